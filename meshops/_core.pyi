"""The core: what runs for each element, candidate and individual, compiled from Rust.

Arrays are borrowed where they lie in memory row by row, copied where they do not, and never
written to. ValueError where shapes do not fit or a row is named that is not there.
"""

from typing import Literal

from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.operations.candidates import CandidateArrays, Candidates
from meshops.operations.slide import Curves
from meshops.operations.strips import Strips
from meshops.surface import PatchSurface
from meshops.topology import Topology
from meshops.workpiece import Workpiece

class Scoring:
    """Criteria at one target element size: what `meshops.criteria.Scoring.core` makes."""

    def __new__(
        cls, levels: Floats, weights: Floats, active: Bools, penalties: Floats, sizing: Floats
    ) -> Scoring:
        """(13, 6) levels, (13,) weights, (13,) active, (5,) penalties and (7,) sizing."""

class Fitness:
    """How meshes are ordered by their quality sums, as `meshops.fitness.Fitness` has it."""

    def __new__(
        cls,
        limits: tuple[float, float, float],
        share: float,
        irregularity: float,
        trias_first: bool,
    ) -> Fitness:
        """Limits of shape, trias and size; what comes second is divided by `share`."""

    def of(self, sums: Floats, prices: Floats, scoring: Scoring) -> Floats:
        """(P,) fitness of (P, 56) quality sums; minus infinity where there is no mesh."""

# --- meshes: topology, patches, validity ----------------------------------------------------------

class ElementGraph:
    """Elements of a mesh, joined across the edges that may be crossed."""

    def __new__(cls, element_edges: Ints, edge_elements: Ints, crossable: Bools) -> ElementGraph:
        """(M, 4) edges of the elements, (E, 2) elements of the edges, (E,) bool."""

    def label_components(self, selected: Bools) -> Ints:
        """(M,) component of each selected element, by their first elements; elsewhere -1."""

    def rings_around(self, allowed: Bools, centres: Ints) -> Ints:
        """(M,) crossable edges to the nearest centre; 2^30 where no way is through allowed ones."""

    def nearby(self, allowed: Bools, centre: int, shift: int) -> int:
        """Row of the element that is visited as number `shift` from a centre, or the last one."""

    def disc(self, allowed: Bools, centre: int, most: int) -> Bools:
        """(M,) bool: allowed elements across at most `most` crossable edges from a centre."""

    def strip(self, allowed: Bools, first: int, last: int, most: int) -> Bools:
        """(M,) bool: elements within `most` crossable edges from the shortest way between two.

        A disc around the first where there is no way.
        """

    def partition(self, editable: Bools, bad: Ints, rings: int, elements: int) -> Ints:
        """(M,) subdomain of each element; -1 for an element that is in none.

        Each bad element that is in no subdomain yet starts one: all free elements around it, ring
        by ring, up to so many rings and elements.
        """

    def cut(self, rows: Ints, elements: Ints) -> tuple[Ints, Ints, Ints]:
        """Cut connected elements out along every barrier; their rows ascend.

        Returns the elements (m, 4) on patch nodes, those of the border first; the mesh node of each
        patch node (n,); and the border edges (b, 2), each in the direction of its element.
        """

def find_edges(elements: Ints, nodes: int) -> tuple[Ints, Ints, Ints, Ints, Bools]:
    """Find the edges of elements (M, 4), each once, ordered by their nodes.

    Returns
    -------
    edges : (E, 2) int32
        Node rows, the smaller first.
    element_edges : (M, 4) int32
        The edge of each side; -1 fourth for a tria.
    edge_elements : (E, 2) int32
        The two elements of an edge that has exactly two; elsewhere -1.
    uses : (E,) int32
        How many elements meet at an edge.
    opposed : (E,) bool
        Edges of exactly two elements that run along them in opposite directions.
    """

def elements_of_nodes(elements: Ints, nodes: int) -> tuple[Ints, Ints]:
    """Elements around each node: those of node n are ``around[start[n]:start[n + 1]]``."""

def unit_normals(points: Floats, elements: Ints) -> Floats:
    """(M, 3) unit normals; a quad's is that of its two diagonals; zero for a flat line."""

