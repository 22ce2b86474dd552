"""VTK's files keep their arrays, other cells and coding when their shells change."""

from pathlib import Path

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.mesh import NO_NODE
from tests.test_formats_splice import synthetic_edit

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "other"

MODES = [
    (mode, coded, compressor)
    for mode, coded in [("ascii", 1), ("binary", 1), ("appended", 1), ("appended", 0)]
    for compressor in ("", "zlib", "lzma")
]

ASCII = """\
<?xml version="1.0"?>
<!-- by hand -->
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <UnstructuredGrid>
    <FieldData>
      <DataArray type="Float64" Name="TIME" NumberOfTuples="1" format="ascii">2.5</DataArray>
    </FieldData>
    <Piece NumberOfPoints="9" NumberOfCells="6">
      <PointData Scalars="Temp">
        <DataArray type="Float64" Name="Temp" format="ascii">0 1 2 10 11 12 20 21 22</DataArray>
        <DataArray type="Int64" Name="GlobalNodeId" format="ascii">7 8 9 1 2 3 4 5 60</DataArray>
      </PointData>
      <CellData>
        <DataArray type="Int32" Name="PART ID" format="ascii">9 9 1 1 5 5</DataArray>
        <DataArray type="Float32" Name="Thickness" format="ascii">.1 .1 .2 .2 9 9</DataArray>
        <DataArray type="Int32" Name="layer" format="ascii">1 2 1 2 0 0</DataArray>
      </CellData>
      <Points>
        <DataArray type="Float32" NumberOfComponents="3" format="ascii">
          0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 2 0 1 2 0 2 2 0
        </DataArray>
      </Points>
      <Cells>
        <DataArray type="Int32" Name="connectivity" format="ascii">
          0 1 4 3  3 4 7 6  1 2 5 4  4 5 8 7  0 3  3 6
        </DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">4 8 12 16 18 20</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">9 9 9 9 3 3</DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
"""


