"""Writing a deck that was read again from its bytes and found to be what it should be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshops.errors import HarmError, InputError
from meshops.formats import Deck, read_deck
from meshops.formats.difference import deck_corners
from meshops.formats.matching import matched, renumbered, rounding
from meshops.formats.output import refuse_to_overwrite
from meshops.mesh import NO_NODE, Ids, ShellMesh

Verify = Callable[[ShellMesh, ShellMesh], tuple[str, ...]]
"""Compares the mesh of a deck, and that of the written one read again: a sentence a fault."""

SHOWN = 3


def nothing_else(before: ShellMesh, after: ShellMesh) -> tuple[str, ...]:
    """Verify nothing."""
    return ()


@dataclass(frozen=True, eq=False)
class Written:
    """What was written.

    Attributes
    ----------
    files : tuple of Path
        The deck first, then the files that belong to it.
    mesh : ShellMesh
        With the ids that its nodes and elements have in the deck.
    """

    files: tuple[Path, ...]
    mesh: ShellMesh


def write_verified(
    deck: Deck,
    mesh: ShellMesh,
    path: Path,
    verify: Verify = nothing_else,
    read: Callable[[Path], Deck] = read_deck,
) -> Written:
    """Write a deck beside ``path``, read it again, and give it its name if it is the model.

    Parameters
    ----------
    deck : Deck
    mesh : ShellMesh
        Descends from the deck's.
    path : Path
    verify : callable
        What else must hold of the mesh of the deck and of that which was read again.
    read : callable
        Reads a deck as the given one was read.

    Raises
    ------
    HarmError
        Where the written deck cannot be read, is another mesh or does not pass ``verify``. Nothing
        is left of it.
    InputError
        Where it cannot be written.
    """
    refuse_to_overwrite(path, list(deck.files))
    staged = path.with_name(f"{path.stem}-checked{path.suffix}")
    if staged.exists():
        staged = path.with_name(f"{path.stem}-checked-{mesh.digest}{path.suffix}")
    files = deck.write(mesh, staged)
    try:
        numbered, faults = _checked(deck, mesh, staged, verify, read)
        if faults:
            more = f"; and {len(faults) - SHOWN} more" if len(faults) > SHOWN else ""
            raise HarmError(
                f"{path} is not written: read again, it is not what it should be: "
                f"{'; '.join(fault.rstrip('.') for fault in faults[:SHOWN])}{more}."
            )
        staged.replace(path)
    except BaseException:
        for file in files:
            file.unlink(missing_ok=True)
        raise
    return Written((path, *files[1:]), numbered)


def _checked(
    deck: Deck, mesh: ShellMesh, written: Path, verify: Verify, read: Callable[[Path], Deck]
) -> tuple[ShellMesh, tuple[str, ...]]:
    """Return the mesh with the ids that it has in a file, and what is wrong with that."""
    suffix = written.suffix.lower()
    is_other = suffix != deck.files[0].suffix.lower()
    try:
        again = read_deck(written) if is_other else read(written)
    except InputError as error:
        return mesh, (f"it cannot be read ({str(error).rstrip('.')})",)
    model = None if is_other else deck.numbered(mesh)
    after = again.mesh
    if model is not None:
        found = differences(model, again.mesh) or _other_regions(deck, model, again)
    else:
        model = matched(mesh, again.mesh, is_split=suffix == ".stl")
        if model is None:
            return mesh, ("its elements are not those of the model",)
        found = () if is_other or suffix == ".stl" else _mixed_regions(model, after)
        after = renumbered(after, model, mesh)
    if suffix == ".stl":  # which knows no quads
        return model, found
    return model, found or verify(deck.mesh, after)


def differences(model: ShellMesh, again: ShellMesh) -> tuple[str, ...]:
    """Say in what a mesh that was read again differs from its model, by their deck ids.

    Nodes that no element uses are left aside, and so are regions.
    """
    found = [
        *_other_ids("node", model.node_ids[_used(model)], again.node_ids[_used(again)]),
        *_other_ids("element", model.element_ids, again.element_ids),
    ]
    if found:
        return tuple(found)
    rows, places = _sorted(again.element_ids), _sorted(model.element_ids)
    corners = deck_corners(again, again.node_ids)[rows]
    other = (corners != deck_corners(model, model.node_ids)[places]).any(axis=1)
    if other.any():
        ids = again.element_ids[rows][other]
        return (f"{_named('element', ids)} on other nodes than in the model",)
    return tuple(_moved_nodes(model, again))


def _moved_nodes(model: ShellMesh, again: ShellMesh) -> list[str]:
    here, there = _used(model), _used(again)
    here = here[_sorted(model.node_ids[here])]
    there = there[_sorted(again.node_ids[there])]
    distance = np.linalg.norm(model.points[here] - again.points[there], axis=1)
    moved = ~(distance <= rounding(model))
    return [f"{_named('node', model.node_ids[here][moved])} elsewhere"] if moved.any() else []


def _other_regions(deck: Deck, model: ShellMesh, again: Deck) -> tuple[str, ...]:
    """Elements that are called otherwise than in the model: of another property, in other sets."""
    rows, places = _sorted(again.mesh.element_ids), _sorted(model.element_ids)
    pairs = np.stack([model.region[places], again.mesh.region[rows]], axis=1)
    kinds, kind = np.unique(pairs, axis=0, return_inverse=True)
    other = [deck.region_name(a) != again.region_name(b) for a, b in kinds.tolist()]
    ids = model.element_ids[places][np.array(other, bool)[kind.reshape(-1)]]
    return (f"{_named('element', ids)} of another property or in other sets",) if len(ids) else ()


def _mixed_regions(model: ShellMesh, again: ShellMesh) -> tuple[str, ...]:
    """Elements of one region of the model that are in several there, or the other way round."""
    rows, places = _sorted(again.element_ids), _sorted(model.element_ids)
    pairs = np.unique(np.stack([model.region[places], again.region[rows]]), axis=1)
    if all(len(np.unique(labels)) == pairs.shape[1] for labels in pairs):
        return ()
    return ("its regions are not those of the model",)


def _other_ids(noun: str, model: Ids, again: Ids) -> list[str]:
    missing, new = np.setdiff1d(model, again), np.setdiff1d(again, model)
    found = [f"{_named(noun, missing)} missing"] if len(missing) else []
    return found + ([f"{_named(noun, new)} unknown to the model"] if len(new) else [])


def _named(noun: str, ids: Ids) -> str:
    shown = ", ".join(map(str, ids[:SHOWN])) + ", ..." * (len(ids) > SHOWN)
    return f"{noun} {shown} is" if len(ids) == 1 else f"{len(ids)} {noun}s ({shown}) are"


def _used(mesh: ShellMesh) -> Ids:
    used: Ids = np.unique(mesh.elements[mesh.elements != NO_NODE]).astype(np.int64)
    return used


def _sorted(ids: Ids) -> Ids:
    order: Ids = np.argsort(ids, kind="stable")
    return order
