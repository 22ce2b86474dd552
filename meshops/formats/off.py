"""OFF files, also with colours, normals and texture: COFF, NOFF, STOFF and so on."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats.file_rows import FileRows
from meshops.formats.fresh import write_edited
from meshops.formats.grid import Grid, Shells, shells_of
from meshops.formats.locks import Lock
from meshops.formats.one_file import OneFile
from meshops.formats.sources import read_bytes
from meshops.formats.welding import weld
from meshops.formats.words import corners, integers, lines_of, numbers, resolution
from meshops.mesh import NO_NODE, Floats, Ids, ShellMesh

_HEAD = re.compile(r"(ST)?(C)?(N)?(4)?(n)?OFF")

WIDEST = 12
"""Numbers of a point at the most: place, normal, colour and texture."""


class Word(NamedTuple):
    """A word and the number of its line."""

    text: str
    line: int


@dataclass(frozen=True, eq=False)
class OffFile(OneFile):
    """An OFF file and the mesh of its faces.

    Attributes
    ----------
    source : Path
    data : bytes
        The file as it was read.
    head : str
        'OFF', 'COFF' and so on.
    points : (n, 3) float64
    words : list of str
        Each point as it stands in the file, with colour and all.
    extra : (n, k) float64
        What follows the places.
    colours : list of str
        What follows the corners of each face.
    point_of : (n,) int64
        The point that each has been welded to.
    corners : (m, 4) int64
        Rows of points of the faces, as the file names them.
    shells : Shells
    notes : tuple of str
    """

    source: Path
    data: bytes
    head: str
    points: Floats
    words: list[str]
    extra: Floats
    colours: list[str]
    point_of: Ids
    corners: Ids
    shells: Shells
    notes: tuple[str, ...]

    @property
    def mesh(self) -> ShellMesh:
        """Quads and trias, all of one region."""
        return self.shells.mesh

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked."""
        return self.shells.locks

    def check_room(self) -> None:
        """Do nothing: what is new is known by its row."""

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write the file with ``mesh`` in the place of its faces; colours and normals stay.

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
        extra = rows.point_values(self.extra)
        moved = np.zeros(len(rows.points), bool)
        moved[rows.node_point[rows.carried.difference.moved]] = True
        points = [
            self.words[source]
            if source >= 0 and not moved[row]
            else " ".join(map(repr, [*rows.points[row].tolist(), *extra[row].tolist()]))
            for row, source in enumerate(rows.point_from.tolist())
        ]
        faces = []
        for row, face in enumerate(rows.cell_from.tolist()):
            nodes = [node for node in rows.corners[row].tolist() if node != NO_NODE]
            if not nodes:
                # a face that names a point twice stays as it is
                was = self.corners[face]
                nodes = rows.point_of[was[was != NO_NODE]].tolist()
            faces.append(" ".join([str(len(nodes)), *map(str, nodes), self.colours[face]]).rstrip())
        text = [self.head, f"{len(points)} {len(faces)} 0", *points, *faces, ""]
        return "\n".join(text).encode("latin-1")


def read_off(path: Path) -> OffFile:
    """Read an OFF file; faces that share no points are welded.

    Raises
    ------
    InputError
        Where the file is missing, no OFF or binary, ends early, holds what is no number or a face
        of more than four corners, or as ``checked_mesh``.
    """
    lines = list(lines_of(path))
    head, width = _head(lines, path)
    number, first = lines[0]
    stream = _Words([(number, first[1:]), *lines[1:]])
    node_count, face_count = stream.counts(path)
    by_lines = _is_by_lines(stream.rest(), node_count, face_count)
    places: list[list[float]] = []
    written: list[str] = []
    extra: list[list[float]] = []
    point_lines: list[int] = []
    faces: list[list[int]] = []
    face_lines: list[int] = []
    colours: list[str] = []
    while len(places) < node_count and stream.has(3):
        words = stream.take(3)
        more = stream.take_line() if by_lines else stream.take(min(width, stream.left) - 3)
        values = numbers([word.text for word in [*words, *more]], path, words[0].line)
        places.append(values[:3])
        extra.append(values[3:])
        written.append(" ".join(word.text for word in [*words, *more]))
        point_lines.append(words[0].line)
    has_colours = not stream.holds_just(face_count)
    while len(faces) < face_count and stream.has(1):
        (count,) = stream.take(1)
        (size,) = integers([count.text], path, count.line)
        if not stream.has(size):
            break
        words = stream.take(max(size, 0))
        nodes = integers([word.text for word in words], path, count.line)
        # what is below 0 is no node either, and not what stands last in a tria
        named = [node if node >= 0 else NO_NODE - 1 for node in nodes]
        faces.append(corners(named, path, count.line))
        face_lines.append(count.line)
        more = stream.take_line() if has_colours else []
        colours.append(" ".join(word.text for word in more))
    if (len(places), len(faces)) != (node_count, face_count):
        raise InputError(
            f"{path.name}: {len(places)} of {node_count} points and {len(faces)} of {face_count} "
            "faces are there; the file is cut short."
        )
    place = np.array(places, np.float64).reshape(-1, 3)
    nodes_of = np.array(faces, np.int64).reshape(-1, 4)
    _check_named(nodes_of, face_lines, len(place), path)
    welded = weld(place, nodes_of, resolution([w for row in written for w in row.split()[:3]]))
    own = welded.point_of
    grid = Grid(
        source=path.name,
        points=place,
        node_ids=np.arange(1, len(place) + 1),
        corners=np.where(nodes_of == NO_NODE, NO_NODE, own[nodes_of]),
        shell_ids=np.arange(1, len(nodes_of) + 1),
        parts=np.zeros(len(nodes_of), np.int64),
        held_nodes=welded.held,
        held_by="points on the same place",
    )
    shells = shells_of(
        grid,
        lambda row: f"{path.name}, line {point_lines[row]}",
        lambda row: f"{path.name}, line {face_lines[row]}",
    )
    least = min((len(row) for row in extra), default=0)
    return OffFile(
        source=path,
        data=read_bytes(path),
        head=head,
        points=place,
        words=written,
        extra=np.array([row[:least] for row in extra], np.float64).reshape(len(extra), least),
        colours=colours,
        point_of=own,
        corners=nodes_of,
        shells=shells,
        notes=(*welded.notes, *shells.notes),
    )


