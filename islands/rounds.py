"""Rounds: subdomains around the bad places are evolved, stitched back, and cut anew elsewhere."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from islands.archipelago import Archipelago, Executor, Schedule, Status, evolve_archipelagos
from islands.finishing import Piece, finished
from islands.integration_ga import Problem, Work
from islands.island import IslandState
from islands.procedure import Round, all_aims, perform_rounds
from islands.rates import (
    adapted_rates,
    credits_of,
    first_credit,
    flow_rates,
    named_rates,
    small_rates,
)
from islands.reporter import Reporter
from islands.search import Evolution, Plan, SearchState, Watchers
from islands.sliding import slid
from islands.stitching import stitched, subdomain_work
from meshops.guard import guarded
from meshops.mesh import Floats, ShellMesh
from meshops.quality_sums import FAILED, IRREGULAR, SHAPE_FAILED, TRIAS
from meshops.reference import Reference
from meshops.subdomain import Extent, Subdomain, places, subdomains
from meshops.workpiece import Workpiece
from tracking.events import RoundReport

BATCH = 64
"""Subdomains that are evolved at the same time, which bounds the memory."""

FADING = 0.7
"""Of an operation's credit that lasts to the next round."""

WORTHWHILE = 0.02
"""Faults that a round removes, per subdomain, for which the next one keeps its extent."""

LEADING = (Extent(3, 60), Extent(6, 160), Extent(12, 500))
"""Of the first rounds, in which only small edits are tried: of repairs that mend the same the
smallest is the best, and these are found in no time."""

FLOW = Extent(rings=20, elements=800)
"""Of the subdomains in which irregular nodes are to vanish: these come in pairs that are far apart,
and are worth looking for in each other's reach."""

TIDY = Extent(rings=8, elements=200)
"""Of those in which the irregular nodes that a repair brought are to vanish: its neighbourhood."""

FLOW_PATIENCE = 2
"""Rounds for a better flow in vain, over the plan's patience, after which there are no more."""

DENSE, DENSE_LEVEL = 0.1, 2
"""Share of bad places among the elements from which the first extent is this one."""


def evolve_rounds(
    problem: Problem,
    start: ShellMesh | SearchState,
    reference: Reference,
    plan: Plan,
    schedule: Schedule,
    executor: Executor,
    watch: Watchers,
) -> Evolution:
    """Evolve procedures for all bad places of a mesh, round by round, until nothing improves.

    What one subdomain becomes does not depend on the others of its round, so the work grows with
    the number of bad places and can be shared out. A search that starts from a state goes on as
    the one that was there, and ends with the same mesh.
    """
    return _Search(problem, reference, plan, schedule, executor, watch).run(start)


