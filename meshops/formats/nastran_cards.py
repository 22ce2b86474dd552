"""Nastran bulk data: lines to cards and back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
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


class _Row(NamedTuple):
    head: str
    fields: list[str]
    marker: str
    form: Form


def lex(
    lines: Sequence[str], start: int, where: Callable[[int], str] = "line {}".format
) -> Iterator[Card]:
    """Cards of ``lines[start:]`` up to ENDDATA; ``where`` names the place of a line for messages.

    Raises
    ------
    InputError
        Where cards are replicated with ``=`` or a continuation is away from its card.
    """
    card: Card | None = None
    marker, width = "", 0
    for position in range(start, len(lines)):
        row = _split(lines[position])
        if row is None:
            continue
        if not row.head or row.head[0] in "+*":
            if card is None:
                continue
            _check_marker(marker, row.head, where(position) if marker else "")
            # lines are shorter than their fields allow; the next line begins a row of its own
            card.fields.extend([""] * (width - len(card.fields)))
            card.fields.extend(row.fields)
            card.lines.append(position)
            marker, width = row.marker, width + max(len(row.fields), row.form.per_line)
            continue
        if card is not None:
            yield card
        name = row.head.rstrip("* ").upper()
        if name.startswith("ENDDATA"):
            return
        if name.startswith("="):
            raise InputError(
                f"{where(position)}: replicated cards ('=') are not read; write them out."
            )
        card = Card(name, row.fields, [position], row.form)
        marker, width = row.marker, max(len(row.fields), row.form.per_line)
    if card is not None:
        yield card


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


def _split(line: str) -> _Row | None:
    text = line.rstrip("\r\n")
    if "$" in text:
        text = text[: text.index("$")]
    if "\t" in text:
        text = text.expandtabs(8)
    if not text or text.isspace():
        return None
    if "," in text[:10]:
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
    if rest and (not rest[0] or rest[0][0] in "+*" or not rest[0][0].isdecimal()):
        marker, rest = rest[0], rest[1:]
    # some writers put more than eight fields on a line; none is to be lost
    return _Row(head, fields + rest, marker, form)


def _check_marker(marker: str, head: str, place: str) -> None:
    parent, child = marker.lstrip("+*").strip(), head.lstrip("+*").strip()
    if parent and child and parent.upper() != child.upper():
        raise InputError(
            f"{place}: the continuation '{head}' does not follow its card, which ends in "
            f"'{marker}'; put it right after its card."
        )
