"""Finishing: the fittest procedure of an archipelago is performed on its mesh, and polished."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from islands.integration_ga import Work
from islands.procedure import Step, perform_steps
from meshops.edit import apply
from meshops.guard import guarded
from meshops.mesh import ShellMesh
from meshops.operations import Operation
from meshops.operations.smooth import METHODS, Smooth, Smoothing
from meshops.subdomain import Aim
from meshops.workpiece import Workpiece

POLISH_RINGS = 40
"""Of smoothing around the worst element: far enough for a subdomain of usual size."""


@dataclass(frozen=True, eq=False)
class Piece:
    """What becomes of the mesh of a work by its fittest procedure, polished.

    Attributes
    ----------
    steps : tuple of Step
        That lead to it, the polish among them; none: the mesh is as it was.
    mesh : ShellMesh
    """

    steps: tuple[Step, ...]
    mesh: ShellMesh


def polish_for(aim: Aim, operations: Sequence[Operation]) -> tuple[Smoothing, ...]:
    """Return the smoothings that are tried last; none where smoothing is not asked for."""
    if not any(operation.code == Smooth.code for operation in operations):
        return ()
    return ("even",) if aim == "faults" else ("laplace", "even")


def finished(work: Work, steps: tuple[Step, ...], mesh: ShellMesh | None = None) -> Piece:
    """Perform steps on the mesh of a work, smooth it where that makes it fitter, and guard it.

    `mesh` is what the steps lead to, where that is known. For straight rows it is enough that
    nothing gets worse. No steps are left where nothing of what they do is kept.
    """
    if not steps:
        return Piece(steps, work.mesh)
    problem = work.problem
    if mesh is None:
        mesh = perform_steps(
            work.mesh, steps, problem.operations, problem.setting, problem.reference
        )
    setting = replace(problem.setting, fitness=replace(problem.fitness, kind="quality"))
    smooth = Smooth()
    root = Workpiece(work.mesh, setting, problem.reference)
    for method in work.polish:
        parameters = np.array([[1, POLISH_RINGS, METHODS.index(method)]], np.int32)
        workpiece = Workpiece(mesh, setting, problem.reference)
        edit = smooth.apply(workpiece, parameters)
        after = workpiece.tally + workpiece.tally_change(edit)
        before, smoothed = workpiece.fitness(np.stack([workpiece.tally, after]))
        if smoothed > before or (method == "laplace" and smoothed == before):
            steps, mesh = (*steps, Step(smooth.code, parameters)), apply(mesh, edit)
    if work.aim is not None:
        mesh = guarded(root, mesh, work.aim, neutral=work.keeps_neutral)
    return Piece(steps if mesh is not work.mesh else (), mesh)
