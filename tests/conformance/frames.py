# SPDX-License-Identifier: GPL-3.0-or-later
"""A decoder of plain frames, from protocol/README.md and the table of channels alone. Slow and simple: what other
decoders are held against. A `fault` plants one mistake, so that the suite can be tested."""

import struct

HEADER = struct.Struct("<4sBBHIIQQQQdQHHI")
KEY, DELTA, TOPOLOGY = 1, 2, 3
POSITIONS, MASK, TOOL_NAMES, TOOLS = 1, 2, 6, 7
PREVIOUS, HELD = 1, 2
TOOL_BYTES = 84


class Bad(Exception):
    """A frame that breaks the rules of the page."""


def _require(good, reason):
    if not good:
        raise Bad(reason)


def split(frame):
    """The header's fields, and (type, payload) of each section."""
    _require(len(frame) >= HEADER.size, "shorter than a header")
    names = ("magic version kind flags byte_count session epoch sequence base tick time_s published_us profile"
             " section_count reserved").split()
    head = dict(zip(names, HEADER.unpack_from(frame)))
    _require(head["magic"] == b"CAUF" and head["version"] == 1, "no frame of this version")
    _require(head["byte_count"] == len(frame), "byte_count is not the length")
    _require(head["kind"] in (KEY, DELTA, TOPOLOGY), "kind")
    at, found, last = HEADER.size, [], 0
    for _ in range(head["section_count"]):
        _require(at + 8 <= len(frame), "a section begins beyond the end")
        kind, zero, more, length = struct.unpack_from("<BBHI", frame, at)
        _require(zero == 0 and more == 0 and length % 4 == 0, "a section's head")
        _require(at + 8 + length <= len(frame), "a section ends beyond the end")
        _require(kind > last, "types do not ascend")
        found.append((kind, frame[at + 8:at + 8 + length]))
        at, last = at + 8 + length, kind
    _require(at == len(frame), "bytes behind the last section")
    return head, found


def _leb128(data):
    numbers, value, shift = [], 0, 0
    for byte in data:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value)
            value = shift = 0
    _require(shift == 0 and len(numbers) % 2 == 0, "a run list that ends early")
    return numbers


def _indices(runs, count, most):
    numbers, at, found = _leb128(runs), 0, []
    for skip, length in zip(numbers[0::2], numbers[1::2]):
        _require(length > 0 and at + skip + length <= most, "a run")
        found.extend(range(at + skip, at + skip + length))
        at += skip + length
    _require(len(found) == count, "runs and count differ")
    return found


