"""The shape and size of each element, from the published definitions alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.mesh import Bools, Floats, ShellMesh

FLAT = 1e-12
"""Twice the area over the longest edge squared up to which an element has no shape."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """Measures of M elements, (M,) each; lengths in the mesh's unit, angles in degrees.

    An element without area has the worst values there are.

    Attributes
    ----------
    is_tria : bool
    least_angle, greatest_angle
        At the corners; over 180 where a quad is concave.
    scaled_jacobian
        Least sine of a corner, 1 for a square and for a regular tria, negative where a corner
        turns the wrong way (Verdict).
    skew, taper, warpage, jacobian
        As HyperMesh defines them; `jacobian` is the ratio at the Gauss points.
    shortest, longest
        Edges.
    height
        The least of the edges and, normalised, of the heights.
    area
    """

    is_tria: Bools
    least_angle: Floats
    greatest_angle: Floats
    scaled_jacobian: Floats
    skew: Floats
    taper: Floats
    warpage: Floats
    jacobian: Floats
    shortest: Floats
    longest: Floats
    height: Floats
    area: Floats

    @classmethod
    def of(cls, mesh: ShellMesh) -> Shapes:
        """Measure all elements of a mesh."""
        tria = mesh.is_tria
        of_trias = _trias(mesh.points[mesh.elements[tria, :3]])
        of_quads = _quads(mesh.points[mesh.elements[~tria]])
        columns = {}
        for name, values in of_quads.items():
            columns[name] = np.empty(len(tria))
            columns[name][tria], columns[name][~tria] = of_trias[name], values
        return cls(is_tria=tria, **columns)

    def aspect(self, *, normalised: bool = False) -> Floats:
        """(M,) longest edge over the shortest, or over the least normalised height."""
        size = self.height if normalised else self.shortest
        infinite = np.full(len(size), np.inf)
        ratio: Floats = np.divide(self.longest, size, out=infinite, where=size > 0.0)
        return ratio


def _trias(corners: Floats) -> dict[str, Floats]:
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    longest, shortest = lengths.max(axis=1), lengths.min(axis=1)
    twice = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    sound = (twice > FLAT * longest**2) & (shortest > FLAT * longest)
    angles = np.degrees(_angles(sides, twice[:, None].repeat(3, axis=1)))
    products = (lengths * np.roll(lengths, 1, axis=1)).max(axis=1)
    # the line of two mid-sides is parallel to the third side
    medians = np.roll(sides, 1, axis=1) * -1.0 + sides
    skew = 90.0 - np.degrees(_lines_apart(medians, np.roll(sides, -1, axis=1))).min(axis=1)
    one, zero = np.ones(len(corners)), np.zeros(len(corners))
    return {
        "least_angle": np.where(sound, angles.min(axis=1), 0.0),
        "greatest_angle": np.where(sound, angles.max(axis=1), 180.0),
        "scaled_jacobian": np.where(sound, _ratio(2.0 / np.sqrt(3.0) * twice, products), 0.0),
        "skew": np.where(sound, skew, 90.0),
        "taper": zero,
        "warpage": zero,
        "jacobian": one,
        "shortest": shortest,
        "longest": longest,
        "height": 2.0 / np.sqrt(3.0) * _ratio(twice, longest),
        "area": 0.5 * twice,
    }


def _quads(corners: Floats) -> dict[str, Floats]:
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    longest, shortest = lengths.max(axis=1), lengths.min(axis=1)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    twice = np.linalg.norm(normal, axis=1)
    sound = (twice > FLAT * longest**2) & (shortest > FLAT * longest)
    of_corners = np.cross(np.roll(sides, 1, axis=1), sides)
    magnitudes = np.linalg.norm(of_corners, axis=2)
    signed = _ratio(np.einsum("qij,qj->qi", of_corners, normal), twice[:, None])
    angles = np.degrees(_angles(sides, magnitudes))
    angles = np.where(signed < 0.0, 360.0 - angles, angles)
    pairs = lengths * np.roll(lengths, 1, axis=1)
    mean = signed.mean(axis=1)
    at_gauss = mean[:, None] + (signed - mean[:, None]) / np.sqrt(3.0)
    split = [
        _angle(of_corners[:, k], of_corners[:, k + 2], magnitudes[:, k], magnitudes[:, k + 2])
        for k in (0, 1)
    ]
    along, across = sides[:, 0] - sides[:, 2], sides[:, 1] - sides[:, 3]
    skew = 90.0 - np.degrees(_lines_apart(along, across))
    longer = np.maximum(lengths, np.roll(lengths, 1, axis=1))
    return {
        "least_angle": np.where(sound, angles.min(axis=1), 0.0),
        "greatest_angle": np.where(sound, angles.max(axis=1), 180.0),
        "scaled_jacobian": np.where(sound, _ratio(signed, pairs).min(axis=1), 0.0),
        "skew": np.where(sound, skew, 90.0),
        "taper": np.where(sound, 1.0 - _ratio(2.0 * signed.min(axis=1), twice), 1.0),
        "warpage": np.where(sound, np.degrees(np.maximum(*split)), 180.0),
        "jacobian": np.where(sound, _ratio(at_gauss.min(axis=1), at_gauss.max(axis=1)), 0.0),
        "shortest": shortest,
        "longest": longest,
        "height": np.minimum(shortest, _ratio(magnitudes, longer).min(axis=1)),
        "area": 0.5 * twice,
    }


def _angles(sides: Floats, sines: Floats) -> Floats:
    """Interior angles in radians; `sines` are the lengths of the corners' cross products."""
    cosines = -np.einsum("eij,eij->ei", np.roll(sides, 1, axis=1), sides)
    found: Floats = np.arctan2(sines, cosines)
    return found


def _angle(one: Floats, other: Floats, length: Floats, other_length: Floats) -> Floats:
    """Radians between vectors (n, 3); 0 where one of them has no length."""
    sine = np.linalg.norm(np.cross(one, other), axis=1)
    angle: Floats = np.arctan2(sine, np.einsum("ij,ij->i", one, other))
    return np.where((length > 0.0) & (other_length > 0.0), angle, 0.0)


def _lines_apart(one: Floats, other: Floats) -> Floats:
    """Radians between lines, at most a right angle; 0 where one has no length."""
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    found: Floats = np.arctan2(sine, np.abs((one * other).sum(axis=-1)))
    return found


def _ratio(numerator: Floats, denominator: Floats) -> Floats:
    """Quotient; 0 where there is nothing to divide by."""
    numerator, denominator = np.broadcast_arrays(numerator, denominator)
    out = np.zeros(numerator.shape)
    return np.divide(numerator, denominator, out=out, where=denominator > 0.0)
