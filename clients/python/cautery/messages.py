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
    1002: "the client violated the WebSocket protocol",
    1003: "a binary message was not a chunk of an upload",
    1007: "a text message was not UTF-8",
    1009: "a message was longer than the limit",
    1011: "the server has an internal error",
    1013: "the server has too many connections",
    4001: "the client sent no hello within 5 s",
    4002: "the token is missing or unknown",
    4003: "client and server support no common version of the protocol",
    4004: "the client did not read its frames fast enough",
    4005: "the client sends too many messages a second",
    4006: "the client did not answer pings",
    4007: "another connection took over this one",
    4008: "the client sent too many malformed messages",
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
    # largest heat exposure of the vertex's edges, over the exposure that parts the edge, 0 to 1
    "exposure": Scalar(3, 0, 0.00392156862745098, 255, "1"),
    # share of the vertex's edges that have parted, 0 to 1
    "charring": Scalar(4, 0, 0.00392156862745098, 255, "1"),
    # von Mises stress of fat, volume weighted
    "stress": Scalar(5, 0, 0, 65535, "Pa"),
    # temperature of the tools' heat grids at the vertex; outside of the grids ambient_c of the scene
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

    # lasting identity of the client, unique among the clients of the token's owner; the stored answers of client_sequence belong to it
    client_id: NotRequired[str]

    # access token, if the server needs one
    token: NotRequired[str]

    # resume token of an earlier hello: takes back the tools of that connection within 10 s of its loss, energy off
    resume: NotRequired[str]

    # wanted role, at most the role of the token (default: that role)
    role: NotRequired[Literal["view", "operate", "admin"]]


class Limits(TypedDict):
    """limits of the server; a client that exceeds one gets an error or a close code"""

    # largest text message (1 to 9007199254740991 B)
    message_bytes_max: int

    # largest upload (0 to 9007199254740991 B)
    upload_bytes_max: int

    # largest size of all uploads of the connection; an upload below 64 KiB counts as 64 KiB (0 to 9007199254740991 B)
    uploads_bytes_max: NotRequired[int]

    # largest data of one binary chunk (1 to 9007199254740991 B)
    chunk_bytes_max: int

    # largest number of sessions of the daemon (0 to 9007199254740991)
    sessions_max: int

    # largest number of connections of the daemon (0 to 9007199254740991)
    subscribers_max: int

    # largest number of different stream profiles of a session (1 to 4)
    profiles_max: int

    # largest number of streams of a connection (1 to 64)
    streams_max: NotRequired[int]

    # largest number of tools of a session (1 to 8)
    tools_max: int

    # largest number of requests of a connection in a second (1 to 9007199254740991 1/s)
    requests_per_s_max: int

    # largest number of tool.move notifications of a connection in a second (1 to 9007199254740991 1/s)
    motions_per_s_max: int

    # bytes of unsent frames above which frames are skipped (1 to 9007199254740991 B)
    bytes_in_flight_max: int

    # longest time between two messages of a driver before its energy goes off (0.01 to 60 s)
    heartbeat_s: float


class HelloResult(TypedDict):
    """who the server is and what the client may do"""

    # name and version of the server
    server: str

    # wire version spoken from now on (1 to 1000)
    version: int

    # the daemon's label; session ids start with it
    daemon: str

    # role of this connection
    role: Literal["view", "operate", "admin"]

    # number of the connection, which frames give as the number of the driver (1 to 4294967295)
    client: int

    # as given, or chosen by the server
    client_id: str

    # resume token for a later hello
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
    """reports to the server that a driver is alive; a notification, or a request to measure the clock offset"""

    # false: the page is hidden or another window has the focus; energy goes off at once
    visible: bool

    # the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us)
    client_time_us: NotRequired[int]


class HeartbeatResult(TypedDict):
    """clocks from which the client computes their offset"""

    # the server's monotonic clock (0 to 9007199254740991 us)
    server_time_us: int

    # as given in the heartbeat (0 to 9007199254740991 us)
    client_time_us: NotRequired[int]


class SceneSummary(TypedDict):
    """a scene from which sessions can be created"""

    # name of the scene
    name: str

    # description in words
    description: str


class SceneList(TypedDict):
    """all scenes of the daemon"""

    # sorted by name
    scenes: Sequence[SceneSummary]


class SceneRef(TypedDict):
    """names a scene"""

    # name of the scene
    scene: str


class SceneResult(TypedDict):
    """a whole scene, which can be changed and sent to session.create"""

    # the scene with every member, also defaults
    definition: Scene


class InstrumentMode(TypedDict):
    """settings of the generator in a mode of an instrument; the members are those of a tool"""

    # name of the mode
    mode: str

    # description in words
    description: str

    # power, if no other power is given (0 to 400 W)
    power_w: float

    # least power of the mode (0 to 400 W)
    power_least_w: float

    # largest power of the mode (0 to 400 W)
    power_most_w: float

    # largest peak voltage (1 to 10000 V)
    peak_v: float

    # peak voltage over root mean square voltage; the duty cycle is 2 / crest_factor^2 (1.4 to 20)
    crest_factor: float

    # largest current, root mean square (0.01 to 10 A)
    current_max_a: float

    # power ends when the load reaches this multiple of its minimum; 0: never (0 to 100)
    load_rise_off: float


class Instrument(TypedDict):
    """profile of an instrument, which a tool of a scene, tool.add and tool.configure can name"""

    # name of the instrument
    name: str

    # description in words
    description: str

    # shape of the tool
    shape: str

    # modes; the first is the default
    modes: Sequence[InstrumentMode]


class InstrumentList(TypedDict):
    """all profiles of instruments"""

    # sorted by name
    instruments: Sequence[Instrument]


class SessionRef(TypedDict):
    """names a session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]


class SessionChange(TypedDict):
    """names a session to change"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991)
    client_sequence: NotRequired[int]


class SessionSummary(TypedDict):
    """a session in a list"""

    # id of the session
    session: str

    # scene from which the session was created
    scene: str

    # state of the session
    state: Literal["starting", "running", "paused", "faulted"]

    # steps since creation, along the present branch (0 to 9007199254740991)
    tick: int

    # simulated time (0 to 1000000000000 s)
    time_s: float

    # length of one tick (0.0001 to 1 s)
    step_s: float

    # wanted simulated time over wall time (0 to 100)
    speed: float

    # reached simulated time over wall time, in the last second (0 to 1000000)
    realtime_factor: float

    # number of vertices (0 to 16777216)
    vertex_count: int

    # number of faces, drawn or not (0 to 16777216)
    face_count: int

    # number of tools (0 to 8)
    tool_count: int

    # number of streams (0 to 9007199254740991)
    subscriber_count: int

    # epoch of the frames; it changes with each rewind, reset, restore and restart
    epoch: str

    # reason why the session is faulted
    fault: NotRequired[str]

    # false: the session is ephemeral; in an answer to session.pause: the store was full, but the session pauses
    stored: NotRequired[bool]

    # stage of the builder while the session starts, is rewound or restored (meshing, ordering, factoring, settling; reading, restoring, replaying)
    stage: NotRequired[str]


class SessionList(TypedDict):
    """all sessions of the daemon"""

    # sorted by id
    sessions: Sequence[SessionSummary]


class SessionCreate(TypedDict):
    """creates a session from a scene of the daemon or from a given scene"""

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the session, without the daemon's label (default: chosen by the server)
    name: NotRequired[str]

    # a scene of the daemon; give either this or definition
    scene: NotRequired[str]

    # the scene itself; a mesh of source bytes names an upload in file
    definition: NotRequired[Scene]

    # the session starts paused (default: false)
    paused: NotRequired[bool]

    # the session is never stored; it ends with the connection that created it, or with the daemon (default: false)
    ephemeral: NotRequired[bool]


class LayerDescription(TypedDict):
    """a layer and its range in the face list"""

    # name of the layer in the scene
    name: str

    # kind of tissue
    kind: Literal["fascia", "membrane", "fat", "links"]

    # index of the first face of the layer (0 to 16777216)
    first_face: int

    # number of faces; 0 for links (0 to 16777216)
    face_count: int

    # number of triangles, tetrahedra or links (0 to 16777216)
    element_count: int


class Driver(TypedDict):
    """the client that drives a tool"""

    # name of the tool
    tool: str

    # number of the connection that drives the tool; 0: no driver (0 to 4294967295)
    client: int

    # name that the client gave in hello, or name of the DDS participant
    name: str

    # whether the energy of the tool is on
    energized: bool

    # reason why energy is off; without meaning while energy is on
    energy_off: Literal["never_enabled", "commanded", "watchdog", "restored", "taken_over"]


