"""Nastran decks (.bdf .dat .nas .blk): read, and spliced on writing.

The linear shells are the mesh. Everything else in the deck stays as it is, and so do the nodes and
shells that it refers to: they are locked. A shell is of the region of its card family, property
and other attributes, because a new element of a region takes them over. A material angle THETA is
taken over as it stands, although it is measured from the first edge of an element.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshops.errors import InputError
from meshops.formats import nastran_sections as sections
from meshops.formats.checks import checked_mesh
from meshops.formats.difference import Difference, compare
from meshops.formats.fortran import real_field
from meshops.formats.fresh import write_mesh
from meshops.formats.ids import IdSet
from meshops.formats.nastran_cards import Card, Form, card_lines, lex
from meshops.formats.nastran_references import References, collect
from meshops.formats.nastran_shells import CORNERS, Attributes, attributes
from meshops.formats.nastran_systems import Systems, integer_at
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import NASTRAN
from meshops.mesh import Bools, Floats, Ids, Ints, ShellMesh

LARGEST_ID = 99_999_999

_SYSTEM_CARDS = ("CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S")
_NUMBERED_POINTS = ("SPOINT", "EPOINT", "PLOTEL")


@dataclass(frozen=True, eq=False)
class _Cards:
    grids: list[Card]
    grid_by_id: dict[int, Card]
    shells: list[Card]
    systems: Systems
    references: References
    taken: IdSet


@dataclass(frozen=True, eq=False)
class NastranDeck:
    """A Nastran deck: its linear shells as a mesh, its lines, and its cards by id.

    Attributes
    ----------
    mesh : ShellMesh
        ``region`` counts the attributes in ``regions``.
    sources : Sources
    """

    mesh: ShellMesh
    sources: Sources
    regions: list[Attributes]
    _cards: _Cards

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the deck with ``mesh`` in the place of its shells.

        Lines of nodes that did not move and of shells that keep their nodes stay byte for byte,
        and so do all other lines. Included files go beside ``path`` where they change.

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
        cards = self._cards
        change = compare(
            self.mesh,
            mesh,
            taken_nodes=_union(cards.taken, cards.references.nodes),
            taken_elements=_union(cards.taken, cards.references.elements),
            limit=LARGEST_ID,
        )
        splice = Splice(self.sources)
        self._write_nodes(splice, mesh, change)
        self._write_shells(splice, mesh, change)
        splice.write(path, sections.include_lines)

    def _write_nodes(self, splice: Splice, mesh: ShellMesh, change: Difference) -> None:
        cards = self._cards
        gone = set(change.gone_nodes.tolist())
        moved = dict(zip(change.node_ids[change.moved].tolist(), change.moved, strict=True))
        for grid in cards.grids if gone or moved else ():
            node = int(grid.field(0))
            if node in gone:
                splice.drop(grid.lines)
            elif node in moved:
                text = self._moved_grid(grid, mesh.points[moved[node]])
                splice.replace(grid.lines, text)
        splice.insert_after(cards.grids[-1].lines[-1], self._new_grids(mesh, change))

    def _moved_grid(self, grid: Card, point: Floats) -> list[str]:
        systems = self._cards.systems
        local = systems.frame(systems.system_of(grid), grid).from_basic(point[None])[0]
        tail = [grid.field(i) for i in range(5, len(grid.fields))]
        fields = [grid.field(0), grid.field(1), *map(real_field, local.tolist()), *tail]
        return card_lines("GRID", fields, grid.form)

    def _new_grids(self, mesh: ShellMesh, change: Difference) -> list[str]:
        systems = self._cards.systems
        # in the system of GRDSET, since a blank CP would be read as that one
        frame = systems.frame(systems.default, self._cards.grids[0])
        system = str(systems.default) if systems.default else ""
        local = frame.from_basic(mesh.points[change.new_nodes])
        rows: list[str] = []
        ids = change.node_ids[change.new_nodes]
        for node, point in zip(ids.tolist(), local.tolist(), strict=True):
            fields = [str(node), system, *map(real_field, point)]
            rows += card_lines("GRID", fields, Form(wide=True))
        return rows

    def _write_shells(self, splice: Splice, mesh: ShellMesh, change: Difference) -> None:
        cards = self._cards
        gone = set(change.gone_elements.tolist())
        ids, corners = change.element_ids, change.corners
        rewired = {int(ids[row]): _nodes(corners[row]) for row in change.rewired}
        for card in cards.shells if gone or rewired else ():
            element = int(card.field(0))
            if element in gone:
                splice.drop(card.lines)
            elif element in rewired:
                splice.replace(card.lines, _shell(attributes(card), element, rewired[element]))
        rows: list[str] = []
        for row in change.new_elements:
            region = self.regions[mesh.region[row]]
            rows += _shell(region, int(ids[row]), _nodes(corners[row]))
        splice.insert_after(cards.shells[-1].lines[-1], rows)


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
    cards = _sort_cards(sources, bulk)
    cards.references.nodes.update(sections.output_nodes(sources.stream[case:bulk]))
    _check_repeated(cards, sources)
    regions, region, is_uniform = _regions(cards.shells)
    element_ids = np.array([integer_at(card, 0, sources) for card in cards.shells], np.int64)
    corners = _corners(cards.shells, sources)
    used = set(corners.ravel().tolist())
    grids = [card for card in cards.grids if int(card.field(0)) in used]
    node_ids = np.array([int(card.field(0)) for card in grids], np.int64)
    mesh = checked_mesh(
        source=sources.name,
        points=cards.systems.basic_points(grids),
        node_ids=node_ids,
        corners=corners,
        element_ids=element_ids,
        region=region,
        locked_nodes=cards.references.nodes.mask(node_ids) | _fixed(grids),
        locked_elements=cards.references.elements.mask(element_ids) | ~is_uniform,
        node_place=lambda row: sources.where(grids[row].lines[0]),
        element_place=lambda row: sources.where(cards.shells[row].lines[0]),
    )
    return NastranDeck(mesh, sources, regions, cards)


def _sort_cards(sources: Sources, bulk: int) -> _Cards:
    by_name: dict[str, list[Card]] = {}
    for card in lex(sources.stream, bulk, sources.where):
        by_name.setdefault(card.name, []).append(card)
    grids = by_name.pop("GRID", [])
    grid_by_id = {integer_at(card, 0, sources): card for card in grids}
    shells = [card for name in CORNERS for card in by_name.pop(name, [])]
    shells.sort(key=lambda card: card.lines[0])
    default = next((integer_at(card, 1, sources, 0) for card in by_name.get("GRDSET", [])), 0)
    frames = [card for name in _SYSTEM_CARDS for card in by_name.get(name, [])]
    others = [card for some in by_name.values() for card in some]
    taken = IdSet(set(grid_by_id))
    taken.read(card.field(0) for card in [*shells, *others])
    for name in _NUMBERED_POINTS:
        for card in by_name.get(name, []):
            taken.read(card.fields)
    return _Cards(
        grids=grids,
        grid_by_id=grid_by_id,
        shells=shells,
        systems=Systems(frames, grid_by_id, sources, default),
        references=collect(others),
        taken=taken,
    )


def _check_repeated(cards: _Cards, sources: Sources) -> None:
    """Refuse a GRID that comes again with another output system or constraint."""
    if len(cards.grids) == len(cards.grid_by_id):
        return
    for grid in cards.grids:
        other = cards.grid_by_id[int(grid.field(0))]
        if any(grid.field(i) != other.field(i) for i in (5, 6, 7)):
            raise InputError(
                f"{sources.where(other.lines[0])}: node {grid.field(0)} is defined a second time "
                f"with other content (first: {sources.where(grid.lines[0])}); renumber or remove "
                "one."
            )


def _regions(shells: Sequence[Card]) -> tuple[list[Attributes], Ints, Bools]:
    """Find the regions, the number of the one of each shell, and the shells of one thickness."""
    regions: list[Attributes] = []
    number_of_key: dict[tuple[str, ...], int] = {}
    number_of_text: dict[tuple[str, ...], tuple[int, bool]] = {}
    found = []
    for card in shells:
        # cards typed alike are the rule: look only at what is new
        text = (card.name, card.field(1) or card.field(0), *card.fields[2 + CORNERS[card.name] :])
        if text not in number_of_text:
            item = attributes(card)
            number = number_of_key.setdefault(item.region_key, len(regions))
            if number == len(regions):
                regions.append(item)
            number_of_text[text] = (number, item.is_uniform)
        found.append(number_of_text[text])
    region = np.array([number for number, _ in found], np.int32)
    return regions, region, np.array([uniform for _, uniform in found], bool)


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


def _shell(item: Attributes, element: int, nodes: Sequence[int]) -> list[str]:
    name, fields = item.card(element, nodes)
    return card_lines(name, fields, item.form)


def _nodes(corners: Ids) -> list[int]:
    return [int(node) for node in corners if node]


def _union(first: IdSet, second: IdSet) -> IdSet:
    union = IdSet()
    union.update(first)
    union.update(second)
    return union
