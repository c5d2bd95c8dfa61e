// SPDX-License-Identifier: Apache-2.0
// Generated from protocol/include/cautery/*.def and the codec's tables; do not edit.
// After a change there, build the target `messages`.

export const WIRE_VERSION = 1;
export const SUBPROTOCOL = 'cautery.v1';

/** no members */
export type Nothing = Record<string, never>;

/** the first message on a connection */
export interface Hello {
  /** wire version wanted; this document is version 1 (1 to 1000) */
  version: number;
  /** name and version of the client program, for logs and other users */
  client: string;
  /** lasting identity of the client, unique among the clients of the token's owner; the stored answers of client_sequence belong to it */
  client_id?: string;
  /** access token, if the server needs one */
  token?: string;
  /** resume token of an earlier hello: takes back the tools of that connection within 10 s of its loss, energy off */
  resume?: string;
  /** wanted role, at most the role of the token (default: that role) */
  role?: 'view' | 'operate' | 'admin';
}

/** limits of the server; a client that exceeds one gets an error or a close code */
export interface Limits {
  /** largest text message (1 to 9007199254740991 B) */
  message_bytes_max: number;
  /** largest upload (0 to 9007199254740991 B) */
  upload_bytes_max: number;
  /** largest size of all uploads of the connection; an upload below 64 KiB counts as 64 KiB (0 to 9007199254740991 B) */
  uploads_bytes_max?: number;
  /** largest data of one binary chunk (1 to 9007199254740991 B) */
  chunk_bytes_max: number;
  /** largest number of sessions of the daemon (0 to 9007199254740991) */
  sessions_max: number;
  /** largest number of connections of the daemon (0 to 9007199254740991) */
  subscribers_max: number;
  /** largest number of different stream profiles of a session (1 to 4) */
  profiles_max: number;
  /** largest number of streams of a connection (1 to 64) */
  streams_max?: number;
  /** largest number of tools of a session (1 to 8) */
  tools_max: number;
  /** largest number of requests of a connection in a second (1 to 9007199254740991 1/s) */
  requests_per_s_max: number;
  /** largest number of tool.move notifications of a connection in a second (1 to 9007199254740991 1/s) */
  motions_per_s_max: number;
  /** bytes of unsent frames above which frames are skipped (1 to 9007199254740991 B) */
  bytes_in_flight_max: number;
  /** longest time between two messages of a driver before its energy goes off (0.01 to 60 s) */
  heartbeat_s: number;
}

/** who the server is and what the client may do */
export interface HelloResult {
  /** name and version of the server */
  server: string;
  /** wire version spoken from now on (1 to 1000) */
  version: number;
  /** the daemon's label; session ids start with it */
  daemon: string;
  /** role of this connection */
  role: 'view' | 'operate' | 'admin';
  /** number of the connection, which frames give as the number of the driver (1 to 4294967295) */
  client: number;
  /** as given, or chosen by the server */
  client_id: string;
  /** resume token for a later hello */
  resume: string;
  /** what this server can do */
  capabilities: ('upload' | 'export' | 'dds' | 'store')[];
  /** limits of this connection */
  limits: Limits;
  /** the server's monotonic clock, as in frames (0 to 9007199254740991 us) */
  server_time_us: number;
  /** the server's wall clock since 1970 (0 to 1000000000000 s) */
  wall_time_s: number;
}

/** reports to the server that a driver is alive; a notification, or a request to measure the clock offset */
export interface Heartbeat {
  /** false: the page is hidden or another window has the focus; energy goes off at once */
  visible: boolean;
  /** the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us) */
  client_time_us?: number;
}

/** clocks from which the client computes their offset */
export interface HeartbeatResult {
  /** the server's monotonic clock (0 to 9007199254740991 us) */
  server_time_us: number;
  /** as given in the heartbeat (0 to 9007199254740991 us) */
  client_time_us?: number;
}

/** a scene from which sessions can be created */
export interface SceneSummary {
  /** name of the scene */
  name: string;
  /** description in words */
  description: string;
}

/** all scenes of the daemon */
export interface SceneList {
  /** sorted by name */
  scenes: SceneSummary[];
}

/** names a scene */
export interface SceneRef {
  /** name of the scene */
  scene: string;
}

/** a whole scene, which can be changed and sent to session.create */
export interface SceneResult {
  /** the scene with every member, also defaults */
  definition: Scene;
}

/** settings of the generator in a mode of an instrument; the members are those of a tool */
export interface InstrumentMode {
  /** name of the mode */
  mode: string;
  /** description in words */
  description: string;
  /** power, if no other power is given (0 to 400 W) */
  power_w: number;
  /** least power of the mode (0 to 400 W) */
  power_least_w: number;
  /** largest power of the mode (0 to 400 W) */
  power_most_w: number;
  /** largest peak voltage (1 to 10000 V) */
  peak_v: number;
  /** peak voltage over root mean square voltage; the duty cycle is 2 / crest_factor^2 (1.4 to 20) */
  crest_factor: number;
  /** largest current, root mean square (0.01 to 10 A) */
  current_max_a: number;
  /** power ends when the load reaches this multiple of its minimum; 0: never (0 to 100) */
  load_rise_off: number;
}

/** profile of an instrument, which a tool of a scene, tool.add and tool.configure can name */
export interface Instrument {
  /** name of the instrument */
  name: string;
  /** description in words */
  description: string;
  /** shape of the tool */
  shape: string;
  /** modes; the first is the default */
  modes: InstrumentMode[];
}

/** all profiles of instruments */
export interface InstrumentList {
  /** sorted by name */
  instruments: Instrument[];
}

/** names a session */
export interface SessionRef {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
}

/** names a session to change */
export interface SessionChange {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** number of this change among those of the client_id; a repeated number returns the first answer (1 to 9007199254740991) */
  client_sequence?: number;
}

/** a session in a list */
export interface SessionSummary {
  /** id of the session */
  session: string;
  /** scene from which the session was created */
  scene: string;
  /** state of the session */
  state: 'starting' | 'running' | 'paused' | 'faulted';
  /** steps since creation, along the present branch (0 to 9007199254740991) */
  tick: number;
  /** simulated time (0 to 1000000000000 s) */
  time_s: number;
  /** length of one tick (0.0001 to 1 s) */
  step_s: number;
  /** wanted simulated time over wall time (0 to 100) */
  speed: number;
  /** reached simulated time over wall time, in the last second (0 to 1000000) */
  realtime_factor: number;
  /** number of vertices (0 to 16777216) */
  vertex_count: number;
  /** number of faces, drawn or not (0 to 16777216) */
  face_count: number;
  /** number of tools (0 to 8) */
  tool_count: number;
  /** number of streams (0 to 9007199254740991) */
  subscriber_count: number;
  /** epoch of the frames; it changes with each rewind, reset, restore and restart */
  epoch: string;
  /** reason why the session is faulted */
  fault?: string;
  /** false: the session is ephemeral; in an answer to session.pause: the store was full, but the session pauses */
  stored?: boolean;
  /** stage of the builder while the session starts, is rewound or restored (meshing, ordering, factoring, settling; reading, restoring, replaying) */
  stage?: string;
}

/** all sessions of the daemon */
export interface SessionList {
  /** sorted by id */
  sessions: SessionSummary[];
}

/** creates a session from a scene of the daemon or from a given scene */
export interface SessionCreate {
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the session, without the daemon's label (default: chosen by the server) */
  name?: string;
  /** a scene of the daemon; give either this or definition */
  scene?: string;
  /** the scene itself; a mesh of source bytes names an upload in file */
  definition?: Scene;
  /** the session starts paused (default: false) */
  paused?: boolean;
  /** the session is never stored; it ends with the connection that created it, or with the daemon (default: false) */
  ephemeral?: boolean;
}

/** a layer and its range in the face list */
export interface LayerDescription {
  /** name of the layer in the scene */
  name: string;
  /** kind of tissue */
  kind: 'fascia' | 'membrane' | 'fat' | 'links';
  /** index of the first face of the layer (0 to 16777216) */
  first_face: number;
  /** number of faces; 0 for links (0 to 16777216) */
  face_count: number;
  /** number of triangles, tetrahedra or links (0 to 16777216) */
  element_count: number;
}

/** the client that drives a tool */
export interface Driver {
  /** name of the tool */
  tool: string;
  /** number of the connection that drives the tool; 0: no driver (0 to 4294967295) */
  client: number;
  /** name that the client gave in hello, or name of the DDS participant */
  name: string;
  /** whether the energy of the tool is on */
  energized: boolean;
  /** reason why energy is off; without meaning while energy is on */
  energy_off: 'never_enabled' | 'commanded' | 'watchdog' | 'restored' | 'taken_over';
}

/** everything that a client must know about a session */
export interface SessionDescription {
  /** as in session.list */
  summary: SessionSummary;
  /** description of the scene in words */
  description: string;
  /** instruction set that this machine uses; results are equal to the bit only within one */
  instruction_set: string;
  /** number of triangles of sheets (0 to 9007199254740991) */
  triangle_count: number;
  /** number of tetrahedra of fat (0 to 9007199254740991) */
  tetrahedron_count: number;
  /** number of links (0 to 9007199254740991) */
  link_count: number;
  /** in the order of the scene */
  layers: LayerDescription[];
  /** one for each tool, in the order of frames */
  drivers: Driver[];
  /** the scene with the present materials, tools and gravity */
  definition: Scene;
}

/** advances a paused session */
export interface SessionStep {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** number of steps (default: 1) (1 to 100000) */
  ticks?: number;
}

/** a command to a tool, before the first tick; the members are those of the method that it names */
export interface AdvanceCommand {
  /** method of the command */
  method: 'tool.move' | 'tool.energize' | 'tool.grasp' | 'tool.release' | 'tool.hold';
  /** a tool that the client drives; any tool to turn energy off */
  tool: string;
  /** number that the driver gives the command; frames show the number of the last command applied (0 to 9007199254740991) */
  sequence?: number;
  /** tool.move: position of the tip (-100 to 100 m) */
  position_m?: [number, number, number];
  /** tool.move: unit quaternion w, x, y, z (-1.001 to 1.001) */
  rotation?: [number, number, number, number];
  /** tool.move: opening of the jaws, 0 closed (default) to 1 open (0 to 1) */
  jaw?: number;
  /** tool.energize: whether energy is turned on or off */
  energized?: boolean;
  /** tool.energize: energy goes off after this many ticks; 0 (default): no limit (0 to 2147483647) */
  ticks?: number;
}

