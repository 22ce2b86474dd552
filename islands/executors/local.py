"""Islands in this process, one after the other, sharing what they learn."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from islands.archipelago import TimeUpError
from islands.genetics import Breeding
from islands.integration_ga import Evaluator, Handle, Outcome, Problem, Task, run_task
from islands.island import IslandState, Migrants, step
from meshops.mesh import ShellMesh
from meshops.workpiece import Workpiece


@dataclass(frozen=True, eq=False)
class LocalRunner:
    """Runs operation GAs here; `deadline` is a time of time.monotonic()."""

    problem: Problem
    deadline: float

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle]]:
        """Run one after the other; TimeUpError where the deadline has passed."""
        results = []
        for task, mesh in jobs:
            if time.monotonic() >= self.deadline:
                raise TimeUpError
            results.append(run_task(self.problem, task, mesh))
        return results


class LocalExecutor:
    """All islands in this process."""

    def __init__(
        self,
        problem: Problem,
        mesh: ShellMesh,
        breeding: Breeding,
        genes: int,
        *,
        deadline: float = float("inf"),
    ) -> None:
        root = root_outcome(problem, mesh)
        self._evaluator = Evaluator(problem, LocalRunner(problem, deadline), root, mesh)
        self._breeding = breeding
        self._genes = genes

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        """Step the islands in turn."""
        for state, immigrants in steps:
            yield step(state, immigrants, self._evaluator, self._breeding, self._genes)

    def close(self) -> None:
        """Nothing is held."""


def root_outcome(problem: Problem, mesh: ShellMesh) -> Outcome:
    """Take the mesh that every procedure starts from as the outcome of no operation."""
    workpiece = Workpiece(mesh, problem.setting)
    return Outcome(mesh.digest, workpiece.tally, mesh.elements[:0, :2], 0)