def valid_elements(points: Floats, elements: Ints, least_corner: float) -> Bools:
    """(M,) bool: elements whose worst corner, along their own normal, is not below `least_corner`.

    A corner is its Jacobian over the longest edge squared: a square has 1.
    """

def all_facing(points: Floats, elements: Ints, normals: Floats) -> bool:
    """Whether every element looks the way of its (M, 3) surface normal, up to 60 degrees."""

def has_doubles(elements: Ints, nodes: int) -> bool:
    """Whether two elements have the same nodes, or one all nodes of another."""

def trace_loops(border: Ints) -> tuple[Ints, Ints]:
    """Order the border edges (b, 2) of a patch, each from node to node, into closed loops.

    Returns the rows of the edges, loop after loop, and where each loop starts and the last ends.
    """

def irregular_nodes(start: Ints, outside: Ints) -> Bools:
    """(N,) bool: used nodes with other than four elements.

    `outside` is how many of them are not of the mesh; -1: any number may meet at the node.
    """

def irregular_change(goes: Ints, comes: Ints, elements: Ints, start: Ints, outside: Ints) -> int:
    """How many more nodes are irregular once elements (B, 4) have come for those in some rows."""

# --- quality of elements and meshes ---------------------------------------------------------------

def measure_elements(points: Floats, elements: Ints, sizing: Floats) -> Floats:
    """(M, 12) measures of elements, in the order of the criteria.

    Lengths in the unit of `points`, angles in degrees. NaN where a criterion does not apply or is
    not measured here (chordal deviation). `sizing` is that of `meshops.criteria.Scoring`.
    """

def element_faults(points: Floats, elements: Ints, scoring: Scoring) -> Floats:
    """(M, 3) severity of each element's faults of shape and of size, and its Q.I."""

def penalise(values: Floats, scoring: Scoring) -> Floats:
    """(M, 12) penalties of (M, 12) measures; NaN where a criterion is inactive or not measured."""

def penalty_of(value: float, criterion: int, scoring: Scoring) -> float:
    """Penalty of one value by a criterion: linear between its levels, constant outside them."""

def sum_measures(values: Floats, is_tria: Bools, scoring: Scoring) -> Floats:
    """(56,) quality sums of elements by their (M, 12) measures; no node counts as irregular."""

def sum_elements(points: Floats, elements: Ints, scoring: Scoring) -> Floats:
    """(56,) quality sums of elements, chordal deviation left out; no node counts as irregular."""

def criterion_indices(sums: Floats) -> Floats:
    """(12,) Q.I. by criterion: mean penalty that passes plus the sum of those that fail."""

def percent_trias(sums: Floats) -> float:
    """Trias in percent of the elements; 0 for no elements."""

def compound_index(sums: Floats, scoring: Scoring) -> float:
    """Compound Q.I.: weighted mean over the criteria that pass plus the sum of the rest."""

def compound_indices(sums: Floats, scoring: Scoring) -> Floats:
    """(P,) compound Q.I. of (P, 56) quality sums; NaN where there is no mesh."""

# --- surfaces -------------------------------------------------------------------------------------

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

def bounding_spheres(points: Floats, facets: Ints) -> Floats:
    """(T, 4) centre and radius of a sphere around each facet (T, 3)."""

def nearest(
    queries: Floats, points: Floats, facets: Ints, spheres: Floats
) -> tuple[Floats, Floats, Ints]:
    """Nearest point of a surface to each query.

    Returns the points (Q, 3), the distances (Q,) and the facets (Q,) that they lie on; of equally
    near ones the first.
    """

class FacetTree:
    """The facets of a surface that is asked many times; there is one."""

    def __new__(cls, points: Floats, facets: Ints) -> FacetTree: ...
    def nearest(self, queries: Floats) -> tuple[Floats, Floats, Ints]:
        """Find what the function of that name finds."""

def areas_of(points: Floats, facets: Ints) -> tuple[Floats, float]:
    """Sum of the area vectors of facets (3,), and sum of their areas."""

def plane_of(points: Floats, facets: Ints, tolerance: float) -> tuple[Floats, float, Floats, bool]:
    """Sum of the area vectors of facets, sum of their areas, unit normal, and whether it is plane.

    Plane: all points are nearer to one plane than `tolerance` times their extent, and all facets
    look the same way.
    """

