# SPDX-License-Identifier: Apache-2.0
"""The messages of the wire.

Generated from protocol/include/cautery/*.def and the codec's tables; do not edit. After a change there,
build the target `messages`.
"""

# pylint: disable=too-many-lines,line-too-long
from __future__ import annotations

from typing import Any, Literal, Mapping, NamedTuple, NotRequired, Sequence, TypeAlias, TypedDict, Union

WIRE_VERSION = 1
SUBPROTOCOL = "cautery.v1"

# What a word of error.data.status is as error.code.
ERROR_CODES = {
    "bad_syntax": -32700,
    "invalid_request": -32600,
    "method_not_found": -32601,
    "bad_value": -32602,
    "internal": -32603,
    "bad_mesh": -32003,
    "bad_state": -32004,
    "not_found": -32005,
    "already_exists": -32006,
    "limit": -32007,
    "unsupported": -32008,
    "no_memory": -32009,
    "io": -32010,
    "numerical": -32011,
    "faulted": -32012,
    "corrupt": -32013,
    "not_here": -32040,
    "hello_required": -32041,
    "unauthorized": -32042,
    "forbidden": -32043,
    "version": -32044,
    "not_driver": -32045,
    "rate": -32046,
    "draining": -32047,
    "store_full": -32048,
    "sequence_past": -32049,
    "sequence_conflict": -32050,
    "moved": -32051,
}

# Codes with which a connection closes.
CLOSE_REASONS = {
    1000: "done",
    1001: "the server is shutting down",
    1002: "the WebSocket protocol was broken",
    1003: "a binary message that is no chunk of an upload",
    1007: "a text message that is not UTF-8",
    1009: "a message beyond the limit",
    1011: "the server met an error of its own",
    1013: "too many connections",
    4001: "no hello within 5 s",
    4002: "the token is missing or not known",
    4003: "no common version",
    4004: "frames were not read fast enough",
    4005: "too many messages a second",
    4006: "pings were not answered",
    4007: "another connection resumed this one",
    4008: "too many malformed messages",
}

FRAME_KIND = {"key": 1, "delta": 2, "topology": 3}

# Numbers of a frame's sections.
SECTION = {
    "positions": 1,
    "mask": 2,
    "exposure": 3,
    "charring": 4,
    "stress": 5,
    "tools": 7,
    "statistics": 8,
    "temperature": 9,
    "vessels": 10,
    "blood": 11,
    "tool_contact": 12,
    "tool_names": 6,
    "faces": 16,
    "face_layers": 17,
    "texture": 18,
    "rest": 19,
    "tools_asked": 32,
    "tool_jaws": 33,
    "tool_power": 34,
    "tool_force": 35,
}

# Words that frames have as numbers.
TOOL_SHAPES = (
    "sphere",
    "capsule",
    "hook",
    "spatula",
    "bipolar",
    "shears",
    "grasper",
)
ENERGY_OFF_REASONS = (
    "never_enabled",
    "commanded",
    "watchdog",
    "restored",
    "taken_over",
)

# Requests that take client_sequence: sent again they act once.
CHANGING_METHODS = frozenset({
    "session.create",
    "session.pause",
    "session.resume",
    "session.step",
    "session.speed",
    "session.reset",
    "session.destroy",
    "session.fork",
    "session.snapshot",
    "session.restore",
    "session.rewind",
    "tool.add",
    "tool.remove",
    "tool.configure",
    "tool.move",
    "tool.energize",
    "tool.grasp",
    "tool.release",
    "tool.hold",
    "tool.take_over",
    "tool.hand_over",
    "pin",
    "unpin",
    "material.set",
    "gravity.set",
    "force.set",
})

# Requests that the quotas of expensive requests count: they may take long.
EXPENSIVE_METHODS = frozenset({
    "session.create",
    "session.reset",
    "session.fork",
    "session.restore",
    "session.rewind",
    "session.export",
    "session.log",
    "session.frame_at",
    "mesh.read",
    "store.backup",
    "move.read",
})


class Scalar(NamedTuple):
    """A scalar of the vertices: n in a frame is least + step n in the unit, n is at most `most`.

    Step 0: the stream describes it, as `stress_step_pa`."""

    section: int
    least: float
    step: float
    most: int
    unit: str


SCALARS = {
    # the largest of the vertex's edges': heat taken up over what ignites it, 0 to 1
    "exposure": Scalar(3, 0, 0.00392156862745098, 255, "1"),
    # share of the vertex's edges that have parted, 0 to 1
    "charring": Scalar(4, 0, 0.00392156862745098, 255, "1"),
    # von Mises stress of fat, volume weighted
    "stress": Scalar(5, 0, 0, 65535, "Pa"),
    # what the tools' heat grids say at the vertex, elsewhere the scene's ambient_c
    "temperature": Scalar(9, -20, 0.25, 65535, "degC"),
    # depth of blood on the surface
    "blood": Scalar(11, 0, 2e-05, 255, "m"),
}


class Nothing(TypedDict):
    """no members"""


class Hello(TypedDict):
    """the first message on a connection"""

    # wire version wanted; this document is version 1 (1 to 1000)
    version: int

    # name and version of the client program, for logs and other users
    client: str

    # the client's own lasting identity, among those of its token's owner; names the stored answers of client_sequence
    client_id: NotRequired[str]

    # access token, where the server asks for one
    token: NotRequired[str]

    # token of an earlier hello: takes back the tools driven within 10 s of the loss, energy off
    resume: NotRequired[str]

    # role wanted; the token's by default and at most
    role: NotRequired[Literal["view", "operate", "admin"]]


class Limits(TypedDict):
    """what the server accepts; beyond it are errors or a close code"""

    # of a text message (1 to 9007199254740991 B)
    message_bytes_max: int

    # of one upload (0 to 9007199254740991 B)
    upload_bytes_max: int

    # of all uploads of the connection; one below 64 KiB counts for that (0 to 9007199254740991 B)
    uploads_bytes_max: NotRequired[int]

    # of data in one binary chunk (1 to 9007199254740991 B)
    chunk_bytes_max: int

    # sessions of the daemon (0 to 9007199254740991)
    sessions_max: int

    # connections of the daemon (0 to 9007199254740991)
    subscribers_max: int

    # different stream profiles of a session (1 to 4)
    profiles_max: int

    # streams of a connection (1 to 64)
    streams_max: NotRequired[int]

    # tools of a session (1 to 8)
    tools_max: int

    # requests of a connection (1 to 9007199254740991 1/s)
    requests_per_s_max: int

    # tool.move notifications of a connection (1 to 9007199254740991 1/s)
    motions_per_s_max: int

    # frames unsent before some are skipped (1 to 9007199254740991 B)
    bytes_in_flight_max: int

    # longest pause between a driver's messages before energy is cut (0.01 to 60 s)
    heartbeat_s: float


class HelloResult(TypedDict):
    """who the server is and what the client may do"""

    # name and version of the server
    server: str

    # wire version spoken from now on (1 to 1000)
    version: int

    # the daemon's label; session ids start with it
    daemon: str

    # role granted
    role: Literal["view", "operate", "admin"]

    # the connection's number: the driver number in frames (1 to 4294967295)
    client: int

    # as given, or one made up by the server
    client_id: str

    # token for a later hello
    resume: str

    # what this server can do
    capabilities: Sequence[Literal["upload", "export", "dds", "store"]]

    # limits of this connection
    limits: Limits

    # the server's monotonic clock, as in frames (0 to 9007199254740991 us)
    server_time_us: int

    # the server's wall clock since 1970 (0 to 1000000000000 s)
    wall_time_s: float


class Heartbeat(TypedDict):
    """sign of life of a driver; a notification, or a request to measure the clock"""

    # false: the page is hidden or blurred, energy is cut at once
    visible: bool

    # the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us)
    client_time_us: NotRequired[int]


class HeartbeatResult(TypedDict):
    """for the offset of the clocks"""

    # the server's monotonic clock (0 to 9007199254740991 us)
    server_time_us: int

    # as given (0 to 9007199254740991 us)
    client_time_us: NotRequired[int]


class SceneSummary(TypedDict):
    """a scene that sessions can be made from"""

    # its name
    name: str

    # in words
    description: str


class SceneList(TypedDict):
    """all of them"""

    # by name
    scenes: Sequence[SceneSummary]


class SceneRef(TypedDict):
    """names a scene"""

    # its name
    scene: str


class SceneResult(TypedDict):
    """a scene whole, to change and send back to session.create"""

    # every member, defaults too
    definition: Scene


class InstrumentMode(TypedDict):
    """how the generator of an instrument is set in a mode; the members are those of a tool"""

    # its name
    mode: str

    # in words
    description: str

    # power, where no other is named (0 to 400 W)
    power_w: float

    # least power that the mode has (0 to 400 W)
    power_least_w: float

    # most power that the mode has (0 to 400 W)
    power_most_w: float

    # most voltage, peak (1 to 10000 V)
    peak_v: float

    # of the voltage; its duty is 2 / crest_factor^2 (1.4 to 20)
    crest_factor: float

    # most current, root mean square (0.01 to 10 A)
    current_max_a: float

    # power ends when the load is so many times its least; 0: never (0 to 100)
    load_rise_off: float


class Instrument(TypedDict):
    """a profile of an instrument, which a tool of a scene, tool.add and tool.configure may name"""

    # its name
    name: str

    # in words
    description: str

    # shape of the tool
    shape: str

    # the first is the default
    modes: Sequence[InstrumentMode]


class InstrumentList(TypedDict):
    """all of them"""

    # by name
    instruments: Sequence[Instrument]


class SessionRef(TypedDict):
    """names a session"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]


class SessionChange(TypedDict):
    """names a session to change"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991)
    client_sequence: NotRequired[int]


class SessionSummary(TypedDict):
    """a session in a list"""

    # its id
    session: str

    # the scene it was made from
    scene: str

    # what it does
    state: Literal["starting", "running", "paused", "faulted"]

    # steps since creation, along the present branch (0 to 9007199254740991)
    tick: int

    # simulated (0 to 1000000000000 s)
    time_s: float

    # one tick (0.0001 to 1 s)
    step_s: float

    # simulated over wall time that is aimed at (0 to 100)
    speed: float

    # what is reached, over the last second (0 to 1000000)
    realtime_factor: float

    # vertices (0 to 16777216)
    vertex_count: int

    # faces, drawn and not (0 to 16777216)
    face_count: int

    # tools (0 to 8)
    tool_count: int

    # streams joined (0 to 9007199254740991)
    subscriber_count: int

    # of its frames; another after rewind, reset, restore and restart
    epoch: str

    # why it is faulted
    fault: NotRequired[str]

    # false: the session is ephemeral; or, in an answer to session.pause, the store was full, and the session pauses all the same
    stored: NotRequired[bool]

    # while it is starting or is rewound or restored: what the builder does (meshing, ordering, factoring, settling; reading, restoring, replaying)
    stage: NotRequired[str]