class SessionDescription(TypedDict):
    """everything that a client must know about a session"""

    # as in session.list
    summary: SessionSummary

    # description of the scene in words
    description: str

    # instruction set that this machine uses; results are equal to the bit only within one
    instruction_set: str

    # number of triangles of sheets (0 to 9007199254740991)
    triangle_count: int

    # number of tetrahedra of fat (0 to 9007199254740991)
    tetrahedron_count: int

    # number of links (0 to 9007199254740991)
    link_count: int

    # in the order of the scene
    layers: Sequence[LayerDescription]

    # one for each tool, in the order of frames
    drivers: Sequence[Driver]

    # the scene with the present materials, tools and gravity
    definition: Scene


class SessionStep(TypedDict):
    """advances a paused session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # number of steps (default: 1) (1 to 100000)
    ticks: NotRequired[int]


class AdvanceCommand(TypedDict):
    """a command to a tool, before the first tick; the members are those of the method that it names"""

    # method of the command
    method: Literal["tool.move", "tool.energize", "tool.grasp", "tool.release", "tool.hold"]

    # a tool that the client drives; any tool to turn energy off
    tool: str

    # number that the driver gives the command; frames show the number of the last command applied (0 to 9007199254740991)
    sequence: NotRequired[int]

    # tool.move: position of the tip (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # tool.move: unit quaternion w, x, y, z (-1.001 to 1.001)
    rotation: NotRequired[Sequence[float]]

    # tool.move: opening of the jaws, 0 closed (default) to 1 open (0 to 1)
    jaw: NotRequired[float]

    # tool.energize: whether energy is turned on or off
    energized: NotRequired[bool]

    # tool.energize: energy goes off after this many ticks; 0 (default): no limit (0 to 2147483647)
    ticks: NotRequired[int]


class ObservedRegion(TypedDict):
    """a box (least_m, most_m) or a ball (center_m, radius_m); it contains the elements whose middle is inside while the tissue is at rest"""

    # name of the region, which the answer repeats
    name: str

    # least corner of the box (-100 to 100 m)
    least_m: NotRequired[Sequence[float]]

    # largest corner of the box (-100 to 100 m)
    most_m: NotRequired[Sequence[float]]

    # centre of the ball (-100 to 100 m)
    center_m: NotRequired[Sequence[float]]

    # radius of the ball (0 to 100 m)
    radius_m: NotRequired[float]


class Observe(TypedDict):
    """what the answer to session.advance contains, besides tick and time"""

    # positions, mask, tools, vessels, and scalars by their names; not `statistics`, which is only in frames
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # vertices of positions and scalars, in this order (default: all) (0 to 16777215)
    vertices: NotRequired[Sequence[int]]

    # regions for which removed volume and damage are reported
    regions: NotRequired[Sequence[ObservedRegion]]

    # whether the energy of instruments is reported (default: false)
    energy: NotRequired[bool]


class SessionAdvance(TypedDict):
    """advances a paused session in lock-step"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # number of ticks; 0: only observe (default: 1) (0 to 100000)
    ticks: NotRequired[int]

    # commands to tools, before the first tick; if one is refused, none takes effect, except that requests to turn energy off do
    commands: NotRequired[Sequence[AdvanceCommand]]

    # what the answer contains (default: nothing)
    observe: NotRequired[Observe]


class ObservedScalar(TypedDict):
    """values of a scalar channel"""

    # name of the channel
    channel: Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]

    # value of each vertex, in the unit of the channel (-1e+300 to 1e+300)
    values: Sequence[float]


class ObservedTool(TypedDict):
    """present state of a tool"""

    # name of the tool
    tool: str

    # position of the tip in the actual pose, which tissue can hold back (-1000000 to 1000000 m)
    position_m: Sequence[float]

    # rotation of the actual pose, quaternion w, x, y, z (-1.001 to 1.001)
    rotation: Sequence[float]

    # actual opening of the jaws, 0 closed to 1 open (0 to 1)
    jaw: float

    # whether the energy of the tool is on
    energized: bool

    # reason why energy is off; belongs to the session, not to the simulated state
    energy_off: NotRequired[Literal["never_enabled", "commanded", "watchdog", "restored", "taken_over"]]

    # force of the tissue on the tool, filtered with force_filter_s; at most force_max_n (-1000000 to 1000000 N)
    force_n: Sequence[float]

    # torque about the tip, filtered as the force; at most force_max_n times tip_length_m (-1000000 to 1000000 N m)
    torque_nm: Sequence[float]

    # force in the last tick, without filter and limit (-1000000000000 to 1000000000000 N)
    raw_force_n: Sequence[float]

    # torque about the tip in the last tick, without filter and limit (-1000000000000 to 1000000000000 N m)
    raw_torque_nm: Sequence[float]

    # temperature of the hot part (-300 to 1000000 degC)
    tip_temperature_c: float

    # estimate of the heat that tissue took up (0 to 1000000000000 J)
    energy_j: float

    # with energy `tissue`: power given to tissue in the last tick; else 0 (0 to 1000000 W)
    power_w: float

    # load of the generator; 0: no current flows (0 to 1000000000000 ohm)
    load_ohm: float

    # number of vertices that the tool touches (0 to 9007199254740991)
    contact_vertices: int

    # number of points that the jaws hold (0 to 9007199254740991)
    grasped_vertices: int

    # number of the last command applied (0 to 9007199254740991)
    sequence: int


class ObservedVessel(TypedDict):
    """present state of a blood vessel"""

    # name of the vessel
    vessel: str

    # whether the vessel is parted somewhere
    parted: bool

    # whether the wall of the vessel has a hole somewhere
    pierced: bool

    # whether the vessel is pressed so flat somewhere that no blood flows
    shut: bool

    # whether a seal withstands the blood pressure
    sealed: bool

    # whether blood leaves the vessel
    bleeds: bool

    # flow of blood out of the vessel in the last tick (0 to 1 m^3/s)
    bleeding_m3_s: float

    # volume of blood that has left the vessel since the session began (0 to 1000000 m^3)
    shed_m3: float

    # predicted pressure at which the best seal opens; 0: no seal (0 to 1000000000000 Pa)
    burst_pa: float


class ObservedDamage(TypedDict):
    """damage by heat and force, in volumes of the tissue at rest; links have no volume"""

    # number of tetrahedra and triangles that were removed (0 to 9007199254740991)
    removed_count: int

    # volume of the removed elements (0 to 1000000000 m^3)
    removed_m3: float

    # volume of the present elements, each weighted with the mean exposure of its vertices (0 to 1000000000 m^3)
    damaged_m3: float


class RegionDamage(TypedDict):
    """damage inside and outside of a region"""

    # name of the region
    name: str

    # damage inside the region
    inside: ObservedDamage

    # damage outside the region
    outside: ObservedDamage


class ObservedEnergy(TypedDict):
    """where the energy of instruments went since the session was created; delivered_j and blade_j together are the sum of the members after far_j; with energy `paper` all members are 0"""

    # energy that current delivered in tissue (-1000000000000 to 1000000000000 J)
    delivered_j: float

    # heat from blades into tissue; below 0: from tissue into blades (-1000000000000 to 1000000000000 J)
    blade_j: float

    # energy of current far from the tool, where no heat is computed; not part of the sum (-1000000000000 to 1000000000000 J)
    far_j: float

    # heat of the tissue above its temperature at the start (-1000000000000 to 1000000000000 J)
    stored_j: float

    # energy carried away by water that boiled off, as steam and smoke (-1000000000000 to 1000000000000 J)
    boiled_j: float

    # energy carried away by blood (-1000000000000 to 1000000000000 J)
    perfused_j: float

    # energy lost at surfaces (-1000000000000 to 1000000000000 J)
    ambient_j: float

    # heat of tissue that was removed (-1000000000000 to 1000000000000 J)
    shed_j: float

    # volume of present tissue that heat has killed (0 to 1000000000 m^3)
    coagulated_m3: float

    # rate at which water boiled off in the last tick (0 to 1000000 kg/s)
    vapour_kg_s: float


class Advanced(TypedDict):
    """the ticks were computed; the observed values"""

    # present tick of the session (0 to 9007199254740991)
    tick: int

    # simulated time (0 to 1000000000000 s)
    time_s: float

    # number of computed ticks; fewer than requested if lock-step ended meanwhile (0 to 100000)
    ticks: int

    # whether the ticks are on the disk; false for ephemeral sessions
    stored: bool

    # x, y, z of the vertices (-1000000 to 1000000 m)
    positions_m: NotRequired[Sequence[float]]

    # words of 32 faces, the lowest bit first; a set bit: the face is not drawn (0 to 4294967295)
    mask: NotRequired[Sequence[int]]

    # in the order of the channels
    scalars: NotRequired[Sequence[ObservedScalar]]

    # in the order in which the tools were added
    tools: NotRequired[Sequence[ObservedTool]]

    # in the order of the scene
    vessels: NotRequired[Sequence[ObservedVessel]]

    # in the order of the request
    regions: NotRequired[Sequence[RegionDamage]]

    # energy of the whole session
    energy: NotRequired[ObservedEnergy]