def nearest_edges(points: Floats, starts: Floats, ends: Floats) -> tuple[Floats, Ints, Floats]:
    """Distance, row and place (from 0 at its start to 1) of the nearest edge to each point."""

# --- smoothing: nodes move, elements stay as they are ---------------------------------------------

class NodeSearch:
    """What nodes move for, and what they must keep.

    No element is turned over, gets a corner below the least or leaves the surface; none that does
    already gets worse. Of the elements around a node that moves no more fail than before, and
    their highest Q.I. does not rise, but for ``even``, which lowers their sum.

    Parameters
    ----------
    goal
        To the mean of the neighbours; for the worst elements first; for the mean element.
    surface
        The surface that they stay on.
    tolerance
        How far from it the centre of an element may be.
    least_corner
        The worst corner that an element may get.
    """

    def __new__(
        cls,
        goal: Literal["laplace", "worst", "even"],
        surface: PatchSurface,
        tolerance: float,
        least_corner: float,
        scoring: Scoring,
    ) -> NodeSearch: ...
    def optimise(self, points: Floats, elements: Ints, nodes: Ints) -> Floats:
        """(N, 3) places once some nodes have moved to where the elements around them are better.

        The mesh may be the part of another that is all elements around them, which close around
        each.
        """

    def slide(
        self, points: Floats, elements: Ints, nodes: Ints, curves: Curves, shift: float
    ) -> Floats:
        """(N, 3) places once some nodes have moved, those on a border along it.

        Along a border of which each element fails alike, no node can do anything alone: `shift`, of
        its edges, is what all border nodes beside failing elements do at first.
        """

def smooth_laplace(points: Floats, elements: Ints, first_free: int, sweeps: int) -> Floats:
    """(N, 3) places once the nodes from a row on have moved towards the mean of their neighbours.

    A node moves in the tangent plane of its elements, and only as far as the worst corner around it
    does not get worse.
    """

def project(points: Floats, surface: PatchSurface) -> Floats:
    """(N, 3) nearest places on a surface."""

def relax_candidates(
    candidates: Candidates, workpiece: Workpiece, most_elements: int, sweeps: int
) -> tuple[Floats, Ints, Ints, Floats]:
    """Smooth the new points, the moved nodes and the free nodes of the elements that come.

    Each candidate on its own, on the surface; one that moves nodes of more than `most_elements`
    stays as it is. Returns points, moved_start, moved and moved_to of the candidates.
    """

# --- recombination: trias to quads, quads to trias ------------------------------------------------

def tria_neighbours(trias: Ints, nodes: int) -> Ints:
    """(T, 3) tria across side k, from node k to the next one; -1 for none."""

def pair_shapes(points: Floats, trias: Ints, neighbours: Ints) -> Floats:
    """(T, 3) shape of the quad that each tria makes with its neighbour across side k.

    The sine of the quad's worst corner; -2 for sides without a neighbour.
    """

def greedy_matching(neighbours: Ints, shapes: Floats, least: float) -> Ints:
    """(T,) mate of each tria or -1: neighbours are paired by falling shape down to `least`."""

def maximum_matching(neighbours: Ints, shapes: Floats, mate: Ints) -> Ints:
    """(T,) mate of each tria or -1: a matching augmented until none has more pairs.

    Better shapes are tried first. Neighbours must be mutual, and mates too.
    """

def merge_pairs(trias: Ints, neighbours: Ints, mate: Ints) -> Ints:
    """(M, 4) elements: a quad for each pair, in the place of its first tria, and lone trias."""

def recombine(points: Floats, trias: Ints, least: float, good: float) -> Ints:
    """(M, 4) elements of trias (T, 3), merged as completely as can be, good quads first.

    No quad is of a shape below `least`; those down to `good` are taken greedily.
    """

def as_trias(points: Floats, elements: Ints) -> Ints:
    """(T, 3) trias as they are, quads split along their better diagonal, in their order."""

