"""Abaqus and CalculiX decks (.inp): read, and spliced on writing.

Linear shells, membranes, and plane and axisymmetric elements are the mesh. What other keywords name
for good is locked; what is said of nodes and elements alike is had by new ones too (see
``abaqus_nodes`` and ``abaqus_regions``). Each part is a mesh of its own, and all of them are read
as one in which no part shares a node or a region with another.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meshops.errors import InputError
from meshops.formats.abaqus_blocks import (
    READ_AS_DECK,
    Block,
    blocks,
    find_includes,
    include_lines,
)
from meshops.formats.abaqus_items import is_shell
from meshops.formats.abaqus_part import Part, read_part
from meshops.formats.abaqus_scopes import Scope
from meshops.formats.fresh import write_mesh
from meshops.formats.locks import Lock, most_first
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import ABAQUS
from meshops.mesh import NEW, NO_NODE, Ids, ShellMesh

_GENERATING = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM")


@dataclass(frozen=True, eq=False)
class AbaqusDeck:
    """An Abaqus deck: its elements as a mesh, its lines, and its parts.

    Attributes
    ----------
    mesh : ShellMesh
        Of all parts; ids of a part are its own plus its offset.
    sources : Sources
    parts : list of Part
    offsets : list of int
        0, but where parts use the same ids.
    locks : tuple of Lock
    notes : tuple of str
    """

    mesh: ShellMesh
    sources: Sources
    parts: list[Part]
    offsets: list[int]
    locks: tuple[Lock, ...] = ()
    notes: tuple[str, ...] = ()

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the deck with ``mesh`` in the place of its shells; see ``NastranDeck.write``.

        Raises
        ------
        InputError
            Where the path is one of the deck's files or cannot be written, or no ids are left.
        ValueError
            Where the mesh does not descend from this deck's.
        """
        if path.suffix.lower() not in ABAQUS:
            write_mesh(mesh, path)
            return
        splice = Splice(self.sources)
        first = 0
        for part, offset in zip(self.parts, self.offsets, strict=True):
            stop = first + len(part.regions)
            part.splice(splice, _cut_out(mesh, first, stop, offset))
            first = stop
        splice.write(path, include_lines)


def read_abaqus(path: Path) -> AbaqusDeck:
    """Read an Abaqus deck with all that it includes.

    Raises
    ------
    InputError
        Where a file is missing or not text, nodes or elements are generated or cannot be read, or
        the mesh fails the checks of ``checked_mesh``.
    """
    sources = read_sources(path, find_includes, order=("root", "beside"))
    every = blocks(sources.stream)
    _refuse_generated(every, sources)
    names = list(dict.fromkeys(block.scope for block in every if is_shell(block))) or [""]
    parts = [read_part(Scope.of(name, every), every, sources) for name in names]
    offsets = _offsets([part.mesh for part in parts])
    return AbaqusDeck(
        mesh=_united([part.mesh for part in parts], offsets),
        sources=sources,
        parts=parts,
        offsets=offsets,
        locks=_together([lock for part in parts for lock in part.locks]),
        notes=(*_notes_of_parts(parts, offsets), *_notes_of_files(every)),
    )


def _refuse_generated(every: Sequence[Block], sources: Sources) -> None:
    for block in every:
        if block.keyword in _GENERATING:
            raise InputError(
                f"{sources.where(block.header[0])}: *{block.keyword} is not read; "
                "write out the nodes and elements that it makes."
            )


def _offsets(meshes: Sequence[ShellMesh]) -> list[int]:
    """Find what to add to the ids of each part so that no two parts use the same ones."""
    clash = any(
        len(np.unique(np.concatenate(ids))) < sum(map(len, ids))
        for ids in ([mesh.node_ids for mesh in meshes], [mesh.element_ids for mesh in meshes])
    )
    highest = max(int(ids.max()) for m in meshes for ids in (m.node_ids, m.element_ids))
    step = 10 ** len(str(highest)) if clash else 0
    return [number * step for number in range(len(meshes))]


def _united(meshes: Sequence[ShellMesh], offsets: Sequence[int]) -> ShellMesh:
    if len(meshes) == 1:
        return meshes[0]
    nodes = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    regions = np.cumsum([0, *(int(mesh.region.max()) + 1 for mesh in meshes)])
    return ShellMesh.build(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate(
            [
                np.where(mesh.elements == NO_NODE, NO_NODE, mesh.elements + first)
                for mesh, first in zip(meshes, nodes, strict=False)
            ]
        ),
        region=np.concatenate(
            [mesh.region + first for mesh, first in zip(meshes, regions, strict=False)]
        ),
        locked_nodes=np.concatenate([mesh.locked_nodes for mesh in meshes]),
        locked_elements=np.concatenate([mesh.locked_elements for mesh in meshes]),
        node_ids=np.concatenate(
            [mesh.node_ids + offset for mesh, offset in zip(meshes, offsets, strict=True)]
        ),
        element_ids=np.concatenate(
            [mesh.element_ids + offset for mesh, offset in zip(meshes, offsets, strict=True)]
        ),
    )


def _cut_out(mesh: ShellMesh, first: int, stop: int, offset: int) -> ShellMesh:
    """Take the elements of some regions out of a mesh, as a mesh of their own.

    Nodes that no element uses are left out: those are locked, and a deck keeps them anyway.
    """
    rows = np.flatnonzero((mesh.region >= first) & (mesh.region < stop))
    if len(rows) == len(mesh.elements) and not offset:
        return mesh
    elements = mesh.elements[rows]
    nodes = np.unique(elements[elements != NO_NODE])
    places = np.searchsorted(nodes, elements)
    return ShellMesh.build(
        mesh.points[nodes],
        np.where(elements == NO_NODE, NO_NODE, places),
        region=mesh.region[rows] - first,
        locked_nodes=mesh.locked_nodes[nodes],
        locked_elements=mesh.locked_elements[rows],
        node_ids=_without_offset(mesh.node_ids[nodes], offset),
        element_ids=_without_offset(mesh.element_ids[rows], offset),
    )


def _without_offset(ids: Ids, offset: int) -> Ids:
    own: Ids = np.where(ids == NEW, NEW, ids - offset)
    return own


def _together(locks: Sequence[Lock]) -> tuple[Lock, ...]:
    """Add up what the same keywords lock in several parts."""
    counts: Counter[Lock] = Counter()
    for lock in locks:
        counts[replace(lock, count=0)] += lock.count
    return most_first([replace(lock, count=count) for lock, count in counts.items()])


def _notes_of_parts(parts: Sequence[Part], offsets: Sequence[int]) -> list[str]:
    return [
        f"Parts use the same ids: here those of {part.scope.name} are {offset:,} higher than in "
        "the deck."
        for part, offset in zip(parts, offsets, strict=True)
        if offset
    ]


def _notes_of_files(every: Sequence[Block]) -> list[str]:
    return [
        f"*{block.keyword} reads {block.written['INPUT']}, which is no part of the deck: it stays "
        "where it is."
        for block in every
        if "INPUT" in block.parameters and block.keyword not in READ_AS_DECK
    ]
