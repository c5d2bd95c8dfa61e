# SPDX-License-Identifier: Apache-2.0
"""A session's stream as numpy arrays: decodes frames as protocol/README.md describes them."""

from __future__ import annotations

import struct
import threading
import time
from dataclasses import dataclass, replace
from typing import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from .errors import BadFrame, NoAnswer
from .messages import (ENERGY_OFF_REASONS, FRAME_KIND, SCALARS, SECTION, TOOL_SHAPES, WIRE_VERSION,
                       StreamDescription)
from .vertex_codec import decode_vertices

Floats = npt.NDArray[np.float64]

_HEAD = struct.Struct("<4sBBHIIQQQQdQHHI")
_PAUSED, _FAULTED = 1, 2
_MESHOPT = 1
_PREVIOUS, _HELD = 1, 2
_ENERGIZED, _GRASPING, _FROZEN, _SLIPPING = 1, 2, 4, 8

_TOOL = np.dtype([
    ("sequence", "<u8"), ("position_m", "<f4", 3), ("rotation", "<f4", 4), ("jaw", "<f4"), ("force_n", "<f4", 3),
    ("torque_nm", "<f4", 3), ("tip_temperature_c", "<f4"), ("energy_j", "<f4"), ("driver", "<u4"), ("flags", "u1"),
    ("energy_off", "u1"), ("grasped_vertices", "<u2"), ("contact_vertices", "<u2"), ("touched_layers", "<u2")])
_STATISTICS = np.dtype([
    ("realtime_factor", "<f4"), ("step_cost_s", "<f4"), ("stage_s", "<f4", 8), ("residual", "<f4"),
    ("deferred_max_s", "<f4"), ("iterations", "<u4"), ("backtracks", "<u4"), ("inverted", "<u4"),
    ("edges_parted", "<u4"), ("elements_removed", "<u4"), ("pending_downdates", "<u4"), ("refactorisations", "<u4"),
    ("contacts", "<u4"), ("frozen_vertices", "<u4"), ("refused_commands", "<u4"), ("energy_gain_j", "<f4"),
    ("resting", "<u4"), ("error", "<f4"), ("contacts_left_out", "<u4"), ("elements_torn", "<u4"),
    ("touching_cut_short", "<u4")])


@dataclass(frozen=True)
class Tool:
    """A tool in a frame. Metres, newtons, radians; `rotation` is w, x, y, z."""

    name: str
    shape: str
    position_m: Floats  # (3,)
    rotation: Floats  # (4,)
    jaw: float  # 0 closed to 1 open
    force_n: Floats  # (3,), of the tissue on the tool, filtered, force_max_n at most
    torque_nm: Floats  # (3,), about the tip, filtered as force_n
    tip_temperature_c: float
    energy_j: float  # estimate of the heat that tissue took up
    driver: int  # the client's number; 0: no driver
    energized: bool
    grasping: bool
    frozen: bool  # by the watchdog
    slipping: bool
    energy_off: str  # reason of the last time that energy went off
    sequence: int  # number of the last command that was applied
    delivered_w: float = 0.0  # power given to tissue in the last step
    load_ohm: float = 0.0  # load of the generator; 0: no current flows
    raw_force_n: Floats | None = None  # (3,), of the tick of the state, without filter and limit; None: not sent
    raw_torque_nm: Floats | None = None  # (3,), about the tip, without filter and limit; None: not sent
    force_filter_s: float | None = None  # time constant of the filter; 0: no filter; None: not sent


@dataclass(frozen=True)
class Vessel:
    """A blood vessel as a frame shows it (channel `vessels`)."""

    name: str
    parted: bool
    pierced: bool  # the wall has a hole
    shut: bool  # pressed so flat that no blood flows
    sealed: bool  # a seal withstands the pressure of the blood
    bleeds: bool
    radius_m: float
    bleeding_m3_s: float
    shed_m3: float  # volume of blood that has left the vessel
    burst_pa: float  # predicted pressure at which the best seal opens; 0: no seal
    points: Floats  # (P, 3), m: points of the middle line
    open: Floats  # (P,): open share of the lumen's area, 0 where a seal holds; below 0: parted there