class _Words:
    """The words of a file, taken one after the other."""

    def __init__(self, lines: list[tuple[int, list[str]]]) -> None:
        self._words = [Word(text, number) for number, words in lines for text in words]
        self._at = 0

    @property
    def left(self) -> int:
        return len(self._words) - self._at

    def has(self, count: int) -> bool:
        return self.left >= count

    def take(self, count: int) -> list[Word]:
        found = self._words[self._at : self._at + max(count, 0)]
        self._at += len(found)
        return found

    def take_line(self) -> list[Word]:
        """Take what is left of the line of the word that was taken last."""
        line = self._words[self._at - 1].line
        stop = self._at
        while stop < len(self._words) and self._words[stop].line == line:
            stop += 1
        return self.take(stop - self._at)

    def holds_just(self, faces: int) -> bool:
        """Whether what is left are so many faces and no more."""
        at = self._at
        for _ in range(faces):
            if at >= len(self._words) or not self._words[at].text.isdecimal():
                return False
            at += 1 + int(self._words[at].text[:9])
        return at == len(self._words)

    def rest(self) -> list[list[str]]:
        """List what is left, by lines."""
        lines: dict[int, list[str]] = {}
        for word in self._words[self._at :]:
            lines.setdefault(word.line, []).append(word.text)
        return list(lines.values())

    def counts(self, path: Path) -> tuple[int, int]:
        """Take the numbers of points and faces, and that of the edges, where it is there."""
        words = self.take(2)
        line = words[0].line if words else 1
        if len(words) < 2:
            raise InputError(
                f"{path.name}, line {line}: how many points are there? Check the file."
            )
        points, faces = integers([word.text for word in words], path, line)
        if points < 0 or faces < 0:
            raise InputError(f"{path.name}, line {line}: a count is below 0; correct the line.")
        # some writers leave the edges out, and then begin a new line
        follows = self.left > 0 and self._words[self._at].line == words[1].line
        if follows or words[1].line != words[0].line:
            self.take(1)
        return points, faces


def _head(lines: list[tuple[int, list[str]]], path: Path) -> tuple[str, int]:
    """Keyword of the file, and how many numbers a point has by that."""
    number, words = lines[0] if lines else (1, [""])
    found = _HEAD.fullmatch(words[0])
    if not found:
        raise InputError(
            f"{path.name}, line {number}: an OFF file begins with OFF; check the file."
        )
    texture, colour, normal, four, many = found.groups()
    if four or many or words[1:2] == ["BINARY"]:
        raise InputError(
            f"{path.name}, line {number}: '{' '.join(words)}' is not read; save it as text in "
            "three dimensions."
        )
    return words[0], 3 + 3 * bool(normal) + 4 * bool(colour) + 2 * bool(texture)


def _is_by_lines(lines: list[list[str]], points: int, faces: int) -> bool:
    """Whether each point and each face has a line of its own."""
    if len(lines) < points + faces:
        return False
    widths = {len(line) for line in lines[:points]}
    if len(widths) > 1 or not all(3 <= width <= WIDEST for width in widths):
        return False
    return all(
        line[0].isdecimal() and len(line[0]) < 9 and len(line) > int(line[0])
        for line in lines[points : points + faces]
    )


def _check_named(faces: Ids, lines: list[int], points: int, path: Path) -> None:
    wrong = (faces >= points) | (faces < NO_NODE)
    for row in np.flatnonzero(wrong.any(axis=1))[:1]:
        number = faces[row][wrong[row]][0] + 1
        raise InputError(
            f"{path.name}, line {lines[row]}: element {row + 1} names node {number}, which is not "
            "defined; add the node or correct the element."
        )
