"""Pressures on shells: loads that stay on a surface when it is meshed anew.

PLOAD4 and PLOAD2 act on the area of an element, along its normal, which no edit turns round, or in
a direction of their own. Any other load names its elements for good: they are locked.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import NamedTuple

from meshops.formats.fortran import canonical, real, real_field
from meshops.formats.ids import is_id
from meshops.formats.nastran_cards import Card, Form, card_lines

Layer = tuple[str, ...]
"""What loads have in common that add up to one field of pressure: card, SID and direction."""


class Pressure(NamedTuple):
    """What a card says that loads shells, apart from the ids of the shells; as typed.

    Attributes
    ----------
    values : tuple of one or four str
        At all corners, or at each of them.
    direction : tuple of no or four str
        CID, N1, N2 and N3 where the load does not act along the normal.
    """

    name: str
    sid: str
    values: tuple[str, ...]
    form: Form
    direction: tuple[str, ...] = ()

    @property
    def value(self) -> str:
        """The pressure at the first corner."""
        return self.values[0]

    @property
    def layer(self) -> Layer:
        """Equal for loads that differ in their values alone."""
        return (self.name, self.sid, *(canonical(text, zero="") for text in self.direction))

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal loads."""
        return (*self.layer, "", *map(canonical, self.values))

    def with_values(self, values: Sequence[float]) -> Pressure:
        """Load like this one with other pressures, one or four; equal ones are typed once."""
        typed = tuple(real_field(value, 16 if self.form.wide else 8) for value in values)
        return self._replace(values=typed[:1] if len(set(typed)) == 1 else typed)

    def lines(self, elements: Iterable[int]) -> list[str]:
        """Write the cards that put this load on elements, in as few lines as may be."""
        if self.name == "PLOAD4":
            return [line for run in _runs(elements) for line in self._pload4(*run)]
        runs = list(_runs(elements))
        singles = [str(i) for first, last in runs if last < first + 2 for i in (first, last)]
        words = [["THRU"], *([str(first), "THRU", str(last)] for first, last in runs)]
        ranges = [item for item in words[1:] if int(item[2]) >= int(item[0]) + 2]
        singles = list(dict.fromkeys(singles))
        lists = [singles[i : i + 6] for i in range(0, len(singles), 6)]
        return [
            line
            for item in (*lists, *ranges)
            for line in card_lines(self.name, [self.sid, self.value, *item], self.form)
        ]

    def _pload4(self, first: int, last: int) -> list[str]:
        thru = ["THRU", str(last)] if last > first else ["", ""]
        values = [*self.values, "", "", ""][:4]
        fields = [self.sid, str(first), *values, *thru, *self.direction]
        return card_lines(self.name, fields, self.form)


class PressureCard(NamedTuple):
    """A load, the elements that it names, and the positions of its lines in the stream."""

    elements: Sequence[int]
    pressure: Pressure
    lines: list[int]

    def left(self, gone: Iterable[int]) -> list[str]:
        """Write the card again without some of its elements."""
        if not isinstance(self.elements, range):
            without = set(gone)
            return self.pressure.lines(e for e in self.elements if e not in without)
        rows = []
        first = self.elements.start
        for element in [*sorted(gone), self.elements.stop]:
            rows += self.pressure.lines(_ends(first, element - 1))
            first = element + 1
        return rows


def pressure_card(card: Card) -> PressureCard | None:
    """Read a PLOAD4 or PLOAD2 that acts on areas of shells; None for what says more than that."""
    if card.name == "PLOAD4":
        sid, first, *values = (card.field(i) for i in range(6))
        # P2 to P4 are P1 where they are blank
        values = [text or values[0] for text in values]
        elements = _elements([first, *card.fields[6:8]], singles=1)
        direction = tuple(card.field(i) for i in range(8, 12))
        is_area = card.field(12).upper() in ("", "SURF") and card.field(13).upper() in ("", "NORM")
        is_plain = is_area and not any(card.fields[14:])
    else:
        sid, values = card.field(0), [card.field(1)]
        elements = _elements(card.fields[2:], singles=6)
        direction, is_plain = (), True
    if not (elements and is_plain and is_id(sid) and all(map(_is_real, values))):
        return None
    if any(direction) and not all(_is_real(text or "0.") for text in direction[1:]):
        return None
    if len(set(map(canonical, values))) == 1:
        values = values[:1]
    has_direction = any(real(text) for text in direction[1:])
    load = Pressure(card.name, sid, tuple(values), card.form, direction if has_direction else ())
    return PressureCard(elements, load, card.lines)


def _elements(fields: Sequence[str], *, singles: int) -> Sequence[int]:
    """Ids that fields name, as a range or at most ``singles`` one by one; else none."""
    words = [text for text in fields if text]
    if len(words) == 3 and words[1].upper() == "THRU" and is_id(words[0]) and is_id(words[2]):
        return range(int(words[0]), int(words[2]) + 1)
    if len(words) <= singles and all(map(is_id, words)):
        return tuple(dict.fromkeys(map(int, words)))
    return ()


def _runs(ids: Iterable[int]) -> list[tuple[int, int]]:
    """First and last of each run of ids that follow each other."""
    if isinstance(ids, range):
        return [(ids.start, ids.stop - 1)] if ids else []
    runs = []
    for _, group in groupby(enumerate(ids), lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        runs.append((run[0], run[-1]))
    return runs


def _ends(first: int, last: int) -> range:
    return range(first, last + 1)


def _is_real(text: str) -> bool:
    try:
        real(text)
    except ValueError:
        return False
    return bool(text)
