"""Meshes for tests of what works on meshes."""

import numpy as np

from meshops.mesh import ShellMesh


def bad_plate(columns: int = 10, rows: int = 8, seed: int = 0) -> ShellMesh:
    """A plane plate of 5 x 5 quads whose inner nodes are shaken, with some quads split."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(columns + 1) * 5.0, np.arange(rows + 1) * 5.0, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    numbers = np.arange(x.size).reshape(x.shape)
    inner = numbers[1:-1, 1:-1].ravel()
    points[inner, :2] += rng.uniform(-1.5, 1.5, (len(inner), 2))
    quads = np.stack(
        [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    split = np.zeros(len(quads), bool)
    split[rng.choice(len(quads), 6, replace=False)] = True
    a, b, c, d = quads[split].T
    trias = [np.stack([a, b, c, -np.ones_like(a)], 1), np.stack([a, c, d, -np.ones_like(a)], 1)]
    return ShellMesh.build(points, np.concatenate([quads[~split], *trias]))
