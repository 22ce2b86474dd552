"""Case control of a Nastran deck: the nodes and shells that it names, and its SETs."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from meshops.formats.ids import IdSet, is_id
from meshops.formats.nastran_sections import statements

_SET = re.compile(r"SET\s*(\d+)\s*=\s*(.*)", re.IGNORECASE | re.DOTALL)
_REQUEST = re.compile(r"(\w+)\s*(?:\([^)]*\))?\s*=\s*(\d+)\s*")
_SURFACE = re.compile(r"(?:SURFACE|VOLUME)\s+\d+\s+SET\s+(\d+)", re.IGNORECASE)
_GRID = re.compile(r"\bGRID\s*=\s*(\d+)", re.IGNORECASE)
_GRDPNT = re.compile(r"PARAM\s*,\s*GRDPNT\s*,\s*(\d+)", re.IGNORECASE)
_CURVES = re.compile(r"XY(?:PLOT|PRINT|PUNCH|PEAK|PAPL|PAPLOT)\b(.*)", re.IGNORECASE | re.DOTALL)
_CURVE_ID = re.compile(r"(?<![\w.(])(\d+)\s*(?=\()")
_NODE_OUTPUT = (
    *("DISP", "VECT", "PRES", "SPCF", "OLOA", "VELO", "ACCE", "MPCF", "GPFO", "THER", "SVEC"),
    *("SDIS", "SVEL", "SACC", "NLLO", "GPKE", "PART"),
)
_ELEMENT_OUTPUT = (
    *("STRESS", "STRAIN", "FORCE", "ELFORCE", "ELSTRESS", "ELSTRAIN", "NLSTRESS", "FLUX"),
    *("ESE", "EKE", "EDE", "CSTRESS", "CSTRAIN"),
)


class SetDefinition(NamedTuple):
    """One SET statement: its ids and the positions of its lines in the stream."""

    number: int
    ids: IdSet
    lines: list[int]


@dataclass(frozen=True)
class CaseControl:
    """What case control says of nodes and shells.

    Attributes
    ----------
    node_sets, element_sets : list of SetDefinition
        Those that an output request of nodes or of elements uses. A number may come again in
        another subcase.
    nodes, elements : IdSet
        Named by other statements.
    numbers : set of int
        Of all sets that a request names.
    """

    node_sets: list[SetDefinition] = field(default_factory=list)
    element_sets: list[SetDefinition] = field(default_factory=list)
    nodes: IdSet = field(default_factory=IdSet)
    elements: IdSet = field(default_factory=IdSet)
    numbers: set[int] = field(default_factory=set)


def read_case_control(lines: Sequence[str], start: int = 0) -> CaseControl:
    """Read case control, whose first line is at position ``start`` of the stream."""
    sets: list[SetDefinition] = []
    used: dict[str, set[int]] = defaultdict(set)
    found = CaseControl()
    for text, rows in statements(lines):
        definition = _SET.match(text)
        request = _REQUEST.fullmatch(text)
        curves = _CURVES.match(text)
        surface = _SURFACE.match(text)
        if definition:
            ids = IdSet()
            # a set of degrees of freedom names them as 12/T3
            ids.read(word.partition("/")[0] for word in re.split(r"[\s,]+", definition[2]))
            sets.append(SetDefinition(int(definition[1]), ids, [start + row for row in rows]))
        elif curves:
            named = {int(word) for word in _CURVE_ID.findall(curves[1].partition("/")[2])}
            found.nodes.singles.update(named)
            found.elements.singles.update(named)
        elif surface:
            used["elements"].add(int(surface[1]))
        elif request:
            found.numbers.add(int(request[2]))
            word = request[1].upper()
            if word.startswith(_NODE_OUTPUT):
                used["nodes"].add(int(request[2]))
            elif word.startswith(_ELEMENT_OUTPUT):
                used["elements"].add(int(request[2]))
        point = _GRDPNT.match(text) or (None if definition else _GRID.search(text))
        if point and is_id(point[1]):
            found.nodes.singles.add(int(point[1]))
    found.node_sets.extend(item for item in sets if item.number in used["nodes"])
    found.element_sets.extend(item for item in sets if item.number in used["elements"])
    return found


def grown_set(line: str, ids: Iterable[int]) -> list[str]:
    """Write the first line of a SET statement again with more ids, which come first."""
    match = re.match(r"(\s*SET\s*\d+\s*=\s*)(.*)", line.rstrip("\r\n"), re.IGNORECASE)
    if match is None:
        raise ValueError(f"{line!r} begins no SET")
    rows = [match[1]]
    for word in runs(ids):
        if len(rows[-1]) + len(word) > 68:
            rows.append("     ")
        rows[-1] += f"{word}, "
    return [*(row.rstrip() for row in rows), f"     {match[2]}"]


def runs(ids: Iterable[int]) -> list[str]:
    """Write ids as '5', '7 THRU 9'."""
    found: list[list[int]] = []
    for number in sorted(ids):
        if found and number == found[-1][1] + 1:
            found[-1][1] = number
        else:
            found.append([number, number])
    return [str(a) if a == b else f"{a} THRU {b}" for a, b in found]