class SessionSpeed(TypedDict):
    """sets the speed of a session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # wanted simulated time over wall time (0.01 to 10)
    speed: float


class SessionFork(TypedDict):
    """creates a new session from the state of this session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the new session, without the daemon's label (default: chosen by the server)
    name: NotRequired[str]

    # tick of the state (default: the present tick) (0 to 9007199254740991)
    tick: NotRequired[int]

    # the new session starts paused (default: false)
    paused: NotRequired[bool]


class SessionSnapshot(TypedDict):
    """stores the state of a session under a name"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the snapshot (default: chosen by the server)
    name: NotRequired[str]


class SnapshotResult(TypedDict):
    """a stored state"""

    # name of the snapshot, for session.restore
    name: str

    # tick of the state (0 to 9007199254740991)
    tick: int

    # hash of the whole state
    hash: str

    # bytes stored for the state; 0: the state can be reached from an earlier checkpoint and the log (0 to 9007199254740991 B)
    byte_count: int


class NamedSnapshot(TypedDict):
    """a snapshot of a session"""

    # name of the snapshot, for session.restore
    name: str

    # tick of the state (0 to 9007199254740991)
    tick: int

    # number of the branch of the snapshot (0 to 9007199254740991)
    branch: int


class SnapshotList(TypedDict):
    """all snapshots of a session"""

    # sorted by tick
    snapshots: Sequence[NamedSnapshot]


class SessionRestore(TypedDict):
    """restores a snapshot on a new branch; energy goes off"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the snapshot
    name: str


class SessionRewind(TypedDict):
    """rewinds to a tick on a new branch; energy goes off"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # a tick from oldest_tick of the timeline on, or one that a refusal names (0 to 9007199254740991)
    tick: int


class Restored(TypedDict):
    """state of a session after a rewind, restore or reset"""

    # tick of the state (0 to 9007199254740991)
    tick: int

    # epoch of the frames from now on
    epoch: str

    # number of the branch in the store (0 to 9007199254740991)
    branch: int

    # false: another build or instruction set wrote the state, so later ticks may differ in the last digits
    exact: bool


class SessionExport(TypedDict):
    """asks for the tissue as a file"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # format of the file
    format: Literal["vtu", "obj"]


class SessionLog(TypedDict):
    """asks for the command log as a script for cautery-sim"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # first tick (default: 0) (0 to 9007199254740991)
    from_tick: NotRequired[int]

    # last tick (default: the present tick) (0 to 9007199254740991)
    to_tick: NotRequired[int]


class Transfer(TypedDict):
    """a file that follows in binary chunks"""

    # number of the transfer in the headers of the chunks (1 to 4294967295)
    transfer: int

    # proposed file name
    file_name: str

    # media type of the file
    media_type: str

    # size of the file (0 to 9007199254740991 B)
    byte_count: int

    # SHA-256 of the file, 64 lower-case hex digits
    sha256: str


class SessionTimeline(TypedDict):
    """asks for the events of a session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # first tick (default: 0) (0 to 9007199254740991)
    from_tick: NotRequired[int]

    # largest number of events, the newest of them (default: 1024) (1 to 4096)
    count: NotRequired[int]


class TimelineEvent(TypedDict):
    """an event on the present branch"""

    # tick of the event (0 to 9007199254740991)
    tick: int

    # simulated time (0 to 1000000000000 s)
    time_s: float

    # kind of the event
    kind: Literal["created", "cut", "tear", "inverted", "energy_gain", "bleeding", "bleeding_stopped", "sealed", "energy_on", "energy_off", "watchdog", "driver", "tool_added", "tool_removed", "refused", "fault", "rewind", "reset", "snapshot", "restore"]

    # tool of the event
    tool: NotRequired[str]

    # client that caused the event
    client: NotRequired[str]

    # cut: number of removed elements; refused: number of commands (0 to 9007199254740991)
    count: NotRequired[int]

    # details in words
    detail: NotRequired[str]


class Timeline(TypedDict):
    """events of a session, and the oldest tick that can be reached"""

    # present tick (0 to 9007199254740991)
    tick: int

    # every tick from this tick on can be reached (0 to 9007199254740991)
    oldest_tick: int

    # number of the present branch (0 to 9007199254740991)
    branch: int

    # oldest first; cuts within 30 ticks are one event
    events: Sequence[TimelineEvent]


class TickResult(TypedDict):
    """when a change takes effect"""

    # tick border at which the change takes effect (0 to 9007199254740991)
    tick: int


class SessionFrameAt(TypedDict):
    """asks for the picture of a past tick; the session continues and does not change"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # tick on the present branch, from oldest_tick to the present (0 to 9007199254740991)
    tick: int

    # channels (default: those marked in the table of channels)
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # quantisation step (default: 5e-5) (1e-07 to 0.001 m)
    step_m: NotRequired[float]

    # true: no section of the frame uses meshoptimizer's codec (default: false)
    plain: NotRequired[bool]


class PastFrame(TypedDict):
    """one key frame, which follows in binary chunks, and what a decoder needs besides the topology; the tools in the frame have no drivers"""

    # number of the transfer in the headers of the chunks (1 to 4294967295)
    transfer: int

    # proposed file name
    file_name: str

    # media type of the file
    media_type: str

    # size of the frame (0 to 9007199254740991 B)
    byte_count: int

    # SHA-256 of the frame, 64 lower-case hex digits
    sha256: str

    # tick that the frame shows (0 to 9007199254740991)
    tick: int

    # true: equal to the bit to the past state; false: replayed by another build or instruction set
    exact: bool

    # session number in the frame's header (0 to 4294967295)
    session_number: int

    # profile in the frame's header (0 to 3)
    profile: int

    # epoch in the frame's header, which no stream has
    epoch: str

    # channels of the frame
    channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]

    # number of vertices in positions and scalars (0 to 16777216)
    vertex_count: int

    # number of faces in the mask (0 to 16777216)
    face_count: int

    # position of the quantised zero (-1000000 to 1000000 m)
    origin_m: Sequence[float]

    # length of one quantised step (1e-07 to 0.01 m)
    step_m: float

    # one step of the stress channel (0.001 to 1000000000 Pa)
    stress_step_pa: float


class FrameProgress(TypedDict):
    """progress of a past view"""

    # id of the session
    session: str

    # tick of the past view (0 to 9007199254740991)
    tick: int

    # present stage of the work
    stage: Literal["building", "reading", "restoring", "replaying"]

    # tick at which the replay began (0 to 9007199254740991)
    from_tick: int

    # tick that the replay has reached (0 to 9007199254740991)
    at_tick: int


class StoreBackup(TypedDict):
    """asks the daemon to copy its store"""

    # name of the copy, without .db (default: the time); no file is replaced
    name: NotRequired[str]


class StoreCopy(TypedDict):
    """a checked copy of the store, as it was at one moment"""

    # path of the copy on the daemon's machine
    file: str

    # size of the copy (0 to 9007199254740991 B)
    byte_count: int


class MoveBegin(TypedDict):
    """begins to move a session to another daemon"""

    # id of the session on this daemon
    session: str

    # id of the session on the target daemon
    target: str

    # label of the target daemon
    label: str

    # address of the target daemon, for clients that use the old id; empty if one address leads to all daemons
    url: NotRequired[str]


class MoveBegun(TypedDict):
    """a move has begun"""

    # name of the move
    move: str


class MoveRef(TypedDict):
    """names a move"""

    # id of the session on the daemon that is asked
    session: str

    # name of the move, from move.begin
    move: str


class MoveHeld(TypedDict):
    """the state at which a session is suspended"""

    # tick of the state (0 to 9007199254740991)
    tick: int

    # hash of the state
    hash: str

    # true: the state of the other daemon was restored to the bit; false: another build or instruction set wrote it, so later ticks may differ in the last digits
    exact: NotRequired[bool]


class MoveDecision(TypedDict):
    """result of a move"""

    # false: the session stays, and this move can no longer happen
    moved: bool

    # id of the session on the target daemon
    target: NotRequired[str]

    # proof with which the target daemon may serve the session
    proof: NotRequired[str]

    # if the session stays: release with which the target daemon may forget the move
    release: NotRequired[str]


class MoveReceive(TypedDict):
    """delivers a piece of a session"""

    # id of the session on this daemon
    session: str

    # name of the move, from move.begin
    move: str

    # upload that holds the piece; this request removes the upload
    upload: str


class MoveReceived(TypedDict):
    """a piece is on the disk of the target daemon"""

    # number of pieces on the disk (0 to 9007199254740991)
    pieces: int

    # after the last piece: receipt that proves to the source daemon that all pieces are on the disk
    receipt: NotRequired[str]


class MoveCommit(TypedDict):
    """informs the source daemon that the target daemon has all pieces"""

    # id of the session on this daemon
    session: str

    # name of the move, from move.begin
    move: str

    # receipt of the last move.receive on the target daemon
    receipt: str


class MoveForget(TypedDict):
    """removes the pieces of a move"""

    # id of the session on this daemon
    session: str

    # name of the move, from move.begin
    move: str

    # release from move.cancel
    release: NotRequired[str]

    # instead of a release: the source daemon is lost for good. If it had decided the move, the session is lost
    source_lost: NotRequired[bool]


class MoveAccept(TypedDict):
    """asks the target daemon to serve the session"""

    # id of the session on this daemon
    session: str

    # name of the move, from move.begin
    move: str

    # proof from move.commit
    proof: str


class MoveEntry(TypedDict):
    """a move, as this daemon knows it"""

    # id of the session on this daemon
    session: str

    # name of the move, from move.begin
    move: str

    # id of the session on the other daemon
    other: str

    # leaving, held, deciding, gone; incoming, doubt (all pieces are here, but only the source daemon knows whether the move is decided), accepting
    state: str

    # gone: address of the other daemon, as move.begin gave it
    url: NotRequired[str]


class MoveList(TypedDict):
    """moves of this daemon's sessions"""

    # unfinished moves first, then sessions that have moved away
    moves: Sequence[MoveEntry]


