"""Digests of arrays: what compiled Python gave once, and the core has to give on any machine."""

import hashlib

import numpy as np


def digest(*arrays):
    """Of types, shapes and all bytes; tuples of arrays are taken apart."""
    found = hashlib.sha256()
    for array in _flat(arrays):
        found.update(f"{array.dtype.str} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()[:16]


def _flat(arrays):
    for array in arrays:
        if isinstance(array, tuple):
            yield from _flat(array)
        else:
            yield array


def sides(elements):
    """Sides of some elements, each from node to node."""
    found = []
    for element in elements.tolist():
        nodes = [node for node in element if node >= 0]
        found += zip(nodes, nodes[1:] + nodes[:1], strict=True)
    return found


def outline(elements):
    """Sides that no other of some elements runs against."""
    found = sides(elements)
    return sorted(side for side in found if side[::-1] not in found)
