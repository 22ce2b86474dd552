"""What runs per element, candidate and individual: the core."""

from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.workpiece import Workpiece

class Scoring:
    """Criteria at one target element size."""

    def __new__(
        cls, levels: Floats, weights: Floats, active: Bools, penalties: Floats, sizing: Floats
    ) -> Scoring: ...

class Ground:
    """The surface that changed elements must stay on; without facets where it is plane.

    Parameters
    ----------
    points : (n, 3) float64
    facets : (t, 3) int32
    spheres : (t, 4) float64
        Around each facet, as `bounding_spheres` finds them.
    tolerance
        How far from it the centre of an element may be.
    least_corner
        The worst corner that an element may get.
    """

    def __new__(
        cls, points: Floats, facets: Ints, spheres: Floats, tolerance: float, least_corner: float
    ) -> Ground: ...

# --- local edits --------------------------------------------------------------------------------

def evaluate_merges(
    genomes: Ids,
    pairs: Ints,
    on_border: Bools,
    normals: Floats,
    workpiece: Workpiece,
    scoring: Scoring | None,
) -> Floats:
    """(P, TALLY_SIZE) sums of the mesh after merging pairs of nodes at once, for many choices.

    NaN where two pairs share a node, or where merging would invert an element, tear the mesh or
    join it to itself.

    Parameters
    ----------
    genomes : (P, G) int64
        Rows of the pairs; a row beyond them merges nothing.
    pairs : (K, 3) int32
        The node that goes, the one that stays, and whether they meet half-way (1) or there (0).
    on_border : (K,) bool
        Whether the edge between them is on the border.
    normals : (M, 3) float64
        Unit normals of the elements.
    workpiece
        The mesh and its measures.
    scoring
        None: elements are counted and not measured.
    """

def rewire(elements: Ints, target: Ints) -> tuple[Ints, Ints, Ints]:
    """Find which elements vanish by merging, which change, and to what nodes.

    `target` (N,) int32 has for each node the one that it is merged into, for most itself.
    """