class WaitingCommand(TypedDict):
    """a command that waits for a later tick"""

    # number of the command, for session.cancel (1 to 9007199254740991)
    number: int

    # tick at which the command takes effect (1 to 9007199254740991)
    tick: int

    # method of the command, as tool.move
    method: str

    # tool of the command
    tool: NotRequired[str]

    # number that the driver gave the command (0 to 9007199254740991)
    sequence: int

    # client that sent the command (1 to 4294967295)
    client: int

    # name of that client
    name: str


class WaitingList(TypedDict):
    """the commands of a session that wait for later ticks"""

    # in the order of arrival; at most 64 of one client
    commands: Sequence[WaitingCommand]


class SessionCancel(TypedDict):
    """cancels commands that wait for later ticks"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # number of the command, from session.waiting (default: all commands of the caller) (1 to 9007199254740991)
    number: NotRequired[int]


class Cancelled(TypedDict):
    """cancelled commands"""

    # number of cancelled commands (0 to 9007199254740991)
    count: int


class SessionJoin(TypedDict):
    """asks for frames"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # largest number of frames in a second of wall time (default: 60) (0.1 to 1000 1/s)
    rate_hz: NotRequired[float]

    # channels (default: those marked in the table of channels)
    channels: NotRequired[Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]]

    # wanted quantisation step; the server may choose a finer step (default: 5e-5) (1e-07 to 0.001 m)
    step_m: NotRequired[float]

    # true: no section of the frames uses meshoptimizer's codec (default: false)
    plain: NotRequired[bool]


class StreamDescription(TypedDict):
    """what a decoder needs; a topology frame and a key frame follow"""

    # id of the session
    session: str

    # session number in the frames' headers (0 to 4294967295)
    session_number: int

    # profile in the frames' headers (0 to 3)
    profile: int

    # epoch at the time of joining
    epoch: str

    # largest number of frames in a second, as granted (0.1 to 1000 1/s)
    rate_hz: float

    # channels of the stream
    channels: Sequence[Literal["positions", "mask", "exposure", "charring", "stress", "tools", "statistics", "temperature", "vessels", "blood", "tool_contact"]]

    # number of vertices in positions and scalars (0 to 16777216)
    vertex_count: int

    # number of faces in mask and topology (0 to 16777216)
    face_count: int

    # position of the quantised zero (-1000000 to 1000000 m)
    origin_m: Sequence[float]

    # length of one quantised step (1e-07 to 0.01 m)
    step_m: float

    # one step of the stress channel (0.001 to 1000000000 Pa)
    stress_step_pa: float

    # true: no section of the frames uses meshoptimizer's codec; older servers do not send this member
    plain: NotRequired[bool]


class StreamAck(TypedDict):
    """the newest frame that the client has decoded; limits the frames in flight and shows delays"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # epoch of the frame
    epoch: str

    # sequence number of the frame (0 to 9007199254740991)
    sequence: int


class ToolRef(TypedDict):
    """names a tool of a session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the tool
    tool: str