def drawn(path, mode, coded, compressor):
    """Shells of two parts, a line, a hexahedron and a shell of second order, with arrays."""
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    core = pytest.importorskip("vtkmodules.vtkCommonCore")
    io = pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import numpy_to_vtk

    x, y = (a.ravel() for a in np.meshgrid(np.arange(7.0), np.arange(5.0)))
    flat = np.stack([x, y, 0 * x], axis=1)
    above = [(x, y, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    middle = [(6.5, 0, 0), (7, 0.5, 0), (6.5, 1, 0), (6, 0.5, 0), (7, 0, 0), (7, 1, 0)]
    points = np.concatenate([flat, above, middle])
    quads = [[a, a + 1, a + 8, a + 7] for b in range(4) for a in range(7 * b, 7 * b + 6)]
    cells = [(9, q) for q in quads[:-1]]
    cells += [(5, quads[-1][:3]), (5, [quads[-1][i] for i in (0, 2, 3)]), (3, [0, 7])]
    cells += [(12, [*quads[0], 35, 36, 37, 38]), (23, [6, 43, 44, 13, 39, 40, 41, 42])]
    grid = vtk.vtkUnstructuredGrid()
    place = core.vtkPoints()
    place.SetData(numpy_to_vtk(points, deep=True))
    grid.SetPoints(place)
    for kind, nodes in cells:
        grid.InsertNextCell(kind, len(nodes), nodes)
    part = np.array([1 + (points[nodes].mean(axis=0)[0] > 3) for _, nodes in cells], np.int32)
    values = {"PartId": part, "t": part * 0.1, "v": np.outer(part, [1.0, 2.0, 3.0])}
    for name, array in values.items():
        found = numpy_to_vtk(array, deep=True)
        found.SetName(name)
        grid.GetCellData().AddArray(found)
    for name, array in {"T": points[:, 0] + 10 * points[:, 1], "u": points * 2}.items():
        found = numpy_to_vtk(array, deep=True)
        found.SetName(name)
        grid.GetPointData().AddArray(found)
    writer = io.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    {
        "ascii": writer.SetDataModeToAscii,
        "binary": writer.SetDataModeToBinary,
        "appended": writer.SetDataModeToAppended,
    }[mode]()
    writer.SetEncodeAppendedData(coded)
    {
        "": writer.SetCompressorTypeToNone,
        "zlib": writer.SetCompressorTypeToZLib,
        "lzma": writer.SetCompressorTypeToLZMA,
    }[compressor]()
    writer.Write()


def loaded(path):
    """What VTK reads: points, cells as (type, places), arrays of points and cells."""
    io = pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = io.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData())
    cells = []
    for row in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(row)
        nodes = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        cells.append((grid.GetCellType(row), tuple(map(tuple, points[nodes].round(6).tolist()))))
    arrays = [
        {
            data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
            for k in range(data.GetNumberOfArrays())
        }
        for data in (grid.GetPointData(), grid.GetCellData())
    ]
    return points, cells, *arrays


@pytest.mark.parametrize(("mode", "coded", "compressor"), MODES)
def test_what_vtk_writes_is_read_edited_and_read_by_vtk_again(tmp_path, mode, coded, compressor):
    source, out = tmp_path / "part.vtu", tmp_path / "out.vtu"
    drawn(source, mode, coded, compressor)
    deck = read_deck(source)
    assert sorted(set(deck.mesh.region.tolist())) == [1, 2]
    assert len(deck.mesh.elements) == 25
    deck.write(deck.mesh, out)
    assert out.read_bytes() == source.read_bytes()
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, out)
    head = slice(source.read_bytes().find(b"<VTKFile"), source.read_bytes().find(b"<Piece"))
    assert out.read_bytes()[head] == source.read_bytes()[head]
    _, before, _, _ = loaded(source)
    points, cells, at_points, at_cells = loaded(out)
    kept = [cell for cell in before if cell[0] not in (5, 9)]
    assert [cell for cell in cells if cell[0] not in (5, 9)] == kept
    shells = [
        tuple(map(tuple, edited.points[e[e >= 0]].round(6).tolist())) for e in edited.elements
    ]
    assert sorted(c[1] for c in cells if c[0] in (5, 9)) == sorted(shells)
    np.testing.assert_allclose(at_points["T"], points[:, 0] + 10 * points[:, 1], atol=1e-9)
    # the moved node has left the plane, where there was no field
    np.testing.assert_allclose(at_points["u"][:, :2], 2 * points[:, :2], atol=1e-9)
    np.testing.assert_array_equal(at_cells["t"], at_cells["PartId"] * 0.1)
    np.testing.assert_array_equal(at_cells["v"], np.outer(at_cells["PartId"], [1.0, 2.0, 3.0]))
    region = {tuple(sorted(s)): r for s, r in zip(shells, edited.region.tolist(), strict=True)}
    found = {tuple(sorted(c[1])): p for c, p in zip(cells, at_cells["PartId"], strict=True)}
    assert {key: found[key] for key in region} == region
    assert read_deck(out).mesh.locked_nodes.sum() == deck.mesh.locked_nodes.sum()


def test_what_other_cells_name_is_locked(tmp_path):
    drawn(tmp_path / "part.vtu", "ascii", 1, "")
    deck = read_deck(tmp_path / "part.vtu")
    locked = deck.mesh.node_ids[deck.mesh.locked_nodes] - 1
    assert locked.tolist() == [0, 1, 6, 7, 8, 13]
    assert deck.mesh.element_ids[deck.mesh.locked_elements].tolist() == [1]
    assert [(lock.count, lock.cards) for lock in deck.locks] == [
        (1, "faces of solids"),
        (4, "solids"),
        (2, "lines"),
        (2, "surface cells of more nodes"),
    ]


@pytest.fixture
def file(tmp_path):
    (tmp_path / "m.vtu").write_text(ASCII)
    return tmp_path / "m.vtu"


def test_arrays_named_like_a_part_tell_the_regions(file):
    deck = read_deck(file)
    assert deck.mesh.region.tolist() == [9, 9, 1, 1]
    assert deck.notes == ("The cell array 'PART ID' tells the regions.",)
    assert read_deck(file, regions="layer").mesh.region.tolist() == [1, 2, 1, 2]
    with pytest.raises(InputError, match=r"no cell array 'lay'.*'PART ID', 'Thickness', 'layer'"):
        read_deck(file, regions="lay")
    with pytest.raises(InputError, match="does not hold one integer"):
        read_deck(file, regions="Thickness")


