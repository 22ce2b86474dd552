"""Rectangular, cylindrical and spherical coordinate systems."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshops.mesh import Floats

Kind = Literal["R", "C", "S"]


@dataclass(frozen=True, eq=False)
class Frame:
    """A coordinate system; angles are in degrees, as in decks.

    Local coordinates are (x, y, z), (r, theta, z) or (r, theta, phi), with the spherical theta
    measured from the z axis and phi about it (MSC Nastran Quick Reference Guide, CORD2S).

    Attributes
    ----------
    kind : 'R', 'C' or 'S'
    origin : (3,) float64
        In the basic system.
    axes : (3, 3) float64
        Rows are the unit vectors x, y, z in the basic system.
    """

    kind: Kind
    origin: Floats
    axes: Floats

    def to_basic(self, local: Floats) -> Floats:
        """Turn local coordinates (N, 3) into basic ones (N, 3)."""
        if self is BASIC:
            return local
        basic: Floats = self.origin + self._to_rectangular(local) @ self.axes
        return basic

    def from_basic(self, basic: Floats) -> Floats:
        """Turn basic coordinates (N, 3) into local ones (N, 3)."""
        if self is BASIC:
            return basic
        rectangular = (basic - self.origin) @ self.axes.T
        if self.kind == "R":
            return rectangular
        x, y, z = rectangular.T
        azimuth = np.degrees(np.arctan2(y, x))
        if self.kind == "C":
            return np.column_stack([np.hypot(x, y), azimuth, z])
        polar = np.degrees(np.arctan2(np.hypot(x, y), z))
        return np.column_stack([np.linalg.norm(rectangular, axis=1), polar, azimuth])

    def vectors(self, components: Floats, points: Floats) -> Floats:
        """Turn a vector of three components (3,) in the system into basic ones at points (N, 3)."""
        if self.kind == "R":
            return np.broadcast_to(components @ self.axes, points.shape)
        local = np.radians(self.from_basic(points))
        turn = local[:, 1] if self.kind == "C" else local[:, 2]
        zero, one = np.zeros_like(turn), np.ones_like(turn)
        out = np.stack([np.cos(turn), np.sin(turn), zero], axis=1)
        round_ = np.stack([-np.sin(turn), np.cos(turn), zero], axis=1)
        up = np.stack([zero, zero, one], axis=1)
        base = [out, round_, up]
        if self.kind == "S":
            sine, cosine = np.sin(local[:, 1:2]), np.cos(local[:, 1:2])
            base = [sine * out + cosine * up, cosine * out - sine * up, round_]
        turned: Floats = sum(c * b for c, b in zip(components, base, strict=True)) @ self.axes
        return turned

    def _to_rectangular(self, local: Floats) -> Floats:
        if self.kind == "R":
            return local
        r, second, third = local.T
        if self.kind == "C":
            angle = np.radians(second)
            return np.column_stack([r * np.cos(angle), r * np.sin(angle), third])
        polar, azimuth = np.radians(second), np.radians(third)
        across = r * np.sin(polar)
        return np.column_stack(
            [across * np.cos(azimuth), across * np.sin(azimuth), r * np.cos(polar)]
        )


BASIC = Frame("R", np.zeros(3), np.eye(3))
"""The basic system: its coordinates pass through unchanged, bit for bit."""


def frame_through(kind: Kind, points: Floats) -> Frame:
    """Make a system of its origin, a point on z and one in the xz half-plane: points (3, 3).

    Raises ValueError where the three lie on a line.
    """
    origin, on_z, in_xz = points
    z = on_z - origin
    y = np.cross(z, in_xz - origin)
    length_z, length_y = float(np.linalg.norm(z)), float(np.linalg.norm(y))
    if not length_y > 1e-12 * length_z * float(np.linalg.norm(in_xz - origin)):
        raise ValueError("the three points of a coordinate system lie on a line")
    z, y = z / length_z, y / length_y
    return Frame(kind, origin, np.array([np.cross(y, z), y, z]))
