"""Abaqus and CalculiX decks (.inp): read, and spliced on writing.

Linear shells, membranes, and plane and axisymmetric elements are the mesh. What other keywords name
for good is locked; what is said of nodes and elements alike is had by new ones too (see
``abaqus_nodes`` and ``abaqus_regions``). Each part is a mesh of its own, and all of them are read
as one in which no part shares a node or a region with another.
"""

from __future__ import annotations

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
from meshops.formats.difference import numbered
from meshops.formats.fresh import write_mesh
from meshops.formats.locks import Lock, most_first, raised
from meshops.formats.selection import select
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import ABAQUS
from meshops.formats.union import Union
from meshops.mesh import Bools, ShellMesh

_GENERATING = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM")


@dataclass(frozen=True, eq=False)
class AbaqusDeck:
    """An Abaqus deck: its elements as a mesh, its lines, and its parts.

    Attributes
    ----------
    mesh : ShellMesh
        Of all parts.
    sources : Sources
    parts : list of Part
    locks : tuple of Lock
    notes : tuple of str
    """

    mesh: ShellMesh
    sources: Sources
    parts: list[Part]
    locks: tuple[Lock, ...]
    notes: tuple[str, ...]
    _union: Union

    @property
    def files(self) -> tuple[Path, ...]:
        """The files of the deck, the one that was named first."""
        return tuple(file.path for file in self.sources.files)

    def region_name(self, region: int) -> str:
        """Return the sets that the elements of a region of the mesh are in."""
        number, own = self._union.part_of(region)
        return ", ".join(sorted(self.parts[number].sets_of(own)))

    def select(self, text: str) -> Bools:
        """Return which elements a user names, (M,) bool: an ELSET or ids.

        Raises InputError where that is nothing of the mesh.
        """
        named: dict[str, Bools] = {}
        first = 0
        for part in self.parts:
            stop = first + len(part.mesh.elements)
            for name, mine in part.elements_of_sets().items():
                mask = named.setdefault(name.upper(), np.zeros(len(self.mesh.elements), bool))
                mask[first:stop] |= mine
            first = stop
        return select(self.mesh, text, named)

    def numbered(self, mesh: ShellMesh) -> ShellMesh:
        """Give a mesh that descends from ``self.mesh`` the ids that ``write`` gives it."""
        parts = zip(self.parts, self._union.split(mesh), strict=True)
        return self._union.numbered(mesh, [numbered(part.change(mine)) for part, mine in parts])

    def check_room(self) -> None:
        """Raise InputError where there are too few free ids for what a repair may add."""
        for part in self.parts:
            part.check_room()

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
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
            return (path,)
        splice = Splice(self.sources)
        for part, mine in zip(self.parts, self._union.split(mesh), strict=True):
            part.splice(splice, mine)
        return splice.write(path, include_lines)


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
    union = Union.of([part.mesh for part in parts], range(len(parts)))
    return AbaqusDeck(
        mesh=union.mesh,
        sources=sources,
        parts=parts,
        locks=_together(
            [
                lock
                for part, shift in zip(parts, union.shifts, strict=True)
                for lock in raised(part.locks, shift)
            ]
        ),
        notes=(*_notes_of_parts(parts, union), *_notes_of_files(every)),
        _union=union,
    )


def _refuse_generated(every: Sequence[Block], sources: Sources) -> None:
    for block in every:
        if block.keyword in _GENERATING:
            raise InputError(
                f"{sources.where(block.header[0])}: *{block.keyword} is not read; "
                "write out the nodes and elements that it makes."
            )


def _together(locks: Sequence[Lock]) -> tuple[Lock, ...]:
    """Add up what the same keywords lock in several parts."""
    found: dict[tuple[str, str], Lock] = {}
    for lock in locks:
        key = (lock.kind, lock.cards)
        known = found.get(key, replace(lock, count=0, ids=()))
        found[key] = replace(known, count=known.count + lock.count, ids=known.ids + lock.ids)
    return most_first(list(found.values()))


def _notes_of_parts(parts: Sequence[Part], union: Union) -> list[str]:
    notes = [note for part in parts for note in part.notes]
    return notes + [
        f"Ids of {part.scope.name} are counted from {shift:,}, since other parts have the same."
        for part, shift in zip(parts, union.shifts, strict=True)
        if shift
    ]


def _notes_of_files(every: Sequence[Block]) -> list[str]:
    return [
        f"*{block.keyword} reads {block.written['INPUT']}, which is no part of the deck: it stays "
        "where it is."
        for block in every
        if "INPUT" in block.parameters and block.keyword not in READ_AS_DECK
    ]