/** a box (least_m, most_m) or a ball (center_m, radius_m); it contains the elements whose middle is inside while the tissue is at rest */
export interface ObservedRegion {
  /** name of the region, which the answer repeats */
  name: string;
  /** least corner of the box (-100 to 100 m) */
  least_m?: [number, number, number];
  /** largest corner of the box (-100 to 100 m) */
  most_m?: [number, number, number];
  /** centre of the ball (-100 to 100 m) */
  center_m?: [number, number, number];
  /** radius of the ball (0 to 100 m) */
  radius_m?: number;
}

/** what the answer to session.advance contains, besides tick and time */
export interface Observe {
  /** positions, mask, tools, vessels, and scalars by their names; not `statistics`, which is only in frames */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** vertices of positions and scalars, in this order (default: all) (0 to 16777215) */
  vertices?: number[];
  /** regions for which removed volume and damage are reported */
  regions?: ObservedRegion[];
  /** whether the energy of instruments is reported (default: false) */
  energy?: boolean;
}

/** advances a paused session in lock-step */
export interface SessionAdvance {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** number of ticks; 0: only observe (default: 1) (0 to 100000) */
  ticks?: number;
  /** commands to tools, before the first tick; if one is refused, none takes effect, except that requests to turn energy off do */
  commands?: AdvanceCommand[];
  /** what the answer contains (default: nothing) */
  observe?: Observe;
}

/** values of a scalar channel */
export interface ObservedScalar {
  /** name of the channel */
  channel: 'positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact';
  /** value of each vertex, in the unit of the channel (-1e+300 to 1e+300) */
  values: number[];
}

/** present state of a tool */
export interface ObservedTool {
  /** name of the tool */
  tool: string;
  /** position of the tip in the actual pose, which tissue can hold back (-1000000 to 1000000 m) */
  position_m: [number, number, number];
  /** rotation of the actual pose, quaternion w, x, y, z (-1.001 to 1.001) */
  rotation: [number, number, number, number];
  /** actual opening of the jaws, 0 closed to 1 open (0 to 1) */
  jaw: number;
  /** whether the energy of the tool is on */
  energized: boolean;
  /** reason why energy is off; belongs to the session, not to the simulated state */
  energy_off?: 'never_enabled' | 'commanded' | 'watchdog' | 'restored' | 'taken_over';
  /** force of the tissue on the tool, filtered with force_filter_s; at most force_max_n (-1000000 to 1000000 N) */
  force_n: [number, number, number];
  /** torque about the tip, filtered as the force; at most force_max_n times tip_length_m (-1000000 to 1000000 N m) */
  torque_nm: [number, number, number];
  /** force in the last tick, without filter and limit (-1000000000000 to 1000000000000 N) */
  raw_force_n: [number, number, number];
  /** torque about the tip in the last tick, without filter and limit (-1000000000000 to 1000000000000 N m) */
  raw_torque_nm: [number, number, number];
  /** temperature of the hot part (-300 to 1000000 degC) */
  tip_temperature_c: number;
  /** estimate of the heat that tissue took up (0 to 1000000000000 J) */
  energy_j: number;
  /** with energy `tissue`: power given to tissue in the last tick; else 0 (0 to 1000000 W) */
  power_w: number;
  /** load of the generator; 0: no current flows (0 to 1000000000000 ohm) */
  load_ohm: number;
  /** number of vertices that the tool touches (0 to 9007199254740991) */
  contact_vertices: number;
  /** number of points that the jaws hold (0 to 9007199254740991) */
  grasped_vertices: number;
  /** number of the last command applied (0 to 9007199254740991) */
  sequence: number;
}

/** present state of a blood vessel */
export interface ObservedVessel {
  /** name of the vessel */
  vessel: string;
  /** whether the vessel is parted somewhere */
  parted: boolean;
  /** whether the wall of the vessel has a hole somewhere */
  pierced: boolean;
  /** whether the vessel is pressed so flat somewhere that no blood flows */
  shut: boolean;
  /** whether a seal withstands the blood pressure */
  sealed: boolean;
  /** whether blood leaves the vessel */
  bleeds: boolean;
  /** flow of blood out of the vessel in the last tick (0 to 1 m^3/s) */
  bleeding_m3_s: number;
  /** volume of blood that has left the vessel since the session began (0 to 1000000 m^3) */
  shed_m3: number;
  /** predicted pressure at which the best seal opens; 0: no seal (0 to 1000000000000 Pa) */
  burst_pa: number;
}

/** damage by heat and force, in volumes of the tissue at rest; links have no volume */
export interface ObservedDamage {
  /** number of tetrahedra and triangles that were removed (0 to 9007199254740991) */
  removed_count: number;
  /** volume of the removed elements (0 to 1000000000 m^3) */
  removed_m3: number;
  /** volume of the present elements, each weighted with the mean exposure of its vertices (0 to 1000000000 m^3) */
  damaged_m3: number;
}

/** damage inside and outside of a region */
export interface RegionDamage {
  /** name of the region */
  name: string;
  /** damage inside the region */
  inside: ObservedDamage;
  /** damage outside the region */
  outside: ObservedDamage;
}

/** where the energy of instruments went since the session was created; delivered_j and blade_j together are the sum of the members after far_j; with energy `paper` all members are 0 */
export interface ObservedEnergy {
  /** energy that current delivered in tissue (-1000000000000 to 1000000000000 J) */
  delivered_j: number;
  /** heat from blades into tissue; below 0: from tissue into blades (-1000000000000 to 1000000000000 J) */
  blade_j: number;
  /** energy of current far from the tool, where no heat is computed; not part of the sum (-1000000000000 to 1000000000000 J) */
  far_j: number;
  /** heat of the tissue above its temperature at the start (-1000000000000 to 1000000000000 J) */
  stored_j: number;
  /** energy carried away by water that boiled off, as steam and smoke (-1000000000000 to 1000000000000 J) */
  boiled_j: number;
  /** energy carried away by blood (-1000000000000 to 1000000000000 J) */
  perfused_j: number;
  /** energy lost at surfaces (-1000000000000 to 1000000000000 J) */
  ambient_j: number;
  /** heat of tissue that was removed (-1000000000000 to 1000000000000 J) */
  shed_j: number;
  /** volume of present tissue that heat has killed (0 to 1000000000 m^3) */
  coagulated_m3: number;
  /** rate at which water boiled off in the last tick (0 to 1000000 kg/s) */
  vapour_kg_s: number;
}

/** the ticks were computed; the observed values */
export interface Advanced {
  /** present tick of the session (0 to 9007199254740991) */
  tick: number;
  /** simulated time (0 to 1000000000000 s) */
  time_s: number;
  /** number of computed ticks; fewer than requested if lock-step ended meanwhile (0 to 100000) */
  ticks: number;
  /** whether the ticks are on the disk; false for ephemeral sessions */
  stored: boolean;
  /** x, y, z of the vertices (-1000000 to 1000000 m) */
  positions_m?: number[];
  /** words of 32 faces, the lowest bit first; a set bit: the face is not drawn (0 to 4294967295) */
  mask?: number[];
  /** in the order of the channels */
  scalars?: ObservedScalar[];
  /** in the order in which the tools were added */
  tools?: ObservedTool[];
  /** in the order of the scene */
  vessels?: ObservedVessel[];
  /** in the order of the request */
  regions?: RegionDamage[];
  /** energy of the whole session */
  energy?: ObservedEnergy;
}

/** sets the speed of a session */
export interface SessionSpeed {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** wanted simulated time over wall time (0.01 to 10) */
  speed: number;
}

/** creates a new session from the state of this session */
export interface SessionFork {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the new session, without the daemon's label (default: chosen by the server) */
  name?: string;
  /** tick of the state (default: the present tick) (0 to 9007199254740991) */
  tick?: number;
  /** the new session starts paused (default: false) */
  paused?: boolean;
}

/** stores the state of a session under a name */
export interface SessionSnapshot {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the snapshot (default: chosen by the server) */
  name?: string;
}

/** a stored state */
export interface SnapshotResult {
  /** name of the snapshot, for session.restore */
  name: string;
  /** tick of the state (0 to 9007199254740991) */
  tick: number;
  /** hash of the whole state */
  hash: string;
  /** bytes stored for the state; 0: the state can be reached from an earlier checkpoint and the log (0 to 9007199254740991 B) */
  byte_count: number;
}

/** a snapshot of a session */
export interface NamedSnapshot {
  /** name of the snapshot, for session.restore */
  name: string;
  /** tick of the state (0 to 9007199254740991) */
  tick: number;
  /** number of the branch of the snapshot (0 to 9007199254740991) */
  branch: number;
}

/** all snapshots of a session */
export interface SnapshotList {
  /** sorted by tick */
  snapshots: NamedSnapshot[];
}

/** restores a snapshot on a new branch; energy goes off */
export interface SessionRestore {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the snapshot */
  name: string;
}

/** rewinds to a tick on a new branch; energy goes off */
export interface SessionRewind {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** a tick from oldest_tick of the timeline on, or one that a refusal names (0 to 9007199254740991) */
  tick: number;
}

/** state of a session after a rewind, restore or reset */
export interface Restored {
  /** tick of the state (0 to 9007199254740991) */
  tick: number;
  /** epoch of the frames from now on */
  epoch: string;
  /** number of the branch in the store (0 to 9007199254740991) */
  branch: number;
  /** false: another build or instruction set wrote the state, so later ticks may differ in the last digits */
  exact: boolean;
}

/** asks for the tissue as a file */
export interface SessionExport {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** format of the file */
  format: 'vtu' | 'obj';
}

