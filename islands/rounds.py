"""Rounds: subdomains around the bad places are evolved, stitched back, and cut anew elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from islands.archipelago import Executor, Schedule, Status, evolve_archipelago
from islands.integration_ga import Problem, Work
from islands.island import IslandState
from islands.procedure import Place, Round, perform_steps, subdomain_setting
from islands.reporter import Reporter
from meshops.edit import apply
from meshops.kernels.quality import FAILED, TRIAS
from meshops.mesh import Floats, ShellMesh
from meshops.patch import join
from meshops.reference import Reference
from meshops.subdomain import Extent, Subdomain, places, subdomains
from meshops.workpiece import Workpiece
from tracking.events import Event, RoundReport

BATCH = 64
"""Subdomains that are evolved at the same time, which bounds the memory."""

LEAST_RATE = 0.3
"""Of an even share: what an operation that never paid off is still drawn with."""

FADING = 0.7
"""Of an operation's credit that lasts to the next round."""


@dataclass(frozen=True)
class Plan:
    """Which subdomains are cut out in which round.

    Attributes
    ----------
    extents : tuple of Extent
        From small to large; the next one follows where a round has gained nothing.
    rounds : int
        The most.
    patience : int
        Rounds without a gain at the largest extent after which the run ends.
    """

    extents: tuple[Extent, ...]
    rounds: int
    patience: int


@dataclass(frozen=True, eq=False)
class Evolution:
    """What rounds made of a mesh."""

    mesh: ShellMesh
    rounds: tuple[Round, ...]
    evaluations: int
    status: Status
    reason: str


def evolve_rounds(
    problem: Problem,
    mesh: ShellMesh,
    reference: Reference,
    plan: Plan,
    schedule: Schedule,
    executor: Executor,
    record: Callable[[Event], None],
    started: float,
) -> Evolution:
    """Evolve procedures for all bad places of a mesh, round by round, until nothing improves.

    What one subdomain becomes does not depend on the others of its round, so the work grows with
    the number of bad places and can be shared out.
    """
    credit = np.zeros(len(problem.codes))
    rounds: list[Round] = []
    evaluations = batches = level = cycle = best_rounds = 0
    best_mesh, best_tally = mesh, Workpiece(mesh, problem.setting).tally
    status: Status = "finished"
    reason = "all rounds are done"
    try:
        for turn in range(plan.rounds):
            workpiece = Workpiece(mesh, problem.setting)
            found = subdomains(workpiece, plan.extents[level], turn)
            if not found and level + 1 < len(plan.extents) and len(places(workpiece)):
                level += 1  # each fault has a subdomain whose border does not allow less
                continue
            if not found:
                reason = "nothing is left to gain"
                break
            drawn = replace(moving_on(problem, cycle), weights=adapted_rates(credit), turn=turn)
            works = [subdomain_work(drawn, reference, subdomain) for subdomain in found]
            tally = workpiece.tally
            best: list[IslandState] = []
            for first in range(0, len(works), BATCH):
                batch = works[first : first + BATCH]
                roots = np.stack([work.root.tally for work in batch])
                reporter = Reporter(
                    record=record,
                    setting=problem.setting,
                    operations=problem.operations,
                    tally=tally,
                    roots=roots,
                    generation=batches * (schedule.generations + 1),
                    evaluations=evaluations,
                    started=started,
                )
                effort = replace(schedule, generations=min(level + cycle, schedule.generations))
                result = evolve_archipelago(batch, effort, executor, reporter.watch, reporter.post)
                best += result.best
                tally = tally + sum(
                    s.best_tally - r
                    for s, r in zip(result.best, roots, strict=True)
                    if s.best_steps
                )
                evaluations += result.evaluations
                batches += 1
                status = result.status
                if status != "finished":
                    break
            done = Round(
                plan.extents[level],
                turn,
                tuple(
                    Place(tuple(subdomain.centre.tolist()), state.best_steps)
                    for subdomain, state in zip(found, best, strict=False)
                ),
            )
            mesh = _stitched(mesh, found, works, done)
            rounds.append(done)
            credit = FADING * credit + credits_of(done, problem)
            record(
                RoundReport(
                    turn=turn,
                    rings=plan.extents[level].rings,
                    places=len(done.places),
                    changed=sum(bool(place.steps) for place in done.places),
                    solved=sum(
                        bool(s.best_steps) and w.is_solved(s.best_tally)
                        for w, s in zip(works, best, strict=False)
                    ),
                    failed=int(tally[FAILED]),
                    trias=int(tally[TRIAS]),
                    evaluations=evaluations,
                    seconds=time.monotonic() - started,
                    rates=_named_rates(drawn),
                )
            )
            if _faults(tally) < _faults(best_tally):
                best_mesh, best_tally, best_rounds = mesh, tally, len(rounds)
                cycle = 0
            own = drawn.fitness.of_faults(tally) > drawn.fitness.of_faults(workpiece.tally)
            if not own and level + 1 < len(plan.extents):
                level += 1
            elif not own:
                cycle, level = cycle + 1, 0
                if cycle > plan.patience:
                    reason = f"{plan.patience} cycles brought no gain"
                    break
            if status != "finished":
                break
    except KeyboardInterrupt:
        status = "interrupted"
    return Evolution(best_mesh, tuple(rounds[:best_rounds]), evaluations, status, reason)


