# SPDX-License-Identifier: Apache-2.0
"""Decodes meshoptimizer's vertex codec, version 0, with numpy alone.

Each byte of a vertex forms a series over the vertices. A series has the differences from vertex to vertex, as zigzag
numbers, in groups of 16. A group has 0, 2, 4 or 8 bits for each number. If all bits of a number are set, the
number follows the group as a whole byte.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .errors import BadFrame

_HEADER = 0xA0
_GROUP = 16
_BLOCK_VERTICES_MOST, _BLOCK_BYTES = 256, 8192
_TAIL_BYTES_LEAST = 32


def _table(bits: int) -> npt.NDArray[np.uint8]:
    """For each byte, its numbers of `bits` bits each, the highest first: (256, 8 / bits)."""
    shifts = np.arange(8 - bits, -1, -bits)
    return (np.arange(256)[:, None] >> shifts & (1 << bits) - 1).astype(np.uint8)


_TABLES = {1: _table(2), 2: _table(4)}  # by the kind of a group; kind 0: all zero, 3: whole bytes
_ESCAPES = {kind: [int(n) for n in (table == table.max()).sum(axis=1)] for kind, table in _TABLES.items()}


def _find_groups(data: bytes, count: int, stride: int, end: int) -> dict[int, list[tuple[int, int]]]:
    """Finds the groups, by kind: (index among all differences, offset in the data)."""
    found: dict[int, list[tuple[int, int]]] = {1: [], 2: [], 3: []}
    columns = -(-count // _GROUP) * _GROUP
    block = min(_BLOCK_VERTICES_MOST, _BLOCK_BYTES // stride & ~(_GROUP - 1))
    at = 1
    for first in range(0, count, block):
        groups = -(-min(block, count - first) // _GROUP)
        for byte in range(stride):
            kinds = data[at:at + (groups + 3) // 4]
            at += len(kinds)
            for group in range(groups):
                kind = kinds[group >> 2] >> 2 * (group & 3) & 3
                if kind == 0:
                    continue
                found[kind].append((byte * columns + first + _GROUP * group, at))
                if kind == 3:
                    at += _GROUP
                else:
                    escapes = _ESCAPES[kind]
                    packed = data[at:at + 4 * kind]
                    at += len(packed) + sum(escapes[one] for one in packed)
            if at > end:
                raise BadFrame("packed vertices end too early")
    if at != end:
        raise BadFrame("packed vertices do not end where their data does")
    return found


def _unpack(groups: list[tuple[int, int]], kind: int, data: npt.NDArray[np.uint8],
            differences: npt.NDArray[np.uint8]) -> None:
    if not groups:
        return
    places, starts = np.array(groups).T
    if kind == 3:
        values = data[starts[:, None] + np.arange(_GROUP)]
    else:
        packed = 4 * kind
        values = _TABLES[kind][data[starts[:, None] + np.arange(packed)]].reshape(-1, _GROUP)
        escaped = values == (1 << 2 * kind) - 1
        further = starts[:, None] + packed + np.cumsum(escaped, axis=1) - 1
        values[escaped] = data[further[escaped]]
    differences[places[:, None] + np.arange(_GROUP)] = values


def decode_vertices(data: bytes, count: int, stride: int) -> npt.NDArray[np.uint8]:
    """The bytes of `count` vertices of `stride` bytes each: (count, stride)."""
    tail = max(stride, _TAIL_BYTES_LEAST)
    if len(data) < 1 + tail or data[0] != _HEADER:
        raise BadFrame("the bytes are not vertices of meshoptimizer's codec, version 0")
    try:
        groups = _find_groups(data, count, stride, len(data) - tail)
    except IndexError as error:
        raise BadFrame("packed vertices end too early") from error
    columns = -(-count // _GROUP) * _GROUP
    differences = np.zeros(stride * columns, np.uint8)
    source = np.frombuffer(data, np.uint8)
    for kind, found in groups.items():
        _unpack(found, kind, source, differences)
    signed = (differences >> 1) ^ (0 - (differences & 1)).astype(np.uint8)
    values = np.cumsum(signed.reshape(stride, columns)[:, :count], axis=1, dtype=np.uint8)
    return (values + source[len(data) - stride:, None]).T