class _Search:
    """A search on its way from round to round."""

    state: SearchState
    workpiece: Workpiece
    best: Workpiece

    def __init__(
        self,
        problem: Problem,
        reference: Reference,
        plan: Plan,
        schedule: Schedule,
        executor: Executor,
        watch: Watchers,
    ) -> None:
        self.problem = problem
        self.reference = reference
        self.origin = Workpiece(reference.mesh, problem.setting)
        self.plan = plan
        self.schedule = schedule
        self.executor = executor
        self.watch = watch

    def run(self, start: ShellMesh | SearchState) -> Evolution:
        """Go on from round to round until there is a reason to stop."""
        status: Status = "finished"
        goes_on = isinstance(start, SearchState)
        mesh = start.mesh if isinstance(start, SearchState) else start
        self.workpiece = self.best = Workpiece(mesh, self.problem.setting)
        self.state = start if isinstance(start, SearchState) else self._first()
        if self.state.best is not mesh:
            self.best = Workpiece(self.state.best, self.problem.setting)
        try:
            if self.plan.rounds and not goes_on:
                self._slide()
            kept = -1
            while status == "finished" and not self.state.is_done:
                if self.state.reports > kept:
                    kept = self.state.reports
                    self.watch.keep(self.state)
                status = self._tidy() if self.state.reason else self._go_on()
        except KeyboardInterrupt:
            status = "interrupted"
        state = self.state
        rounds = state.rounds[: state.best_rounds]
        reason = state.reason if status == "finished" else ""
        mesh = guarded(self.origin, state.best, all_aims(rounds))
        return Evolution(mesh, rounds, state.evaluations, state.performed, status, reason)

    def _first(self) -> SearchState:
        # larger subdomains at once where places are dense, and small ones would be in the way
        mesh = self.workpiece.mesh
        share = len(places(self.workpiece)) / max(len(mesh.elements), 1)
        level = min(DENSE_LEVEL, len(self.plan.extents) - 1) if share > DENSE else 0
        return SearchState(
            mesh=mesh,
            best=mesh,
            rounds=(),
            best_rounds=0,
            credit=first_credit(self.problem),
            turn=0,
            batches=0,
            evaluations=0,
            performed=0,
            reports=0,
            level=-len(LEADING),
            first_level=level,
            cycle=0,
            aim="faults",
            flows_left=self.plan.flow,
            flows_in_vain=0,
            reason="",
            is_done=False,
        )

    def _set(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)

    def _take(self, mesh: ShellMesh, done: Round) -> None:
        """Go on with the mesh that a round has made."""
        self.workpiece = Workpiece(mesh, self.problem.setting)
        self._set(mesh=mesh, rounds=(*self.state.rounds, done))

    def _go_on(self) -> Status:
        """Do a round, or find another extent or aim for the next, or a reason to end."""
        turn = self.state.turn
        if turn == self.plan.rounds + self.plan.flow:
            return self._end("all rounds are done")
        self._set(turn=turn + 1)
        found = subdomains(self.workpiece, self._extent, turn, self.state.aim)
        if not found:
            if self._looks_elsewhere():
                return "finished"
            return self._end("nothing is left to gain")
        before = self.best
        status = self._do_round(turn, found)
        if status != "finished":
            return status
        state, stopping = self.state, self.schedule.stopping
        reasons = stopping.of_run(state.evaluations, self._fitness(self.best))
        if self.best is not before and self.watch.is_enough(state.best):
            reasons.append("the mesh is good enough")
        if reasons:
            self._set(reason="; ".join(reasons), is_done=True)
        elif state.cycle > self.plan.patience:
            self._end(f"{self.plan.patience} cycles brought no gain")
        return status

    def _looks_elsewhere(self) -> bool:
        """Go on where no subdomain was found with a larger extent, or for a better flow."""
        if self.state.aim != "faults":
            return False
        if self._has_larger_extent and len(places(self.workpiece)):
            # each fault's subdomain has a border that allows no less
            self._set(level=self._larger)
        elif self.state.flows_left:
            self._set(aim="flow")
        else:
            return False
        return True

    def _end(self, reason: str) -> Status:
        """Give the reason; what tidies is left, as many rounds from here on."""
        self._set(reason=reason, aim="tidy", turn=0)
        return "finished"

    def _tidy(self) -> Status:
        """Let the irregular nodes vanish that came with new elements, from the fittest mesh on."""
        state, turn = self.state, self.state.turn
        self.workpiece = self.best
        self._set(mesh=state.best, rounds=state.rounds[: state.best_rounds], turn=turn + 1)
        if turn < self.plan.tidy:
            found = subdomains(self.workpiece, self._extent, turn, state.aim)
            if found:
                return self._do_round(turn, found)
        self._set(is_done=True)
        return "finished"

    def _slide(self) -> None:
        """Let border nodes slide, before anything else, where fewer elements fail by that."""
        done = slid(self.problem, self.workpiece, self.reference)
        if done is None or done.extent is None:
            return
        mesh, setting = self.workpiece.mesh, self.problem.setting
        operations = self.problem.operations
        self._take(perform_rounds(mesh, (done,), operations, setting, self.reference), done)
        self.best = self.workpiece
        self._set(best=self.state.mesh, best_rounds=1)
        problem = replace(self.problem, weights=adapted_rates(self.state.credit))
        self._report(done, done.extent, problem, [], [])

    def _do_round(self, turn: int, found: list[Subdomain]) -> Status:
        before, extent, state = self.workpiece, self._extent, self.state
        if state.aim == "faults":
            # the first round takes what can be had without any harm: soon there is a better mesh
            problem = self.problem
            if state.batches:
                problem = moving_on(problem, state.cycle, before.tally)
            leads = state.level < 0
            weights = small_rates(problem) if leads else adapted_rates(state.credit)
            problem = replace(problem, weights=weights, turn=turn)
        else:
            problem = replace(self.problem, weights=flow_rates(self.problem), turn=turn)
        drifts = problem.drifts
        works = [
            subdomain_work(problem, self.reference, part, state.aim, keeps_neutral=drifts)
            for part in found
        ]
        states, pieces, status = self._evolve(works)
        empty = Round(extent, turn, (), state.aim, drifts)
        done, mesh = stitched(self.origin, before, empty, found, pieces)
        self._take(mesh, done)
        self._report(done, extent, problem, works, states)
        if state.aim == "faults":
            self._set(credit=FADING * state.credit + credits_of(done, problem))
            self._compare(before, problem, len(works))
        elif state.aim == "flow":
            self._compare_flow()
        else:
            self._remember()
        return status

    def _evolve(self, works: list[Work]) -> tuple[list[IslandState], list[Piece], Status]:
        """Evolve the works batch by batch; fewer states and pieces than works where time is up."""
        tally = self.workpiece.tally
        # more effort where less of it, or less room, was not enough
        now = self.state
        grown = max(now.level - now.first_level, 0) + now.cycle
        if now.aim != "faults":
            grown = now.flows_in_vain
        generations = min(grown, self.schedule.generations)
        of_each = replace(self.schedule.stopping, evaluations=None, target=None)
        effort = replace(self.schedule, generations=generations, stopping=of_each)
        states, pieces = list[IslandState](), list[Piece]()
        for first in range(0, len(works), BATCH):
            batch = works[first : first + BATCH]
            roots = np.stack([work.root.tally for work in batch])
            reporter = Reporter(
                record=self.watch.record,
                setting=self.problem.setting,
                operations=self.problem.operations,
                tally=tally,
                roots=roots,
                generation=self.state.batches * (self.schedule.generations + 1),
                evaluations=self.state.evaluations,
                performed=self.state.performed,
                started=self.watch.started,
            )
            archipelagos = [Archipelago(i, work, effort) for i, work in enumerate(batch)]
            result = evolve_archipelagos(archipelagos, self.executor, reporter.watch)
            self._set(
                batches=self.state.batches + 1,
                evaluations=self.state.evaluations + result.evaluations,
                performed=self.state.performed + result.performed,
            )
            states += result.best
            pieces += [
                piece or finished(work, state.best_steps)
                for work, state, piece in zip(batch, result.best, result.pieces, strict=True)
            ]
            for state, root in zip(result.best, roots, strict=True):
                if state.best_steps:
                    tally = tally + state.best_tally - root
            if result.status != "finished":
                return states, pieces, result.status
        return states, pieces, "finished"

    def _compare(self, before: Workpiece, problem: Problem, works: int) -> None:
        """Remember the fittest mesh, and choose the extent of the next round."""
        tally = self.workpiece.tally
        self._remember()
        if problem.fitness.of_faults(tally) <= problem.fitness.of_faults(before.tally):
            gained = 0.0
        else:
            gained = float(np.abs(tally - before.tally)[[FAILED, TRIAS]].sum())
        if self._has_larger_extent:
            stays = self.state.level >= 0 and gained >= WORTHWHILE * works
            self._set(level=self.state.level if stays else self._larger)
        elif not gained:
            aim = "flow" if self.state.flows_left else "faults"
            self._set(cycle=self.state.cycle + 1, level=0, aim=aim)

    def _compare_flow(self) -> None:
        """Remember the fittest mesh, and go on while that brings something and faults do not."""
        in_vain = 0 if self._remember() else self.state.flows_in_vain + 1
        is_over = in_vain == FLOW_PATIENCE * self.plan.patience
        left = 0 if is_over else self.state.flows_left - 1
        aim = "faults" if len(places(self.workpiece)) or not left else "flow"
        self._set(flows_left=left, flows_in_vain=in_vain, aim=aim)

    def _remember(self) -> bool:
        """Remember the mesh if it is the fittest so far; whether it is."""
        if self._fitness(self.workpiece) <= self._fitness(self.best):
            return False
        fitness = self.problem.fitness
        if fitness.of_faults(self.workpiece.tally) > fitness.of_faults(self.best.tally):
            self._set(cycle=0)
        self.best = self.workpiece
        self._set(best=self.state.mesh, best_rounds=len(self.state.rounds))
        return True

    @property
    def _extent(self) -> Extent:
        state = self.state
        if state.aim != "faults":
            return FLOW if state.aim == "flow" else TIDY
        return (*LEADING, *self.plan.extents)[len(LEADING) + state.level]

    @property
    def _larger(self) -> int:
        """The level of the next extent."""
        return self.state.first_level if self.state.level == -1 else self.state.level + 1

    def _fitness(self, workpiece: Workpiece) -> float:
        return float(workpiece.fitness(workpiece.tally[None])[0])

    @property
    def _has_larger_extent(self) -> bool:
        return self.state.level + 1 < len(self.plan.extents)

    def _report(
        self,
        done: Round,
        extent: Extent,
        problem: Problem,
        works: list[Work],
        states: list[IslandState],
    ) -> None:
        tally = self.workpiece.tally
        solved = [
            bool(state.best_steps) and work.is_solved(state.best_tally)
            for work, state in zip(works, states, strict=False)
        ]
        self._set(reports=self.state.reports + 1)
        self.watch.record(
            RoundReport(
                turn=done.turn,
                rings=extent.rings,
                places=len(done.places),
                changed=sum(bool(place.steps) for place in done.places),
                solved=sum(solved),
                failed=int(tally[FAILED]),
                trias=int(tally[TRIAS]),
                irregular=int(tally[IRREGULAR]),
                evaluations=self.state.evaluations,
                performed=self.state.performed,
                seconds=time.monotonic() - self.watch.started,
                rates=named_rates(problem),
            )
        )


def moving_on(problem: Problem, cycle: int, tally: Floats) -> Problem:
    """Return the problem as a search takes it up that stood still `cycle` times.

    Trias come first where no element fails: what fails for their sake is the easier to mend, and
    comes first again in the next round, so that a run that is cut short has not lost by it. A
    search that stands still gives both the first place in turn, and drifts among equal meshes.
    """
    setting = problem.setting
    trias_first = cycle % 2 == 1 if cycle else tally[SHAPE_FAILED] == 0
    fitness = replace(setting.fitness, kind="quads" if trias_first else "quality")
    return replace(problem, setting=replace(setting, fitness=fitness), drifts=cycle > 0)