def split_quads(points: Floats, elements: Ints, chosen: Bools) -> Ints:
    """(M', 4) elements: the chosen quads split along their better diagonal, all else as it is.

    The two trias of a quad take its place.
    """

def unite_trias(points: Floats, elements: Ints) -> Ints:
    """(M', 4) elements on the same nodes: lone trias move through quads until they meet in pairs.

    They are taken in the order of their rows, each on its shortest way to another.
    """

# --- meshing of plane areas and patches -----------------------------------------------------------

def clip_ears(points: Floats, start: Ints) -> Ints | None:
    """(t, 3) trias of the area within closed loops; None where they do not bound an area.

    Loop i has the points (n, 2) ``start[i]:start[i + 1]``: one runs counter-clockwise around the
    area, all others clockwise around a hole in it.
    """

def pack_parallelograms(
    points: Floats, trias: Ints, border: Ints, size: float, room: int
) -> tuple[Floats, Ints] | None:
    """Fill a plane area with nodes for quads of edge `size`, in rows along its border.

    Parameters
    ----------
    points : (n, 2) float64
        Border nodes come first.
    trias : (t, 3) int32
        An older triangulation of the area, whose border stays.
    border : (b, 2) int32
        Border edges in the direction of their tria.
    size : float
    room : int
        Most nodes that may be placed.

    Returns
    -------
    The points (n', 2), border nodes first, and the trias (t', 3); None where the area cannot be
    triangulated on its border.
    """

def fill_by_refinement(
    points: Floats, trias: Ints, border: Ints, size: float, room: int
) -> tuple[Floats, Ints] | None:
    """Fill an area with trias of edge `size` by Delaunay refinement and Laplace smoothing.

    Parameters and results are those of ``pack_parallelograms``.
    """

def fill_by_bubbles(
    points: Floats, trias: Ints, border: Ints, size: float, room: int
) -> tuple[Floats, Ints] | None:
    """Fill an area with trias of edge `size` by bubble packing.

    Parameters and results are those of ``pack_parallelograms``.
    """

def lift(flat: Floats, trias: Ints, points: Floats, places: Floats) -> Floats:
    """(q, 3) places on a surface of places (q, 2) in the plane of its flattened trias.

    `flat` (n, 2) and `points` (n, 3) are its nodes in the plane and in space. Where a place lies in
    no tria, the nearest node lends its own.
    """

def area_normals(points: Floats, trias: Ints) -> Floats:
    """(T, 3) normals of trias, as long as twice their area."""

def extents(points: Floats) -> tuple[float, float]:
    """Largest coordinate without its sign; largest distance along an axis from the first point.

    Infinite where a coordinate is not finite.
    """

def collar_apexes(points: Floats, trias: Ints, border: Ints) -> Floats:
    """(b, 3) points, one outside each border edge, in the plane of the tria inside it."""

class BorderCollar:
    """A patch of trias with one more tria outside each border edge, so that remeshing keeps it."""

    points: Floats
    """(n + b, 3); the apexes of the collar come last."""
    trias: Ints
    """(t + b, 3); those of the collar come last."""
    inside: Floats
    """(t + b,) 1 for the trias of the patch, 0 for those of the collar."""

    def __new__(cls, points: Floats, trias: Ints, border: Ints, nudge: float) -> BorderCollar:
        """Put a collar on a patch (n, 3), (t, 3), (b, 2).

        Nodes at the same place are set apart by `nudge`; a node of the border may come back so far
        from its place.
        """

    def take_off(self, points: Floats, trias: Ints, inside: Floats) -> tuple[Floats, Ints]:
        """Take the collar off the remeshed patch: its points and trias.

        Nodes of the border first, at the rows and places that they had. ValueError where a
        coordinate is not finite or the border did not come back whole.
        """

# --- local edits ----------------------------------------------------------------------------------

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

def evaluate_candidates(
    candidates: Candidates,
    workpiece: Workpiece,
    scoring: Scoring,
    plane_tolerance: float,
    surface_tolerance: float,
) -> Floats:
    """(K, 56) quality sums of the mesh after each candidate alone.

    NaN for a candidate that does nothing, or that would not leave the mesh whole, its new elements
    sound and its new places on the surface. How far from it they may be: `plane_tolerance` is a
    share of its extent, where it is plane, `surface_tolerance` one of the edge length there.
    """

