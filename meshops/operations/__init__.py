"""Operations: one file each; every one returns an Edit and changes nothing."""

from __future__ import annotations

from meshops.operations.anneal import Anneal
from meshops.operations.automesh import Automesh
from meshops.operations.coarsen import Coarsen
from meshops.operations.collapse_chord import CollapseChord
from meshops.operations.collapse_diagonal import CollapseDiagonal
from meshops.operations.create_nodes import CreateNodes
from meshops.operations.delete_entity import DeleteEntity
from meshops.operations.edit_element import EditElement
from meshops.operations.insert_chord import InsertChord
from meshops.operations.join_trias import JoinTrias
from meshops.operations.open_diagonal import OpenDiagonal
from meshops.operations.protocol import Operation, Remembering, SearchSpace
from meshops.operations.quick_edit import QuickEdit
from meshops.operations.refine import Refine
from meshops.operations.remesh import Remesh
from meshops.operations.remesh_ranges import RemeshRanges
from meshops.operations.remove_doublet import RemoveDoublet
from meshops.operations.replace_chain import ReplaceChain
from meshops.operations.replace_node import ReplaceNode, ReplaceNodePairs
from meshops.operations.slide import Slide
from meshops.operations.smooth import Smooth
from meshops.operations.split_quad import SplitQuad
from meshops.operations.swap_edge import SwapEdge
from meshops.operations.transport_tria import TransportTria

NOTHING = 2
"""The gene of "do nothing" (section 3.3); 0 and 1 are Remesh and ReplaceNode as there."""

PAPER_OPERATIONS: tuple[Operation, ...] = (RemeshRanges(), ReplaceNodePairs())
"""Remesh and ReplaceNode as the paper has them."""

OPERATIONS: tuple[Operation, ...] = (
    SwapEdge(),
    JoinTrias(),
    SplitQuad(),
    TransportTria(),
    CollapseDiagonal(),
    OpenDiagonal(),
    RemoveDoublet(),
    CollapseChord(),
    Smooth(),
    Slide(),
    ReplaceChain(),
    CreateNodes(pool=30),
    EditElement(pool=30),
    Remesh(),
    ReplaceNode(),
    Anneal(),
)
"""Those that a default run chooses from."""

ALL_OPERATIONS: tuple[Operation, ...] = (
    *OPERATIONS,
    *PAPER_OPERATIONS,
    InsertChord(),
    Refine(),
    Coarsen(),
    Automesh(),
    DeleteEntity(),
    QuickEdit(),
)
"""Those that a procedure can name."""

__all__ = [
    "ALL_OPERATIONS",
    "NOTHING",
    "OPERATIONS",
    "PAPER_OPERATIONS",
    "Operation",
    "Remembering",
    "Remesh",
    "RemeshRanges",
    "ReplaceNode",
    "ReplaceNodePairs",
    "SearchSpace",
]
