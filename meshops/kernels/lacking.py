"""What a live patch lacks, as the energy of each element and node.

Of an element that is its Q.I., and more where it fails or is a tria or is not sound or off its
size; of an inner node, whether it is irregular, that is whether other than four elements meet
there. See :mod:`meshops.kernels.living` for ``live`` and :mod:`meshops.kernels.node_scores` for
``ground`` and ``scoring``. And:

prices : (5,)
    What a fault of shape, a tria, an irregular node, an element that is not sound and a fault of
    size cost.
site : plane (3,), ground, outside (N,), fixed, area, wanted
    The normal of a plane patch, (0, 0, 0) where it is curved and `ground` counts; how many elements
    outside of the patch meet at a node, -1 where any number may; how many nodes stay where they
    are; the mean area of a quad, a tria being half of one; the wanted sizes.
wanted : sizes (X, Y, Z), origin (3,), cell
    Edge lengths by place, each for a cube of a grid.
"""

from __future__ import annotations

from math import log

from meshops.kernels.living import Live
from meshops.kernels.node_scores import Ground, Scoring, centre, element_faults, foot, soundness
from meshops.kernels.vectors import Vector, area_vector, compiled, inlined, length
from meshops.mesh import Floats, Ints

Prices = tuple[float, float, float, float, float]
Wanted = tuple[Floats, Floats, float]
Site = tuple[Floats, Ground, Ints, int, float, Wanted]

SOUND = 0.05
"""`corner_jacobian_min` from which an element is sound."""

FAR_FROM_REGULAR = 1.5
"""What each element too many or too few at a node costs beyond the first, over what that costs."""

LEAST_FAULT, MOST_FAULT, FAULT_SLOPE = 0.6, 1.2, 0.1
"""Of the whole price: what the least fault costs, the most, and what each more severity adds, so
that what barely fails costs more than a tria and what fails by far has a way back."""

AT_BORDER = 0.1
"""What a tria with a side on a border costs beyond any other tria, over what that costs."""

OFF_SIZE = 0.25
"""What an element costs that has e times the area that is wanted there, or an e-th of it."""


@compiled
def is_plane(site: Site) -> bool:
    """Whether the patch is plane."""
    plane = site[0]
    return bool(plane[0] != 0.0 or plane[1] != 0.0 or plane[2] != 0.0)


@compiled
def _size_off(area: float, place: Vector, wanted: Wanted) -> float:
    """Logarithm of a quad's area over the one that is wanted in its place."""
    sizes, origin, cell = wanted
    i = min(max(int((place[0] - origin[0]) / cell), 0), sizes.shape[0] - 1)
    j = min(max(int((place[1] - origin[1]) / cell), 0), sizes.shape[1] - 1)
    k = min(max(int((place[2] - origin[2]) / cell), 0), sizes.shape[2] - 1)
    size = sizes[i, j, k]
    return log(max(area, 1e-12 * size * size) / (size * size))


@inlined
def _fault_cost(severity: float) -> float:
    return min(LEAST_FAULT + FAULT_SLOPE * severity, MOST_FAULT) if severity > 0.0 else 0.0


@compiled
def element_cost(
    live: Live, e: int, site: Site, prices: Prices, values: Floats, scoring: Scoring
) -> float:
    """Energy of an element; 0 of an empty row."""
    points, elements = live[0], live[1]
    element = elements[e]
    if element[0] < 0:
        return 0.0
    shape, size, index = element_faults(points, element, values, scoring)
    a, b, c, d = element[0], element[1], element[2], element[3]
    area = length(area_vector(points, a, b, c, d))
    # by area, so that a mesh does not get better by having fewer elements
    away = _size_off(area if d >= 0 else 2.0 * area, centre(points, element), site[5])
    share = area / site[4]
    cost: float = share * OFF_SIZE * away * away
    cost += prices[0] * _fault_cost(shape) + prices[4] * _fault_cost(size)
    if shape + size == 0.0:
        cost += share * index
    if d < 0:
        outside = site[2]
        at_border = (outside[a] < 0) + (outside[b] < 0) + (outside[c] < 0) > 1
        cost += prices[1] * (1.0 + AT_BORDER if at_border else 1.0)
    plane, ground = site[0], site[1]
    normal = (plane[0], plane[1], plane[2])
    if not is_plane(site):
        _, normal, distance = foot(ground, centre(points, element))
        if distance > ground[3]:
            cost += prices[3]
    lowest = soundness(points, element, normal)
    if lowest < SOUND:
        cost += prices[3] * (1.0 + SOUND - lowest)
    return cost


@compiled
def node_cost(live: Live, node: int, site: Site, prices: Prices) -> float:
    """Energy of a node."""
    around, outside = live[3], site[2]
    if outside[node] < 0 or around[node] == 0:
        return 0.0
    away = abs(around[node] + outside[node] - 4)
    if away == 0:
        return 0.0
    cost: float = prices[2] * (1.0 + FAR_FROM_REGULAR * (away - 1))
    return cost
