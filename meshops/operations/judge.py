"""The common judge of small edits: every guard and the quality, for many candidates at once."""

from __future__ import annotations

from meshops._core import evaluate_candidates
from meshops.mesh import Floats
from meshops.operations.candidates import Candidates
from meshops.surface import PLANE_TOLERANCE
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
    return evaluate_candidates(
        candidates,
        workpiece,
        workpiece.setting.scoring.core,
        PLANE_TOLERANCE,
        SURFACE_TOLERANCE,
    )
