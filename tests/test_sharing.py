"""Sharing: whatever order hosts answer in, each archipelago goes its own way to its piece."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from islands.archipelago import Archipelago, Milestone, Mode
from islands.executors import sharing
from islands.executors.crew import Job
from islands.executors.sharing import Sharing
from islands.finishing import Piece
from islands.stopping import Stopping
from tests.decks import bad_plate
from tests.scripted import Goal, archipelago, sail, same, schedule, scripted_step

MESH = bad_plate()


@pytest.fixture(autouse=True)
def _no_store(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sharing.Parcel, "of", lambda work, batch: (work, batch))


def answer(job: Job, pieces: list[int]) -> Any:
    """Do a job as a host would."""
    arguments = job.arguments(False)  # noqa: FBT003
    if job.method == "step":
        return scripted_step(arguments["asked"])
    pieces.append(arguments["number"])
    return arguments["number"], Piece(arguments["steps"], MESH)


def shared_out(
    going: list[Archipelago], hosts: int, rng: np.random.Generator, most: float = np.inf
) -> tuple[list[Milestone], Sharing, list[int]]:
    """Let hosts answer in any order, one job each at a time; so many answers at the most."""
    share, found, pieces = Sharing(going, 0, hosts), list[Milestone](), list[int]()
    at: dict[int, Job] = {}
    answers = 0
    while not share.is_over and answers < most:
        for host in range(hosts):
            if host not in at and (job := share.next_job(host)):
                at[host] = job
        assert at, "it would wait for ever"
        host = int(rng.choice(sorted(at)))
        found += share.take(answer(at.pop(host), pieces))
        answers += 1
    return found, share, pieces


def start(count: int, islands: int, mode: Mode, solved_at: float, evaluations: int | None) -> Any:
    plan = schedule(islands, 4, delay=1, mode=mode, stopping=Stopping(evaluations=evaluations))
    # one in two is solved, at any time
    return [archipelago(plan, Goal(solved_at if n % 2 else np.inf), n) for n in range(count)]


ARCHIPELAGOS: dict[str, Any] = {
    "given_": st.tuples(
        st.integers(1, 4),
        st.integers(1, 4),
        st.sampled_from(["synchronous", "overlapped"]),
        st.integers(1, 6),
        st.sampled_from([None, 30]),
    ),
    "hosts": st.integers(1, 6),
    "seed": st.integers(0, 10**6),
}


@settings(max_examples=60, deadline=None)
@given(**ARCHIPELAGOS)
def test_each_goes_its_own_way_whoever_answers_first(
    given_: tuple[Any, ...], hosts: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    found, _, pieces = shared_out(start(*given_), hosts, rng)
    assert sorted(pieces) == list(range(given_[0]))
    for alone in start(*given_):
        expected = sail(alone, rng).milestones
        own = [milestone for milestone in found if milestone.work == alone.number]
        assert len(own) == len(expected)
        assert all(same(one, other) for one, other in zip(own, expected, strict=True))
        assert [m.piece is not None for m in own] == [m.is_last for m in own]


@settings(max_examples=60, deadline=None)
@given(**ARCHIPELAGOS, most=st.integers(0, 60))
def test_where_time_is_up_nothing_is_lost_that_was_reached(
    given_: tuple[Any, ...], hosts: int, seed: int, most: int
) -> None:
    going = start(*given_)
    found, share, _ = shared_out(going, hosts, np.random.default_rng(seed), most)
    found += share.without_pieces()
    over = {a.number for a in going if a.is_over}
    assert sorted(m.work for m in found if m.is_last) == sorted(over)


def test_what_is_over_already_is_not_waited_for() -> None:
    plan = schedule(2, 3)
    *_, last = sail(archipelago(plan, Goal()), np.random.default_rng(0)).milestones
    assert Sharing([Archipelago(0, Goal(), plan, last)], 0, 2).is_over  # type: ignore[arg-type]
