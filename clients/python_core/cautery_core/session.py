# SPDX-License-Identifier: GPL-3.0-or-later
"""A session of tissue in this process."""

from __future__ import annotations

import ctypes
import json
import os
import threading
import weakref
from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from cautery.stream import Vessel

from . import layout
from .errors import CommandRefused, CoreError
from .library import core

Floats = npt.NDArray[np.float64]
_REST = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Layer:
    """A layer of the tissue. Its faces are `first_face` to `first_face + face_count`."""

    name: str
    kind: str
    first_face: int
    face_count: int
    element_count: int


@dataclass(frozen=True)
class Tool:
    """A tool after a step. Metres, newtons, radians; `rotation` is w, x, y, z."""

    name: str
    shape: str
    position_m: Floats  # (3,), of the tip; tissue can hold the tool back
    rotation: Floats  # (4,)
    jaw: float  # 0 closed to 1 open
    energized: bool
    grasping: bool  # jaws commanded closed
    slipping: bool
    grasped_vertices: int
    contact_vertices: int
    force_n: Floats  # (3,), of the tissue on the tool, filtered with sizes["force_filter_s"], at most force_max_n
    torque_nm: Floats  # (3,), about the tip, filtered as force_n
    raw_force_n: Floats  # (3,), of the last step, without filter and limit
    raw_torque_nm: Floats  # (3,)
    tip_temperature_c: float
    energy_j: float  # estimate of the heat that tissue took up
    power_w: float  # with energy `tissue`: power given to tissue in the last step
    load_ohm: float  # load of the generator; 0: no current flows
    slips: int  # number of times that the tool fell too far behind its commanded pose
    sizes: Mapping[str, float]  # numbers of the tool as in a scene, for example temperature_c


def _text(bytes_: bytes) -> str:
    return bytes_.decode("utf-8", "replace")


def _raised(error: layout.Error, kind: type[CoreError] = CoreError) -> CoreError:
    status = layout.STATUSES[error.status] if 0 <= error.status < len(layout.STATUSES) else str(error.status)
    return kind(status, _text(error.file), _text(error.path), _text(error.reason))


def _json(value: Any) -> bytes:
    """Returns the value as JSON. numpy arrays become lists."""
    try:
        return json.dumps(value, allow_nan=False, default=lambda array: array.tolist()).encode()
    except (AttributeError, RecursionError) as error:
        raise TypeError(f"the value cannot be written as JSON: {error}") from error


def _path(path: str | os.PathLike[str]) -> bytes:
    encoded = os.fsencode(path)
    if b"\0" in encoded:
        raise ValueError("the path contains a zero byte")
    return encoded


def _array(kind: type, address: int | None, *shape: int) -> npt.NDArray[Any]:
    """Returns a copy of the numbers at an address in the core."""
    made = np.empty(shape, np.dtype(kind))
    if made.size:
        ctypes.memmove(made.ctypes.data, address, made.nbytes)
    return made


def _sizes(definition: layout.ToolDef) -> dict[str, float]:
    return {name: getattr(definition, name) for name in layout.TOOL_SIZES}


def _tool(state: layout.ToolState) -> Tool:
    return Tool(
        name=_text(state.name), shape=layout.SHAPES[state.definition.shape],
        position_m=np.array(state.pose.position_m), rotation=np.array(state.pose.rotation), jaw=state.jaw,
        energized=state.energized, grasping=state.grasping, slipping=state.slipping,
        grasped_vertices=state.grasped_vertices, contact_vertices=state.contact_vertices,
        force_n=np.array(state.force_n), torque_nm=np.array(state.torque_nm),
        raw_force_n=np.array(state.raw_force_n), raw_torque_nm=np.array(state.raw_torque_nm),
        tip_temperature_c=state.tip_temperature_c, energy_j=state.energy_j, power_w=state.delivered_w,
        load_ohm=state.load_ohm, slips=state.slips,
        sizes=_sizes(state.definition))


