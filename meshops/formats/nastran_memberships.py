"""What a Nastran deck says of nodes that new nodes can have too: supports, sets, temperatures.

A card of this kind lists nodes one by one, in a range, or in groups with a value each. A node that
vanishes is taken out of its card; a new one gets a further card of the same kind.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from itertools import chain
from typing import NamedTuple

from meshops.formats.fortran import real, real_field
from meshops.formats.ids import IdSet, is_id
from meshops.formats.nastran_cards import Card, Form, card_lines
from meshops.formats.node_attributes import Membership

Family = tuple[str, ...]
"""Name and first fields of the cards that say the same: ``("SPC", "1")``."""


class _Groups(NamedTuple):
    """Cards of a lead and groups G C D: where the values are in a group, and how many groups."""

    lead: int
    size: int
    components: int | None
    values: tuple[int, ...]
    times: int


_GROUPS = {
    "SPC": _Groups(1, 3, 1, (2,), 2),
    "SPCD": _Groups(1, 3, 1, (2,), 2),
    "TEMP": _Groups(1, 2, None, (1,), 3),
    "TIC": _Groups(1, 4, 1, (2, 3), 1),
    "USET": _Groups(1, 2, 1, (), 3),
    **dict.fromkeys(
        ("ASET", "BSET", "CSET", "OMIT", "QSET", "SPCOFF", "BNDFIX", "BNDFREE"),
        _Groups(0, 2, 1, (), 4),
    ),
}
_LISTS = {
    "SPC1": ("SPC", 1),
    "USET1": ("USET", 1),
    "SESET": ("SESET", 1),
    **{f"{name}1": (name, 0) for name, groups in _GROUPS.items() if groups.lead == 0},
}
_MAY_BE_ABSENT = ("SPC1",)
"""Cards whose ranges may hold ids of no node."""

NAMES = frozenset((*_GROUPS, *_LISTS))


class Entry(NamedTuple):
    """What a card says of some nodes: the components that it means, one digit each, and values."""

    ids: IdSet
    components: str
    values: tuple[float, ...]

    def memberships(self, family: Family, system: int) -> list[Membership]:
        """Memberships of a node whose output system is ``system``, which components depend on."""
        said = [(*family, digit, system) for digit in self.components] or [family]
        return [Membership(kind, self.values) for kind in said]


class NodeCard(NamedTuple):
    """A card that says something of the nodes that it names.

    ``can_shrink`` is false where a node cannot be taken out of it.
    """

    card: Card
    family: Family
    entries: list[Entry]
    can_shrink: bool

    def without(self, gone: Collection[int], every: Collection[int]) -> list[str] | None:
        """Lines of the card without some nodes; None where it may stay as it is.

        ``every`` holds all nodes of the deck: a range that has held others, too, may hold them.
        """
        ids = [entry.ids for entry in self.entries]
        if any(mine.ranges for mine in ids):
            return self._without_in_ranges(gone, every)
        if set().union(*(mine.singles for mine in ids)).isdisjoint(gone):
            return None
        name, fields, layout = self.card.name, self.card.fields, _GROUPS.get(self.card.name)
        lead = layout.lead if layout else _lead_of_list(self.card)
        size = layout.size if layout else 1
        groups = [[*fields[i : i + size]] for i in range(lead, len(fields), size)]
        kept = [group for group in groups if group[0] and int(group[0]) not in gone]
        whole = [[*group, *[""] * size][:size] for group in kept]
        return card_lines(name, [*fields[:lead], *chain(*whole)], self.card.form) if kept else []

    def _without_in_ranges(self, gone: Collection[int], every: Collection[int]) -> list[str] | None:
        (ids,) = (entry.ids for entry in self.entries)
        if len(ids.ranges) > 1 or ids.singles - {end for r in ids.ranges for end in r[:2]}:
            return None
        ((first, last, _),) = ids.ranges
        out = sorted(node for node in gone if first <= node <= last)
        if not out or last - first >= len(every) or any(i not in every for i in range(first, last)):
            return None
        lead = self.card.fields[: _lead_of_list(self.card)]
        kept = [node for node in range(first, last + 1) if node not in gone]
        return [
            line
            for words in _range_or_list(kept)
            for line in card_lines(self.card.name, [*lead, *words], self.card.form)
        ]


def node_card(card: Card) -> NodeCard | None:
    """Read a card of ``NAMES``; None where it says something that is not understood."""
    if card.name in _LISTS:
        base, lead = _LISTS[card.name]
        start = _lead_of_list(card)
        words = [text for text in card.fields[start:] if text]
        ids = IdSet()
        ids.read(words)
        has_range = bool(ids.ranges)
        plain = all(is_id(word) or word.upper() == "THRU" for word in words)
        components = card.field(lead) if start > lead else ""
        if not (words and plain and (components.isdecimal() or start == lead)):
            return None
        family = (base, *card.fields[:lead])
        values: tuple[float, ...] = (0.0,) if base == "SPC" else ()
        entry = Entry(ids, components.strip("0"), values)
        can_shrink = not has_range or card.name in _MAY_BE_ABSENT
        return NodeCard(card, family, [entry], can_shrink)
    layout = _GROUPS[card.name]
    entries = []
    for k in range(layout.times):
        group = [card.field(layout.lead + k * layout.size + i) for i in range(layout.size)]
        if not any(group):
            continue
        components = group[layout.components] if layout.components is not None else ""
        try:
            values = tuple(real(group[i]) for i in layout.values)
        except ValueError:
            return None
        if not is_id(group[0]) or (components and not components.isdecimal()):
            return None
        entries.append(Entry(IdSet({int(group[0])}), components.strip("0"), values))
    if any(card.fields[layout.lead + layout.times * layout.size :]):
        return None
    return NodeCard(card, (card.name, *card.fields[: layout.lead]), entries, can_shrink=True)


def growth(
    family: Family, components: str, values: tuple[float, ...], nodes: Sequence[int], form: Form
) -> list[str]:
    """Write further cards that say of some nodes what others of a family say of theirs."""
    name, *head = family
    typed = [real_field(value, 16 if form.wide else 8) for value in values]
    is_list = name in ("SESET", "USET") or (name == "SPC" and not any(values))
    if is_list or _GROUPS[name].lead == 0:
        lead = [*head, components] if name != "SESET" else head
        card = name if name == "SESET" else f"{name}1"
        return [
            line
            for words in _range_or_list(nodes)
            for line in card_lines(card, [*lead, *words], form)
        ]
    layout = _GROUPS[name]
    digits = [components] if layout.components is not None else []
    groups = [[str(node), *digits, *typed] for node in nodes]
    return [
        line
        for i in range(0, len(groups), layout.times)
        for line in card_lines(name, [*head, *chain(*groups[i : i + layout.times])], form)
    ]


def _lead_of_list(card: Card) -> int:
    """Count the fields before the list: identification and, but for SESET, components."""
    return _LISTS[card.name][1] + (card.name != "SESET")


def _range_or_list(nodes: Sequence[int]) -> Iterable[list[str]]:
    """Ranges of three and more as cards of their own, all others in one list."""
    runs: list[list[int]] = []
    for node in sorted(nodes):
        if runs and node == runs[-1][-1] + 1:
            runs[-1].append(node)
        else:
            runs.append([node])
    singles = [str(node) for run in runs if len(run) < 3 for node in run]
    ranges = [[str(run[0]), "THRU", str(run[-1])] for run in runs if len(run) >= 3]
    return [*([singles] if singles else []), *ranges]
