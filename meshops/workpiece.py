"""Workpiece: a mesh with all that operations want to know of it, found out once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from meshops._core import (
    elements_of_nodes,
    irregular_change,
    irregular_nodes,
    penalise,
    sum_elements,
    sum_measures,
)
from meshops.assessment import Assessment
from meshops.bounds import bounds_of
from meshops.criteria import Scoring
from meshops.edit import Edit
from meshops.fitness import Fitness
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ints, ShellMesh
from meshops.quality import (
    SHAPES,
    element_values,
    failing_penalties,
    index_of_penalties,
    region_areas,
)
from meshops.quality_sums import FAILED, IRREGULAR, SHAPE_FAILED, SIZE, TRIAS
from meshops.rows import Rows
from meshops.sizing import LOCAL, SizeField, at_even_size
from meshops.surface import PatchSurface
from meshops.topology import FEATURE_ANGLE, Topology, topology


@dataclass(frozen=True)
class Setting:
    """What stays the same over a whole run.

    Attributes
    ----------
    scoring : Scoring
        The criteria at the run's element size.
    fitness : Fitness
    element_size : float or None
        Edge length that Remesh aims at; None keeps the size that the mesh has in that place.
    feature_angle : float
        Degrees from which the edge between two elements is a feature.
    sizes : SizeField or None
        The wanted size by place, where it is not the same everywhere: lengths are judged by it.
    gradation : SizeField or None
        The same within a subdomain too, which is searched at one size: the guard judges by it.
    keeps_sizes : bool
        Whether these sizes are those that the mesh had, and it is to keep them.
    rows : Rows or None
        The rows across strips that the mesh had, which it is to keep; None: within a subdomain,
        where strips do not show.
    areas : (R,) float64 or None
        Of the regions that the mesh had; None: within a subdomain.
    outside : (b,) int32 or None
        Of a subdomain, whose border nodes have the ids from 1 to b: how many elements of the mesh
        around it meet at each of them; -1 where any number may.
    slides : bool
        Whether nodes of a subdomain on a border of the mesh may slide along it.
    """

    scoring: Scoring
    fitness: Fitness
    element_size: float | None = None
    feature_angle: float = FEATURE_ANGLE
    sizes: SizeField | None = None
    gradation: SizeField | None = None
    keeps_sizes: bool = False
    rows: Rows | None = None
    areas: Floats | None = None
    outside: Ints | None = None
    slides: bool = False

    @classmethod
    def of(
        cls,
        mesh: ShellMesh,
        assessment: Assessment,
        fitness: Fitness,
        *,
        element_size: float | None,
        feature_angle: float,
        slides: bool,
    ) -> Self:
        """Set a run up on a mesh that is judged by an assessment."""
        scoring = assessment.scoring
        if fitness.kind != "trias":
            scoring = replace(scoring, bounds=bounds_of(mesh))
        return cls(
            scoring=scoring,
            fitness=fitness,
            element_size=element_size,
            feature_angle=feature_angle,
            sizes=assessment.sizes,
            gradation=assessment.sizes,
            keeps_sizes=assessment.gradation == LOCAL,
            rows=None if fitness.kind == "trias" else Rows.of(mesh, feature_angle),
            areas=region_areas(mesh),
            slides=slides,
        )

    def at_even_size(self, mesh: ShellMesh) -> ShellMesh:
        """Bring each element to the size that `scoring` judges lengths by, apart from the others.

        An element that is as large as the size field wants it there becomes as large as the
        scoring wants all; its angles stay.
        """
        if self.sizes is None:
            return mesh
        return at_even_size(mesh, self.sizes, self.scoring.size)


@dataclass(frozen=True, eq=False)
class Workpiece:
    """A mesh under a setting.

    Attributes
    ----------
    mesh : ShellMesh
    setting : Setting
    reference : PatchSurface or None
        The surface that nodes must stay on; None: that of the mesh as it is.
    """

    mesh: ShellMesh
    setting: Setting
    reference: PatchSurface | None = None

    @cached_property
    def surface(self) -> PatchSurface:
        """The surface that nodes must stay on."""
        return self.reference or PatchSurface.of(self.mesh.points, self.mesh.elements)

    @cached_property
    def topology(self) -> Topology:
        """Edges and barriers."""
        return topology(self.mesh, feature_angle=self.setting.feature_angle)

    @cached_property
    def tally(self) -> Floats:
        """(TALLY_SIZE,) sums over all elements, from which fitness follows."""
        scoring = self.setting.scoring.core
        tally = sum_measures(self._values_at_even_size, self.mesh.is_tria, scoring)
        tally[IRREGULAR] = np.count_nonzero(self.irregular)
        return tally

    @cached_property
    def outside(self) -> Ints:
        """(N,) int32: elements around each node that are not of the mesh; -1 where any number is.

        Nodes on a barrier may have any number of elements.
        """
        outside = np.where(self.topology.inner_nodes, 0, -1).astype(np.int32)
        if self.setting.outside is not None:
            own = (self.mesh.node_ids != NEW) & (self.mesh.node_ids <= len(self.setting.outside))
            outside[own] = self.setting.outside[self.mesh.node_ids[own] - 1]
        return outside

    @cached_property
    def irregular(self) -> Bools:
        """(N,) bool: inner nodes at which not just four elements meet."""
        return irregular_nodes(self.around[0], self.outside)

    @cached_property
    def irregular_elements(self) -> Bools:
        """(M,) bool: elements with an irregular node."""
        elements = self.mesh.elements
        irregular: Bools = (self.irregular[elements] & (elements != NO_NODE)).any(axis=1)
        return irregular

    @cached_property
    def values(self) -> Floats:
        """(M, 12) measures of all elements as they are."""
        return element_values(self.mesh, self.setting.scoring)

    @cached_property
    def _values_at_even_size(self) -> Floats:
        if self.setting.sizes is None:
            return self.values
        return element_values(self.setting.at_even_size(self.mesh), self.setting.scoring)

    @cached_property
    def _penalties(self) -> Floats:
        return penalise(self._values_at_even_size, self.setting.scoring.core)

    @cached_property
    def around(self) -> tuple[Ints, Ints]:
        """The elements of each node, as `elements_of_nodes` finds them."""
        return elements_of_nodes(self.mesh.elements, len(self.mesh.points))

    def tally_of(self, points: Floats, elements: Ints) -> Floats:
        """(TALLY_SIZE,) sums over some elements."""
        return sum_elements(points, elements, self.setting.scoring.core)

    def tally_change(self, edit: Edit) -> Floats:
        """(TALLY_SIZE,) what the edit adds to the tally of the mesh."""
        mesh = self.mesh
        gone = np.zeros(len(mesh.elements), bool)
        gone[edit.removed] = True
        touched = gone.copy()
        touched[edit.rewired] = True
        if len(edit.moved):
            moved = np.zeros(len(mesh.points), bool)
            moved[edit.moved] = True
            touched |= (moved[mesh.elements] & (mesh.elements != NO_NODE)).any(axis=1)
        after = mesh.elements.copy()
        after[edit.rewired] = edit.rewired_to
        new = np.concatenate([after[touched & ~gone], edit.added_elements])
        change: Floats = self.tally_of(edit.points_after(mesh), new) - self.tally_of(
            mesh.points, mesh.elements[touched]
        )
        change[IRREGULAR] = self.irregular_change(np.nonzero(touched)[0].astype(np.int32), new)
        return change

    def irregular_change(self, gone: Ints, new: Ints) -> int:
        """How many more nodes are irregular once elements (B, 4) have come for the rows `gone`."""
        return irregular_change(gone, new, self.mesh.elements, self.around[0], self.outside)

    def fitness(self, tallies: Floats) -> Floats:
        """(P,) fitness of (P, TALLY_SIZE) tallies."""
        return self.setting.fitness.of(tallies, self.setting.scoring)

    def accepts(self, tally: Floats) -> bool:
        """Whether a mesh with this tally (TALLY_SIZE,) is fitter or has as many faults."""
        before, after = self.fitness(np.stack([self.tally, tally]))
        faults = [SHAPE_FAILED, FAILED, TRIAS]
        return bool(after > before) or bool((tally[faults] == self.tally[faults]).all())

    @cached_property
    def failed_criteria(self) -> Bools:
        """(M, C) bool: which criterion of elements each element fails."""
        fails: Bools = failing_penalties(self._penalties, self.setting.scoring)
        return fails

    @cached_property
    def failing(self) -> Bools:
        """(M,) bool: which elements fail a criterion."""
        failing: Bools = np.any(self.failed_criteria, axis=1)
        return failing

    @cached_property
    def failing_by_shape(self) -> Bools:
        """(M,) bool: which elements fail a criterion of shape."""
        failing: Bools = np.any(self.failed_criteria[:, SHAPES], axis=1)
        return failing

    @cached_property
    def in_regular_rows(self) -> Bools:
        """(M,) bool: elements that fail by size alone, in rows that no irregular node is near.

        Neither a tria nor an element that fails by shape shares a node with them: what mends their
        size is another density and no other arrangement, so they are left alone.
        """
        elements = self.mesh.elements
        is_node = elements != NO_NODE
        near = self.irregular.copy()
        amiss = self.failing_by_shape | self.mesh.is_tria
        near[elements[amiss][is_node[amiss]]] = True
        rows: Bools = self.failing & ~amiss & ~(near[elements] & is_node).any(axis=1)
        return rows

    @property
    def severity_in_rows(self) -> float:
        """Severity of the faults of size in regular rows."""
        rows = self.mesh.elements[self.in_regular_rows]
        return float(self.tally_of(self.mesh.points, rows)[SIZE])

    @cached_property
    def mendable(self) -> Bools:
        """(M,) bool: elements that fail, but for those in regular rows."""
        mendable: Bools = self.failing & ~self.in_regular_rows
        return mendable

    @cached_property
    def bad_elements(self) -> Ints:
        """Rows of the elements that fail or are trias, worst first.

        Where there are none, of those with an irregular node; where there is none either, of all.
        Elements that fail by shape come first, then others by their Q.I.; equals in the order of
        their rows. Elements that no operation may take out are left out.
        """
        mesh = self.mesh
        editable = self.topology.editable
        for chosen in (self.mendable | mesh.is_tria, self.irregular_elements, editable):
            bad = np.nonzero(chosen & editable)[0]
            if len(bad):
                break
        index = index_of_penalties(self._penalties[bad], self.setting.scoring)
        order = np.lexsort((bad, -np.round(index, 9), ~self.failing_by_shape[bad]))
        return bad[order].astype(np.int32)

    @cached_property
    def rings(self) -> Ints:
        """(M,) int32: across how many crossable edges the nearest bad element is.

        0 for the bad elements themselves; a large number where none can be reached.
        """
        return self.topology.graph.rings_around(self.topology.editable, self.bad_elements)
