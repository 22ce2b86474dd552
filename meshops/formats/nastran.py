"""Nastran decks (.bdf .dat .nas .blk): read, and spliced on writing.

The linear shells are the mesh. Everything else in the deck stays as it is, and so do the nodes and
shells that it refers to: they are locked. Two things follow the elements instead. An even pressure
on a shell is one of its attributes, and a new shell of the region gets a card like it. A material
angle is measured from the first edge of an element, and a new element gets the one that
leaves the material direction as it was. A shell is of the region of its card family, property and
other attributes, because a new element of a region takes them over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshops.formats import nastran_sections as sections
from meshops.formats.checks import checked_mesh
from meshops.formats.difference import compare
from meshops.formats.fresh import write_mesh
from meshops.formats.ids import IdSet
from meshops.formats.locks import Lock
from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_contents import Contents, sort_cards
from meshops.formats.nastran_directions import MaterialDirections, part_by_direction
from meshops.formats.nastran_output import Update
from meshops.formats.nastran_regions import find_regions
from meshops.formats.nastran_shells import CORNERS, Attributes
from meshops.formats.nastran_systems import integer_at
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import NASTRAN
from meshops.mesh import Bools, Ids, ShellMesh

LARGEST_ID = 99_999_999


@dataclass(frozen=True, eq=False)
class NastranDeck:
    """A Nastran deck: its linear shells as a mesh, its lines, and its cards.

    Attributes
    ----------
    mesh : ShellMesh
        ``region`` counts the attributes in ``regions``.
    sources : Sources
    regions : list of Attributes
    directions : MaterialDirections
    """

    mesh: ShellMesh
    sources: Sources
    regions: list[Attributes]
    directions: MaterialDirections
    _contents: Contents
    locks: tuple[Lock, ...] = ()
    notes: tuple[str, ...] = ()

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the deck with ``mesh`` in the place of its shells.

        Lines of nodes that did not move and of shells that keep their nodes in their places stay
        byte for byte, and so do all others but the loads of shells that are new or gone. Included
        files go beside ``path`` where they change.

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
        contents = self._contents
        change = compare(
            self.mesh,
            mesh,
            taken_nodes=_union(contents.taken, contents.references.nodes),
            taken_elements=_union(contents.taken, contents.references.elements),
            limit=LARGEST_ID,
        )
        angles = self.directions.changed_angles(mesh, change)
        splice = Splice(self.sources)
        Update(mesh, change, self.regions, angles).splice(splice, contents)
        splice.write(path, sections.include_lines)


def read_nastran(path: Path) -> NastranDeck:
    """Read a Nastran deck with all that it includes.

    Raises
    ------
    InputError
        Where a file is missing or not text, a card cannot be read, or the mesh fails the checks of
        ``checked_mesh``.
    """
    sources = read_sources(path, sections.find_includes)
    case, bulk = sections.bulk_start(sources)
    contents = sort_cards(sources, bulk)
    references = contents.references
    references.nodes.update(sections.output_nodes(sources.stream[case:bulk]))
    shells = contents.shells
    element_ids = np.array([integer_at(card, 0, sources) for card in shells], np.int64)
    corners = _corners(shells, sources)
    regions = find_regions(shells, element_ids, contents.pressures, contents.oriented)
    used = set(corners.ravel().tolist())
    grids = [card for card in contents.grids if int(card.field(0)) in used]
    node_ids = np.array([int(card.field(0)) for card in grids], np.int64)
    mesh = checked_mesh(
        source=sources.name,
        points=contents.systems.basic_points(grids),
        node_ids=node_ids,
        corners=corners,
        element_ids=element_ids,
        region=regions.region,
        locked_nodes=references.nodes.mask(node_ids) | _fixed(grids),
        locked_elements=references.elements.mask(element_ids) | ~regions.is_uniform,
        node_place=lambda row: sources.where(grids[row].lines[0]),
        element_place=lambda row: sources.where(shells[row].lines[0]),
    )
    mesh, before = part_by_direction(mesh, regions.angles)
    return NastranDeck(
        mesh=mesh,
        sources=sources,
        regions=[regions.attributes[region] for region in before],
        directions=MaterialDirections.of(mesh, regions.angles),
        _contents=contents,
    )


def _corners(shells: Sequence[Card], sources: Sources) -> Ids:
    """(M, 4) int64 node ids, 0 last in a tria."""
    corners = np.zeros((len(shells), 4), np.int64)
    for row, card in enumerate(shells):
        count = CORNERS[card.name]
        corners[row, :count] = [integer_at(card, 2 + i, sources) for i in range(count)]
    return corners


def _fixed(grids: Sequence[Card]) -> Bools:
    """Which GRIDs have an output system or a permanent constraint of their own."""
    return np.array([(card.field(5) or "0") != "0" or bool(card.field(6)) for card in grids], bool)


def _union(first: IdSet, second: IdSet) -> IdSet:
    union = IdSet()
    union.update(first)
    union.update(second)
    return union
