"""Planar parts, meshed by every configuration of gmsh, each result improved.

A start counts unless gmsh gave no mesh, a folded one, or one with a border edge that fails by
itself: whatever is meshed inside, the element at that edge fails.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import repeat
from math import isfinite
from typing import Any

import numpy as np

from benchmarks.improving import CRITERIA, improved, job_of, processes
from benchmarks.isolation import IsolatedError
from benchmarks.measures import Shape, parity_bound
from benchmarks.parts import Part
from benchmarks.peers import Configuration, gmsh_mesh
from benchmarks.report import Row
from meshops.criteria import LEVELS, SLACK, Scoring
from meshops.criteria_files import load_criteria
from meshops.mesh import ShellMesh
from meshops.quality_index import quality_index
from meshops.topology import topology

TO_SOLVE, TO_LEAD = 30.0, 60.0
"""Seconds within which a start must be solved, and be ahead of every configuration of gmsh."""

FLOW, PATIENCE = 1000, 1000
"""Rounds for a better flow, and cycles without a gain: more than there is time for."""


@dataclass(frozen=True, eq=False)
class Start:
    """What gmsh made of a part.

    Attributes
    ----------
    part : Part
    configuration : Configuration
    mesh : ShellMesh or None
    shape : Shape or None
    excuse : str
        Why it does not count; empty where it does.
    """

    part: Part
    configuration: Configuration
    mesh: ShellMesh | None
    shape: Shape | None
    excuse: str

    @classmethod
    def of(cls, part: Part, configuration: Configuration) -> Start:
        """Mesh the part."""
        try:
            mesh = gmsh_mesh(part, configuration)
        except IsolatedError as error:
            return cls(part, configuration, None, None, str(error))
        scoring = scoring_of(part)
        excuse = "folded" if is_folded(mesh) else ""
        if failing := failing_border_edges(mesh, scoring):
            excuse = f"{failing} border edges fail"
        return cls(part, configuration, mesh, Shape.of(mesh, scoring), excuse)


@dataclass(frozen=True)
class Trial:
    """What became of a start within `TO_LEAD` seconds; it ends sooner where it is ahead of gmsh.

    Attributes
    ----------
    part, configuration : str
    failed_before, trias_before, failed, trias, bound : int
        The bound is the fewest trias that the borders allow.
    solved_after : float
        Seconds until no element failed and just the bound of trias was left.
    seconds : float
        Until the end.
    shape : Shape
        At the end.
    """

    part: str
    configuration: str
    failed_before: int
    trias_before: int
    failed: int
    trias: int
    bound: int
    solved_after: float
    seconds: float
    shape: Shape


def planar(
    parts: Sequence[Part], configurations: Sequence[Configuration], workers: int
) -> tuple[list[Row], dict[str, Any]]:
    """Improve every start of every part, so many at a time."""
    rows: list[Row] = []
    details: dict[str, Any] = {}
    with processes(workers) as pool:
        for part in parts:
            starts = [Start.of(part, configuration) for configuration in configurations]
            counted = [start for start in starts if not start.excuse]
            trials = list(pool.map(_trial, counted, repeat(_best(starts))))
            rows += _rows(part, starts, trials)
            details[part.name] = {
                "trials": [_plain(trial) for trial in trials],
                "listed": {str(s.configuration): s.excuse for s in starts if s.excuse},
                "gmsh": {str(s.configuration): vars(s.shape) for s in starts if s.shape},
            }
    return rows, details


def scoring_of(part: Part) -> Scoring:
    """Return the criteria at the size of a part."""
    return load_criteria(CRITERIA).at(part.size)


def failing_border_edges(mesh: ShellMesh, scoring: Scoring) -> int:
    """Count the border edges that are too short or too long by themselves."""
    found = topology(mesh)
    ends = mesh.points[found.edges[found.is_border]]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    fail = LEVELS.index("fail")
    shortest, longest = (
        scoring.criteria[name].levels[fail] * scoring.size for name in ("min size", "max length")
    )
    slack = SLACK * scoring.size
    return int(np.count_nonzero((lengths < shortest - slack) | (lengths > longest + slack)))


def is_folded(mesh: ShellMesh) -> bool:
    """Whether two neighbours of a plane mesh disagree about which side is up."""
    found = topology(mesh, feature_angle=180.0)
    return not bool(found.crossable[found.uses == 2].all())


def _best(starts: Sequence[Start]) -> tuple[float, int]:
    """Lowest mean element Q.I. and fewest singular nodes of what gmsh made of a part."""
    shapes = [start.shape for start in starts if start.shape]
    return min(s.index for s in shapes), min(s.singular_nodes for s in shapes)


def _trial(start: Start, best: tuple[float, int]) -> Trial:
    assert start.mesh is not None
    part = start.part
    scoring = scoring_of(part)

    def is_ahead(mesh: ShellMesh) -> bool:
        quality, shape = quality_index(mesh, scoring), Shape.of(mesh, scoring)
        solved = (quality.failed, quality.trias) == (0, parity_bound(mesh))
        return solved and shape.index < best[0] and shape.singular_nodes < best[1]

    name = f"{part.name}, {start.configuration}"
    job = job_of(name, start.mesh, size=part.size, flow=FLOW, patience=PATIENCE)
    found = improved(job, TO_LEAD, is_ahead)
    before, after = found.done.before, found.done.after
    return Trial(
        part=part.name,
        configuration=str(start.configuration),
        failed_before=before.failed,
        trias_before=before.trias,
        failed=after.failed,
        trias=after.trias,
        bound=found.bound,
        solved_after=found.solved_after,
        seconds=found.done.seconds,
        shape=Shape.of(found.done.mesh, scoring),
    )


def _rows(part: Part, starts: Sequence[Start], trials: Sequence[Trial]) -> Iterator[Row]:
    peers = [start for start in starts if start.shape]
    seconds = [trial.solved_after for trial in trials]
    solved = sum(value <= TO_SOLVE for value in seconds)
    listed = sum(bool(start.excuse) for start in starts)
    yield Row(
        f"{part.name}: 0 failed, trias at the parity bound",
        f"{solved} of {len(trials)} starts ({listed} listed apart), {_median_and_worst(seconds)} s",
        f"all within {TO_SOLVE:g} s",
        solved == len(trials),
    )
    for name, figure in (("mean element Q.I.", "index"), ("singular nodes", "singular_nodes")):
        best, peer = min((getattr(p.shape, figure), p.configuration) for p in peers)
        values = [getattr(trial.shape, figure) for trial in trials]
        ahead = sum(value < best for value in values)
        yield Row(
            f"{part.name}: {name}",
            f"{ahead} of {len(trials)} below gmsh, {_median_and_worst(values)}",
            f"all < {best:.3g} ({peer})",
            ahead == len(trials),
        )


def _median_and_worst(values: Sequence[float]) -> str:
    if not values:
        return "none"
    return f"median {statistics.median(values):.3g}, worst {max(values):.3g}"


def _plain(trial: Trial) -> dict[str, Any]:
    """Return a trial as what JSON can hold; None where it was never solved."""
    seconds = trial.solved_after if isfinite(trial.solved_after) else None
    return vars(trial) | {"solved_after": seconds, "shape": vars(trial.shape)}
