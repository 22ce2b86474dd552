"""Pressures by element number of an Abaqus deck: even ones, and those that are samples of a field.

``pressure_fields`` tells the two apart. An even pressure is a fact like any other; a field is
carried over to what is meshed anew, with its force and its moment.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meshops.formats.abaqus_blocks import fields
from meshops.formats.abaqus_output import number
from meshops.formats.abaqus_types import has_sides
from meshops.formats.abaqus_uses import Row
from meshops.formats.difference import Difference
from meshops.formats.fortran import real
from meshops.formats.pressure_fields import Field, Layer, ShellLoads, sort_loads
from meshops.formats.pressure_transfer import carry_over, touched_elements
from meshops.formats.splice import Splice
from meshops.mesh import Ids, ShellMesh


class Pressure(NamedTuple):
    """A line that puts a pressure on one element."""

    row: Row

    @property
    def layer(self) -> Layer:
        """Keyword, parameters and step."""
        return self.row.fact.kind

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal pressures."""
        return (*self.row.fact.kind, *self.row.fact.value)

    @property
    def values(self) -> tuple[str, ...]:
        """The pressure."""
        return self.row.fact.value

    @property
    def pressure(self) -> Pressure:
        """Itself: a line holds one pressure."""
        return self

    @property
    def elements(self) -> tuple[int]:
        """Id of the element."""
        return (int(self.row.subject),)


@dataclass(frozen=True, eq=False)
class PressureFields:
    """Pressures that differ from element to element.

    Attributes
    ----------
    graded : dict of int to tuple of (Layer, int)
        By element id: the fields that it is a sample of, and in which of their areas it is.
    fields : dict of Layer to Field
    rows : dict of (Layer, int) to Row
        The line of each element.
    """

    graded: dict[int, tuple[tuple[Layer, int], ...]]
    fields: dict[Layer, Field[Pressure]]
    rows: dict[tuple[Layer, int], Row]

    def splice(
        self,
        splice: Splice,
        lines: Sequence[str],
        before: ShellMesh,
        change: Difference,
        graded: Mapping[int, Sequence[Layer]],
    ) -> None:
        """Write the lines of elements that are new, reshaped or gone.

        Parameters
        ----------
        graded
            The fields of each region.
        """
        gone = set(change.gone_elements.tolist())
        for (_, element), row in self.rows.items():
            if element in gone:
                splice.drop([row.position])
        after = change.mesh
        touched = touched_elements(change)
        for region in np.unique(after.region[touched]).tolist():
            new = np.flatnonzero(touched & (after.region == region))
            old = np.flatnonzero(before.region == region)
            for layer in graded[region]:
                pressures = self._carried(layer, before, old, after, new)
                ids = change.element_ids[new].tolist()
                self._write(splice, lines, layer, dict(zip(ids, pressures, strict=True)))

    def _carried(
        self, layer: Layer, before: ShellMesh, old: Ids, after: ShellMesh, new: Ids
    ) -> list[float]:
        found = self.fields[layer].values
        values = np.array([np.resize(found[e], 4) for e in before.element_ids[old].tolist()])
        pressures = carry_over(before, old, values, after, new, lambda vectors, _: vectors)
        even: list[float] = pressures[:, 0].tolist()
        return even

    def _write(
        self, splice: Splice, lines: Sequence[str], layer: Layer, pressures: Mapping[int, float]
    ) -> None:
        last = self.fields[layer].sample.row
        for mine in self.rows:
            if mine[0] == layer and self.rows[mine].position > last.position:
                last = self.rows[mine]
        added = []
        for element, pressure in pressures.items():
            row = self.rows.get((layer, element), last)
            line = lines[row.position]
            indent = line[: len(line) - len(line.lstrip())]
            label = fields(line)[1]
            text = f"{indent}{row.instance}{element}, {label}, {number(pressure)}"
            if (layer, element) in self.rows:
                splice.replace([row.position], [text])
            else:
                added.append(text)
        splice.insert_after(last.position, added)


def is_pressure(row: Row, kind: str) -> bool:
    """Tell whether a line puts a pressure along the normal on an element of a type."""
    if row.block.keyword != "DLOAD" or row.fact.kind[-1] != "P" or not has_sides(kind):
        return False
    try:
        return len(row.fact.value) == 1 and bool(np.isfinite(real(row.fact.value[0])))
    except ValueError:
        return False


def sort_pressures(
    rows: Sequence[Row], element_ids: Ids, corners: Ids
) -> tuple[list[Row], PressureFields]:
    """Tell the lines of even pressures from those of fields.

    Parameters
    ----------
    element_ids, corners : (M,) int64, (M, 4) int64
        Of all elements; a tria has 0 last.
    """
    loads: ShellLoads[Pressure] = sort_loads(map(Pressure, rows), element_ids, corners)
    even = [load.row for mine in loads.even.values() for load in mine]
    in_field = {layer: item.values for layer, item in loads.fields.items()}
    of_fields = {
        (row.fact.kind, int(row.subject)): row
        for row in rows
        if int(row.subject) in in_field.get(row.fact.kind, {})
    }
    return even, PressureFields(loads.graded, loads.fields, of_fields)
