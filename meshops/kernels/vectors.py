"""Vectors of three numbers, as tuples: compiled code keeps them in registers."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any, TypeVar

from numba import njit

from meshops.mesh import Floats

Vector = tuple[float, float, float]

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Compile by numba and keep the machine code on disk.

    Dividing by zero makes infinity or NaN, as IEEE 754 has it: no check in the hot loops.
    """
    machine: Function = njit(cache=True, error_model="numpy")(function)
    return machine


def inlined(function: Function) -> Function:
    """Compile into its callers: for what runs once an element, where the call itself costs most."""
    machine: Function = njit(cache=True, error_model="numpy", forceinline=True)(function)
    return machine


@compiled
def edge(points: Floats, i: int, j: int) -> Vector:
    """Vector from point i to point j."""
    return points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]


@compiled
def add(u: Vector, v: Vector) -> Vector:
    """Sum."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


@compiled
def subtract(u: Vector, v: Vector) -> Vector:
    """Difference."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


@compiled
def dot(u: Vector, v: Vector) -> float:
    """Inner product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@compiled
def cross(u: Vector, v: Vector) -> Vector:
    """Outer product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@compiled
def length(u: Vector) -> float:
    """Euclidean length."""
    return sqrt(dot(u, u))


@compiled
def scale(u: Vector, factor: float) -> Vector:
    """Multiple."""
    return u[0] * factor, u[1] * factor, u[2] * factor


@compiled
def area_vector(points: Floats, a: int, b: int, c: int, d: int) -> Vector:
    """Area of element abcd times its mean unit normal; ``d`` is -1 for a tria."""
    last = c if d < 0 else d
    return scale(cross(edge(points, a, c), edge(points, b, last)), 0.5)


@compiled
def unit(u: Vector) -> Vector:
    """Vector of length 1 in the same direction; (0, 0, 0) for a vector without length."""
    size = length(u)
    if size <= 0.0:
        return 0.0, 0.0, 0.0
    return scale(u, 1.0 / size)


@compiled
def corner_jacobian_min(
    points: Floats, a: int, b: int, c: int, d: int, nx: float, ny: float, nz: float
) -> float:
    """Smallest corner Jacobian against a unit normal, over the longest edge squared.

    At most 1 (a square: 1, an equilateral tria: 0.87); 0 or less for an element that is concave,
    flat or turned over as seen from the normal. ``d`` is -1 for a tria.
    """
    normal = (nx, ny, nz)
    ab, bc = edge(points, a, b), edge(points, b, c)
    if d < 0:
        ca = edge(points, c, a)
        longest = max(dot(ab, ab), dot(bc, bc), dot(ca, ca))
        lowest: float = dot(cross(ab, bc), normal)
    else:
        cd, da = edge(points, c, d), edge(points, d, a)
        longest = max(dot(ab, ab), dot(bc, bc), dot(cd, cd), dot(da, da))
        lowest = min(
            dot(cross(da, ab), normal),
            dot(cross(ab, bc), normal),
            dot(cross(bc, cd), normal),
            dot(cross(cd, da), normal),
        )
    return lowest / longest if longest > 0.0 else 0.0
