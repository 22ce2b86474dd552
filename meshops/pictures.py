"""Pictures of meshes: where the trias and the failed elements are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from meshops.assessment import Assessment
from meshops.errors import InputError
from meshops.formats.output import write_whole
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh
from meshops.topology import element_normals, topology

KINDS = {
    "quad": "#cbd8e6",
    "tria": "#f2a72e",
    "failed quad": "#d9301f",
    "failed tria": "#7a0010",
}
"""Colours in falling lightness, so that they also differ for those who do not see red or green."""

_INK = "#1d2733"
_LOCKED = "#6b625a"
_LOCKED_SHARE = 0.42
_EDGE_SHARE = 0.62
_SHADE = 0.32
_DPI = 150
_SMALLEST = 2.0
"""Pixels; where elements are smaller than that, their edges would be all that one sees."""

_FLAT = 1e-4
"""Extent across a plane mesh, relative to its largest extent."""

_MARGIN = 0.02
_HEADER, _FOOTER = 0.75, 0.45
"""Inches above and below the meshes."""


@dataclass(frozen=True, eq=False)
class _View:
    """An orthographic camera: rows of `axes` are right, up and towards the viewer."""

    axes: Floats
    is_face_on: bool

    def project(self, points: Floats) -> Floats:
        """(N, 3) places: right, up and towards the viewer."""
        places: Floats = points @ self.axes.T
        return places


def draw(mesh: ShellMesh, assessment: Assessment, path: Path, *, title: str = "") -> None:
    """Draw a mesh to a PNG file, which is written whole.

    Trias and failed elements stand out in colour, locked elements are greyer; borders and feature
    edges are drawn stronger. A plane mesh is seen face on, any other obliquely from above.

    Raises
    ------
    InputError
        Where the mesh has no element or the file cannot be written.
    """
    _draw_panels([(title, mesh)], assessment, path, panel_width=9.0)


def draw_before_after(
    before: ShellMesh, after: ShellMesh, assessment: Assessment, path: Path
) -> None:
    """Draw two states of a mesh side by side, seen alike; see :func:`draw`."""
    _draw_panels([("before", before), ("after", after)], assessment, path, panel_width=6.5)


def _draw_panels(
    panels: list[tuple[str, ShellMesh]], assessment: Assessment, path: Path, *, panel_width: float
) -> None:
    from matplotlib.figure import Figure

    for _, mesh in panels:
        if not len(mesh.elements):
            raise InputError("the mesh has no element to draw: give one with quads or trias")
    view = _view_of(_used_points(panels[0][1]))
    window = _window([view.project(_used_points(mesh))[:, :2] for _, mesh in panels])
    width, height = window[1] - window[0]
    panel_height = panel_width * float(np.clip(height / width, 0.3, 1.1))
    total = panel_height + _HEADER + _FOOTER
    figure = Figure(figsize=(panel_width * len(panels), total), dpi=_DPI, facecolor="white")
    pixels = _DPI * min(panel_width / width, panel_height / height)

    kinds = [_kinds(mesh, assessment) for _, mesh in panels]
    for place, (title, mesh) in enumerate(panels):
        box = (place / len(panels), _FOOTER / total, 1 / len(panels), panel_height / total)
        axes = figure.add_axes(box)
        axes.set(xlim=window[:, 0], ylim=window[:, 1], aspect="equal")
        axes.set_axis_off()
        axes.add_collection(_collection(mesh, kinds[place], view, pixels))
        _write_header(figure, box, total, title, _summary(mesh, assessment))
    locked = sum(int(mesh.locked_elements.sum()) for _, mesh in panels)
    _write_legend(figure, np.concatenate(kinds), locked, with_counts=len(panels) == 1)
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))


def _kinds(mesh: ShellMesh, assessment: Assessment) -> Ints:
    """(M,) place of each element's kind in ``KINDS``."""
    failed = assessment.failing(mesh)
    return mesh.is_tria.astype(np.int32) + np.int32(2) * failed.astype(np.int32)


def _collection(mesh: ShellMesh, kinds: Ints, view: _View, pixels: float) -> Any:
    """Elements and strong edges as one collection, the farthest first (painter's algorithm).

    A strong edge is a polygon of no area that comes right after the nearest of its elements.
    """
    from matplotlib.collections import PolyCollection

    places = view.project(mesh.points)
    corners = mesh.elements.copy()
    corners[mesh.is_tria, 3] = corners[mesh.is_tria, 2]
    depth = places[corners, 2].mean(axis=1)
    if view.is_face_on:
        depth[:] = 0.0
    edges, edge_depth = _strong_edges(mesh, depth)
    items = np.concatenate([corners, edges[:, [0, 1, 1, 0]]])
    order = np.argsort(np.concatenate([depth, edge_depth]), kind="stable")

    lengths = np.linalg.norm(np.diff(places[corners[:, :3], :2], axis=1), axis=2)
    with_edges = float(np.median(lengths)) * pixels >= _SMALLEST
    faces = _face_colours(mesh, kinds, view)
    ink = np.array(_rgb(_INK))
    lines = _EDGE_SHARE * ink + (1.0 - _EDGE_SHARE) * faces if with_edges else faces
    thin = float(np.clip(0.02 * np.median(lengths) * pixels, 0.2, 0.5)) if with_edges else 0.0
    strong = np.broadcast_to(ink, (len(edges), 3))
    polygons: Any = places[items, :2][order]
    return PolyCollection(
        polygons,
        facecolors=np.concatenate([faces, strong])[order],
        edgecolors=np.concatenate([lines, strong])[order],
        linewidths=np.repeat([thin, 1.8 * thin + 0.25], [len(corners), len(edges)])[order],
        antialiaseds=with_edges,
        joinstyle="round",
        capstyle="round",
        snap=False,
    )


