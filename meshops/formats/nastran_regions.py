"""Regions of Nastran shells: which of them may take each other's place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_loads import Pressure
from meshops.formats.nastran_shells import CORNERS, Attributes, attributes
from meshops.formats.pressure_fields import ShellLoads
from meshops.mesh import Bools, Floats, Ids, Ints

_LAMINATES = ("PCOMP", "PCOMPG", "PCOMPS")
_ORIENTED_MATERIALS = ("MAT2", "MAT8")
_PSHELL_MATERIALS = (1, 3, 5, 10)


@dataclass(frozen=True, eq=False)
class Regions:
    """The regions that the attributes of shells make.

    Attributes
    ----------
    attributes : list of Attributes
        Of the first element of each region.
    region : (M,) int32
    angles : (M,) float64
        Of the material direction, in degrees; NaN where an element has none.
    is_uniform : (M,) bool
        Whether an element has one thickness.
    """

    attributes: list[Attributes]
    region: Ints
    angles: Floats
    is_uniform: Bools


def find_regions(
    shells: Sequence[Card],
    element_ids: Ids,
    loads: ShellLoads[Pressure],
    sets: Sequence[frozenset[int]],
    oriented: frozenset[str],
) -> Regions:
    """Sort shells by their attributes; those that differ in their angles alone are together.

    A blank THETA, and a THETA of zero where no element alike has another, say nothing of a
    material direction; but they do in a property of ``oriented``. ``sets`` are the numbers of the
    output sets that each shell is in.
    """
    kinds, kind = _kinds(shells, element_ids, loads, sets)
    angled = {item.key_but_theta for item in kinds if item.angle or item.pid in oriented}
    angles: list[float] = []
    numbers: dict[tuple[object, ...], int] = {}
    number_of_kind: list[int] = []
    first: list[Attributes] = []
    for item in kinds:
        says_nothing = not item.theta and item.pid not in oriented
        angle = item.angle if item.key_but_theta in angled and not says_nothing else None
        key = (*item.key_but_theta, item.theta_key if angle is None else "angle")
        number = numbers.setdefault(key, len(first))
        if number == len(first):
            first.append(item)
        number_of_kind.append(number)
        angles.append(np.nan if angle is None else angle)
    return Regions(
        attributes=first,
        region=np.array(number_of_kind, np.int32)[kind],
        angles=np.array(angles)[kind],
        is_uniform=np.array([item.is_uniform for item in kinds], bool)[kind],
    )


def oriented_properties(by_name: dict[str, list[Card]]) -> frozenset[str]:
    """Ids of the properties whose stiffness has a direction: laminates, and PSHELLs of MAT2, 8."""
    laminates = {card.field(0) for name in _LAMINATES for card in by_name.get(name, [])}
    materials = {card.field(0) for name in _ORIENTED_MATERIALS for card in by_name.get(name, [])}
    shells = {
        card.field(0)
        for card in by_name.get("PSHELL", [])
        if any(card.field(i) in materials for i in _PSHELL_MATERIALS)
    }
    return frozenset(laminates | shells)


def _kinds(
    shells: Sequence[Card],
    element_ids: Ids,
    loads: ShellLoads[Pressure],
    sets: Sequence[frozenset[int]],
) -> tuple[list[Attributes], Ids]:
    """Different attributes in the order of their first shells, and which a shell has, (M,)."""
    number_of_text: dict[tuple[object, ...], int] = {}
    kinds: list[Attributes] = []
    found: list[int] = []
    for card, element, mine in zip(shells, element_ids.tolist(), sets, strict=True):
        even, graded = loads.even.get(element, ()), loads.graded.get(element, ())
        # cards typed alike are the rule: look only at what is new
        tail = card.fields[2 + CORNERS[card.name] :]
        text = (card.name, card.field(1) or card.field(0), *tail, even, graded, mine)
        number = number_of_text.setdefault(text, len(kinds))
        if number == len(kinds):
            kinds.append(attributes(card, even)._replace(graded=graded, sets=mine))
        found.append(number)
    return kinds, np.array(found, np.int64)
