"""Stitching: subdomains of a mesh become works, and what became of them is put back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from islands.finishing import Piece, polish_for
from islands.integration_ga import Problem, Work
from islands.procedure import Place, Round, subdomain_setting
from meshops.fitness import limits_of
from meshops.guard import guarded_edits
from meshops.mesh import ShellMesh
from meshops.reference import Reference
from meshops.subdomain import Aim, Subdomain
from meshops.workpiece import Workpiece


def subdomain_work(
    problem: Problem,
    reference: Reference,
    subdomain: Subdomain,
    aim: Aim,
    *,
    keeps_neutral: bool = False,
) -> Work:
    """Make a subdomain something for an archipelago to improve.

    Where faults are the aim it is done as soon as there are none.
    """
    setting = subdomain_setting(problem.setting, subdomain)
    workpiece = Workpiece(subdomain.mesh, setting)
    limits = limits_of(workpiece.tally)
    return Work(
        replace(
            problem,
            setting=replace(setting, fitness=replace(setting.fitness, limits=limits)),
            reference=reference.around(subdomain.patch),
        ),
        subdomain.mesh,
        least_trias=subdomain.least_trias if aim == "faults" else -1,
        least_size=workpiece.severity_in_rows,
        aim=aim,
        keeps_neutral=keeps_neutral,
        polish=polish_for(aim, problem.operations),
    )


def stitched(
    origin: Workpiece,
    before: Workpiece,
    empty: Round,
    found: Sequence[Subdomain],
    pieces: Sequence[Piece],
) -> tuple[Round, ShellMesh]:
    """Put back what became of subdomains, of as many as there are pieces.

    `origin` is the mesh that the run began with, `empty` the round before it has places.
    """
    done, edits = [], []
    for subdomain, piece in zip(found, pieces, strict=False):
        x, y, z = subdomain.centre.tolist()
        if piece.steps:
            edits.append(subdomain.edit(before.mesh, piece.mesh))
        done.append(Place((x, y, z), piece.steps))
    after = guarded_edits(before, edits, empty.aim, origin=origin, neutral=empty.keeps_neutral)
    return replace(empty, places=tuple(done)), after