@dataclass(frozen=True)
class Contact:
    """A linear model of the contact of a tool at the tick of the frame (channel `tool_contact`). P planes."""

    name: str
    valid: bool
    asked_position_m: Floats  # (3,): commanded
    asked_rotation: Floats  # (4,): w, x, y, z
    position_m: Floats  # (3,): actual
    rotation: Floats  # (4,)
    force_n: Floats  # (3,): raw, of the tissue on the tool
    compliance_m_n: Floats  # (3, 3): at the commanded position
    friction: float
    damping_ns_m: float
    grasp_n_m: float  # stiffness of what the jaws hold; 0: nothing
    grasp_anchor_m: Floats  # (3,): commanded position at which the grasped tissue pulls with 0 N
    normals: Floats  # (P, 3): of the planes, out of the tissue
    offsets_m: Floats  # (P,): a plane is in contact if normal . position is less
    velocities_m_s: Floats  # (P,): of the tissue along the normal


@dataclass(frozen=True)
class State:
    """The state in a frame. The arrays are copies. V vertices, F faces."""

    tick: int
    time_s: float
    paused: bool
    faulted: bool
    positions: Floats  # (V, 3), m; old for vertices that no drawn face uses
    removed: npt.NDArray[np.bool_]  # (F,): faces that are not drawn
    scalars: Mapping[str, Floats]  # (V,) for each channel of the stream, as in `messages.SCALARS`
    tools: Mapping[str, Tool]
    statistics: Mapping[str, float]
    vessels: Mapping[str, Vessel]  # empty without the channel `vessels`
    contacts: Mapping[str, Contact]  # by tool; empty without the channel `tool_contact`


@dataclass(frozen=True)
class _Header:
    kind: int
    flags: int
    session: int
    epoch: int
    sequence: int
    base: int
    tick: int
    time_s: float
    profile: int


def session_number(frame: bytes) -> int:
    """Returns the session number in the header of a frame, which identifies its stream."""
    return int.from_bytes(frame[12:16], "little")


def _sections(frame: bytes) -> tuple[_Header, Iterator[tuple[int, bytes]]]:
    if len(frame) < _HEAD.size:
        raise BadFrame("the bytes are shorter than the header of a frame")
    (magic, version, kind, flags, count, session, epoch, sequence, base, tick, time_s, _published, profile, sections,
     _reserved) = _HEAD.unpack_from(frame)
    if magic != b"CAUF" or version != WIRE_VERSION or count != len(frame):
        raise BadFrame("the bytes are not a frame of this version")

    def each() -> Iterator[tuple[int, bytes]]:
        at = _HEAD.size
        for _ in range(sections):
            number, length = frame[at], int.from_bytes(frame[at + 4:at + 8], "little")
            if at + 8 + length > len(frame):
                raise BadFrame("a section ends beyond the frame")
            yield number, frame[at + 8:at + 8 + length]
            at += 8 + length

    return _Header(kind, flags, session, epoch, sequence, base, tick, time_s, profile), each()


def _indices(runs: bytes, count: int, most: int) -> npt.NDArray[np.int64]:
    """Returns the indices of the elements in a run list, (count,)."""
    numbers, value, shift = [], 0, 0
    for byte in runs:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value)
            value = shift = 0
    skips, lengths = np.array(numbers[0::2], np.int64), np.array(numbers[1::2], np.int64)
    if len(skips) != len(lengths) or lengths.sum() != count or skips.sum() + count > most:
        raise BadFrame("the runs of a section do not add up to its count")
    return np.repeat(np.cumsum(skips), lengths) + np.arange(count)


