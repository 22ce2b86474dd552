from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from meshops.assessment import Assessment
from meshops.criteria import PAPER, STANDARD, Scoring
from meshops.errors import InputError
from meshops.examples import plate
from meshops.mesh import ShellMesh
from meshops.pictures import KINDS, draw, draw_before_after

SCORING = PAPER.at(5.0)
JUDGED = Assessment(SCORING)


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return plate()


def grid(columns: int, rows: int) -> ShellMesh:
    """Squares of size 1 in the plane z = 0."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0)))
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    quads = np.column_stack([first, first + 1, first + columns + 2, first + columns + 1])
    return ShellMesh.build(np.column_stack([x, y, 0.0 * x]), quads)


def split(mesh: ShellMesh, rows: np.ndarray) -> ShellMesh:
    """The mesh with some quads cut into two trias."""
    quads = mesh.elements[rows]
    none = np.full(len(quads), -1)
    halves = [np.column_stack([quads[:, [0, i, i + 1]], none]) for i in (1, 2)]
    return ShellMesh.build(
        mesh.points, np.concatenate([np.delete(mesh.elements, rows, 0), *halves])
    )


def turned(mesh: ShellMesh, axes: np.ndarray) -> ShellMesh:
    return ShellMesh.build(mesh.points @ axes, mesh.elements)


def pixels(path: Path) -> np.ndarray:
    """(h, w, 3) without header and legend."""
    return imread(path)[120:-75, :, :3]


def count(image: np.ndarray, kind: str) -> int:
    colour = np.array([int(KINDS[kind][i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return int((np.abs(image - colour).max(axis=-1) < 0.02).sum())


def picture(mesh: ShellMesh, folder: Path, scoring: Scoring = SCORING) -> np.ndarray:
    draw(mesh, Assessment(scoring), folder / "mesh.png")
    return pixels(folder / "mesh.png")


def test_writes_one_png_of_sensible_size(mesh: ShellMesh, tmp_path: Path) -> None:
    path = tmp_path / "plate.png"
    draw(mesh, JUDGED, path, title="plate")
    assert path.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    assert [p.name for p in tmp_path.iterdir()] == ["plate.png"]
    height, width = imread(path).shape[:2]
    assert 800 <= width <= 3000
    assert 800 <= height <= 3000
    assert path.stat().st_size < 1_000_000


def test_a_title_may_hold_any_sign(tmp_path: Path) -> None:
    draw(grid(2, 2), JUDGED, tmp_path / "a.png", title="$run_1$ \\part{ $x^")
    assert (tmp_path / "a.png").exists()


def test_replaces_an_older_picture(mesh: ShellMesh, tmp_path: Path) -> None:
    first = picture(grid(3, 3), tmp_path)
    second = picture(mesh, tmp_path)
    assert first.shape != second.shape or not np.array_equal(first, second)


def test_colours_cover_the_area_of_their_elements(mesh: ShellMesh, tmp_path: Path) -> None:
    image = picture(mesh, tmp_path)
    corners = mesh.points[mesh.elements[mesh.is_tria, :3], :2]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    trias = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    per_unit = (1350 / 104.0) ** 2  # 9 inches for the plate and its margins
    assert count(image, "tria") == pytest.approx(trias * per_unit, rel=0.15)
    assert count(image, "failed quad") > 2 * 10.0 * per_unit
    assert count(image, "failed tria") == 0


def test_amber_grows_with_the_trias(tmp_path: Path) -> None:
    whole = grid(10, 10)
    seen = [
        count(picture(split(whole, np.arange(n)), tmp_path, STANDARD.at(1.0)), "tria")
        for n in (0, 10, 40)
    ]
    assert seen[0] == 0
    assert seen[2] == pytest.approx(4 * seen[1], rel=0.05)


def test_what_fails_is_red(tmp_path: Path) -> None:
    mixed = split(grid(10, 10), np.arange(50))
    fair = picture(mixed, tmp_path, STANDARD.at(1.0))
    assert count(fair, "failed quad") == count(fair, "failed tria") == 0
    too_large = picture(mixed, tmp_path, STANDARD.at(0.2))
    assert count(too_large, "quad") == count(too_large, "tria") == 0
    assert count(too_large, "failed quad") == pytest.approx(count(fair, "quad"), rel=0.02)
    assert count(too_large, "failed tria") == pytest.approx(count(fair, "tria"), rel=0.02)


def test_locked_elements_are_greyer(tmp_path: Path) -> None:
    free = grid(10, 10)
    half = ShellMesh.build(free.points, free.elements, locked_elements=np.arange(100) < 50)
    before, after = (picture(m, tmp_path, STANDARD.at(1.0)) for m in (free, half))
    assert count(after, "quad") == pytest.approx(0.5 * count(before, "quad"), rel=0.02)
    assert after.mean() < before.mean()


@pytest.mark.parametrize(
    "axes",
    [
        pytest.param(np.eye(3)[[0, 2, 1]], id="xz"),
        pytest.param(np.eye(3)[[1, 2, 0]], id="yz"),
        pytest.param(np.array([[0.8, 0.6, 0], [0, 0, 1], [-0.6, 0.8, 0]]), id="upright"),
    ],
)
def test_a_plane_is_seen_face_on_wherever_it_stands(
    mesh: ShellMesh, axes: np.ndarray, tmp_path: Path
) -> None:
    flat = turned(mesh, np.eye(3))
    lying, standing = picture(flat, tmp_path), picture(turned(flat, axes), tmp_path)
    assert lying.shape == standing.shape
    assert np.abs(lying - standing).mean() < 0.002
    for mirrored in (lying[::-1], lying[:, ::-1]):
        assert np.abs(lying - mirrored).mean() > 0.005  # so that no mirror image would pass


def test_a_plane_of_any_tilt_is_not_shortened(tmp_path: Path) -> None:
    a, b = np.cos(0.7), np.sin(0.7)
    tilt = np.array([[1, 0, 0], [0, a, b], [0, -b, a]]) @ np.array(
        [[a, b, 0], [-b, a, 0], [0, 0, 1]]
    )
    tilted = turned(grid(6, 6), tilt)
    image = picture(tilted, tmp_path, STANDARD.at(1.0))
    quads = count(image, "quad")
    drawn = np.nonzero((image < 0.99).any(axis=-1))
    width, height = (np.ptp(axis) for axis in drawn[::-1])
    # a square seen face on fills, turned by an angle t, 1 / (1 + sin 2 t) of its bounding box
    cosine = tilt[0] @ np.cross([0, 0, 1], tilt[2]) / np.hypot(*tilt[2, :2])
    share = 1.0 / (1.0 + 2.0 * abs(cosine) * np.sqrt(1.0 - cosine**2))
    assert width == pytest.approx(height, rel=0.02)
    assert quads == pytest.approx(share * width * height, rel=0.05)


def test_the_sides_of_a_box_are_shaded(tmp_path: Path) -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    front, right, top = [0, 4, 5, 1], [4, 6, 7, 5], [1, 5, 7, 3]
    image = picture(ShellMesh.build(corners, [front, right, top]), tmp_path, STANDARD.at(1.0))
    brightness, often = np.unique(image.sum(axis=-1).round(2), return_counts=True)
    assert len(brightness[often > 50_000]) == 4  # the three sides and the paper


@pytest.mark.parametrize("trias", ["first", "last"])
@pytest.mark.parametrize("height", [-1.5, 1.5])
def test_what_is_near_hides_what_is_far(tmp_path: Path, trias: str, height: float) -> None:
    large, small = grid(10, 10), split(grid(2, 2), np.arange(4))
    lifted = small.points + np.array([4.0, 4.0, height])
    parts = [(large.points, large.elements), (lifted, small.elements)]
    (p, e), (q, f) = parts[::-1] if trias == "first" else parts
    both = ShellMesh.build(
        np.concatenate([p, q]), np.concatenate([e, np.where(f < 0, f, f + len(p))])
    )
    image = picture(both, tmp_path, STANDARD.at(1.0))
    saturation = image.max(axis=-1) - image.min(axis=-1)
    assert (np.count_nonzero(saturation > 0.5) > 1000) == (height > 0.0)


def test_tiny_elements_lose_their_edges(tmp_path: Path) -> None:
    image = picture(grid(2000, 5), tmp_path, STANDARD.at(1.0))
    rows, columns = np.nonzero((image < 0.99).any(axis=-1))
    row = image[(rows.min() + rows.max()) // 2, columns.min() + 4 : columns.max() - 4]
    assert count(row, "quad") == len(row)


def test_before_and_after_are_side_by_side(mesh: ShellMesh, tmp_path: Path) -> None:
    quads = ShellMesh.build(mesh.points, mesh.elements[~mesh.is_tria])
    draw_before_after(mesh, quads, JUDGED, tmp_path / "both.png")
    image = pixels(tmp_path / "both.png")
    left, right = np.array_split(image, 2, axis=1)
    assert image.shape[1] > 1.5 * image.shape[0]
    assert count(left, "tria") > 1000
    assert count(right, "tria") == 0
    assert count(right, "quad") == pytest.approx(count(left, "quad"), rel=0.1)


def test_refuses_a_mesh_without_elements(tmp_path: Path) -> None:
    empty = ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4)))
    with pytest.raises(InputError, match="no element"):
        draw(empty, JUDGED, tmp_path / "empty.png")
    assert not any(tmp_path.iterdir())


def test_says_where_a_picture_cannot_be_written(mesh: ShellMesh, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="file"):
        draw(mesh, JUDGED, tmp_path / "file" / "plate.png")


@pytest.mark.parametrize(
    "points",
    [
        pytest.param(np.zeros((3, 3)), id="all in one place"),
        pytest.param(np.outer([0.0, 1.0, 2.0], [1.0, 1.0, 1.0]), id="all on a line"),
    ],
)
def test_a_degenerate_mesh_still_gets_a_picture(points: np.ndarray, tmp_path: Path) -> None:
    flat = ShellMesh.build(points, [[0, 1, 2, -1]])
    draw(flat, JUDGED, tmp_path / "flat.png")
    assert (tmp_path / "flat.png").stat().st_size > 0
