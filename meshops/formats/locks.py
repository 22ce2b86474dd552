"""What of a mesh is locked, by which cards, and what that forbids: told before a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from meshops.mesh import Ids, ShellMesh

Kind = Literal["nodes", "elements"]

NODES_STAY = "they neither move nor vanish"
ELEMENTS_STAY = "they stay as they are"


@dataclass(frozen=True)
class Lock:
    """One reason why nodes or elements of a deck stay.

    Attributes
    ----------
    kind : 'nodes' or 'elements'
    count : int
        How many; one that has several reasons counts for each of them.
    cards : str
        What locks them, in the words of the deck: 'CD on GRID', 'PLOAD1', 'NSET SET-1'.
    forbids : str
        What cannot be done to them: 'they neither move nor vanish'.
    ids : tuple of int
        Their ids in the deck, where they are known one by one.
    """

    kind: Kind
    count: int
    cards: str
    forbids: str
    ids: tuple[int, ...] = field(default=(), repr=False, compare=False)

    @property
    def sentence(self) -> str:
        """'4,990 nodes: CD on GRID (they neither move nor vanish)'."""
        noun = self.kind if self.count != 1 else self.kind.removesuffix("s")
        forbids = self.forbids
        if self.count == 1:
            forbids = forbids.replace(
                "they neither move nor vanish", "it neither moves nor vanishes"
            )
            forbids = forbids.replace("they stay as they are", "it stays as it is")
        return f"{self.count:,} {noun}: {self.cards} ({forbids})"


def lock_of(kind: Kind, ids: Ids, cards: str) -> Lock:
    """Return the lock of nodes or elements with these deck ids (K,)."""
    forbids = NODES_STAY if kind == "nodes" else ELEMENTS_STAY
    return Lock(kind, len(ids), cards, forbids, tuple(ids.tolist()))


def raised(locks: Iterable[Lock], shift: int) -> list[Lock]:
    """Raise the ids of locks, as those of a part are among others."""
    if not shift:
        return list(locks)
    return [replace(lock, ids=tuple(number + shift for number in lock.ids)) for lock in locks]


def most_first(locks: list[Lock]) -> tuple[Lock, ...]:
    """Order locks for a reader: those of elements first, then by their counts, then by name."""
    return tuple(sorted(locks, key=lambda lock: (lock.kind, -lock.count, lock.cards)))


def locks_told(mesh: ShellMesh, locks: Sequence[Lock]) -> tuple[str, ...]:
    """Say how much of a mesh is locked, by which cards, and what that forbids: a line each."""
    nodes, elements = int(mesh.locked_nodes.sum()), int(mesh.locked_elements.sum())
    if not (nodes or elements):
        return ()
    total = (
        f"locked: {nodes:,} of {len(mesh.points):,} nodes, {elements:,} of "
        f"{len(mesh.elements):,} elements"
    )
    if not locks:
        return (f"{total}, since other cards refer to them",)
    return (total, *(f"  {lock.sentence}" for lock in locks))


def only_lock(deck: ShellMesh, mesh: ShellMesh, text: str) -> Lock:
    """Return the lock that leaves only a part of a deck free, which the user has named."""
    ids = mesh.element_ids[mesh.locked_elements & ~deck.locked_elements].tolist()
    return Lock("elements", len(ids), f"--only {text}", ELEMENTS_STAY, tuple(ids))