/** asks for the command log as a script for cautery-sim */
export interface SessionLog {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** first tick (default: 0) (0 to 9007199254740991) */
  from_tick?: number;
  /** last tick (default: the present tick) (0 to 9007199254740991) */
  to_tick?: number;
}

/** a file that follows in binary chunks */
export interface Transfer {
  /** number of the transfer in the headers of the chunks (1 to 4294967295) */
  transfer: number;
  /** proposed file name */
  file_name: string;
  /** media type of the file */
  media_type: string;
  /** size of the file (0 to 9007199254740991 B) */
  byte_count: number;
  /** SHA-256 of the file, 64 lower-case hex digits */
  sha256: string;
}

/** asks for the events of a session */
export interface SessionTimeline {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** first tick (default: 0) (0 to 9007199254740991) */
  from_tick?: number;
  /** largest number of events, the newest of them (default: 1024) (1 to 4096) */
  count?: number;
}

/** an event on the present branch */
export interface TimelineEvent {
  /** tick of the event (0 to 9007199254740991) */
  tick: number;
  /** simulated time (0 to 1000000000000 s) */
  time_s: number;
  /** kind of the event */
  kind: 'created' | 'cut' | 'tear' | 'inverted' | 'energy_gain' | 'bleeding' | 'bleeding_stopped' | 'sealed' | 'energy_on' | 'energy_off' | 'watchdog' | 'driver' | 'tool_added' | 'tool_removed' | 'refused' | 'fault' | 'rewind' | 'reset' | 'snapshot' | 'restore';
  /** tool of the event */
  tool?: string;
  /** client that caused the event */
  client?: string;
  /** cut: number of removed elements; refused: number of commands (0 to 9007199254740991) */
  count?: number;
  /** details in words */
  detail?: string;
}

/** events of a session, and the oldest tick that can be reached */
export interface Timeline {
  /** present tick (0 to 9007199254740991) */
  tick: number;
  /** every tick from this tick on can be reached (0 to 9007199254740991) */
  oldest_tick: number;
  /** number of the present branch (0 to 9007199254740991) */
  branch: number;
  /** oldest first; cuts within 30 ticks are one event */
  events: TimelineEvent[];
}

/** when a change takes effect */
export interface TickResult {
  /** tick border at which the change takes effect (0 to 9007199254740991) */
  tick: number;
}

/** asks for the picture of a past tick; the session continues and does not change */
export interface SessionFrameAt {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** tick on the present branch, from oldest_tick to the present (0 to 9007199254740991) */
  tick: number;
  /** channels (default: those marked in the table of channels) */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** quantisation step (default: 5e-5) (1e-07 to 0.001 m) */
  step_m?: number;
  /** true: no section of the frame uses meshoptimizer's codec (default: false) */
  plain?: boolean;
}

/** one key frame, which follows in binary chunks, and what a decoder needs besides the topology; the tools in the frame have no drivers */
export interface PastFrame {
  /** number of the transfer in the headers of the chunks (1 to 4294967295) */
  transfer: number;
  /** proposed file name */
  file_name: string;
  /** media type of the file */
  media_type: string;
  /** size of the frame (0 to 9007199254740991 B) */
  byte_count: number;
  /** SHA-256 of the frame, 64 lower-case hex digits */
  sha256: string;
  /** tick that the frame shows (0 to 9007199254740991) */
  tick: number;
  /** true: equal to the bit to the past state; false: replayed by another build or instruction set */
  exact: boolean;
  /** session number in the frame's header (0 to 4294967295) */
  session_number: number;
  /** profile in the frame's header (0 to 3) */
  profile: number;
  /** epoch in the frame's header, which no stream has */
  epoch: string;
  /** channels of the frame */
  channels: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** number of vertices in positions and scalars (0 to 16777216) */
  vertex_count: number;
  /** number of faces in the mask (0 to 16777216) */
  face_count: number;
  /** position of the quantised zero (-1000000 to 1000000 m) */
  origin_m: [number, number, number];
  /** length of one quantised step (1e-07 to 0.01 m) */
  step_m: number;
  /** one step of the stress channel (0.001 to 1000000000 Pa) */
  stress_step_pa: number;
}

/** progress of a past view */
export interface FrameProgress {
  /** id of the session */
  session: string;
  /** tick of the past view (0 to 9007199254740991) */
  tick: number;
  /** present stage of the work */
  stage: 'building' | 'reading' | 'restoring' | 'replaying';
  /** tick at which the replay began (0 to 9007199254740991) */
  from_tick: number;
  /** tick that the replay has reached (0 to 9007199254740991) */
  at_tick: number;
}

/** asks the daemon to copy its store */
export interface StoreBackup {
  /** name of the copy, without .db (default: the time); no file is replaced */
  name?: string;
}

/** a checked copy of the store, as it was at one moment */
export interface StoreCopy {
  /** path of the copy on the daemon's machine */
  file: string;
  /** size of the copy (0 to 9007199254740991 B) */
  byte_count: number;
}

/** begins to move a session to another daemon */
export interface MoveBegin {
  /** id of the session on this daemon */
  session: string;
  /** id of the session on the target daemon */
  target: string;
  /** label of the target daemon */
  label: string;
  /** address of the target daemon, for clients that use the old id; empty if one address leads to all daemons */
  url?: string;
}

/** a move has begun */
export interface MoveBegun {
  /** name of the move */
  move: string;
}

/** names a move */
export interface MoveRef {
  /** id of the session on the daemon that is asked */
  session: string;
  /** name of the move, from move.begin */
  move: string;
}

/** the state at which a session is suspended */
export interface MoveHeld {
  /** tick of the state (0 to 9007199254740991) */
  tick: number;
  /** hash of the state */
  hash: string;
  /** true: the state of the other daemon was restored to the bit; false: another build or instruction set wrote it, so later ticks may differ in the last digits */
  exact?: boolean;
}

/** result of a move */
export interface MoveDecision {
  /** false: the session stays, and this move can no longer happen */
  moved: boolean;
  /** id of the session on the target daemon */
  target?: string;
  /** proof with which the target daemon may serve the session */
  proof?: string;
  /** if the session stays: release with which the target daemon may forget the move */
  release?: string;
}

/** delivers a piece of a session */
export interface MoveReceive {
  /** id of the session on this daemon */
  session: string;
  /** name of the move, from move.begin */
  move: string;
  /** upload that holds the piece; this request removes the upload */
  upload: string;
}

/** a piece is on the disk of the target daemon */
export interface MoveReceived {
  /** number of pieces on the disk (0 to 9007199254740991) */
  pieces: number;
  /** after the last piece: receipt that proves to the source daemon that all pieces are on the disk */
  receipt?: string;
}

/** informs the source daemon that the target daemon has all pieces */
export interface MoveCommit {
  /** id of the session on this daemon */
  session: string;
  /** name of the move, from move.begin */
  move: string;
  /** receipt of the last move.receive on the target daemon */
  receipt: string;
}

/** removes the pieces of a move */
export interface MoveForget {
  /** id of the session on this daemon */
  session: string;
  /** name of the move, from move.begin */
  move: string;
  /** release from move.cancel */
  release?: string;
  /** instead of a release: the source daemon is lost for good. If it had decided the move, the session is lost */
  source_lost?: boolean;
}

/** asks the target daemon to serve the session */
export interface MoveAccept {
  /** id of the session on this daemon */
  session: string;
  /** name of the move, from move.begin */
  move: string;
  /** proof from move.commit */
  proof: string;
}

/** a move, as this daemon knows it */
export interface MoveEntry {
  /** id of the session on this daemon */
  session: string;
  /** name of the move, from move.begin */
  move: string;
  /** id of the session on the other daemon */
  other: string;
  /** leaving, held, deciding, gone; incoming, doubt (all pieces are here, but only the source daemon knows whether the move is decided), accepting */
  state: string;
  /** gone: address of the other daemon, as move.begin gave it */
  url?: string;
}

/** moves of this daemon's sessions */
export interface MoveList {
  /** unfinished moves first, then sessions that have moved away */
  moves: MoveEntry[];
}

/** a command that waits for a later tick */
export interface WaitingCommand {
  /** number of the command, for session.cancel (1 to 9007199254740991) */
  number: number;
  /** tick at which the command takes effect (1 to 9007199254740991) */
  tick: number;
  /** method of the command, as tool.move */
  method: string;
  /** tool of the command */
  tool?: string;
  /** number that the driver gave the command (0 to 9007199254740991) */
  sequence: number;
  /** client that sent the command (1 to 4294967295) */
  client: number;
  /** name of that client */
  name: string;
}

/** the commands of a session that wait for later ticks */
export interface WaitingList {
  /** in the order of arrival; at most 64 of one client */
  commands: WaitingCommand[];
}

/** cancels commands that wait for later ticks */
export interface SessionCancel {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** number of the command, from session.waiting (default: all commands of the caller) (1 to 9007199254740991) */
  number?: number;
}

/** cancelled commands */
export interface Cancelled {
  /** number of cancelled commands (0 to 9007199254740991) */
  count: number;
}

/** asks for frames */
export interface SessionJoin {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** largest number of frames in a second of wall time (default: 60) (0.1 to 1000 1/s) */
  rate_hz?: number;
  /** channels (default: those marked in the table of channels) */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** wanted quantisation step; the server may choose a finer step (default: 5e-5) (1e-07 to 0.001 m) */
  step_m?: number;
  /** true: no section of the frames uses meshoptimizer's codec (default: false) */
  plain?: boolean;
}

