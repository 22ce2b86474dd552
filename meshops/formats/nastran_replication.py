"""Replicated cards: '=', '*(1)', '==' and '=(8)', written out.

A field '=' repeats that of the card before, '*(1)' adds to it, '==' repeats all that is left, and a
line '=(8)' makes eight more of the last line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from meshops.errors import InputError
from meshops.formats.fortran import real, real_field
from meshops.formats.nastran_cards import Form, card_lines, split_line
from meshops.formats.sources import Sources

MOST = 100_000
"""Cards of one replication: more are a slip of the hand, and would take for ever."""

_TIMES = re.compile(r"=\s*\(?\s*(\d+)\s*\)?")
_STEP = re.compile(r"\*\s*\(?\s*([^()\s]+)\s*\)?")


class _Model(NamedTuple):
    """The card that the next line repeats, and the line that made it of the one before."""

    name: str
    fields: list[str]
    form: Form
    line: Sequence[str] = ()


def write_out(sources: Sources, start: int) -> Sources:
    """Put what replicating lines from position ``start`` on make into the stream.

    A card and all that is made of it are a group of ``Sources.groups``.

    Raises
    ------
    InputError
        Where a line repeats no card, one of several lines, or no number.
    """
    stream = sources.stream
    if not any(line.lstrip()[:1] == "=" for line in stream[start:]):
        return sources
    lines, places = stream[:start], sources.places[:start]
    groups: list[list[int]] = []
    model: _Model | None = None
    for position in range(start, len(stream)):
        row = split_line(stream[position])
        if row is None or row.head[:1] != "=":
            lines.append(stream[position])
            places.append(sources.places[position])
            if row is not None:
                is_card = row.head[:1] not in ("", "+", "*")
                name = row.head.rstrip("* ").upper()
                model = _Model(name, row.fields, row.form) if is_card else None
                base = len(lines) - 1
            continue
        place = sources.where(position)
        if model is None:
            raise InputError(
                f"{place}: '{row.head}' repeats no card of one line; write its cards out."
            )
        times = _TIMES.fullmatch(row.head)
        if not times and row.head != "=":
            raise InputError(f"{place}: '{row.head}' is no replication; write its cards out.")
        if times and (len(times[1]) > len(str(MOST)) or int(times[1]) > MOST):
            raise InputError(
                f"{place}: '{row.head}' makes more than {MOST:,} cards; correct it, or write its "
                "cards out."
            )
        line = model.line if times else row.fields
        if not groups or groups[-1][0] != base:
            groups.append([base])
        for _ in range(int(times[1]) if times else 1):
            model = _repeated(model, line, place)
            rows = card_lines(model.name, model.fields, model.form)
            groups[-1] += range(len(lines), len(lines) + len(rows))
            lines += [f"{text}{_eol(stream[position])}" for text in rows]
            places += [sources.places[position]] * len(rows)
    return replace(sources, stream=lines, places=places, groups=groups)


def _repeated(model: _Model, line: Sequence[str], place: str) -> _Model:
    fields: list[str] = []
    for i in range(max(len(line), len(model.fields))):
        text = line[i] if i < len(line) else ""
        before = model.fields[i] if i < len(model.fields) else ""
        if text == "==":
            fields += model.fields[i:]
            break
        step = _STEP.fullmatch(text)
        fields.append(_stepped(before, step[1], model.form, place) if step else text)
        if text == "=":
            fields[-1] = before
    return _Model(model.name, fields, model.form, line)


def _stepped(text: str, step: str, form: Form, place: str) -> str:
    try:
        if "." not in step and "." not in text:
            return str(int(text or "0") + int(step))
        return real_field(real(text) + real(step), 16 if form.wide else 8)
    except ValueError:
        raise InputError(f"{place}: '{step}' cannot be added to '{text}'; correct it.") from None


def _eol(line: str) -> str:
    return line[len(line.rstrip("\r\n")) :] or "\n"
