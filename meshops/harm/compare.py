"""Two meshes compared: what `report` needs, measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.criteria import Scoring
from meshops.harm.borders import Lines, compare_lines
from meshops.harm.changes import Changes, duplicates, with_regions_of
from meshops.harm.edges import BORDER, INSIDE, Edges, Kinds, kinds_of, used_nodes
from meshops.harm.gradation import Gradation, SizeRatio, compare_sizes, size_ratio
from meshops.harm.limits import failures
from meshops.harm.places import Judged, judge_places
from meshops.harm.report import Harm, Standing
from meshops.harm.rows import Walks, compare_rows, walk_across
from meshops.harm.shapes import Shapes
from meshops.harm.surfaces import areas_by_region, compare_surfaces, folded_elements
from meshops.mesh import NO_NODE, Bools, Floats, ShellMesh

LEAST, MOST = 0.5, 1.5
"""Edges over the gradation that are right in any case, where the criteria do not say otherwise."""


@dataclass(frozen=True, eq=False)
class _Measured:
    judged: Judged
    edges: Edges
    kinds: Kinds
    walks: Walks
    lines: Lines


def compare(
    before: ShellMesh,
    after: ShellMesh,
    scoring: Scoring,
    sizes: tuple[Floats, Floats] | None = None,
) -> Harm:
    """Compare a mesh with what has become of it.

    Parameters
    ----------
    before, after : ShellMesh
    scoring : Scoring
        Limits, and the size that both meshes are judged by.
    sizes : (M1,) and (M2,) float64, optional
        Sizes of the elements to judge by instead, as `local_sizes` gives them.
    """
    changes = Changes.of(before, after)
    after = with_regions_of(before, after, changes)
    then, now = (
        _measure(mesh, scoring, None if sizes is None else sizes[k])
        for k, mesh in enumerate((before, after))
    )
    gradation = Gradation.of(before, then.edges)
    ratio_before = size_ratio(before, then.edges, gradation)
    ratio_after = compare_sizes(before, then.edges, after, now.edges, gradation, _bounds(scoring))
    return Harm(
        before=_standing(then, ratio_before),
        after=_standing(now, ratio_after),
        sizes=ratio_after,
        rows=compare_rows(then.walks, now.walks),
        lines=compare_lines(then.lines, now.lines, changes),
        surface=compare_surfaces(before, then.edges, after, changes),
        places=judge_places(then.judged, now.judged, changes),
        changed_elements=changes.changed_elements,
        changed_nodes=changes.changed_nodes,
        other_ids=int(np.count_nonzero(changes.other_ids)),
        lost_locks=_lost_locks(before, changes),
    )


def verify(
    before: ShellMesh,
    after: ShellMesh,
    scoring: Scoring,
    sizes: tuple[Floats, Floats] | None = None,
) -> tuple[str, ...]:
    """Say what of a mesh must not be written: one sentence for each promise that is broken.

    The arguments are those of `compare`; no sentence, no harm.
    """
    return compare(before, after, scoring, sizes).broken()


def local_sizes(before: ShellMesh, after: ShellMesh) -> tuple[Floats, Floats]:
    """Sizes of the elements of both meshes by the gradation that the first one has."""
    gradation = Gradation.of(before, Edges.of(before))
    return gradation.of_elements(before), gradation.of_elements(after)


def median_size(mesh: ShellMesh) -> float:
    """Median length of the edges, each counted once; ValueError for a mesh without any."""
    lengths = Edges.of(mesh).lengths(mesh)
    if not len(lengths):
        raise ValueError("a mesh without elements has no size")
    return float(np.median(lengths))


def _measure(mesh: ShellMesh, scoring: Scoring, sizes: Floats | None) -> _Measured:
    edges = Edges.of(mesh)
    kinds = kinds_of(mesh, edges)
    walks = walk_across(mesh, edges, kinds)
    shapes = Shapes.of(mesh)
    judged = Judged(mesh, shapes, failures(shapes, scoring, sizes), _irregular(mesh, edges, kinds))
    return _Measured(judged, edges, kinds, walks, Lines.of(mesh, edges, kinds, walks))


def _standing(measured: _Measured, ratio: SizeRatio) -> Standing:
    judged, edges = measured.judged, measured.edges
    mesh, shapes, failed = judged.mesh, judged.shapes, judged.failures
    tria, folded = mesh.is_tria, folded_elements(mesh, edges)
    both = tria[edges.pair].all(axis=1) & (edges.pair[:, 0] >= 0)
    at_border = (edges.of_side >= 0) & (measured.kinds[edges.of_side] == BORDER)
    return Standing(
        elements=len(tria),
        quads=int(np.count_nonzero(~tria)),
        trias=int(np.count_nonzero(tria)),
        failed_by_shape=int(np.count_nonzero(failed.shape)),
        failed_by_size=int(np.count_nonzero(failed.size)),
        failed_by_size_alone=int(np.count_nonzero(failed.size_alone)),
        shape_severity=float(failed.shape_severity.sum()),
        size_severity=float(failed.size_severity.sum()),
        adjacent_trias=int(np.count_nonzero(both)),
        border_trias=int(np.count_nonzero(tria & at_border.any(axis=1))),
        irregular=int(np.count_nonzero(judged.irregular)),
        inverted=int(np.count_nonzero((shapes.scaled_jacobian <= 0.0) | folded)),
        same_nodes=len(duplicates(mesh)),
        least_scaled_jacobian=float(shapes.scaled_jacobian.min(initial=1.0)),
        mean_scaled_jacobian=float(shapes.scaled_jacobian.mean()) if len(tria) else 1.0,
        least_angle=float(shapes.least_angle.min(initial=90.0)),
        greatest_angle=float(shapes.greatest_angle.max(initial=0.0)),
        least_size=ratio.least,
        greatest_size=ratio.greatest,
        areas=areas_by_region(mesh, folded),
    )


def _irregular(mesh: ShellMesh, edges: Edges, kinds: Kinds) -> Bools:
    inner = used_nodes(mesh)
    inner[edges.nodes[kinds != INSIDE]] = False
    corners = mesh.elements[mesh.elements != NO_NODE]
    irregular: Bools = inner & (np.bincount(corners, minlength=len(inner)) != 4)
    return irregular


def _bounds(scoring: Scoring) -> tuple[float, float]:
    """Ratios to the gradation between which an edge passes the limits of length."""
    bounds = []
    for name, default in (("min size", LEAST), ("max length", MOST)):
        criterion = scoring.criteria[name]
        bounds.append(criterion.levels[3] if criterion.scaled and criterion.active else default)
    return bounds[0], bounds[1]


def _lost_locks(before: ShellMesh, changes: Changes) -> int:
    nodes = before.locked_nodes & used_nodes(before) & ~changes.kept_nodes
    elements = before.locked_elements & ~changes.kept_elements
    return int(np.count_nonzero(nodes) + np.count_nonzero(elements))
