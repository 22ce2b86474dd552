"""What stands around the bulk data of a Nastran deck: includes, sections, case control."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from meshops.errors import InputError
from meshops.formats.ids import IdSet
from meshops.formats.sources import Sources, Statement

_INCLUDE = re.compile(r"\s*INCLUDE(?:\s*=\s*|\s+|(?=['\"]))(.*)", re.IGNORECASE | re.DOTALL)
_ASSIGN = re.compile(r"\s*ASSIGN\s+(\w+)\s*=\s*(?:'([^']*)'|([^\s,']+))", re.IGNORECASE)
_BEGIN = re.compile(r"\s*BEGIN\b", re.IGNORECASE)
_CEND = re.compile(r"\s*CEND\b", re.IGNORECASE)
_SET = re.compile(r"\s*SET\s+(\d+)\s*=\s*(.*)", re.IGNORECASE | re.DOTALL)
_REQUEST = re.compile(r"\s*(\w+)\s*(?:\([^)]*\))?\s*=\s*(\d+)\s*")
_NODE_OUTPUT = (
    *("DISP", "VECT", "PRES", "SPCF", "OLOA", "VELO", "ACCE", "MPCF", "GPFO", "THER", "SVEC"),
    *("SDIS", "SVEL", "SACC", "NLLO", "GPKE", "PART"),
)


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


def bulk_start(sources: Sources) -> tuple[int, int]:
    """Positions in the stream where case control and bulk data start.

    Raises
    ------
    InputError
        Where there is a second bulk section, as in decks of superelements.
    """
    case = bulk = 0
    for position, line in enumerate(sources.stream):
        initial = line.lstrip()[:1]
        if initial not in ("B", "b", "C", "c", "E", "e"):
            continue
        if line.lstrip()[:7].upper() == "ENDDATA":
            break
        if _CEND.match(line) and not bulk:
            case = position + 1
        elif _BEGIN.match(line):
            if bulk:
                raise InputError(
                    f"{sources.where(position)}: a second bulk section begins here; "
                    "put each superelement into a deck of its own."
                )
            bulk = position + 1
    return case, max(case, bulk)


def output_nodes(lines: Sequence[str]) -> IdSet:
    """Nodes in the case control SETs that an output request of nodes uses."""
    sets: dict[int, IdSet] = {}
    wanted = []
    for statement in _statements(lines):
        definition = _SET.match(statement)
        request = _REQUEST.fullmatch(statement)
        if definition:
            sets[int(definition[1])] = ids = IdSet()
            ids.read(re.split(r"[\s,]+", definition[2]))
        elif request and request[1].upper().startswith(_NODE_OUTPUT):
            wanted.append(int(request[2]))
    nodes = IdSet()
    for number in wanted:
        nodes.update(sets.get(number, IdSet()))
    return nodes


def _statements(lines: Sequence[str]) -> Iterator[str]:
    pending = ""
    for line in lines:
        text = pending + line.split("$")[0].strip()
        pending = f"{text} " if text.endswith(",") else ""
        if not pending:
            yield text


def _path(lines: Sequence[str], stop: int, text: str) -> tuple[str, int]:
    quote = text[:1]
    if quote not in ("'", '"'):
        return text.split("$")[0].strip(), stop
    text = text[1:]
    while quote not in text and stop < len(lines):
        text += lines[stop].strip()
        stop += 1
    return text.split(quote)[0].strip(), stop