def _numbers(data: bytes, count: int, width: int, components: int, coding: int) -> npt.NDArray[np.int64]:
    """Returns the numbers of a section, (count, components)."""
    kind = {1: "u1", 2: "<u2", 4: "<u4"}[width]
    if coding != _MESHOPT:
        return np.frombuffer(data, kind, count * components).reshape(count, components).astype(np.int64)
    packed = data[4:4 + int.from_bytes(data[:4], "little")]
    if components == 1:
        rows = decode_vertices(packed, -(-count * width // 4), 4)
        return rows.copy().reshape(-1).view(kind)[:count].reshape(count, 1).astype(np.int64)
    rows = decode_vertices(packed, count, width * components + 3 & ~3)
    return rows[:, :width * components].copy().view(kind).astype(np.int64)


def _wrap(values: npt.NDArray[np.int64]) -> npt.NDArray[np.int32]:
    """Wraps integers modulo 2^32."""
    return (values & 0xFFFFFFFF).astype(np.uint32).view(np.int32)


def _take_elements(payload: bytes, held: npt.NDArray[np.int32]) -> None:
    """Writes a section's elements into `held`, (N, components)."""
    width, components, coding, reference = payload[:4]
    count, run_bytes = struct.unpack_from("<II", payload, 4)
    if components != held.shape[1] or width not in (1, 2, 4):
        raise BadFrame("a section has the wrong number of components, or an unknown width")
    if count == 0:
        return
    indices = _indices(payload[12:12 + run_bytes], count, len(held))
    values = _numbers(payload[12 + (run_bytes + 3 & ~3):], count, width, components, coding)
    if reference in (_PREVIOUS, _HELD):
        balance = {1: 0x80, 2: 0x8080, 4: 0x80808080}[width]
        values = (values ^ balance) - balance
    if reference == _PREVIOUS:
        values = np.cumsum(values, axis=0)
    elif reference == _HELD:
        values = values + held[indices]
    held[indices] = _wrap(values)


class Stream:
    """The stream of a joined session. `wait` returns the state in a frame. `faces` and `rest` are constant.

    The thread of the client updates the state. All functions may be called from any thread.
    """

    def __init__(self, description: StreamDescription) -> None:
        self.description = description
        vertices, faces = description["vertex_count"], description["face_count"]
        self.faces = np.zeros((faces, 3), np.int32)  # vertices of each face
        self.face_layers = np.zeros(faces, np.int32)  # index of the layer of each face
        self.rest = np.zeros((vertices, 3))  # m
        self.texture: npt.NDArray[np.float32] | None = None  # (F, 3, 2): u, v of each corner
        self.skipped = 0  # number of deltas that did not continue the held state
        self._held = {
            SECTION["positions"]: np.zeros((vertices, 3), np.int32),
            SECTION["mask"]: np.zeros((-(-faces // 32), 1), np.int32),
            **{scalar.section: np.zeros((vertices, 1), np.int32) for scalar in SCALARS.values()}}
        self._header: _Header | None = None
        self._names: list[tuple[str, str]] = []
        self._tools: dict[str, Tool] = {}
        self._statistics: dict[str, float] = {}
        self._vessels: dict[str, Vessel] = {}
        self._contacts: dict[str, Contact] = {}
        self._changed = threading.Condition()
        self._over: Exception | None = None

    # ---- for users
    def wait(self, tick: int = 0, timeout_s: float = 30.0) -> State:
        """Returns the state of the first frame at `tick` or later. Raises NoAnswer, or what ended the connection."""
        end_s = time.monotonic() + timeout_s
        with self._changed:
            while self._header is None or self._header.tick < tick:
                if self._over:
                    raise self._over
                if not self._changed.wait(end_s - time.monotonic()) and time.monotonic() >= end_s:
                    raise NoAnswer(f"no frame of tick {tick} or later arrived within {timeout_s:g} s")
            return self._state(self._header)

    def next(self, after: int, timeout_s: float = 30.0) -> State:
        """Returns the state of the first frame after a tick."""
        return self.wait(after + 1, timeout_s)

    # ---- for the client
    def take(self, frame: bytes) -> str:
        """Decodes a frame. Returns "key", "delta" or "topology", or "skipped" if it does not continue the held state.

        After BadFrame no state is held until the next key frame.
        """
        with self._changed:
            try:
                return self._take(frame)
            except (IndexError, KeyError, OverflowError, ValueError, struct.error) as error:
                raise BadFrame(str(error)) from error

    def end(self, reason: Exception) -> None:
        """Ends the stream: `wait` raises `reason` from now on."""
        with self._changed:
            self._over = reason
            self._changed.notify_all()

    def place(self) -> tuple[str, int] | None:
        """Epoch and sequence of the last frame, as `stream.ack` has them."""
        with self._changed:
            return (f"{self._header.epoch:016x}", self._header.sequence) if self._header else None

    # ---- inside
    def _take(self, frame: bytes) -> str:
        header, sections = _sections(frame)
        if not self._applies(header):
            self.skipped += header.kind == FRAME_KIND["delta"]
            return "skipped"
        if header.kind == FRAME_KIND["topology"]:
            self._take_topology(dict(sections))
            return "topology"
        self._header = None
        if header.kind == FRAME_KIND["key"]:
            for held in self._held.values():
                held.fill(0)
            self._names = []
        for number, payload in sections:
            self._take_section(number, payload)
        self._header = header
        self._changed.notify_all()
        return "key" if header.kind == FRAME_KIND["key"] else "delta"

    def _applies(self, header: _Header) -> bool:
        if header.session != self.description["session_number"] or header.profile != self.description["profile"]:
            return False
        held = self._header
        if header.kind == FRAME_KIND["delta"]:
            return held is not None and (held.epoch, held.sequence) == (header.epoch, header.base)
        older = held is not None and held.epoch == header.epoch and header.sequence <= held.sequence
        return header.kind == FRAME_KIND["topology"] or not older

    def _metres(self, quantised: npt.NDArray[np.int32]) -> Floats:
        return np.asarray(self.description["origin_m"]) + self.description["step_m"] * quantised

    def _take_topology(self, sections: dict[int, bytes]) -> None:
        rest = np.zeros((len(self.rest), 3), np.int32)
        layers = np.zeros((len(self.faces), 1), np.int32)
        texture = np.zeros((len(self.faces), 6), np.int32)
        into = {SECTION["faces"]: self.faces, SECTION["face_layers"]: layers, SECTION["rest"]: rest,
                SECTION["texture"]: texture}
        for number, held in into.items():
            if number in sections:
                _take_elements(sections[number], held)
        self.face_layers = layers[:, 0]
        self.rest = self._metres(rest)
        if SECTION["texture"] in sections:
            self.texture = texture.view(np.float32).reshape(-1, 3, 2)

    def _take_section(self, number: int, payload: bytes) -> None:
        if number in self._held:
            _take_elements(payload, self._held[number])
        elif number == SECTION["tool_names"]:
            self._names = _tool_names(payload)
        elif number == SECTION["tools"]:
            self._tools = _tools(payload, self._names)
        elif number == SECTION["tool_power"]:
            self._tools = _with_power(payload, self._tools)
        elif number == SECTION["tool_force"]:
            self._tools = _with_raw_force(payload, self._tools)
        elif number == SECTION["vessels"]:
            self._vessels = _vessels(payload)
        elif number == SECTION["tool_contact"]:
            self._contacts = _contacts(payload)
        elif number == SECTION["statistics"]:
            self._statistics = _statistics(payload)

    def _scalar(self, name: str) -> Floats:
        scalar = SCALARS[name]
        step = scalar.step or self.description["stress_step_pa"]
        values: Floats = scalar.least + step * self._held[scalar.section][:, 0]
        return values

    def _state(self, header: _Header) -> State:
        bits = np.unpackbits(self._held[SECTION["mask"]].view(np.uint8).reshape(-1), bitorder="little")
        channels = self.description["channels"]
        return State(
            tick=header.tick, time_s=header.time_s, paused=bool(header.flags & _PAUSED),
            faulted=bool(header.flags & _FAULTED), positions=self._metres(self._held[SECTION["positions"]]),
            removed=bits[:len(self.faces)].astype(bool),
            scalars={name: self._scalar(name) for name in SCALARS if name in channels},
            tools=dict(self._tools), statistics=dict(self._statistics), vessels=dict(self._vessels),
            contacts=dict(self._contacts))


def _vessels(payload: bytes) -> dict[str, Vessel]:
    vessels, at = {}, 4
    for _ in range(int.from_bytes(payload[:4], "little")):
        length, flags, count = struct.unpack_from("<BBH", payload, at)
        radius, bleeding, shed, burst = struct.unpack_from("<4f", payload, at + 4)
        name = payload[at + 20:at + 20 + length].decode()
        at += 20 + -(-length // 4) * 4
        line = np.frombuffer(payload, "<f4", 4 * count, at).reshape(count, 4).astype(float)
        at += 16 * count
        vessels[name] = Vessel(name, *(bool(flags >> bit & 1) for bit in range(5)), radius, bleeding, shed, burst,
                               line[:, :3], line[:, 3])
    if at != len(payload):
        raise BadFrame("vessels of another length")
    return vessels


def _contacts(payload: bytes) -> dict[str, Contact]:
    contacts, at = {}, 4
    for _ in range(int.from_bytes(payload[:4], "little")):
        length, flags, count = struct.unpack_from("<BBH", payload, at)
        numbers = np.frombuffer(payload, "<f4", 29, at + 4).astype(float)
        name = payload[at + 120:at + 120 + length].decode()
        at += 120 + -(-length // 4) * 4
        planes = np.frombuffer(payload, "<f4", 5 * count, at).reshape(count, 5).astype(float)
        at += 20 * count
        xx, yy, zz, xy, xz, yz = numbers[17:23]
        contacts[name] = Contact(
            name, bool(flags & 1), numbers[0:3], numbers[3:7], numbers[7:10], numbers[10:14], numbers[14:17],
            np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), float(numbers[23]), float(numbers[24]),
            float(numbers[25]), numbers[26:29], planes[:, :3], planes[:, 3], planes[:, 4])
    if at != len(payload):
        raise BadFrame("the section of contacts has the wrong length")
    return contacts


def _tool_names(payload: bytes) -> list[tuple[str, str]]:
    names, at = [], 4
    for _ in range(int.from_bytes(payload[:4], "little")):
        shape, length = payload[at], payload[at + 1]
        word = TOOL_SHAPES[shape] if shape < len(TOOL_SHAPES) else str(shape)
        names.append((payload[at + 2:at + 2 + length].decode(), word))
        at += 2 + length
    return names


def _tools(payload: bytes, names: list[tuple[str, str]]) -> dict[str, Tool]:
    tools = {}
    for (name, shape), record in zip(names, np.frombuffer(payload, _TOOL, len(names))):
        flags, off = int(record["flags"]), int(record["energy_off"])
        tools[name] = Tool(
            name=name, shape=shape, position_m=record["position_m"].astype(float),
            rotation=record["rotation"].astype(float), jaw=float(record["jaw"]),
            force_n=record["force_n"].astype(float), torque_nm=record["torque_nm"].astype(float),
            tip_temperature_c=float(record["tip_temperature_c"]), energy_j=float(record["energy_j"]),
            driver=int(record["driver"]), energized=bool(flags & _ENERGIZED), grasping=bool(flags & _GRASPING),
            frozen=bool(flags & _FROZEN), slipping=bool(flags & _SLIPPING),
            energy_off=ENERGY_OFF_REASONS[off] if off < len(ENERGY_OFF_REASONS) else str(off),
            sequence=int(record["sequence"]))
    return tools


def _with_power(payload: bytes, tools: dict[str, Tool]) -> dict[str, Tool]:
    power = np.frombuffer(payload, "<f4", 2 * len(tools)).reshape(-1, 2)
    return {name: replace(tool, delivered_w=float(watts), load_ohm=float(ohm))
            for (name, tool), (watts, ohm) in zip(tools.items(), power)}


def _with_raw_force(payload: bytes, tools: dict[str, Tool]) -> dict[str, Tool]:
    rows = np.frombuffer(payload, "<f4", 7 * len(tools)).reshape(-1, 7).astype(float)
    return {name: replace(tool, raw_force_n=row[:3], raw_torque_nm=row[3:6], force_filter_s=float(row[6]))
            for (name, tool), row in zip(tools.items(), rows)}


def _statistics(payload: bytes) -> dict[str, float]:
    """Reads the statistics. Members that an older daemon does not send are 0."""
    record = np.frombuffer(payload[:_STATISTICS.itemsize].ljust(_STATISTICS.itemsize, b"\0"), _STATISTICS)[0]
    return {name: float(record[name]) for name in _STATISTICS.names or () if name != "stage_s"}
