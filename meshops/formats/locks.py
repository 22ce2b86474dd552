"""What of a mesh is locked, by which cards, and what that forbids: told before a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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
    """

    kind: Kind
    count: int
    cards: str
    forbids: str

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


def most_first(locks: list[Lock]) -> tuple[Lock, ...]:
    """Order locks for a reader: those of elements first, then by their counts, then by name."""
    return tuple(sorted(locks, key=lambda lock: (lock.kind, -lock.count, lock.cards)))
