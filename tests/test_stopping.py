"""What ends a search, and that its reason is told."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from islands.island import IslandState
from islands.stopping import Stopping
from meshops.examples import plate
from tests.jobs import finish, job, whole_job
from tracking.events import Event, RoundReport, RunFinished


def island(number: int, genomes: list[list[int]], **values: float) -> IslandState:
    state = IslandState.first(0, number)
    return replace(state, generation=3, genomes=np.array(genomes), **values)  # type: ignore[arg-type]


TWO = (
    island(0, [[1, 2], [1, 2]], stagnant=2, best_fitness=9.0, evaluations=10),
    island(1, [[1, 2], [3, 4]], stagnant=4, best_fitness=8.0, evaluations=30),
)


@pytest.mark.parametrize(
    ("stopping", "words"),
    [
        (Stopping(), []),
        (Stopping(evaluations=41, target=9.5, stagnation=3, diversity=0.5), []),
        (Stopping(evaluations=40), ["40 of 40 evaluations"]),
        (Stopping(target=9.0), ["the fitness is 9 and 9 was asked for"]),
        (Stopping(stagnation=2), ["2 generations found nothing better"]),
        (Stopping(diversity=0.6), ["50% of the genomes differ"]),
        (Stopping(evaluations=1, target=1.0, stagnation=1, diversity=1.0), ["9", "40", "2", "50%"]),
    ],
)
def test_each_rule_ends_a_search_on_its_own_and_all_reasons_are_told(
    stopping: Stopping, words: list[str]
) -> None:
    reasons = stopping.of_both(TWO)
    assert len(reasons) == len(words)
    assert all(word in reason for word, reason in zip(words, reasons, strict=True))


def test_nothing_ends_before_its_first_generation() -> None:
    stopping = Stopping(evaluations=1, target=-1.0, stagnation=1, diversity=1.0)
    assert stopping.of_both([IslandState.first(0, 0)]) == []


@given(st.integers(1, 100), st.integers(0, 100), st.floats(0, 100), st.floats(0, 100))
def test_a_run_ends_at_its_limit_and_not_before(
    limit: int, spent: int, wanted: float, fitness: float
) -> None:
    assert bool(Stopping(evaluations=limit).of_run(spent, 0.0)) == (spent >= limit)
    assert bool(Stopping(target=wanted).of_run(0, fitness)) == (fitness >= wanted)


def ended(events: list[Event]) -> RunFinished:
    (last,) = (event for event in events if isinstance(event, RunFinished))
    return last


def test_rounds_end_after_the_one_that_spends_the_evaluations() -> None:
    events: list[Event] = []
    limit = 100
    finish(job(plate(), evaluations=limit), events)
    spent = [event.evaluations for event in events if isinstance(event, RoundReport)]
    assert spent[-1] >= limit > max(spent[:-1], default=0)
    assert f"of {limit} evaluations" in ended(events).reason


def test_rounds_end_where_the_fitness_is_reached() -> None:
    events: list[Event] = []
    done = finish(job(plate(), target_fitness=99.9), events)
    assert done.fitness >= 99.9
    assert "was asked for" in ended(events).reason


def test_one_archipelago_ends_by_its_rules() -> None:
    events: list[Event] = []
    finish(whole_job(plate(), generations=9, stagnation=1), events)
    assert "found nothing better" in ended(events).reason
