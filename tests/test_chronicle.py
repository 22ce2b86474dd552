"""The record of a run holds together: the best never falls, steps only rise."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from islands.chronicle import Chronicle
from tests.jobs import finish, job
from tests.meshes import make
from tracking.events import GenerationReport, RoundReport, RunFinished

REPORT = GenerationReport(0, 0, 90.0, 80.0, 70.0, 92.0, 8, 4, 1.2, 10, 9, 1.0, "first")
ROUND = RoundReport(0, 3, 12, 7, 4, 9, 6, 8, 42, 21, 3.3, {})
END = RunFinished("finished", "done", None, 95.0, 9.0, 100, 90, "", "")

told_things = st.lists(
    st.one_of(
        st.builds(
            lambda island, best, trias: replace(
                REPORT, island=island, best_so_far=best, trias=trias
            ),
            st.integers(0, 2),
            st.floats(0, 100),
            st.integers(0, 20),
        ),
        st.just(ROUND),
    ),
    max_size=30,
)


def numbered(events):
    """Generations rise from one report to the next."""
    return [
        replace(e, generation=n) if isinstance(e, GenerationReport) else e
        for n, e in enumerate(events)
    ]


@given(told_things, st.integers(0, 30))
def test_the_best_never_falls_and_steps_only_rise(events, cut):
    events = [*numbered(events), END]
    chronicle = Chronicle()
    told = [chronicle.told(event) for event in events]
    for island in range(3):
        bests = [e for e in told if isinstance(e, GenerationReport) and e.island == island]
        values = [e.best_so_far for e in bests]
        assert values == sorted(values)
        given_ = [e for e in events if isinstance(e, GenerationReport) and e.island == island]
        for report in bests:  # figures belong to the best that they are told with
            assert (report.best_so_far, report.trias) in {(e.best_so_far, e.trias) for e in given_}
    rounds = [e for e in told if isinstance(e, RoundReport)]
    assert [e.number for e in rounds] == list(range(1, len(rounds) + 1))
    steps = [e.generation if isinstance(e, GenerationReport) else e.step for e in told]
    assert steps == sorted(steps)
    # a run that goes on tells what it would have told
    again = Chronicle(told[:cut])
    assert [again.told(event) for event in events[cut:]] == told[cut:]


def test_evaluations_of_a_run_count_once():
    events = []
    done = finish(job(make("plain", 3), islands=3), events)
    reports = [e for e in events if isinstance(e, GenerationReport)]
    by_generation = {}
    for report in reports:
        by_generation.setdefault(report.generation, set()).add(report.evaluations)
    # every island tells what all of them have asked for
    assert all(len(found) == 1 for found in by_generation.values())
    if reports:
        assert reports[-1].evaluations == done.evaluations
