"""The cards of a Nastran deck, sorted by what they mean for the mesh."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from meshops.errors import InputError
from meshops.formats.ids import IdSet, is_id
from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_loads import PressureCard, pressure_card
from meshops.formats.nastran_memberships import NAMES, NodeCard, node_card
from meshops.formats.nastran_references import References, collect
from meshops.formats.nastran_regions import oriented_properties
from meshops.formats.nastran_shells import CORNERS
from meshops.formats.nastran_systems import Systems, integer_at
from meshops.formats.sources import Sources

_SYSTEM_CARDS = ("CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S")
_NUMBERED_POINTS = ("SPOINT", "EPOINT", "PLOTEL")
_PRESSURES = ("PLOAD4", "PLOAD2")
_RIGID = ("RBE1", "RBE2", "RBE3")


@dataclass(frozen=True, eq=False)
class Contents:
    """What a section of bulk data consists of.

    Attributes
    ----------
    grids, shells : list of Card
        In the order of the deck.
    grid_by_id : dict of int to Card
    grdset : Card or None
        What it says of fields that a GRID leaves blank.
    pressures : list of PressureCard
        Loads that follow their shells; all others are references.
    node_cards : list of NodeCard
        Cards that say of nodes what new nodes can have too; all others are references.
    rigid : list of (str, IdSet)
        Rigid elements, as 'RBE2 7', and their nodes.
    oriented : frozenset of str
        Properties whose stiffness has a direction.
    systems : Systems
    references : dict of str to References
        By the names of the cards.
    taken : IdSet
        Ids that nothing new may have.
    """

    grids: list[Card]
    grid_by_id: dict[int, Card]
    grdset: Card | None
    shells: list[Card]
    pressures: list[PressureCard]
    node_cards: list[NodeCard]
    rigid: list[tuple[str, IdSet]]
    oriented: frozenset[str]
    systems: Systems
    references: dict[str, References]
    taken: IdSet

    def referenced(self) -> References:
        """All nodes and elements that other cards refer to."""
        every = References()
        for found in self.references.values():
            every.nodes.update(found.nodes)
            every.elements.update(found.elements)
        return every


def sort_cards(sources: Sources, cards: Iterable[Card], foreign: Iterable[Card]) -> Contents:
    """Sort the cards of a section of bulk data.

    Parameters
    ----------
    cards
        Of the section.
    foreign
        Cards of other sections that may name ids of this one.

    Raises
    ------
    InputError
        Where a card cannot be read, or a GRID comes again with other content.
    """
    by_name: dict[str, list[Card]] = {}
    for card in cards:
        by_name.setdefault(card.name, []).append(card)
    grids = by_name.pop("GRID", [])
    grid_by_id = {integer_at(card, 0, sources): card for card in grids}
    _check_repeated(grids, grid_by_id, sources)
    shells = [card for name in CORNERS for card in by_name.pop(name, [])]
    shells.sort(key=lambda card: card.lines[0])
    oriented = oriented_properties(by_name)
    pressures = _take_pressures(by_name, shells)
    node_cards = _take_node_cards(by_name)
    grdset = next(iter(by_name.get("GRDSET", [])), None)
    default = integer_at(grdset, 1, sources, 0) if grdset else 0
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
        grdset=grdset,
        shells=shells,
        pressures=pressures,
        node_cards=node_cards,
        rigid=[
            (f"{card.name} {card.field(0)}", collect([card])[card.name].nodes)
            for name in _RIGID
            for card in by_name.get(name, [])
        ],
        oriented=oriented,
        systems=Systems(frames, grid_by_id, sources, default),
        references=collect([*others, *foreign]),
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
            if load and _names_any(load.elements, ids):
                taken.append(load)
            else:
                left.append(card)
        by_name[name] = left
    return taken


def _names_any(elements: Sequence[int], ids: set[int]) -> bool:
    if len(elements) > len(ids):
        return any(element in elements for element in ids)
    return not ids.isdisjoint(elements)


def _take_node_cards(by_name: dict[str, list[Card]]) -> list[NodeCard]:
    """Take the cards that say of nodes what others can have too out of the cards."""
    taken = []
    for name in NAMES:
        read = [(card, node_card(card)) for card in by_name.pop(name, [])]
        taken += [found for _, found in read if found]
        by_name[name] = [card for card, found in read if not found]
    return sorted(taken, key=lambda found: found.card.lines[0])


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
