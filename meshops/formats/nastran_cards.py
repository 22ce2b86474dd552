"""Nastran bulk data: lines to cards and back."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from meshops.errors import InputError


class Form(NamedTuple):
    """How a card is typed: with commas or in columns, with 16 or 8 characters a field."""

    free: bool = False
    wide: bool = False

    @property
    def per_line(self) -> int:
        """Number of fields on a line."""
        return 4 if self.wide else 8


class Card(NamedTuple):
    """One bulk data card.

    Attributes
    ----------
    name : str
        In capitals, without the ``*`` of wide fields.
    fields : list of str
        What follows the name, eight fields a row (four in wide rows), stripped; continuation
        markers are left out.
    lines : list of int
        Positions of its lines in the stream; comments may stand between them.
    form : Form
        Of its first line.
    """

    name: str
    fields: list[str]
    lines: list[int]
    form: Form

    def field(self, i: int) -> str:
        """Field ``i``, counted from 0 after the name; blank where the card is shorter."""
        return self.fields[i] if i < len(self.fields) else ""


_SMALL, _WIDE = Form(), Form(wide=True)
_FREE = re.compile(r"\s*[A-Za-z]\w*\*?\s*,")
_WORDS = frozenset("THRU BY EXCEPT ALL ENDT SKIP UM ALPHA".split())  # noqa: SIM905 - words
_BLANK_BEGINS_LINE = frozenset(("MPC", "CQUAD4", "CTRIA3", "CQUADR", "CTRIAR"))


class _Row(NamedTuple):
    head: str
    fields: list[str]
    marker: str
    form: Form


def lex(
    lines: Sequence[str],
    start: int,
    where: Callable[[int], str] = "line {}".format,
    *,
    stop: int | None = None,
) -> list[Card]:
    """Cards of ``lines[start:stop]`` up to ENDDATA; ``where`` names a line for messages.

    A continuation that bears a name may stand anywhere, since a deck may be sorted; it belongs to
    the card whose line ends in that name.

    Raises
    ------
    InputError
        Where a continuation belongs to no card.
    """
    found: list[_Rows] = []
    strays: list[_Rows] = []
    waiting: dict[str, _Rows] = {}
    current: _Rows | None = None
    for position in range(start, len(lines) if stop is None else stop):
        row = split_line(lines[position])
        if row is None:
            continue
        name = row.head.rstrip("* ").upper()
        if name and name[0] not in "+*":
            if name.startswith("ENDDATA"):
                break
            current = _Rows(Card(name, [], [], row.form))
            found.append(current)
        elif current is None or not current.is_followed_by(row):
            if not _continued_name(row.head):
                continue
            current = _Rows(Card(row.head, [], [], row.form), current)
            strays.append(current)
        current.append(position, row, waiting)
    _bring_back(strays, waiting, where)
    return [rows.card for rows in found]


class _Rows:
    """Lines of a card that follow each other, and the marker that the last one ends in.

    Continuations that do not follow their card are rows without one, until it is found.
    """

    def __init__(self, card: Card, before: _Rows | None = None) -> None:
        self.card = card
        self.before = before
        self.owner: _Rows = self
        self.is_card = card.name[:1] not in ("+", "*")
        self.marker = ""
        self.width = 0

    def is_followed_by(self, row: _Row) -> bool:
        child = _continued_name(row.head)
        return not child or child in _names(self.marker)

    def append(self, position: int, row: _Row, waiting: dict[str, _Rows]) -> None:
        width = max(len(row.fields), row.form.per_line)
        self._add(row.fields, [position], width, row.marker, waiting)

    def join(self, other: _Rows, waiting: dict[str, _Rows]) -> None:
        other.owner = self
        self._add(other.card.fields, other.card.lines, other.width, other.marker, waiting)

    def _add(
        self,
        fields: Sequence[str],
        lines: Sequence[int],
        width: int,
        marker: str,
        waiting: dict[str, _Rows],
    ) -> None:
        # lines are shorter than their fields allow; the next line begins a row of its own
        self.card.fields.extend([""] * (self.width - len(self.card.fields)))
        self.card.fields.extend(fields)
        self.card.lines.extend(lines)
        self.width += width
        self.marker = marker
        for name in _names(marker):
            waiting[name] = self


def _bring_back(
    strays: list[_Rows], waiting: dict[str, _Rows], where: Callable[[int], str]
) -> None:
    """Put continuations to the cards that end in their names, or else to those before them."""
    while strays:
        left = []
        for rows in strays:
            owner = waiting.get(_continued_name(rows.card.name))
            if owner is not None and owner.is_card:
                owner.join(rows, waiting)
            else:
                left.append(rows)
        if len(left) == len(strays):
            rows = left.pop(0)
            before = _owner(rows.before)
            if before is not None and (not before.is_card or before.marker.strip("+* ")):
                raise InputError(
                    f"{where(rows.card.lines[0])}: the continuation '{rows.card.name}' does not "
                    "follow its card, and no card ends in its name; put it right after its card."
                )
            # what is before all cards continues something that is not bulk data
            if before is not None:
                before.join(rows, waiting)
        strays = left


def _owner(rows: _Rows | None) -> _Rows | None:
    while rows is not None and rows.owner is not rows:
        rows = rows.owner
    return rows


def _names(marker: str) -> set[str]:
    """Name a continuation of a line that ends in ``marker`` by what follows its first character.

    '+A' is followed by '+A'; of an old 'CORD1' the first character only becomes a '+' too.
    """
    return {marker.lstrip("+*").strip().upper(), marker[1:].strip().upper()} - {""}


def _continued_name(head: str) -> str:
    return head[1:].strip().upper()


def card_lines(name: str, fields: Sequence[str], form: Form) -> list[str]:
    """Write a card; fields become wide where one has more than eight characters.

    Continuation markers are left blank, so that they cannot meet a marker of the deck.
    """
    last = max((i + 1 for i, text in enumerate(fields) if text), default=0)
    wide = form.wide or any(len(text) > 8 for text in fields)
    count = Form(wide=wide).per_line
    # a card in wide fields has an even number of lines
    used = [*fields[:last], *[""] * (-last % 8 if wide else 0)]
    rows = [used[i : i + count] for i in range(0, len(used), count)]
    heads = [name + "*" * wide, *(("*" if wide else "+") for _ in rows[1:])]
    if form.free:
        lines = [",".join([head, *row]) for head, row in zip(heads, rows, strict=True)]
        return [*(f"{line},{heads[-1]}" for line in lines[:-1]), lines[-1].rstrip(",")]
    width = 16 if wide else 8
    return [
        (head.ljust(8) + "".join(text.rjust(width) for text in row)).rstrip()
        for head, row in zip(heads, rows, strict=True)
    ]


def split_line(line: str) -> _Row | None:
    """Head, fields and marker of a line; None for a comment or a blank one."""
    text = line.rstrip("\r\n")
    if "$" in text:
        text = text[: text.index("$")]
    if "\t" in text:
        text = text.expandtabs(8)
    if not text or text.isspace():
        return None
    if "," in text and ("," in text[:10] or _FREE.match(text)):
        return _split_free(text)
    head = text[:8].strip()
    marker = text[72:80].strip()
    width = 16 if "*" in head else 8
    fields = [text[i : i + width].strip() for i in range(8, min(len(text), 72), width)]
    return _Row(head, fields, marker, _WIDE if width == 16 else _SMALL)


def _split_free(text: str) -> _Row:
    head, *tokens = (token.strip() for token in text.split(","))
    wide = "*" in head
    form = Form(free=True, wide=wide)
    count = form.per_line
    fields, rest = tokens[:count], tokens[count:]
    marker = ""
    if rest and _is_marker(rest, head.rstrip("* ").upper()):
        marker, rest = rest[0], rest[1:]
    # some writers put more than eight fields on a line; none is to be lost
    return _Row(head, fields + rest, marker, form)


def _is_marker(rest: Sequence[str], name: str) -> bool:
    """Whether the first of the fields beyond those of a line is a marker, or more data.

    A marker is blank or begins with a plus, a star or a letter. The second line of some cards
    begins with a blank; where just one stands between two numbers, it is that one.
    """
    first = rest[0].upper()
    if not first:
        return name not in _BLANK_BEGINS_LINE or len(rest) == 1 or not rest[1]
    return first not in _WORDS and (first[0] in "+*" or first[0].isalpha())
