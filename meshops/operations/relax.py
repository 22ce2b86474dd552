"""Relaxing the nodes around each of many small edits."""

from __future__ import annotations

from dataclasses import replace

from meshops.kernels.relaxation import relax_candidates
from meshops.operations.candidates import Candidates
from meshops.workpiece import Workpiece

SWEEPS = 3

MOST_ELEMENTS = 400
"""A candidate around whose nodes are more elements is not relaxed."""


def relax(workpiece: Workpiece, candidates: Candidates, *, sweeps: int = SWEEPS) -> Candidates:
    """Let the free nodes around each candidate find better places, on the surface.

    New elements of another shape need another place for their nodes: without that, few changes of
    the topology are worth it. Smart Laplacian smoothing (Freitag 1997).
    """
    mesh = workpiece.mesh
    points, moved_start, moved, moved_to = relax_candidates(
        *candidates.arrays,
        mesh.points,
        mesh.elements,
        *workpiece.around,
        workpiece.topology.free_nodes,
        MOST_ELEMENTS,
        sweeps,
    )
    workpiece.surface.project(points, 0)
    workpiece.surface.project(moved_to, 0)
    return replace(
        candidates, points=points, moved_start=moved_start, moved=moved, moved_to=moved_to
    )
