"""A reader of Abaqus input for tests that shares nothing with the one that is tested, and edits."""

import re
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from meshops.edit import Edit, apply
from meshops.mesh import NO_NODE

OUTSIDE_QUOTES = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')


@dataclass
class Model:
    """What a deck without parts says: flat, by names in capitals unless quoted."""

    nodes: dict = field(default_factory=dict)
    elements: dict = field(default_factory=dict)
    nsets: dict = field(default_factory=lambda: defaultdict(set))
    elsets: dict = field(default_factory=lambda: defaultdict(set))
    rows: dict = field(default_factory=lambda: defaultdict(list))

    def area(self, element):
        p = np.array([self.nodes[n] for n in self.elements[element][1]])
        cross = np.cross(p[2] - p[0], p[-1] - p[1]) if len(p) == 4 else None
        return np.linalg.norm(np.cross(p[1] - p[0], p[2] - p[0]) if cross is None else cross) / 2


def key(name):
    return name if name.startswith('"') else name.upper()


def read_model(text):
    model = Model()
    keyword, options = "", {}
    for line in text.splitlines():
        bare = line.strip()
        if not bare or bare.startswith("**"):
            continue
        if bare.startswith("*"):
            keyword, *rest = (part.strip() for part in OUTSIDE_QUOTES.split(bare[1:]))
            parted = [part.partition("=") for part in rest]
            keyword, options = keyword.upper(), {p[0].strip().upper(): p[2].strip() for p in parted}
            continue
        values = [value.strip() for value in bare.split(",") if value.strip()]
        if keyword == "NODE":
            model.nodes[int(values[0])] = [float(v) for v in (*values[1:], 0, 0, 0)][:3]
            model.nsets[key(options.get("NSET", ""))].add(int(values[0]))
        elif keyword == "ELEMENT":
            kind = options["TYPE"].upper()
            model.elements[int(values[0])] = (kind, [int(v) for v in values[1:]])
            model.elsets[key(options.get("ELSET", ""))].add(int(values[0]))
        elif keyword in ("NSET", "ELSET"):
            sets = {"NSET": model.nsets, "ELSET": model.elsets}[keyword]
            mine = sets[key(options[keyword])]
            if {"GENERATE", "GEN"} & options.keys():
                first, last, step = (int(v) for v in (*values, 1)[:3])
                mine |= set(range(first, last + 1, step))
            else:
                for value in values:
                    mine |= {int(value)} if value.isdigit() else sets[key(value)]
        else:
            model.rows[keyword].append(values)
    return model


def fanned(mesh, *element_ids):
    """The mesh with a new node in the middle of each of these quads, and four trias round it."""
    rows = [int(np.flatnonzero(mesh.element_ids == i)[0]) for i in element_ids]
    middles = mesh.points[mesh.elements[rows]].mean(axis=1)
    trias = [
        (a, b, len(mesh.points) + i, NO_NODE)
        for i, row in enumerate(rows)
        for a, b in zip(mesh.elements[row], np.roll(mesh.elements[row], -1), strict=True)
    ]
    return apply(
        mesh,
        Edit(
            removed=np.array(rows, np.int32),
            added_points=middles,
            added_elements=np.array(trias, np.int32),
            added_region=np.repeat(mesh.region[rows], 4),
        ),
    )


def free_quads(mesh):
    """Ids of the quads that are not locked."""
    return mesh.element_ids[~mesh.locked_elements & ~mesh.is_tria].tolist()


def written(deck, mesh, name="out.inp"):
    """Text of the deck with another mesh, written beside it."""
    path = deck.sources.files[0].path.parent / "written" / name
    deck.write(mesh, path)
    return path.read_text()
