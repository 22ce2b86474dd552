"""Search: what a run over rounds is told, what it is between two of them, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from islands.archipelago import Milestone, Status
from islands.procedure import Round
from meshops.mesh import Floats, ShellMesh
from meshops.subdomain import Aim, Extent
from tracking.events import Event


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
class SearchState:
    """All that a search is between two rounds: what goes on from it does not know how it came.

    Attributes
    ----------
    mesh, best : ShellMesh
        The mesh of the last round, and the fittest one so far.
    rounds : tuple of Round
        All that lead to `mesh`; the first `best_rounds` lead to `best`.
    best_rounds : int
    credit : (C,) float64
        Of the operations, for what has paid off.
    turn, batches, evaluations, performed, reports : int
        Rounds that were tried, batches of subdomains, individuals of operation GAs that were asked
        for and that were scored for that, rounds that were reported.
    level, first_level, cycle : int
        Which extent comes next, which came first, and how often all of them brought no gain.
    aim : "faults", "flow" or "tidy"
    flows_left, flows_in_vain : int
        Rounds for a better flow.
    reason : str
        Why the rounds are over and just those that tidy are left; empty before.
    is_done : bool
    """

    mesh: ShellMesh
    best: ShellMesh
    rounds: tuple[Round, ...]
    best_rounds: int
    credit: Floats
    turn: int
    batches: int
    evaluations: int
    performed: int
    reports: int
    level: int
    first_level: int
    cycle: int
    aim: Aim
    flows_left: int
    flows_in_vain: int
    reason: str
    is_done: bool


State = SearchState | Milestone
"""What a run goes on from: over rounds, or of one archipelago for the whole mesh."""


@dataclass(frozen=True, eq=False)
class Evolution:
    """What rounds made of a mesh."""

    mesh: ShellMesh
    rounds: tuple[Round, ...]
    evaluations: int
    performed: int
    status: Status
    reason: str


@dataclass(frozen=True)
class Watchers:
    """Who follows a search.

    Attributes
    ----------
    record : callable
        Takes the events.
    keep : callable
        Takes the state after each round that was not cut short, or the milestone after each
        generation where there are no rounds.
    is_enough : callable
        Whether a mesh ends the search earlier; asked of each one that is the fittest so far.
    started : float
        The time.monotonic() from which seconds count.
    """

    record: Callable[[Event], None]
    keep: Callable[[State], None]
    is_enough: Callable[[ShellMesh], bool]
    started: float