/** what a decoder needs; a topology frame and a key frame follow */
export interface StreamDescription {
  /** id of the session */
  session: string;
  /** session number in the frames' headers (0 to 4294967295) */
  session_number: number;
  /** profile in the frames' headers (0 to 3) */
  profile: number;
  /** epoch at the time of joining */
  epoch: string;
  /** largest number of frames in a second, as granted (0.1 to 1000 1/s) */
  rate_hz: number;
  /** channels of the stream */
  channels: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** number of vertices in positions and scalars (0 to 16777216) */
  vertex_count: number;
  /** number of faces in mask and topology (0 to 16777216) */
  face_count: number;
  /** position of the quantised zero (-1000000 to 1000000 m) */
  origin_m: [number, number, number];
  /** length of one quantised step (1e-07 to 0.01 m) */
  step_m: number;
  /** one step of the stress channel (0.001 to 1000000000 Pa) */
  stress_step_pa: number;
  /** true: no section of the frames uses meshoptimizer's codec; older servers do not send this member */
  plain?: boolean;
}

/** the newest frame that the client has decoded; limits the frames in flight and shows delays */
export interface StreamAck {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** epoch of the frame */
  epoch: string;
  /** sequence number of the frame (0 to 9007199254740991) */
  sequence: number;
}

/** names a tool of a session */
export interface ToolRef {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the tool */
  tool: string;
}

/** gives up a tool, or hands it over to another client */
export interface ToolHandOver {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** name of the tool */
  tool: string;
  /** connection that becomes the driver (default: the tool has no driver) (1 to 4294967295) */
  client?: number;
}

/** a command was accepted into the log */
export interface CommandResult {
  /** tick border at which the command takes effect (0 to 9007199254740991) */
  tick: number;
  /** as given in the command (0 to 9007199254740991) */
  sequence: number;
  /** false: the store was full; energy is off nevertheless */
  stored?: boolean;
}

/** announces a mesh file; replaces an upload of the same name, complete or not */
export interface UploadBegin {
  /** name of the upload, for meshes[].file of source bytes with the ending of file_name */
  name: string;
  /** file name for messages and names of sessions; the format is recognised from the bytes */
  file_name: string;
  /** exact size of the file (1 to 9007199254740991 B) */
  byte_count: number;
}

/** the server is ready for chunks */
export interface UploadBeginResult {
  /** number of the transfer for the headers of the chunks (1 to 4294967295) */
  transfer: number;
  /** largest data of one chunk (1 to 9007199254740991 B) */
  chunk_bytes_max: number;
}

/** all chunks were sent */
export interface UploadEnd {
  /** number from upload.begin (1 to 4294967295) */
  transfer: number;
  /** SHA-256 of the file, 64 lower-case hex digits */
  sha256: string;
}

/** asks for a report on an upload, read as a mesh */
export interface MeshRead {
  /** name of a complete upload, as in upload.begin */
  upload: string;
  /** metres in one unit of the file (default: guessed from the size of the mesh, if that is clear) (1e-09 to 1000 m) */
  unit_m?: number;
  /** fat (tetrahedra) or fascia (triangles); default: fat if the file has tetrahedra or a closed surface */
  as?: 'fascia' | 'membrane' | 'fat' | 'links';
  /** true: refuse a mesh that needs repair (default: false) */
  strict?: boolean;
  /** true: never fill the mesh with tetrahedra; for scenes that a client writes itself (default: false) */
  as_it_is?: boolean;
  /** edge length of the tetrahedra that fill the mesh (default: gives about 8,000 tetrahedra) (1e-06 to 10 m) */
  edge_m?: number;
  /** labels of a segmentation to keep, as in 1,3 (default: all) */
  labels?: string;
  /** pinned sides: bottom, top, left, right, front, back, with commas, or none (default: bottom) */
  pin?: string;
}

/** elements of one kind in the file */
export interface MeshKind {
  /** name of the kind, as hexahedra */
  name: string;
  /** number that became elements of the mesh (0 to 9007199254740991) */
  read: number;
  /** number that were ignored (0 to 9007199254740991) */
  passed: number;
}

/** one kind of repair */
export interface MeshMend {
  /** the repair in words, as `duplicate vertices merged` */
  what: string;
  /** number of repairs (1 to 9007199254740991) */
  count: number;
}

/** a region of the mesh */
export interface MeshRegion {
  /** 2: region of triangles, 3: of tetrahedra (2 to 3) */
  dimension: number;
  /** number of the region, as layers name it (-2147483648 to 2147483647) */
  region: number;
  /** number of elements (0 to 9007199254740991) */
  element_count: number;
  /** name of the region in the file, or empty */
  name: string;
}

/** report on a mesh file */
export interface MeshReport {
  /** the whole report in words, one fact in each line */
  text: string;
  /** format of the file, as Gmsh 4.1 */
  format: string;
  /** number of vertices in the file (0 to 9007199254740991) */
  vertices_read: number;
  /** elements in the file */
  kinds: MeshKind[];
  /** repairs of the mesh */
  mended: MeshMend[];
  /** number of vertices of the mesh (0 to 9007199254740991) */
  vertex_count: number;
  /** number of triangles (0 to 9007199254740991) */
  triangle_count: number;
  /** number of tetrahedra (0 to 9007199254740991) */
  tetrahedron_count: number;
  /** number of connected pieces (0 to 9007199254740991) */
  component_count: number;
  /** number of edges on the rim of a surface without tetrahedra; 0: the surface is closed (0 to 9007199254740991) */
  open_edge_count: number;
  /** the first regions of the mesh */
  regions: MeshRegion[];
  /** number of all regions (0 to 9007199254740991) */
  region_count: number;
  /** least corner of the bounding box (-1000000 to 1000000 m) */
  least_m: [number, number, number];
  /** largest corner of the bounding box (-1000000 to 1000000 m) */
  most_m: [number, number, number];
  /** metres in one unit of the file, as used (1e-09 to 1000 m) */
  unit_m: number;
  /** number of elements in each tenth of the quality from 0 to 1 (mean ratio) (0 to 9007199254740991) */
  quality: number[];
  /** least quality of all elements (0 to 1) */
  least_quality: number;
}

/** result of reading a mesh */
export interface MeshReading {
  /** report on the file */
  report: MeshReport;
  /** a scene with the upload, for session.create */
  definition: Scene;
  /** a choice that the user has, as whether the surface is filled */
  note?: string;
}

/** removes an upload */
export interface UploadDiscard {
  /** name of the upload, which may be complete or still arriving */
  name: string;
}

/** the file is complete; the server keeps it until it is discarded, another upload takes its name, or the connection closes */
export interface UploadResult {
  /** as given in upload.begin */
  name: string;
  /** value for the member file of a mesh of source bytes */
  file: string;
  /** number of received bytes (0 to 9007199254740991 B) */
  byte_count: number;
}

/** a session has changed */
export interface SessionChanged {
  /** reason of the change */
  change: 'created' | 'destroyed' | 'paused' | 'resumed' | 'stepped' | 'speed' | 'reset' | 'rewound' | 'restored' | 'restarted' | 'moved' | 'tools' | 'tissue';
  /** present summary of the session */
  summary: SessionSummary;
  /** client that caused the change */
  client?: string;
  /** moved: address of the daemon that has the session now, if it is another */
  target?: string;
  /** moved: id of the session on that daemon */
  moved_to?: string;
}

/** the simulation failed numerically; rewind or reset the session */
export interface SessionFaulted {
  /** id of the session */
  session: string;
  /** tick of the fault (0 to 9007199254740991) */
  tick: number;
  /** reason in words */
  reason: string;
}

/** a tool has another driver, or its energy went off */
export interface DriverChanged {
  /** id of the session */
  session: string;
  /** present driver of the tool */
  driver: Driver;
}

/** commands to a tool were refused; sent at most once a second for each tool */
export interface ToolRefused {
  /** id of the session */
  session: string;
  /** name of the tool */
  tool: string;
  /** number of commands refused since the last such message (1 to 9007199254740991) */
  count: number;
  /** number of the last refused command (0 to 9007199254740991) */
  sequence: number;
  /** status of the last refusal, from the table of errors */
  status: string;
  /** member of that command that was refused */
  path?: string;
  /** reason in words */
  reason: string;
}

/** another client asks the driver for a tool; the driver may answer with tool.hand_over */
export interface TakeoverRequested {
  /** id of the session */
  session: string;
  /** name of the tool */
  tool: string;
  /** client that asks (1 to 4294967295) */
  client: number;
  /** name that the client gave in hello */
  name: string;
}

/** an event happened; the timeline contains it from now on */
export interface EventNotice {
  /** id of the session */
  session: string;
  /** the event */
  event: TimelineEvent;
}

/** a mesh of a scene */
export interface Mesh {
  /** where the mesh comes from */
  source: 'sheet' | 'slab' | 'pattern' | 'file' | 'bytes';
  /** name of the mesh */
  name: string;
  /** extent, centred in x and y, top at z = 0 (1e-06 to 10 m) */
  size_m?: number[];
  /** cells along each axis; of a pattern, triangles of the fan, 3 at least (1 to 1000) */
  cells?: number[];
  /** turns the UV axes against the mesh's axes (-6.3 to 6.3 rad) */
  texture_turn_rad?: number;
  /** path of a mesh file, relative to the scene file */
  file?: string;
  /** metres in one unit of the file (1e-09 to 1000 m) */
  unit_m?: number;
  /** 1: refuse a mesh with errors instead of repairing it (0 to 1) */
  strict?: number;
  /** translation of the mesh, applied after unit_m (-100 to 100 m) */
  translate_m?: [number, number, number];
}

/** a selection of vertices by their rest positions */
export interface Selection {
  /** which vertices */
  kind: 'rim' | 'box' | 'sphere' | 'nearest';
  /** only vertices of this layer; without it, of any layer */
  layer?: string;
  /** least corner of the box (-100 to 100 m) */
  least_m?: [number, number, number];
  /** largest corner of the box (-100 to 100 m) */
  most_m?: [number, number, number];
  /** centre of the sphere, or the point for `nearest` (-100 to 100 m) */
  center_m?: [number, number, number];
  /** radius of the sphere (0 to 100 m) */
  radius_m?: number;
}

