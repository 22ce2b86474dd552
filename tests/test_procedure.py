"""Procedures as files, each mistake one sentence that names the file; steps as messages."""

import json
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from islands.procedure import Procedure, Step, perform_steps
from meshops.errors import InputError
from meshops.operations import ALL_OPERATIONS
from tests.decks import bad_plate
from tests.jobs import finish, job, setting_of, whole_job

Spoil = Callable[[dict[str, Any]], object]


@pytest.fixture(scope="module")
def document() -> str:
    return finish(job(bad_plate(), rounds=2)).procedure.to_json(ALL_OPERATIONS)


def step(of: dict[str, Any]) -> dict[str, Any]:
    steps = [s for r in of["rounds"] for place in r["places"] for s in place["steps"]]
    return next(s for s in steps if s["parameters"])


SPOILS: dict[str, Spoil] = {
    "another format": lambda of: of.update(format="meshipelago procedure 1"),
    "without rounds": lambda of: of.pop("rounds"),
    "an operation that is not known": lambda of: step(of).update(operation="magic"),
    "parameters that are no rows": lambda of: step(of).update(parameters=[1, 2]),
    "ragged parameters": lambda of: step(of).update(parameters=[[1, 2], [3]]),
    "an extent of nothing": lambda of: of["rounds"][0].update(extent=[3, 0]),
    "an extent of three numbers": lambda of: of["rounds"][0].update(extent=[3, 4, 5]),
    "a place of two coordinates": lambda of: of["rounds"][0]["places"][0].update(centre=[0, 1]),
    "a box of one corner": lambda of: of.update(box=[[0, 0, 0]]),
    "a size in words": lambda of: of.update(size="large"),
    "criteria that are not known": lambda of: of.update(criteria="[criteria.beauty]\nfail = 1\n"),
}


@pytest.mark.parametrize("name", SPOILS)
def test_what_is_no_procedure_is_told_in_one_sentence(document: str, name: str) -> None:
    spoilt = json.loads(document)
    SPOILS[name](spoilt)
    with pytest.raises(InputError, match=r"mine\.json") as told:
        Procedure.from_json(json.dumps(spoilt), ALL_OPERATIONS, "mine.json")
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "null", '"procedure"'])
def test_what_is_no_document_is_told_in_one_sentence(text: str) -> None:
    with pytest.raises(InputError, match=r"mine\.json is not a procedure"):
        Procedure.from_json(text, ALL_OPERATIONS, "mine.json")


def test_settings_come_back_as_they_were(document: str) -> None:
    procedure = Procedure.from_json(document, ALL_OPERATIONS, "mine.json")
    was = job(bad_plate()).problem.setting
    again = procedure.setting(bad_plate())
    for one, other in zip(was.scoring.arrays, again.scoring.arrays, strict=True):
        assert np.array_equal(one, other)
    assert (again.element_size, again.feature_angle) == (was.element_size, was.feature_angle)
    assert procedure.mesh == bad_plate().digest
    assert procedure.box.tolist() == [[0, 0, 0], [50, 40, 0]]


def test_a_procedure_of_the_whole_mesh_has_one_place_and_no_extent() -> None:
    done = finish(whole_job(bad_plate(), generations=0))
    text = done.procedure.to_json(ALL_OPERATIONS)
    (only,) = Procedure.from_json(text, ALL_OPERATIONS, "mine.json").rounds
    assert only.extent is None
    assert len(only.places) == 1
    assert "#" not in done.text


def test_a_step_that_does_not_fit_is_named() -> None:
    mesh = bad_plate()
    steps = (Step(2, np.zeros((0, 2), np.int32)), Step(0, np.array([(1, 9999)], np.int32)))
    with pytest.raises(InputError, match=r"Step 2 \(remesh-ranges\) does not fit"):
        perform_steps(mesh, steps, ALL_OPERATIONS, setting_of(mesh))


def test_a_step_does_not_hold_the_message_that_it_came_with() -> None:
    step = Step(1, np.arange(6, dtype=np.int32).reshape(3, 2))
    buffers: list[pickle.PickleBuffer] = []
    message = pickle.dumps(step, protocol=5, buffer_callback=buffers.append)
    came = pickle.loads(message, buffers=buffers)
    assert (came.parameters == step.parameters).all()
    assert not np.shares_memory(came.parameters, step.parameters)
