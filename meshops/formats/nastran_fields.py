"""Fields of pressure of a Nastran deck on elements that are new or reshaped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from meshops.formats.difference import Difference
from meshops.formats.fortran import real
from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_loads import Layer, Pressure
from meshops.formats.nastran_shells import Attributes
from meshops.formats.nastran_systems import Systems
from meshops.formats.pressure_fields import Field
from meshops.formats.pressure_transfer import AreaVectors, carry_over, touched_elements
from meshops.mesh import Floats, ShellMesh


def carried_pressures(
    before: ShellMesh,
    change: Difference,
    regions: Sequence[Attributes],
    fields: Mapping[Layer, Field[Pressure]],
    systems: Systems,
    asked_by: Card,
) -> dict[int, list[Pressure]]:
    """Find the loads by fields of pressure on what is new or reshaped, by its row.

    ``asked_by`` is a card of the deck, for messages about coordinate systems.
    """
    after = change.mesh
    touched = touched_elements(change)
    found: dict[int, list[Pressure]] = {}
    is_tria = after.is_tria
    for region in np.unique(after.region[touched]).tolist():
        new = np.flatnonzero(touched & (after.region == region))
        old = np.flatnonzero(before.region == region)
        for layer, _ in regions[region].graded:
            field = fields[layer]
            ids = before.element_ids[old].tolist()
            values = np.array([np.resize(field.values[element], 4) for element in ids])
            acting = _acting(field.sample, systems, asked_by)
            pressures = carry_over(before, old, values, after, new, acting)
            for row, at_corners in zip(new.tolist(), pressures.tolist(), strict=True):
                load = field.sample.with_values(_typed(at_corners, bool(is_tria[row])))
                found.setdefault(row, []).append(load)
    return found


def _acting(load: Pressure, systems: Systems, asked_by: Card) -> AreaVectors:
    if not load.direction:
        return lambda vectors, _: vectors
    frame = systems.frame(int(load.direction[0] or "0"), asked_by)
    components = np.array([real(text) for text in load.direction[1:]])
    components /= np.linalg.norm(components)

    def along(vectors: Floats, centres: Floats) -> Floats:
        areas = np.linalg.norm(vectors, axis=1, keepdims=True)
        acting: Floats = areas * frame.vectors(components, centres)
        return acting

    return along


def _typed(at_corners: Sequence[float], is_tria: bool) -> list[float]:  # noqa: FBT001 - a kind
    corners = [*at_corners[:3], at_corners[0]] if is_tria else list(at_corners)
    return corners[:1] if len(set(corners)) == 1 else corners
