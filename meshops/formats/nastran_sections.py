"""What stands around the bulk data of a Nastran deck: includes, sections, case control."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from meshops.formats.sources import Sources, Statement

_INCLUDE = re.compile(r"\s*INCLUDE(?:\s*=\s*|\s+|(?=['\"]))(.*)", re.IGNORECASE | re.DOTALL)
_ASSIGN = re.compile(r"\s*ASSIGN\s+(\w+)\s*=\s*(?:'([^']*)'|([^\s,']+))", re.IGNORECASE)
_BEGIN = re.compile(r"\s*BEGIN\b", re.IGNORECASE)
_CEND = re.compile(r"\s*CEND\b", re.IGNORECASE)
_PART = re.compile(r"\b(?:SUPER|AUXMODEL)\s*=\s*(\d+)", re.IGNORECASE)


def find_includes(lines: Sequence[str]) -> list[Statement]:
    """INCLUDE statements of a file up to ENDDATA; a quoted path may run over several lines."""
    found = []
    i = 0
    while i < len(lines):
        # looking at one letter first keeps long decks fast
        initial = lines[i].lstrip()[:1]
        if initial in ("E", "e") and lines[i].lstrip()[:7].upper() == "ENDDATA":
            break
        match = _INCLUDE.match(lines[i]) if initial in ("I", "i") else None
        stop = i + 1
        if match:
            written, stop = _path(lines, stop, match[1].strip())
            found.append(Statement(i, stop, written))
        i = stop
    return found


def find_symbols(lines: Sequence[str]) -> dict[str, str]:
    """Logical names that ASSIGN statements give to folders, in capitals."""
    found = {}
    for line in lines:
        match = _ASSIGN.match(line) if line.lstrip()[:1] in ("A", "a") else None
        if match:
            found[match[1].upper()] = match[2] or match[3]
        elif _BEGIN.match(line):
            break
    return found


def include_lines(_lines: Sequence[str], written: str) -> list[str]:
    """Write an INCLUDE statement, broken after slashes to stay within 72 columns."""
    rows = ["INCLUDE '"]
    for part in re.findall(r"[^/]*/|[^/]+", written):
        if len(rows[-1]) + len(part) > 70 and rows[-1] != "INCLUDE '":
            rows.append("")
        rows[-1] += part
    rows[-1] += "'"
    return rows


class Section(NamedTuple):
    """A bulk data section: the deck's own (0), or that of a superelement or auxiliary model."""

    number: int
    start: int
    stop: int


def bulk_sections(sources: Sources) -> tuple[int, list[Section]]:
    """Position in the stream where case control starts, and the sections of bulk data.

    Ids are those of a section; what begins without a number of its own belongs to the deck's.
    """
    case = start = number = 0
    begun = False
    sections: list[Section] = []
    end = len(sources.stream)
    for position, line in enumerate(sources.stream):
        initial = line.lstrip()[:1]
        if initial not in ("B", "b", "C", "c", "E", "e"):
            continue
        if line.lstrip()[:7].upper() == "ENDDATA":
            end = position
            break
        if _CEND.match(line) and not begun:
            case = start = position + 1
        elif _BEGIN.match(line):
            own = _PART.search(line.split("$")[0])
            # what is before the first BEGIN is case control, but for a deck of parts without any
            if begun or (own and not case):
                sections.append(Section(number, start, position))
            number, start, begun = int(own[1]) if own else 0, position + 1, True
    sections.append(Section(number, start, end))
    return case, sections


def statements(lines: Sequence[str]) -> Iterator[tuple[str, list[int]]]:
    """Statements of case control, those that go on after a comma put together, and their lines."""
    pending = ""
    rows: list[int] = []
    for row, line in enumerate(lines):
        text = pending + line.split("$")[0].strip()
        rows.append(row)
        pending = f"{text} " if text.endswith(",") else ""
        if not pending:
            if text:
                yield text, rows
            rows = []


def _path(lines: Sequence[str], stop: int, text: str) -> tuple[str, int]:
    quote = text[:1]
    if quote not in ("'", '"'):
        return text.split("$")[0].strip(), stop
    text = text[1:]
    while quote not in text and stop < len(lines):
        text += lines[stop].strip()
        stop += 1
    return text.split(quote)[0].strip(), stop
