"""Rounds: subdomains around the bad places are evolved, stitched back, and cut anew elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from islands.archipelago import Executor, Schedule, Status, evolve_archipelago
from islands.integration_ga import Problem, Work
from islands.island import IslandState
from islands.procedure import Round, perform
from islands.rates import adapted_rates, credits_of, first_credit, flow_rates, named_rates
from islands.reporter import Reporter
from islands.sliding import slid
from islands.stitching import stitched, subdomain_work
from meshops.kernels.quality import FAILED, IRREGULAR, TRIAS
from meshops.mesh import Floats, ShellMesh
from meshops.reference import Reference
from meshops.subdomain import Aim, Extent, Subdomain, places, subdomains
from meshops.workpiece import Workpiece
from tracking.events import Event, RoundReport

BATCH = 64
"""Subdomains that are evolved at the same time, which bounds the memory."""

FADING = 0.7
"""Of an operation's credit that lasts to the next round."""

WORTHWHILE = 0.02
"""Faults that a round removes, per subdomain, for which the next one keeps its extent."""

FLOW = Extent(rings=20, elements=800)
"""Of the subdomains in which irregular nodes are to vanish: these come in pairs that are far apart,
and are worth looking for in each other's reach."""

TIDY = Extent(rings=8, elements=200)
"""Of those in which the irregular nodes that a repair brought are to vanish: its neighbourhood."""

FLOW_PATIENCE = 2
"""Rounds for a better flow in vain, over the plan's patience, after which there are no more."""

DENSE, DENSE_LEVEL = 0.1, 2
"""Share of bad places among the elements from which the first extent is this one."""


@dataclass(frozen=True)
class Plan:
    """Which subdomains are cut out in which round.

    Attributes
    ----------
    extents : tuple of Extent
        From small to large; the next one follows where a round has gained too little.
    rounds : int
        The most.
    patience : int
        Times that all extents bring no gain, one after the other, after which the run ends.
    flow : int
        The most rounds for a better flow: one after each time that all extents bring no gain, and
        the others once there are no faults left.
    tidy : int
        The most rounds at the end for a better flow where elements are new.
    """

    extents: tuple[Extent, ...]
    rounds: int
    patience: int
    flow: int
    tidy: int


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
    is_enough: Callable[[ShellMesh], bool],
) -> Evolution:
    """Evolve procedures for all bad places of a mesh, round by round, until nothing improves.

    A mesh that `is_enough` ends it earlier.

    What one subdomain becomes does not depend on the others of its round, so the work grows with
    the number of bad places and can be shared out.
    """
    search = _Search(problem, mesh, reference, plan, schedule, executor, record, started, is_enough)
    return search.run()


