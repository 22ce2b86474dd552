"""The plain polygon formats OBJ and OFF, with quads and trias mixed in the order of the file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats.sources import read_lines
from meshops.mesh import NO_NODE, Floats, Ids, ShellMesh


class Polygons(NamedTuple):
    """Points (N, 3) and corners (M, 4): point numbers from 1, 0 last in a tria; line numbers."""

    points: Floats
    corners: Ids
    point_lines: list[int]
    corner_lines: list[int]


def read_obj(path: Path) -> Polygons:
    """Read the vertices and faces of a Wavefront OBJ file; raises InputError as ``read_off``."""
    points: list[list[float]] = []
    corners: list[list[int]] = []
    point_lines, corner_lines = [], []
    for number, words in _lines(path):
        if words[0] == "v":
            points.append(_numbers(words[1:4], path, number))
            point_lines.append(number)
        elif words[0] == "f":
            face = _integers([word.split("/")[0] for word in words[1:]], path, number)
            # a negative number counts back from the vertex last read
            absolute = [i + len(points) + 1 if i < 0 else i for i in face]
            corners.append(_corners(absolute, path, number))
            corner_lines.append(number)
    return _polygons(points, corners, point_lines, corner_lines)


def read_off(path: Path) -> Polygons:
    """Read an OFF file.

    Raises
    ------
    InputError
        Where the file is not OFF, ends early, holds what is no number or a polygon of more than
        four corners.
    """
    rows = _lines(path)
    number, words = next(rows, (1, [""]))
    if not words[0].endswith("OFF"):
        raise InputError(
            f"{path.name}, line {number}: an OFF file begins with OFF; check the file."
        )
    if len(words) < 3:
        number, counts = next(rows, (number, ["0", "0"]))
    else:
        counts = words[1:]
    node_count, face_count = [*_integers(counts[:2], path, number), 0, 0][:2]
    points: list[list[float]] = []
    corners: list[list[int]] = []
    point_lines, corner_lines = [], []
    for number, words in rows:
        if len(points) < node_count:
            points.append(_numbers(words[:3], path, number))
            point_lines.append(number)
        elif len(corners) < face_count:
            (count,) = _integers(words[:1], path, number)
            face = _integers(words[1 : 1 + max(count, 0)], path, number)
            corners.append(_corners([i + 1 for i in face], path, number))
            corner_lines.append(number)
    if (len(points), len(corners)) != (node_count, face_count):
        raise InputError(
            f"{path.name}: {len(points)} of {node_count} points and {len(corners)} of {face_count} "
            "faces are there; the file is cut short."
        )
    return _polygons(points, corners, point_lines, corner_lines)


def obj_text(mesh: ShellMesh) -> str:
    """Text of a Wavefront OBJ file."""
    points = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    faces = [_join("f", [i + 1 for i in face]) for face in _faces(mesh)]
    return "\n".join([*points, *faces, ""])


def off_text(mesh: ShellMesh) -> str:
    """Text of an OFF file."""
    points = [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    faces = [_join(str(len(face)), face) for face in _faces(mesh)]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *points, *faces, ""])


def _faces(mesh: ShellMesh) -> list[list[int]]:
    return [[i for i in element if i != NO_NODE] for element in mesh.elements.tolist()]


def _join(head: str, numbers: Sequence[int]) -> str:
    return " ".join([head, *map(str, numbers)])


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(read_lines(path), start=1):
        words = line.split("#")[0].split()
        if words:
            yield number, words


def _numbers(words: Sequence[str], path: Path, line: int) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        raise InputError(
            f"{path.name}, line {line}: '{' '.join(words)}' are not all numbers; correct the line."
        ) from None


def _integers(words: Sequence[str], path: Path, line: int) -> list[int]:
    try:
        return np.array(words, np.int64).tolist() if words else []
    except (ValueError, OverflowError):
        raise InputError(
            f"{path.name}, line {line}: '{' '.join(words)}' are not all integers; correct the line."
        ) from None


def _corners(nodes: Sequence[int], path: Path, line: int) -> list[int]:
    if len(nodes) in (3, 4):
        return [*nodes, 0][:4]
    raise InputError(
        f"{path.name}, line {line}: the face has {len(nodes)} corners; split it into quads and "
        "trias."
    )


def _polygons(
    points: list[list[float]],
    corners: list[list[int]],
    point_lines: list[int],
    corner_lines: list[int],
) -> Polygons:
    padded = [[*point, 0.0, 0.0, 0.0][:3] for point in points]
    return Polygons(
        np.array(padded, np.float64).reshape(-1, 3),
        np.array(corners, np.int64).reshape(-1, 4),
        point_lines,
        corner_lines,
    )
