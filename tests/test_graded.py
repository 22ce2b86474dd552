"""Runs with a size field: lengths are judged by the size that is wanted in that place."""

import numpy as np
import pytest

from islands.config import load_config
from islands.procedure import Procedure, perform
from islands.run import Job, improve
from meshops.criteria import PAPER
from meshops.errors import InputError
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS


def graded() -> ShellMesh:
    """Rings of nearly square quads that grow eightfold outwards, one of them split in two trias."""
    spokes, rings = 24, 9
    angle = np.tile(np.arange(spokes) * 2 * np.pi / spokes, rings)
    radius = np.repeat(1.3 ** np.arange(rings), spokes)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle])
    inner = np.arange(spokes * (rings - 1))
    ahead = inner - inner % spokes + (inner + 1) % spokes
    quads = np.column_stack([inner, inner + spokes, ahead + spokes, ahead])
    a, b, c, d = quads[100]
    elements = np.vstack([np.delete(quads, 100, axis=0), [a, b, c, -1], [a, c, d, -1]])
    return ShellMesh.build(points, elements)


def job(size: str | float | None) -> Job:
    given = {"criteria": "paper", "rounds": 20} | ({} if size is None else {"size": size})
    return Job.of("graded", graded(), PAPER, load_config(None, given))


def test_a_gradation_is_no_fault() -> None:
    even, local = job("even"), job(None)
    assert local.quality(local.mesh).failed < even.quality(even.mesh).failed / 4


def test_a_graded_mesh_keeps_its_gradation() -> None:
    work = job("local")
    done = improve(work)
    assert (done.after.failed, done.after.trias) <= (done.before.failed, done.before.trias)
    assert done.after.trias == 0
    assert 0.8 < len(done.mesh.elements) / len(work.mesh.elements) < 1.25


def test_its_procedure_is_replayed() -> None:
    work = job("local")
    done = improve(work)
    again = Procedure.from_json(done.procedure.to_json(ALL_OPERATIONS), ALL_OPERATIONS, "file")
    mesh = perform(work.mesh, again.rounds, ALL_OPERATIONS, again.setting(work.mesh))
    assert mesh.digest == done.mesh.digest


def test_a_file_of_sizes(tmp_path) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "sizes.csv"
    path.write_text("x,y,z,size\n0,0,0,1\n")
    assert job(str(path)).quality(graded()).failed == job(1.0).quality(graded()).failed


@pytest.mark.parametrize("size", ["no such file", "-1x"])
def test_a_size_that_is_nothing(size: str) -> None:
    with pytest.raises(InputError, match="neither a number"):
        job(size)


def test_the_papers_profile_takes_a_number() -> None:
    with pytest.raises(InputError, match="give a number"):
        load_config(None, {"profile": "paper", "size": "local"})