class ToolHandOver(TypedDict):
    """gives up a tool, or hands it over to another client"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # name of the tool
    tool: str

    # connection that becomes the driver (default: the tool has no driver) (1 to 4294967295)
    client: NotRequired[int]


class CommandResult(TypedDict):
    """a command was accepted into the log"""

    # tick border at which the command takes effect (0 to 9007199254740991)
    tick: int

    # as given in the command (0 to 9007199254740991)
    sequence: int

    # false: the store was full; energy is off nevertheless
    stored: NotRequired[bool]


class UploadBegin(TypedDict):
    """announces a mesh file; replaces an upload of the same name, complete or not"""

    # name of the upload, for meshes[].file of source bytes with the ending of file_name
    name: str

    # file name for messages and names of sessions; the format is recognised from the bytes
    file_name: str

    # exact size of the file (1 to 9007199254740991 B)
    byte_count: int


class UploadBeginResult(TypedDict):
    """the server is ready for chunks"""

    # number of the transfer for the headers of the chunks (1 to 4294967295)
    transfer: int

    # largest data of one chunk (1 to 9007199254740991 B)
    chunk_bytes_max: int


class UploadEnd(TypedDict):
    """all chunks were sent"""

    # number from upload.begin (1 to 4294967295)
    transfer: int

    # SHA-256 of the file, 64 lower-case hex digits
    sha256: str


# asks for a report on an upload, read as a mesh
MeshRead = TypedDict("MeshRead", {
    # name of a complete upload, as in upload.begin
    "upload": str,

    # metres in one unit of the file (default: guessed from the size of the mesh, if that is clear) (1e-09 to 1000 m)
    "unit_m": NotRequired[float],

    # fat (tetrahedra) or fascia (triangles); default: fat if the file has tetrahedra or a closed surface
    "as": NotRequired[Literal["fascia", "membrane", "fat", "links"]],

    # true: refuse a mesh that needs repair (default: false)
    "strict": NotRequired[bool],

    # true: never fill the mesh with tetrahedra; for scenes that a client writes itself (default: false)
    "as_it_is": NotRequired[bool],

    # edge length of the tetrahedra that fill the mesh (default: gives about 8,000 tetrahedra) (1e-06 to 10 m)
    "edge_m": NotRequired[float],

    # labels of a segmentation to keep, as in 1,3 (default: all)
    "labels": NotRequired[str],

    # pinned sides: bottom, top, left, right, front, back, with commas, or none (default: bottom)
    "pin": NotRequired[str],
})


class MeshKind(TypedDict):
    """elements of one kind in the file"""

    # name of the kind, as hexahedra
    name: str

    # number that became elements of the mesh (0 to 9007199254740991)
    read: int

    # number that were ignored (0 to 9007199254740991)
    passed: int


class MeshMend(TypedDict):
    """one kind of repair"""

    # the repair in words, as `duplicate vertices merged`
    what: str

    # number of repairs (1 to 9007199254740991)
    count: int


class MeshRegion(TypedDict):
    """a region of the mesh"""

    # 2: region of triangles, 3: of tetrahedra (2 to 3)
    dimension: int

    # number of the region, as layers name it (-2147483648 to 2147483647)
    region: int

    # number of elements (0 to 9007199254740991)
    element_count: int

    # name of the region in the file, or empty
    name: str


class MeshReport(TypedDict):
    """report on a mesh file"""

    # the whole report in words, one fact in each line
    text: str

    # format of the file, as Gmsh 4.1
    format: str

    # number of vertices in the file (0 to 9007199254740991)
    vertices_read: int

    # elements in the file
    kinds: Sequence[MeshKind]

    # repairs of the mesh
    mended: Sequence[MeshMend]

    # number of vertices of the mesh (0 to 9007199254740991)
    vertex_count: int

    # number of triangles (0 to 9007199254740991)
    triangle_count: int

    # number of tetrahedra (0 to 9007199254740991)
    tetrahedron_count: int

    # number of connected pieces (0 to 9007199254740991)
    component_count: int

    # number of edges on the rim of a surface without tetrahedra; 0: the surface is closed (0 to 9007199254740991)
    open_edge_count: int

    # the first regions of the mesh
    regions: Sequence[MeshRegion]

    # number of all regions (0 to 9007199254740991)
    region_count: int

    # least corner of the bounding box (-1000000 to 1000000 m)
    least_m: Sequence[float]

    # largest corner of the bounding box (-1000000 to 1000000 m)
    most_m: Sequence[float]

    # metres in one unit of the file, as used (1e-09 to 1000 m)
    unit_m: float

    # number of elements in each tenth of the quality from 0 to 1 (mean ratio) (0 to 9007199254740991)
    quality: Sequence[float]

    # least quality of all elements (0 to 1)
    least_quality: float


class MeshReading(TypedDict):
    """result of reading a mesh"""

    # report on the file
    report: MeshReport

    # a scene with the upload, for session.create
    definition: Scene

    # a choice that the user has, as whether the surface is filled
    note: NotRequired[str]


class UploadDiscard(TypedDict):
    """removes an upload"""

    # name of the upload, which may be complete or still arriving
    name: str


class UploadResult(TypedDict):
    """the file is complete; the server keeps it until it is discarded, another upload takes its name, or the connection closes"""

    # as given in upload.begin
    name: str

    # value for the member file of a mesh of source bytes
    file: str

    # number of received bytes (0 to 9007199254740991 B)
    byte_count: int


class SessionChanged(TypedDict):
    """a session has changed"""

    # reason of the change
    change: Literal["created", "destroyed", "paused", "resumed", "stepped", "speed", "reset", "rewound", "restored", "restarted", "moved", "tools", "tissue"]

    # present summary of the session
    summary: SessionSummary

    # client that caused the change
    client: NotRequired[str]

    # moved: address of the daemon that has the session now, if it is another
    target: NotRequired[str]

    # moved: id of the session on that daemon
    moved_to: NotRequired[str]


class SessionFaulted(TypedDict):
    """the simulation failed numerically; rewind or reset the session"""

    # id of the session
    session: str

    # tick of the fault (0 to 9007199254740991)
    tick: int

    # reason in words
    reason: str


class DriverChanged(TypedDict):
    """a tool has another driver, or its energy went off"""

    # id of the session
    session: str

    # present driver of the tool
    driver: Driver


class ToolRefused(TypedDict):
    """commands to a tool were refused; sent at most once a second for each tool"""

    # id of the session
    session: str

    # name of the tool
    tool: str

    # number of commands refused since the last such message (1 to 9007199254740991)
    count: int

    # number of the last refused command (0 to 9007199254740991)
    sequence: int

    # status of the last refusal, from the table of errors
    status: str

    # member of that command that was refused
    path: NotRequired[str]

    # reason in words
    reason: str


class TakeoverRequested(TypedDict):
    """another client asks the driver for a tool; the driver may answer with tool.hand_over"""

    # id of the session
    session: str

    # name of the tool
    tool: str

    # client that asks (1 to 4294967295)
    client: int

    # name that the client gave in hello
    name: str


class EventNotice(TypedDict):
    """an event happened; the timeline contains it from now on"""

    # id of the session
    session: str

    # the event
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

    # path of a mesh file, relative to the scene file
    file: NotRequired[str]

    # metres in one unit of the file (1e-09 to 1000 m)
    unit_m: NotRequired[float]

    # 1: refuse a mesh with errors instead of repairing it (0 to 1)
    strict: NotRequired[int]

    # translation of the mesh, applied after unit_m (-100 to 100 m)
    translate_m: NotRequired[Sequence[float]]


class Selection(TypedDict):
    """a selection of vertices by their rest positions"""

    # which vertices
    kind: Literal["rim", "box", "sphere", "nearest"]

    # only vertices of this layer; without it, of any layer
    layer: NotRequired[str]

    # least corner of the box (-100 to 100 m)
    least_m: NotRequired[Sequence[float]]

    # largest corner of the box (-100 to 100 m)
    most_m: NotRequired[Sequence[float]]

    # centre of the sphere, or the point for `nearest` (-100 to 100 m)
    center_m: NotRequired[Sequence[float]]

    # radius of the sphere (0 to 100 m)
    radius_m: NotRequired[float]


class Tool(TypedDict):
    """a tool of a scene"""

    # name of the tool
    name: str

    # profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out
    instrument: NotRequired[str]

    # mode of the instrument (default: its first)
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

    # spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # largest angular speed of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # force above which a grasped vertex slips (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # largest force of the jaws on what they hold (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power to which the generator is set; for energy tissue (0 to 400 W)
    power_w: NotRequired[float]

    # largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # peak voltage over root mean square voltage (1.4 to 20)
    crest_factor: NotRequired[float]

    # largest current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of the force filter; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # position of the tip at the start (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # unit quaternion w, x, y, z: tool frame (shaft along +z) to world
    rotation: NotRequired[Sequence[float]]


class VesselPoint(TypedDict):
    """a point of the middle line of a vessel"""

    # position of the point at rest (-100 to 100 m)
    at_m: Sequence[float]


class Vessel(TypedDict):
    """a blood vessel in a layer of fat"""

    # name of the vessel
    name: str

    # layer of fat in which the vessel lies
    layer: str

    # outer radius of the tube (0.0001 to 0.01 m)
    radius_m: NotRequired[float]

    # thickness of the wall of the vessel; less than the radius (1e-05 to 0.005 m)
    wall_m: NotRequired[float]

    # blood pressure at the first point of the vessel (0 to 40000 Pa)
    pressure_pa: NotRequired[float]

    # pressure of blood that flows back from the last point of the vessel (0 to 40000 Pa)
    end_pressure_pa: NotRequired[float]

    # length of a tube of this radius that leads the blood to the vessel (0.001 to 10 m)
    supply_m: NotRequired[float]

    # points of the middle line of the vessel
    points: NotRequired[Sequence[VesselPoint]]


class Pull(TypedDict):
    """a scripted pull, for measurements"""

    # displacement of the chosen vertices (-1 to 1 m)
    move_m: NotRequired[Sequence[float]]

    # time that the displacement takes (0.001 to 3600 s)
    duration_s: NotRequired[float]

    # vertices that are pulled
    selection: Selection


class Cut(TypedDict):
    """a scripted cut, for measurements"""

    # name of the tool in the scene
    tool: str

    # where the tip waits before the cut (-100 to 100 m)
    from_m: Sequence[float]

    # where the tip moves to (-100 to 100 m)
    to_m: Sequence[float]

    # unit quaternion w, x, y, z of the tool
    rotation: NotRequired[Sequence[float]]

    # time that the tip waits at from_m (0 to 3600 s)
    dwell_s: NotRequired[float]

    # speed of the tip on the cut (1e-05 to 1 m/s)
    speed_m_s: NotRequired[float]


# a layer of tissue
Layer: TypeAlias = Union["FasciaLayer", "MembraneLayer", "FatLayer", "LinksLayer"]


class FasciaRegion(TypedDict):
    """members of a region's material that differ from the layer's material"""

    # number of a region in the mesh file (0 to 2147483647)
    region: int

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class FasciaLayer(TypedDict):
    """a layer of this kind, with its material"""

    # kind of tissue
    kind: Literal["fascia"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: the tissue whose thermal and electric properties the layer has
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # regions of the mesh file, with the members that differ
    regions: NotRequired[Sequence[FasciaRegion]]


class MembraneRegion(TypedDict):
    """members of a region's material that differ from the layer's material"""

    # number of a region in the mesh file (0 to 2147483647)
    region: int

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MembraneLayer(TypedDict):
    """a layer of this kind, with its material"""

    # kind of tissue
    kind: Literal["membrane"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # membrane: the fat layer whose boundary it covers; links: the upper layer
    of: NotRequired[str]

    # material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: the tissue whose thermal and electric properties the layer has
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # regions of the mesh file, with the members that differ
    regions: NotRequired[Sequence[MembraneRegion]]


class FatRegion(TypedDict):
    """members of a region's material that differ from the layer's material"""

    # number of a region in the mesh file (0 to 2147483647)
    region: int

    # elastic law
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10)
    yield_strain: NotRequired[float]

    # largest plastic strain (gamma_2); 0: no plastic flow (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class FatLayer(TypedDict):
    """a layer of this kind, with its material"""

    # kind of tissue
    kind: Literal["fat"]

    # name of the layer
    name: str

    # mesh whose triangles or tetrahedra the layer takes
    mesh: NotRequired[str]

    # material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000)
    fibre: NotRequired[Sequence[float]]

    # with energy `tissue`: the tissue whose thermal and electric properties the layer has
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s)
    viscosity_s: NotRequired[float]

    # elastic law
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10)
    yield_strain: NotRequired[float]

    # largest plastic strain (gamma_2); 0: no plastic flow (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]

    # regions of the mesh file, with the members that differ
    regions: NotRequired[Sequence[FatRegion]]


class LinksLayer(TypedDict):
    """a layer of this kind, with its material"""

    # kind of tissue
    kind: Literal["links"]

    # name of the layer
    name: str

    # membrane: the fat layer whose boundary it covers; links: the upper layer
    of: NotRequired[str]

    # lower layer of the links
    to: NotRequired[str]

    # with energy `tissue`: the tissue whose thermal and electric properties the layer has
    tissue: NotRequired[Literal["connective", "fat", "liver", "muscle"]]

    # with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10)
    perfusion: NotRequired[float]

    # share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1)
    coagulated_tear: NotRequired[float]

    # Young's modulus of a truss (1 to 100000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # cross section of a truss (1e-12 to 1 m^2)
    area_m2: NotRequired[float]

    # length of the longest truss (1e-06 to 1 m)
    reach_m: NotRequired[float]

    # number of trusses from each vertex of the upper sheet (1 to 8)
    per_vertex: NotRequired[float]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class Scene(TypedDict):
    """the data from which a session is created"""

    # name of the scene
    name: str

    # description of the scene in words
    description: NotRequired[str]

    # time step; one tick (0.001 to 0.03333333333333333 s)
    step_s: NotRequired[float]

    # damping rate c: each step multiplies velocities by exp(-c step_s) (0 to 1000 1/s)
    damping_per_s: NotRequired[float]

    # temperature of the body around the tools (-20 to 60 degC)
    ambient_c: NotRequired[float]

    # relative residual at which a step ends; 0: not used (0 to 1)
    tolerance: NotRequired[float]

    # largest error of a step, relative to its motion; 0: all iterations (0 to 1)
    accuracy: NotRequired[float]

    # least distance between tissue surfaces; 0: no tissue contact (0 to 0.01 m)
    contact_thickness_m: NotRequired[float]

    # Coulomb coefficient of tissue on tissue (0 to 2)
    contact_friction: NotRequired[float]

    # edge length of one cell of the heat computation; for energy tissue (0.0001 to 0.005 m)
    cell_m: NotRequired[float]

    # largest number of iterations of a step (small tissue: up to 64); with `accuracy` 0, each step takes all (1 to 1000)
    iterations: NotRequired[int]

    # how the global step is solved; `newton` also uses Newton's method for all sheets
    solver: NotRequired[Literal["cholesky", "diagonal", "newton"]]

    # number format of the local and global steps
    precision: NotRequired[Literal["single", "double"]]

    # how a tick advances motion: `euler` damps, more for longer steps; `sdirk2` is of second order and solves twice a tick; at 60 steps/s it keeps 0.997 of a 5 Hz swing each period
    integrator: NotRequired[Literal["euler", "sdirk2"]]

    # what heat parts: `edges`, each with all elements that share it, as in the paper; or `elements` one by one, so that a cut does not depend on the mesh
    parting: NotRequired[Literal["edges", "elements"]]

    # model of an energized tool: with `paper` the hot part has a set temperature; with `tissue` a generator heats tissue, boils its water and parts elements (needs parting `elements`)
    energy: NotRequired[Literal["paper", "tissue"]]

    # seed of all random numbers (0 to 9007199254740991)
    seed: NotRequired[int]

    # gravity (-100 to 100 m/s^2)
    gravity_m_s2: NotRequired[Sequence[float]]

    # meshes of the layers
    meshes: NotRequired[Sequence[Mesh]]

    # layers of tissue
    layers: NotRequired[Sequence[Layer]]

    # pinned vertices
    pins: NotRequired[Sequence[Selection]]

    # tools at the start
    tools: NotRequired[Sequence[Tool]]

    # blood vessels
    vessels: NotRequired[Sequence[Vessel]]

    # a scripted pull
    pull: NotRequired[Pull]

    # a scripted cut
    cut: NotRequired[Cut]


class ToolAdd(TypedDict):
    """adds a tool, which the caller drives"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
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

    # spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # largest angular speed of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # force above which a grasped vertex slips (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # largest force of the jaws on what they hold (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power to which the generator is set; for energy tissue (0 to 400 W)
    power_w: NotRequired[float]

    # largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # peak voltage over root mean square voltage (1.4 to 20)
    crest_factor: NotRequired[float]

    # largest current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of the force filter; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # name of the tool
    name: str

    # position of the tip at the start (-100 to 100 m)
    position_m: NotRequired[Sequence[float]]

    # unit quaternion w, x, y, z: tool frame (shaft along +z) to world
    rotation: NotRequired[Sequence[float]]

    # profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out
    instrument: NotRequired[str]

    # mode of the instrument (default: its first)
    mode: NotRequired[str]