def moving_on(problem: Problem, cycle: int) -> Problem:
    """Return the problem as a search takes it up that stood still `cycle` times.

    It gives failed elements and trias the first place in turn, and drifts among equal meshes.
    """
    if not cycle:
        return problem
    setting = problem.setting
    fitness = replace(setting.fitness, kind="quads" if cycle % 2 else "quality")
    return replace(problem, setting=replace(setting, fitness=fitness), drifts=True)


def subdomain_work(problem: Problem, reference: Reference, subdomain: Subdomain) -> Work:
    """Make a subdomain something for an archipelago to improve."""
    return Work(
        replace(
            problem,
            setting=subdomain_setting(problem.setting, subdomain),
            reference=reference.around(subdomain.patch),
        ),
        subdomain.mesh,
        subdomain.least_trias,
    )


def adapted_rates(credit: Floats) -> Floats:
    """(C,) how often each operation is drawn: more often what has paid off."""
    even = np.full(len(credit), 1.0 / len(credit))
    if not credit.any():
        return even
    rates: Floats = LEAST_RATE * even + (1.0 - LEAST_RATE) * credit / credit.sum()
    normalised: Floats = rates / rates.sum()
    return normalised


def credits_of(done: Round, problem: Problem) -> Floats:
    """(C,) how many steps of the fittest procedures of a round were of each operation."""
    codes = [step.code for place in done.places for step in place.steps if len(step.parameters)]
    return np.array([codes.count(code) for code in problem.codes], np.float64)


def _named_rates(problem: Problem) -> dict[str, float]:
    names = {operation.code: operation.name for operation in problem.operations}
    rates = problem.weights if problem.weights is not None else np.zeros(0)
    return {
        names.get(code, "nothing"): round(float(rate), 4)
        for code, rate in zip(problem.codes, rates, strict=True)
    }


def _stitched(
    mesh: ShellMesh, found: Sequence[Subdomain], works: Sequence[Work], done: Round
) -> ShellMesh:
    edits = []
    for subdomain, work, place in zip(found, works, done.places, strict=False):
        problem = work.problem
        after = perform_steps(
            subdomain.mesh, place.steps, problem.operations, problem.setting, problem.reference
        )
        edits.append(subdomain.edit(mesh, after))
    return apply(mesh, join(mesh, edits))


def _faults(tally: Floats) -> tuple[float, float]:
    return tally[FAILED], tally[TRIAS]
