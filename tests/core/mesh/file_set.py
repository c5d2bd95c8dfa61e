# SPDX-License-Identifier: GPL-3.0-or-later
"""A set of small mesh files in every format that is read, and the report wanted of each.

    file_set.py FOLDER                writes the files
    file_set.py --check PROGRAM FOLDER   writes them and compares PROGRAM's reports (mesh_report.c)

Most hold one box of 40 x 30 x 20 mm: as a hexahedron, six tetrahedra, or its surface.
"""
import base64
import os
import struct
import subprocess
import sys
import zlib

BOX = [(0, 0, 0), (.04, 0, 0), (.04, .03, 0), (0, .03, 0), (0, 0, .02), (.04, 0, .02), (.04, .03, .02), (0, .03, .02)]
HEXAHEDRON = (0, 1, 2, 3, 4, 5, 6, 7)
TETRAHEDRA = [(0, 1, 2, 6), (0, 5, 1, 6), (0, 4, 5, 6), (0, 7, 4, 6), (0, 3, 7, 6), (0, 2, 3, 6)]
QUADRANGLES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TRIANGLES = [t for q in QUADRANGLES for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
WEDGES = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)]
MIDDLE = (.02, .015, .01)
PYRAMIDS = [(*reversed(q), 8) for q in QUADRANGLES]

SIZE = "size: 0.04 x 0.03 x 0.02 m, unit_m 1 (metres)"
SOLID = "mesh: 8 vertices, 6 tetrahedra, 1 component"
CLOSED = "mesh: 8 vertices, 12 triangles, 1 component, closed surface"

CASES = []


def case(name, data, *lines, arguments=(), files=None):
    """A file, and the lines of its report in order but for the last, or one that begins with
    `refused: `, which is a part of the refusal. `files` are others that lie beside it."""
    data = data.encode() if isinstance(data, str) else data
    CASES.append((name, data, lines, arguments, files or {}))


def tetrahedra(format_name, *, read="read: 6 tetrahedra", passed=None, mended=None, regions="regions: 0 (6 tetrahedra)", vertices=8):
    lines = [f"format: {format_name}, {vertices} vertices", read, passed, mended, SOLID, SIZE, regions]
    return [line for line in lines if line]


def surface(format_name, *, read="read: 12 triangles", passed=None, mended=None, regions="regions: 0 (12 triangles)", vertices=8, mesh=CLOSED):
    lines = [f"format: {format_name}, {vertices} vertices", read, passed, mended, mesh, SIZE, regions]
    return [line for line in lines if line]


def numbers(values):
    return " ".join(repr(v) if isinstance(v, float) else str(v) for v in values)


def ascending(rows):
    return "".join(numbers(row) + "\n" for row in rows)


# ---- Gmsh ------------------------------------------------------------------------------------------
GMSH = {2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 15: 1, 1: 2, 9: 6, 11: 10}


def gmsh_2(points, elements, names=(), version="2.2"):
    """elements: (type, group, corners from 0)"""
    text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n"
    if names:
        text += f"$PhysicalNames\n{len(names)}\n" + "".join(f'{d} {n} "{name}"\n' for d, n, name in names) + "$EndPhysicalNames\n"
    text += f"$Nodes\n{len(points)}\n" + "".join(f"{i + 1} {numbers(p)}\n" for i, p in enumerate(points)) + "$EndNodes\n"
    text += f"$Elements\n{len(elements)}\n"
    for i, (kind, group, corners) in enumerate(elements):
        text += f"{i + 1} {kind} 2 {group} 1 {numbers(c + 1 for c in corners)}\n"
    return text + "$EndElements\n"


def gmsh_2_binary(points, elements, order="<"):
    data = b"$MeshFormat\n2.2 1 8\n" + struct.pack(order + "i", 1) + b"\n$EndMeshFormat\n$Nodes\n%d\n" % len(points)
    data += b"".join(struct.pack(order + "i3d", i + 1, *p) for i, p in enumerate(points)) + b"\n$EndNodes\n$Elements\n%d\n" % len(elements)
    for i, (kind, group, corners) in enumerate(elements):
        data += struct.pack(order + "iii", kind, 1, 2) + struct.pack(order + f"{3 + len(corners)}i", i + 1, group, 1, *(c + 1 for c in corners))
    return data + b"\n$EndElements\n"


def gmsh_4(points, elements, entities, names=(), partitioned="", version="4.1"):
    """elements: (dimension, entity, type, [corners]); entities: text of the section"""
    text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n"
    if names:
        text += f"$PhysicalNames\n{len(names)}\n" + "".join(f'{d} {n} "{name}"\n' for d, n, name in names) + "$EndPhysicalNames\n"
    text += f"$Entities\n{entities}$EndEntities\n"
    if partitioned:
        text += f"$PartitionedEntities\n{partitioned}$EndPartitionedEntities\n"
    count = sum(len(e[3]) for e in elements)
    if version == "4.1":
        text += f"$Nodes\n1 {len(points)} 1 {len(points)}\n3 1 0 {len(points)}\n"
        text += "".join(f"{i + 1}\n" for i in range(len(points))) + ascending(points)
        text += f"$EndNodes\n$Elements\n{len(elements)} {count} 1 {count}\n"
    else:
        text += f"$Nodes\n1 {len(points)}\n1 3 0 {len(points)}\n"
        text += "".join(f"{i + 1} {numbers(p)}\n" for i, p in enumerate(points))
        text += f"$EndNodes\n$Elements\n{len(elements)} {count}\n"
    number = 0
    for dimension, entity, kind, rows in elements:
        first, second = (dimension, entity) if version == "4.1" else (entity, dimension)
        text += f"{first} {second} {kind} {len(rows)}\n"
        for corners in rows:
            number += 1
            text += f"{number} {numbers(c + 1 for c in corners)}\n"
    return text + "$EndElements\n"


