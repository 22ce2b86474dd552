"""Wavefront OBJ files: faces are edited; groups, objects, materials, lines and the rest stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats.file_rows import FileRows
from meshops.formats.fresh import write_edited
from meshops.formats.grid import Grid, Others, Shells, shells_of
from meshops.formats.locks import Lock
from meshops.formats.one_file import OneFile
from meshops.formats.sources import read_lines
from meshops.formats.welding import weld
from meshops.formats.words import corners, integers, numbers, resolution
from meshops.mesh import NO_NODE, Floats, Ids, ShellMesh

State = tuple[str, str, str]
"""Object, group and material that a face belongs to."""

_STATES = {"o": 0, "g": 1, "usemtl": 2}


class Line(NamedTuple):
    """A statement: what it is, its words, its text without line end, and its line number from 1."""

    kind: str
    words: list[str]
    text: str
    number: int


@dataclass(frozen=True, eq=False)
class ObjFile(OneFile):
    """An OBJ file and the mesh of its faces.

    Attributes
    ----------
    source : Path
    data : bytes
        The file as it was read.
    lines : list of Line
    points : (n, 3) float64
    corners : (m, 4) int64
        Rows of points of the faces, as the file names them.
    states : list of int
        Object, group and material of each face, by their number.
    point_of : (n,) int64
        The point that each has been welded to.
    shells : Shells
    notes : tuple of str
    """

    source: Path
    data: bytes
    lines: list[Line]
    points: Floats
    corners: Ids
    states: list[int]
    point_of: Ids
    shells: Shells
    notes: tuple[str, ...]

    @property
    def mesh(self) -> ShellMesh:
        """Quads and trias; a region is what has the same object, group and material."""
        return self.shells.mesh

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked."""
        return self.shells.locks

    def check_room(self) -> None:
        """Do nothing: what is new is known by its row."""

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write the file with ``mesh`` in the place of its faces.

        Faces that stay keep their texture and their normals; new ones have none.

        Raises
        ------
        InputError
            Where ``path`` is the source or cannot be written.
        """
        return write_edited(mesh, path, self.source, self._written)

    def _written(self, mesh: ShellMesh) -> bytes:
        rows = FileRows.of(self.shells, mesh, self.points, self.point_of, self.shells.element_of)
        if rows.carried.is_unchanged:
            return self.data
        faces = self._faces(rows)
        vertices = self._vertices(rows)
        found: list[str] = []
        count = [0, 0]
        for line in self.lines:
            if line.kind == "v":
                # all together where the first was: new faces may name them anywhere below
                found += vertices if count[0] == 0 else []
                count[0] += 1
            elif line.kind == "f":
                found += faces[count[1]]
                count[1] += 1
            elif line.kind in ("l", "p"):
                found.append(self._joined(line, rows, count[0]))
            else:
                found.append(line.text)
        eol = "\r\n" if b"\r\n" in self.data else "\n"
        return "".join(text + eol for text in found).encode("latin-1")

    def _vertices(self, rows: FileRows) -> list[str]:
        old = [line for line in self.lines if line.kind == "v"]
        moved = np.zeros(len(rows.points), bool)
        moved[rows.node_point[rows.carried.difference.moved]] = True
        width = min((len(line.words) for line in old), default=4)
        more = np.array([[float(w) for w in line.words[4:width]] for line in old])
        extra = rows.point_values(more.reshape(len(old), -1))
        found = []
        for row, source in enumerate(rows.point_from.tolist()):
            if source >= 0 and not moved[row]:
                found.append(old[source].text)
            else:
                values = [*rows.points[row].tolist(), *extra[row].tolist()]
                found.append(" ".join(["v", *map(repr, values)]))
        return found

    def _faces(self, rows: FileRows) -> list[list[str]]:
        """Lines that follow each face of the file, itself the first of them where it stays."""
        old = [line for line in self.lines if line.kind == "f"]
        changed = rows.is_rewired(self.corners) & ~rows.is_new
        found: list[list[str]] = [[] for _ in old]
        last = {state: face for face, state in enumerate(self.states)}
        for row, face in enumerate(rows.cell_from.tolist()):
            nodes = [node + 1 for node in rows.corners[row].tolist() if node != NO_NODE]
            if rows.is_new[row]:
                found[last[self.states[face]]].append(_statement("f", nodes))
            elif changed[row]:
                found[face].insert(0, _statement("f", nodes))
            else:
                found[face].insert(0, self._renamed(old[face], rows.point_of, self.corners[face]))
        return found

    def _renamed(self, line: Line, point_of: Ids, was: Ids) -> str:
        """Write a face that stays, with texture and normals, on points as they count now."""
        words = []
        for word, point in zip(line.words[1:], was.tolist(), strict=False):
            _, slash, rest = word.partition("/")
            words.append(f"{point_of[point] + 1}{slash}{rest}")
        same = [word.lstrip("+") for word in line.words[1:]] == words
        return line.text if same else " ".join(["f", *words])

    def _joined(self, line: Line, rows: FileRows, seen: int) -> str:
        words = []
        for word in line.words[1:]:
            head, slash, rest = word.partition("/")
            point = _absolute(int(head), seen)
            words.append(f"{rows.point_of[point] + 1}{slash}{rest}")
        return " ".join([line.kind, *words])


def read_obj(path: Path) -> ObjFile:
    """Read a Wavefront OBJ file; faces that share no points are welded.

    Raises
    ------
    InputError
        Where the file is missing, is no text, holds what is no number or a face of more than four
        corners, or as ``checked_mesh``.
    """
    lines = _statements(path)
    points: list[list[float]] = []
    words: list[str] = []
    faces: list[list[int]] = []
    face_lines: list[int] = []
    point_lines: list[int] = []
    joined: list[Ids] = []
    state = ["", "", ""]
    states: list[int] = []
    known: dict[tuple[str, ...], int] = {}
    for line in lines:
        if line.kind == "v":
            points.append([*numbers(line.words[1:], path, line.number), 0.0, 0.0, 0.0][:3])
            words += line.words[1:4]
            point_lines.append(line.number)
        elif line.kind == "f":
            nodes = _named(line, path, len(points))
            faces.append(corners(nodes, path, line.number))
            face_lines.append(line.number)
            states.append(known.setdefault(tuple(state), len(known) + 1))
        elif line.kind in ("l", "p"):
            nodes = _named(line, path, len(points))
            joined.append(np.array(nodes, np.int64))
        elif line.kind in _STATES:
            state[_STATES[line.kind]] = " ".join(line.words[1:])
    place = np.array(points, np.float64).reshape(-1, 3)
    nodes_of = np.array(faces, np.int64).reshape(-1, 4)
    _check_named(nodes_of, face_lines, len(place), path)
    welded = weld(place, nodes_of, resolution(words))
    own = welded.point_of
    grid = Grid(
        source=path.name,
        points=place,
        node_ids=np.arange(1, len(place) + 1),
        corners=np.where(nodes_of == NO_NODE, NO_NODE, own[nodes_of]),
        shell_ids=np.arange(1, len(nodes_of) + 1),
        parts=np.array(states, np.int64) if len(known) > 1 else np.zeros(len(states), np.int64),
        others=_others(joined, own, path),
        held_nodes=welded.held,
        held_by="points on the same place",
    )
    shells = shells_of(
        grid,
        lambda row: f"{path.name}, line {point_lines[row]}",
        lambda row: f"{path.name}, line {face_lines[row]}",
    )
    data = path.read_bytes()
    notes = (*welded.notes, *shells.notes)
    return ObjFile(path, data, lines, place, nodes_of, states, own, shells, notes)


def _statements(path: Path) -> list[Line]:
    found = []
    text, first = "", 0
    for number, line in enumerate(read_lines(path), start=1):
        bare = line.rstrip("\r\n")
        first = first if text else number
        if bare.endswith("\\"):
            text += bare[:-1] + " "
            continue
        text += bare
        words = text.split("#")[0].split()
        found.append(Line(words[0] if words else "", words, text, first))
        text = ""
    if text:
        words = text.split("#")[0].split()
        found.append(Line(words[0] if words else "", words, text, first))
    return found


def _statement(kind: str, nodes: Sequence[int]) -> str:
    return " ".join([kind, *map(str, nodes)])


def _absolute(number: int, seen: int) -> int:
    """Row of a point; a negative number counts back from the one that was read last."""
    return number + seen if number < 0 else number - 1


def _named(line: Line, path: Path, seen: int) -> list[int]:
    given = integers([word.split("/")[0] for word in line.words[1:]], path, line.number)
    found = [_absolute(number, seen) for number in given]
    if min(found, default=0) < 0:
        number = given[int(np.argmin(found))]
        raise InputError(
            f"{path.name}, line {line.number}: there is no node {number}; correct the line."
        )
    return found


def _check_named(faces: Ids, lines: list[int], points: int, path: Path) -> None:
    wrong = faces >= points
    for row in np.flatnonzero(wrong.any(axis=1))[:1]:
        number = faces[row][wrong[row]][0] + 1
        raise InputError(
            f"{path.name}, line {lines[row]}: element {row + 1} names node {number}, which is not "
            "defined; add the node or correct the element."
        )


def _others(joined: list[Ids], own: Ids, path: Path) -> list[Others]:
    found = []
    for nodes in joined:
        if len(nodes) and (nodes.min() < 0 or nodes.max() >= len(own)):
            raise InputError(f"{path.name}: a line names a point that is not there; correct it.")
        ends = np.stack([nodes[:-1], nodes[1:]], axis=1) if len(nodes) > 1 else nodes[:, None]
        if ends.size:
            found.append(Others(own[ends], 1 if len(nodes) > 1 else 0))
    return found
