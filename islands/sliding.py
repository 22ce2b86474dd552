"""Sliding before anything else: what border nodes can mend alone needs no search."""

from __future__ import annotations

import numpy as np

from islands.integration_ga import Problem
from islands.procedure import Place, Round, Step, subdomain_setting
from meshops.edit import apply
from meshops.operations.slide import SHIFTS, Slide
from meshops.quality_sums import SHAPE, SIZE
from meshops.reference import Reference
from meshops.subdomain import Extent, Subdomain, subdomains
from meshops.workpiece import Workpiece

EXTENT = Extent(40, 2000)
"""Of the subdomains: long strips fit in, and large areas do not take long."""

TIMES = 3
"""That the border nodes of a subdomain slide at the most."""


def slid(problem: Problem, workpiece: Workpiece, reference: Reference) -> Round | None:
    """Slide in each subdomain of a mesh, where fewer elements fail by that; None where in none.

    No other operation has changed anything yet that stood in the way, and elements that pass are
    left alone by those that follow. It takes no random numbers.
    """
    operation = Slide()
    if operation not in problem.operations or not workpiece.topology.sliding_nodes.any():
        return None
    places = []
    for subdomain in subdomains(workpiece, EXTENT, 0):
        x, y, z = subdomain.centre.tolist()
        steps = _steps(operation, subdomain, workpiece, reference)
        places.append(Place((x, y, z), steps))
    return Round(EXTENT, 0, tuple(places)) if any(place.steps for place in places) else None


def _steps(
    operation: Slide, subdomain: Subdomain, around: Workpiece, reference: Reference
) -> tuple[Step, ...]:
    """Slide as long as fewer elements fail, each time by the shift that makes it fittest."""
    steps: list[Step] = []
    setting = subdomain_setting(around.setting, subdomain)
    workpiece = Workpiece(subdomain.mesh, setting)
    if not (workpiece.topology.sliding_nodes.any() and workpiece.mendable.any()):
        return ()
    workpiece = Workpiece(subdomain.mesh, setting, reference.around(subdomain.patch))
    while len(steps) < TIMES:
        choices = [np.array([[1, EXTENT.rings, k]], np.int32) for k in range(len(SHIFTS))]
        edits = [operation.apply(workpiece, choice) for choice in choices]
        tallies = workpiece.tally + np.stack([workpiece.tally_change(edit) for edit in edits])
        best = int(np.argmax(workpiece.fitness(tallies)))
        if tuple(tallies[best][[SHAPE, SIZE]]) >= tuple(workpiece.tally[[SHAPE, SIZE]]):
            break
        steps.append(Step(operation.code, choices[best]))
        mesh = apply(workpiece.mesh, edits[best])
        workpiece = Workpiece(mesh, setting, workpiece.reference)
    return tuple(steps)