def gmsh_4_binary(order="<", version=4.1):
    size, pack = ("Q", struct.pack)
    data = f"$MeshFormat\n{version} 1 8\n".encode() + pack(order + "i", 1) + b"\n$EndMeshFormat\n$Entities\n"
    data += pack(order + "4Q", 0, 0, 0, 1) + pack(order + "i6d", 1, 0, 0, 0, .04, .03, .02) + pack(order + "Qi", 1, 7) + pack(order + size, 0)
    data += b"\n$EndEntities\n$Nodes\n"
    if version == 4.1:
        data += pack(order + "4Q", 1, 8, 1, 8) + pack(order + "3iQ", 3, 1, 0, 8) + pack(order + "8Q", *range(1, 9))
        data += b"".join(pack(order + "3d", *p) for p in BOX) + b"\n$EndNodes\n$Elements\n"
        data += pack(order + "4Q", 1, 6, 1, 6) + pack(order + "3iQ", 3, 1, 4, 6)
        data += b"".join(pack(order + "5Q", i + 1, *(c + 1 for c in t)) for i, t in enumerate(TETRAHEDRA))
    else:
        data += pack(order + "2Q", 1, 8) + pack(order + "3iQ", 1, 3, 0, 8)
        data += b"".join(pack(order + "i3d", i + 1, *p) for i, p in enumerate(BOX)) + b"\n$EndNodes\n$Elements\n"
        data += pack(order + "2Q", 1, 6) + pack(order + "3iQ", 1, 3, 4, 6)
        data += b"".join(pack(order + "5i", i + 1, *(c + 1 for c in t)) for i, t in enumerate(TETRAHEDRA))
    return data + b"\n$EndElements\n"


