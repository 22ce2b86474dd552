"""Sound decks, criteria and settings as text, with something of all that readers look at."""

from __future__ import annotations

FOUR_ENTITIES = b"""\
$Entities
0 0 2 0
1 0 0 0 10 15 0 1 7 0
2 10 0 0 15 15 0 0 0
$EndEntities
"""

NASTRAN = {
    "cards.bdf": """\
$ cards of many kinds
CORD2R,5,,0.,0.,0.,0.,0.,1.
,1.,0.,0.
GRID,1,,0.,0.,0.
GRID,2,,5.,0.,0.
GRID           3       5     10.      0.      0.       0     345
GRID*                  4                              0.              5.*
*                     0.
GRID,5,,5.,5.,0.
GRID,6,,10.,5.,0.
CQUAD4         1       7       1       2       5       4     30.      .1+
+                             .1      .1      .1      .1
CQUAD4,2,7,2,3,6,5,,0.05
CTRIA3,3,8,4,5,1
CBAR,9,3,1,2,0.,0.,1.
PSHELL,7,1,.1
PSHELL,8,1,.2,1,,1
MAT1,1,7.+4,,.3
SPC1,1,123456,1,THRU,2
SPC,2,4,345,.0
FORCE,3,6,,1.5,0.,0.,1.
PLOAD4,4,1,.5,,,,THRU,2
PLOAD2,5,-1.,1,2
RBE2,20,1,123,2,4
SET1,30,1,THRU,6,BY,2
ASET1,3,1,2
MPC,6,1,1,1.,2,1,-1.
TEMP,7,1,20.
PARAM,GRDPNT,1
""",
    "case.bdf": """\
SOL 101
CEND
SET 1 = 1,2,THRU,3
SUBCASE 1
  DISP(PLOT) = 1
  LOAD = 3
SUBCASE 2
  SET 1 = ALL
  STRESS = 1
BEGIN BULK
GRID,1,,0.,0.,0.
=,*1,,*5.,==
=2
GRID,11,,0.,5.,0.
GRID,12,,5.,5.,0.
GRID,13,,10.,5.,0.
CQUAD4,1,1,1,2,12,11
CQUAD4,2,1,2,3,13,12
CTRIA6,4,1,1,2,3,11,12,13
SPOINT,100,THRU,105
ENDDATA
""",
}

ABAQUS = {
    "cards.inp": """\
*HEADING
 a plate
** a comment
*NODE, NSET=NALL
1, 0., 0., 0.
2, 5., 0., 0.
3, 10., 0., 0.
4, 0., 5., 0.
5, 5., 5., 0.
6, 10., 5., 0.
*ELEMENT, TYPE=S4R, ELSET="Skin A"
1, 1, 2, 5, 4
2, 2, 3, 6,
 5
*ELEMENT, TYPE=B31, ELSET=BEAMS
9, 1, 2
*NSET, NSET=FIX, GENERATE
1, 4, 3
*ELSET, ELSET=BOTH
Skin A, 2
*SURFACE, NAME=TOP, TYPE=ELEMENT
"Skin A", SPOS
1, S3
*SHELL SECTION, ELSET="Skin A", MATERIAL=STEEL
0.1, 5
*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*BOUNDARY
FIX, 1, 6
*INITIAL CONDITIONS, TYPE=TEMPERATURE
NALL, 20.
*STEP
*STATIC
*DLOAD
1, P, .5
*CLOAD
6, 3, 1.
*END STEP
""",
    "parts.inp": """\
*PART, NAME=A
*NODE
1, 0., 0., 0.
2, 5., 0., 0.
3, 5., 5., 0.
4, 0., 5., 0.
*ELEMENT, TYPE=S4
1, 1, 2, 3, 4
*END PART
*PART, NAME=B
*NODE
1, 0., 0., 1.
2, 5., 0., 1.
3, 5., 5., 1.
*ELEMENT, TYPE=S3
1, 1, 2, 3
*END PART
*ASSEMBLY, NAME=ALL
*INSTANCE, NAME=A-1, PART=A
*END INSTANCE
*INSTANCE, NAME=B-1, PART=B
1., 0., 0.
*END INSTANCE
*NSET, NSET=N, INSTANCE=A-1
1, 2
*END ASSEMBLY
""",
}

