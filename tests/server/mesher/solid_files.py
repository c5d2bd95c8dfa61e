# SPDX-License-Identifier: GPL-3.0-or-later
"""A set of surfaces and segmentations, and what cautery-mesh makes of each.

    solid_files.py FOLDER                  writes the files
    solid_files.py --check PROGRAM FOLDER  writes them, and runs PROGRAM (cautery-mesh) on each
"""
import gzip
import math
import os
import struct
import subprocess
import sys

CASES = []


def case(name, data, *lines, arguments=(), code=0, volume=None, regions=None, centre=None):
    """A file, and lines of the report that begin so, in order; with `code` what the complaint holds.
    `volume` within 5 %; `regions`: numbers and names; `centre`: middle of region 1 within half a unit."""
    CASES.append((name, data, lines, arguments, code, volume, regions, centre))


# ---- surfaces --------------------------------------------------------------------------------------
def ball(radius=20.0, n=20, centre=(0, 0, 0)):
    def at(i, j):
        j = j if 0 < i < n else 0  # one vertex at each pole
        theta, phi = math.pi * i / n, math.pi * (j % (2 * n)) / n
        return tuple(c + radius * x for c, x in zip(centre, (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))))
    triangles = []
    for i in range(n):
        for j in range(2 * n):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [(a, b, d)] * (i > 0) + [(b, c, d)] * (i < n - 1)
    return triangles


def turned(triangles, every=1):
    return [(a, c, b) if k % every == 0 else (a, b, c) for k, (a, b, c) in enumerate(triangles)]


def stl(triangles):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in v), 0) for t in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + body


def obj(triangles):
    numbers = {v: i + 1 for i, v in enumerate(dict.fromkeys(v for t in triangles for v in t))}
    return "".join(f"v {x} {y} {z}\n" for x, y, z in numbers) + "".join("f {} {} {}\n".format(*(numbers[v] for v in t)) for t in triangles)


BALL = 4 / 3 * math.pi * 20 ** 3


