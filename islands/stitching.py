"""Stitching: what was found for each subdomain of a mesh is performed, polished and put back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from islands.integration_ga import Problem, Work
from islands.island import IslandState
from islands.procedure import Place, Round, Step, perform_steps, subdomain_setting
from meshops.edit import apply
from meshops.mesh import ShellMesh
from meshops.operations.smooth import METHODS, Smooth
from meshops.patch import join
from meshops.reference import Reference
from meshops.subdomain import Aim, Subdomain
from meshops.workpiece import Workpiece

STRAIGHTEN, POLISH = (
    Step(Smooth().code, np.array([[1, 40, METHODS.index(method)]], np.int32))
    for method in ("laplace", "even")
)
"""Smoothing of all nodes around the worst element, far enough for a subdomain of usual size."""


def subdomain_work(problem: Problem, reference: Reference, subdomain: Subdomain, aim: Aim) -> Work:
    """Make a subdomain something for an archipelago to improve.

    Where faults are the aim it is done as soon as there are none.
    """
    return Work(
        replace(
            problem,
            setting=subdomain_setting(problem.setting, subdomain),
            reference=reference.around(subdomain.patch),
        ),
        subdomain.mesh,
        subdomain.least_trias if aim == "faults" else -1,
    )


def stitched(
    mesh: ShellMesh,
    empty: Round,
    found: Sequence[Subdomain],
    works: Sequence[Work],
    states: Sequence[IslandState],
) -> tuple[Round, ShellMesh]:
    """Perform what was found in each subdomain, polish it, and put all of them back.

    `empty` is the round before it has places.
    """
    done, edits = [], []
    for subdomain, work, state in zip(found, works, states, strict=False):
        x, y, z = subdomain.centre.tolist()
        steps = state.best_steps
        if steps:
            problem = work.problem
            after = perform_steps(
                work.mesh, steps, problem.operations, problem.setting, problem.reference
            )
            steps, after = _polished(after, steps, problem, empty.aim)
            edits.append(subdomain.edit(mesh, after))
        done.append(Place((x, y, z), steps))
    return replace(empty, places=tuple(done)), apply(mesh, join(mesh, edits))


def _polished(
    mesh: ShellMesh, steps: tuple[Step, ...], problem: Problem, aim: Aim
) -> tuple[tuple[Step, ...], ShellMesh]:
    """Smooth a whole subdomain as last steps, where that makes it fitter.

    Where flow is the aim, straight rows are reason enough.
    """
    setting = replace(problem.setting, fitness=replace(problem.fitness, kind="quality"))
    if not any(operation.code == POLISH.code for operation in problem.operations):
        return steps, mesh
    for step in (POLISH,) if aim == "faults" else (STRAIGHTEN, POLISH):
        workpiece = Workpiece(mesh, setting, problem.reference)
        edit = Smooth().apply(workpiece, step.parameters)
        after = workpiece.tally + workpiece.tally_change(edit)
        before, smoothed = workpiece.fitness(np.stack([workpiece.tally, after]))
        if smoothed > before or (step is STRAIGHTEN and smoothed == before):
            steps, mesh = (*steps, step), apply(mesh, edit)
    return steps, mesh