def test_an_array_that_numbers_the_cells_is_no_part(tmp_path):
    drawn(tmp_path / "m.vtu", "ascii", 1, "")
    text = (tmp_path / "m.vtu").read_text()
    first = text.index('Name="PartId"')
    start, stop = text.index(">", first) + 1, text.index("</DataArray>", first)
    numbers = " ".join(map(str, range(len(text[start:stop].split()))))
    (tmp_path / "m.vtu").write_text(text[:start] + numbers + text[stop:])
    assert set(read_deck(tmp_path / "m.vtu").mesh.region.tolist()) == {0}


def test_numberings_go_on_and_what_does_not_change_keeps_its_text(file, tmp_path):
    deck = read_deck(file)
    mesh = deck.mesh
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [1, 4, 7]
    a, b, c, d = mesh.elements[2]
    new = len(mesh.points)
    edit = Edit(
        removed=np.array([2]),
        added_points=np.array([[1.5, 0.25, 0.0]]),
        added_elements=np.array([[a, b, new, NO_NODE], [b, c, new, NO_NODE], [c, d, a, new]]),
        added_region=np.full(3, 1),
        moved=np.array([8]),
        moved_to=np.array([[2.0, 1.5, 0.0]]),
    )
    deck.write(apply(mesh, edit), tmp_path / "out.vtu")
    text = (tmp_path / "out.vtu").read_text()
    assert text.startswith(ASCII[: ASCII.index("<Piece")])
    assert '<Piece NumberOfPoints="10" NumberOfCells="8">' in text
    again = read_deck(tmp_path / "out.vtu")

    def values(name):
        at = text.index(f'Name="{name}"')
        return text[text.index(">", at) + 1 : text.index("<", at)].split()

    assert [float(v) for v in values("Temp")] == pytest.approx(
        [0, 1, 2, 10, 11, 12, 20, 21, 17, 1.5 + 2.5]
    )
    assert values("GlobalNodeId") == ["7", "8", "9", "1", "2", "3", "4", "5", "60", "61"]
    assert values("PART ID") == ["9", "9", "1", "5", "5", "1", "1", "1"]
    assert values("Thickness") == ["0.1", "0.1", "0.2", "9.0", "9.0", "0.2", "0.2", "0.2"]
    assert values("types") == ["9", "9", "9", "3", "3", "5", "5", "9"]
    assert sorted(again.mesh.region.tolist()) == [1, 1, 1, 1, 9, 9]


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
def test_the_file_with_part_ids(tmp_path):
    deck = read_deck(FAULTS / "f14_part_ids.vtu")
    assert set(deck.mesh.region.tolist()) == {11, 22}
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, tmp_path / "out.vtu")
    points, cells, at_points, at_cells = loaded(tmp_path / "out.vtu")
    assert len(points) == len(edited.points)
    assert len(cells) == len(edited.elements)
    assert set(at_points) == {"Temp"}
    assert set(at_cells) == {"PartId", "Thickness"}
    by_part = {
        (int(p), float(t)) for p, t in zip(at_cells["PartId"], at_cells["Thickness"], strict=True)
    }
    before = loaded(FAULTS / "f14_part_ids.vtu")[3]
    assert by_part == {
        (int(p), float(t)) for p, t in zip(before["PartId"], before["Thickness"], strict=True)
    }


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("</VTKFile>", "", "cannot be read as vtu"),
        ('UnstructuredGrid" version', 'PolyData" version', "save it as an unstructured grid"),
        ("0 1 4 3 ", "0 1 4 33 ", "names a node that is not there"),
        ("4 8 12 16 18 20", "4 8 12 16 18 200", "do not fit their points"),
        ("4 8 12 16 18 20", "4 8 x 16 18 20", "'offsets' cannot be read"),
        ("9 9 1 1 5 5", "9 9 1 1 5", "'PART ID' has 5 values for 6 cells"),
        ('"Float32" Number', '"Float12" Number', "'Float12' is not known"),
        ('byte_order="', 'compressor="vtkLZ4DataCompressor" byte_order="', "save it with zlib"),
        ("0 0 0 1 0 0", "0 nan 0 1 0 0", "not a finite number"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, old, new, words):
    assert old in ASCII
    (tmp_path / "m.vtu").write_text(ASCII.replace(old, new, 1))
    with pytest.raises(InputError, match=words):
        read_deck(tmp_path / "m.vtu")
