"""What the nodes of a Nastran deck have in common, by node; and new nodes that get it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from meshops.formats.ids import IdSet
from meshops.formats.nastran_cards import Card, Form, card_lines
from meshops.formats.nastran_case import SetDefinition, grown_set
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_memberships import Family, NodeCard, growth
from meshops.formats.node_attributes import Membership, Memberships
from meshops.formats.splice import Splice
from meshops.mesh import Bools, Ids

_ON_GRID = ("CD", "PS", "SEID")


class GridFields(NamedTuple):
    """Output system, permanent constraints and superelement of a GRID; '' where it has none."""

    system: str
    constraints: str
    superelement: str


def grid_fields(grid: Card, grdset: Card | None) -> GridFields:
    """Read the fields of a GRID after its coordinates; blank ones are as GRDSET says."""
    typed = [grid.field(i) or (grdset.field(i) if grdset else "") for i in (5, 6, 7)]
    return GridFields(*(text.lstrip("0+") for text in typed))


def node_memberships(
    contents: Contents, node_sets: Iterable[SetDefinition], node_ids: Ids
) -> list[Memberships]:
    """Memberships of each node, (N,)."""
    found: list[set[Membership]] = []
    systems = []
    for node in node_ids.tolist():
        fields = grid_fields(contents.grid_by_id[node], contents.grdset)
        system = int(fields.system or "0")
        systems.append(system)
        mine = {Membership(("PS", digit, system)) for digit in fields.constraints}
        if system:
            mine.add(Membership(("CD",), system))
        if fields.superelement:
            mine.add(Membership(("SEID",), fields.superelement))
        found.append(mine)
    row_of = {node: row for row, node in enumerate(node_ids.tolist())}

    def add(ids: IdSet, items_for: Callable[[int], list[Membership]]) -> None:
        rows = [row_of[i] for i in ids.singles if i in row_of]
        if ids.ranges or ids.everything:
            rows = np.flatnonzero(ids.mask(node_ids)).tolist()
        made = {system: items_for(system) for system in {systems[row] for row in rows}}
        for row in rows:
            found[row].update(made[systems[row]])

    for card in contents.node_cards:
        for entry in card.entries:
            add(entry.ids, partial(entry.memberships, card.family))
    for definition in node_sets:
        # results are asked for at these nodes, but for a set that means all of them
        every = bool(definition.ids.mask(node_ids).all())
        add(
            definition.ids,
            partial(_alike, Membership(("SET", definition.number), can_shrink=every)),
        )
    for name, ids in contents.rigid:
        item = Membership(("RIGID", name), can_grow=False, can_shrink=False)
        add(ids, partial(_alike, item))
    return [frozenset(mine) for mine in found]


def _alike(item: Membership, _system: int) -> list[Membership]:
    return [item]


def held_nodes(contents: Contents, node_ids: Ids) -> dict[str, Bools]:
    """Nodes that cannot be taken out of the cards that name them, (N,), by the names of these."""
    found: dict[str, Bools] = {}
    for card in contents.node_cards:
        if not card.can_shrink:
            mask = found.setdefault(card.card.name, np.zeros(len(node_ids), bool))
            for entry in card.entries:
                mask |= entry.ids.mask(node_ids)
    return found


def is_listed(item: Membership) -> bool:
    """Whether a membership is a place on a card that lists nodes, and not a field of the GRID."""
    return isinstance(item.kind, tuple) and item.kind[0] not in (*_ON_GRID, "SET")


def card_name(item: Membership) -> str:
    """Name a membership in the words of a deck, for a reader."""
    kind = item.kind if isinstance(item.kind, tuple) else (item.kind,)
    if kind[0] in _ON_GRID:
        return f"{kind[0]} on GRID"
    if kind[0] == "RIGID":
        return str(kind[1]).partition(" ")[0]
    return f"{kind[0]} {kind[1]}" if kind[0] == "SET" else str(kind[0])


def new_grid(node: int, place: Sequence[str], items: Memberships, grdset: Card | None) -> list[str]:
    """Write the GRID of a new node, with its system and coordinates and what it has of its own."""
    value = {item.kind[0]: str(item.value) for item in items if isinstance(item.kind, tuple)}
    digits = {
        str(item.kind[1]) for item in items if isinstance(item.kind, tuple) and item.kind[0] == "PS"
    }
    wanted = (value.get("CD", ""), "".join(sorted(digits)), value.get("SEID", ""))
    default = [grdset.field(i).lstrip("0+") if grdset else "" for i in (5, 6, 7)]
    # a blank would mean what GRDSET says
    typed = [
        "" if text == usual else text or "0" for text, usual in zip(wanted, default, strict=True)
    ]
    return card_lines("GRID", [str(node), *place, *typed], Form(wide=True))


def splice_node_cards(
    splice: Splice,
    contents: Contents,
    gone: Collection[int],
    new: Mapping[int, Memberships],
) -> None:
    """Take nodes that are gone out of their cards and give new ones, by id, cards of their own."""
    every = contents.grid_by_id.keys()
    for card in contents.node_cards if gone else ():
        lines = card.without(gone, every)
        if lines is not None:
            splice.replace(card.card.lines, lines)
    last: dict[Family, Card] = {card.family: card.card for card in contents.node_cards}
    ranges = [card for card in contents.node_cards if any(e.ids.ranges for e in card.entries)]
    said: dict[_Saying, list[int]] = defaultdict(list)
    for node, items in new.items():
        for saying in _sayings(items - _already(ranges, node, items), last):
            said[saying].append(node)
    for saying, nodes in said.items():
        like = last[saying.family]
        rows = growth(saying.family, saying.components, saying.values, nodes, like.form)
        splice.insert_after(like.lines[-1], rows)


def splice_sets(
    splice: Splice,
    stream: Sequence[str],
    sets: Iterable[SetDefinition],
    new: Mapping[int, Sequence[int]],
) -> None:
    """Let SETs of case control hold new ids too, which come by the numbers of the sets."""
    for definition in sets:
        ids = np.array(new.get(definition.number, []), np.int64)
        missing = ids[~definition.ids.mask(ids)].tolist()
        if missing:
            first = definition.lines[0]
            splice.replace([first], grown_set(stream[first], missing))


class _Saying(NamedTuple):
    family: Family
    components: str
    values: tuple[float, ...]


def _sayings(items: Iterable[Membership], families: Iterable[Family]) -> list[_Saying]:
    """Put the memberships together that one card can say."""
    components: dict[tuple[Family, tuple[float, ...]], str] = defaultdict(str)
    for item in items:
        kind, values = item.kind, item.value
        if not (isinstance(kind, tuple) and isinstance(values, tuple)):
            continue
        for family in families:
            if kind[: len(family)] == family:
                components[family, values] += "".join(kind[len(family) :][:1])
    return [
        _Saying(family, "".join(sorted(digits)), values)
        for (family, values), digits in components.items()
    ]


def _already(ranges: Iterable[NodeCard], node: int, items: Memberships) -> set[Membership]:
    """Find what a range of a card gives to the id of a new node."""
    id_ = np.array([node])
    system = next((item.value for item in items if item.kind == ("CD",)), 0)
    found: set[Membership] = set()
    for card in ranges:
        for entry in card.entries:
            if isinstance(system, int) and entry.ids.mask(id_)[0]:
                found.update(entry.memberships(card.family, system))
    return found