class SessionList(TypedDict):
    """all sessions of the daemon"""

    # by id
    sessions: Sequence[SessionSummary]


class SessionCreate(TypedDict):
    """makes a session from a scene of the daemon or from one given whole"""

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # wanted id, without the daemon's label; made up by default
    name: NotRequired[str]

    # a scene of the daemon; either this or definition
    scene: NotRequired[str]

    # the scene itself; meshes of source bytes name an upload in file
    definition: NotRequired[Scene]

    # starts paused; false by default
    paused: NotRequired[bool]

    # is never on a disk, and ends with its maker's connection or the daemon; false by default
    ephemeral: NotRequired[bool]


class LayerDescription(TypedDict):
    """a layer and its range in the face list"""

    # of the scene
    name: str

    # of tissue
    kind: Literal["fascia", "membrane", "fat", "links"]

    # index of its first face (0 to 16777216)
    first_face: int

    # faces; 0 for links (0 to 16777216)
    face_count: int

    # triangles, tetrahedra or links (0 to 16777216)
    element_count: int


class Driver(TypedDict):
    """who moves a tool"""

    # the tool
    tool: str

    # the driving connection's number; 0: no driver (0 to 4294967295)
    client: int

    # the client's name in its hello, or the DDS participant's
    name: str

    # whether its energy is on
    energized: bool

    # why it is off; meaningless while on
    energy_off: Literal["never_enabled", "commanded", "watchdog", "restored", "taken_over"]


class SessionDescription(TypedDict):
    """what a client must know of a session"""

    # as in the list
    summary: SessionSummary

    # of the scene, in words
    description: str

    # chosen by this machine; determinism holds within one
    instruction_set: str

    # of sheets (0 to 9007199254740991)
    triangle_count: int

    # of fat (0 to 9007199254740991)
    tetrahedron_count: int

    # trusses (0 to 9007199254740991)
    link_count: int

    # in the order of the scene
    layers: Sequence[LayerDescription]

    # one for each tool, in the order of frames
    drivers: Sequence[Driver]

    # the scene with its present materials, tools and gravity
    definition: Scene


class SessionStep(TypedDict):
    """advances a paused session"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # steps; 1 by default (1 to 100000)
    ticks: NotRequired[int]


class AdvanceCommand(TypedDict):
    """a command about a tool, before the first tick; it has the members of the method that it names"""

    # which
    method: Literal["tool.move", "tool.energize", "tool.grasp", "tool.release", "tool.hold"]

    # one that the client drives; to turn energy off, any
    tool: str

    # the driver's own count; frames show the last one applied (0 to 9007199254740991)
    sequence: NotRequired[int]

    # tool.move: place of the tip (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # tool.move: unit quaternion w, x, y, z (-1.001 to 1.001)
    rotation: NotRequired[Sequence[float]]

    # tool.move: 0 closed, the default, to 1 open (0 to 1)
    jaw: NotRequired[float]

    # tool.energize: on or off
    energized: NotRequired[bool]

    # tool.energize on: energy is off again after so many ticks; 0, the default: no limit (0 to 2147483647)
    ticks: NotRequired[int]


class ObservedRegion(TypedDict):
    """a box (least_m, most_m) or a ball (center_m, radius_m): the elements whose middle is in it while the tissue is at rest"""

    # given back
    name: str

    # the box's corner of its least coordinates (-100 to 100 m)
    least_m: NotRequired[Sequence[float]]

    # of its largest (-100 to 100 m)
    most_m: NotRequired[Sequence[float]]

    # the ball's middle (-100 to 100 m)
    center_m: NotRequired[Sequence[float]]

    # of the ball (0 to 100 m)
    radius_m: NotRequired[float]


class Observe(TypedDict):
    """what session.advance is to answer with, besides tick and time"""

    # positions, mask, tools, vessels, and scalars by their names; `statistics` is in frames alone
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # of positions and scalars: these alone, in this order; all by default (0 to 16777215)
    vertices: NotRequired[Sequence[int]]

    # where removed volume and damage are reported
    regions: NotRequired[Sequence[ObservedRegion]]

    # whether the energy of instruments is reported; false by default
    energy: NotRequired[bool]


class SessionAdvance(TypedDict):
    """makes ticks of a paused session in lock-step"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # how many; 1 by default, 0 to observe alone (0 to 100000)
    ticks: NotRequired[int]

    # commands about tools, before the first tick; if one is refused none acts, but energy is still turned off where one asks for it
    commands: NotRequired[Sequence[AdvanceCommand]]

    # nothing by default
    observe: NotRequired[Observe]


class ObservedScalar(TypedDict):
    """a scalar channel"""

    # which
    channel: Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]

    # of the vertices, in the channel's unit (-1e+300 to 1e+300)
    values: Sequence[float]


class ObservedTool(TypedDict):
    """a tool as it is"""

    # its name
    tool: str

    # of the tip: the actual pose, which tissue can stop (-1000000 to 1000000 m)
    position_m: Sequence[float]

    # quaternion w, x, y, z (-1.001 to 1.001)
    rotation: Sequence[float]

    # actual opening, 0 closed to 1 open (0 to 1)
    jaw: float

    # whether its energy is on
    energized: bool

    # while energy is off: why; of the session, not of the simulated state
    energy_off: NotRequired[Literal["never_enabled", "commanded", "watchdog", "restored", "taken_over"]]

    # of the tissue on the tool, filtered with the tool's `force_filter_s`; force_max_n at most (-1000000 to 1000000 N)
    force_n: Sequence[float]

    # about the tip, filtered as the force; force_max_n times tip_length_m at most (-1000000 to 1000000 N m)
    torque_nm: Sequence[float]

    # of the last tick, without filter and bound (-1000000000000 to 1000000000000 N)
    raw_force_n: Sequence[float]

    # about the tip, of the last tick, without filter and bound (-1000000000000 to 1000000000000 N m)
    raw_torque_nm: Sequence[float]

    # of the hot part (-300 to 1000000 degC)
    tip_temperature_c: float

    # heat that tissue has taken up, about (0 to 1000000000000 J)
    energy_j: float

    # with energy `tissue`: given to tissue in the last tick; else 0 (0 to 1000000 W)
    power_w: float

    # that its generator finds; 0: no current flows (0 to 1000000000000 ohm)
    load_ohm: float

    # vertices that it touches (0 to 9007199254740991)
    contact_vertices: int

    # points that its jaws hold (0 to 9007199254740991)
    grasped_vertices: int

    # of the last command applied (0 to 9007199254740991)
    sequence: int


class ObservedVessel(TypedDict):
    """a blood vessel as it is"""

    # its name
    vessel: str

    # whether it is parted somewhere
    parted: bool

    # whether its wall has a hole somewhere
    pierced: bool

    # whether it is pressed so flat somewhere that nothing flows
    shut: bool

    # whether a seal withstands the pressure of its blood
    sealed: bool

    # whether blood leaves it
    bleeds: bool

    # blood that left it in the last tick, by time (0 to 1 m^3/s)
    bleeding_m3_s: float

    # blood that has left it since the session began (0 to 1000000 m^3)
    shed_m3: float

    # predicted pressure at which its best seal opens; 0: no seal (0 to 1000000000000 Pa)
    burst_pa: float


class ObservedDamage(TypedDict):
    """what heat and force have done, in volumes of the tissue at rest; links have none"""

    # tetrahedra and triangles that are not there any more (0 to 9007199254740991)
    removed_count: int

    # their volume (0 to 1000000000 m^3)
    removed_m3: float

    # volume of those that are there, each weighted by the mean exposure of its vertices (0 to 1000000000 m^3)
    damaged_m3: float


class RegionDamage(TypedDict):
    """inside a region and outside it"""

    # the region's
    name: str

    # inside
    inside: ObservedDamage

    # outside
    outside: ObservedDamage


class ObservedEnergy(TypedDict):
    """where the energy of instruments went since the session was made; delivered_j and blade_j together are the sum of those after far_j; with energy `paper` all are 0"""

    # by current in tissue (-1000000000000 to 1000000000000 J)
    delivered_j: float

    # from blades into tissue; below 0: the other way (-1000000000000 to 1000000000000 J)
    blade_j: float

    # by current far away, where no heat is computed; not part of the sum (-1000000000000 to 1000000000000 J)
    far_j: float

    # heat of the tissue above its first temperature (-1000000000000 to 1000000000000 J)
    stored_j: float

    # taken along by water that boiled off, as steam and smoke (-1000000000000 to 1000000000000 J)
    boiled_j: float

    # taken along by blood (-1000000000000 to 1000000000000 J)
    perfused_j: float

    # lost at surfaces (-1000000000000 to 1000000000000 J)
    ambient_j: float

    # heat of tissue that was removed (-1000000000000 to 1000000000000 J)
    shed_j: float

    # volume of the tissue that is there and dead by heat (0 to 1000000000 m^3)
    coagulated_m3: float

    # water that boiled off in the last tick (0 to 1000000 kg/s)
    vapour_kg_s: float


class Advanced(TypedDict):
    """the ticks are made, and this is what was asked for"""

    # where the session is now (0 to 9007199254740991)
    tick: int

    # simulated (0 to 1000000000000 s)
    time_s: float

    # ticks that were made: fewer than asked for where lock-step ended meanwhile (0 to 100000)
    ticks: int

    # whether they are on the disk; false for ephemeral sessions
    stored: bool

    # x, y, z of the vertices (-1000000 to 1000000 m)
    positions_m: NotRequired[Sequence[float]]

    # words of 32 faces, the lowest bit first; a set bit: not drawn (0 to 4294967295)
    mask: NotRequired[Sequence[int]]

    # in the order of the channels
    scalars: NotRequired[Sequence[ObservedScalar]]

    # as they were added
    tools: NotRequired[Sequence[ObservedTool]]

    # in the scene's order
    vessels: NotRequired[Sequence[ObservedVessel]]

    # in the order of the request
    regions: NotRequired[Sequence[RegionDamage]]

    # of the whole session
    energy: NotRequired[ObservedEnergy]


class SessionSpeed(TypedDict):
    """sets the pace"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # simulated over wall time to aim at (0.01 to 10)
    speed: float


class SessionFork(TypedDict):
    """makes a new session from this one's state"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # wanted id of the new one, without the daemon's label; made up by default
    name: NotRequired[str]

    # of the state; the present one by default (0 to 9007199254740991)
    tick: NotRequired[int]

    # the new session starts paused; false by default
    paused: NotRequired[bool]