def all_surfaces():
    closed = ("surface: 1520 triangles, 1 component, 0 open edges", "edge: ", "solid: ")
    case("ball.stl", stl(ball()), *closed, volume=BALL)
    case("ball.obj", obj(ball()), *closed, volume=BALL)
    case("inward.stl", stl(turned(ball())), "surface: 1520 triangles, 1 component, 0 open edges, 1520 triangles turned outward", volume=BALL)
    case("mixed.stl", stl(turned(ball(), 7)), "surface: 1520 triangles, 1 component, 0 open edges, 218 triangles turned outward", volume=BALL)
    case("open.stl", stl(ball()[40:]), "surface: 1480 triangles, 1 component, 40 open edges", volume=BALL)
    case("two.stl", stl(ball() + ball(centre=(50, 0, 0))), "surface: 3040 triangles, 2 components", volume=2 * BALL)
    case("crossing.stl", stl(ball() + ball(centre=(20.1, 0, 0))), "surface: 3040 triangles, 2 components", volume=BALL * (2 - 5 / 16))
    case("cavity.stl", stl(ball() + turned(ball(10))), "surface: 3040 triangles, 2 components", volume=BALL * 7 / 8)
    pipe = [tuple((x, y, 40 * z) for x, y, z in t) for t in ball(0.5, 24)]
    case("pipe.stl", stl([tuple((x + (z / 8) ** 3, y, z) for x, y, z in t) for t in pipe]), "surface: 2208 triangles, 1 component, 0 open edges", "edge: ", "solid: ")
    case("edge.stl", stl(ball()), "surface: ", "edge: 5 of a longest side of 40 (asked for)", arguments=("--edge", "5"))
    case("strict.obj", obj(ball()), *closed, arguments=("--strict",))
    case("strict_open.stl", stl(ball()[40:]), "--strict refuses to fill an open surface: 40 edges on its rim", arguments=("--strict",), code=3)
    case("strict_turned.stl", stl(turned(ball(), 7)), "--strict refuses to turn 218 triangles whose normal points inward", arguments=("--strict",), code=3)
    case("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "nothing is inside this surface", code=3)
    case("fine.stl", stl(ball()), "--edge: this edge is too short: it gives ", arguments=("--edge", "0.01"), code=3)
    case("coarse.stl", stl(ball()), "--edge: an edge of 500 is longer than the tissue is thick", arguments=("--edge", "500"), code=3)
    case("labels.stl", stl(ball()), "--labels: a surface has no labels", arguments=("--labels", "1"), code=3)
    case("damaged.stl", stl(ball())[:-30], "cautery-mesh: ", code=3)
    case("letter.txt", "Dear colleague,\n", "has none of the supported formats", code=3)
    case("empty.stl", b"", "is empty", code=3)
    case("full.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n",
         "this file has tetrahedra already", code=3)


# ---- segmentations ---------------------------------------------------------------------------------
SIDE = 30


def label_at(i, j, k):
    """A ball of 10 voxels around (12, 15, 15), and its part beyond x = 15 as label 7."""
    if (i - 12) ** 2 + (j - 15) ** 2 + (k - 15) ** 2 > 100:
        return 0
    return 7 if i > 15 else 2


VOXELS = [label_at(i, j, k) for k in range(SIDE) for j in range(SIDE) for i in range(SIDE)]
NAMES = "Segment0_Name:=liver\nSegment0_LabelValue:=2\nSegment1_Name:=vena cava\nSegment1_LabelValue:=7\n"


def nrrd(numbers, *, kind="uint8", encoding="raw", space="left-posterior-superior", extra=NAMES, directions="(1,0,0) (0,1,0) (0,0,1)", dimension="3", sizes=f"{SIDE} {SIDE} {SIDE}"):
    head = f"NRRD0004\n# a comment with the name of Jane Doe\ntype: {kind}\ndimension: {dimension}\n" + (f"space: {space}\n" if space else "")
    head += f"sizes: {sizes}\nspace directions: {directions}\nspace origin: (0,0,0)\nkinds: domain domain domain\nendian: little\nencoding: {encoding}\n{extra}\n"
    return head.encode() + numbers


def nifti(numbers, *, version=1, code=2, affine=((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)), sform=1, order="<", sizes=(3, SIDE, SIDE, SIDE, 1, 1, 1, 1), slope=0.0, units=2, magic=b"n+1\0"):
    head = bytearray(352 if version == 1 else 544)

    def put(at, form, *values):
        struct.pack_into(order + form, head, at, *values)
    if version == 1:
        put(0, "i", 348)
        put(40, "8h", *sizes)
        put(70, "h", code)
        put(76, "8f", 1, 1, 1, 1, 1, 1, 1, 1)
        put(108, "f", 352)
        put(112, "2f", slope, 0)
        head[123] = units
        head[148:156] = b"Jane Doe"
        put(254, "h", sform)
        put(280, "12f", *(x for row in affine for x in row))
        head[344:348] = magic
    else:
        put(0, "i", 540)
        head[4:8] = b"n+2\0"
        put(12, "h", code)
        put(16, "8q", *sizes)
        put(104, "8d", 1, 1, 1, 1, 1, 1, 1, 1)
        put(168, "q", 544)
        put(348, "i", sform)
        put(400, "12d", *(x for row in affine for x in row))
        put(500, "i", units)
    return bytes(head) + numbers


def packed_as(form, order="<"):
    return struct.pack(f"{order}{len(VOXELS)}{form}", *VOXELS)


def all_segmentations():
    small, both = bytes(VOXELS), (VOXELS.count(2) + VOXELS.count(7))
    named = [(2, "liver"), (7, "vena cava")]
    plain = [(2, "label 2"), (7, "label 7")]
    lps = ("format: NRRD, 30 x 30 x 30 voxels of 1 x 1 x 1 mm", "orientation: the file's axes run to LPS; of the mesh x is right, y front, z head (RAS)",
           "edge: ", "solid: ", 'label 2 "liver": ', 'label 7 "vena cava": ')
    case("raw.nrrd", nrrd(small), *lps, volume=both, regions=named, centre=(-12, -15, -15 + 30))
    case("gzip.nrrd", nrrd(gzip.compress(small, mtime=0), encoding="gzip"), *lps, volume=both, regions=named)
    case("ascii.nrrd", nrrd(" ".join(map(str, VOXELS)).encode(), encoding="ascii"), *lps, volume=both, regions=named)
    for kind, form in (("short", "h"), ("unsigned int", "I"), ("int64", "q"), ("float", "f"), ("double", "d")):
        case(f"{kind.replace(' ', '_')}.nrrd", nrrd(packed_as(form), kind=kind), *lps, volume=both, regions=named)
    case("big.nrrd", nrrd(packed_as("h", ">"), kind="short").replace(b"endian: little", b"endian: big"), *lps, volume=both, regions=named)
    case("ras.nrrd", nrrd(small, space="RAS"), "format: ", "orientation: the file's axes run to RAS", volume=both, centre=(12, 15, 15))
    case("turned.nrrd", nrrd(small, space="RAS", directions="(0,0,2) (0,1,0) (1,0,0)"), "format: NRRD, 30 x 30 x 30 voxels of 2 x 1 x 1 mm",
         "orientation: the file's axes run to SAR", volume=2 * both, centre=(15, 15, 24))
    case("frameless.nrrd", nrrd(small, space=None), "format: ", "orientation: the file states none, so that left and right may be exchanged", volume=both)
    case("kept.nrrd", nrrd(small), "format: ", "orientation: ", "edge: ", "solid: ", 'label 7 "vena cava": ', arguments=("--labels", "7"), volume=VOXELS.count(7),
         regions=[(7, "vena cava")])
    case("unnamed.nrrd", nrrd(small, extra=""), "format: ", "orientation: ", "edge: ", "solid: ", "label 2: ", "label 7: ", regions=plain)
    case("thin.nrrd", nrrd(bytes([9 if k == 14415 else v for k, v in enumerate(VOXELS)])), "format: ", "orientation: ", "edge: ", "solid: ", 'label 2 "liver": ',
         'label 7 "vena cava": ', "label 9: 1 voxels, 0 tetrahedra (lost: thinner than an edge; choose a shorter one)")
    many = bytes(0 if v == 0 else 1 + (k % 63) for k, v in enumerate(VOXELS))
    long_names = "".join(f"Segment{k}_Name:={'a' * 44}{k:03}\nSegment{k}_LabelValue:={k + 1}\n" for k in range(63))
    case("names.nrrd", nrrd(many, extra=long_names), "format: ", "orientation: ", "edge: ", "solid: ", *(f'label {k + 1} "{"a" * 44}{k:03}": ' for k in range(63)))
    atlas = bytes(0 if v == 0 else 5 if v == 2 else 20 + k % 200 for k, v in enumerate(VOXELS))
    late = "Segment99_Name:=spleen\nSegment99_LabelValue:=5\n"
    case("atlas.nrrd", nrrd(atlas, extra=late), "format: ", "orientation: ", "edge: ", "solid: ", 'label 5 "spleen": ', arguments=("--labels", "5"),
         volume=VOXELS.count(2), regions=[(5, "spleen")])
    complaint = {"code": 3}
    case("missing.nrrd", nrrd(small), "--labels: no voxel has label 5", arguments=("--labels", "2,5"), **complaint)
    case("words.nrrd", nrrd(small), "--labels: labels must be numbers from 1 to 65535 with commas", arguments=("--labels", "liver"), **complaint)
    case("short_file.nrrd", nrrd(small[:-9]), "the file ends early: 26991 bytes of voxels, of 27000 that its header promises", **complaint)
    case("broken_gzip.nrrd", nrrd(b"\x1f\x8b\x08\x00" + bytes(60), encoding="gzip"), "the packed data are damaged", **complaint)
    case("image.nrrd", nrrd(bytes(k % 200 for k in range(SIDE ** 3))), "more than 63 different labels: choose some of them (labels); an image", **complaint)
    case("negative.nrrd", nrrd(struct.pack("<27000h", *(v - 1000 for v in VOXELS)), kind="short"), "a voxel holds -1000", **complaint)
    case("empty.nrrd", nrrd(bytes(SIDE ** 3)), "all voxels of this volume are 0", **complaint)
    case("layers.nrrd", nrrd(small, dimension="4"), "this volume has 4 axes, but only 3 are supported", **complaint)
    case("detached.nrrd", nrrd(b"", extra="data file: voxels.raw\n"), "the voxels are in a separate file", **complaint)
    case("bzip2.nrrd", nrrd(small, encoding="bzip2"), "the encoding 'bzip2' is not read: save the file as raw or gzip", **complaint)
    case("flat.nrrd", nrrd(small, directions="(1,0,0) (1,0,0) (0,0,1)"), "the axes of this volume do not span a space", **complaint)
    case("headless.nrrd", b"NRRD0004\ntype: uint8\n", "the header has no end", **complaint)
    case("huge.nrrd", nrrd(b"", sizes="8000 8000 8000"), "crop the volume", **complaint)

    first = ("format: NIfTI 1, 30 x 30 x 30 voxels of 1 x 1 x 1 mm", "orientation: the file's axes run to RAS", "edge: ", "solid: ")
    mirrored = ((-1, 0, 0, 0), (0, -1, 0, 0), (0, 0, 1, 0))
    case("plain.nii", nifti(small), *first, volume=both, regions=plain, centre=(12, 15, 15))
    case("packed.nii.gz", gzip.compress(nifti(small), mtime=0), *first, volume=both, regions=plain)
    case("mirrored.nii", nifti(small, affine=mirrored), "format: ", "orientation: the file's axes run to LPS", volume=both, centre=(-12, -15, 15))
    case("second.nii", nifti(small, version=2), "format: NIfTI 2", volume=both, regions=plain)
    case("big.nii", nifti(packed_as("h", ">"), code=4, order=">"), *first, volume=both)
    case("metres.nii", nifti(small, affine=((.001, 0, 0, 0), (0, .001, 0, 0), (0, 0, .001, 0)), units=1), *first, volume=both)
    case("frameless.nii", nifti(small, sform=0), "format: ", "orientation: the file states none", volume=both)
    case("series.nii", nifti(small * 2, sizes=(4, SIDE, SIDE, SIDE, 2, 1, 1, 1)), "this volume has more than 3 axes", **complaint)
    case("scaled.nii", nifti(small, slope=0.5), "the voxels are scaled by 0.5: this is an image, not a segmentation", **complaint)
    case("colours.nii", nifti(small * 3, code=128), "the data type 128 is not read", **complaint)
    case("pair.nii", nifti(small, magic=b"ni1\0"), "save header and voxels as one file (.nii)", **complaint)
    case("cut.nii.gz", gzip.compress(nifti(small), mtime=0)[:200], "", **complaint)


# ---- checking --------------------------------------------------------------------------------------
def read_solid(data):
    """Positions, tetrahedra with their regions, and names of a binary Gmsh 2.2 file."""
    names = []
    if b"$PhysicalNames\n" in data:
        block = data.split(b"$PhysicalNames\n")[1].split(b"$EndPhysicalNames")[0].decode().splitlines()[1:]
        names = [(int(line.split()[1]), line.split('"')[1]) for line in block]
    at = data.index(b"$Nodes\n") + 7
    end = data.index(b"\n", at)
    positions = [struct.unpack_from("<3d", data, end + 1 + 28 * k + 4) for k in range(int(data[at:end]))]
    at = data.index(b"$Elements\n") + 10
    end = data.index(b"\n", at)
    elements = [struct.unpack_from("<7i", data, end + 13 + 28 * k) for k in range(int(data[at:end]))]
    return positions, [(e[1], [positions[v - 1] for v in e[3:]]) for e in elements], names


def volume_of(corners):
    a, b, c, d = corners
    u, v, w = ([q - p for p, q in zip(a, x)] for x in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6


def middle_of(tetrahedra):
    parts = [(volume_of(corners), [sum(x) / 4 for x in zip(*corners)]) for _, corners in tetrahedra]
    whole = sum(v for v, _ in parts)
    return [sum(v * m[c] for v, m in parts) / whole for c in range(3)]


def why_not(result, out, wanted):
    """Why a result is not the wanted one, or None."""
    _, _, lines, _, code, volume, regions, centre = wanted
    said = result.stderr.decode()
    if result.returncode != code:
        return f"ends with {result.returncode}"
    if "Jane" in said:
        return "tells a patient's name"
    if code:
        return None if lines[0] in said and not os.path.exists(out) else "has another complaint"
    report = [line for line in said.splitlines() if not line.endswith(" %")]
    for place, line in enumerate(lines):
        if place >= len(report) or not report[place].startswith(line):
            return f"has no line {place + 1} that begins with `{line}`"
    with open(out, "rb") as file:
        _, tetrahedra, names = read_solid(file.read())
    volumes = [volume_of(corners) for _, corners in tetrahedra]
    if min(volumes) <= 0 or (volume and abs(sum(volumes) / volume - 1) > 0.05):
        return f"has volume {sum(volumes)}, of {volume}, least {min(volumes)}"
    if regions is not None and (names != regions or {r for r, _ in tetrahedra} != {r for r, _ in regions}):
        return f"has regions {names}"
    middle = middle_of(tetrahedra)
    if centre and max(abs(a - b) for a, b in zip(middle, centre)) > 0.5:
        return f"is around {middle}"
    return None


def write(folder):
    os.makedirs(folder, exist_ok=True)
    for name, data, *_ in CASES:
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data.encode() if isinstance(data, str) else data)


def check(program, folder):
    failed = 0
    for wanted in CASES:
        out = os.path.join(folder, wanted[0] + ".solid.msh")
        if os.path.exists(out):
            os.remove(out)
        result = subprocess.run([program, wanted[0], "--out", os.path.basename(out), *wanted[3]], cwd=folder, capture_output=True, check=False)
        why = why_not(result, out, wanted)
        if why:
            failed += 1
            print(f"{wanted[0]} {why}\n{result.stderr.decode()}")
    print(f"{len(CASES)} files, {failed} with another result than wanted")
    return 1 if failed or len(CASES) < 50 else 0


all_surfaces()
all_segmentations()

if __name__ == "__main__":
    if sys.argv[1] == "--check":
        write(sys.argv[3])
        sys.exit(check(os.path.abspath(sys.argv[2]), sys.argv[3]))
    write(sys.argv[1])
