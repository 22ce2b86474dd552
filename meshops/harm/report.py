"""The columns that two meshes are compared by, and what of them is worse."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from meshops.harm import borders, surfaces
from meshops.harm.borders import LineDeviation
from meshops.harm.gradation import SizeRatio
from meshops.harm.places import Places
from meshops.harm.rows import RowsAcross
from meshops.harm.surfaces import SurfaceDeviation

AROUND = 4
"""Elements around a node that is put back."""

ANGLE_SLACK = 0.01
"""Degrees; both are what rounded coordinates may change."""

SIZE_SLACK = 0.02
"""Share that an edge which is out of bounds may be longer or shorter than those near it."""


@dataclass(frozen=True)
class Standing:
    """How one mesh stands.

    Attributes
    ----------
    elements, quads, trias : int
    failed_by_shape, failed_by_size, failed_by_size_alone : int
        Elements that break a limit of shape, one of size, and of size but none of shape.
    shape_severity, size_severity : float
        How far beyond their limits all of them are: 1 for each that is at the worst level.
    adjacent_trias : int
        Pairs of trias that share an edge.
    border_trias : int
        Trias with an edge on a free border.
    irregular : int
        Inner nodes at which not just four elements meet.
    inverted : int
        Elements with a corner that is flat or turns the wrong way, or that are folded back.
    same_nodes : int
        Elements on the nodes of another one.
    least_scaled_jacobian, mean_scaled_jacobian : float
    least_angle, greatest_angle : float
        Degrees.
    least_size, greatest_size : float
        Edges over the gradation of the mesh before.
    areas : dict of float
        By region.
    """

    elements: int
    quads: int
    trias: int
    failed_by_shape: int
    failed_by_size: int
    failed_by_size_alone: int
    shape_severity: float
    size_severity: float
    adjacent_trias: int
    border_trias: int
    irregular: int
    inverted: int
    same_nodes: int
    least_scaled_jacobian: float
    mean_scaled_jacobian: float
    least_angle: float
    greatest_angle: float
    least_size: float
    greatest_size: float
    areas: dict[int, float]

    @property
    def faults(self) -> int:
        """Failed elements and trias; a tria that fails counts for both."""
        return self.failed_by_shape + self.failed_by_size_alone + self.trias


@dataclass(frozen=True)
class Harm:
    """Two meshes compared.

    Attributes
    ----------
    before, after : Standing
    sizes : SizeRatio
        Of the edges after, with the worst beside those near it before.
    rows : RowsAcross
    lines : tuple of LineDeviation
    surface : SurfaceDeviation
    places : Places
    changed_elements, changed_nodes : int
    other_ids : int
        Elements on the same nodes that have another id.
    lost_locks : int
        Locked nodes that are not in their place any more, and locked elements that are not there.
    """

    before: Standing
    after: Standing
    sizes: SizeRatio
    rows: RowsAcross
    lines: tuple[LineDeviation, ...]
    surface: SurfaceDeviation
    places: Places
    changed_elements: int
    changed_nodes: int
    other_ids: int
    lost_locks: int

    @property
    def faults_removed(self) -> int:
        """How many failed elements and trias fewer there are; negative for more."""
        return self.before.faults - self.after.faults

    @property
    def changed_per_fault(self) -> float:
        """Changed elements for each fault removed; 0 where nothing changed, else infinite."""
        if self.faults_removed > 0:
            return self.changed_elements / self.faults_removed
        return float("inf") if self.changed_elements else 0.0

    @property
    def border_deviation(self) -> float:
        """Largest share of the local edge that any line has moved by."""
        return max((line.worst for line in self.lines), default=0.0)

    @property
    def area_change(self) -> float:
        """Largest relative change of a region's area."""
        return surfaces.worst_area_change(self.before.areas, self.after.areas)[0]

    def broken(self) -> tuple[str, ...]:
        """Say what no deck may be written with."""
        return (*self._counts(), *self._trias(), *self._geometry(), *self._identity())

    def worse(self) -> tuple[str, ...]:
        """Say what is worse than before in any column, one sentence each."""
        return (*self.broken(), *self._quality(), *self._rows_and_sizes(), *self._places())

    def to_json(self) -> dict[str, Any]:
        """Return all columns as what json can write."""
        return {
            **asdict(self),
            "changed_per_fault": self.changed_per_fault,
            "border_deviation": self.border_deviation,
            "area_change": self.area_change,
            "worse": list(self.worse()),
        }

    def _counts(self) -> list[str]:
        b, a = self.before, self.after
        found = [
            _rise("elements fail by shape", b.failed_by_shape, a.failed_by_shape),
            _rise("inverted or flat elements", b.inverted, a.inverted),
            _rise("elements lie on the nodes of another one", b.same_nodes, a.same_nodes),
        ]
        if a.failed_by_shape == b.failed_by_shape and _more(a.shape_severity, b.shape_severity):
            found.append(
                "faults of shape are graver: their severity goes from "
                f"{b.shape_severity:.3g} to {a.shape_severity:.3g}."
            )
        if self.surface.turned:
            found.append(f"{self.surface.turned} new elements have their normal turned round.")
        return [sentence for sentence in found if sentence]

    def _trias(self) -> list[str]:
        b, a = self.before, self.after
        more, paid = a.trias - b.trias, max(b.failed_by_shape - a.failed_by_shape, 0)
        if more <= paid:
            return []
        return [f"{b.trias} trias become {a.trias}, and just {paid} faults of shape went for them."]

    def _geometry(self) -> list[str]:
        found = [
            f"the {line.kind} moves by {_percent(line.worst)} of its local edge or width"
            f"{_at(line.place)}; {borders.LIMIT:.0%} is the most."
            for line in self.lines
            if line.worst > borders.LIMIT
        ]
        found += [
            f"{line.corners_lost} corners of the {line.kind} have no node any more."
            for line in self.lines
            if line.corners_lost
        ]
        if self.surface.excess > surfaces.LIMIT:
            s = self.surface
            found.append(
                f"the surface moves by {_percent(max(s.nodes, s.middles, s.back))} of its local "
                f"edge{_at(s.place)}; {surfaces.LIMIT:.0%} beyond its own facets "
                f"({_percent(s.facets)}) is the most."
            )
        change, region = surfaces.worst_area_change(self.before.areas, self.after.areas)
        if change > surfaces.AREA_LIMIT:
            areas = [s.areas.get(region, 0.0) for s in (self.before, self.after)]
            found.append(
                f"the area of region {region} goes from {areas[0]:.6g} to {areas[1]:.6g}: "
                f"{_percent(change)}, where {surfaces.AREA_LIMIT:.1%} is the most."
            )
        return found

    def _identity(self) -> list[str]:
        found = []
        if self.other_ids:
            found.append(f"{self.other_ids} elements on the same nodes have another id.")
        if self.lost_locks:
            found.append(f"{self.lost_locks} locked nodes or elements are not as they were.")
        return found

    def _quality(self) -> list[str]:
        b, a = self.before, self.after
        # where a folded node is put back, what is around it is as long and narrow as the rest
        paid = AROUND * max(b.inverted - a.inverted, 0)
        found = [
            _rise("elements fail by size", b.failed_by_size, a.failed_by_size - paid),
            _rise("pairs of trias share an edge", b.adjacent_trias, a.adjacent_trias),
            _rise("trias lie at a free border", b.border_trias, a.border_trias),
        ]
        for what, old, new, slack in (
            ("least scaled Jacobian", b.least_scaled_jacobian, a.least_scaled_jacobian, 1e-4),
            ("least angle", b.least_angle, a.least_angle, ANGLE_SLACK),
            ("largest angle", -b.greatest_angle, -a.greatest_angle, ANGLE_SLACK),
        ):
            if new < old - slack:
                found.append(f"the {what} goes from {abs(old):.3g} to {abs(new):.3g}.")
        if (
            a.failed_by_size == b.failed_by_size
            and not paid
            and _more(a.size_severity, b.size_severity)
        ):
            found.append(
                "faults of size are graver: their severity goes from "
                f"{b.size_severity:.3g} to {a.size_severity:.3g}."
            )
        is_milder = _more(b.shape_severity, a.shape_severity)
        nothing = self.faults_removed <= 0 and a.irregular >= b.irregular and not is_milder
        if self.changed_elements and nothing:
            found.append(f"{self.changed_elements} elements changed, and no fault went.")
        return [sentence for sentence in found if sentence]

    def _rows_and_sizes(self) -> list[str]:
        found = []
        if self.rows.fewer:
            found.append(
                f"{self.rows.before} rows across become {self.rows.after}{_at(self.rows.place)}, "
                f"and so at {self.rows.fewer} edges."
            )
        if self.sizes.grown > 1.0 + SIZE_SLACK:
            found.append(
                f"an edge is {self.sizes.grown:.2f} times as long as any that was near it"
                f"{_at(self.sizes.place)}."
            )
        if self.sizes.shrunk < 1.0 - SIZE_SLACK:
            found.append(
                f"an edge is {self.sizes.shrunk:.2f} times as long as the shortest that was near it"
                f"{_at(self.sizes.place)}."
            )
        return found

    def _places(self) -> list[str]:
        p = self.places
        rules = (
            (p.new_faults, "have a fault of shape that is new, or graver than what it replaces"),
            (p.unpaid_trias, "have more new trias than faults of shape that went"),
            (p.spoiled, "lose quality, and no fault of shape, tria or irregular node goes"),
        )
        return [
            f"{count} of {p.count} changed places {what}{_at(example)}."
            for (count, what), example in zip(rules, p.examples, strict=True)
            if count
        ]


def _rise(what: str, before: int, after: int) -> str:
    return f"{what}: {before} before, {after} after." if after > before else ""


def _more(after: float, before: float) -> bool:
    return after > before * (1.0 + 1e-3) + 1e-6


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _at(place: tuple[float, float, float] | None) -> str:
    return "" if place is None else " at ({:.6g}, {:.6g}, {:.6g})".format(*place)