class ToolRemove(TypedDict):
    """removes a tool"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str


class ToolConfigure(TypedDict):
    """replaces shape and sizes of a tool; a missing member takes the instrument's value, or the default"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
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

    # spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m)
    grid_step_m: NotRequired[float]

    # thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s)
    diffusivity_m2_s: NotRequired[float]

    # largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s)
    max_speed_m_s: NotRequired[float]

    # largest angular speed of the tool (0.1 to 100 rad/s)
    max_turn_rad_s: NotRequired[float]

    # Coulomb coefficient of the cold parts (0 to 2)
    friction: NotRequired[float]

    # viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
    drag_ns_m: NotRequired[float]

    # stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m)
    grasp_stiffness_n_m: NotRequired[float]

    # force above which a grasped vertex slips (0 to 1000 N)
    slip_force_n: NotRequired[float]

    # largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N)
    force_max_n: NotRequired[float]

    # largest force of the jaws on what they hold (0.01 to 1000 N)
    close_force_n: NotRequired[float]

    # power to which the generator is set; for energy tissue (0 to 400 W)
    power_w: NotRequired[float]

    # largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V)
    peak_v: NotRequired[float]

    # peak voltage over root mean square voltage (1.4 to 20)
    crest_factor: NotRequired[float]

    # largest current, root mean square (0.01 to 10 A)
    current_max_a: NotRequired[float]

    # time constant of the force filter; 0: no filter (0 to 1 s)
    force_filter_s: NotRequired[float]

    # heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K)
    blade_heat_j_k: NotRequired[float]

    # heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K)
    blade_cooling_w_k: NotRequired[float]

    # power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100)
    load_rise_off: NotRequired[float]

    # profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out
    instrument: NotRequired[str]

    # mode of the instrument (default: its first)
    mode: NotRequired[str]


class ToolMove(TypedDict):
    """moves a tool, at most at its largest speed; driver only"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str

    # position of the tip (-100 to 100 m)
    position_m: Sequence[float]

    # unit quaternion w, x, y, z
    rotation: Sequence[float]

    # opening of the jaws: 0 closed to 1 open (0 to 1)
    jaw: NotRequired[float]


class ToolEnergize(TypedDict):
    """turns energy on (driver only), for at most `ticks` ticks, or off"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str

    # whether energy is turned on or off
    energized: bool

    # energy goes off this many ticks after an enable; 0: no limit (0 to 2147483647)
    ticks: NotRequired[int]


class ToolGrasp(TypedDict):
    """closes the jaws on the tissue between them; driver only"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str


class ToolRelease(TypedDict):
    """opens the jaws; driver only"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str


class ToolHold(TypedDict):
    """keeps a tool where it is until it is moved again; driver only"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # name of the tool
    tool: str


class Pin(TypedDict):
    """pins vertices at their present positions"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which vertices
    selection: Selection