def _strong_edges(mesh: ShellMesh, depth: Floats) -> tuple[Ints, Floats]:
    """(S, 2) edges on borders, T-junctions, features and between regions; depth of the nearest."""
    unlocked = replace(mesh, locked_elements=np.zeros(len(mesh.elements), bool))
    found = topology(unlocked)
    nearest = np.full(len(found.edges), -np.inf)
    is_side = found.element_edges >= 0
    np.maximum.at(
        nearest,
        found.element_edges[is_side],
        np.broadcast_to(depth[:, None], is_side.shape)[is_side],
    )
    strong: Bools = ~found.crossable
    return found.edges[strong], nearest[strong]


def _face_colours(mesh: ShellMesh, kinds: Ints, view: _View) -> Floats:
    """(M, 3) colour by kind; greyer where locked; darker where turned from the light."""
    colours = np.array([_rgb(colour) for colour in KINDS.values()])[kinds]
    locked = mesh.locked_elements
    colours[locked] = _greyer(colours[locked])
    if view.is_face_on:
        return colours
    light = np.array([-0.3, 0.3, 0.906]) @ view.axes
    facing = np.abs(element_normals(mesh) @ light)
    return colours * (1.0 - _SHADE * (1.0 - facing))[:, None]


def _view_of(points: Floats) -> _View:
    """Face on where the points (N, 3) lie in a plane; else with the longest extents in view."""
    spread, directions = np.linalg.eigh(np.cov(points.T, bias=True))
    if spread[0] <= _FLAT**2 * spread[2]:
        return _View(_axes(directions[:, 0]), is_face_on=True)
    towards = np.empty(3)
    towards[np.argsort(-np.ptp(points, axis=0), kind="stable")] = 0.4, 0.55, 0.73
    return _View(_axes(towards * [1.0, -1.0, 1.0]), is_face_on=False)


def _axes(towards: Floats) -> Floats:
    """(3, 3) right, up and towards the viewer; z, or else y, is up and +x, or else +y, right."""
    towards = towards / np.linalg.norm(towards)
    vertical = np.array([0.0, 0.0, 1.0])
    if abs(towards[2]) > 0.99:
        vertical, towards = np.array([0.0, 1.0, 0.0]), towards * np.sign(towards[2])
    right = np.cross(vertical, towards)
    right /= np.linalg.norm(right)
    if right[np.argmax(np.abs(right).round(6))] < 0.0:
        right, towards = -right, -towards
    return np.stack([right, np.cross(towards, right), towards])


def _used_points(mesh: ShellMesh) -> Floats:
    used: Floats = mesh.points[np.unique(mesh.elements[mesh.elements != NO_NODE])]
    return used


def _window(places: list[Floats]) -> Floats:
    """(2, 2) lower left and upper right corner around all places, with a margin."""
    low = np.min([place.min(axis=0) for place in places], axis=0)
    high = np.max([place.max(axis=0) for place in places], axis=0)
    margin = _MARGIN * (float((high - low).max()) or 1.0)
    return np.stack([low - margin, high + margin])


def _summary(mesh: ShellMesh, assessment: Assessment) -> str:
    report = assessment.quality(mesh)
    return (
        f"{report.elements:,} elements   {report.trias:,} trias   {report.failed:,} failed   "
        f"compound Q.I. {report.compound_qi:,.2f}"
    )


def _write_header(
    figure: Any, box: tuple[float, float, float, float], total: float, title: str, summary: str
) -> None:
    middle = box[0] + 0.5 * box[2]
    lines = [(0.28, title, 13, "bold"), (0.55, summary, 10.5, "normal")]
    if not title:
        lines = [(0.42, summary, 11.5, "normal")]
    for inches, text, size, weight in lines:
        figure.text(
            middle,
            1 - inches / total,
            text,
            size=size,
            weight=weight,
            ha="center",
            va="center",
            color=_INK,
            parse_math=False,
        )


def _write_legend(figure: Any, kinds: Ints, locked: int, *, with_counts: bool) -> None:
    from matplotlib.patches import Patch

    counts = np.bincount(kinds, minlength=len(KINDS)).tolist()
    entries: list[tuple[Any, str, int]] = [
        (colour, kind, count)
        for (kind, colour), count in zip(KINDS.items(), counts, strict=True)
        if count
    ]
    if locked:
        entries.append((_greyer(np.array(_rgb(KINDS["quad"]))), "locked", locked))
    handles = [
        Patch(
            facecolor=colour,
            edgecolor=_INK,
            linewidth=0.4,
            label=f"{name}  {count:,}" if with_counts else name,
        )
        for colour, name, count in entries
    ]
    figure.legend(
        handles=handles,
        loc="lower center",
        ncols=len(handles),
        frameon=False,
        fontsize=10,
        labelcolor=_INK,
        handlelength=1.1,
        handleheight=1.1,
    )


def _greyer(colours: Floats) -> Floats:
    return (1.0 - _LOCKED_SHARE) * colours + _LOCKED_SHARE * np.array(_rgb(_LOCKED))


def _rgb(colour: str) -> tuple[float, ...]:
    return tuple(int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
