"""What every operation must leave whole, on random meshes of every kind."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations import OPERATIONS, PAPER_OPERATIONS, RemeshRanges, ReplaceNodePairs
from meshops.workpiece import Setting, Workpiece
from tests.measures import barriers, doubles, unsound
from tests.meshes import CURVED_KINDS, FLAT_KINDS, make, meshes
from tests.wholeness import (
    assert_ids_are_kept,
    assert_nothing_locked_has_changed,
    assert_on_the_surface,
    assert_zones_are_whole,
)

EVERY = (*OPERATIONS, *PAPER_OPERATIONS, RemeshRanges(ranges=2), ReplaceNodePairs(pairs=4, pool=60))
MERGES = {"replace-node", "replace-node-pairs", "replace-chain"}
"""May make one of two border edges in one line, so that trias can leave the mesh there."""

GENOMES = 4
each_operation = pytest.mark.parametrize("operation", EVERY, ids=lambda o: o.name)
seeds = st.integers(0, 10**6)
bounded = settings(max_examples=12, deadline=None)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def outcomes(operation, piece, seed):
    """(mesh after, foretold tally) of the genomes that lead to a valid mesh and change it."""
    rng = np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return []
    genomes = space.draw(rng, GENOMES)
    assert genomes.shape == (GENOMES, len(space.bounds))
    assert (genomes >= 0).all()
    assert (genomes < space.bounds).all()
    found = []
    for genome, tally in zip(genomes, space.evaluate(genomes), strict=True):
        parameters = space.parameters(genome)
        if np.isfinite(tally).all() and len(parameters):
            found.append((apply(piece.mesh, operation.apply(piece, parameters)), tally))
            np.testing.assert_allclose(space.tally(genome), tally, rtol=1e-9, atol=1e-8)
    return found


def assert_no_element_got_worse(before, after):
    """What was unsound or doubled from the start may stay, with its id; nothing new may be."""
    rows = {row for pair in doubles(after) for row in pair} | set(unsound(after))
    were = {row for pair in doubles(before) for row in pair} | set(unsound(before))
    assert set(after.element_ids[sorted(rows)]) <= set(before.element_ids[sorted(were)])


def assert_barriers_are_kept(before, after, *, merges, creases=0):
    """Edges with one element or with three and more are as they were, by their places.

    So each edge inside a zone has two elements still. Merges may shorten the chain of a border.
    Where the part is so round that larger elements turn from each other by more than the feature
    angle, some `creases` may come.
    """

    def kept(mesh):
        return {edge: uses for edge, uses in barriers(mesh).items() if uses > 1 or not merges}

    assert kept(before).items() <= kept(after).items()
    new = kept(after).items() - kept(before).items()
    assert len(new) <= creases
    assert {uses for _, uses in new} <= {2}


@each_operation
@bounded
@given(mesh=meshes(FLAT_KINDS), seed=seeds)
def test_flat_parts_stay_whole(operation, mesh, seed):
    merges = operation.name in MERGES
    for after, tally in outcomes(operation, workpiece(mesh), seed):
        assert_no_element_got_worse(mesh, after)
        assert_nothing_locked_has_changed(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert_barriers_are_kept(mesh, after, merges=merges)
        assert_zones_are_whole(mesh, after, area=1e-9, straight=merges)
        assert_on_the_surface(mesh, after, tolerance=1e-9)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@each_operation
@bounded
@given(mesh=meshes(CURVED_KINDS), seed=seeds)
def test_curved_parts_stay_whole(operation, mesh, seed):
    merges = operation.name in MERGES
    for after, tally in outcomes(operation, workpiece(mesh), seed):
        assert_no_element_got_worse(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert_barriers_are_kept(mesh, after, merges=merges, creases=4 if merges else 0)
        assert_zones_are_whole(mesh, after, area=0.1, straight=merges)
        assert_on_the_surface(mesh, after, tolerance=0.1)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize(
    "operation",
    [o for o in EVERY if o.name not in ("remove-doublet", "slide")],
    ids=lambda o: o.name,
)
def test_there_is_something_to_do(operation):
    """So that the properties above speak of edits and not of nothing.

    These meshes have no doublets, tests/test_local_operations.py has some with; nor a first mesh to
    slide along, which tests/test_slide.py has.
    """
    changed = 0
    for seed in range(20):
        mesh = make("holes", seed)
        changed += sum(m.digest != mesh.digest for m, _ in outcomes(operation, workpiece(mesh), 0))
    assert changed >= 3


@settings(max_examples=30, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from(EVERY), seeds)
def test_the_same_input_gives_the_same_mesh(mesh, operation, seed):
    once, again = (outcomes(operation, workpiece(mesh), seed) for _ in range(2))
    assert [after.digest for after, _ in once] == [after.digest for after, _ in again]
    assert all(np.array_equal(a, b) for (_, a), (_, b) in zip(once, again, strict=True))


@settings(max_examples=30, deadline=None)
@given(meshes(FLAT_KINDS), meshes(FLAT_KINDS), st.sampled_from(OPERATIONS), seeds)
def test_parameters_of_one_mesh_may_be_tried_on_another(mesh, other, operation, seed):
    rng = np.random.default_rng(seed)
    space = operation.search_space(workpiece(mesh), rng)
    if space is None:
        return
    for genome in space.draw(rng, GENOMES):
        edit = operation.apply(workpiece(other), space.parameters(genome))
        after = apply(other, edit)
        assert_no_element_got_worse(other, after)
        assert_zones_are_whole(other, after, area=1e-9, straight=operation.name in MERGES)


def digests():
    """What the operations make of some meshes."""
    return [
        after.digest
        for kind in ("plain", "slit", "cylinder")
        for operation in EVERY
        for after, _ in outcomes(operation, workpiece(make(kind, 11)), 5)
    ]


def test_a_fresh_process_gives_the_same_meshes():
    code = "from tests.test_properties import digests; print(*digests())"
    fresh = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120
    )
    assert fresh.stdout.split() == digests()
    assert len(set(digests())) > 10
