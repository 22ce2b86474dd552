"""Regions of an Abaqus mesh: elements of one kind, of the same sets, with the same facts.

A new element joins the sets of its region, and gets the lines of loads and surfaces that name the
elements of its region by number. A line that means an edge of an element and not a side of it names
the element for good: that edge would be another one elsewhere.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meshops.formats.abaqus_items import Items, element_type
from meshops.formats.abaqus_pressures import PressureFields, is_pressure, sort_pressures
from meshops.formats.abaqus_scopes import Scope
from meshops.formats.abaqus_sets import NamedSets
from meshops.formats.abaqus_types import CORNERS, has_sides, pair
from meshops.formats.abaqus_uses import Fact, Row
from meshops.formats.ids import is_id
from meshops.formats.pressure_fields import Layer
from meshops.formats.splice import Splice
from meshops.mesh import Bools, Ids, Ints

_SIDE = re.compile(r"|[PFRS](POS|NEG)?(NU)?|[PFRS][12](NU)?|HP")
_BODY = re.compile(r"|BF(NU)?|B[XYZ](NU)?|GRAV|NEWTON|CENTRIF|CENT|ROTA|CORIO")


class Region(NamedTuple):
    """What the elements of a region have in common.

    Attributes
    ----------
    quad, tria : str
        Element types.
    elset : str
        Key of the set that *ELEMENT names, or ''.
    lists : frozenset of str
        Identities of the sets that list the elements.
    facts : frozenset of Fact
        What lines say of them by number.
    graded : tuple of (Layer, int)
        The fields of pressure that they are samples of, and in which of their areas they are.
    """

    quad: str
    tria: str
    elset: str
    lists: frozenset[str]
    facts: frozenset[Fact]
    graded: tuple[tuple[Layer, int], ...]


@dataclass(frozen=True, eq=False)
class ElementFacts:
    """What data lines say of elements by number, and which they name for good.

    Attributes
    ----------
    of_element : dict of int to frozenset of Fact
        By id.
    rows : list of Row
        The lines that give these facts.
    pressures : PressureFields
    elements : dict of str to (M,) bool
        Elements named for good, by what names them.
    nodes : dict of str to set of int
        Ids of the ends of the edges that are meant.
    """

    of_element: dict[int, frozenset[Fact]]
    rows: list[Row]
    pressures: PressureFields
    elements: dict[str, Bools]
    nodes: dict[str, set[int]]


def element_facts(
    rows: Sequence[Row],
    shells: Items,
    element_ids: Ids,
    corners: Ids,
    members: Callable[[Row], Bools],
) -> ElementFacts:
    """Tell the lines that a new element can take over from those that mean edges.

    Parameters
    ----------
    members
        Which elements are in the set that a line names, (M,) bool.
    """
    kinds = [element_type(block) for block in shells.blocks]
    row_of_element = {element: row for row, element in enumerate(element_ids.tolist())}
    followed: list[Row] = []
    pressures: list[Row] = []
    said: set[tuple[object, int]] = set()
    elements: dict[str, Bools] = {}
    nodes: dict[str, set[int]] = defaultdict(set)
    for row in rows:
        by_number = is_id(row.subject)
        if by_number:
            place = row_of_element.get(int(row.subject))
            places = [] if place is None else [place]
        else:
            places = np.flatnonzero(members(row)).tolist()
        label = row.fact.kind[-1]
        edged = [place for place in places if not _is_whole(label, kinds[place])]
        if edged:
            title = f"edges in *{row.block.keyword}"
            mask = elements.setdefault(title, np.zeros(len(kinds), bool))
            mask[edged] = True
            for place in edged:
                nodes[title].update(_edge(label, kinds[place], corners[place].tolist()))
        elif places and by_number and (row.fact.kind, places[0]) in said:
            # a second line on the same load: which of the two holds is for the solver to know
            elements.setdefault(f"*{row.block.keyword}", np.zeros(len(kinds), bool))[places] = True
        elif places and by_number:
            said.add((row.fact.kind, places[0]))
            (pressures if is_pressure(row, kinds[places[0]]) else followed).append(row)
    even, fields = sort_pressures(pressures, element_ids, corners)
    facts: dict[int, set[Fact]] = defaultdict(set)
    for row in (*followed, *even):
        facts[int(row.subject)].add(row.fact)
    of_element = {element: frozenset(mine) for element, mine in facts.items()}
    return ElementFacts(of_element, [*followed, *even], fields, elements, nodes)


def find_regions(
    shells: Items, element_ids: Ids, elsets: NamedSets, facts: ElementFacts
) -> tuple[list[Region], Ints]:
    """Find the distinct regions, and the number of the one of each element, (M,) int32."""
    listed: list[set[str]] = [set() for _ in element_ids]
    for item in elsets:
        for row in np.flatnonzero(item.numbers.mask(element_ids)).tolist():
            listed[row].add(item.identity)
    nothing: frozenset[Fact] = frozenset()
    keys = [
        (
            block.parameters.get("ELSET", ""),
            frozenset(names),
            facts.of_element.get(element, nothing),
            facts.pressures.graded.get(element, ()),
        )
        for block, names, element in zip(shells.blocks, listed, element_ids.tolist(), strict=True)
    ]
    kinds = [element_type(block) for block in shells.blocks]
    in_deck = Counter(kinds)
    beside: dict[object, Counter[str]] = defaultdict(Counter)
    for kind, key in zip(kinds, keys, strict=True):
        beside[key][kind] += 1
    numbers: dict[Region, int] = {}
    number_of: dict[object, int] = {}
    for kind, key in dict.fromkeys(zip(kinds, keys, strict=True)):
        elset, names, said, graded = key
        mine = Region(*pair(kind, beside[key], in_deck), elset, names, said, graded)
        number_of[kind, key] = numbers.setdefault(mine, len(numbers))
    region = np.array([number_of[item] for item in zip(kinds, keys, strict=True)], np.int32)
    return list(numbers), region


def write_element_facts(
    splice: Splice,
    lines: Sequence[str],
    facts: ElementFacts,
    *,
    gone: frozenset[int],
    joining: Mapping[Fact, Sequence[int]],
) -> None:
    """Take the lines of vanished elements out, and give the new ones lines like those beside."""
    last: dict[Fact, Row] = {}
    for row in facts.rows:
        last[row.fact] = row
        if int(row.subject) in gone:
            splice.drop([row.position])
    for fact, elements in joining.items():
        row = last[fact]
        line = lines[row.position].rstrip("\r\n")
        texts = (line.replace(row.token, f"{row.instance}{element}", 1) for element in elements)
        splice.insert_after(row.position, texts)


def members_of(
    row: Row, elsets: NamedSets, masks: Mapping[str, Bools], scope: Scope, count: int
) -> Bools:
    """Which of the elements are in the set that a line names, (M,) bool."""
    mask = np.zeros(count, bool)
    for item in elsets:
        if scope.means(row.token, row.block, scope=item.scope, name=item.name):
            mask |= masks[item.identity]
    return mask


def _is_whole(label: str, kind: str) -> bool:
    """Whether a label means a whole element or a side of it, and not an edge."""
    if _BODY.fullmatch(label):
        return True
    return has_sides(kind) and bool(_SIDE.fullmatch(label))


def _edge(label: str, kind: str, corners: Sequence[int]) -> list[int]:
    """Ids of the ends of the edge that a label means; of all corners where that is not known."""
    digits = "".join(char for char in label if char.isdigit())
    # CalculiX counts the two sides of a shell before its edges
    sides = 2 if has_sides(kind) and not label.startswith("E") else 0
    edge = int(digits) - sides if len(digits) == 1 else 0
    count = CORNERS[kind]
    if not 1 <= edge <= count:
        return [node for node in corners if node]
    return [corners[edge - 1], corners[edge % count]]
