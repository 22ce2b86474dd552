"""Renumber: give nodes and elements new rows, so that neighbours have numbers near each other."""

from __future__ import annotations

import numpy as np

from meshops.mesh import NO_NODE, Ids, Ints, ShellMesh


def renumber(mesh: ShellMesh) -> ShellMesh:
    """Order nodes and elements anew along fronts through the mesh; the mesh itself stays.

    Nodes are ordered by reverse Cuthill-McKee (George 1971), elements by the lowest number among
    their nodes, then by the others. A range of numbers is a connected strip then, which is what the
    id ranges of the paper's Remesh need; and as the paper reassigns the ids in HyperMesh before
    each operation, so does it keep a range's meaning. Every node and element keeps its deck id.

    This is no Operation, because an Edit says what changes between two meshes, and here nothing
    does: `meshops.edit.apply` keeps the order of all that stays, on which the splicing of decks
    and the replay of a procedure rely. So it is called on a mesh before a run, not within one.
    """
    nodes = _along_fronts(mesh.elements, len(mesh.points))
    number = np.empty(len(nodes), np.int32)
    number[nodes] = np.arange(len(nodes), dtype=np.int32)
    elements = np.where(mesh.elements == NO_NODE, np.int32(NO_NODE), number[mesh.elements])
    # a tria comes before the quads that share its three lowest nodes, so no_node is the lowest
    order = np.lexsort(np.sort(np.where(elements < 0, len(nodes), elements), axis=1).T[::-1])
    return ShellMesh.build(
        points=mesh.points[nodes],
        elements=elements[order],
        region=mesh.region[order],
        locked_nodes=mesh.locked_nodes[nodes],
        locked_elements=mesh.locked_elements[order],
        node_ids=mesh.node_ids[nodes],
        element_ids=mesh.element_ids[order],
    )


def _along_fronts(elements: Ints, nodes: int) -> Ids:
    """(N,) node rows in reverse Cuthill-McKee order; nodes of one element count as neighbours."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    corners = np.where(elements == NO_NODE, elements[:, :1], elements)
    a, b = np.repeat(corners, 4, axis=1).ravel(), np.tile(corners, (1, 4)).ravel()
    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(nodes, nodes)).tocsr()
    order: Ids = reverse_cuthill_mckee(graph, symmetric_mode=True).astype(np.int64)
    return order