def all_gmsh():
    tets = [(4, 7, t) for t in TETRAHEDRA]
    named = "regions: 7 \"liver\" (6 tetrahedra)"
    case("gmsh22.msh", gmsh_2(BOX, tets, [(3, 7, "liver")]), *tetrahedra("Gmsh 2.2", regions=named))
    case("gmsh22-no-ending", gmsh_2(BOX, tets, [(3, 7, "liver")]), *tetrahedra("Gmsh 2.2", regions=named))
    case("gmsh22-crlf.MSH", gmsh_2(BOX, tets, [(3, 7, "left lobe")]).replace("\n", "\r\n"),
         *tetrahedra("Gmsh 2.2", regions="regions: 7 \"left lobe\" (6 tetrahedra)"))
    case("gmsh22-mark.msh", b"\xef\xbb\xbf" + gmsh_2(BOX, tets).encode(), *tetrahedra("Gmsh 2.2", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh22-binary.msh", gmsh_2_binary(BOX, tets), *tetrahedra("Gmsh 2.2 binary", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh22-big-endian.msh", gmsh_2_binary(BOX, tets, ">"), *tetrahedra("Gmsh 2.2 binary", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh22-other-elements.msh", gmsh_2(BOX, [(15, 0, (0,)), (1, 0, (0, 1)), *tets]),
         *tetrahedra("Gmsh 2.2", passed="passed over: 1 points, 1 lines", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh22-surface-and-solid.msh", gmsh_2(BOX, [*((2, 7, t) for t in TRIANGLES), *tets], [(2, 7, "skin"), (3, 7, "liver")]),
         "format: Gmsh 2.2, 8 vertices", "read: 12 triangles, 6 tetrahedra",
         "mesh: 8 vertices, 6 tetrahedra, 12 triangles, 1 component", SIZE,
         "regions: 7 \"skin\" (12 triangles), 7 \"liver\" (6 tetrahedra)")
    case("hexahedron.msh", gmsh_2(BOX, [(5, 1, HEXAHEDRON)]),
         *tetrahedra("Gmsh 2.2", read="read: 1 hexahedra", mended="mended: 1 hexahedra split into tetrahedra", regions="regions: 1 (6 tetrahedra)"))
    case("hexahedron-inverted.msh", gmsh_2(BOX, [(5, 1, (4, 5, 6, 7, 0, 1, 2, 3))]),
         *tetrahedra("Gmsh 2.2", read="read: 1 hexahedra", mended="mended: 1 inverted elements turned, 1 hexahedra split into tetrahedra",
                     regions="regions: 1 (6 tetrahedra)"))
    case("wedges.msh", gmsh_2(BOX, [(6, 1, w) for w in WEDGES]),
         *tetrahedra("Gmsh 2.2", read="read: 2 wedges", mended="mended: 2 wedges split into tetrahedra", regions="regions: 1 (6 tetrahedra)"))
    case("pyramids.msh", gmsh_2([*BOX, MIDDLE], [(7, 1, p) for p in PYRAMIDS]),
         "format: Gmsh 2.2, 9 vertices", "read: 6 pyramids", "mended: 6 pyramids split into tetrahedra",
         "mesh: 9 vertices, 12 tetrahedra, 1 component", SIZE, "regions: 1 (12 tetrahedra)")
    # Two hexahedra side by side that share a quadrangle, numbered so that it begins elsewhere in each.
    pair = [*BOX, (.08, 0, 0), (.08, .03, 0), (.08, 0, .02), (.08, .03, .02)]
    case("hexahedra-beside.msh", gmsh_2(pair, [(5, 1, HEXAHEDRON), (5, 2, (6, 11, 10, 5, 2, 9, 8, 1))]),
         "format: Gmsh 2.2, 12 vertices", "read: 2 hexahedra", "mended: 2 hexahedra split into tetrahedra",
         "mesh: 12 vertices, 12 tetrahedra, 1 component", "size: 0.08 x 0.03 x 0.02 m, unit_m 1 (metres)",
         "regions: 1 (6 tetrahedra), 2 (6 tetrahedra)")
    case("quadrangles.msh", gmsh_2(BOX, [(3, 2, q) for q in QUADRANGLES], [(2, 2, "capsule")]),
         *surface("Gmsh 2.2", read="read: 6 quadrangles", mended="mended: 6 quadrangles and polygons split into triangles",
                  regions="regions: 2 \"capsule\" (12 triangles)"))
    ten = [*BOX[:3], BOX[6], *(tuple((a + b) / 2 for a, b in zip(BOX[i], BOX[j])) for i, j in ((0, 1), (1, 2), (0, 2), (0, 6), (2, 6), (1, 6)))]
    case("second-order.msh", gmsh_2(ten, [(11, 1, range(10))]),
         "format: Gmsh 2.2, 10 vertices", "read: 1 10-node tetrahedra",
         "mended: 1 higher-order elements reduced to their corners, 6 unused vertices left out",
         "mesh: 4 vertices, 1 tetrahedra, 1 component", SIZE, "regions: 1 (1 tetrahedra)")
    box = "0 0 0 0.04 0.03 0.02"
    case("gmsh41.msh", gmsh_4(BOX, [(3, 1, 4, TETRAHEDRA)], f"0 0 0 1\n1 {box} 1 7 0\n", [(3, 7, "liver")]), *tetrahedra("Gmsh 4.1", regions=named))
    case("gmsh41-partitioned.msh",
         gmsh_4(BOX, [(3, 2, 4, TETRAHEDRA[:3]), (3, 3, 4, TETRAHEDRA[3:])], f"0 0 0 1\n1 {box} 1 7 0\n", [(3, 7, "liver")],
                f"2 0\n0 0 0 2\n2 3 1 1 1 {box} 1 7 0\n3 3 1 1 2 {box} 0 0\n"), *tetrahedra("Gmsh 4.1", regions=named))
    case("gmsh40.msh", gmsh_4(BOX, [(3, 1, 4, TETRAHEDRA)], f"1 0 0 1\n9 0 0 0 0 0 0 0\n1 {box} 1 7 0\n", [(3, 7, "liver")], version="4"),
         *tetrahedra("Gmsh 4.0", regions=named))
    case("gmsh41-binary.msh", gmsh_4_binary(), *tetrahedra("Gmsh 4.1 binary", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh41-big-endian.msh", gmsh_4_binary(">"), *tetrahedra("Gmsh 4.1 binary", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh40-binary.msh", gmsh_4_binary(version=4.0), *tetrahedra("Gmsh 4.0 binary", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh1.msh", "$NOD\n8\n" + "".join(f"{i + 1} {numbers(p)}\n" for i, p in enumerate(BOX)) + "$ENDNOD\n$ELM\n6\n" +
         "".join(f"{i + 1} 4 7 1 4 {numbers(c + 1 for c in t)}\n" for i, t in enumerate(TETRAHEDRA)) + "$ENDELM\n",
         *tetrahedra("Gmsh 1", regions="regions: 7 (6 tetrahedra)"))
    case("gmsh-missing-node.msh", gmsh_2(BOX[:7], tets), "refused: line")
    case("gmsh-cut-short.msh", gmsh_2(BOX, tets)[:-60], "refused: line")
    case("gmsh-lines-only.msh", gmsh_2(BOX, [(1, 0, (0, 1))]), "refused: line 18: no surface and no volume elements in this file, but 8 vertices, 1 lines")


# ---- mending ---------------------------------------------------------------------------------------
def all_mending():
    tets = [(4, 0, t) for t in TETRAHEDRA]
    loose = [(x + 1e-9 * k, y - 2e-9 * k, z + 2e-9 * k) for k, t in enumerate(TETRAHEDRA) for x, y, z in (BOX[v] for v in t)]
    case("duplicates.msh", gmsh_2(loose, [(4, 0, range(4 * i, 4 * i + 4)) for i in range(6)]),
         *tetrahedra("Gmsh 2.2", vertices=24, mended="mended: 16 duplicate vertices merged"))
    case("inverted.msh", gmsh_2(BOX, [(4, 0, (t[1], t[0], *t[2:])) if i < 2 else (4, 0, t) for i, t in enumerate(TETRAHEDRA)]),
         *tetrahedra("Gmsh 2.2", mended="mended: 2 inverted elements turned"))
    case("degenerate-tetrahedra.msh", gmsh_2(BOX, [*tets, (4, 0, (0, 1, 2, 3)), (4, 0, (0, 1, 2, 2))]),
         *tetrahedra("Gmsh 2.2", read="read: 8 tetrahedra", mended="mended: 2 degenerate tetrahedra left out"))
    case("repeated.msh", gmsh_2(BOX, [*tets, tets[0], (4, 0, (TETRAHEDRA[1][2], *TETRAHEDRA[1][:2], TETRAHEDRA[1][3]))]),
         *tetrahedra("Gmsh 2.2", read="read: 8 tetrahedra", mended="mended: 2 repeated elements left out"))
    third = (*sorted(set(TETRAHEDRA[0]) & set(TETRAHEDRA[1]), reverse=True), next(iter(set(range(8)) - set(TETRAHEDRA[0]) - set(TETRAHEDRA[1]))))
    case("third-at-a-face.msh", gmsh_2(BOX, [*tets, (4, 0, third)]),
         *tetrahedra("Gmsh 2.2", read="read: 7 tetrahedra", mended="mended: 1 tetrahedra left out that were the third at a face"))
    case("unused.msh", gmsh_2([*BOX, (9, 9, 9)], tets), *tetrahedra("Gmsh 2.2", vertices=9, mended="mended: 1 unused vertices left out"))
    case("all-degenerate.msh", gmsh_2(BOX, [(4, 0, (0, 1, 2, 3))]), "refused: every element is degenerate: 0 flat triangles, 1 flat tetrahedra")
    far = [(x + .1, y, z) for x, y, z in BOX]
    case("two-components.msh", gmsh_2(BOX + far, [*tets, *((4, 3, tuple(v + 8 for v in t)) for t in TETRAHEDRA)]),
         "format: Gmsh 2.2, 16 vertices", "read: 12 tetrahedra", "mesh: 16 vertices, 12 tetrahedra, 2 components",
         "size: 0.14 x 0.03 x 0.02 m, unit_m 1 (metres)", "regions: 0 (6 tetrahedra), 3 (6 tetrahedra)")
    strict = ("--strict",)
    case("strict-clean.msh", gmsh_2(BOX, [(15, 0, (0,)), *tets]), *tetrahedra("Gmsh 2.2", passed="passed over: 1 points"), arguments=strict)
    case("strict-duplicates.msh", gmsh_2(loose, [(4, 0, range(4 * i, 4 * i + 4)) for i in range(6)]),
         "refused: strict: strict refuses to repair this mesh: 16 duplicate vertices merged", arguments=strict)
    case("strict-hexahedron.msh", gmsh_2(BOX, [(5, 1, HEXAHEDRON)]),
         "refused: strict: strict refuses to repair this mesh: 1 hexahedra split into tetrahedra", arguments=strict)
    case("strict-degenerate.msh", gmsh_2(BOX, [*tets, (4, 0, (0, 1, 2, 3))]),
         "refused: strict: strict refuses to repair this mesh: 1 degenerate tetrahedra left out", arguments=strict)


# ---- units -----------------------------------------------------------------------------------------
def all_units():
    def scaled(factor):
        return gmsh_2([tuple(factor * c for c in p) for p in BOX], [(4, 0, t) for t in TETRAHEDRA])
    case("millimetres.msh", scaled(4000), "refused: unit_m: this mesh is 160 m long, which is not a plausible size of tissue: did you mean millimetres (unit_m 0.001)?")
    case("centimetres.msh", scaled(400), "refused: unit_m: this mesh is 16 m long, which is not a plausible size of tissue: did you mean centimetres (unit_m 0.01)?")
    case("micrometres.msh", scaled(2.5e6), "refused: unit_m: this mesh is 1e+05 m long, which is not a plausible size of tissue: did you mean micrometres (unit_m 1e-06)?")
    case("too-small.msh", scaled(1e-3), "refused: unit_m: this mesh is 4e-05 m long, which is not a plausible size of tissue: did you mean kilometres (unit_m 1000)?")
    case("millimetres-said.msh", scaled(1000),
         *tetrahedra("Gmsh 2.2")[:-2], "size: 0.04 x 0.03 x 0.02 m, unit_m 0.001 (millimetres)", "regions: 0 (6 tetrahedra)",
         arguments=("--unit-m", "0.001"))


# ---- OBJ -------------------------------------------------------------------------------------------
def obj(faces, points=BOX):
    return "".join(f"v {numbers(p)}\n" for p in points) + "".join(f"f {numbers(c + 1 for c in f)}\n" for f in faces)


def all_obj():
    case("box.obj", "# a box\n" + obj(TRIANGLES), *surface("OBJ"))
    case("BOX.OBJ", obj(TRIANGLES), *surface("OBJ"))
    case("mark.obj", b"\xef\xbb\xbf" + obj(TRIANGLES).encode(), *surface("OBJ"))
    case("old-mac.obj", obj(TRIANGLES).replace("\n", "\r"), *surface("OBJ"))
    case("crlf.obj", obj(TRIANGLES).replace("\n", "\r\n"), *surface("OBJ"))
    case("quadrangles.obj", obj(QUADRANGLES),
         *surface("OBJ", read="read: 6 quadrangles", mended="mended: 6 quadrangles and polygons split into triangles"))
    case("degenerate-face.obj", obj([*TRIANGLES, (0, 1, 1), (0, 1, 0, 1)]),
         *surface("OBJ", read="read: 13 triangles, 1 quadrangles",
                  mended="mended: 3 degenerate triangles left out, 1 quadrangles and polygons split into triangles"))
    case("materials.obj", "".join(f"v {numbers(p)}\n" for p in BOX) + "usemtl capsule\n" +
         "".join(f"f {numbers(c + 1 for c in f)}\n" for f in TRIANGLES[:4]) + "usemtl vessel wall\n" +
         "".join(f"f {numbers(c + 1 for c in f)}\n" for f in TRIANGLES[4:]),
         *surface("OBJ", regions="regions: 1 \"capsule\" (4 triangles), 2 \"vessel wall\" (8 triangles)"))
    square = "v 0 0 0\nv .04 0 0\nv .04 .03 0\nv 0 .03 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\n"
    case("degenerate-texture.obj", square + "f 1/1 3/1 4/1\n",
         "format: OBJ, 4 vertices", "read: 2 triangles", "mended: 1 degenerate texture triangles left out",
         "mesh: 4 vertices, 2 triangles, 1 component, open surface with 4 edges on its rim",
         "size: 0.04 x 0.03 x 0 m, unit_m 1 (metres)", "regions: 0 (2 triangles)")
    case("half-textured.obj", square + "f 1 3 4\n",
         "format: OBJ, 4 vertices", "read: 2 triangles", "passed over: 4 texture points (some corners have none)",
         "mesh: 4 vertices, 2 triangles, 1 component, open surface with 4 edges on its rim",
         "size: 0.04 x 0.03 x 0 m, unit_m 1 (metres)", "regions: 0 (2 triangles)")
    arrow = [(0, 0, 0), (.04, .015, 0), (0, .03, 0), (.01, .015, 0)]
    case("concave.obj", obj([(0, 1, 2, 3)], arrow),
         "format: OBJ, 4 vertices", "read: 1 quadrangles", "mended: 1 quadrangles and polygons split into triangles",
         "mesh: 4 vertices, 2 triangles, 1 component, open surface with 4 edges on its rim",
         "size: 0.04 x 0.03 x 0 m, unit_m 1 (metres)", "regions: 0 (2 triangles)")
    case("other-lines.obj", obj(TRIANGLES) + "l 1 2\np 1\nf 1 2\n",
         *surface("OBJ", passed="passed over: 1 lines, 1 points, 1 faces of fewer than 3 corners"))
    case("missing-vertex.obj", obj([*TRIANGLES, (0, 1, 8)]), "refused: line 21: 9 as a vertex number: the file has only 8 so far")


# ---- STL -------------------------------------------------------------------------------------------
def stl(triangles, name=""):
    text = f"solid {name}\n"
    for t in triangles:
        text += "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {numbers(BOX[v])}\n" for v in t) + "endloop\nendfacet\n"
    return text + f"endsolid {name}\n"


def stl_binary(title=b""):
    data = title.ljust(80, b"\0") + struct.pack("<I", 12)
    return data + b"".join(struct.pack("<12fH", 0, 0, 0, *(c for v in t for c in BOX[v]), 0) for t in TRIANGLES)


def all_stl():
    merged = "mended: 28 duplicate vertices merged"
    case("box.stl", stl(TRIANGLES, "liver"), *surface("STL", vertices=36, mended=merged, regions="regions: 1 \"liver\" (12 triangles)"))
    case("two-solids.STL", stl(TRIANGLES[:4], "a") + stl(TRIANGLES[4:], "b"),
         *surface("STL", vertices=36, mended=merged, regions="regions: 1 \"a\" (4 triangles), 2 \"b\" (8 triangles)"))
    case("binary.stl", stl_binary(), *surface("STL binary", vertices=36, mended=merged))
    case("binary-that-says-solid.stl", stl_binary(b"solid of a scanner"), *surface("STL binary", vertices=36, mended=merged))
    case("binary-and-more.stl", stl_binary() + b"abc",
         *surface("STL binary", vertices=36, passed="passed over: 3 bytes after the last facet", mended=merged))
    case("cut-short.stl", stl(TRIANGLES)[:-40], "refused: line")
    case("binary-cut-short.stl", stl_binary()[:-40], "refused: 'binary-cut-short.stl' has none of the supported formats")


# ---- PLY -------------------------------------------------------------------------------------------
def ply(form):
    head = f"ply\nformat {form} 1.0\ncomment made for a test\nelement vertex 8\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\n"
    head += "element face 6\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    if form == "ascii":
        return head + "".join(f"{numbers(p)} 255\n" for p in BOX) + "".join(f"4 {numbers(q)}\n" for q in QUADRANGLES) + "0 1\n"
    order = "<" if "little" in form else ">"
    data = head.encode() + b"".join(struct.pack(order + "fdfB", *p, 255) for p in BOX)
    return data + b"".join(struct.pack(order + "B4i", 4, *q) for q in QUADRANGLES) + struct.pack(order + "2i", 0, 1)


def all_ply():
    for name, form, shown in (("text", "ascii", "PLY"), ("little", "binary_little_endian", "PLY binary"), ("big", "binary_big_endian", "PLY binary")):
        case(f"{name}.ply", ply(form), *surface(shown, read="read: 6 quadrangles", passed="passed over: 1 edge elements",
                                                 mended="mended: 6 quadrangles and polygons split into triangles"))
    case("cut-short.ply", ply("binary_little_endian")[:-60], "refused: ")
    case("points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
         "refused: line 8: no surface and no volume elements in this file, but 1 vertices")


# ---- Medit -----------------------------------------------------------------------------------------
def medit(more=""):
    text = "MeshVersionFormatted 2\n# a comment\nDimension 3\nVertices\n8\n" + "".join(f"{numbers(p)} 0\n" for p in BOX)
    return text + more + "Tetrahedra\n6\n" + "".join(f"{numbers(c + 1 for c in t)} 5\n" for t in TETRAHEDRA) + "End\n"


def meshb(version, order="<"):
    whole, place, real = ("q" if version == 4 else "i"), ("q" if version >= 3 else "i"), ("f" if version == 1 else "d")
    data = struct.pack(order + "2i", 1, version)

    def block(code, body):
        nonlocal data
        head = 4 + struct.calcsize("=" + place)
        data += struct.pack(order + "i" + place, code, len(data) + head + len(body)) + body
    block(3, struct.pack(order + "i", 3))
    block(4, struct.pack(order + whole, 8) + b"".join(struct.pack(order + "3" + real + whole, *p, 0) for p in BOX))
    block(99, b"12345678")
    block(8, struct.pack(order + whole, 6) + b"".join(struct.pack(order + "5" + whole, *(c + 1 for c in t), 5) for t in TETRAHEDRA))
    return data + struct.pack(order + "i" + place, 54, 0)


def all_medit():
    regions = "regions: 5 (6 tetrahedra)"
    case("medit.mesh", medit(), *tetrahedra("Medit", regions=regions))
    case("medit-more.mesh", medit("Corners\n1\n1\nRidges 1\n1\nEdges\n1\n1 2 0\n"),
         *tetrahedra("Medit", passed="passed over: 1 Corners lines, 1 Ridges lines, 1 lines", regions=regions))
    case("medit-hexahedron.mesh", "MeshVersionFormatted 1\nDimension\n3\nVertices 8\n" + "".join(f"{numbers(p)} 0\n" for p in BOX) +
         "Hexahedra 1\n1 2 3 4 5 6 7 8 5\nQuadrilaterals 6\n" + "".join(f"{numbers(c + 1 for c in q)} 2\n" for q in QUADRANGLES) + "End\n",
         "format: Medit, 8 vertices", "read: 1 hexahedra, 6 quadrangles",
         "mended: 6 quadrangles and polygons split into triangles, 1 hexahedra split into tetrahedra",
         "mesh: 8 vertices, 6 tetrahedra, 12 triangles, 1 component", SIZE, "regions: 2 (12 triangles), 5 (6 tetrahedra)")
    for version in (1, 2, 3, 4):
        case(f"medit-{version}.meshb", meshb(version), *tetrahedra("Medit binary", passed="passed over: 1 other blocks", regions=regions))
    case("medit-big-endian.meshb", meshb(2, ">"), *tetrahedra("Medit binary", passed="passed over: 1 other blocks", regions=regions))
    case("cut-short.mesh", medit()[:-20], "refused: line")


# ---- TetGen ----------------------------------------------------------------------------------------
def all_tetgen():
    def node(first):
        return "# points\n8 3 0 1\n" + "".join(f"{i + first} {numbers(p)} 1\n" for i, p in enumerate(BOX))

    def ele(first):
        return "6 4 1\n" + "".join(f"{i + first} {numbers(c + first for c in t)} 3\n" for i, t in enumerate(TETRAHEDRA)) + "# by hand\n"
    regions = "regions: 3 (6 tetrahedra)"
    case("box.1.node", node(1), *tetrahedra("TetGen", regions=regions), files={"box.1.ele": ele(1)})
    case("zero.1.ele", ele(0), *tetrahedra("TetGen", regions=regions), files={"zero.1.node": node(0)})
    case("together.tetgen", node(0) + ele(0), *tetrahedra("TetGen", regions=regions))
    case("face.1.face", "12 1\n" + "".join(f"{i} {numbers(t)} 4\n" for i, t in enumerate(TRIANGLES)),
         *surface("TetGen", regions="regions: 4 (12 triangles)"), files={"face.1.node": node(0)})
    case("elements-alone.1.ele", ele(1), "refused: line 1: elements without their points: keep the .node file beside this one")
    case("points-alone.1.node", node(1), "refused: line 10: points without elements: keep the .ele file beside this one")


# ---- USD -------------------------------------------------------------------------------------------
def usd_tuples(rows):
    return "[" + ", ".join("(" + ", ".join(map(str, row)) + ")" for row in rows) + "]"


def all_usd():
    head = "#usda 1.0\n(\n    defaultPrim = \"World\"\n    metersPerUnit = {unit}\n    upAxis = \"Z\"\n)\n\ndef Xform \"World\"\n{{\n"
    tets = "    def TetMesh \"Liver\"\n    {\n        int[] surfaceFaceVertexIndices = []\n        point3f[] points = %s\n        int4[] tetVertexIndices = %s\n    }\n"
    case("tets.usda", head.format(unit=1) + tets % (usd_tuples(BOX), usd_tuples(TETRAHEDRA)) + "}\n",
         *tetrahedra("USD", regions="regions: 1 \"Liver\" (6 tetrahedra)"))
    case("centimetres.usda", head.format(unit=0.01) + tets % (usd_tuples([tuple(100 * c for c in p) for p in BOX]), usd_tuples(TETRAHEDRA)) + "}\n",
         *tetrahedra("USD", regions="regions: 1 \"Liver\" (6 tetrahedra)"))
    mesh = "def Mesh \"Skin\" (\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{\n    # counts\n    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]\n"
    mesh += f"    int[] faceVertexIndices = [{', '.join(str(v) for q in QUADRANGLES for v in q)}]\n    point3f[] points = {usd_tuples(BOX)}\n"
    mesh += "    double3 xformOp:translate = (1, 0, 0)\n}\n"
    case("surface.usda", "#usda 1.0\n" + mesh,
         *surface("USD", read="read: 6 quadrangles", passed="passed over: 1 transforms",
                  mended="mended: 6 quadrangles and polygons split into triangles", regions="regions: 1 \"Skin\" (12 triangles)"))
    case("cut-short.usda", (head.format(unit=1) + tets % (usd_tuples(BOX), usd_tuples(TETRAHEDRA)))[:-100], "refused: line")
    case("binary.usdc", b"PXR-USDC" + bytes(80), "refused: 'binary.usdc' is binary USD: convert it with usdcat")


# ---- VTK -------------------------------------------------------------------------------------------
def vtk(cells, types, regions=None, head="# vtk DataFile Version 3.0\na box\nASCII\nDATASET UNSTRUCTURED_GRID\n", points=BOX):
    text = head + f"POINTS {len(points)} double\n" + ascending(points)
    text += f"CELLS {len(cells)} {sum(len(c) + 1 for c in cells)}\n" + "".join(f"{len(c)} {numbers(c)}\n" for c in cells)
    text += f"CELL_TYPES {len(cells)}\n" + "".join(f"{t}\n" for t in types)
    if regions:
        text += f"CELL_DATA {len(cells)}\nSCALARS region int 1\nLOOKUP_TABLE default\n" + "".join(f"{r}\n" for r in regions)
    return text


def vtu_array(values, kind, name, form, appended, header="I", compress=False, components=None):
    code = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}[kind]
    raw = struct.pack(f"<{len(values)}{code}", *values)
    attributes = f'type="{kind}" Name="{name}" format="{form}"' + (f' NumberOfComponents="{components}"' if components else "")
    if form == "ascii":
        return f"<DataArray {attributes}>\n{numbers(values)}\n</DataArray>\n"
    if compress:
        blocks = [raw[i:i + 64] for i in range(0, len(raw), 64)]
        packed = [zlib.compress(b) for b in blocks]
        head = struct.pack(f"<{3 + len(blocks)}{header}", len(blocks), 64, len(raw) % 64, *map(len, packed))
        parts = [head, b"".join(packed)]
    else:
        parts = [struct.pack("<" + header, len(raw)) + raw]
    coded = b"".join(base64.b64encode(p) for p in parts)
    if form == "binary":
        return f"<DataArray {attributes}>{coded.decode()}</DataArray>\n"
    offset = len(appended[0])
    appended[0] += coded if appended[1] else b"".join(parts)
    return f'<DataArray {attributes} offset="{offset}"/>\n'


def vtu(form, *, raw=False, header="UInt32", compress=False, cells=TETRAHEDRA, types=None, regions=None):
    appended = [b"", not raw]
    code = "I" if header == "UInt32" else "Q"

    def array(values, kind, name, components=None):
        return vtu_array(values, kind, name, form, appended, code, compress, components)
    offsets = [sum(len(c) for c in cells[:i + 1]) for i in range(len(cells))]
    text = f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="{header}"'
    text += (' compressor="vtkZLibDataCompressor"' if compress else "") + ">\n<UnstructuredGrid>\n"
    text += f'<Piece NumberOfPoints="8" NumberOfCells="{len(cells)}">\n<CellData>\n' + array(regions or [9] * len(cells), "Int32", "region") + "</CellData>\n"
    text += "<Points>\n" + array([c for p in BOX for c in p], "Float64", "Points", 3) + "</Points>\n<Cells>\n"
    text += array([v for c in cells for v in c], "Int64", "connectivity") + array(offsets, "Int64", "offsets")
    text += array(types or [10] * len(cells), "UInt8", "types") + "</Cells>\n</Piece>\n</UnstructuredGrid>\n"
    data = text.encode()
    if form == "appended":
        data += f'<AppendedData encoding="{"raw" if raw else "base64"}">\n_'.encode() + appended[0] + b"\n</AppendedData>\n"
    return data + b"</VTKFile>\n"


def all_vtk():
    regions = "regions: 9 (6 tetrahedra)"
    case("legacy.vtk", vtk(TETRAHEDRA, [10] * 6, [9] * 6), *tetrahedra("VTK 3.0", regions=regions))
    case("legacy-mixed.vtk", vtk([HEXAHEDRON, (0, 1), *QUADRANGLES], [12, 3, *[9] * 6], [1, 0, *[2] * 6]),
         "format: VTK 3.0, 8 vertices", "read: 1 hexahedra, 6 quadrangles", "passed over: 1 lines",
         "mended: 6 quadrangles and polygons split into triangles, 1 hexahedra split into tetrahedra",
         "mesh: 8 vertices, 6 tetrahedra, 12 triangles, 1 component", SIZE, "regions: 2 (12 triangles), 1 (6 tetrahedra)")
    case("voxel.vtk", vtk([(0, 1, 3, 2, 4, 5, 7, 6)], [11]),
         *tetrahedra("VTK 3.0", read="read: 1 voxels", mended="mended: 1 hexahedra split into tetrahedra"))
    case("strips.vtk", "# vtk DataFile Version 3.0\na strip\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0\n.04 0 0\n0 .03 0\n.04 .03 0\n"
         "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n",
         "format: VTK 3.0, 4 vertices", "read: 2 triangles", "mesh: 4 vertices, 2 triangles, 1 component, open surface with 4 edges on its rim",
         "size: 0.04 x 0.03 x 0 m, unit_m 1 (metres)", "regions: 0 (2 triangles)")
    shown = "VTK XML UnstructuredGrid"
    for name, options in (("ascii", {"form": "ascii"}), ("base64", {"form": "binary"}), ("base64-64", {"form": "binary", "header": "UInt64"}),
                          ("zlib", {"form": "binary", "compress": True}), ("appended-base64", {"form": "appended"}),
                          ("appended-raw", {"form": "appended", "raw": True}),
                          ("appended-raw-zlib", {"form": "appended", "raw": True, "compress": True, "header": "UInt64"})):
        case(f"{name}.vtu", vtu(**options), *tetrahedra(shown, regions=regions))
    case("mixed.vtu", vtu("ascii", cells=[*WEDGES], types=[13, 13], regions=[4, 4]),
         *tetrahedra(shown, read="read: 2 wedges", mended="mended: 2 wedges split into tetrahedra", regions="regions: 4 (6 tetrahedra)"))
    case("polydata.vtp", '<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData><Piece NumberOfPoints="8" NumberOfPolys="6">'
         f'<Points><DataArray type="Float32" format="ascii">{numbers(c for p in BOX for c in p)}</DataArray></Points><Polys>'
         f'<DataArray type="Int32" Name="connectivity" format="ascii">{numbers(v for q in QUADRANGLES for v in q)}</DataArray>'
         '<DataArray type="Int32" Name="offsets" format="ascii">4 8 12 16 20 24</DataArray></Polys></Piece></PolyData></VTKFile>',
         *surface("VTK XML PolyData", read="read: 6 quadrangles", mended="mended: 6 quadrangles and polygons split into triangles"))
    case("lz4.vtu", vtu("ascii").replace(b"header_type", b'compressor="vtkLZ4DataCompressor" header_type'),
         "refused: line 2: vtkLZ4DataCompressor is not read: save the file with zlib or uncompressed")
    case("cut-short.vtu", vtu("binary", compress=True)[:-300], "refused: line")
    damaged = bytearray(vtu("appended", raw=True, compress=True))
    at = damaged.rindex(b"x\x9c") + 4
    damaged[at] ^= 0xff
    case("damaged.vtu", bytes(damaged), "refused: line")
    case("image.vti", '<VTKFile type="ImageData" version="0.1"><ImageData/></VTKFile>',
         "refused: line 1: a VTK file of type ImageData: save it as an unstructured grid (.vtu)")


# ---- what is none of them --------------------------------------------------------------------------
def all_others():
    case("empty.msh", "", "refused: 'empty.msh' is empty")
    case("letter.txt", "Dear colleague,\nhere is the liver.\n", "refused: 'letter.txt' has none of the supported formats")
    case("noise.stl", bytes(range(256)) * 2, "refused: 'noise.stl' has none of the supported formats")
    case("volume.nrrd", "NRRD0004\ntype: uchar\n", "refused: 'volume.nrrd' is a volume of voxels (NRRD): make tetrahedra of it with cautery-mesh")
    case("volume.nii", bytes(344) + b"n+1\0" + bytes(100), "refused: 'volume.nii' is a volume of voxels (NIfTI): make tetrahedra of it with cautery-mesh")
    case("volume.mha", "ObjectType = Image\nNDims = 3\n", "refused: 'volume.mha' is a MetaImage: save the segmentation as NRRD or NIfTI")
    case("packed.msh.gz", b"\x1f\x8b\x08\x00" + bytes(40), "refused: 'packed.msh.gz' is compressed with gzip: unpack it first")
    case("utf16.obj", obj(TRIANGLES).encode("utf-16"), "refused: 'utf16.obj' is text in UTF-16: save it as UTF-8")


def write(folder):
    os.makedirs(folder, exist_ok=True)
    for name, data, _, _, files in CASES:
        for other, text in {name: data, **files}.items():
            with open(os.path.join(folder, other), "wb") as file:
                file.write(text.encode() if isinstance(text, str) else text)


def differs(name, wanted, lines):
    """Why a report is not the wanted one, or None."""
    if wanted[0].startswith("refused: "):
        return None if len(lines) == 1 and lines[0].startswith(wanted[0]) else "is not refused so"
    if lines[:-1] != list(wanted):
        return "has another report"
    counts = [int(n) for n in lines[-1].removeprefix("quality in tenths from 0 to 1: ").split(",")[0].split()]
    mesh = next(line for line in lines if line.startswith("mesh: "))
    kind = "tetrahedra" if "tetrahedra" in mesh else "triangles"
    elements = int(mesh.split(f" {kind}")[0].split()[-1])
    return None if len(counts) == 10 and sum(counts) == elements else "has a histogram of other elements"


def check(program, folder):
    failed = 0
    for name, _, wanted, arguments, _ in CASES:
        # Names without a folder: the folder of the build is in no message.
        result = subprocess.run([program, *arguments, name], cwd=folder, capture_output=True, text=True, check=False)
        lines = result.stdout.splitlines()[1:]
        why = differs(name, wanted, lines) if lines and not result.returncode else f"ends with {result.returncode} {result.stderr}"
        if why:
            failed += 1
            print(f"{name} {why}\n  wanted: " + "\n          ".join(wanted) + "\n  got:    " + "\n          ".join(lines))
    print(f"{len(CASES)} files, {failed} with another report than wanted")
    return 1 if failed or len(CASES) < 60 else 0


for make in (all_gmsh, all_mending, all_units, all_obj, all_stl, all_ply, all_medit, all_tetgen, all_usd, all_vtk, all_others):
    make()

if __name__ == "__main__":
    if sys.argv[1] == "--check":
        write(sys.argv[3])
        sys.exit(check(os.path.abspath(sys.argv[2]), sys.argv[3]))
    write(sys.argv[1])
