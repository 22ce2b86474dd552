"""Transfer: a procedure of one plate, performed on another without any search."""

from dataclasses import replace

import numpy as np
import pytest

from islands.procedure import Procedure, perform_rounds
from islands.run import Finished
from islands.transfer import transfer
from meshops.errors import InputError
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from tests.decks import bad_plate
from tests.jobs import faults, finish, job, setting_of, whole_job
from tests.measures import barriers, corners
from tests.meshes import cylinder, sheet, with_
from tests.wholeness import assert_ids_are_kept, assert_sound, assert_zones_are_whole


@pytest.fixture(scope="module")
def finished() -> Finished:
    return finish(job(bad_plate()))


def mirrored(mesh: ShellMesh) -> ShellMesh:
    """The other hand of a part, its elements numbered the way that faces up again."""
    elements = mesh.elements.copy()
    for row, element in enumerate(elements):
        size = len(corners(element))
        elements[row, :size] = element[:size][::-1]
    return with_(mesh, points=mesh.points * (-1.0, 1.0, 1.0), elements=elements)


def transferred(procedure: Procedure, mesh: ShellMesh) -> ShellMesh:
    after, rounds = transfer(procedure, mesh, ALL_OPERATIONS, setting_of(mesh))
    again = perform_rounds(mesh, rounds, ALL_OPERATIONS, setting_of(mesh))
    assert again.digest == after.digest
    return after


@pytest.mark.parametrize(
    "mesh",
    [mirrored(bad_plate()), bad_plate(seed=5), bad_plate(16, 6, seed=3)],
    ids=["mirrored", "another seed", "another shape"],
)
def test_another_plate_gets_better(finished: Finished, mesh: ShellMesh) -> None:
    after = transferred(finished.procedure, mesh)
    assert faults(after) < faults(mesh)
    assert_sound(after)
    assert_ids_are_kept(mesh, after)
    assert_zones_are_whole(mesh, after, area=1e-9)
    assert barriers(after) == barriers(mesh)


def test_on_its_own_mesh_it_does_no_less_than_half_of_what_it_did(finished: Finished) -> None:
    mesh = bad_plate()
    before, after, best = faults(mesh), faults(transferred(finished.procedure, mesh)), finished
    assert after <= before
    assert after[0] - best.after.failed <= (before[0] - best.after.failed) / 2


@pytest.mark.parametrize("seed", range(6))
def test_no_mesh_gets_worse(finished: Finished, seed: int) -> None:
    flat = sheet(9, 7, seed=seed, jitter=0.3, trias=0.3, holes=0.05)
    for part in (flat, cylinder(flat)):
        mesh = with_(part, points=5.0 * part.points)
        after = transferred(finished.procedure, mesh)
        assert faults(after) <= faults(mesh)
        assert barriers(after) == barriers(mesh)


def test_a_mesh_without_fault_stays_as_it_is(finished: Finished) -> None:
    mesh = with_(sheet(6, 5), points=5.0 * sheet(6, 5).points)
    assert transferred(finished.procedure, mesh).digest == mesh.digest


def test_a_procedure_that_did_nothing_does_nothing(finished: Finished) -> None:
    mesh = bad_plate(seed=5)
    empty = replace(finished.procedure, rounds=())
    idle = replace(
        finished.procedure,
        rounds=tuple(
            replace(r, places=tuple(replace(p, steps=()) for p in r.places))
            for r in finished.procedure.rounds
        ),
    )
    assert transferred(empty, mesh).digest == transferred(idle, mesh).digest == mesh.digest


def test_a_procedure_of_element_numbers_is_refused() -> None:
    done = finish(whole_job(bad_plate(), generations=0))
    mesh = bad_plate(seed=5)
    with pytest.raises(InputError, match="whole mesh"):
        transfer(done.procedure, mesh, ALL_OPERATIONS, setting_of(mesh))


def test_the_same_places_are_found_wherever_the_part_lies(finished: Finished) -> None:
    """By its place in the box around the part."""
    mesh = bad_plate(seed=5)
    moved = with_(mesh, points=mesh.points + np.array([1000.0, -500.0, 250.0]))
    one, other = (transferred(finished.procedure, m) for m in (mesh, moved))
    assert np.array_equal(one.elements, other.elements)
    np.testing.assert_allclose(other.points - [1000.0, -500.0, 250.0], one.points, atol=1e-6)
