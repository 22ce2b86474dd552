"""Relaxing the nodes around each of many small edits."""

from __future__ import annotations

from dataclasses import replace

from meshops._core import relax_candidates
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
    points, moved_start, moved, moved_to = relax_candidates(
        candidates, workpiece, MOST_ELEMENTS, sweeps
    )
    return replace(
        candidates, points=points, moved_start=moved_start, moved=moved, moved_to=moved_to
    )