def _vessel(state: layout.VesselState) -> Vessel:
    points = state.point[:state.point_count]
    return Vessel(_text(state.name), *(bool(state.flags >> bit & 1) for bit in range(5)), state.radius_m,
                  state.bleeding_m3_s, state.shed_m3, state.burst_pa,
                  np.array([list(one.position_m) for one in points], float).reshape(-1, 3),
                  np.array([one.open for one in points], float))


class Session:
    """A session of a scene: a file's path, or a dictionary with the members of a scene file.

        with Session("fascia.json") as session:
            session.move_tool("hook", [0, 0, 0])
            session.step(60)

    `directory` is the folder of the mesh files of a dictionary. `threads` is the number of threads of a step, 1 to 16;
    results do not depend on it. `instruction_set` is the highest instruction set to use ("baseline", "avx2", "avx512"),
    which gives equal bits on different machines. Arrays are copies. V vertices, F faces. Functions may be called from any
    thread. Calls on one session wait for each other; calls on different sessions do not. Functions raise CoreError, and
    ValueError after `close`.
    """

    def __init__(self, scene: str | os.PathLike[str] | Mapping[str, Any], *, directory: str | None = None,
                 threads: int = 1, command_capacity: int = 1024, instruction_set: str | None = None) -> None:
        if instruction_set not in (None, *layout.INSTRUCTION_SETS):
            raise ValueError(f"instruction_set {instruction_set!r} is not one of {', '.join(layout.INSTRUCTION_SETS)}")
        self._core = core()
        self._lock = threading.Lock()
        definition = self._core.cau_default_session_def()
        definition.thread_count, definition.command_capacity = threads, command_capacity
        definition.instruction_set = instruction_set.encode() if instruction_set else None
        pointer, error = ctypes.c_void_p(), layout.Error()
        if isinstance(scene, Mapping):
            text = _json(scene)
            status = self._core.cau_session_from_json(None, text, len(text), _path(directory) if directory else None,
                                                      definition, pointer, error)
        else:
            status = self._core.cau_session_from_file(_path(scene), definition, pointer, error)
        if status:
            raise _raised(error)
        self._pointer: int | None = pointer.value
        self._end = weakref.finalize(self, self._core.cau_session_destroy, pointer.value)
        self._end.atexit = False  # another thread may still be in a step when Python ends
        self._watched = 0
        self._describe()

    def _describe(self) -> None:
        """Reads what never changes in a session."""
        info = layout.SessionInfo()
        self._core.cau_session_describe(self._pointer, info)
        self.name, self.description, self.step_s = _text(info.name), _text(info.description), info.step_s
        self.vertex_count, self.face_count = info.vertex_count, info.face_count
        self.faces = _array(layout.INTS, info.face, info.face_count, 3)  # vertices of each face
        self.face_layers = _array(layout.INTS, info.face_layer, info.face_count)
        self.rest = _array(layout.DOUBLES, info.rest_position, info.vertex_count, 3)  # m
        self.tetrahedra = _array(layout.INTS, info.tetrahedron, info.tetrahedron_count, 4)
        self.links = _array(layout.INTS, info.link, info.link_count, 2)
        self.instruction_set = _text(info.instruction_set)
        self.layers = tuple(Layer(_text(one.name), layout.LAYER_KINDS[one.kind], one.first_face, one.face_count,
                                  one.element_count) for one in info.layers[:info.layer_count])

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the session, after any call of another thread has returned. A second call does nothing."""
        with self._lock:
            self._pointer = None
            self._end()

    def _opened(self) -> int:
        """Returns the session. The caller holds the lock."""
        if self._pointer is None:
            raise ValueError("the session is closed")
        return self._pointer

    def _frame(self) -> layout.Frame:
        """Returns a view of the present state. The caller holds the lock, and uses the view only meanwhile."""
        frame = layout.Frame()
        self._core.cau_session_frame(self._opened(), frame)
        return frame

    # ---- commands
    def submit(self, command: str, *, tick: int = 0, **members: Any) -> None:
        """Queues a command: `submit("tool.grasp", tool="grasper")`. It takes effect at the next tick, or at `tick`.

        The members are those of `cautery/command_json.h` and of the wire. If a command is refused at its tick,
        `step` raises CommandRefused.
        """
        text, error = _json({"command": command, "tick": tick, **members}), layout.Error()
        with self._lock:
            if self._core.cau_session_submit_json(self._opened(), text, len(text), error):
                raise _raised(error)

    def move_tool(self, tool: str, position_m: npt.ArrayLike, rotation: npt.ArrayLike = _REST, jaw: float = 0.0) -> None:
        """Sets the commanded pose: tip (3,), rotation w, x, y, z (4,), jaw 0 closed to 1 open."""
        self.submit("tool.move", tool=tool, position_m=np.asarray(position_m, float),
                    rotation=np.asarray(rotation, float), jaw=jaw)

    def energize(self, tool: str, energized: bool = True) -> None:
        """Turns the tool's energy on or off."""
        self.submit("tool.energize", tool=tool, energized=bool(energized))

    def grasp(self, tool: str) -> None:
        """Closes the jaws of the tool on the tissue between them."""
        self.submit("tool.grasp", tool=tool)

    def release(self, tool: str) -> None:
        """Opens the tool's jaws."""
        self.submit("tool.release", tool=tool)

    def configure_tool(self, tool: str, **changes: Any) -> None:
        """Changes members of the tool, such as temperature_c or shape. Other members keep their present values.

        With `instrument` (and `mode`) the tool becomes that instrument. Other members come from the profile, or are
        defaults.
        """
        states = self.tools
        if tool not in states:
            raise CoreError("not_found", "", "tool", f'there is no tool "{tool}"')
        if "instrument" in changes:
            self.submit("tool.configure", tool=tool, **changes)
            return
        self.submit("tool.configure", tool=tool, **{"shape": states[tool].shape, **states[tool].sizes, **changes})

    # ---- time
    def step(self, ticks: int = 1) -> int:
        """Computes `ticks` steps, and returns the tick that is reached.

        Raises CoreError ("numerical", "faulted") if the motion of the tissue is no longer sound: then call `restore`.
        Raises CommandRefused after the tick at which a command was refused.
        """
        for _ in range(ticks):
            self._step_once()
        return self.tick

    def _step_once(self) -> None:
        error = layout.Error()
        with self._lock:
            status = self._core.cau_session_step(self._opened(), error)
            frame = self._frame()
            refused = _raised(frame.refusals[0], CommandRefused) if frame.refusal_count else None
        if status:
            raise _raised(error)
        if refused:
            raise refused

    def set_threads(self, threads: int) -> None:
        """Sets the number of threads, 1 to 16, that steps use from now on. Results do not depend on it."""
        if not 1 <= threads <= 16:
            raise ValueError(f"{threads} threads: a session uses 1 to 16")
        with self._lock:
            self._core.cau_session_set_threads(self._opened(), threads)

    # ---- the present state
    @property
    def tick(self) -> int:
        """Number of steps since the beginning."""
        with self._lock:
            return int(self._frame().tick)

    @property
    def time_s(self) -> float:
        """Simulated time."""
        with self._lock:
            return float(self._frame().time_s)

    @property
    def positions(self) -> Floats:
        """Positions of the vertices, (V, 3), m."""
        return self.read_positions(np.empty((self.vertex_count, 3)))

    def read_positions(self, out: Floats) -> Floats:
        """Writes the positions into the array `out`, (V, 3) doubles in C order, and returns `out`."""
        shape = (self.vertex_count, 3)
        if not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != np.float64 \
                or not out.flags.c_contiguous or not out.flags.writeable:
            raise ValueError(f"positions need an array {shape} of doubles, contiguous in C's order and writeable")
        with self._lock:
            ctypes.memmove(out.ctypes.data, self._frame().position, out.nbytes)
        return out

    @property
    def velocities(self) -> Floats:
        """Velocities of the vertices, (V, 3), m/s."""
        with self._lock:
            return _array(layout.DOUBLES, self._frame().velocity, self.vertex_count, 3)

    @property
    def removed(self) -> npt.NDArray[np.bool_]:
        """Whether each face is not drawn, because it is removed or lies inside, (F,)."""
        with self._lock:
            words = _array(layout.WORDS, self._frame().face_mask, -(-self.face_count // 32))
        bits = np.unpackbits(words.astype("<u4").view(np.uint8), bitorder="little")
        return bits[:self.face_count].astype(bool)

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """Whether each vertex belongs to a drawn face, (V,)."""
        with self._lock:
            return _array(layout.BYTES, self._frame().vertex_visible, self.vertex_count).astype(bool)

    def scalar(self, name: str) -> npt.NDArray[np.float32]:
        """Returns a value of each vertex, (V,): "exposure", "charring", "stress" (Pa), "temperature" (degC) or "blood" (m).

        From the first call on, steps also compute stress, temperature or blood.
        """
        if name not in layout.SCALARS:
            raise ValueError(f"scalar {name!r} is not one of {', '.join(layout.SCALARS)}")
        with self._lock:
            pointer = self._opened()
            if not self._watched & layout.SCALARS[name]:
                self._watched |= layout.SCALARS[name]
                self._core.cau_session_watch(pointer, self._watched)
            return _array(layout.FLOATS, self._frame().scalar[list(layout.SCALARS).index(name)], self.vertex_count)

    @property
    def tools(self) -> dict[str, Tool]:
        """The tools by name."""
        with self._lock:
            frame = self._frame()
            states = [_tool(frame.tools[i]) for i in range(frame.tool_count)]
        return {tool.name: tool for tool in states}

    @property
    def vessels(self) -> dict[str, Vessel]:
        """The blood vessels by name, in the scene's order."""
        with self._lock:
            frame = self._frame()
            states = [_vessel(frame.vessels[i].contents) for i in range(frame.vessel_count)]
        return {vessel.name: vessel for vessel in states}

    @property
    def statistics(self) -> dict[str, float]:
        """Times, counts and errors of the last step, as in `cautery/session.h`.

        `long_inverted` is the sum over all layers.
        """
        with self._lock:
            statistics = self._frame().statistics
        numbers = {field[0]: getattr(statistics, field[0]) for field in layout.Statistics._fields_
                   if field[0] != "seconds"}
        return numbers | {"long_inverted": sum(numbers["long_inverted"])}

    # ---- snapshots
    def snapshot(self) -> bytes:
        """Returns the whole state with the queued commands."""
        count, error = ctypes.c_size_t(), layout.Error()
        with self._lock:
            pointer = self._opened()
            held = ctypes.create_string_buffer(self._core.cau_session_snapshot_bytes(pointer))
            if self._core.cau_session_snapshot(pointer, held, len(held), count, error):
                raise _raised(error)
            return held.raw[:count.value]

    def restore(self, snapshot: bytes) -> bool:
        """Restores a snapshot of a session of the same scene. Returns False if another build or instruction set wrote it:
        later steps may then differ in the last digits.

        Raises CoreError "corrupt" if the bytes are not a snapshot of this scene. Then the session does not change.
        """
        exact, error = ctypes.c_bool(), layout.Error()
        bytes_ = bytes(snapshot)
        with self._lock:
            status = self._core.cau_session_restore(self._opened(), bytes_, len(bytes_), exact, error)
        if status:
            raise _raised(error)
        return bool(exact.value)

    def hash(self) -> int:
        """Returns the hash of the whole state. Equal hashes mean equal bits."""
        with self._lock:
            return int(self._core.cau_session_hash(self._opened()))

    def share(self) -> int:
        """Shares memory with other sessions of equal tissue that called this. Returns the shared bytes."""
        with self._lock:
            return int(self._core.cau_session_share(self._opened()))
