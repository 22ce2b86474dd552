"""The common judge of small edits: every guard and the quality, for many candidates at once."""

from __future__ import annotations

import numpy as np

from meshops._core import nearest
from meshops.kernels.judging import judge_candidates
from meshops.mesh import Bools, Floats
from meshops.operations.candidates import Candidates
from meshops.quality_sums import ELEMENTS
from meshops.surface import PLANE_TOLERANCE, PatchSurface
from meshops.workpiece import Workpiece

SURFACE_TOLERANCE = 0.1
"""Of the edge length: how far a new place, or the centre of a new element, may be from the surface.
It is the level at which the chordal deviation of the standard criteria fails."""


def judge(workpiece: Workpiece, candidates: Candidates) -> Floats:
    """(K, TALLY_SIZE) tally of the whole mesh after each candidate alone.

    NaN where a guard forbids the candidate or where it does nothing. The guards: what goes may be
    taken out and is of one zone; the border of what comes is that of what goes; no barrier runs
    inside; nodes that move or vanish are free; no edge and no element comes twice; every element
    that comes or whose nodes move is sound and faces the way it did; new places are on the
    surface.
    """
    mesh, topology = workpiece.mesh, workpiece.topology
    start, around = workpiece.around
    tallies, edges, centres = judge_candidates(
        *candidates.arrays,
        mesh.points,
        mesh.elements,
        topology.element_edges,
        topology.edge_elements,
        topology.crossable,
        topology.zones,
        topology.free_nodes,
        start,
        around,
        workpiece.outside,
        workpiece.values,
        workpiece.tally,
        *workpiece.setting.scoring.arrays,
    )
    whole = np.isfinite(tallies[:, ELEMENTS])
    tallies[_leaves_surface(workpiece.surface, candidates, whole, edges, centres)] = np.nan
    judged: Floats = tallies
    return judged


def _leaves_surface(
    surface: PatchSurface, candidates: Candidates, asked: Bools, edges: Floats, centres: Floats
) -> Bools:
    """(K,) bool: which of the candidates that are asked for have a place off the surface.

    On a plane that is a new point, or one that a node moves to; elsewhere also the centre of a new
    element (B, 3). `edges` (K,) is the edge length that the tolerance is taken of.
    """
    queries = np.concatenate([candidates.points, candidates.moved_to, centres])
    owners = np.concatenate(
        [
            np.repeat(np.arange(len(candidates)), np.diff(start))
            for start in (candidates.point_start, candidates.moved_start, candidates.added_start)
        ]
    )
    wanted = asked[owners]
    queries, owners = queries[wanted], owners[wanted]
    if surface.plane is not None:
        distance = np.abs((queries - surface.points[0]) @ surface.plane)
        limit = np.full(len(queries), PLANE_TOLERANCE * float(np.ptp(surface.points, axis=0).max()))
    else:
        spheres = surface.spheres
        distance = nearest(queries, surface.points, surface.trias, spheres)[1]
        limit = SURFACE_TOLERANCE * edges[owners]
    leaves = np.zeros(len(candidates), bool)
    leaves[owners[~(distance <= limit)]] = True
    return leaves
