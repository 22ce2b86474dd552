"""What is left because nothing can be done without harm, and what it would need."""

import numpy as np
import pytest

from benchmarks.improving import job_of
from islands.left_in_rows import LeftInRows
from meshops.mesh import ShellMesh
from meshops.workpiece import Workpiece
from tests.meshes import shaped, sheet


def left_of(mesh: ShellMesh) -> LeftInRows:
    return LeftInRows.of(Workpiece(mesh, job_of("rows", mesh).problem.setting))


@pytest.mark.parametrize("rows", [1, 3])
def test_oblongs_are_told_with_the_rows_of_their_strip(rows: int) -> None:
    left = left_of(shaped(sheet(12, rows), lambda x, y: (8 * x, y, 0 * x)))
    assert left.elements == 12 * rows
    assert "aspect ratio" in left.criteria
    assert left.rows == (rows, rows)
    assert f"{12 * rows} elements fail by " in left.words()
    assert f"in rows {rows} wide, and are left: another density would be needed" in left.words()


def test_a_mesh_without_faults_of_size_has_nothing_to_tell() -> None:
    assert left_of(sheet(6, 6)) == LeftInRows(0)
    assert LeftInRows(0).words() == ""


def test_what_lies_in_no_strip_is_told_without_rows() -> None:
    tall = np.concatenate([np.arange(20.0), 19 + 0.05 * np.arange(1, 3), 19.1 + np.arange(1, 20)])
    left = left_of(shaped(sheet(30, 40), lambda x, y: (x, tall[y.astype(int)], 0 * x)))
    assert left.elements > 0
    assert left.rows is None
    assert f"{left.elements} elements fail by " in left.words()
    assert "in rows, and are left" in left.words()