class Claims:
    """What each of some candidates needs for itself."""

    def __new__(cls, candidates: Candidates, elements: Ints, around: tuple[Ints, Ints]) -> Claims:
        """`around`: the elements of nodes, as `elements_of_nodes` finds them."""

    def combine(self, genomes: Ids, changes: Floats) -> tuple[Floats, Bools]:
        """Take the candidates of each genome in order, but none that needs what an earlier one has.

        Parameters
        ----------
        genomes : (P, G) int64
            Rows of candidates; a row beyond them is nothing.
        changes : (K, 56) float64
            What each candidate adds to the quality sums.

        Returns
        -------
        (P, 56) float64 sums of the changes, and (P, G) bool which genes were taken.
        """

def join_trias(elements: Ints, pairs: Ints) -> CandidateArrays:
    """One quad of each pair of trias (S, 2) that share an edge."""

def swap_edges(elements: Ints, pairs: Ints) -> CandidateArrays:
    """Two turns of the edge between each pair of elements (S, 2); one that there is not is empty.

    Between two quads it turns to one of the two other long diagonals of their hexagon; between a
    quad and a tria the tria changes its place in their pentagon; between two trias the first turn
    is to the other diagonal.
    """

def collapse_diagonals(
    quads: Ints, points: Floats, elements: Ints, around: tuple[Ints, Ints], free: Bools
) -> CandidateArrays:
    """Make the opposite nodes of each quad one, in two ways; empty where neither node is free.

    A node that is free goes to the other, and both to the middle where both are free.
    """

def open_diagonals(
    nodes: Ints, variants: int, points: Floats, elements: Ints, around: tuple[Ints, Ints]
) -> CandidateArrays:
    """Split each node along two of its edges and put a quad between, in up to 12 variants.

    Variant i opens at edge i of the node and at the one half of the elements further on; empty
    where there is none.
    """

def select_ranges(ranges: Ints, count: int) -> Bools:
    """(count,) bool: union of ranges (K, 2) of numbers from 1, ends included, in any order."""

# --- strips ---------------------------------------------------------------------------------------

def straight_strips(
    elements: Ints, topology: Topology, trias: Ints, reach: int, steps: int
) -> tuple[Ints, Ints, Ints]:
    """Open strips that leave a tria and cross quads from side to opposite side.

    All that end at another tria behind at most `reach` quads (or `steps`, where that is more), each
    found once, and all that end in one of the first `steps` quads. Returns start, cells and rungs
    of `Strips`.
    """

def closed_strips(elements: Ints, topology: Topology) -> tuple[Ints, Ints, Ints]:
    """All rows of quads that close on themselves, except those that cross themselves."""

def shortest_strips(
    elements: Ints, topology: Topology, trias: Ints, reach: int, steps: int, partners: int
) -> tuple[Ints, Ints, Ints]:
    """Open strips: the shortest ways from each tria through quads, turning as they may.

    Those to the nearest `partners` other trias behind 1 to `reach` quads, each pair found once, and
    those to each quad across at most `steps` edges.
    """

def transport_trias(
    strips: Strips, ways: Ints, points: Floats, elements: Ints
) -> tuple[Ints, Ints]:
    """Elements after the tria at the beginning of each strip has walked to its end.

    Parameters
    ----------
    strips
        Open ones that begin at a tria.
    ways : (S,) int32
        Where a step goes that crosses a quad straight: always right (0), always left (1), or where
        it gives the better elements (2).

    Returns
    -------
    added_start, added : (S + 1,) int32, (B, 4) int32
        They take the place of the cells of each strip.
    """

def insert_chords(
    strips: Strips, ends: Ints, points: Floats, elements: Ints
) -> tuple[tuple[Ints, Ints, Ints, Ints], tuple[Ints, Floats]]:
    """Put a node on the middle of every rung and split the strips lengthwise.

    The quads between two rungs become two, a tria at the end becomes a quad, and a quad at the end
    a quad and a tria, which is at the first node of the last rung for an end of 0, at the second
    for 1. There is only 0 for a strip that does not end in a quad.

    Returns the elements that go and come, and the new points, as in ``Candidates``.
    """