def take_elements(payload, held, components, fault=None):
    """Writes a section's elements into `held`, a flat list of numbers modulo 2^32."""
    _require(len(payload) >= 12, "elements without a head")
    width, stated, coding, reference, count, run_bytes = struct.unpack_from("<BBBBII", payload)
    _require(stated == components and width in (1, 2, 4) and reference <= HELD, "elements of another kind")
    _require(coding == 0, "a coding that was not asked for")
    data = payload[12 + (run_bytes + 3 & ~3):]
    _require(len(data) == (count * components * width + 3 & ~3), "data of another length")
    numbers = struct.unpack_from(f"<{count * components}{'-BH-I'[width]}", data)
    balance = 0 if fault == "unsigned" else int("80" * width, 16)
    previous = [0] * components
    for i, element in enumerate(_indices(payload[12:12 + run_bytes], count, len(held) // components)):
        for c in range(components):
            value, at = numbers[components * i + c], components * element + c
            if reference in (PREVIOUS, HELD):
                value = (value ^ balance) - balance
            if reference == PREVIOUS and fault != "no_previous":
                value += previous[c]
            elif reference == HELD:
                value += held[at]
            held[at] = previous[c] = value % 2**32


def _signed(number):
    return number - 2**32 if number >= 2**31 else number


class Decoder:
    """What one stream's frames make. `channels`: those of protocol/asyncapi.json, x-stream-channels."""

    def __init__(self, description, channels, fault=None):
        self.description, self.fault = description, fault
        vertices, faces = description["vertex_count"], description["face_count"]
        self.scalars = [one for one in channels if "most" in one and one["name"] in description["channels"]]
        self.held = {POSITIONS: [0] * 3 * vertices, MASK: [0] * ((faces + 31) // 32),
                     **{one["section"]: [0] * vertices for one in self.scalars}}
        self.faces = [0] * 3 * faces
        self.place, self.tick, self.names, self.tools = None, 0, [], []

    def take(self, frame):
        """Whether the frame was taken. Raises Bad; then nothing is held until the next key frame."""
        head, sections = split(frame)
        if not self._applies(head):
            return False
        if head["kind"] == TOPOLOGY:
            take_elements(dict(sections)[16], self.faces, 3)
            return True
        before, self.place = self.place, None
        if head["kind"] == KEY and self.fault != "keeps":
            for array in self.held.values():
                array[:] = [0] * len(array)
            self.names = []
        for kind, payload in sections:
            self._section(kind, payload)
        self.place, self.tick = (head["epoch"], head["sequence"]), head["tick"]
        if self.fault == "late":  # shows the frame before
            self.tick = 0 if before is None else self.tick
        return True

    def _applies(self, head):
        mine = (self.description["session_number"], self.description["profile"])
        if (head["session"], head["profile"]) != mine and self.fault != "any_stream":
            return False
        if head["kind"] == DELTA:
            epoch, sequence = self.place or (None, None)
            return self.place is not None and (epoch == head["epoch"] or self.fault == "any_epoch") and (
                sequence == head["base"] or self.fault == "any_base")
        older = self.place is not None and self.place[0] == head["epoch"] and head["sequence"] <= self.place[1]
        return head["kind"] == TOPOLOGY or not older or self.fault == "old_key"

    def _section(self, kind, payload):
        if kind in self.held:
            take_elements(payload, self.held[kind], 3 if kind == POSITIONS else 1, self.fault)
        elif kind == TOOL_NAMES and self.fault != "no_names":
            self._take_names(payload)
        elif kind == TOOLS:
            self._take_tools(payload)
        elif self.fault == "only_known" and kind > 40:
            raise Bad("a section that is not known")

    def _take_names(self, payload):
        self.names, at = [], 4
        for _ in range(int.from_bytes(payload[:4], "little")):
            length = payload[at + 1]
            self.names.append(payload[at + 2:at + 2 + length].decode())
            at += 2 + length

    def _take_tools(self, payload):
        _require(len(payload) >= TOOL_BYTES * len(self.names), "fewer records than names")
        self.tools = []
        for i, name in enumerate(self.names):
            sequence, *numbers = struct.unpack_from("<Q17f", payload, TOOL_BYTES * i)
            flags = payload[TOOL_BYTES * i + 76]
            self.tools.append({"name": name, "sequence": sequence, "position_m": numbers[:3],
                               "energized": bool(flags & 1)})

    def drawn_vertices(self):
        """Those of faces that are drawn: rule 4 of the page says nothing of the others."""
        words, used = self.held[MASK], set()
        for face in range(self.description["face_count"]):
            if not words[face // 32] >> face % 32 & 1:
                used.update(self.faces[3 * face:3 * face + 3])
        return sorted(used)

    def state(self):
        """As an adapter answers."""
        origin, step = self.description["origin_m"], self.description["step_m"]
        words = self.held[MASK]
        bits = (lambda f: 31 - f % 32) if self.fault == "mask_order" else (lambda f: f % 32)
        result = {
            "epoch": f"{self.place[0]:016x}" if self.place else None,
            "sequence": self.place[1] if self.place else None,
            "tick": self.tick,
            "positions_m": [origin[i % 3] + step * _signed(q) for i, q in enumerate(self.held[POSITIONS])],
            "removed": [f for f in range(self.description["face_count"]) if words[f // 32] >> bits(f) & 1],
            "tools": self.tools}
        for one in self.scalars:
            scale = one["step"] or self.description["stress_step_pa"]
            result[one["name"]] = [one["least"] + scale * n for n in self.held[one["section"]]]
        return result