/** a tool of a scene */
export interface Tool {
  /** name of the tool */
  name: string;
  /** profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out */
  instrument?: string;
  /** mode of the instrument (default: its first) */
  mode?: string;
  /** shape */
  shape?: 'sphere' | 'capsule' | 'hook' | 'spatula' | 'bipolar' | 'shears' | 'grasper';
  /** radius of the hot part (0.0002 to 0.05 m) */
  hot_radius_m?: number;
  /** length of needle, hook foot, blade or jaws (0.001 to 0.1 m) */
  tip_length_m?: number;
  /** radius of the shaft (0.0002 to 0.05 m) */
  shaft_radius_m?: number;
  /** length of the shaft (0.001 to 1 m) */
  shaft_length_m?: number;
  /** angle between open jaws (0.05 to 1.5 rad) */
  jaw_open_rad?: number;
  /** temperature of the hot part while energized (0 to 1500 degC) */
  temperature_c?: number;
  /** nodes of the heat grid along each axis (8 to 64) */
  grid_cells?: number;
  /** spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** largest angular speed of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** force above which a grasped vertex slips (0 to 1000 N) */
  slip_force_n?: number;
  /** largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N) */
  force_max_n?: number;
  /** largest force of the jaws on what they hold (0.01 to 1000 N) */
  close_force_n?: number;
  /** power to which the generator is set; for energy tissue (0 to 400 W) */
  power_w?: number;
  /** largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** peak voltage over root mean square voltage (1.4 to 20) */
  crest_factor?: number;
  /** largest current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of the force filter; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100) */
  load_rise_off?: number;
  /** position of the tip at the start (-100 to 100 m) */
  position_m?: [number, number, number];
  /** unit quaternion w, x, y, z: tool frame (shaft along +z) to world */
  rotation?: [number, number, number, number];
}

/** a point of the middle line of a vessel */
export interface VesselPoint {
  /** position of the point at rest (-100 to 100 m) */
  at_m: [number, number, number];
}

/** a blood vessel in a layer of fat */
export interface Vessel {
  /** name of the vessel */
  name: string;
  /** layer of fat in which the vessel lies */
  layer: string;
  /** outer radius of the tube (0.0001 to 0.01 m) */
  radius_m?: number;
  /** thickness of the wall of the vessel; less than the radius (1e-05 to 0.005 m) */
  wall_m?: number;
  /** blood pressure at the first point of the vessel (0 to 40000 Pa) */
  pressure_pa?: number;
  /** pressure of blood that flows back from the last point of the vessel (0 to 40000 Pa) */
  end_pressure_pa?: number;
  /** length of a tube of this radius that leads the blood to the vessel (0.001 to 10 m) */
  supply_m?: number;
  /** points of the middle line of the vessel */
  points?: VesselPoint[];
}

/** a scripted pull, for measurements */
export interface Pull {
  /** displacement of the chosen vertices (-1 to 1 m) */
  move_m?: [number, number, number];
  /** time that the displacement takes (0.001 to 3600 s) */
  duration_s?: number;
  /** vertices that are pulled */
  selection: Selection;
}

/** a scripted cut, for measurements */
export interface Cut {
  /** name of the tool in the scene */
  tool: string;
  /** where the tip waits before the cut (-100 to 100 m) */
  from_m: [number, number, number];
  /** where the tip moves to (-100 to 100 m) */
  to_m: [number, number, number];
  /** unit quaternion w, x, y, z of the tool */
  rotation?: [number, number, number, number];
  /** time that the tip waits at from_m (0 to 3600 s) */
  dwell_s?: number;
  /** speed of the tip on the cut (1e-05 to 1 m/s) */
  speed_m_s?: number;
}

/** a layer of tissue */
export type Layer = FasciaLayer | MembraneLayer | FatLayer | LinksLayer;

/** members of a region's material that differ from the layer's material */
export interface FasciaRegion {
  /** number of a region in the mesh file (0 to 2147483647) */
  region: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface FasciaLayer {
  /** kind of tissue */
  kind: 'fascia';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: the tissue whose thermal and electric properties the layer has */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** regions of the mesh file, with the members that differ */
  regions?: FasciaRegion[];
}

/** members of a region's material that differ from the layer's material */
export interface MembraneRegion {
  /** number of a region in the mesh file (0 to 2147483647) */
  region: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface MembraneLayer {
  /** kind of tissue */
  kind: 'membrane';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** membrane: the fat layer whose boundary it covers; links: the upper layer */
  of?: string;
  /** material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: the tissue whose thermal and electric properties the layer has */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** regions of the mesh file, with the members that differ */
  regions?: MembraneRegion[];
}

/** members of a region's material that differ from the layer's material */
export interface FatRegion {
  /** number of a region in the mesh file (0 to 2147483647) */
  region: number;
  /** elastic law */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10) */
  yield_strain?: number;
  /** largest plastic strain (gamma_2); 0: no plastic flow (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface FatLayer {
  /** kind of tissue */
  kind: 'fat';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** material direction of a mesh without UV coordinates; fat: first material axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: the tissue whose thermal and electric properties the layer has */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio pi f viscosity_s; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** elastic law */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10) */
  yield_strain?: number;
  /** largest plastic strain (gamma_2); 0: no plastic flow (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** regions of the mesh file, with the members that differ */
  regions?: FatRegion[];
}

