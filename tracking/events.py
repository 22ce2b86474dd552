"""The events of a run: all that the rest of the program tells to tracking.

Events hold plain scalars, strings, tuples and mappings, so that every recorder can keep them as it
likes. A recorder sees one ``RunStarted``, then reports, then one ``RunFinished``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol

Setting = str | int | float | bool
Status = Literal["finished", "interrupted", "time-limit", "failed"]


@dataclass(frozen=True)
class MeshSummary:
    """A mesh in figures.

    Attributes
    ----------
    elements, quads, trias : int
    failed : int
        Elements that fail a criterion.
    compound_qi : float
        The sum of the elements' Q.I.; 0 is perfect.
    failed_by_shape, failed_by_size : int
        Those of the failed that fail a criterion of shape, and those that fail by size alone.
    """

    elements: int
    quads: int
    trias: int
    failed: int
    compound_qi: float
    failed_by_shape: int = 0
    failed_by_size: int = 0


@dataclass(frozen=True)
class RunStarted:
    """The first event of a run.

    Attributes
    ----------
    name : str
        The deck's base name.
    run_id : str
        Names this run and no other. A run that is resumed keeps it, and its record goes on.
    seed : int
    backend : str
        Where the operation GAs run, e.g. ``"local"``.
    islands : int
    settings : Mapping
        All settings, flat.
    before : MeshSummary
    note : str
        The user's own words about the run.
    told : tuple of str
        What the user should know before it runs: by what it judges, what is locked and why.
    """

    name: str
    run_id: str
    seed: int
    backend: str
    islands: int
    settings: Mapping[str, Setting]
    before: MeshSummary
    note: str = ""
    told: tuple[str, ...] = ()


@dataclass(frozen=True)
class GenerationReport:
    """What an island has to tell after a generation.

    Attributes
    ----------
    island, generation : int
    best, mean, worst : float
        Fitness over the individuals of this generation; more is better.
    best_so_far : float
        Fitness of the island's best procedure so far; it never falls.
    trias, failed, compound_qi
        Of the mesh that the best procedure so far makes.
    evaluations, performed : int
        Individuals of operation GAs that the procedures of all islands asked for since the start
        of the run, and those of them that were scored: the others were known.
    seconds : float
        Time since the start of the run.
    procedure : str
        The best procedure so far, in the form of the paper's figure 10.
    """

    island: int
    generation: int
    best: float
    mean: float
    worst: float
    best_so_far: float
    trias: int
    failed: int
    compound_qi: float
    evaluations: int
    performed: int
    seconds: float
    procedure: str


@dataclass(frozen=True)
class MigrationReport:
    """An individual has gone from one island to another after a generation."""

    generation: int
    source: int
    target: int
    fitness: float
    genome: tuple[int, ...]


@dataclass(frozen=True)
class FaultReport:
    """An individual could not be scored, and has the worst fitness for that.

    Attributes
    ----------
    generation, island : int
    reason : str
    """

    generation: int
    island: int
    reason: str


@dataclass(frozen=True)
class RoundReport:
    """What a round over all bad places of a mesh has brought.

    Attributes
    ----------
    turn : int
        Where its subdomains were cut: from 0, and from 0 again where it only tidies up.
    rings : int
        How far the places reached.
    places, changed, solved : int
        Places that were worked on, those that are better now, those without a fault now.
    failed, trias, irregular : int
        Of the whole mesh after the round; irregular are inner nodes of other than four elements.
    evaluations, performed : int
        Individuals of operation GAs since the start of the run: asked for, and scored for that.
    seconds : float
        Since the start of the run.
    rates : Mapping
        How often each operation was drawn, by its name.
    number : int
        Of the rounds of the run, from 1.
    step : int
        Later than all generations before it: it only rises.
    """

    turn: int
    rings: int
    places: int
    changed: int
    solved: int
    failed: int
    trias: int
    irregular: int
    evaluations: int
    performed: int
    seconds: float
    rates: Mapping[str, float]
    number: int = 0
    step: int = 0


@dataclass(frozen=True)
class RunFinished:
    """The last event of a run, whatever ended it.

    Attributes
    ----------
    status : Status
    reason : str
        Why the run ended, in words.
    after : MeshSummary or None
        The mesh that the best procedure makes; None where there is none.
    fitness : float
        Of the best procedure.
    seconds : float
    evaluations, performed : int
        Individuals of operation GAs over all islands: asked for, and scored for that.
    procedure : str
        The best procedure, in the form of the paper's figure 10.
    digest : str
        The content hash of the mesh ``after``.
    worse : tuple of str
        In what the mesh is worse than the run found it, a phrase each.
    step : int
        Later than all generations.
    """

    status: Status
    reason: str
    after: MeshSummary | None
    fitness: float
    seconds: float
    evaluations: int
    performed: int
    procedure: str
    digest: str
    worse: tuple[str, ...] = ()
    step: int = 0


Event = RunStarted | GenerationReport | MigrationReport | FaultReport | RoundReport | RunFinished


def known_before(report: GenerationReport | RunFinished) -> float:
    """Share of the individuals that procedures asked for and that were known already."""
    return 1.0 - report.performed / report.evaluations if report.evaluations else 0.0


class Recorder(Protocol):
    """Remembers or shows events."""

    def record(self, event: Event) -> None:
        """Take one event; returns soon."""

    def keep(self, paths: Sequence[Path]) -> None:
        """Take the files that the run has made; called at most once, before ``close``."""

    def close(self) -> None:
        """Finish what is begun and let go of everything held; a second call does nothing."""
