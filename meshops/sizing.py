"""Size fields: how long an edge should be at a place."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from meshops.errors import InputError
from meshops.mesh import NO_NODE, Floats, ShellMesh
from meshops.topology import topology

LOCAL = "local"
"""Stands for the mesh's own sizes on the command line."""

COLUMNS = ("x", "y", "z", "size")

NEIGHBOURS = 4
"""Nearest samples that the size at a place follows from."""

SMOOTHING_ROUNDS = 4


class SizeField(Protocol):
    """The wanted edge length as a function of place: a value, that pickles and never changes."""

    @property
    def digest(self) -> str:
        """Equal digests, equal sizes everywhere."""

    def at(self, places: Floats) -> Floats:
        """(n,) edge lengths, all above 0, at places (n, 3)."""


@dataclass(frozen=True)
class Uniform:
    """The same size everywhere; InputError unless it is positive."""

    size: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.size) and self.size > 0.0):
            raise InputError(f"the target element size must be positive, not {self.size:g}")

    @property
    def digest(self) -> str:
        """The size itself, to the last bit."""
        return f"uniform {float(self.size).hex()}"

    def at(self, places: Floats) -> Floats:
        """(n,) times the size."""
        return np.full(len(places), float(self.size))


@dataclass(frozen=True, eq=False)
class SizeSamples:
    """Sizes known at some places; between them by inverse squared distance (Shepard 1968).

    Never less than the smallest sample nor more than the largest, and equal to a sample at its
    place.

    Attributes
    ----------
    places : (n, 3) float64
    sizes : (n,) float64
    """

    places: Floats
    sizes: Floats

    @classmethod
    def build(cls, places: ArrayLike, sizes: ArrayLike) -> Self:
        """Copy the samples and make them read-only; ValueError where they are no size field."""
        p, s = np.array(places, np.float64), np.array(sizes, np.float64)
        if not len(s) or p.shape != (len(s), 3):
            raise ValueError(f"places {p.shape} must be (n, 3) and sizes {s.shape} (n,), n above 0")
        if not (np.isfinite(p).all() and np.isfinite(s).all() and (s > 0.0).all()):
            raise ValueError("places must be finite, sizes finite and above 0")
        p.flags.writeable = s.flags.writeable = False
        return cls(p, s)

    @classmethod
    def of(cls, mesh: ShellMesh) -> Self:
        """Sample the mesh's own gradation: at each node the geometric mean of its edges' lengths.

        That of a rectangle is the edge of a square as large. Averaged over neighbours a few times,
        so that one bad element does not ask for its like.
        InputError for a mesh without elements.
        """
        if not len(mesh.elements):
            raise InputError("the mesh has no element to take a size from: give the element size")
        start, end = topology(mesh).edges.T
        count = len(mesh.points)
        lengths = np.linalg.norm(mesh.points[end] - mesh.points[start], axis=1)
        known = lengths > 0.0
        if not known.any():
            raise InputError("elements without any length leave no size: give the element size")
        start, end, logarithms = start[known], end[known], np.log(lengths[known])
        edges = np.bincount(start, minlength=count) + np.bincount(end, minlength=count)
        used = edges > 0
        total = np.bincount(start, logarithms, count) + np.bincount(end, logarithms, count)
        sizes = np.divide(total, edges, out=np.zeros(count), where=used)
        for _ in range(SMOOTHING_ROUNDS):
            around = np.bincount(start, sizes[end], count) + np.bincount(end, sizes[start], count)
            sizes = (sizes + around) / (1 + edges)
        return cls.build(mesh.points[used], np.exp(sizes[used]))

    @cached_property
    def digest(self) -> str:
        """Hash of the samples in their order."""
        h = hashlib.blake2b(digest_size=16)
        h.update(np.ascontiguousarray(self.places).tobytes())
        h.update(np.ascontiguousarray(self.sizes).tobytes())
        return f"samples {h.hexdigest()}"

    def at(self, places: Floats) -> Floats:
        """(n,) sizes at places (n, 3), from the nearest samples."""
        if not len(places):
            return np.zeros(0)
        nearest = np.arange(1, min(NEIGHBOURS, len(self.sizes)) + 1)
        distance, rows = self._tree.query(places, nearest)
        # over the nearest one, so that no square of a distance over- or underflows
        ratio = np.divide(
            distance[:, :1], distance, out=np.ones_like(distance), where=distance > 0.0
        )
        weights = ratio**2
        sizes: Floats = (weights * self.sizes[rows]).sum(axis=1) / weights.sum(axis=1)
        return sizes

    @cached_property
    def _tree(self) -> Any:
        return cKDTree(self.places)

    def __getstate__(self) -> dict[str, object]:
        """Only the samples travel; the tree is made again where it is needed."""
        return {"places": self.places, "sizes": self.sizes}


