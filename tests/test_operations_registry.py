"""The registry of operations: what a procedure names is there, once, and says what it does."""

import sys

import numpy as np
import pytest

from islands.procedure import Place, Procedure, Round, Step, steps_text
from meshops.criteria import PAPER
from meshops.operations import ALL_OPERATIONS, NOTHING, OPERATIONS, PAPER_OPERATIONS
from meshops.subdomain import Extent
from meshops.workpiece import Workpiece
from tests.decks import bad_plate
from tests.jobs import setting_of

each_operation = pytest.mark.parametrize("operation", ALL_OPERATIONS, ids=lambda o: o.name)


def found_on_a_plate(operation):
    """Parameters that the operation finds on some plate."""
    for seed in range(20):
        mesh = bad_plate(seed=seed)
        piece = Workpiece(mesh, setting_of(mesh))
        rng = np.random.default_rng(seed)
        space = operation.search_space(piece, rng)
        if space is None:
            continue
        for genome in space.draw(rng, 8):
            parameters = space.parameters(genome)
            if len(parameters):
                return parameters
    # there are no doublets or holes on these plates, and no first mesh to slide along
    columns = {"quick-edit": 4, "slide": 3}.get(operation.name, 2)
    return np.ones((1, columns), np.int32)


def procedure_of(*steps):
    place = Place((1.0, 2.5, 1 / 3), steps)
    box = np.array([(0.0, 0.0, 0.0), (50.0, 40.0, 0.1)])
    rounds = (Round(Extent(3, 60), 4, (place, Place((0.0, 0.0, 0.0), ()))),)
    return Procedure(rounds, "m", "r", box, PAPER, 5.0, None, None, 30.0, slides=True, seed=7)


def test_names_and_codes_are_unique():
    for known in (
        [operation.name for operation in ALL_OPERATIONS] + ["nothing"],
        [operation.code for operation in ALL_OPERATIONS] + [NOTHING],
    ):
        assert len(set(known)) == len(known)


def test_the_paper_has_the_codes_of_its_section_3_3():
    assert [operation.code for operation in PAPER_OPERATIONS] == [0, 1]
    assert NOTHING == 2
    assert set(OPERATIONS) | set(PAPER_OPERATIONS) <= set(ALL_OPERATIONS)


@each_operation
def test_each_says_what_it_does(operation):
    kind = type(operation)
    assert len(kind.__doc__.splitlines()[0]) > 20
    assert sys.modules[kind.__module__].__doc__
    assert operation.name == operation.name.lower()
    assert operation.name == kind().name
    assert operation.code == kind().code


@each_operation
def test_steps_come_back_from_json_and_are_written_as_in_figure_10(operation):
    parameters = found_on_a_plate(operation)
    assert parameters.dtype == np.int32
    procedure = procedure_of(
        Step(operation.code, parameters), Step(NOTHING, parameters[:0]),
        Step(operation.code, parameters[:0]),
    )  # fmt: skip
    text = procedure.to_json(ALL_OPERATIONS)
    again = Procedure.from_json(text, ALL_OPERATIONS, "p.json")
    assert again.to_json(ALL_OPERATIONS) == text
    (done,) = again.rounds
    assert (done.extent, done.turn) == (Extent(3, 60), 4)
    steps = done.places[0].steps
    assert [step.code for step in steps] == [operation.code, NOTHING, operation.code]
    assert np.array_equal(steps[0].parameters, parameters)
    assert [len(step.parameters) for step in steps[1:]] == [0, 0]

    lines = steps_text(steps, ALL_OPERATIONS).splitlines()
    name = str(operation.code) if operation.code <= NOTHING else operation.name
    assert lines == [f"{name} {operation.format(parameters)}", f"{NOTHING} -", f"{name} -"]
    assert again.text(ALL_OPERATIONS).startswith("# round 1, 3 rings around 1, 2.5, 0.333333\n")
