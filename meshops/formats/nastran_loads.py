"""Even pressures on shells: loads that stay on a surface when it is meshed anew.

PLOAD4 and PLOAD2 act along the normal of an element, and no edit turns a normal round. Any other
load names its elements for good: they are locked.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from meshops.formats.fortran import canonical, real
from meshops.formats.ids import is_id
from meshops.formats.nastran_cards import Card, Form, card_lines


class Pressure(NamedTuple):
    """What a card says that loads shells evenly, apart from the ids of the shells; as typed."""

    name: str
    sid: str
    value: str
    form: Form

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal loads."""
        return (self.name, self.sid, canonical(self.value))

    def lines(self, elements: Iterable[int]) -> list[str]:
        """Write the cards that put this load on elements, one for each run of their ids."""
        rows = []
        for first, last in _runs(elements):
            thru = ["THRU", str(last)] if last > first else []
            if self.name == "PLOAD4":
                fields = [self.sid, str(first), self.value, "", "", "", *thru]
            else:
                fields = [self.sid, self.value, str(first), *thru]
            rows += card_lines(self.name, fields, self.form)
        return rows


class PressureCard(NamedTuple):
    """A load, the elements that it names, and the positions of its lines in the stream."""

    elements: Sequence[int]
    pressure: Pressure
    lines: list[int]


def pressure_card(card: Card) -> PressureCard | None:
    """Read a PLOAD4 or PLOAD2 that loads shells evenly; None for what says more than that."""
    if card.name == "PLOAD4":
        sid, first, value, *others = (card.field(i) for i in range(6))
        # P2 to P4 are P1 where they are blank
        is_even = all(canonical(text) == canonical(value) for text in others if text)
        elements = _elements([first, *card.fields[6:8]], singles=1)
        is_plain = is_even and not any(card.fields[8:])
    else:
        sid, value = card.field(0), card.field(1)
        elements = _elements(card.fields[2:], singles=6)
        is_plain = True
    if not (elements and is_plain and is_id(sid) and _is_real(value)):
        return None
    return PressureCard(elements, Pressure(card.name, sid, value, card.form), card.lines)


def _elements(fields: Sequence[str], *, singles: int) -> Sequence[int]:
    """Ids that fields name, as a range or at most ``singles`` one by one; else none."""
    words = [text for text in fields if text]
    if len(words) == 3 and words[1].upper() == "THRU" and is_id(words[0]) and is_id(words[2]):
        return range(int(words[0]), int(words[2]) + 1)
    if len(words) <= singles and all(map(is_id, words)):
        return tuple(dict.fromkeys(map(int, words)))
    return ()


def _runs(ids: Iterable[int]) -> Iterator[tuple[int, int]]:
    """First and last of each run of ids that follow each other."""
    for _, group in groupby(enumerate(ids), lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        yield run[0], run[-1]


def _is_real(text: str) -> bool:
    try:
        real(text)
    except ValueError:
        return False
    return bool(text)
