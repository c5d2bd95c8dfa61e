# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what cautery-sim writes for ParaView: unstructured grids with raw appended data."""

import array
import re
from dataclasses import dataclass

TYPES = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}
ARRAY = re.compile(rb'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)" format="appended" offset="(\d+)"/>')
TETRAHEDRON, LINK, TRIANGLE = range(3)  # the cells' `kind`


@dataclass
class State:
    """The tissue at a tick: `position_m` by vertex, living cells as tuples of vertices."""

    position_m: list
    cells: list
    kind: list
    layer: list
    exposure: list

    def triangles(self, layer=None):
        return [cell for cell, kind, of in zip(self.cells, self.kind, self.layer)
                if kind == TRIANGLE and layer in (None, of)]


def read_arrays(data):
    start = data.index(b"_", data.index(b"<AppendedData")) + 1
    arrays = {}
    for kind, name, components, offset in ARRAY.findall(data):
        at = start + int(offset)
        size = int.from_bytes(data[at:at + 8], "little")
        values = array.array(TYPES[kind.decode()])
        values.frombytes(data[at + 8:at + 8 + size])
        width = int(components)
        arrays[name.decode()] = (list(values) if width == 1 else
                                 [tuple(values[i:i + width]) for i in range(0, len(values), width)])
    return arrays


def read(path):
    with open(path, "rb") as file:
        arrays = read_arrays(file.read())
    ends = [0, *arrays["offsets"]]
    corners = arrays["connectivity"]
    return State(position_m=arrays["position_m"],
                 cells=[tuple(corners[a:b]) for a, b in zip(ends, ends[1:])],
                 kind=arrays["kind"], layer=arrays["layer"], exposure=arrays["exposure"])


def read_tips(path):
    """Where the tools' tips are, of a file tools-<tick>.vtu."""
    with open(path, "rb") as file:
        return read_arrays(file.read())["position_m"][::2]
