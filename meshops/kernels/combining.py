"""Small edits done at once: which of them get into each other's way."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Floats, Ids, Ints


@compiled
def claims(
    removed_start: Ints,
    removed: Ints,
    added_start: Ints,
    added: Ints,
    point_start: Ints,
    new_points: Floats,
    moved_start: Ints,
    moved: Ints,
    moved_to: Floats,
    elements: Ints,
    start: Ints,
    around: Ints,
) -> tuple[Ints, Ints]:
    """List what each candidate needs for itself, ragged: ``claimed[start[k]:start[k + 1]]``.

    Numbers below the node count N are the nodes of the elements that go or come; N + e is element
    e, where that goes or a node of it moves.
    """
    nodes = len(start) - 1
    size = 5 * len(removed) + 4 * len(added)
    for node in moved:
        size += start[node + 1] - start[node]
    claimed = np.empty(size, np.int32)
    claim_start = np.zeros_like(removed_start)
    count = 0
    for k in range(len(removed_start) - 1):
        for e in removed[removed_start[k] : removed_start[k + 1]]:
            claimed[count] = nodes + e
            count += 1
            for node in elements[e]:
                if node >= 0:
                    claimed[count] = node
                    count += 1
        for i in range(added_start[k], added_start[k + 1]):
            for node in added[i]:
                if 0 <= node < nodes:
                    claimed[count] = node
                    count += 1
        for node in moved[moved_start[k] : moved_start[k + 1]]:
            for i in range(start[node], start[node + 1]):
                claimed[count] = nodes + around[i]
                count += 1
        claim_start[k + 1] = count
    return claim_start, claimed[:count].copy()


@compiled
def combine(
    genomes: Ids, start: Ints, claimed: Ints, most: int, changes: Floats
) -> tuple[Floats, Bools]:
    """Take the candidates of each genome in order, but none that needs what an earlier one has.

    Parameters
    ----------
    genomes : (P, G) int64
        Rows of candidates; a row beyond them is nothing.
    start, claimed : (K + 1,) int32, (C,) int32
        What each candidate needs, numbers below `most`.
    changes : (K, S) float64
        What each candidate adds to the tally.

    Returns
    -------
    (P, S) float64 sums of the changes, and (P, G) bool which genes were taken.
    """
    sums = np.zeros((len(genomes), changes.shape[1]))
    taken = np.zeros(genomes.shape, np.bool_)
    owner = np.full(most, -1, np.int64)
    for p in range(len(genomes)):
        for g in range(genomes.shape[1]):
            k = genomes[p, g]
            if k >= len(changes):
                continue
            clear = True
            for i in range(start[k], start[k + 1]):
                clear = clear and owner[claimed[i]] != p
            if not clear:
                continue
            for i in range(start[k], start[k + 1]):
                owner[claimed[i]] = p
            sums[p] += changes[k]
            taken[p, g] = True
    return sums, taken