class Unpin(TypedDict):
    """releases pinned vertices"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # which vertices
    selection: Selection


# replaces the material of a layer
MaterialSet: TypeAlias = Union["MaterialSetFascia", "MaterialSetMembrane", "MaterialSetFat", "MaterialSetLinks"]


class MaterialSetFascia(TypedDict):
    """replaces the material of a layer"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # kind of the layer
    kind: Literal["fascia"]

    # name of the layer
    layer: str

    # number of a region in the mesh file; 0: the layer's own material (0 to 2147483647)
    region: NotRequired[int]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetMembrane(TypedDict):
    """replaces the material of a layer"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # kind of the layer
    kind: Literal["membrane"]

    # name of the layer
    layer: str

    # number of a region in the mesh file; 0: the layer's own material (0 to 2147483647)
    region: NotRequired[int]

    # sheet thickness (1e-06 to 0.05 m)
    thickness_m: NotRequired[float]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # stiffness k of the strain limit (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # bending stiffness; 0: bending is not resisted (0 to 10 N m)
    bending_stiffness_nm: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetFat(TypedDict):
    """replaces the material of a layer"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # kind of the layer
    kind: Literal["fat"]

    # name of the layer
    layer: str

    # number of a region in the mesh file; 0: the layer's own material (0 to 2147483647)
    region: NotRequired[int]

    # elastic law
    model: NotRequired[Literal["neohookean", "corotated", "stvk", "energy"]]

    # mass density (1 to 25000 kg/m^3)
    density_kg_m3: NotRequired[float]

    # Young's modulus (1 to 10000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # Poisson's ratio; at most 1/3 for model energy (0 to 0.45)
    poisson_ratio: NotRequired[float]

    # stiffness of the strain limit and shrinkage (1 to 10000000000 Pa)
    limit_stiffness_pa: NotRequired[float]

    # limit range: largest shear, the cosine of the angle between material axes (0 to 0.99)
    shear_max: NotRequired[float]

    # deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10)
    yield_strain: NotRequired[float]

    # largest plastic strain (gamma_2); 0: no plastic flow (0 to 10)
    plastic_strain_max: NotRequired[float]

    # strain limit
    limit: NotRequired[Literal["none", "target", "range"]]

    # how a target is projected
    projection: NotRequired[Literal["closed_form", "linearised"]]

    # target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100)
    target: NotRequired[Sequence[float]]

    # range: least engineering strain along each axis (-0.99 to 0)
    strain_min: NotRequired[Sequence[float]]

    # range: largest engineering strain along each axis (0 to 100)
    strain_max: NotRequired[Sequence[float]]

    # squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4)
    shrink: NotRequired[Sequence[float]]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class MaterialSetLinks(TypedDict):
    """replaces the material of a layer"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # kind of the layer
    kind: Literal["links"]

    # name of the layer
    layer: str

    # Young's modulus of a truss (1 to 100000000000 Pa)
    young_modulus_pa: NotRequired[float]

    # cross section of a truss (1e-12 to 1 m^2)
    area_m2: NotRequired[float]

    # length of the longest truss (1e-06 to 1 m)
    reach_m: NotRequired[float]

    # number of trusses from each vertex of the upper sheet (1 to 8)
    per_vertex: NotRequired[float]

    # tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC)
    ignition_c: NotRequired[float]

    # standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC)
    ignition_spread_c: NotRequired[float]

    # width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m)
    ignition_bundle_m: NotRequired[float]

    # rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s)
    absorption_per_s: NotRequired[float]

    # energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2)
    tear_energy_j_m2: NotRequired[float]


class GravitySet(TypedDict):
    """sets the gravity of a session"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # gravity (-100 to 100 m/s^2)
    gravity_m_s2: Sequence[float]