def size_factors(mesh: ShellMesh, sizes: SizeField, size: float) -> Floats:
    """(M,) what brings each element from the size that is wanted in its place to `size`."""
    factors: Floats = size / sizes.at(_corners(mesh).mean(axis=1))
    return factors


def at_even_size(mesh: ShellMesh, sizes: SizeField, size: float) -> ShellMesh:
    """Bring each element to the one size that lengths are judged by, apart from the others.

    An element that is as large as the size field wants it there becomes as large as `size`; its
    angles stay.
    """
    corners = _corners(mesh)
    factors = size_factors(mesh, sizes, size)
    elements = np.arange(4 * len(corners), dtype=np.int32).reshape(-1, 4)
    elements[mesh.is_tria, 3] = NO_NODE
    return ShellMesh.build(
        (corners * factors[:, None, None]).reshape(-1, 3),
        elements,
        region=mesh.region,
        element_ids=mesh.element_ids,
    )


def _corners(mesh: ShellMesh) -> Floats:
    """(M, 4, 3) corners; a tria's last one twice."""
    corners: Floats = mesh.points[mesh.elements]
    corners[mesh.is_tria, 3] = corners[mesh.is_tria, 2]
    return corners


def local_growth(sizes: SizeField, places: Floats) -> tuple[float, tuple[float, ...]]:
    """Find the size in the middle of places (n, 3), and how its logarithm grows there.

    Returns the size and six numbers: the gradient that fits best, and the middle.
    """
    middle = places.mean(axis=0)
    logarithms = np.log(sizes.at(places))
    mean = float(logarithms.mean())
    gradient = np.linalg.lstsq(places - middle, logarithms - mean, rcond=1e-6)[0]
    return math.exp(mean), (*gradient.tolist(), *middle.tolist())


def parse_size(text: str, mesh: ShellMesh) -> SizeField:
    """Make the size field that a user names: a number, ``local``, or a file of samples.

    ``local`` is the gradation of `mesh`. Raises InputError for anything else.
    """
    if text == LOCAL:
        return SizeSamples.of(mesh)
    try:
        size = float(text)
    except ValueError:
        if Path(text).is_file():
            return read_samples(Path(text))
    else:
        return Uniform(size)
    raise InputError(
        f'the element size "{text}" is neither a number nor "{LOCAL}" nor a file that is there'
    )


def read_samples(path: Path) -> SizeSamples:
    """Read a file of lines ``x,y,z,size``; empty lines, ``#`` and a heading are passed over.

    Raises InputError, with the number of the line, where one is anything else.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as UTF-8 text ({error})") from None
    samples: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = [word.strip() for word in line.split("#")[0].split(",")]
        is_heading = not samples and tuple(word.lower() for word in words) == COLUMNS
        if words == [""] or is_heading:
            continue
        try:
            samples.append(_sample(words))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from None
    if not samples:
        raise InputError(f"{path}: has no line with {', '.join(COLUMNS)}")
    table = np.array(samples)
    return SizeSamples.build(table[:, :3], table[:, 3])


def samples_text(sizes: SizeField, mesh: ShellMesh) -> str:
    """Write a size field as a file that `read_samples` reads back to the last bit.

    One that is no samples itself is sampled at the nodes of the mesh.
    """
    places = sizes.places if isinstance(sizes, SizeSamples) else mesh.points
    wanted = sizes.sizes if isinstance(sizes, SizeSamples) else sizes.at(mesh.points)
    rows = np.column_stack([places, wanted]).tolist()
    return "\n".join([",".join(COLUMNS), *(",".join(map(repr, row)) for row in rows), ""])


def _sample(words: list[str]) -> list[float]:
    if len(words) != len(COLUMNS):
        raise InputError(f"needs {', '.join(COLUMNS)}, not {len(words)} values")
    try:
        values = [float(word) for word in words]
    except ValueError:
        raise InputError(f"has something else than numbers: {', '.join(words)}") from None
    if not all(map(math.isfinite, values)):
        raise InputError(f"has a number that is not finite: {', '.join(words)}")
    if values[3] <= 0.0:
        raise InputError(f"the size must be above 0, not {values[3]:g}")
    return values
