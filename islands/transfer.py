"""Transfer: a procedure that was found on one mesh, performed on another without any search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from islands.procedure import Place, Procedure, Round, Step, perform_steps, subdomain_setting
from meshops.edit import Edit
from meshops.errors import InputError
from meshops.guard import guarded, guarded_edits
from meshops.mesh import Floats, ShellMesh
from meshops.operations import Operation
from meshops.reference import Reference
from meshops.subdomain import Aim, Subdomain, subdomains
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece


def transfer(
    procedure: Procedure, mesh: ShellMesh, operations: tuple[Operation, ...], setting: Setting
) -> tuple[ShellMesh, tuple[Round, ...]]:
    """Perform a procedure on a mesh that it was not found on.

    Each subdomain of the mesh takes the steps of the recorded place that is nearest to it, in
    parts of the box around either mesh, as far as they make it fitter: a step names places by how
    bad they are and not by id, so it means something on any mesh, and one that does harm is left
    out with those after it. The mesh never gets worse.

    Returns the mesh and the rounds that make it of the given one. Raises InputError where the
    procedure names elements by their numbers, as the paper's do.
    """
    if any(done.extent is None for done in procedure.rounds):
        raise InputError(
            "a procedure for a whole mesh names elements by their numbers, which mean nothing on "
            "another mesh; find one with the default profile."
        )
    reference = Reference(mesh, setting.feature_angle)
    box = np.array([mesh.points.min(axis=0), mesh.points.max(axis=0)])
    origin, rounds = Workpiece(mesh, setting), []
    for done in procedure.rounds:
        assert done.extent is not None
        known = [place for place in done.places if place.steps]
        if not known:
            continue
        centres = _relative(np.array([place.centre for place in known]), procedure.box)
        start = Workpiece(mesh, setting)
        places, edits = [], []
        for subdomain in subdomains(start, done.extent, done.turn, done.aim):
            steps = known[_nearest(centres, _relative(subdomain.centre[None], box))].steps
            surface = reference.around(subdomain.patch)
            place, edit = _take_over(mesh, subdomain, steps, operations, setting, surface, done.aim)
            places.append(place)
            edits.append(edit)
        if any(place.steps for place in places):
            mesh = guarded_edits(start, edits, done.aim, origin=origin)
            rounds.append(replace(done, places=tuple(places), keeps_neutral=False))
    return mesh, tuple(rounds)


def _nearest(centres: Floats, centre: Floats) -> int:
    """Row of the nearest of centres (P, 3) to one (1, 3); the first of equals."""
    return int(np.argmin(np.linalg.norm(centres - centre, axis=1)))


def _relative(points: Floats, box: Floats) -> Floats:
    extent = box[1] - box[0]
    relative: Floats = (points - box[0]) / np.where(extent > 0.0, extent, 1.0)
    return relative


def _take_over(
    mesh: ShellMesh,
    subdomain: Subdomain,
    steps: tuple[Step, ...],
    operations: tuple[Operation, ...],
    setting: Setting,
    surface: PatchSurface,
    aim: Aim,
) -> tuple[Place, Edit]:
    """Perform steps on a subdomain up to the one after which it is fittest."""
    own = subdomain_setting(setting, subdomain)
    x, y, z = subdomain.centre.tolist()

    def fitness(part: ShellMesh) -> float:
        workpiece = Workpiece(part, own)
        return float(workpiece.fitness(workpiece.tally[None])[0])

    current = best = subdomain.mesh
    best_fitness, used = fitness(current), 0
    for number, step in enumerate(steps, 1):
        current = perform_steps(current, (step,), operations, own, surface)
        if fitness(current) > best_fitness:
            best, best_fitness, used = current, fitness(current), number
    best = guarded(Workpiece(subdomain.mesh, own, surface), best, aim)
    used = 0 if best is subdomain.mesh else used
    return Place((x, y, z), steps[:used]), subdomain.edit(mesh, best)
