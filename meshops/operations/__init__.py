"""Operations: one file each; every one returns an Edit and changes nothing."""

from __future__ import annotations

from meshops.operations.protocol import Operation, SearchSpace
from meshops.operations.remesh import Remesh
from meshops.operations.replace_node import ReplaceNode

NOTHING = 2
"""The gene of "do nothing" (section 3.3)."""

PAPER_OPERATIONS: tuple[Operation, ...] = (
    Remesh(ranges=5, reach=None),
    ReplaceNode(optional=False),
)
"""Remesh and ReplaceNode as the paper has them."""

OPERATIONS: tuple[Operation, ...] = (Remesh(), ReplaceNode())
"""The same two, which keep only what makes the mesh fitter."""

__all__ = [
    "NOTHING",
    "OPERATIONS",
    "PAPER_OPERATIONS",
    "Operation",
    "Remesh",
    "ReplaceNode",
    "SearchSpace",
]
