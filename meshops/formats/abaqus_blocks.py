"""Abaqus input: lines to keyword blocks, data lines to records."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from meshops.formats.ids import IdSet, is_id
from meshops.formats.sources import Statement

READ_AS_DECK = frozenset(
    {
        *("INCLUDE", "NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "MPC", "EQUATION", "BOUNDARY"),
        *("CLOAD", "CFLUX", "DLOAD", "DFLUX", "FILM", "RADIATE", "TEMPERATURE", "FIELD"),
        *("INITIAL CONDITIONS", "NODAL THICKNESS", "NORMAL", "DISTRIBUTION"),
    }
)
"""Keywords whose INPUT= names lines of a deck; that of others is a result or a table."""

_INPUT = re.compile(r"(?i)(\bINPUT\s*=\s*)(\"[^\"]*\"|[^,]*)")


class Block(NamedTuple):
    """A keyword with its data lines.

    Attributes
    ----------
    keyword : str
        In capitals, without the star.
    parameters : mapping
        Names, in capitals, and the keys of their values (``name_key``); a parameter without a value
        has ''.
    written : mapping
        The values as they stand in the deck.
    header, data : list of int
        Positions of its keyword lines and data lines in the stream, comments left out.
    scope : str
        The part or instance, or 'ASSEMBLY', that it stands in; '' outside of all.
    step : int
        The step that it stands in, counted from 1; 0 before the first.
    """

    keyword: str
    parameters: Mapping[str, str]
    written: Mapping[str, str]
    header: list[int]
    data: list[int]
    scope: str
    step: int

    @property
    def last(self) -> int:
        """Position of its last line."""
        return (self.data or self.header)[-1]

    @property
    def end(self) -> int:
        """Position after which another keyword can stand: data of a file of its own go on there."""
        return self.header[-1] if "INPUT" in self.parameters else self.last

    @property
    def is_generated(self) -> bool:
        """Whether its lines are first, last and step of ranges."""
        return any(len(name) > 2 and "GENERATE".startswith(name) for name in self.parameters)


class Record(NamedTuple):
    """The values of one node or element, and the positions of their lines."""

    values: list[str]
    lines: list[int]


def name_key(text: str) -> str:
    """Make the texts of one name equal: capitals without blanks, but as it is between quotes."""
    pieces = text.strip().split('"')
    pieces[::2] = ["".join(piece.split()).upper() for piece in pieces[::2]]
    return '"'.join(pieces)


def fields(line: str) -> list[str]:
    """Split a line at the commas that stand outside of quotes, and strip each field."""
    if '"' not in line:
        return [field.strip() for field in line.split(",")]
    found, current = [], ""
    for i, piece in enumerate(line.strip().split('"')):
        if i % 2:
            current += f'"{piece}"'
            continue
        first, *rest = piece.split(",")
        current += first
        for field in rest:
            found.append(current.strip())
            current = field
    return [*found, current.strip()]


def blocks(lines: Sequence[str]) -> list[Block]:
    """Keyword blocks of a stream of lines; lines before the first keyword are passed over."""
    found: list[Block] = []
    scopes: list[str] = [""]
    step = 0
    i = 0
    while i < len(lines):
        text = lines[i].lstrip()
        if not text.startswith("*"):
            if found and text:
                found[-1].data.append(i)
            i += 1
            continue
        if text.startswith("**"):
            i += 1
            continue
        header, keyword, written = _header(lines, i)
        parameters = {name: name_key(value) for name, value in written.items()}
        if keyword in ("PART", "INSTANCE", "ASSEMBLY"):
            name = parameters.get("NAME", "")
            scopes.append(keyword if keyword == "ASSEMBLY" else f"{keyword} {name}")
        step += keyword == "STEP"
        found.append(Block(keyword, parameters, written, header, [], scopes[-1], step))
        if keyword in ("END PART", "END INSTANCE", "END ASSEMBLY") and len(scopes) > 1:
            scopes.pop()
        i = header[-1] + 1
    return found


def find_includes(lines: Sequence[str]) -> list[Statement]:
    """Statements of *INCLUDE, and of other keywords whose INPUT is a part of the deck."""
    found = []
    for i, line in enumerate(lines):
        text = line.lstrip()
        if not text.startswith("*") or text.startswith("**"):
            continue
        header, keyword, written = _header(lines, i)
        if keyword in READ_AS_DECK and "INPUT" in written:
            path = written["INPUT"].strip('"')
            found.append(Statement(i, header[-1] + 1, path, stays=keyword != "INCLUDE"))
    return found


def include_lines(lines: Sequence[str], written: str) -> list[str]:
    """Write the keyword lines again with another path after ``INPUT=``."""
    text = "".join(lines).rstrip("\r\n")
    quoted = f'"{written}"' if "," in written or " " in written else written
    return _INPUT.sub(lambda match: match[1] + quoted, text, count=1).splitlines()


def records(block: Block, lines: Sequence[str], count: int = 0) -> Iterator[Record]:
    """Split a block into records of ``count`` values, or (0) at lines that end in no comma."""
    values: list[str] = []
    positions: list[int] = []
    for position in block.data:
        tokens = fields(lines[position])
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
        if block.is_generated:
            found = generated_range(lines[position])
            if found:
                ids.ranges.add(found)
        else:
            ids.read(without_instance(token)[1] for token in fields(lines[position]))
    return ids


def generated_range(line: str) -> tuple[int, int, int] | None:
    """First, last and step of a line under GENERATE; None where it holds no range."""
    tokens = (without_instance(token)[1] for token in fields(line))
    numbers = [int(token) for token in tokens if is_id(token)]
    if not numbers:
        return None
    last = numbers[1] if len(numbers) > 1 else numbers[0]
    step = numbers[2] if len(numbers) > 2 else 1
    return numbers[0], last, max(step, 1)


def without_instance(token: str) -> tuple[str, str]:
    """('Part-1-1.', '17') of 'Part-1-1.17'; ('', token) where no instance stands before it."""
    text = token.strip()
    quoted_whole = text.count('"') == 2 and text[0] == text[-1] == '"'
    before, point, after = text[1:-1].rpartition(".") if quoted_whole else text.rpartition(".")
    if not point or not before or before[0].isdigit() or before[0] in "+-.":
        return "", text
    if quoted_whole:
        # "Part 1-1.17" names an instance in quotes; "v1.5" may be a name by itself
        return (f'"{before}".', after) if is_id(after) else ("", text)
    return f"{before}.", after.strip()


def _header(lines: Sequence[str], i: int) -> tuple[list[int], str, dict[str, str]]:
    """Positions, keyword and parameters of the keyword that begins in line ``i``.

    A comma at its end continues it in the next line that is no comment.
    """
    header = [i]
    text = lines[i].strip()
    following = i + 1
    while text.endswith(",") and following < len(lines):
        line = lines[following].strip()
        if line.startswith("**"):
            following += 1
            continue
        # a data line may follow a comma too many: no parameter begins with a number
        if not line or not (line[0].isalpha() or line[0] == '"'):
            break
        text += line
        following += 1
        header.append(following - 1)
    keyword, *rest = fields(text[1:])
    written = {}
    for item in rest:
        name, _, value = item.partition("=")
        if name.strip():
            written[_plain(name)] = value.strip()
    return header, _plain(keyword), written


def _plain(name: str) -> str:
    return " ".join(name.upper().split())
