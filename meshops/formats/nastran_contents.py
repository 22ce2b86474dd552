"""The cards of a Nastran deck, sorted by what they mean for the mesh."""

from __future__ import annotations

from dataclasses import dataclass

from meshops.errors import InputError
from meshops.formats.ids import IdSet, is_id
from meshops.formats.nastran_cards import Card, lex
from meshops.formats.nastran_loads import PressureCard, pressure_card
from meshops.formats.nastran_references import References, collect
from meshops.formats.nastran_regions import oriented_properties
from meshops.formats.nastran_shells import CORNERS
from meshops.formats.nastran_systems import Systems, integer_at
from meshops.formats.sources import Sources

_SYSTEM_CARDS = ("CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S")
_NUMBERED_POINTS = ("SPOINT", "EPOINT", "PLOTEL")
_PRESSURES = ("PLOAD4", "PLOAD2")


@dataclass(frozen=True, eq=False)
class Contents:
    """What a deck consists of.

    Attributes
    ----------
    grids, shells : list of Card
        In the order of the deck.
    grid_by_id : dict of int to Card
    pressures : list of PressureCard
        Loads that follow their shells; all others are references.
    oriented : frozenset of str
        Properties whose stiffness has a direction.
    systems : Systems
    references : References
    taken : IdSet
        Ids that nothing new may have.
    """

    grids: list[Card]
    grid_by_id: dict[int, Card]
    shells: list[Card]
    pressures: list[PressureCard]
    oriented: frozenset[str]
    systems: Systems
    references: References
    taken: IdSet


def sort_cards(sources: Sources, bulk: int) -> Contents:
    """Sort the cards of the bulk data, which begins at position ``bulk`` of the stream.

    Raises
    ------
    InputError
        Where a card cannot be read, or a GRID comes again with other content.
    """
    by_name: dict[str, list[Card]] = {}
    for card in lex(sources.stream, bulk, sources.where):
        by_name.setdefault(card.name, []).append(card)
    grids = by_name.pop("GRID", [])
    grid_by_id = {integer_at(card, 0, sources): card for card in grids}
    _check_repeated(grids, grid_by_id, sources)
    shells = [card for name in CORNERS for card in by_name.pop(name, [])]
    shells.sort(key=lambda card: card.lines[0])
    oriented = oriented_properties(by_name)
    pressures = _take_pressures(by_name, shells)
    default = next((integer_at(card, 1, sources, 0) for card in by_name.get("GRDSET", [])), 0)
    frames = [card for name in _SYSTEM_CARDS for card in by_name.get(name, [])]
    others = [card for some in by_name.values() for card in some]
    taken = IdSet(set(grid_by_id))
    taken.read(card.field(0) for card in [*shells, *others])
    for name in _NUMBERED_POINTS:
        for card in by_name.get(name, []):
            taken.read(card.fields)
    return Contents(
        grids=grids,
        grid_by_id=grid_by_id,
        shells=shells,
        pressures=pressures,
        oriented=oriented,
        systems=Systems(frames, grid_by_id, sources, default),
        references=collect(others),
        taken=taken,
    )


def _take_pressures(by_name: dict[str, list[Card]], shells: list[Card]) -> list[PressureCard]:
    """Take the loads that follow their shells out of the cards."""
    ids = {int(card.field(0)) for card in shells if is_id(card.field(0))}
    taken = []
    for name in _PRESSURES:
        left = []
        for card in by_name.pop(name, []):
            load = pressure_card(card)
            # a range that holds more than shells may load solids too
            if load and len(load.elements) <= len(ids) and ids.issuperset(load.elements):
                taken.append(load)
            else:
                left.append(card)
        by_name[name] = left
    return taken


def _check_repeated(grids: list[Card], grid_by_id: dict[int, Card], sources: Sources) -> None:
    """Refuse a GRID that comes again with another output system or constraint."""
    if len(grids) == len(grid_by_id):
        return
    for grid in grids:
        other = grid_by_id[int(grid.field(0))]
        if any(grid.field(i) != other.field(i) for i in (5, 6, 7)):
            raise InputError(
                f"{sources.where(other.lines[0])}: node {grid.field(0)} is defined a second time "
                f"with other content (first: {sources.where(grid.lines[0])}); renumber or remove "
                "one."
            )