class SessionSnapshot(TypedDict):
    """stores the state under a name"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # made up by default
    name: NotRequired[str]


class SnapshotResult(TypedDict):
    """a stored state"""

    # for session.restore
    name: str

    # of the state (0 to 9007199254740991)
    tick: int

    # of the whole state
    hash: str

    # stored for it; 0: an earlier checkpoint and the log lead there (0 to 9007199254740991 B)
    byte_count: int


class NamedSnapshot(TypedDict):
    """a state with a name"""

    # for session.restore
    name: str

    # of the state (0 to 9007199254740991)
    tick: int

    # number of the branch that it was taken on (0 to 9007199254740991)
    branch: int


class SnapshotList(TypedDict):
    """the session's states with a name"""

    # by tick
    snapshots: Sequence[NamedSnapshot]


class SessionRestore(TypedDict):
    """restores a snapshot, energy off; a new branch"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # of the snapshot
    name: str


class SessionRewind(TypedDict):
    """rewinds to a tick, energy off; a new branch"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the timeline's oldest_tick or later, or what a refusal names (0 to 9007199254740991)
    tick: int


class Restored(TypedDict):
    """where a session is after a rewind, restore or reset"""

    # of the state (0 to 9007199254740991)
    tick: int

    # of the frames from now on
    epoch: str

    # number of the branch in the store (0 to 9007199254740991)
    branch: int

    # false: written by another build or instruction set, so not bit-exact
    exact: bool


class SessionExport(TypedDict):
    """asks for the tissue as a file"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # of the file
    format: Literal["vtu", "obj"]


class SessionLog(TypedDict):
    """asks for the command log as a script for cautery-sim"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # first tick; 0 by default (0 to 9007199254740991)
    from_tick: NotRequired[int]

    # last tick; the present one by default (0 to 9007199254740991)
    to_tick: NotRequired[int]


class Transfer(TypedDict):
    """a file that follows in binary chunks"""

    # number in the chunks' headers (1 to 4294967295)
    transfer: int

    # proposed
    file_name: str

    # of the file
    media_type: str

    # of the file (0 to 9007199254740991 B)
    byte_count: int

    # of the file, 64 lower-case hex digits
    sha256: str


class SessionTimeline(TypedDict):
    """asks for what happened"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # first tick; 0 by default (0 to 9007199254740991)
    from_tick: NotRequired[int]

    # newest events wanted at most; 1024 by default (1 to 4096)
    count: NotRequired[int]


class TimelineEvent(TypedDict):
    """something that happened on the present branch"""

    # when (0 to 9007199254740991)
    tick: int

    # simulated (0 to 1000000000000 s)
    time_s: float

    # what
    kind: Literal["created", "cut", "tear", "inverted", "energy_gain", "bleeding", "bleeding_stopped", "sealed", "energy_on", "energy_off", "watchdog", "driver", "tool_added", "tool_removed", "refused", "fault", "rewind", "reset", "snapshot", "restore"]

    # with which tool
    tool: NotRequired[str]

    # by whom
    client: NotRequired[str]

    # cut: elements removed; refused: commands (0 to 9007199254740991)
    count: NotRequired[int]

    # in words
    detail: NotRequired[str]


class Timeline(TypedDict):
    """what happened, and how far back one can go"""

    # the present (0 to 9007199254740991)
    tick: int

    # from here on every tick can be reached (0 to 9007199254740991)
    oldest_tick: int

    # number of the present branch (0 to 9007199254740991)
    branch: int

    # oldest first; cuts within 30 ticks are one
    events: Sequence[TimelineEvent]


class TickResult(TypedDict):
    """when a change takes effect"""

    # the tick border (0 to 9007199254740991)
    tick: int


class SessionFrameAt(TypedDict):
    """asks what a session looked like; it goes on meanwhile, and nothing of it changes"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # on the present line, from oldest_tick to the present (0 to 9007199254740991)
    tick: int

    # by default those that the table of channels marks
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # quantisation; 5e-5 by default (1e-07 to 0.001 m)
    step_m: NotRequired[float]

    # no section of the frame is in meshoptimizer's codec; false by default
    plain: NotRequired[bool]


class PastFrame(TypedDict):
    """one key frame that follows in binary chunks, and what a decoder needs beside the session's topology; its tools have no drivers"""

    # number in the chunks' headers (1 to 4294967295)
    transfer: int

    # proposed
    file_name: str

    # of the file
    media_type: str

    # of the frame (0 to 9007199254740991 B)
    byte_count: int

    # of the frame, 64 lower-case hex digits
    sha256: str

    # what it shows (0 to 9007199254740991)
    tick: int

    # to the bit what was; false: replayed by another build or instruction set
    exact: bool

    # in the frame's header (0 to 4294967295)
    session_number: int

    # in the frame's header (0 to 3)
    profile: int

    # in the frame's header; that of no stream
    epoch: str

    # in the frame
    channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]

    # of positions and scalars (0 to 16777216)
    vertex_count: int

    # of the mask (0 to 16777216)
    face_count: int

    # where the quantised zero is (-1000000 to 1000000 m)
    origin_m: Sequence[float]

    # one quantised step (1e-07 to 0.01 m)
    step_m: float

    # one step of the stress channel (0.001 to 1000000000 Pa)
    stress_step_pa: float


class FrameProgress(TypedDict):
    """how far a past view is"""

    # its id
    session: str

    # where it goes (0 to 9007199254740991)
    tick: int

    # what it does
    stage: Literal["building", "reading", "restoring", "replaying"]

    # where the replay began (0 to 9007199254740991)
    from_tick: int

    # where it is (0 to 9007199254740991)
    at_tick: int


class StoreBackup(TypedDict):
    """has the daemon copy its store"""

    # of the copy, without .db; by default the time. Nothing is replaced
    name: NotRequired[str]


class StoreCopy(TypedDict):
    """a copy of the store as it was at one moment, checked"""

    # where it is, on the daemon's machine
    file: str

    # its size (0 to 9007199254740991 B)
    byte_count: int


class MoveBegin(TypedDict):
    """a session is to go to another daemon"""

    # its id
    session: str

    # its id there
    target: str

    # of the daemon that is to have it
    label: str

    # where that daemon is, for who asks for the old id; none where one address leads to all
    url: NotRequired[str]


class MoveBegun(TypedDict):
    """a move has begun"""

    # names it from here on
    move: str


class MoveRef(TypedDict):
    """names a move"""

    # its id on the daemon that is asked
    session: str

    # of move.begin
    move: str


class MoveHeld(TypedDict):
    """a state that a session stands at"""

    # when (0 to 9007199254740991)
    tick: int

    # of the state
    hash: str

    # another daemon's state was read here to the bit; false: another build or instruction set wrote it, and what follows may differ in last digits
    exact: NotRequired[bool]


class MoveDecision(TypedDict):
    """what became of a move"""

    # false: the session stays, and this move will never be
    moved: bool

    # its id there
    target: NotRequired[str]

    # lets the other daemon serve it
    proof: NotRequired[str]

    # where it stays: lets the other daemon forget the move
    release: NotRequired[str]


class MoveReceive(TypedDict):
    """a piece of a session"""

    # its id here
    session: str

    # of move.begin
    move: str

    # that holds the piece; it is gone with this
    upload: str


class MoveReceived(TypedDict):
    """a piece is on the disk"""

    # that are (0 to 9007199254740991)
    pieces: int

    # of the last piece: proves to the other daemon that all are here
    receipt: NotRequired[str]


class MoveCommit(TypedDict):
    """the other daemon has all pieces of a session"""

    # its id here
    session: str

    # of move.begin
    move: str

    # of the other daemon's last move.receive
    receipt: str


class MoveForget(TypedDict):
    """the pieces of a move are to be removed"""

    # its id here
    session: str

    # of move.begin
    move: str

    # of move.cancel
    release: NotRequired[str]

    # instead of a release: the other daemon is gone for good. If it had decided the move, the session is lost
    source_lost: NotRequired[bool]


class MoveAccept(TypedDict):
    """a session is to be served here"""

    # its id here
    session: str

    # of move.begin
    move: str

    # of move.commit
    proof: str


class MoveEntry(TypedDict):
    """a move, as this daemon knows it"""

    # its id here
    session: str

    # of move.begin
    move: str

    # its id on the other daemon
    other: str

    # leaving, held, deciding, gone; incoming, doubt (all is here, and whether it is to be served is known to the other daemon), accepting
    state: str

    # gone: where the other daemon is, as it was said
    url: NotRequired[str]


class MoveList(TypedDict):
    """moves of this daemon's sessions"""

    # those that are not over first, then what has gone
    moves: Sequence[MoveEntry]


class WaitingCommand(TypedDict):
    """a command that waits for a later tick"""

    # its own, for session.cancel (1 to 9007199254740991)
    number: int

    # when it acts (1 to 9007199254740991)
    tick: int

    # what it is, as tool.move
    method: str

    # the tool that it is about
    tool: NotRequired[str]

    # the driver's own count (0 to 9007199254740991)
    sequence: int

    # the client that asked for it (1 to 4294967295)
    client: int

    # that client's name
    name: str


class WaitingList(TypedDict):
    """the commands of a session that wait for later ticks"""

    # in the order in which they came; at most 64 of a client
    commands: Sequence[WaitingCommand]


class SessionCancel(TypedDict):
    """takes back commands that wait for later ticks"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # the command's, of session.waiting; without it all of the caller's (1 to 9007199254740991)
    number: NotRequired[int]


class Cancelled(TypedDict):
    """what was taken back"""

    # commands (0 to 9007199254740991)
    count: int


class SessionJoin(TypedDict):
    """asks for frames"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # frames a wall second at most; 60 by default (0.1 to 1000 1/s)
    rate_hz: NotRequired[float]

    # by default those that the table of channels marks
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # quantisation wanted; the server may choose a finer one; 5e-5 by default (1e-07 to 0.001 m)
    step_m: NotRequired[float]

    # no section of the frames is in meshoptimizer's codec; false by default
    plain: NotRequired[bool]


class StreamDescription(TypedDict):
    """what a decoder needs; a topology frame and a key frame follow"""

    # its id
    session: str

    # in the frames' headers (0 to 4294967295)
    session_number: int

    # in the frames' headers (0 to 3)
    profile: int

    # at the time of joining
    epoch: str

    # granted (0.1 to 1000 1/s)
    rate_hz: float

    # granted
    channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]

    # of positions and scalars (0 to 16777216)
    vertex_count: int

    # of mask and topology (0 to 16777216)
    face_count: int

    # where the quantised zero is (-1000000 to 1000000 m)
    origin_m: Sequence[float]

    # one quantised step (1e-07 to 0.01 m)
    step_m: float

    # one step of the stress channel (0.001 to 1000000000 Pa)
    stress_step_pa: float

    # no section of its frames is in meshoptimizer's codec; absent from older servers
    plain: NotRequired[bool]