PLAIN = {
    "arrays.vtu": """\
<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid>
<Piece NumberOfPoints="6" NumberOfCells="3">
<PointData><DataArray type="Float64" Name="T" format="ascii">0 1 2 10 11 12</DataArray></PointData>
<CellData>
<DataArray type="Int32" Name="PartId" format="ascii">1 2 2</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="2" format="ascii">1 2 3 4 5 6</DataArray>
</CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 5 0 0 10 0 0 0 5 0 5 5 0 10 5 0
</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">0 1 4 3 1 2 5 4 0 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8 10</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9 9 3</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>
""",
    "groups.msh": """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 5 "clamp"
2 11 "skin left"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 5 0 0
3 10 0 0
4 0 5 0
5 5 5 0
6 10 5 0
$EndNodes
$Elements
5
1 15 2 7 1 1
2 1 2 5 4 1 4
3 3 2 11 1 1 2 5 4
4 2 2 22 3 2 3 6
5 2 2 22 3 2 6 5
$EndElements
$NodeData
1
"T"
1
0
3
0
1
6
1 0
2 1
3 2
4 10
5 11
6 12
$EndNodeData
$Periodic
1
0 1 4
1
1 4
$EndPeriodic
""",
    "groups.obj": """\
mtllib a.mtl
o plate
v 0 0 0
v 5 0 0
v 10 0 0
v 0 5 0
v 5 5 0
v 10 5 0
vt 0 0
usemtl steel
f 1/1 2/1 5/1 4/1
g rib
f -5 -4 -1 \\
  -2
l 1 4
""",
    "soup.obj": """\
v 0.000 0.000 0.000
v 5.000 0.000 0.000
v 5.000 5.000 0.000
v 0.000 0.000 0.000
v 5.000 5.000 0.000
v 0.000 5.000 0.000
f 1 2 3
f 4 5 6
""",
    "colours.off": """\
COFF
6 3 0
0 0 0 1 0 0 1
5 0 0 1 0 0 1
10 0 0 1 0 0 1
0 5 0 1 0 0 1
5 5 0 1 0 0 1
10 5 0 1 0 0 1
4 0 1 4 3 255 0 0
3 1 2 5
3 1 5 4 0 0 255
""",
    "words.off": "OFF # words\n4 2 0 0 0\n0 1 0 0 1 1 0 0 1\n0 3 0 1 2 3 0\n2 3\n",
}

OWN_CRITERIA = """\
name = "crash"
base = "standard"
normalised_size = false
penalties = { ideal = 0, good = 0, warn = 0.8, fail = 1, worst = 10 }

[criteria."min size"]
ideal = 5.0
good = 4.5
warn = 3.5
fail = 3.0
worst = 2.0
scaled = false

[criteria."% of trias"]
weight = 2.0
active = true
"""

HYPERMESH = """\
# a comment
1 min length 1 1.0 5.0 4.5 3.5 3.0 2.0
2 max length 1 1.0 5.0 5.5 8.0 10.0 12.0
3 aspect ratio 1 1.0 1.0 2.0 4.4 5.0 10.0
10 jacobian1 1.0 1.0 0.9 0.8 0.7 0.6
penalty value 0.0 0.0 0.8 1.0 10.0
QI color legend 1 2 3
"""

OWN_CONFIG = """\
profile = "thorough"
islands = 4
topology = "edges"
edges = [[0, 1], [1, 2], [2, 3], [3, 0]]
rings = [3, 4, 6]
largest = [60, 100, 160]
migrant-share = 0.1
mode = "overlapped"
seed = 7

[[island]]
population = 8
mutation = 0.3

[[island]]
selection = "tournament"
operations = ["anneal", "remesh", "smooth"]
irregularity = 1.0
"""
