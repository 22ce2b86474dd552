"""Abaqus input: lines to keyword blocks, data lines to records."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from meshops.formats.ids import IdSet, is_id
from meshops.formats.sources import Statement

_OF_AN_INSTANCE = re.compile(r'(?:"[^"]*"|[A-Za-z_][^.,]*)\.(\d+)')
_INPUT = re.compile(r"(?i)(\bINPUT\s*=\s*)(\"[^\"]*\"|[^,]*)")


class Block(NamedTuple):
    """A keyword with its data lines.

    Attributes
    ----------
    keyword : str
        In capitals, without the star.
    parameters : mapping
        Names and values in capitals; a parameter without a value has ''.
    header, data : list of int
        Positions of its keyword lines and data lines in the stream, comments left out.
    scope : str
        The part or instance, or 'ASSEMBLY', that it stands in; '' outside of all.
    """

    keyword: str
    parameters: Mapping[str, str]
    header: list[int]
    data: list[int]
    scope: str

    @property
    def last(self) -> int:
        """Position of its last line."""
        return (self.data or self.header)[-1]


class Record(NamedTuple):
    """The values of one node or element, and the positions of their lines."""

    values: list[str]
    lines: list[int]


def blocks(lines: Sequence[str]) -> list[Block]:
    """Keyword blocks of a stream of lines; lines before the first keyword are passed over."""
    found: list[Block] = []
    scopes: list[str] = [""]
    i = 0
    while i < len(lines):
        line = lines[i]
        if not line.startswith("*"):
            if found and line.strip():
                found[-1].data.append(i)
            i += 1
            continue
        if line.startswith("**"):
            i += 1
            continue
        stop, keyword, parameters = _header(lines, i)
        if keyword in ("PART", "INSTANCE", "ASSEMBLY"):
            name = parameters.get("NAME", "")
            scopes.append(keyword if keyword == "ASSEMBLY" else f"{keyword} {name}")
        found.append(Block(keyword, parameters, list(range(i, stop)), [], scopes[-1]))
        if keyword in ("END PART", "END INSTANCE", "END ASSEMBLY") and len(scopes) > 1:
            scopes.pop()
        i = stop
    return found


def find_includes(lines: Sequence[str]) -> list[Statement]:
    """Statements of ``*INCLUDE, INPUT=`` and of other keywords with ``INPUT=``."""
    found = []
    for i, line in enumerate(lines):
        if not line.startswith("*") or line.startswith("**"):
            continue
        stop, keyword, parameters = _header(lines, i)
        if "INPUT" in parameters:
            match = _INPUT.search("".join(lines[i:stop]))
            written = match[2].strip().strip('"') if match else ""
            found.append(Statement(i, stop, written, stays=keyword != "INCLUDE"))
    return found


def include_lines(lines: Sequence[str], written: str) -> list[str]:
    """Write the keyword lines again with another path after ``INPUT=``."""
    text = "".join(lines).rstrip("\r\n")
    return _INPUT.sub(lambda match: match[1] + written, text, count=1).splitlines()


def records(block: Block, lines: Sequence[str], count: int = 0) -> Iterator[Record]:
    """Split a block into records of ``count`` values, or (0) at lines that end in no comma."""
    values: list[str] = []
    positions: list[int] = []
    for position in block.data:
        tokens = [token.strip() for token in lines[position].split(",")]
        goes_on = not tokens[-1]
        values += tokens[:-1] if goes_on else tokens
        positions.append(position)
        if len(values) >= count if count else not goes_on:
            yield Record(values, positions)
            values, positions = [], []
    if values:
        yield Record(values, positions)


def id_list(block: Block, lines: Sequence[str]) -> IdSet:
    """Ids of a *NSET or *ELSET block, with GENERATE or without."""
    ids = IdSet()
    for position in block.data:
        tokens = [plain_id(token) for token in lines[position].split(",")]
        if "GENERATE" not in block.parameters:
            ids.read(tokens)
            continue
        numbers = [int(token) for token in tokens if is_id(token)]
        if len(numbers) >= 2:
            step = numbers[2] if len(numbers) > 2 else 1
            ids.ranges.add((numbers[0], numbers[1], max(step, 1)))
    return ids


def plain_id(token: str) -> str:
    """'17' of 'Part-1-1.17'; other tokens as they are, stripped."""
    text = token.strip()
    match = _OF_AN_INSTANCE.fullmatch(text)
    return match[1] if match else text


def _header(lines: Sequence[str], i: int) -> tuple[int, str, dict[str, str]]:
    """End, keyword and parameters of the keyword line ``i``, which a trailing comma continues."""
    stop = i + 1
    text = lines[i].strip()
    while text.endswith(",") and stop < len(lines) and not lines[stop].startswith("*"):
        text += lines[stop].strip()
        stop += 1
    keyword, *rest = text[1:].split(",")
    parameters = {}
    for item in rest:
        name, _, value = item.partition("=")
        parameters[_plain(name)] = value.strip().strip('"').upper()
    return stop, _plain(keyword), parameters


def _plain(name: str) -> str:
    return " ".join(name.upper().split())