/** a layer of this kind, with its material */
export interface LinksLayer {
  /** kind of tissue */
  kind: 'links';
  /** name of the layer */
  name: string;
  /** membrane: the fat layer whose boundary it covers; links: the upper layer */
  of?: string;
  /** lower layer of the links */
  to?: string;
  /** with energy `tissue`: the tissue whose thermal and electric properties the layer has */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** Young's modulus of a truss (1 to 100000000000 Pa) */
  young_modulus_pa?: number;
  /** cross section of a truss (1e-12 to 1 m^2) */
  area_m2?: number;
  /** length of the longest truss (1e-06 to 1 m) */
  reach_m?: number;
  /** number of trusses from each vertex of the upper sheet (1 to 8) */
  per_vertex?: number;
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** the data from which a session is created */
export interface Scene {
  /** name of the scene */
  name: string;
  /** description of the scene in words */
  description?: string;
  /** time step; one tick (0.001 to 0.03333333333333333 s) */
  step_s?: number;
  /** damping rate c: each step multiplies velocities by exp(-c step_s) (0 to 1000 1/s) */
  damping_per_s?: number;
  /** temperature of the body around the tools (-20 to 60 degC) */
  ambient_c?: number;
  /** relative residual at which a step ends; 0: not used (0 to 1) */
  tolerance?: number;
  /** largest error of a step, relative to its motion; 0: all iterations (0 to 1) */
  accuracy?: number;
  /** least distance between tissue surfaces; 0: no tissue contact (0 to 0.01 m) */
  contact_thickness_m?: number;
  /** Coulomb coefficient of tissue on tissue (0 to 2) */
  contact_friction?: number;
  /** edge length of one cell of the heat computation; for energy tissue (0.0001 to 0.005 m) */
  cell_m?: number;
  /** largest number of iterations of a step (small tissue: up to 64); with `accuracy` 0, each step takes all (1 to 1000) */
  iterations?: number;
  /** how the global step is solved; `newton` also uses Newton's method for all sheets */
  solver?: 'cholesky' | 'diagonal' | 'newton';
  /** number format of the local and global steps */
  precision?: 'single' | 'double';
  /** how a tick advances motion: `euler` damps, more for longer steps; `sdirk2` is of second order and solves twice a tick; at 60 steps/s it keeps 0.997 of a 5 Hz swing each period */
  integrator?: 'euler' | 'sdirk2';
  /** what heat parts: `edges`, each with all elements that share it, as in the paper; or `elements` one by one, so that a cut does not depend on the mesh */
  parting?: 'edges' | 'elements';
  /** model of an energized tool: with `paper` the hot part has a set temperature; with `tissue` a generator heats tissue, boils its water and parts elements (needs parting `elements`) */
  energy?: 'paper' | 'tissue';
  /** seed of all random numbers (0 to 9007199254740991) */
  seed?: number;
  /** gravity (-100 to 100 m/s^2) */
  gravity_m_s2?: [number, number, number];
  /** meshes of the layers */
  meshes?: Mesh[];
  /** layers of tissue */
  layers?: Layer[];
  /** pinned vertices */
  pins?: Selection[];
  /** tools at the start */
  tools?: Tool[];
  /** blood vessels */
  vessels?: Vessel[];
  /** a scripted pull */
  pull?: Pull;
  /** a scripted cut */
  cut?: Cut;
}

/** adds a tool, which the caller drives */
export interface ToolAdd {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** shape */
  shape?: 'sphere' | 'capsule' | 'hook' | 'spatula' | 'bipolar' | 'shears' | 'grasper';
  /** radius of the hot part (0.0002 to 0.05 m) */
  hot_radius_m?: number;
  /** length of needle, hook foot, blade or jaws (0.001 to 0.1 m) */
  tip_length_m?: number;
  /** radius of the shaft (0.0002 to 0.05 m) */
  shaft_radius_m?: number;
  /** length of the shaft (0.001 to 1 m) */
  shaft_length_m?: number;
  /** angle between open jaws (0.05 to 1.5 rad) */
  jaw_open_rad?: number;
  /** temperature of the hot part while energized (0 to 1500 degC) */
  temperature_c?: number;
  /** nodes of the heat grid along each axis (8 to 64) */
  grid_cells?: number;
  /** spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** largest angular speed of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** force above which a grasped vertex slips (0 to 1000 N) */
  slip_force_n?: number;
  /** largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N) */
  force_max_n?: number;
  /** largest force of the jaws on what they hold (0.01 to 1000 N) */
  close_force_n?: number;
  /** power to which the generator is set; for energy tissue (0 to 400 W) */
  power_w?: number;
  /** largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** peak voltage over root mean square voltage (1.4 to 20) */
  crest_factor?: number;
  /** largest current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of the force filter; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100) */
  load_rise_off?: number;
  /** name of the tool */
  name: string;
  /** position of the tip at the start (-100 to 100 m) */
  position_m?: [number, number, number];
  /** unit quaternion w, x, y, z: tool frame (shaft along +z) to world */
  rotation?: [number, number, number, number];
  /** profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out */
  instrument?: string;
  /** mode of the instrument (default: its first) */
  mode?: string;
}

/** removes a tool */
export interface ToolRemove {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
}

/** replaces shape and sizes of a tool; a missing member takes the instrument's value, or the default */
export interface ToolConfigure {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
  /** shape */
  shape?: 'sphere' | 'capsule' | 'hook' | 'spatula' | 'bipolar' | 'shears' | 'grasper';
  /** radius of the hot part (0.0002 to 0.05 m) */
  hot_radius_m?: number;
  /** length of needle, hook foot, blade or jaws (0.001 to 0.1 m) */
  tip_length_m?: number;
  /** radius of the shaft (0.0002 to 0.05 m) */
  shaft_radius_m?: number;
  /** length of the shaft (0.001 to 1 m) */
  shaft_length_m?: number;
  /** angle between open jaws (0.05 to 1.5 rad) */
  jaw_open_rad?: number;
  /** temperature of the hot part while energized (0 to 1500 degC) */
  temperature_c?: number;
  /** nodes of the heat grid along each axis (8 to 64) */
  grid_cells?: number;
  /** spacing of the heat grid; at most the smallest radius of the hot part (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** thermal diffusivity of the heat grid (alpha of eq. 18) (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** largest speed of the tool; it follows faster commands at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** largest angular speed of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** stiffness of the spring that attaches one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** force above which a grasped vertex slips (0 to 1000 N) */
  slip_force_n?: number;
  /** largest force of the tool on tissue, and largest force sent to drivers (0.01 to 1000 N) */
  force_max_n?: number;
  /** largest force of the jaws on what they hold (0.01 to 1000 N) */
  close_force_n?: number;
  /** power to which the generator is set; for energy tissue (0 to 400 W) */
  power_w?: number;
  /** largest peak voltage; from 200 V the tool sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** peak voltage over root mean square voltage (1.4 to 20) */
  crest_factor?: number;
  /** largest current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of the force filter; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, for energy tissue; 0: computed from its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never (0 to 100) */
  load_rise_off?: number;
  /** profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the settings that this object leaves out */
  instrument?: string;
  /** mode of the instrument (default: its first) */
  mode?: string;
}

/** moves a tool, at most at its largest speed; driver only */
export interface ToolMove {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
  /** position of the tip (-100 to 100 m) */
  position_m: [number, number, number];
  /** unit quaternion w, x, y, z */
  rotation: [number, number, number, number];
  /** opening of the jaws: 0 closed to 1 open (0 to 1) */
  jaw?: number;
}

/** turns energy on (driver only), for at most `ticks` ticks, or off */
export interface ToolEnergize {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
  /** whether energy is turned on or off */
  energized: boolean;
  /** energy goes off this many ticks after an enable; 0: no limit (0 to 2147483647) */
  ticks?: number;
}

/** closes the jaws on the tissue between them; driver only */
export interface ToolGrasp {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
}

/** opens the jaws; driver only */
export interface ToolRelease {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
}

/** keeps a tool where it is until it is moved again; driver only */
export interface ToolHold {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** name of the tool */
  tool: string;
}

/** pins vertices at their present positions */
export interface Pin {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** which vertices */
  selection: Selection;
}

/** releases pinned vertices */
export interface Unpin {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** which vertices */
  selection: Selection;
}

/** replaces the material of a layer */
export type MaterialSet = MaterialSetFascia | MaterialSetMembrane | MaterialSetFat | MaterialSetLinks;

/** replaces the material of a layer */
export interface MaterialSetFascia {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** kind of the layer */
  kind: 'fascia';
  /** name of the layer */
  layer: string;
  /** number of a region in the mesh file; 0: the layer's own material (0 to 2147483647) */
  region?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces the material of a layer */
export interface MaterialSetMembrane {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** kind of the layer */
  kind: 'membrane';
  /** name of the layer */
  layer: string;
  /** number of a region in the mesh file; 0: the layer's own material (0 to 2147483647) */
  region?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** bending stiffness; 0: bending is not resisted (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces the material of a layer */
export interface MaterialSetFat {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** kind of the layer */
  kind: 'fat';
  /** name of the layer */
  layer: string;
  /** number of a region in the mesh file; 0: the layer's own material (0 to 2147483647) */
  region?: number;
  /** elastic law */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** limit range: largest shear, the cosine of the angle between material axes (0 to 0.99) */
  shear_max?: number;
  /** deviatoric Green strain at which plastic flow begins (gamma_1) (0 to 10) */
  yield_strain?: number;
  /** largest plastic strain (gamma_2); 0: no plastic flow (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest engineering strain along each axis (0 to 100) */
  strain_max?: [number, number, number];
  /** squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces the material of a layer */
export interface MaterialSetLinks {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** kind of the layer */
  kind: 'links';
  /** name of the layer */
  layer: string;
  /** Young's modulus of a truss (1 to 100000000000 Pa) */
  young_modulus_pa?: number;
  /** cross section of a truss (1e-12 to 1 m^2) */
  area_m2?: number;
  /** length of the longest truss (1e-06 to 1 m) */
  reach_m?: number;
  /** number of trusses from each vertex of the upper sheet (1 to 8) */
  per_vertex?: number;
  /** tissue parts when exposure times absorption_per_s exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation of ignition_c in the tissue, drawn from the seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of fibre bundles that share one ignition temperature; 0: no bundles (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** rate at which tissue takes up heat (xi of eq. 20) (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy of a tear per area; 0: tissue does not tear (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** sets the gravity of a session */
export interface GravitySet {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** gravity (-100 to 100 m/s^2) */
  gravity_m_s2: [number, number, number];
}

/** applies an outer force to vertices */
export interface ForceSet {
  /** id of the session (default: the session in the connection's URL) */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the command takes effect at the first tick border at or after this tick; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** number that the driver gives the command (0 to 9007199254740991) */
  sequence?: number;
  /** force on each chosen vertex (-1000 to 1000 N) */
  force_n: [number, number, number];
  /** which vertices */
  selection: Selection;
}

/** Requests: params and result of each method. */
export interface Requests {
  /** must be the first message; before it no other request is served */
  'hello': { params: Hello; result: HelloResult };
  /** reports to the server that a driver is alive, every 100 ms while energy is on */
  'heartbeat': { params: Heartbeat; result: HeartbeatResult };
  /** lists the scenes of the daemon */
  'scene.list': { params: Nothing; result: SceneList };
  /** returns one scene with all members */
  'scene.get': { params: SceneRef; result: SceneResult };
  /** lists the profiles of instruments */
  'instrument.list': { params: Nothing; result: InstrumentList };
  /** lists the sessions of the daemon */
  'session.list': { params: Nothing; result: SessionList };
  /** makes a session */
  'session.create': { params: SessionCreate; result: SessionDescription };
  /** returns layers, drivers and scene of a session */
  'session.describe': { params: SessionRef; result: SessionDescription };
  /** asks for frames; call it again to change the profile */
  'session.join': { params: SessionJoin; result: StreamDescription };
  /** ends the stream of frames */
  'session.leave': { params: SessionRef; result: Nothing };
  /** stops time at a tick border; energy goes off */
  'session.pause': { params: SessionChange; result: SessionSummary };
  /** resumes a paused session */
  'session.resume': { params: SessionChange; result: SessionSummary };
  /** advances a paused session; the answer comes when the steps are done */
  'session.step': { params: SessionStep; result: TickResult };
  /** advances a paused session in lock-step: commands, ticks and observation in one request. There is no client_sequence: `tick` shows whether the request was done */
  'session.advance': { params: SessionAdvance; result: Advanced };
  /** sets the speed of a session */
  'session.speed': { params: SessionSpeed; result: SessionSummary };
  /** resets a session to tick 0, on a new branch */
  'session.reset': { params: SessionChange; result: Restored };
  /** ends a session and removes it from the store, also a session that the daemon could not start */
  'session.destroy': { params: SessionChange; result: Nothing };
  /** creates a new session from the state of this session, energy off */
  'session.fork': { params: SessionFork; result: SessionDescription };
  /** stores the state under a name */
  'session.snapshot': { params: SessionSnapshot; result: SnapshotResult };
  /** lists the snapshots that session.restore can restore, also those of other branches */
  'session.snapshots': { params: SessionRef; result: SnapshotList };
  /** restores a snapshot */
  'session.restore': { params: SessionRestore; result: Restored };
  /** rewinds to a tick */
  'session.rewind': { params: SessionRewind; result: Restored };
  /** returns the tissue as a file, which follows in binary chunks */
  'session.export': { params: SessionExport; result: Transfer };
  /** returns the command log as a script, which follows in binary chunks */
  'session.log': { params: SessionLog; result: Transfer };
  /** returns cuts and other events */
  'session.timeline': { params: SessionTimeline; result: Timeline };
  /** returns the key frame of a past tick without a rewind; binary chunks follow. A second request of a client cancels its first */
  'session.frame_at': { params: SessionFrameAt; result: PastFrame };
  /** cancels the running session.frame_at of the client, if there is one */
  'session.frame_cancel': { params: SessionRef; result: Nothing };
  /** lists the commands that wait for later ticks */
  'session.waiting': { params: SessionRef; result: WaitingList };
  /** cancels waiting commands of the caller; with a number and role admin, of any client. Each cancelled command is answered with `bad_state` */
  'session.cancel': { params: SessionCancel; result: Cancelled };
  /** asks for a key frame, at most once a second */
  'stream.key_frame': { params: SessionRef; result: Nothing };
  /** adds a tool, which the caller drives */
  'tool.add': { params: ToolAdd; result: CommandResult };
  /** removes a tool */
  'tool.remove': { params: ToolRemove; result: CommandResult };
  /** replaces shape and sizes of a tool; a missing member takes the instrument's value, or the default */
  'tool.configure': { params: ToolConfigure; result: CommandResult };
  /** moves a tool, at most at its largest speed; driver only */
  'tool.move': { params: ToolMove; result: CommandResult };
  /** turns energy on (driver only), for at most `ticks` ticks, or off */
  'tool.energize': { params: ToolEnergize; result: CommandResult };
  /** closes the jaws on the tissue between them; driver only */
  'tool.grasp': { params: ToolGrasp; result: CommandResult };
  /** opens the jaws; driver only */
  'tool.release': { params: ToolRelease; result: CommandResult };
  /** keeps a tool where it is until it is moved again; driver only */
  'tool.hold': { params: ToolHold; result: CommandResult };
  /** makes the caller the driver, if the tool has no driver or the caller has role admin; energy goes off */
  'tool.take_over': { params: ToolRef; result: Driver };
  /** asks the driver for the tool; the driver receives takeover.requested */
  'tool.request_takeover': { params: ToolRef; result: Nothing };
  /** gives up a tool or hands it to another client; energy goes off; driver only */
  'tool.hand_over': { params: ToolHandOver; result: Driver };
  /** pins vertices at their present positions */
  'pin': { params: Pin; result: CommandResult };
  /** releases pinned vertices */
  'unpin': { params: Unpin; result: CommandResult };
  /** replaces the material of a layer */
  'material.set': { params: MaterialSet; result: CommandResult };
  /** sets the gravity of a session */
  'gravity.set': { params: GravitySet; result: CommandResult };
  /** applies an outer force to vertices */
  'force.set': { params: ForceSet; result: CommandResult };
  /** announces a mesh file */
  'upload.begin': { params: UploadBegin; result: UploadBeginResult };
  /** checks length and hash of an upload */
  'upload.end': { params: UploadEnd; result: UploadResult };
  /** reads an upload as a mesh; returns a report, and a scene with the mesh for session.create */
  'mesh.read': { params: MeshRead; result: MeshReading };
  /** removes an upload; sessions that use it stay */
  'upload.discard': { params: UploadDiscard; result: Nothing };
  /** copies the daemon's store to a file on its machine, without interrupting clients; one copy at a time */
  'store.backup': { params: StoreBackup; result: StoreCopy };
  /** begins to move a session to another daemon; the session is served meanwhile */
  'move.begin': { params: MoveBegin; result: MoveBegun };
  /** returns the next piece of the session, which follows in binary chunks */
  'move.read': { params: MoveRef; result: Transfer };
  /** suspends the session, energy off; requests to it wait */
  'move.hold': { params: MoveRef; result: MoveHeld };
  /** ends the session here, given the receipt for all pieces; the answer has the proof with which the target daemon serves the session */
  'move.commit': { params: MoveCommit; result: MoveDecision };
  /** cancels the move, unless the session has moved already: the answer says which */
  'move.cancel': { params: MoveRef; result: MoveDecision };
  /** delivers an upload as a piece of an arriving session; the answer comes when the piece is on the disk */
  'move.receive': { params: MoveReceive; result: MoveReceived };
  /** builds the arrived session; the answer comes when the session could soon be served */
  'move.ready': { params: MoveRef; result: MoveHeld };
  /** serves the arrived session, given the proof of move.commit; the answer comes when the session is served */
  'move.accept': { params: MoveAccept; result: SessionDescription };
  /** removes the pieces of a move, given the release of move.cancel */
  'move.forget': { params: MoveForget; result: Nothing };
  /** lists sessions that arrive, are in doubt, are leaving, or have moved away */
  'move.list': { params: Nothing; result: MoveList };
}

/** Notifications from the client. */
export interface Notices {
  /** reports to the server that a driver is alive, every 100 ms while energy is on */
  'heartbeat': Heartbeat;
  /** reports the newest frame that the client has decoded */
  'stream.ack': StreamAck;
  /** moves a tool, at most at its largest speed; driver only */
  'tool.move': ToolMove;
}

/** Notifications from the server. */
export interface Pushes {
  /** sent to all clients that joined the session; created and destroyed go to all clients */
  'session.changed': SessionChanged;
  /** sent to all clients that joined the session */
  'session.faulted': SessionFaulted;
  /** sent to all clients that joined the session */
  'tool.driver_changed': DriverChanged;
  /** sent to the tool's driver */
  'tool.refused': ToolRefused;
  /** sent to the tool's driver */
  'takeover.requested': TakeoverRequested;
  /** sent to the client that waits for session.frame_at, about ten times a second */
  'session.frame_progress': FrameProgress;
  /** sent to all clients that joined the session */
  'event': EventNotice;
}

/** Requests that take client_sequence: sent again they act once. */
export const CHANGING_METHODS: ReadonlySet<string> = new Set<string>([
  'session.create',
  'session.pause',
  'session.resume',
  'session.step',
  'session.speed',
  'session.reset',
  'session.destroy',
  'session.fork',
  'session.snapshot',
  'session.restore',
  'session.rewind',
  'tool.add',
  'tool.remove',
  'tool.configure',
  'tool.move',
  'tool.energize',
  'tool.grasp',
  'tool.release',
  'tool.hold',
  'tool.take_over',
  'tool.hand_over',
  'pin',
  'unpin',
  'material.set',
  'gravity.set',
  'force.set',
]);

/** error.code by error.data.status. */
export const ERROR_CODES = {
  bad_syntax: -32700,
  invalid_request: -32600,
  method_not_found: -32601,
  bad_value: -32602,
  internal: -32603,
  bad_mesh: -32003,
  bad_state: -32004,
  not_found: -32005,
  already_exists: -32006,
  limit: -32007,
  unsupported: -32008,
  no_memory: -32009,
  io: -32010,
  numerical: -32011,
  faulted: -32012,
  corrupt: -32013,
  not_here: -32040,
  hello_required: -32041,
  unauthorized: -32042,
  forbidden: -32043,
  version: -32044,
  not_driver: -32045,
  rate: -32046,
  draining: -32047,
  store_full: -32048,
  sequence_past: -32049,
  sequence_conflict: -32050,
  moved: -32051,
} as const;
export type ErrorStatus = keyof typeof ERROR_CODES;

/** Close codes of the connection and what they mean. */
export const CLOSE_REASONS: Readonly<Record<number, string>> = {
  1000: 'done',
  1001: 'the server is shutting down',
  1002: 'the client violated the WebSocket protocol',
  1003: 'a binary message was not a chunk of an upload',
  1007: 'a text message was not UTF-8',
  1009: 'a message was longer than the limit',
  1011: 'the server has an internal error',
  1013: 'the server has too many connections',
  4001: 'the client sent no hello within 5 s',
  4002: 'the token is missing or unknown',
  4003: 'client and server support no common version of the protocol',
  4004: 'the client did not read its frames fast enough',
  4005: 'the client sends too many messages a second',
  4006: 'the client did not answer pings',
  4007: 'another connection took over this one',
  4008: 'the client sent too many malformed messages',
};

export const FRAME_KIND = { key: 1, delta: 2, topology: 3, } as const;
export const SECTION = {
  positions: 1,
  mask: 2,
  exposure: 3,
  charring: 4,
  stress: 5,
  tools: 7,
  statistics: 8,
  temperature: 9,
  vessels: 10,
  blood: 11,
  tool_contact: 12,
  tool_names: 6,
  faces: 16,
  face_layers: 17,
  texture: 18,
  rest: 19,
  tools_asked: 32,
  tool_jaws: 33,
  tool_power: 34,
  tool_force: 35,
} as const;

/** Scalars of the vertices: n in a frame stands for least + step n in the unit, n is at most `most`.
 * Step 0: the stream states it, as stress_step_pa. */
export const SCALARS = {
  /** largest heat exposure of the vertex's edges, over the exposure that parts the edge, 0 to 1 */
  exposure: { section: 3, byDefault: true, least: 0, step: 0.00392156862745098, most: 255, unit: '1' },
  /** share of the vertex's edges that have parted, 0 to 1 */
  charring: { section: 4, byDefault: true, least: 0, step: 0.00392156862745098, most: 255, unit: '1' },
  /** von Mises stress of fat, volume weighted */
  stress: { section: 5, byDefault: false, least: 0, step: 0, most: 65535, unit: 'Pa' },
  /** temperature of the tools' heat grids at the vertex; outside of the grids ambient_c of the scene */
  temperature: { section: 9, byDefault: false, least: -20, step: 0.25, most: 65535, unit: 'degC' },
  /** depth of blood on the surface */
  blood: { section: 11, byDefault: false, least: 0, step: 2e-05, most: 255, unit: 'm' },
} as const;
export type ScalarName = keyof typeof SCALARS;

/** Words that frames tell by their number. */
export const TOOL_SHAPES = ['sphere', 'capsule', 'hook', 'spatula', 'bipolar', 'shears', 'grasper', ] as const;
export const ENERGY_OFF_REASONS = ['never_enabled', 'commanded', 'watchdog', 'restored', 'taken_over', ] as const;

/** What a tool of a shape has. */
export const SHAPE_TRAITS: Readonly<Record<(typeof TOOL_SHAPES)[number], { hot: boolean; jaws: boolean; meaning: string }>> = {
  sphere: { hot: true, jaws: false, meaning: 'hot ball at the tip, cold shaft' },
  capsule: { hot: true, jaws: false, meaning: 'hot needle, cold shaft' },
  hook: { hot: true, jaws: false, meaning: 'monopolar L hook: hot foot and heel, cold shaft' },
  spatula: { hot: true, jaws: false, meaning: 'hot flat blade, cold shaft' },
  bipolar: { hot: true, jaws: true, meaning: 'two jaws that close, hot inner faces' },
  shears: { hot: true, jaws: true, meaning: 'ultrasonic: one hot blade, one cold clamping jaw' },
  grasper: { hot: false, jaws: true, meaning: 'two cold jaws' },
};

/** Choices of a material, in words. */
export const MODELS = ['neohookean', 'corotated', 'stvk', 'energy', ] as const;
export const LIMITS = ['none', 'target', 'range', ] as const;
export const PROJECTIONS = ['closed_form', 'linearised', ] as const;

export interface Parameter {
  name: string;
  unit: string;
  least: number;
  most: number;
  default: number;
  meaning: string;
}

/** Numbers that panels edit. */
export const PARAMETERS = {
  scene: [
    { name: 'step_s', unit: 's', least: 0.001, most: 0.03333333333333333, default: 0.01666666666666667,
      meaning: "time step; one tick" },
    { name: 'damping_per_s', unit: '1/s', least: 0, most: 1000, default: 0,
      meaning: "damping rate c: each step multiplies velocities by exp(-c step_s)" },
    { name: 'ambient_c', unit: 'degC', least: -20, most: 60, default: 37,
      meaning: "temperature of the body around the tools" },
    { name: 'tolerance', unit: '1', least: 0, most: 1, default: 0,
      meaning: "relative residual at which a step ends; 0: not used" },
    { name: 'accuracy', unit: '1', least: 0, most: 1, default: 0.01,
      meaning: "largest error of a step, relative to its motion; 0: all iterations" },
    { name: 'contact_thickness_m', unit: 'm', least: 0, most: 0.01, default: 0,
      meaning: "least distance between tissue surfaces; 0: no tissue contact" },
    { name: 'contact_friction', unit: '1', least: 0, most: 2, default: 0.1,
      meaning: "Coulomb coefficient of tissue on tissue" },
    { name: 'cell_m', unit: 'm', least: 0.0001, most: 0.005, default: 0.00025,
      meaning: "edge length of one cell of the heat computation; for energy tissue" },
  ],
  tool: [
    { name: 'hot_radius_m', unit: 'm', least: 0.0002, most: 0.05, default: 0.003,
      meaning: "radius of the hot part" },
    { name: 'tip_length_m', unit: 'm', least: 0.001, most: 0.1, default: 0.008,
      meaning: "length of needle, hook foot, blade or jaws" },
    { name: 'shaft_radius_m', unit: 'm', least: 0.0002, most: 0.05, default: 0.0025,
      meaning: "radius of the shaft" },
    { name: 'shaft_length_m', unit: 'm', least: 0.001, most: 1, default: 0.12,
      meaning: "length of the shaft" },
    { name: 'jaw_open_rad', unit: 'rad', least: 0.05, most: 1.5, default: 0.6,
      meaning: "angle between open jaws" },
    { name: 'temperature_c', unit: 'degC', least: 0, most: 1500, default: 170,
      meaning: "temperature of the hot part while energized" },
    { name: 'grid_cells', unit: '1', least: 8, most: 64, default: 16,
      meaning: "nodes of the heat grid along each axis" },
    { name: 'grid_step_m', unit: 'm', least: 5e-05, most: 0.01, default: 0.001,
      meaning: "spacing of the heat grid; at most the smallest radius of the hot part" },
    { name: 'diffusivity_m2_s', unit: 'm^2/s', least: 0, most: 0.001, default: 4.2e-06,
      meaning: "thermal diffusivity of the heat grid (alpha of eq. 18)" },
    { name: 'max_speed_m_s', unit: 'm/s', least: 0.001, most: 5, default: 0.5,
      meaning: "largest speed of the tool; it follows faster commands at this speed" },
    { name: 'max_turn_rad_s', unit: 'rad/s', least: 0.1, most: 100, default: 12,
      meaning: "largest angular speed of the tool" },
    { name: 'friction', unit: '1', least: 0, most: 2, default: 0.2,
      meaning: "Coulomb coefficient of the cold parts" },
    { name: 'drag_ns_m', unit: 'N s/m', least: 0, most: 100, default: 0.05,
      meaning: "viscous drag of the hot part on each vertex in it" },
    { name: 'grasp_stiffness_n_m', unit: 'N/m', least: 1, most: 1000000, default: 200,
      meaning: "stiffness of the spring that attaches one grasped vertex" },
    { name: 'slip_force_n', unit: 'N', least: 0, most: 1000, default: 2,
      meaning: "force above which a grasped vertex slips" },
    { name: 'force_max_n', unit: 'N', least: 0.01, most: 1000, default: 20,
      meaning: "largest force of the tool on tissue, and largest force sent to drivers" },
    { name: 'close_force_n', unit: 'N', least: 0.01, most: 1000, default: 8,
      meaning: "largest force of the jaws on what they hold" },
    { name: 'power_w', unit: 'W', least: 0, most: 400, default: 30,
      meaning: "power to which the generator is set; for energy tissue" },
    { name: 'peak_v', unit: 'V', least: 1, most: 10000, default: 1150,
      meaning: "largest peak voltage; from 200 V the tool sparks and cuts" },
    { name: 'crest_factor', unit: '1', least: 1.4, most: 20, default: 1.4,
      meaning: "peak voltage over root mean square voltage" },
    { name: 'current_max_a', unit: 'A', least: 0.01, most: 10, default: 2,
      meaning: "largest current, root mean square" },
    { name: 'force_filter_s', unit: 's', least: 0, most: 1, default: 0.02,
      meaning: "time constant of the force filter; 0: no filter" },
    { name: 'blade_heat_j_k', unit: 'J/K', least: 0, most: 100, default: 0,
      meaning: "heat capacity of the hot part, for energy tissue; 0: computed from its shape" },
    { name: 'blade_cooling_w_k', unit: 'W/K', least: 0, most: 1, default: 0,
      meaning: "heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape" },
    { name: 'load_rise_off', unit: '1', least: 0, most: 100, default: 0,
      meaning: "power ends when the load reaches this multiple of its minimum, until energy is turned off and on; 0: never" },
  ],
  fascia: [
    { name: 'thickness_m', unit: 'm', least: 1e-06, most: 0.05, default: 0.0005,
      meaning: "sheet thickness" },
    { name: 'density_kg_m3', unit: 'kg/m^3', least: 1, most: 25000, default: 1100,
      meaning: "mass density" },
    { name: 'limit_stiffness_pa', unit: 'Pa', least: 1, most: 10000000000, default: 1000000,
      meaning: "stiffness k of the strain limit" },
    { name: 'shear_max', unit: '1', least: 0, most: 0.99, default: 0,
      meaning: "limit range: largest shear, the cosine of the angle between material axes" },
    { name: 'bending_stiffness_nm', unit: 'N m', least: 0, most: 10, default: 0,
      meaning: "bending stiffness; 0: bending is not resisted" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 172,
      meaning: "tissue parts when exposure times absorption_per_s exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation of ignition_c in the tissue, drawn from the seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of fibre bundles that share one ignition temperature; 0: no bundles" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "rate at which tissue takes up heat (xi of eq. 20)" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy of a tear per area; 0: tissue does not tear" },
  ],
  membrane: [
    { name: 'thickness_m', unit: 'm', least: 1e-06, most: 0.05, default: 0.0005,
      meaning: "sheet thickness" },
    { name: 'density_kg_m3', unit: 'kg/m^3', least: 1, most: 25000, default: 1100,
      meaning: "mass density" },
    { name: 'limit_stiffness_pa', unit: 'Pa', least: 1, most: 10000000000, default: 1000000,
      meaning: "stiffness k of the strain limit" },
    { name: 'shear_max', unit: '1', least: 0, most: 0.99, default: 0,
      meaning: "limit range: largest shear, the cosine of the angle between material axes" },
    { name: 'bending_stiffness_nm', unit: 'N m', least: 0, most: 10, default: 0,
      meaning: "bending stiffness; 0: bending is not resisted" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 96.40000000000001,
      meaning: "tissue parts when exposure times absorption_per_s exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation of ignition_c in the tissue, drawn from the seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of fibre bundles that share one ignition temperature; 0: no bundles" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "rate at which tissue takes up heat (xi of eq. 20)" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy of a tear per area; 0: tissue does not tear" },
  ],
  fat: [
    { name: 'density_kg_m3', unit: 'kg/m^3', least: 1, most: 25000, default: 911,
      meaning: "mass density" },
    { name: 'young_modulus_pa', unit: 'Pa', least: 1, most: 10000000000, default: 5000,
      meaning: "Young's modulus" },
    { name: 'poisson_ratio', unit: '1', least: 0, most: 0.45, default: 0.4,
      meaning: "Poisson's ratio; at most 1/3 for model energy" },
    { name: 'limit_stiffness_pa', unit: 'Pa', least: 1, most: 10000000000, default: 1000,
      meaning: "stiffness of the strain limit and shrinkage" },
    { name: 'shear_max', unit: '1', least: 0, most: 0.99, default: 0,
      meaning: "limit range: largest shear, the cosine of the angle between material axes" },
    { name: 'yield_strain', unit: '1', least: 0, most: 10, default: 0,
      meaning: "deviatoric Green strain at which plastic flow begins (gamma_1)" },
    { name: 'plastic_strain_max', unit: '1', least: 0, most: 10, default: 0,
      meaning: "largest plastic strain (gamma_2); 0: no plastic flow" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 76,
      meaning: "tissue parts when exposure times absorption_per_s exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation of ignition_c in the tissue, drawn from the seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of fibre bundles that share one ignition temperature; 0: no bundles" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "rate at which tissue takes up heat (xi of eq. 20)" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy of a tear per area; 0: tissue does not tear" },
  ],
  links: [
    { name: 'young_modulus_pa', unit: 'Pa', least: 1, most: 100000000000, default: 100000,
      meaning: "Young's modulus of a truss" },
    { name: 'area_m2', unit: 'm^2', least: 1e-12, most: 1, default: 1e-06,
      meaning: "cross section of a truss" },
    { name: 'reach_m', unit: 'm', least: 1e-06, most: 1, default: 0.005,
      meaning: "length of the longest truss" },
    { name: 'per_vertex', unit: '1', least: 1, most: 8, default: 3,
      meaning: "number of trusses from each vertex of the upper sheet" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 172,
      meaning: "tissue parts when exposure times absorption_per_s exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation of ignition_c in the tissue, drawn from the seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of fibre bundles that share one ignition temperature; 0: no bundles" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "rate at which tissue takes up heat (xi of eq. 20)" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy of a tear per area; 0: tissue does not tear" },
  ],
} satisfies Record<string, Parameter[]>;