class _Search:
    """A search on its way from round to round."""

    def __init__(
        self,
        problem: Problem,
        mesh: ShellMesh,
        reference: Reference,
        plan: Plan,
        schedule: Schedule,
        executor: Executor,
        record: Callable[[Event], None],
        started: float,
        is_enough: Callable[[ShellMesh], bool],
    ) -> None:
        self.problem = problem
        self.reference = reference
        self.plan = plan
        self.schedule = schedule
        self.executor = executor
        self.record = record
        self.started = started
        self.is_enough = is_enough
        self.workpiece = Workpiece(mesh, problem.setting)
        self.best = self.workpiece
        self.rounds: list[Round] = []
        self.best_rounds = 0
        self.credit = first_credit(problem)
        self.evaluations = 0
        self.batches = 0
        self.level = self.first_level = self._first_level()
        self.cycle = 0
        self.aim: Aim = "faults"
        self.flows_left = plan.flow
        self.flows_in_vain = 0

    def _first_level(self) -> int:
        """Larger subdomains at once where places are dense, and small ones would be in the way."""
        share = len(places(self.workpiece)) / max(len(self.workpiece.mesh.elements), 1)
        return min(DENSE_LEVEL, len(self.plan.extents) - 1) if share > DENSE else 0

    def run(self) -> Evolution:
        """Go on from round to round until there is a reason to stop."""
        status: Status = "finished"
        reason = "all rounds are done"
        try:
            if self.plan.rounds:
                self._slide()
            for turn in range(self.plan.rounds + self.plan.flow):
                found = subdomains(self.workpiece, self._extent, turn, self.aim)
                if found:
                    status = self._do_round(turn, found)
                elif not self._looks_elsewhere():
                    reason = "nothing is left to gain"
                    break
                if status != "finished":
                    break
                if self.is_enough(self.best.mesh):
                    reason = "the mesh is good enough"
                    break
                if self.cycle > self.plan.patience:
                    reason = f"{self.plan.patience} cycles brought no gain"
                    break
            if status == "finished":
                status = self._tidy()
        except KeyboardInterrupt:
            status = "interrupted"
        rounds = tuple(self.rounds[: self.best_rounds])
        return Evolution(self.best.mesh, rounds, self.evaluations, status, reason)

    def _looks_elsewhere(self) -> bool:
        """Go on where no subdomain was found with a larger extent, or for a better flow."""
        if self.aim != "faults":
            return False
        if self._has_larger_extent and len(places(self.workpiece)):
            self.level += 1  # each fault's subdomain has a border that allows no less
        elif self.flows_left:
            self.aim = "flow"
        else:
            return False
        return True

    def _tidy(self) -> Status:
        """Let the irregular nodes vanish that came with new elements, from the fittest mesh on."""
        self.aim = "tidy"
        status: Status = "finished"
        for turn in range(self.plan.tidy):
            self.workpiece = self.best
            del self.rounds[self.best_rounds :]
            found = subdomains(self.workpiece, self._extent, turn, self.aim)
            if not found or status != "finished":
                break
            status = self._do_round(turn, found)
        return status

    def _slide(self) -> None:
        """Let border nodes slide, before anything else, where fewer elements fail by that."""
        done = slid(self.problem, self.workpiece, self.reference)
        if done is None or done.extent is None:
            return
        mesh, setting = self.workpiece.mesh, self.problem.setting
        mesh = perform(mesh, (done,), self.problem.operations, setting, self.reference)
        self.workpiece = self.best = Workpiece(mesh, setting)
        self.rounds.append(done)
        self.best_rounds = 1
        problem = replace(self.problem, weights=adapted_rates(self.credit))
        self._report(done, done.extent, problem, [], [])

    def _do_round(self, turn: int, found: list[Subdomain]) -> Status:
        before, extent = self.workpiece, self._extent
        if self.aim == "faults":
            # the first round takes what can be had without any harm: soon there is a better mesh
            problem = self.problem
            if self.batches:
                problem = moving_on(problem, self.cycle, before.tally)
            problem = replace(problem, weights=adapted_rates(self.credit), turn=turn)
        else:
            problem = replace(self.problem, weights=flow_rates(self.problem), turn=turn)
        works = [
            subdomain_work(problem, self.reference, subdomain, self.aim) for subdomain in found
        ]
        states, status = self._evolve(works)
        empty = Round(extent, turn, (), self.aim)
        done, mesh = stitched(before.mesh, empty, found, works, states)
        self.workpiece = Workpiece(mesh, self.problem.setting)
        self.rounds.append(done)
        self._report(done, extent, problem, works, states)
        if self.aim == "faults":
            self.credit = FADING * self.credit + credits_of(done, problem)
            self._compare(before, problem, len(works))
        elif self.aim == "flow":
            self._compare_flow()
        else:
            self._remember()
        return status

    def _evolve(self, works: list[Work]) -> tuple[list[IslandState], Status]:
        """Evolve the works batch by batch; fewer states than works where time is up."""
        tally = self.workpiece.tally
        # more effort where less of it, or less room, was not enough
        grown = max(self.level - self.first_level, 0) + self.cycle
        if self.aim != "faults":
            grown = self.flows_in_vain
        generations = min(grown, self.schedule.generations)
        effort = replace(self.schedule, generations=generations)
        states: list[IslandState] = []
        for first in range(0, len(works), BATCH):
            batch = works[first : first + BATCH]
            roots = np.stack([work.root.tally for work in batch])
            reporter = Reporter(
                record=self.record,
                setting=self.problem.setting,
                operations=self.problem.operations,
                tally=tally,
                roots=roots,
                generation=self.batches * (self.schedule.generations + 1),
                evaluations=self.evaluations,
                started=self.started,
            )
            result = evolve_archipelago(batch, effort, self.executor, reporter.watch, reporter.post)
            self.batches += 1
            self.evaluations += result.evaluations
            states += result.best
            for state, root in zip(result.best, roots, strict=True):
                if state.best_steps:
                    tally = tally + state.best_tally - root
            if result.status != "finished":
                return states, result.status
        return states, "finished"

    def _compare(self, before: Workpiece, problem: Problem, works: int) -> None:
        """Remember the fittest mesh, and choose the extent of the next round."""
        tally = self.workpiece.tally
        self._remember()
        if problem.fitness.of_faults(tally) <= problem.fitness.of_faults(before.tally):
            gained = 0.0
        else:
            gained = float(np.abs(tally - before.tally)[[FAILED, TRIAS]].sum())
        if self._has_larger_extent:
            self.level += gained < WORTHWHILE * works
        elif not gained:
            self.cycle, self.level = self.cycle + 1, 0
            self.aim = "flow" if self.flows_left else "faults"

    def _compare_flow(self) -> None:
        """Remember the fittest mesh, and go on while that brings something and faults do not."""
        self.flows_left -= 1
        self.flows_in_vain = 0 if self._remember() else self.flows_in_vain + 1
        if self.flows_in_vain == FLOW_PATIENCE * self.plan.patience:
            self.flows_left = 0
        if len(places(self.workpiece)) or not self.flows_left:
            self.aim = "faults"

    def _remember(self) -> bool:
        """Remember the mesh if it is the fittest so far; whether it is."""
        if self._fitness(self.workpiece) <= self._fitness(self.best):
            return False
        fitness = self.problem.fitness
        if fitness.of_faults(self.workpiece.tally) > fitness.of_faults(self.best.tally):
            self.cycle = 0
        self.best, self.best_rounds = self.workpiece, len(self.rounds)
        return True

    @property
    def _extent(self) -> Extent:
        return {"faults": self.plan.extents[self.level], "flow": FLOW, "tidy": TIDY}[self.aim]

    def _fitness(self, workpiece: Workpiece) -> float:
        return float(workpiece.fitness(workpiece.tally[None])[0])

    @property
    def _has_larger_extent(self) -> bool:
        return self.level + 1 < len(self.plan.extents)

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
        self.record(
            RoundReport(
                turn=done.turn,
                rings=extent.rings,
                places=len(done.places),
                changed=sum(bool(place.steps) for place in done.places),
                solved=sum(solved),
                failed=int(tally[FAILED]),
                trias=int(tally[TRIAS]),
                irregular=int(tally[IRREGULAR]),
                evaluations=self.evaluations,
                seconds=time.monotonic() - self.started,
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
    trias_first = cycle % 2 == 1 if cycle else tally[FAILED] == 0
    fitness = replace(setting.fitness, kind="quads" if trias_first else "quality")
    return replace(problem, setting=replace(setting, fitness=fitness), drifts=cycle > 0)
