"""A strip of five quads as a Nastran deck, and what tests do with it."""

import numpy as np

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.mesh import NO_NODE

# nodes 11 to 16 below and 21 to 26 above, shells 1 to 5
GRIDS = "".join(f"GRID,{10 * j + i},,{i}.,{j}.,0.\n" for j in (1, 2) for i in range(1, 7))
SHELLS = "".join(f"CQUAD4,{i},1,{10 + i},{11 + i},{21 + i},{20 + i}\n" for i in range(1, 6))


def strip(*thetas):
    """The strip with a THETA for each shell."""
    return GRIDS + "".join(
        f"{line},{theta}\n" for line, theta in zip(SHELLS.splitlines(), thetas, strict=True)
    )


def deck_maker(folder):
    """A function that reads a text as a deck in a folder."""

    def make(text, name="deck.bdf"):
        path = folder / name
        path.write_bytes(text.encode())
        return read_deck(path)

    return make


def written(deck, mesh):
    """What the deck becomes with another mesh, as out.bdf beside it."""
    path = deck.sources.files[0].path.with_name("out.bdf")
    deck.write(mesh, path)
    return path.read_bytes().decode()


def halved(mesh, *element_ids):
    """The mesh with each of these quads replaced by two trias of the same region."""
    rows = [int(np.flatnonzero(mesh.element_ids == i)[0]) for i in element_ids]
    quads = mesh.elements[rows]
    trias = [[(a, b, c, NO_NODE), (c, d, a, NO_NODE)] for a, b, c, d in quads]
    return apply(
        mesh,
        Edit(
            removed=np.array(rows, np.int32),
            added_elements=np.reshape(trias, (-1, 4)),
            added_region=np.repeat(mesh.region[rows], 2),
        ),
    )


def changed_lines(before, after):
    """Lines that went, and lines that came."""
    before, after = before.splitlines(), after.splitlines()
    return [a for a in before if a not in after], [b for b in after if b not in before]
