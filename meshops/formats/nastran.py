"""Nastran decks (.bdf .dat .nas .blk .fem): read, and spliced on writing.

The linear shells are the mesh. Everything else in the deck stays as it is, and so do the nodes and
shells that it refers to: they are locked. Some things follow the mesh instead. What all nodes of an
element share, as a support, new nodes between them get too. A pressure on shells stays on its area.
A material angle is measured from the first edge of an element, and a new element gets the one that
leaves the material direction as it was. A shell is of the region of its card family, property and
other attributes, because a new element of a region takes them over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meshops.errors import InputError
from meshops.formats import nastran_sections as sections
from meshops.formats.fresh import write_mesh
from meshops.formats.locks import Lock, most_first
from meshops.formats.nastran_cards import Card, lex
from meshops.formats.nastran_case import CaseControl, read_case_control
from meshops.formats.nastran_contents import Contents, sort_cards
from meshops.formats.nastran_directions import MaterialDirections
from meshops.formats.nastran_nodes import splice_sets
from meshops.formats.nastran_part import Part, read_part
from meshops.formats.nastran_references import used_sets
from meshops.formats.nastran_replication import write_out
from meshops.formats.nastran_shells import Attributes
from meshops.formats.nastran_superelements import attached
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import NASTRAN
from meshops.formats.union import Union
from meshops.mesh import ShellMesh

_NAME_OTHER_SECTIONS = ("SE", "CSUPER", "CSUPEXT", "RELEASE")
"""Cards of the main section that begin so name nodes of superelements."""


@dataclass(frozen=True, eq=False)
class NastranDeck:
    """A Nastran deck: its linear shells as a mesh, its lines, and its sections of bulk data.

    Attributes
    ----------
    mesh : ShellMesh
        ``region`` counts the attributes in ``regions``.
    sources : Sources
    parts : list of Part
        One of the deck itself and one of each superelement that has shells.
    case : CaseControl
    locks : tuple of Lock
    notes : tuple of str
    """

    mesh: ShellMesh
    sources: Sources
    parts: list[Part]
    case: CaseControl
    locks: tuple[Lock, ...]
    notes: tuple[str, ...]
    _union: Union

    @property
    def regions(self) -> list[Attributes]:
        """What new elements of each region take over."""
        return [attributes for part in self.parts for attributes in part.regions]

    @property
    def directions(self) -> MaterialDirections:
        """The material directions of the first part."""
        return self.parts[0].directions

    def check_room(self) -> None:
        """Raise InputError where there are too few free ids for what a repair may add."""
        for part in self.parts:
            part.check_room()

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the deck with ``mesh`` in the place of its shells.

        Lines of nodes that did not move and of shells that keep their nodes in their places stay
        byte for byte, and so do all others but those that name what is new or gone. Included
        files go below the folder of ``path`` where they change.

        Parameters
        ----------
        mesh
            Descends from ``self.mesh`` by edits.
        path
            Where to write; none of the deck's own files.

        Raises
        ------
        InputError
            Where the path is one of the deck's files or cannot be written, or no ids are left.
        ValueError
            Where the mesh does not descend from this deck's.
        """
        if path.suffix.lower() not in NASTRAN:
            write_mesh(mesh, path)
            return
        splice = Splice(self.sources)
        of_nodes: dict[int, list[int]] = {}
        of_shells: dict[int, list[int]] = {}
        for part, mine in zip(self.parts, self._union.split(mesh), strict=True):
            update = part.update(mine)
            update.splice(splice)
            for every, new in zip((of_nodes, of_shells), update.new_in_sets(), strict=True):
                for number, ids in new.items():
                    every.setdefault(number, []).extend(ids)
        stream = self.sources.stream
        both = {item.lines[0]: item for item in (*self.case.node_sets, *self.case.element_sets)}
        joint = {
            number: sorted({*of_nodes.get(number, []), *of_shells.get(number, [])})
            for number in {*of_nodes, *of_shells}
        }
        splice_sets(splice, stream, both.values(), joint)
        splice.write(path, sections.include_lines)


def read_nastran(path: Path) -> NastranDeck:
    """Read a Nastran deck with all that it includes.

    Raises
    ------
    InputError
        Where a file is missing or not text, a card cannot be read, or the mesh fails the checks of
        ``checked_mesh``.
    """
    sources = read_sources(path, sections.find_includes, find_symbols=sections.find_symbols)
    start, found = sections.bulk_sections(sources)
    begin = found[0].start
    case = read_case_control(sources.stream[start:begin], start)
    sources = write_out(sources, begin)
    by_section = {
        number: list(used_sets(cards, case.numbers)) for number, cards in _sections(sources).items()
    }
    main = by_section.get(0, [])
    foreign = [card for card in main if card.name.startswith(_NAME_OTHER_SECTIONS)]
    contents = {
        number: sort_cards(sources, cards, foreign if number else [])
        for number, cards in by_section.items()
    }
    with_shells = {number: item for number, item in contents.items() if item.shells}
    if not with_shells:
        raise InputError(
            f"{sources.name} holds no linear shell element: there is nothing to repair."
        )
    parts = [read_part(sources, item, case) for item in with_shells.values()]
    if len(contents) > 1:
        parts = [
            _attached(part, [item for item in contents.values() if item is not part.contents])
            for part in parts
        ]
    union = Union.of([part.mesh for part in parts], list(with_shells))
    notes = [note for part in parts for note in part.notes]
    if any(union.shifts):
        notes.append("Ids of superelement n are counted from n,000,000,000, since some come twice.")
    return NastranDeck(
        mesh=union.mesh,
        sources=sources,
        parts=parts,
        case=case,
        locks=most_first([lock for part in parts for lock in part.locks]),
        notes=tuple(notes),
        _union=union,
    )


def _sections(sources: Sources) -> dict[int, list[Card]]:
    """Cards by the numbers of their sections."""
    found: dict[int, list[Card]] = {}
    for section in sections.bulk_sections(sources)[1]:
        cards = lex(sources.stream, section.start, sources.where, stop=section.stop)
        found.setdefault(section.number, []).extend(cards)
    return found


def _attached(part: Part, others: Sequence[Contents]) -> Part:
    """Lock nodes that are joined to those of another section by their places."""
    places = [item.systems.basic_points(item.grids) for item in others]
    held = attached(part.mesh.points, np.concatenate(places))
    locked = part.mesh.locked_nodes | held
    locked.setflags(write=False)
    lock = Lock("nodes", int(held.sum()), "the border of a superelement", "they stay in place")
    return replace(
        part,
        mesh=replace(part.mesh, locked_nodes=locked),
        locks=(*part.locks, lock) if lock.count else part.locks,
    )