class StreamAck(TypedDict):
    """how far the client has decoded; bounds what is in flight, shows delays"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # of the frame
    epoch: str

    # of the frame (0 to 9007199254740991)
    sequence: int


class ToolRef(TypedDict):
    """names a tool of a session"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # its name
    tool: str


class ToolHandOver(TypedDict):
    """gives a tool up"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # its name
    tool: str

    # to this connection; by default the tool has no driver (1 to 4294967295)
    client: NotRequired[int]


class CommandResult(TypedDict):
    """a command is in the log"""

    # the tick border at which it takes effect (0 to 9007199254740991)
    tick: int

    # as given (0 to 9007199254740991)
    sequence: int

    # false: the store was full; energy is off all the same
    stored: NotRequired[bool]


class UploadBegin(TypedDict):
    """announces a mesh file; takes the place of an upload of the same name, whole or not"""

    # for scenes: meshes[].file of source bytes, with file_name's ending
    name: str

    # for messages and the names of sessions; the format is found from the bytes
    file_name: str

    # of the file, exactly (1 to 9007199254740991 B)
    byte_count: int


class UploadBeginResult(TypedDict):
    """chunks may come"""

    # number for the chunks' headers (1 to 4294967295)
    transfer: int

    # of data in one chunk (1 to 9007199254740991 B)
    chunk_bytes_max: int


class UploadEnd(TypedDict):
    """all chunks are sent"""

    # as upload.begin answered (1 to 4294967295)
    transfer: int

    # of the file, 64 lower-case hex digits
    sha256: str


# an upload is a mesh to report on
MeshRead = TypedDict("MeshRead", {
    # as in upload.begin; whole
    "upload": str,

    # metres in one unit of the file; guessed by default where it is clear (1e-09 to 1000 m)
    "unit_m": NotRequired[float],

    # fat (tetrahedra) or fascia (triangles); by default fat where there are tetrahedra, or an inside
    "as": NotRequired[Literal["fascia", "membrane", "fat", "links"]],

    # refuses a mesh that would have to be mended; false by default
    "strict": NotRequired[bool],

    # never fills the mesh with tetrahedra, for a scene of one's own; false by default
    "as_it_is": NotRequired[bool],

    # length of an edge of the tetrahedra that fill it; about 8,000 of them by default (1e-06 to 10 m)
    "edge_m": NotRequired[float],

    # of a segmentation: labels to keep, as in 1,3; all by default
    "labels": NotRequired[str],

    # sides that are pinned: bottom, top, left, right, front, back, with commas, or none; the bottom by default
    "pin": NotRequired[str],
})


class MeshKind(TypedDict):
    """elements of one kind in the file"""

    # the kind: hexahedra
    name: str

    # became elements of the mesh (0 to 9007199254740991)
    read: int

    # were passed over (0 to 9007199254740991)
    passed: int


class MeshMend(TypedDict):
    """something that was mended"""

    # in words: duplicate vertices merged
    what: str

    # how many (1 to 9007199254740991)
    count: int


class MeshRegion(TypedDict):
    """a region of the mesh"""

    # 2: of triangles, 3: of tetrahedra (2 to 3)
    dimension: int

    # its number, as layers name it (-2147483648 to 2147483647)
    region: int

    # elements (0 to 9007199254740991)
    element_count: int

    # of the file, or empty
    name: str


class MeshReport(TypedDict):
    """what became of a mesh file"""

    # the whole report in words, one fact a line
    text: str

    # Gmsh 4.1
    format: str

    # vertices in the file (0 to 9007199254740991)
    vertices_read: int

    # elements in the file
    kinds: Sequence[MeshKind]

    # what was mended
    mended: Sequence[MeshMend]

    # vertices of the mesh (0 to 9007199254740991)
    vertex_count: int

    # triangles (0 to 9007199254740991)
    triangle_count: int

    # tetrahedra (0 to 9007199254740991)
    tetrahedron_count: int

    # connected pieces (0 to 9007199254740991)
    component_count: int

    # edges on the rim of a surface without tetrahedra; 0: closed (0 to 9007199254740991)
    open_edge_count: int

    # the first regions
    regions: Sequence[MeshRegion]

    # of all regions (0 to 9007199254740991)
    region_count: int

    # corner of the bounding box (-1000000 to 1000000 m)
    least_m: Sequence[float]

    # the opposite corner (-1000000 to 1000000 m)
    most_m: Sequence[float]

    # metres in one unit of the file, as used (1e-09 to 1000 m)
    unit_m: float

    # elements by quality in tenths from 0 to 1 (mean ratio) (0 to 9007199254740991)
    quality: Sequence[float]

    # of all elements (0 to 1)
    least_quality: float


class MeshReading(TypedDict):
    """a mesh that was read"""

    # what became of the file
    report: MeshReport

    # a scene around the upload, for session.create
    definition: Scene

    # a choice that the user has: the surface was filled
    note: NotRequired[str]


class UploadDiscard(TypedDict):
    """an upload is not needed any more"""

    # as in upload.begin; it may be whole or still coming
    name: str


class UploadResult(TypedDict):
    """the file is kept until it is discarded, another takes its name, or the connection closes"""

    # as given
    name: str

    # what a mesh of source bytes says in file
    file: str

    # received (0 to 9007199254740991 B)
    byte_count: int


class SessionChanged(TypedDict):
    """a session is no longer as it was"""

    # why
    change: Literal["created", "destroyed", "paused", "resumed", "stepped", "speed", "reset", "rewound", "restored", "restarted", "moved", "tools", "tissue"]

    # as it is now
    summary: SessionSummary

    # who did it
    client: NotRequired[str]

    # moved: the address of the daemon that has it now, if it is another
    target: NotRequired[str]

    # moved: its id there
    moved_to: NotRequired[str]


class SessionFaulted(TypedDict):
    """the simulation met numerical trouble; rewind or reset"""

    # its id
    session: str

    # when (0 to 9007199254740991)
    tick: int

    # in words
    reason: str


class DriverChanged(TypedDict):
    """a tool has another driver or lost its energy"""

    # its id
    session: str

    # as it is now
    driver: Driver


class ToolRefused(TypedDict):
    """commands to a tool were refused; sent at most once a second and tool"""

    # its id
    session: str

    # the tool
    tool: str

    # refused since the last such message (1 to 9007199254740991)
    count: int

    # of the last one (0 to 9007199254740991)
    sequence: int

    # why the last one was refused: a status of the error table
    status: str

    # its offending member
    path: NotRequired[str]

    # in words
    reason: str


class TakeoverRequested(TypedDict):
    """another client asks the driver for a tool; answer with tool.hand_over or not at all"""

    # its id
    session: str

    # the tool
    tool: str

    # who asks (1 to 4294967295)
    client: int

    # the client's name in its hello
    name: str


class EventNotice(TypedDict):
    """something happened, as it will stand in the timeline"""

    # its id
    session: str

    # what
    event: TimelineEvent


class Mesh(TypedDict):
    """a mesh of a scene"""

    # where the mesh comes from
    source: Literal["sheet", "slab", "pattern", "file", "bytes"]

    # name of the mesh
    name: str

    # extent, centred in x and y, top at z = 0 (1e-06 to 10 m)
    size_m: NotRequired[Sequence[float]]

    # cells along each axis; of a pattern, triangles of the fan, 3 at least (1 to 1000)
    cells: NotRequired[Sequence[int]]

    # turns the UV axes against the mesh's axes (-6.3 to 6.3 rad)
    texture_turn_rad: NotRequired[float]

    # a mesh file, relative to the scene file
    file: NotRequired[str]

    # metres in one unit of the file (1e-09 to 1000 m)
    unit_m: NotRequired[float]

    # 1: refuses a mesh that would have to be mended (0 to 1)
    strict: NotRequired[int]

    # moves the mesh, after the unit (-100 to 100 m)
    translate_m: NotRequired[Sequence[float]]


class Selection(TypedDict):
    """a choice of vertices by rest position"""

    # which vertices
    kind: Literal["rim", "box", "sphere", "nearest"]

    # only of this layer; any if absent
    layer: NotRequired[str]

    # least corner of the box (-100 to 100 m)
    least_m: NotRequired[Sequence[float]]

    # largest corner (-100 to 100 m)
    most_m: NotRequired[Sequence[float]]

    # centre of the sphere, or the place (-100 to 100 m)
    center_m: NotRequired[Sequence[float]]

    # radius of the sphere (0 to 100 m)
    radius_m: NotRequired[float]


class Tool(TypedDict):
    """a tool of a scene"""

    # name of the tool
    name: str

    # profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none
    instrument: NotRequired[str]

    # mode of the instrument; its first by default
    mode: NotRequired[str]

    # shape
    shape: NotRequired[Literal["sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper"]]

    # radius of the hot part (0.0002 to 0.05 m)
    hot_radius_m: NotRequired[float]

    # length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
    tip_length_m: NotRequired[float]

    # radius of the shaft (0.0002 to 0.05 m)
    shaft_radius_m: NotRequired[float]

    # length of the shaft (0.001 to 1 m)
    shaft_length_m: NotRequired[float]

    # angle between open jaws (0.05 to 1.5 rad)
    jaw_open_rad: NotRequired[float]

    # temperature of the hot part while energized (0 to 1500 degC)
    temperature_c: NotRequired[float]

    # nodes of the heat grid along each axis (8 to 64)
    grid_cells: NotRequired[float]

    # spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # alpha of eq. 18 (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # faster commands are followed at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # fastest turning of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # of the attachment of one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # an attached vertex slips above this force (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # the tool pushes with this at most; drivers read it (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # its jaws press what they hold with this at most (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power that is set, with energy `tissue` (0 to 400 W)
    power_w: NotRequired[float]

    # most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # of the voltage: its peak over its root mean square (1.4 to 20)
    crest_factor: NotRequired[float]

    # most current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of its filtered force; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # first place of the tip (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # unit quaternion w, x, y, z: tool frame (shaft along +z) to world
    rotation: NotRequired[Sequence[float]]


class VesselPoint(TypedDict):
    """a point of the middle line of a vessel"""

    # a place of the line, at rest (-100 to 100 m)
    at_m: Sequence[float]


class Vessel(TypedDict):
    """a blood vessel in a layer of fat"""

    # name of the vessel
    name: str

    # layer of fat in which it lies
    layer: str

    # outer radius of the tube (0.0001 to 0.01 m)
    radius_m: NotRequired[float]

    # thickness of its wall; less than the radius (1e-05 to 0.005 m)
    wall_m: NotRequired[float]

    # of the blood, at its first point (0 to 40000 Pa)
    pressure_pa: NotRequired[float]

    # of the blood that comes back, at its last point (0 to 40000 Pa)
    end_pressure_pa: NotRequired[float]

    # length of such a tube that blood has come through (0.001 to 10 m)
    supply_m: NotRequired[float]

    # its middle line
    points: NotRequired[Sequence[VesselPoint]]


class Pull(TypedDict):
    """a scripted pull, for measurements"""

    # way of the chosen vertices (-1 to 1 m)
    move_m: NotRequired[Sequence[float]]

    # time of the way (0.001 to 3600 s)
    duration_s: NotRequired[float]

    # vertices that are pulled
    selection: Selection


class Cut(TypedDict):
    """a scripted cut, for measurements"""

    # tool of the scene
    tool: str

    # where the tip dwells (-100 to 100 m)
    from_m: Sequence[float]

    # where it is drawn to (-100 to 100 m)
    to_m: Sequence[float]

    # unit quaternion w, x, y, z of the tool
    rotation: NotRequired[Sequence[float]]

    # time before it is drawn (0 to 3600 s)
    dwell_s: NotRequired[float]

    # speed of drawing (1e-05 to 1 m/s)
    speed_m_s: NotRequired[float]


# a layer of tissue
Layer: TypeAlias = Union["FasciaLayer", "MembraneLayer", "FatLayer", "LinksLayer"]


class FasciaRegion(TypedDict):
    """what differs from the layer's material in a region"""

    # of the mesh file (0 to 2147483647)
    region: int

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class FasciaLayer(TypedDict):
    """a layer of this kind, with its material"""

    # tissue
    kind: Literal["fascia"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: what heat and current find in it
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # what differs in regions of the mesh file
    regions: NotRequired[Sequence[FasciaRegion]]


class MembraneRegion(TypedDict):
    """what differs from the layer's material in a region"""

    # of the mesh file (0 to 2147483647)
    region: int

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MembraneLayer(TypedDict):
    """a layer of this kind, with its material"""

    # tissue
    kind: Literal["membrane"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # membrane: the fat whose boundary it is; links: the upper layer
    of: NotRequired[str]

    # material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: what heat and current find in it
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # what differs in regions of the mesh file
    regions: NotRequired[Sequence[MembraneRegion]]


class FatRegion(TypedDict):
    """what differs from the layer's material in a region"""

    # of the mesh file (0 to 2147483647)
    region: int

    # elastic energy
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10)
    yield_strain: NotRequired[float]

    # gamma_2; 0: no plasticity (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class FatLayer(TypedDict):
    """a layer of this kind, with its material"""

    # tissue
    kind: Literal["fat"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: what heat and current find in it
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # elastic energy
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10)
    yield_strain: NotRequired[float]

    # gamma_2; 0: no plasticity (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # what differs in regions of the mesh file
    regions: NotRequired[Sequence[FatRegion]]


class LinksLayer(TypedDict):
    """a layer of this kind, with its material"""

    # tissue
    kind: Literal["links"]

    # name of the layer
    name: str

    # membrane: the fat whose boundary it is; links: the upper layer
    of: NotRequired[str]

    # the lower layer
    to: NotRequired[str]

    # with energy `tissue`: what heat and current find in it
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # Young's modulus of a truss (1 to 100000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # cross section of a truss (1e-12 to 1 m^2)
    area_m2: NotRequired[float]

    # longest truss (1e-06 to 1 m)
    reach_m: NotRequired[float]

    # trusses from each vertex of the upper sheet (1 to 8)
    per_vertex: NotRequired[float]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class Scene(TypedDict):
    """the plain data from which a session is made"""

    # name of the scene
    name: str

    # a sentence for people
    description: NotRequired[str]

    # time step; one tick (0.001 to 0.03333333333333333 s)
    step_s: NotRequired[float]

    # v <- v exp(-c dt) (0 to 1000 1/s)
    damping_per_s: NotRequired[float]

    # temperature of the body around the tools (-20 to 60 degC)
    ambient_c: NotRequired[float]

    # stop a step at this relative residual; 0: never (0 to 1)
    tolerance: NotRequired[float]

    # end a step at this error relative to its motion; 0: never (0 to 1)
    accuracy: NotRequired[float]

    # tissue keeps this far from tissue; 0: it crosses (0 to 0.01 m)
    contact_thickness_m: NotRequired[float]

    # of tissue on tissue (0 to 2)
    contact_friction: NotRequired[float]

    # side of the cells of heat, with energy `tissue` (0.0001 to 0.005 m)
    cell_m: NotRequired[float]

    # iterations of a step at most (small tissue: up to 64); with `accuracy` 0, of each (1 to 1000)
    iterations: NotRequired[int]

    # global system; `newton`: and Newton's method for all sheets
    solver: NotRequired[Literal["cholesky", "diagonal", "newton"]]

    # of the local and global steps
    precision: NotRequired[Literal["single", "double"]]

    # how a tick advances motion: `euler` damps by the step; `sdirk2`, of second order, keeps 0.997 of a 5 Hz swing a period at 60 steps/s, for two solves a tick
    integrator: NotRequired[Literal["euler", "sdirk2"]]

    # what heat parts: edges with all that share them, as in the paper, or elements one by one, so that a cut does not depend on the mesh
    parting: NotRequired[Literal["edges", "elements"]]

    # what an energized tool does: `paper` holds a temperature; `tissue` gives power, boils water and parts elements, and needs parting `elements`
    energy: NotRequired[Literal["paper", "tissue"]]

    # of everything drawn at random (0 to 9007199254740991)
    seed: NotRequired[int]

    # gravity (-100 to 100 m/s^2)
    gravity_m_s2: NotRequired[Sequence[float]]

    # meshes that layers take
    meshes: NotRequired[Sequence[Mesh]]

    # layers of tissue
    layers: NotRequired[Sequence[Layer]]

    # vertices that are held
    pins: NotRequired[Sequence[Selection]]

    # tools that are there from the start
    tools: NotRequired[Sequence[Tool]]

    # blood vessels
    vessels: NotRequired[Sequence[Vessel]]

    # a scripted pull
    pull: NotRequired[Pull]

    # a scripted cut
    cut: NotRequired[Cut]


class ToolAdd(TypedDict):
    """a new tool, driven by the caller"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # shape
    shape: NotRequired[Literal["sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper"]]

    # radius of the hot part (0.0002 to 0.05 m)
    hot_radius_m: NotRequired[float]

    # length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
    tip_length_m: NotRequired[float]

    # radius of the shaft (0.0002 to 0.05 m)
    shaft_radius_m: NotRequired[float]

    # length of the shaft (0.001 to 1 m)
    shaft_length_m: NotRequired[float]

    # angle between open jaws (0.05 to 1.5 rad)
    jaw_open_rad: NotRequired[float]

    # temperature of the hot part while energized (0 to 1500 degC)
    temperature_c: NotRequired[float]

    # nodes of the heat grid along each axis (8 to 64)
    grid_cells: NotRequired[float]

    # spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # alpha of eq. 18 (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # faster commands are followed at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # fastest turning of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # of the attachment of one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # an attached vertex slips above this force (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # the tool pushes with this at most; drivers read it (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # its jaws press what they hold with this at most (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power that is set, with energy `tissue` (0 to 400 W)
    power_w: NotRequired[float]

    # most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # of the voltage: its peak over its root mean square (1.4 to 20)
    crest_factor: NotRequired[float]

    # most current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of its filtered force; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # name of the tool
    name: str

    # first place of the tip (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # unit quaternion w, x, y, z: tool frame (shaft along +z) to world
    rotation: NotRequired[Sequence[float]]

    # profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none
    instrument: NotRequired[str]

    # mode of the instrument; its first by default
    mode: NotRequired[str]


class ToolRemove(TypedDict):
    """takes it away"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str


class ToolConfigure(TypedDict):
    """replaces shape and sizes; an absent member takes the instrument's value, or the default"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str

    # shape
    shape: NotRequired[Literal["sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper"]]

    # radius of the hot part (0.0002 to 0.05 m)
    hot_radius_m: NotRequired[float]

    # length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
    tip_length_m: NotRequired[float]

    # radius of the shaft (0.0002 to 0.05 m)
    shaft_radius_m: NotRequired[float]

    # length of the shaft (0.001 to 1 m)
    shaft_length_m: NotRequired[float]

    # angle between open jaws (0.05 to 1.5 rad)
    jaw_open_rad: NotRequired[float]

    # temperature of the hot part while energized (0 to 1500 degC)
    temperature_c: NotRequired[float]

    # nodes of the heat grid along each axis (8 to 64)
    grid_cells: NotRequired[float]

    # spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # alpha of eq. 18 (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # faster commands are followed at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # fastest turning of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # of the attachment of one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # an attached vertex slips above this force (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # the tool pushes with this at most; drivers read it (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # its jaws press what they hold with this at most (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power that is set, with energy `tissue` (0 to 400 W)
    power_w: NotRequired[float]

    # most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # of the voltage: its peak over its root mean square (1.4 to 20)
    crest_factor: NotRequired[float]

    # most current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of its filtered force; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none
    instrument: NotRequired[str]

    # mode of the instrument; its first by default
    mode: NotRequired[str]


class ToolMove(TypedDict):
    """moves it, at its speed limit; needs to be its driver"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str

    # place of the tip (-100 to 100 m)
    position_m: Sequence[float]

    # unit quaternion w, x, y, z
    rotation: Sequence[float]

    # 0 closed to 1 open (0 to 1)
    jaw: NotRequired[float]


class ToolEnergize(TypedDict):
    """energy on (driver only), for as many ticks as `ticks` says; or off"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str

    # on or off
    energized: bool

    # of an enable: its energy goes off after so many ticks; 0: no limit (0 to 2147483647)
    ticks: NotRequired[int]


class ToolGrasp(TypedDict):
    """closes the jaws on what is between them; driver only"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str


class ToolRelease(TypedDict):
    """opens them; driver only"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str


class ToolHold(TypedDict):
    """keeps the tool where it is, until it is moved again; driver only"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which tool
    tool: str


class Pin(TypedDict):
    """holds vertices where they are"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which vertices
    selection: Selection


class Unpin(TypedDict):
    """lets them go"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which vertices
    selection: Selection


# replaces a layer's material
MaterialSet: TypeAlias = Union["MaterialSetFascia", "MaterialSetMembrane", "MaterialSetFat", "MaterialSetLinks"]


class MaterialSetFascia(TypedDict):
    """replaces a layer's material"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # the layer's kind
    kind: Literal["fascia"]

    # which layer
    layer: str

    # of the mesh file; 0: the layer's default (0 to 2147483647)
    region: NotRequired[int]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetMembrane(TypedDict):
    """replaces a layer's material"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # the layer's kind
    kind: Literal["membrane"]

    # which layer
    layer: str

    # of the mesh file; 0: the layer's default (0 to 2147483647)
    region: NotRequired[int]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # bending; 0: no hinges (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetFat(TypedDict):
    """replaces a layer's material"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # the layer's kind
    kind: Literal["fat"]

    # which layer
    layer: str

    # of the mesh file; 0: the layer's default (0 to 2147483647)
    region: NotRequired[int]

    # elastic energy
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99)
    shear_max: NotRequired[float]

    # gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10)
    yield_strain: NotRequired[float]

    # gamma_2; 0: no plasticity (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetLinks(TypedDict):
    """replaces a layer's material"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # the layer's kind
    kind: Literal["links"]

    # which layer
    layer: str

    # Young's modulus of a truss (1 to 100000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # cross section of a truss (1e-12 to 1 m^2)
    area_m2: NotRequired[float]

    # longest truss (1e-06 to 1 m)
    reach_m: NotRequired[float]

    # trusses from each vertex of the upper sheet (1 to 8)
    per_vertex: NotRequired[float]

    # it parts when its exposure exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation, drawn by seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of bundles that part alike; 0: none (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # xi of eq. 20 (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class GravitySet(TypedDict):
    """for the whole session"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # gravity (-100 to 100 m/s^2)
    gravity_m_s2: Sequence[float]


class ForceSet(TypedDict):
    """an outer force on vertices"""

    # its id; that of the connection's URL by default
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # the driver's own count (0 to 9007199254740991)
    sequence: NotRequired[int]

    # on each chosen vertex (-1000 to 1000 N)
    force_n: Sequence[float]

    # which vertices
    selection: Selection


class Calls:
    """A function for each request. What is None is left out."""

    def call(self, method: str, params: Mapping[str, Any]) -> Any:
        """Sends a request and waits for its result."""
        raise NotImplementedError

    def hello(
        self,
        *,
        version: int,
        client: str,
        client_id: str | None = None,
        token: str | None = None,
        resume: str | None = None,
        role: Literal["view", "operate", "admin"] | None = None,
    ) -> HelloResult:
        """`hello`: first of all; nothing else is served before it

        version: wire version wanted; this document is version 1 (1 to 1000)
        client: name and version of the client program, for logs and other users
        client_id: the client's own lasting identity, among those of its token's owner; names the stored answers of client_sequence
        token: access token, where the server asks for one
        resume: token of an earlier hello: takes back the tools driven within 10 s of the loss, energy off
        role: role wanted; the token's by default and at most
        """
        return self.call("hello", {
            "version": version,
            "client": client,
            "client_id": client_id,
            "token": token,
            "resume": resume,
            "role": role,
        })

    def heartbeat(
        self,
        *,
        visible: bool,
        client_time_us: int | None = None,
    ) -> HeartbeatResult:
        """`heartbeat`: sign of life of a driver, every 100 ms while energy is on

        visible: false: the page is hidden or blurred, energy is cut at once
        client_time_us: the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us)
        """
        return self.call("heartbeat", {
            "visible": visible,
            "client_time_us": client_time_us,
        })

    def scene_list(
        self,
    ) -> SceneList:
        """`scene.list`: scenes of the daemon
        """
        return self.call("scene.list", {})

    def scene_get(
        self,
        *,
        scene: str,
    ) -> SceneResult:
        """`scene.get`: one of them whole

        scene: its name
        """
        return self.call("scene.get", {
            "scene": scene,
        })

    def instrument_list(
        self,
    ) -> InstrumentList:
        """`instrument.list`: profiles of instruments
        """
        return self.call("instrument.list", {})

    def session_list(
        self,
    ) -> SessionList:
        """`session.list`: sessions of the daemon
        """
        return self.call("session.list", {})

    def session_create(
        self,
        *,
        client_sequence: int | None = None,
        name: str | None = None,
        scene: str | None = None,
        definition: Scene | None = None,
        paused: bool | None = None,
        ephemeral: bool | None = None,
    ) -> SessionDescription:
        """`session.create`: makes a session

        client_sequence: see session_change (1 to 9007199254740991)
        name: wanted id, without the daemon's label; made up by default
        scene: a scene of the daemon; either this or definition
        definition: the scene itself; meshes of source bytes name an upload in file
        paused: starts paused; false by default
        ephemeral: is never on a disk, and ends with its maker's connection or the daemon; false by default
        """
        return self.call("session.create", {
            "client_sequence": client_sequence,
            "name": name,
            "scene": scene,
            "definition": definition,
            "paused": paused,
            "ephemeral": ephemeral,
        })

    def session_describe(
        self,
        *,
        session: str | None = None,
    ) -> SessionDescription:
        """`session.describe`: layers, drivers, scene

        session: its id; that of the connection's URL by default
        """
        return self.call("session.describe", {
            "session": session,
        })

    def session_join(
        self,
        *,
        session: str | None = None,
        rate_hz: float | None = None,
        channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]] | None = None,
        step_m: float | None = None,
        plain: bool | None = None,
    ) -> StreamDescription:
        """`session.join`: asks for frames; again to change the profile

        session: its id; that of the connection's URL by default
        rate_hz: frames a wall second at most; 60 by default (0.1 to 1000 1/s)
        channels: by default those that the table of channels marks
        step_m: quantisation wanted; the server may choose a finer one; 5e-5 by default (1e-07 to 0.001 m)
        plain: no section of the frames is in meshoptimizer's codec; false by default
        """
        return self.call("session.join", {
            "session": session,
            "rate_hz": rate_hz,
            "channels": channels,
            "step_m": step_m,
            "plain": plain,
        })

    def session_leave(
        self,
        *,
        session: str | None = None,
    ) -> Nothing:
        """`session.leave`: no more frames

        session: its id; that of the connection's URL by default
        """
        return self.call("session.leave", {
            "session": session,
        })

    def session_pause(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
    ) -> SessionSummary:
        """`session.pause`: stops time at a tick border; cuts energy

        session: its id; that of the connection's URL by default
        client_sequence: counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991)
        """
        return self.call("session.pause", {
            "session": session,
            "client_sequence": client_sequence,
        })

    def session_resume(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
    ) -> SessionSummary:
        """`session.resume`: lets time run

        session: its id; that of the connection's URL by default
        client_sequence: counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991)
        """
        return self.call("session.resume", {
            "session": session,
            "client_sequence": client_sequence,
        })

    def session_step(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        ticks: int | None = None,
    ) -> TickResult:
        """`session.step`: advances a paused session; answered when done

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        ticks: steps; 1 by default (1 to 100000)
        """
        return self.call("session.step", {
            "session": session,
            "client_sequence": client_sequence,
            "ticks": ticks,
        })

    def session_advance(
        self,
        *,
        session: str | None = None,
        ticks: int | None = None,
        commands: Sequence[AdvanceCommand] | None = None,
        observe: Observe | None = None,
    ) -> Advanced:
        """`session.advance`: lock-step: commands, ticks and what came of them in one request. The session must be paused. It has no client_sequence: `tick` says whether it was done

        session: its id; that of the connection's URL by default
        ticks: how many; 1 by default, 0 to observe alone (0 to 100000)
        commands: commands about tools, before the first tick; if one is refused none acts, but energy is still turned off where one asks for it
        observe: nothing by default
        """
        return self.call("session.advance", {
            "session": session,
            "ticks": ticks,
            "commands": commands,
            "observe": observe,
        })

    def session_speed(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        speed: float,
    ) -> SessionSummary:
        """`session.speed`: sets the pace

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        speed: simulated over wall time to aim at (0.01 to 10)
        """
        return self.call("session.speed", {
            "session": session,
            "client_sequence": client_sequence,
            "speed": speed,
        })

    def session_reset(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
    ) -> Restored:
        """`session.reset`: back to tick 0; a new branch

        session: its id; that of the connection's URL by default
        client_sequence: counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991)
        """
        return self.call("session.reset", {
            "session": session,
            "client_sequence": client_sequence,
        })

    def session_destroy(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
    ) -> Nothing:
        """`session.destroy`: ends it and removes it from the store, also one that the daemon could not bring up

        session: its id; that of the connection's URL by default
        client_sequence: counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991)
        """
        return self.call("session.destroy", {
            "session": session,
            "client_sequence": client_sequence,
        })

    def session_fork(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        name: str | None = None,
        tick: int | None = None,
        paused: bool | None = None,
    ) -> SessionDescription:
        """`session.fork`: a new session from this state, energy off

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        name: wanted id of the new one, without the daemon's label; made up by default
        tick: of the state; the present one by default (0 to 9007199254740991)
        paused: the new session starts paused; false by default
        """
        return self.call("session.fork", {
            "session": session,
            "client_sequence": client_sequence,
            "name": name,
            "tick": tick,
            "paused": paused,
        })

    def session_snapshot(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        name: str | None = None,
    ) -> SnapshotResult:
        """`session.snapshot`: stores the state under a name

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        name: made up by default
        """
        return self.call("session.snapshot", {
            "session": session,
            "client_sequence": client_sequence,
            "name": name,
        })

    def session_snapshots(
        self,
        *,
        session: str | None = None,
    ) -> SnapshotList:
        """`session.snapshots`: the snapshots that session.restore can restore, those of other branches too

        session: its id; that of the connection's URL by default
        """
        return self.call("session.snapshots", {
            "session": session,
        })

    def session_restore(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        name: str,
    ) -> Restored:
        """`session.restore`: back to a snapshot

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        name: of the snapshot
        """
        return self.call("session.restore", {
            "session": session,
            "client_sequence": client_sequence,
            "name": name,
        })

    def session_rewind(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int,
    ) -> Restored:
        """`session.rewind`: back to a tick

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the timeline's oldest_tick or later, or what a refusal names (0 to 9007199254740991)
        """
        return self.call("session.rewind", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
        })

    def session_export(
        self,
        *,
        session: str | None = None,
        format: Literal["vtu", "obj"],
    ) -> Transfer:
        """`session.export`: the tissue as a file; binary chunks follow

        session: its id; that of the connection's URL by default
        format: of the file
        """
        return self.call("session.export", {
            "session": session,
            "format": format,
        })

    def session_log(
        self,
        *,
        session: str | None = None,
        from_tick: int | None = None,
        to_tick: int | None = None,
    ) -> Transfer:
        """`session.log`: the command log as a script; binary chunks follow

        session: its id; that of the connection's URL by default
        from_tick: first tick; 0 by default (0 to 9007199254740991)
        to_tick: last tick; the present one by default (0 to 9007199254740991)
        """
        return self.call("session.log", {
            "session": session,
            "from_tick": from_tick,
            "to_tick": to_tick,
        })

    def session_timeline(
        self,
        *,
        session: str | None = None,
        from_tick: int | None = None,
        count: int | None = None,
    ) -> Timeline:
        """`session.timeline`: cuts and other events

        session: its id; that of the connection's URL by default
        from_tick: first tick; 0 by default (0 to 9007199254740991)
        count: newest events wanted at most; 1024 by default (1 to 4096)
        """
        return self.call("session.timeline", {
            "session": session,
            "from_tick": from_tick,
            "count": count,
        })

    def session_frame_at(
        self,
        *,
        session: str | None = None,
        tick: int,
        channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]] | None = None,
        step_m: float | None = None,
        plain: bool | None = None,
    ) -> PastFrame:
        """`session.frame_at`: the key frame of a past tick; nothing is rewound; binary chunks follow. A second request of a client cancels its first

        session: its id; that of the connection's URL by default
        tick: on the present line, from oldest_tick to the present (0 to 9007199254740991)
        channels: by default those that the table of channels marks
        step_m: quantisation; 5e-5 by default (1e-07 to 0.001 m)
        plain: no section of the frame is in meshoptimizer's codec; false by default
        """
        return self.call("session.frame_at", {
            "session": session,
            "tick": tick,
            "channels": channels,
            "step_m": step_m,
            "plain": plain,
        })

    def session_frame_cancel(
        self,
        *,
        session: str | None = None,
    ) -> Nothing:
        """`session.frame_cancel`: gives up the client's session.frame_at that is under way, if there is one

        session: its id; that of the connection's URL by default
        """
        return self.call("session.frame_cancel", {
            "session": session,
        })

    def session_waiting(
        self,
        *,
        session: str | None = None,
    ) -> WaitingList:
        """`session.waiting`: the commands that wait for later ticks

        session: its id; that of the connection's URL by default
        """
        return self.call("session.waiting", {
            "session": session,
        })

    def session_cancel(
        self,
        *,
        session: str | None = None,
        number: int | None = None,
    ) -> Cancelled:
        """`session.cancel`: takes back commands that wait for later ticks: the caller's own; with a number and role admin anybody's. Each is answered with `bad_state`

        session: its id; that of the connection's URL by default
        number: the command's, of session.waiting; without it all of the caller's (1 to 9007199254740991)
        """
        return self.call("session.cancel", {
            "session": session,
            "number": number,
        })

    def stream_key_frame(
        self,
        *,
        session: str | None = None,
    ) -> Nothing:
        """`stream.key_frame`: asks for a key frame; at most one a second

        session: its id; that of the connection's URL by default
        """
        return self.call("stream.key_frame", {
            "session": session,
        })

    def tool_add(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        shape: Literal["sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper"] | None = None,
        hot_radius_m: float | None = None,
        tip_length_m: float | None = None,
        shaft_radius_m: float | None = None,
        shaft_length_m: float | None = None,
        jaw_open_rad: float | None = None,
        temperature_c: float | None = None,
        grid_cells: float | None = None,
        grid_step_m: float | None = None,
        diffusivity_m2_s: float | None = None,
        max_speed_m_s: float | None = None,
        max_turn_rad_s: float | None = None,
        friction: float | None = None,
        drag_ns_m: float | None = None,
        grasp_stiffness_n_m: float | None = None,
        slip_force_n: float | None = None,
        force_max_n: float | None = None,
        close_force_n: float | None = None,
        power_w: float | None = None,
        peak_v: float | None = None,
        crest_factor: float | None = None,
        current_max_a: float | None = None,
        force_filter_s: float | None = None,
        blade_heat_j_k: float | None = None,
        blade_cooling_w_k: float | None = None,
        load_rise_off: float | None = None,
        name: str,
        position_m: Sequence[float] | None = None,
        rotation: Sequence[float] | None = None,
        instrument: str | None = None,
        mode: str | None = None,
    ) -> CommandResult:
        """`tool.add`: a new tool, driven by the caller

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        shape: shape
        hot_radius_m: radius of the hot part (0.0002 to 0.05 m)
        tip_length_m: length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
        shaft_radius_m: radius of the shaft (0.0002 to 0.05 m)
        shaft_length_m: length of the shaft (0.001 to 1 m)
        jaw_open_rad: angle between open jaws (0.05 to 1.5 rad)
        temperature_c: temperature of the hot part while energized (0 to 1500 degC)
        grid_cells: nodes of the heat grid along each axis (8 to 64)
        grid_step_m: spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m)
        diffusivity_m2_s: alpha of eq. 18 (0 to 0.001 m^2/s)
        max_speed_m_s: faster commands are followed at this speed (0.001 to 5 m/s)
        max_turn_rad_s: fastest turning of the tool (0.1 to 100 rad/s)
        friction: Coulomb coefficient of the cold parts (0 to 2)
        drag_ns_m: viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
        grasp_stiffness_n_m: of the attachment of one grasped vertex (1 to 1000000 N/m)
        slip_force_n: an attached vertex slips above this force (0 to 1000 N)
        force_max_n: the tool pushes with this at most; drivers read it (0.01 to 1000 N)
        close_force_n: its jaws press what they hold with this at most (0.01 to 1000 N)
        power_w: power that is set, with energy `tissue` (0 to 400 W)
        peak_v: most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V)
        crest_factor: of the voltage: its peak over its root mean square (1.4 to 20)
        current_max_a: most current, root mean square (0.01 to 10 A)
        force_filter_s: time constant of its filtered force; 0: no filter (0 to 1 s)
        blade_heat_j_k: heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K)
        blade_cooling_w_k: heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K)
        load_rise_off: power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100)
        name: name of the tool
        position_m: first place of the tip (-100 to 100 m)
        rotation: unit quaternion w, x, y, z: tool frame (shaft along +z) to world
        instrument: profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none
        mode: mode of the instrument; its first by default
        """
        return self.call("tool.add", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "shape": shape,
            "hot_radius_m": hot_radius_m,
            "tip_length_m": tip_length_m,
            "shaft_radius_m": shaft_radius_m,
            "shaft_length_m": shaft_length_m,
            "jaw_open_rad": jaw_open_rad,
            "temperature_c": temperature_c,
            "grid_cells": grid_cells,
            "grid_step_m": grid_step_m,
            "diffusivity_m2_s": diffusivity_m2_s,
            "max_speed_m_s": max_speed_m_s,
            "max_turn_rad_s": max_turn_rad_s,
            "friction": friction,
            "drag_ns_m": drag_ns_m,
            "grasp_stiffness_n_m": grasp_stiffness_n_m,
            "slip_force_n": slip_force_n,
            "force_max_n": force_max_n,
            "close_force_n": close_force_n,
            "power_w": power_w,
            "peak_v": peak_v,
            "crest_factor": crest_factor,
            "current_max_a": current_max_a,
            "force_filter_s": force_filter_s,
            "blade_heat_j_k": blade_heat_j_k,
            "blade_cooling_w_k": blade_cooling_w_k,
            "load_rise_off": load_rise_off,
            "name": name,
            "position_m": position_m,
            "rotation": rotation,
            "instrument": instrument,
            "mode": mode,
        })

    def tool_remove(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
    ) -> CommandResult:
        """`tool.remove`: takes it away

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        """
        return self.call("tool.remove", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
        })

    def tool_configure(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
        shape: Literal["sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper"] | None = None,
        hot_radius_m: float | None = None,
        tip_length_m: float | None = None,
        shaft_radius_m: float | None = None,
        shaft_length_m: float | None = None,
        jaw_open_rad: float | None = None,
        temperature_c: float | None = None,
        grid_cells: float | None = None,
        grid_step_m: float | None = None,
        diffusivity_m2_s: float | None = None,
        max_speed_m_s: float | None = None,
        max_turn_rad_s: float | None = None,
        friction: float | None = None,
        drag_ns_m: float | None = None,
        grasp_stiffness_n_m: float | None = None,
        slip_force_n: float | None = None,
        force_max_n: float | None = None,
        close_force_n: float | None = None,
        power_w: float | None = None,
        peak_v: float | None = None,
        crest_factor: float | None = None,
        current_max_a: float | None = None,
        force_filter_s: float | None = None,
        blade_heat_j_k: float | None = None,
        blade_cooling_w_k: float | None = None,
        load_rise_off: float | None = None,
        instrument: str | None = None,
        mode: str | None = None,
    ) -> CommandResult:
        """`tool.configure`: replaces shape and sizes; an absent member takes the instrument's value, or the default

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        shape: shape
        hot_radius_m: radius of the hot part (0.0002 to 0.05 m)
        tip_length_m: length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
        shaft_radius_m: radius of the shaft (0.0002 to 0.05 m)
        shaft_length_m: length of the shaft (0.001 to 1 m)
        jaw_open_rad: angle between open jaws (0.05 to 1.5 rad)
        temperature_c: temperature of the hot part while energized (0 to 1500 degC)
        grid_cells: nodes of the heat grid along each axis (8 to 64)
        grid_step_m: spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m)
        diffusivity_m2_s: alpha of eq. 18 (0 to 0.001 m^2/s)
        max_speed_m_s: faster commands are followed at this speed (0.001 to 5 m/s)
        max_turn_rad_s: fastest turning of the tool (0.1 to 100 rad/s)
        friction: Coulomb coefficient of the cold parts (0 to 2)
        drag_ns_m: viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
        grasp_stiffness_n_m: of the attachment of one grasped vertex (1 to 1000000 N/m)
        slip_force_n: an attached vertex slips above this force (0 to 1000 N)
        force_max_n: the tool pushes with this at most; drivers read it (0.01 to 1000 N)
        close_force_n: its jaws press what they hold with this at most (0.01 to 1000 N)
        power_w: power that is set, with energy `tissue` (0 to 400 W)
        peak_v: most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V)
        crest_factor: of the voltage: its peak over its root mean square (1.4 to 20)
        current_max_a: most current, root mean square (0.01 to 10 A)
        force_filter_s: time constant of its filtered force; 0: no filter (0 to 1 s)
        blade_heat_j_k: heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K)
        blade_cooling_w_k: heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K)
        load_rise_off: power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100)
        instrument: profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none
        mode: mode of the instrument; its first by default
        """
        return self.call("tool.configure", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
            "shape": shape,
            "hot_radius_m": hot_radius_m,
            "tip_length_m": tip_length_m,
            "shaft_radius_m": shaft_radius_m,
            "shaft_length_m": shaft_length_m,
            "jaw_open_rad": jaw_open_rad,
            "temperature_c": temperature_c,
            "grid_cells": grid_cells,
            "grid_step_m": grid_step_m,
            "diffusivity_m2_s": diffusivity_m2_s,
            "max_speed_m_s": max_speed_m_s,
            "max_turn_rad_s": max_turn_rad_s,
            "friction": friction,
            "drag_ns_m": drag_ns_m,
            "grasp_stiffness_n_m": grasp_stiffness_n_m,
            "slip_force_n": slip_force_n,
            "force_max_n": force_max_n,
            "close_force_n": close_force_n,
            "power_w": power_w,
            "peak_v": peak_v,
            "crest_factor": crest_factor,
            "current_max_a": current_max_a,
            "force_filter_s": force_filter_s,
            "blade_heat_j_k": blade_heat_j_k,
            "blade_cooling_w_k": blade_cooling_w_k,
            "load_rise_off": load_rise_off,
            "instrument": instrument,
            "mode": mode,
        })

    def tool_move(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
        position_m: Sequence[float],
        rotation: Sequence[float],
        jaw: float | None = None,
    ) -> CommandResult:
        """`tool.move`: moves it, at its speed limit; needs to be its driver

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        position_m: place of the tip (-100 to 100 m)
        rotation: unit quaternion w, x, y, z
        jaw: 0 closed to 1 open (0 to 1)
        """
        return self.call("tool.move", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
            "position_m": position_m,
            "rotation": rotation,
            "jaw": jaw,
        })

    def tool_energize(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
        energized: bool,
        ticks: int | None = None,
    ) -> CommandResult:
        """`tool.energize`: energy on (driver only), for as many ticks as `ticks` says; or off

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        energized: on or off
        ticks: of an enable: its energy goes off after so many ticks; 0: no limit (0 to 2147483647)
        """
        return self.call("tool.energize", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
            "energized": energized,
            "ticks": ticks,
        })

    def tool_grasp(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
    ) -> CommandResult:
        """`tool.grasp`: closes the jaws on what is between them; driver only

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        """
        return self.call("tool.grasp", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
        })

    def tool_release(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
    ) -> CommandResult:
        """`tool.release`: opens them; driver only

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        """
        return self.call("tool.release", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
        })

    def tool_hold(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        tool: str,
    ) -> CommandResult:
        """`tool.hold`: keeps the tool where it is, until it is moved again; driver only

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        tool: which tool
        """
        return self.call("tool.hold", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "tool": tool,
        })

    def tool_take_over(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tool: str,
    ) -> Driver:
        """`tool.take_over`: becomes the driver: of a tool without a driver, or with role admin; energy off

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tool: its name
        """
        return self.call("tool.take_over", {
            "session": session,
            "client_sequence": client_sequence,
            "tool": tool,
        })

    def tool_request_takeover(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tool: str,
    ) -> Nothing:
        """`tool.request_takeover`: asks its driver, who sees takeover.requested

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tool: its name
        """
        return self.call("tool.request_takeover", {
            "session": session,
            "client_sequence": client_sequence,
            "tool": tool,
        })

    def tool_hand_over(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tool: str,
        client: int | None = None,
    ) -> Driver:
        """`tool.hand_over`: gives it up; energy off; driver only

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tool: its name
        client: to this connection; by default the tool has no driver (1 to 4294967295)
        """
        return self.call("tool.hand_over", {
            "session": session,
            "client_sequence": client_sequence,
            "tool": tool,
            "client": client,
        })

    def pin(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        selection: Selection,
    ) -> CommandResult:
        """`pin`: holds vertices where they are

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        selection: which vertices
        """
        return self.call("pin", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "selection": selection,
        })

    def unpin(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        selection: Selection,
    ) -> CommandResult:
        """`unpin`: lets them go

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        selection: which vertices
        """
        return self.call("unpin", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "selection": selection,
        })

    def material_set(
        self,
        **params: Any,
    ) -> CommandResult:
        """`material.set`: replaces a layer's material
        """
        return self.call("material.set", params)

    def gravity_set(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        gravity_m_s2: Sequence[float],
    ) -> CommandResult:
        """`gravity.set`: for the whole session

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        gravity_m_s2: gravity (-100 to 100 m/s^2)
        """
        return self.call("gravity.set", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "gravity_m_s2": gravity_m_s2,
        })

    def force_set(
        self,
        *,
        session: str | None = None,
        client_sequence: int | None = None,
        tick: int | None = None,
        sequence: int | None = None,
        force_n: Sequence[float],
        selection: Selection,
    ) -> CommandResult:
        """`force.set`: an outer force on vertices

        session: its id; that of the connection's URL by default
        client_sequence: see session_change (1 to 9007199254740991)
        tick: applied at the first tick border at or after this; 0: the next (0 to 9007199254740991)
        sequence: the driver's own count (0 to 9007199254740991)
        force_n: on each chosen vertex (-1000 to 1000 N)
        selection: which vertices
        """
        return self.call("force.set", {
            "session": session,
            "client_sequence": client_sequence,
            "tick": tick,
            "sequence": sequence,
            "force_n": force_n,
            "selection": selection,
        })

    def upload_begin(
        self,
        *,
        name: str,
        file_name: str,
        byte_count: int,
    ) -> UploadBeginResult:
        """`upload.begin`: announces a mesh file

        name: for scenes: meshes[].file of source bytes, with file_name's ending
        file_name: for messages and the names of sessions; the format is found from the bytes
        byte_count: of the file, exactly (1 to 9007199254740991 B)
        """
        return self.call("upload.begin", {
            "name": name,
            "file_name": file_name,
            "byte_count": byte_count,
        })

    def upload_end(
        self,
        *,
        transfer: int,
        sha256: str,
    ) -> UploadResult:
        """`upload.end`: checks its length and hash

        transfer: as upload.begin answered (1 to 4294967295)
        sha256: of the file, 64 lower-case hex digits
        """
        return self.call("upload.end", {
            "transfer": transfer,
            "sha256": sha256,
        })

    def mesh_read(
        self,
        *,
        upload: str,
        unit_m: float | None = None,
        as_: Literal["fascia", "membrane", "fat", "links"] | None = None,
        strict: bool | None = None,
        as_it_is: bool | None = None,
        edge_m: float | None = None,
        labels: str | None = None,
        pin: str | None = None,
    ) -> MeshReading:
        """`mesh.read`: reads an upload as a mesh: the report, and a scene around it for session.create

        upload: as in upload.begin; whole
        unit_m: metres in one unit of the file; guessed by default where it is clear (1e-09 to 1000 m)
        as_: fat (tetrahedra) or fascia (triangles); by default fat where there are tetrahedra, or an inside
        strict: refuses a mesh that would have to be mended; false by default
        as_it_is: never fills the mesh with tetrahedra, for a scene of one's own; false by default
        edge_m: length of an edge of the tetrahedra that fill it; about 8,000 of them by default (1e-06 to 10 m)
        labels: of a segmentation: labels to keep, as in 1,3; all by default
        pin: sides that are pinned: bottom, top, left, right, front, back, with commas, or none; the bottom by default
        """
        return self.call("mesh.read", {
            "upload": upload,
            "unit_m": unit_m,
            "as": as_,
            "strict": strict,
            "as_it_is": as_it_is,
            "edge_m": edge_m,
            "labels": labels,
            "pin": pin,
        })

    def upload_discard(
        self,
        *,
        name: str,
    ) -> Nothing:
        """`upload.discard`: forgets it; sessions made of it stay

        name: as in upload.begin; it may be whole or still coming
        """
        return self.call("upload.discard", {
            "name": name,
        })

    def store_backup(
        self,
        *,
        name: str | None = None,
    ) -> StoreCopy:
        """`store.backup`: copies the daemon's store while everybody goes on, to a file on its machine; one at a time

        name: of the copy, without .db; by default the time. Nothing is replaced
        """
        return self.call("store.backup", {
            "name": name,
        })

    def move_begin(
        self,
        *,
        session: str,
        target: str,
        label: str,
        url: str | None = None,
    ) -> MoveBegun:
        """`move.begin`: a session is to go to another daemon; it is served meanwhile

        session: its id
        target: its id there
        label: of the daemon that is to have it
        url: where that daemon is, for who asks for the old id; none where one address leads to all
        """
        return self.call("move.begin", {
            "session": session,
            "target": target,
            "label": label,
            "url": url,
        })

    def move_read(
        self,
        *,
        session: str,
        move: str,
    ) -> Transfer:
        """`move.read`: the next piece of it; binary chunks follow

        session: its id on the daemon that is asked
        move: of move.begin
        """
        return self.call("move.read", {
            "session": session,
            "move": move,
        })

    def move_hold(
        self,
        *,
        session: str,
        move: str,
    ) -> MoveHeld:
        """`move.hold`: suspends the session, energy off; requests to it wait

        session: its id on the daemon that is asked
        move: of move.begin
        """
        return self.call("move.hold", {
            "session": session,
            "move": move,
        })

    def move_commit(
        self,
        *,
        session: str,
        move: str,
        receipt: str,
    ) -> MoveDecision:
        """`move.commit`: by the receipt that the other daemon has all pieces on its disk, the session ends here; the answer lets the other daemon serve it

        session: its id here
        move: of move.begin
        receipt: of the other daemon's last move.receive
        """
        return self.call("move.commit", {
            "session": session,
            "move": move,
            "receipt": receipt,
        })

    def move_cancel(
        self,
        *,
        session: str,
        move: str,
    ) -> MoveDecision:
        """`move.cancel`: it stays, unless it has moved: the answer says which

        session: its id on the daemon that is asked
        move: of move.begin
        """
        return self.call("move.cancel", {
            "session": session,
            "move": move,
        })

    def move_receive(
        self,
        *,
        session: str,
        move: str,
        upload: str,
    ) -> MoveReceived:
        """`move.receive`: an upload is a piece of a session that comes here; answered when it is on the disk

        session: its id here
        move: of move.begin
        upload: that holds the piece; it is gone with this
        """
        return self.call("move.receive", {
            "session": session,
            "move": move,
            "upload": upload,
        })

    def move_ready(
        self,
        *,
        session: str,
        move: str,
    ) -> MoveHeld:
        """`move.ready`: builds what has come, and answers when it could be served soon

        session: its id on the daemon that is asked
        move: of move.begin
        """
        return self.call("move.ready", {
            "session": session,
            "move": move,
        })

    def move_accept(
        self,
        *,
        session: str,
        move: str,
        proof: str,
    ) -> SessionDescription:
        """`move.accept`: it is this daemon's, by the proof of move.commit; answered when it is served

        session: its id here
        move: of move.begin
        proof: of move.commit
        """
        return self.call("move.accept", {
            "session": session,
            "move": move,
            "proof": proof,
        })

    def move_forget(
        self,
        *,
        session: str,
        move: str,
        release: str | None = None,
        source_lost: bool | None = None,
    ) -> Nothing:
        """`move.forget`: removes the pieces of a move, by the release of move.cancel

        session: its id here
        move: of move.begin
        release: of move.cancel
        source_lost: instead of a release: the other daemon is gone for good. If it had decided the move, the session is lost
        """
        return self.call("move.forget", {
            "session": session,
            "move": move,
            "release": release,
            "source_lost": source_lost,
        })

    def move_list(
        self,
    ) -> MoveList:
        """`move.list`: sessions that come, are in doubt, are leaving, or have gone
        """
        return self.call("move.list", {})