class ForceSet(TypedDict):
    """applies an outer force to vertices"""

    # id of the session (default: the session in the connection's URL)
    session: NotRequired[str]

    # see session_change (1 to 9007199254740991)
    client_sequence: NotRequired[int]

    # the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
    tick: NotRequired[int]

    # number that the driver gives the command (0 to 9007199254740991)
    sequence: NotRequired[int]

    # force on each chosen vertex (-1000 to 1000 N)
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
        """`hello`: must be the first message; before it no other request is served

        version: wire version wanted; this document is version 1 (1 to 1000)
        client: name and version of the client program, for logs and other users
        client_id: lasting identity of the client, unique among the clients of the token's owner; the stored answers of client_sequence belong to it
        token: access token, if the server needs one
        resume: resume token of an earlier hello: takes back the tools of that connection within 10 s of its loss, energy off
        role: wanted role, at most the role of the token (default: that role)
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
        """`heartbeat`: reports to the server that a driver is alive, every 100 ms while energy is on

        visible: false: the page is hidden or another window has the focus; energy goes off at once
        client_time_us: the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us)
        """
        return self.call("heartbeat", {
            "visible": visible,
            "client_time_us": client_time_us,
        })

    def scene_list(
        self,
    ) -> SceneList:
        """`scene.list`: lists the scenes of the daemon
        """
        return self.call("scene.list", {})

    def scene_get(
        self,
        *,
        scene: str,
    ) -> SceneResult:
        """`scene.get`: returns one scene with all members

        scene: name of the scene
        """
        return self.call("scene.get", {
            "scene": scene,
        })

    def instrument_list(
        self,
    ) -> InstrumentList:
        """`instrument.list`: lists the profiles of instruments
        """
        return self.call("instrument.list", {})

    def session_list(
        self,
    ) -> SessionList:
        """`session.list`: lists the sessions of the daemon
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
        name: name of the session, without the daemon's label (default: chosen by the server)
        scene: a scene of the daemon; give either this or definition
        definition: the scene itself; a mesh of source bytes names an upload in file
        paused: the session starts paused (default: false)
        ephemeral: the session is never stored; it ends with the connection that created it, or with the daemon (default: false)
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
        """`session.describe`: returns layers, drivers and scene of a session

        session: id of the session (default: the session in the connection's URL)
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
        """`session.join`: asks for frames; call it again to change the profile

        session: id of the session (default: the session in the connection's URL)
        rate_hz: largest number of frames in a second of wall time (default: 60) (0.1 to 1000 1/s)
        channels: channels (default: those marked in the table of channels)
        step_m: wanted quantisation step; the server may choose a finer step (default: 5e-5) (1e-07 to 0.001 m)
        plain: true: no section of the frames uses meshoptimizer's codec (default: false)
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
        """`session.leave`: ends the stream of frames

        session: id of the session (default: the session in the connection's URL)
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
        """`session.pause`: stops time at a tick border; energy goes off

        session: id of the session (default: the session in the connection's URL)
        client_sequence: number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991)
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
        """`session.resume`: resumes a paused session

        session: id of the session (default: the session in the connection's URL)
        client_sequence: number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991)
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
        """`session.step`: advances a paused session; the answer comes when the steps are done

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        ticks: number of steps (default: 1) (1 to 100000)
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
        """`session.advance`: advances a paused session in lock-step: commands, ticks and observation in one request. There is no client_sequence: `tick` shows whether the request was done

        session: id of the session (default: the session in the connection's URL)
        ticks: number of ticks; 0: only observe (default: 1) (0 to 100000)
        commands: commands to tools, before the first tick; if one is refused, none takes effect, except that requests to turn energy off do
        observe: what the answer contains (default: nothing)
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
        """`session.speed`: sets the speed of a session

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        speed: wanted simulated time over wall time (0.01 to 10)
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
        """`session.reset`: resets a session to tick 0, on a new branch

        session: id of the session (default: the session in the connection's URL)
        client_sequence: number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991)
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
        """`session.destroy`: ends a session and removes it from the store, also a session that the daemon could not start

        session: id of the session (default: the session in the connection's URL)
        client_sequence: number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991)
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
        """`session.fork`: creates a new session from the state of this session, energy off

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        name: name of the new session, without the daemon's label (default: chosen by the server)
        tick: tick of the state (default: the present tick) (0 to 9007199254740991)
        paused: the new session starts paused (default: false)
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

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        name: name of the snapshot (default: chosen by the server)
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
        """`session.snapshots`: lists the snapshots that session.restore can restore, also those of other branches

        session: id of the session (default: the session in the connection's URL)
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
        """`session.restore`: restores a snapshot

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        name: name of the snapshot
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
        """`session.rewind`: rewinds to a tick

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: a tick from oldest_tick of the timeline on, or one that a refusal names (0 to 9007199254740991)
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
        """`session.export`: returns the tissue as a file, which follows in binary chunks

        session: id of the session (default: the session in the connection's URL)
        format: format of the file
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
        """`session.log`: returns the command log as a script, which follows in binary chunks

        session: id of the session (default: the session in the connection's URL)
        from_tick: first tick (default: 0) (0 to 9007199254740991)
        to_tick: last tick (default: the present tick) (0 to 9007199254740991)
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
        """`session.timeline`: returns cuts and other events

        session: id of the session (default: the session in the connection's URL)
        from_tick: first tick (default: 0) (0 to 9007199254740991)
        count: largest number of events, the newest of them (default: 1024) (1 to 4096)
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
        """`session.frame_at`: returns the key frame of a past tick without a rewind; binary chunks follow. A second request of a client cancels its first

        session: id of the session (default: the session in the connection's URL)
        tick: tick on the present branch, from oldest_tick to the present (0 to 9007199254740991)
        channels: channels (default: those marked in the table of channels)
        step_m: quantisation step (default: 5e-5) (1e-07 to 0.001 m)
        plain: true: no section of the frame uses meshoptimizer's codec (default: false)
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
        """`session.frame_cancel`: cancels the running session.frame_at of the client, if there is one

        session: id of the session (default: the session in the connection's URL)
        """
        return self.call("session.frame_cancel", {
            "session": session,
        })

    def session_waiting(
        self,
        *,
        session: str | None = None,
    ) -> WaitingList:
        """`session.waiting`: lists the commands that wait for later ticks

        session: id of the session (default: the session in the connection's URL)
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
        """`session.cancel`: cancels waiting commands of the caller; with a number and role admin, of any client. Each cancelled command is answered with `bad_state`

        session: id of the session (default: the session in the connection's URL)
        number: number of the command, from session.waiting (default: all commands of the caller) (1 to 9007199254740991)
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
        """`stream.key_frame`: asks for a key frame, at most once a second

        session: id of the session (default: the session in the connection's URL)
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
        """`tool.add`: adds a tool, which the caller drives

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        shape: shape
        hot_radius_m: radius of the hot part (0.0002 to 0.05 m)
        tip_length_m: length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
        shaft_radius_m: radius of the shaft (0.0002 to 0.05 m)
        shaft_length_m: length of the shaft (0.001 to 1 m)
        jaw_open_rad: angle between open jaws (0.05 to 1.5 rad)
        temperature_c: temperature of the hot part while energized (0 to 1500 degC)
        grid_cells: nodes of the heat grid along each axis (8 to 64)
        grid_step_m: spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m)
        diffusivity_m2_s: thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s)
        max_speed_m_s: largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s)
        max_turn_rad_s: largest angular speed of the tool (0.1 to 100 rad/s)
        friction: Coulomb coefficient of the cold parts (0 to 2)
        drag_ns_m: viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
        grasp_stiffness_n_m: stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m)
        slip_force_n: force above which a grasped vertex slips (0 to 1000 N)
        force_max_n: largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N)
        close_force_n: largest force of the jaws on what they hold (0.01 to 1000 N)
        power_w: power to which the generator is set; for energy tissue (0 to 400 W)
        peak_v: largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V)
        crest_factor: peak voltage over root mean square voltage (1.4 to 20)
        current_max_a: largest current, root mean square (0.01 to 10 A)
        force_filter_s: time constant of the force filter; 0: no filter (0 to 1 s)
        blade_heat_j_k: heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K)
        blade_cooling_w_k: heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K)
        load_rise_off: power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100)
        name: name of the tool
        position_m: position of the tip at the start (-100 to 100 m)
        rotation: unit quaternion w, x, y, z: tool frame (shaft along +z) to world
        instrument: profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out
        mode: mode of the instrument (default: its first)
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
        """`tool.remove`: removes a tool

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
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
        """`tool.configure`: replaces shape and sizes of a tool; a missing member takes the instrument's value, or the default

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
        shape: shape
        hot_radius_m: radius of the hot part (0.0002 to 0.05 m)
        tip_length_m: length of needle, hook foot, blade or jaws (0.001 to 0.1 m)
        shaft_radius_m: radius of the shaft (0.0002 to 0.05 m)
        shaft_length_m: length of the shaft (0.001 to 1 m)
        jaw_open_rad: angle between open jaws (0.05 to 1.5 rad)
        temperature_c: temperature of the hot part while energized (0 to 1500 degC)
        grid_cells: nodes of the heat grid along each axis (8 to 64)
        grid_step_m: spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m)
        diffusivity_m2_s: thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s)
        max_speed_m_s: largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s)
        max_turn_rad_s: largest angular speed of the tool (0.1 to 100 rad/s)
        friction: Coulomb coefficient of the cold parts (0 to 2)
        drag_ns_m: viscous drag of the hot part on each vertex in it (0 to 100 N s/m)
        grasp_stiffness_n_m: stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m)
        slip_force_n: force above which a grasped vertex slips (0 to 1000 N)
        force_max_n: largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N)
        close_force_n: largest force of the jaws on what they hold (0.01 to 1000 N)
        power_w: power to which the generator is set; for energy tissue (0 to 400 W)
        peak_v: largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V)
        crest_factor: peak voltage over root mean square voltage (1.4 to 20)
        current_max_a: largest current, root mean square (0.01 to 10 A)
        force_filter_s: time constant of the force filter; 0: no filter (0 to 1 s)
        blade_heat_j_k: heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K)
        blade_cooling_w_k: heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K)
        load_rise_off: power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100)
        instrument: profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out
        mode: mode of the instrument (default: its first)
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
        """`tool.move`: moves a tool, at most at its largest speed; driver only

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
        position_m: position of the tip (-100 to 100 m)
        rotation: unit quaternion w, x, y, z
        jaw: opening of the jaws: 0 closed to 1 open (0 to 1)
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
        """`tool.energize`: turns energy on (driver only), for at most `ticks` ticks, or off

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
        energized: whether energy is turned on or off
        ticks: energy goes off this many ticks after an enable; 0: no limit (0 to 2147483647)
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
        """`tool.grasp`: closes the jaws on the tissue between them; driver only

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
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
        """`tool.release`: opens the jaws; driver only

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
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
        """`tool.hold`: keeps a tool where it is until it is moved again; driver only

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        tool: name of the tool
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
        """`tool.take_over`: makes the caller the driver, if the tool has no driver or the caller has role admin; energy goes off

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tool: name of the tool
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
        """`tool.request_takeover`: asks the driver for the tool; the driver receives takeover.requested

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tool: name of the tool
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
        """`tool.hand_over`: gives up a tool or hands it to another client; energy goes off; driver only

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tool: name of the tool
        client: connection that becomes the driver (default: the tool has no driver) (1 to 4294967295)
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
        """`pin`: pins vertices at their present positions

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
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
        """`unpin`: releases pinned vertices

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
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
        """`material.set`: replaces the material of a layer
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
        """`gravity.set`: sets the gravity of a session

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
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
        """`force.set`: applies an outer force to vertices

        session: id of the session (default: the session in the connection's URL)
        client_sequence: see session_change (1 to 9007199254740991)
        tick: the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991)
        sequence: number that the driver gives the command (0 to 9007199254740991)
        force_n: force on each chosen vertex (-1000 to 1000 N)
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

        name: name of the upload, for meshes[].file of source bytes with the ending of file_name
        file_name: file name for messages and names of sessions; the format is recognised from the bytes
        byte_count: exact size of the file (1 to 9007199254740991 B)
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
        """`upload.end`: checks length and hash of an upload

        transfer: number from upload.begin (1 to 4294967295)
        sha256: SHA-256 of the file, 64 lower-case hex digits
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
        """`mesh.read`: reads an upload as a mesh; returns a report, and a scene with the mesh for session.create

        upload: name of a complete upload, as in upload.begin
        unit_m: metres in one unit of the file (default: guessed from the size of the mesh, if that is clear) (1e-09 to 1000 m)
        as_: fat (tetrahedra) or fascia (triangles); default: fat if the file has tetrahedra or a closed surface
        strict: true: refuse a mesh that needs repair (default: false)
        as_it_is: true: never fill the mesh with tetrahedra; for scenes that a client writes itself (default: false)
        edge_m: edge length of the tetrahedra that fill the mesh (default: gives about 8,000 tetrahedra) (1e-06 to 10 m)
        labels: labels of a segmentation to keep, as in 1,3 (default: all)
        pin: pinned sides: bottom, top, left, right, front, back, with commas, or none (default: bottom)
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
        """`upload.discard`: removes an upload; sessions that use it stay

        name: name of the upload, which may be complete or still arriving
        """
        return self.call("upload.discard", {
            "name": name,
        })

    def store_backup(
        self,
        *,
        name: str | None = None,
    ) -> StoreCopy:
        """`store.backup`: copies the daemon's store to a file on its machine, without interrupting clients; one copy at a time

        name: name of the copy, without .db (default: the time); no file is replaced
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
        """`move.begin`: begins to move a session to another daemon; the session is served meanwhile

        session: id of the session on this daemon
        target: id of the session on the target daemon
        label: label of the target daemon
        url: address of the target daemon, for clients that use the old id; empty if one address leads to all daemons
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
        """`move.read`: returns the next piece of the session, which follows in binary chunks

        session: id of the session on the daemon that is asked
        move: name of the move, from move.begin
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

        session: id of the session on the daemon that is asked
        move: name of the move, from move.begin
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
        """`move.commit`: ends the session here, given the receipt for all pieces; the answer has the proof with which the target daemon serves the session

        session: id of the session on this daemon
        move: name of the move, from move.begin
        receipt: receipt of the last move.receive on the target daemon
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
        """`move.cancel`: cancels the move, unless the session has moved already: the answer says which

        session: id of the session on the daemon that is asked
        move: name of the move, from move.begin
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
        """`move.receive`: delivers an upload as a piece of an arriving session; the answer comes when the piece is on the disk

        session: id of the session on this daemon
        move: name of the move, from move.begin
        upload: upload that holds the piece; this request removes the upload
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
        """`move.ready`: builds the arrived session; the answer comes when the session could soon be served

        session: id of the session on the daemon that is asked
        move: name of the move, from move.begin
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
        """`move.accept`: serves the arrived session, given the proof of move.commit; the answer comes when the session is served

        session: id of the session on this daemon
        move: name of the move, from move.begin
        proof: proof from move.commit
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
        """`move.forget`: removes the pieces of a move, given the release of move.cancel

        session: id of the session on this daemon
        move: name of the move, from move.begin
        release: release from move.cancel
        source_lost: instead of a release: the source daemon is lost for good. If it had decided the move, the session is lost
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
        """`move.list`: lists sessions that arrive, are in doubt, are leaving, or have moved away
        """
        return self.call("move.list", {})