def collapse_chords(
    strips: Strips, points: Floats, elements: Ints, around: tuple[Ints, Ints], free: Bools
) -> tuple[tuple[Ints, Ints, Ints, Ints], tuple[Ints, Ints, Floats]]:
    """Merge the two nodes of every rung, half-way or at the one that is not free.

    The quads between two rungs vanish, a tria at the end vanishes, and a quad at the end becomes a
    tria. `around` are the elements of nodes.

    Returns the elements that go and come, and the moves, as in ``Candidates``; nothing for a strip
    with a node on two rungs, or with a rung of which neither node is free.
    """

# --- cavities -------------------------------------------------------------------------------------

FILLINGS: int
"""Ways to fill the ring around a node that is taken out."""

def cavity_polygons(elements: Ints, groups: Ints) -> tuple[Ints, Ints]:
    """Walk around each group of up to three adjacent elements.

    The first node is where the first element leaves a side that it shares with another, so that
    the order does not depend on how the nodes are numbered; the first node of an element alone.

    Parameters
    ----------
    elements : (M, 4) int32
    groups : (S, 3) int32
        Element rows; -1 where a place is empty.

    Returns
    -------
    polygons : (S, 12) int32
        Node rows, counter-clockwise; -1 beyond the last.
    sizes : (S,) int32
        Corners of each polygon; 0 where what is around the group is not one simple polygon.
    """

def pillow(
    sets: tuple[Ints, Ints], points: Floats, elements: Ints, graph: ElementGraph
) -> tuple[Ints, Ints, Ints, Floats]:
    """Shrink sets of elements and put a ring of quads around each (Mitchell and Tautges 1995).

    `sets` are where each begins, (K + 1,), and the rows of its elements. Returns the elements that
    come and the new points, as in ``Candidates``.
    """

def remove_nodes(
    nodes: Ints, ways: Ints, elements: Ints, around: tuple[Ints, Ints]
) -> tuple[Ints, Ints, Ints, Ints]:
    """Take inner nodes out and fill the ring around each with fewer elements.

    `nodes` and `ways` (K,): the node of each candidate and the way to fill its ring, below
    ``FILLINGS``. Returns the elements that go and come, as in ``Candidates``; nothing for a way
    that there is not, or that is the same as another.
    """

# --- annealing ------------------------------------------------------------------------------------

class AnnealingPrices:
    """What each lack costs over an element whose Q.I. is higher by 1.

    A fault of shape, a tria, an irregular node, an element that is not valid, a fault of size.
    """

    def __new__(
        cls, *, shape: float, tria: float, irregular: float, invalid: float, size: float
    ) -> AnnealingPrices: ...

class Cooling:
    """Temperatures on the scale of the energy: from one to the other by the same share a trial."""

    def __new__(cls, *, hot: float, cold: float, trials: int) -> Cooling: ...

class WantedSizes:
    """Edge lengths (X, Y, Z) that are wanted, each for a cube of a grid from `origin` (3,) on."""

    def __new__(cls, sizes: Floats, origin: Floats, cell: float) -> WantedSizes: ...

class AnnealingSite:
    """Where a patch lies.

    Parameters
    ----------
    outside : (n,) int32
        How many elements outside of the patch meet at each node; -1: any number may meet there.
    fixed
        How many nodes, the first ones, stay where they are: those of the border.
    plane : (3,) float64 or None
        The normal of a plane patch. Where there is none, `ground` needs facets.
    """

    def __new__(
        cls,
        *,
        outside: Ints,
        fixed: int,
        plane: Floats | None,
        ground: Ground,
        wanted: WantedSizes,
    ) -> AnnealingSite: ...

def anneal(
    points: Floats,
    elements: Ints,
    site: AnnealingSite,
    prices: AnnealingPrices,
    scoring: Scoring,
    cooling: Cooling,
    seed: int,
) -> tuple[Floats, Ints, float, float] | None:
    """Anneal a patch by small random changes (Kirkpatrick, Gelatt and Vecchi 1983).

    Returns its points and elements after it, border nodes first, and the energy before and after;
    None where too many elements meet at a node.
    """
