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
  /** the client's own lasting identity, among those of its token's owner; names the stored answers of client_sequence */
  client_id?: string;
  /** access token, where the server asks for one */
  token?: string;
  /** token of an earlier hello: takes back the tools driven within 10 s of the loss, energy off */
  resume?: string;
  /** role wanted; the token's by default and at most */
  role?: 'view' | 'operate' | 'admin';
}

/** what the server accepts; beyond it are errors or a close code */
export interface Limits {
  /** of a text message (1 to 9007199254740991 B) */
  message_bytes_max: number;
  /** of one upload (0 to 9007199254740991 B) */
  upload_bytes_max: number;
  /** of all uploads of the connection; one below 64 KiB counts for that (0 to 9007199254740991 B) */
  uploads_bytes_max?: number;
  /** of data in one binary chunk (1 to 9007199254740991 B) */
  chunk_bytes_max: number;
  /** sessions of the daemon (0 to 9007199254740991) */
  sessions_max: number;
  /** connections of the daemon (0 to 9007199254740991) */
  subscribers_max: number;
  /** different stream profiles of a session (1 to 4) */
  profiles_max: number;
  /** streams of a connection (1 to 64) */
  streams_max?: number;
  /** tools of a session (1 to 8) */
  tools_max: number;
  /** requests of a connection (1 to 9007199254740991 1/s) */
  requests_per_s_max: number;
  /** tool.move notifications of a connection (1 to 9007199254740991 1/s) */
  motions_per_s_max: number;
  /** frames unsent before some are skipped (1 to 9007199254740991 B) */
  bytes_in_flight_max: number;
  /** longest pause between a driver's messages before energy is cut (0.01 to 60 s) */
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
  /** role granted */
  role: 'view' | 'operate' | 'admin';
  /** the connection's number: the driver number in frames (1 to 4294967295) */
  client: number;
  /** as given, or one made up by the server */
  client_id: string;
  /** token for a later hello */
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

/** sign of life of a driver; a notification, or a request to measure the clock */
export interface Heartbeat {
  /** false: the page is hidden or blurred, energy is cut at once */
  visible: boolean;
  /** the client's clock, one that is never set, from any origin; returned. Once it was sent, only heartbeats with it are signs of life on this connection (0 to 9007199254740991 us) */
  client_time_us?: number;
}

/** for the offset of the clocks */
export interface HeartbeatResult {
  /** the server's monotonic clock (0 to 9007199254740991 us) */
  server_time_us: number;
  /** as given (0 to 9007199254740991 us) */
  client_time_us?: number;
}

/** a scene that sessions can be made from */
export interface SceneSummary {
  /** its name */
  name: string;
  /** in words */
  description: string;
}

/** all of them */
export interface SceneList {
  /** by name */
  scenes: SceneSummary[];
}

/** names a scene */
export interface SceneRef {
  /** its name */
  scene: string;
}

/** a scene whole, to change and send back to session.create */
export interface SceneResult {
  /** every member, defaults too */
  definition: Scene;
}

/** how the generator of an instrument is set in a mode; the members are those of a tool */
export interface InstrumentMode {
  /** its name */
  mode: string;
  /** in words */
  description: string;
  /** power, where no other is named (0 to 400 W) */
  power_w: number;
  /** least power that the mode has (0 to 400 W) */
  power_least_w: number;
  /** most power that the mode has (0 to 400 W) */
  power_most_w: number;
  /** most voltage, peak (1 to 10000 V) */
  peak_v: number;
  /** of the voltage; its duty is 2 / crest_factor^2 (1.4 to 20) */
  crest_factor: number;
  /** most current, root mean square (0.01 to 10 A) */
  current_max_a: number;
  /** power ends when the load is so many times its least; 0: never (0 to 100) */
  load_rise_off: number;
}

/** a profile of an instrument, which a tool of a scene, tool.add and tool.configure may name */
export interface Instrument {
  /** its name */
  name: string;
  /** in words */
  description: string;
  /** shape of the tool */
  shape: string;
  /** the first is the default */
  modes: InstrumentMode[];
}

/** all of them */
export interface InstrumentList {
  /** by name */
  instruments: Instrument[];
}

/** names a session */
export interface SessionRef {
  /** its id; that of the connection's URL by default */
  session?: string;
}

/** names a session to change */
export interface SessionChange {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** counts the client_id's changes; the same again returns the first answer (1 to 9007199254740991) */
  client_sequence?: number;
}

/** a session in a list */
export interface SessionSummary {
  /** its id */
  session: string;
  /** the scene it was made from */
  scene: string;
  /** what it does */
  state: 'starting' | 'running' | 'paused' | 'faulted';
  /** steps since creation, along the present branch (0 to 9007199254740991) */
  tick: number;
  /** simulated (0 to 1000000000000 s) */
  time_s: number;
  /** one tick (0.0001 to 1 s) */
  step_s: number;
  /** simulated over wall time that is aimed at (0 to 100) */
  speed: number;
  /** what is reached, over the last second (0 to 1000000) */
  realtime_factor: number;
  /** vertices (0 to 16777216) */
  vertex_count: number;
  /** faces, drawn and not (0 to 16777216) */
  face_count: number;
  /** tools (0 to 8) */
  tool_count: number;
  /** streams joined (0 to 9007199254740991) */
  subscriber_count: number;
  /** of its frames; another after rewind, reset, restore and restart */
  epoch: string;
  /** why it is faulted */
  fault?: string;
  /** false: the session is ephemeral; or, in an answer to session.pause, the store was full, and the session pauses all the same */
  stored?: boolean;
  /** while it is starting or is rewound or restored: what the builder does (meshing, ordering, factoring, settling; reading, restoring, replaying) */
  stage?: string;
}

/** all sessions of the daemon */
export interface SessionList {
  /** by id */
  sessions: SessionSummary[];
}

/** makes a session from a scene of the daemon or from one given whole */
export interface SessionCreate {
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** wanted id, without the daemon's label; made up by default */
  name?: string;
  /** a scene of the daemon; either this or definition */
  scene?: string;
  /** the scene itself; meshes of source bytes name an upload in file */
  definition?: Scene;
  /** starts paused; false by default */
  paused?: boolean;
  /** is never on a disk, and ends with its maker's connection or the daemon; false by default */
  ephemeral?: boolean;
}

/** a layer and its range in the face list */
export interface LayerDescription {
  /** of the scene */
  name: string;
  /** of tissue */
  kind: 'fascia' | 'membrane' | 'fat' | 'links';
  /** index of its first face (0 to 16777216) */
  first_face: number;
  /** faces; 0 for links (0 to 16777216) */
  face_count: number;
  /** triangles, tetrahedra or links (0 to 16777216) */
  element_count: number;
}

/** who moves a tool */
export interface Driver {
  /** the tool */
  tool: string;
  /** the driving connection's number; 0: no driver (0 to 4294967295) */
  client: number;
  /** the client's name in its hello, or the DDS participant's */
  name: string;
  /** whether its energy is on */
  energized: boolean;
  /** why it is off; meaningless while on */
  energy_off: 'never_enabled' | 'commanded' | 'watchdog' | 'restored' | 'taken_over';
}

/** what a client must know of a session */
export interface SessionDescription {
  /** as in the list */
  summary: SessionSummary;
  /** of the scene, in words */
  description: string;
  /** chosen by this machine; determinism holds within one */
  instruction_set: string;
  /** of sheets (0 to 9007199254740991) */
  triangle_count: number;
  /** of fat (0 to 9007199254740991) */
  tetrahedron_count: number;
  /** trusses (0 to 9007199254740991) */
  link_count: number;
  /** in the order of the scene */
  layers: LayerDescription[];
  /** one for each tool, in the order of frames */
  drivers: Driver[];
  /** the scene with its present materials, tools and gravity */
  definition: Scene;
}

/** advances a paused session */
export interface SessionStep {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** steps; 1 by default (1 to 100000) */
  ticks?: number;
}

/** a command about a tool, before the first tick; it has the members of the method that it names */
export interface AdvanceCommand {
  /** which */
  method: 'tool.move' | 'tool.energize' | 'tool.grasp' | 'tool.release' | 'tool.hold';
  /** one that the client drives; to turn energy off, any */
  tool: string;
  /** the driver's own count; frames show the last one applied (0 to 9007199254740991) */
  sequence?: number;
  /** tool.move: place of the tip (-100 to 100 m) */
  position_m?: [number, number, number];
  /** tool.move: unit quaternion w, x, y, z (-1.001 to 1.001) */
  rotation?: [number, number, number, number];
  /** tool.move: 0 closed, the default, to 1 open (0 to 1) */
  jaw?: number;
  /** tool.energize: on or off */
  energized?: boolean;
  /** tool.energize on: energy is off again after so many ticks; 0, the default: no limit (0 to 2147483647) */
  ticks?: number;
}

/** a box (least_m, most_m) or a ball (center_m, radius_m): the elements whose middle is in it while the tissue is at rest */
export interface ObservedRegion {
  /** given back */
  name: string;
  /** the box's corner of its least coordinates (-100 to 100 m) */
  least_m?: [number, number, number];
  /** of its largest (-100 to 100 m) */
  most_m?: [number, number, number];
  /** the ball's middle (-100 to 100 m) */
  center_m?: [number, number, number];
  /** of the ball (0 to 100 m) */
  radius_m?: number;
}

/** what session.advance is to answer with, besides tick and time */
export interface Observe {
  /** positions, mask, tools, vessels, and scalars by their names; `statistics` is in frames alone */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** of positions and scalars: these alone, in this order; all by default (0 to 16777215) */
  vertices?: number[];
  /** where removed volume and damage are reported */
  regions?: ObservedRegion[];
  /** whether the energy of instruments is reported; false by default */
  energy?: boolean;
}

/** makes ticks of a paused session in lock-step */
export interface SessionAdvance {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** how many; 1 by default, 0 to observe alone (0 to 100000) */
  ticks?: number;
  /** commands about tools, before the first tick; if one is refused none acts, but energy is still turned off where one asks for it */
  commands?: AdvanceCommand[];
  /** nothing by default */
  observe?: Observe;
}

/** a scalar channel */
export interface ObservedScalar {
  /** which */
  channel: 'positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact';
  /** of the vertices, in the channel's unit (-1e+300 to 1e+300) */
  values: number[];
}

/** a tool as it is */
export interface ObservedTool {
  /** its name */
  tool: string;
  /** of the tip: the actual pose, which tissue can stop (-1000000 to 1000000 m) */
  position_m: [number, number, number];
  /** quaternion w, x, y, z (-1.001 to 1.001) */
  rotation: [number, number, number, number];
  /** actual opening, 0 closed to 1 open (0 to 1) */
  jaw: number;
  /** whether its energy is on */
  energized: boolean;
  /** while energy is off: why; of the session, not of the simulated state */
  energy_off?: 'never_enabled' | 'commanded' | 'watchdog' | 'restored' | 'taken_over';
  /** of the tissue on the tool, filtered with the tool's `force_filter_s`; force_max_n at most (-1000000 to 1000000 N) */
  force_n: [number, number, number];
  /** about the tip, filtered as the force; force_max_n times tip_length_m at most (-1000000 to 1000000 N m) */
  torque_nm: [number, number, number];
  /** of the last tick, without filter and bound (-1000000000000 to 1000000000000 N) */
  raw_force_n: [number, number, number];
  /** about the tip, of the last tick, without filter and bound (-1000000000000 to 1000000000000 N m) */
  raw_torque_nm: [number, number, number];
  /** of the hot part (-300 to 1000000 degC) */
  tip_temperature_c: number;
  /** heat that tissue has taken up, about (0 to 1000000000000 J) */
  energy_j: number;
  /** with energy `tissue`: given to tissue in the last tick; else 0 (0 to 1000000 W) */
  power_w: number;
  /** that its generator finds; 0: no current flows (0 to 1000000000000 ohm) */
  load_ohm: number;
  /** vertices that it touches (0 to 9007199254740991) */
  contact_vertices: number;
  /** points that its jaws hold (0 to 9007199254740991) */
  grasped_vertices: number;
  /** of the last command applied (0 to 9007199254740991) */
  sequence: number;
}

/** a blood vessel as it is */
export interface ObservedVessel {
  /** its name */
  vessel: string;
  /** whether it is parted somewhere */
  parted: boolean;
  /** whether its wall has a hole somewhere */
  pierced: boolean;
  /** whether it is pressed so flat somewhere that nothing flows */
  shut: boolean;
  /** whether a seal withstands the pressure of its blood */
  sealed: boolean;
  /** whether blood leaves it */
  bleeds: boolean;
  /** blood that left it in the last tick, by time (0 to 1 m^3/s) */
  bleeding_m3_s: number;
  /** blood that has left it since the session began (0 to 1000000 m^3) */
  shed_m3: number;
  /** predicted pressure at which its best seal opens; 0: no seal (0 to 1000000000000 Pa) */
  burst_pa: number;
}

/** what heat and force have done, in volumes of the tissue at rest; links have none */
export interface ObservedDamage {
  /** tetrahedra and triangles that are not there any more (0 to 9007199254740991) */
  removed_count: number;
  /** their volume (0 to 1000000000 m^3) */
  removed_m3: number;
  /** volume of those that are there, each weighted by the mean exposure of its vertices (0 to 1000000000 m^3) */
  damaged_m3: number;
}

/** inside a region and outside it */
export interface RegionDamage {
  /** the region's */
  name: string;
  /** inside */
  inside: ObservedDamage;
  /** outside */
  outside: ObservedDamage;
}

/** where the energy of instruments went since the session was made; delivered_j and blade_j together are the sum of those after far_j; with energy `paper` all are 0 */
export interface ObservedEnergy {
  /** by current in tissue (-1000000000000 to 1000000000000 J) */
  delivered_j: number;
  /** from blades into tissue; below 0: the other way (-1000000000000 to 1000000000000 J) */
  blade_j: number;
  /** by current far away, where no heat is computed; not part of the sum (-1000000000000 to 1000000000000 J) */
  far_j: number;
  /** heat of the tissue above its first temperature (-1000000000000 to 1000000000000 J) */
  stored_j: number;
  /** taken along by water that boiled off, as steam and smoke (-1000000000000 to 1000000000000 J) */
  boiled_j: number;
  /** taken along by blood (-1000000000000 to 1000000000000 J) */
  perfused_j: number;
  /** lost at surfaces (-1000000000000 to 1000000000000 J) */
  ambient_j: number;
  /** heat of tissue that was removed (-1000000000000 to 1000000000000 J) */
  shed_j: number;
  /** volume of the tissue that is there and dead by heat (0 to 1000000000 m^3) */
  coagulated_m3: number;
  /** water that boiled off in the last tick (0 to 1000000 kg/s) */
  vapour_kg_s: number;
}

/** the ticks are made, and this is what was asked for */
export interface Advanced {
  /** where the session is now (0 to 9007199254740991) */
  tick: number;
  /** simulated (0 to 1000000000000 s) */
  time_s: number;
  /** ticks that were made: fewer than asked for where lock-step ended meanwhile (0 to 100000) */
  ticks: number;
  /** whether they are on the disk; false for ephemeral sessions */
  stored: boolean;
  /** x, y, z of the vertices (-1000000 to 1000000 m) */
  positions_m?: number[];
  /** words of 32 faces, the lowest bit first; a set bit: not drawn (0 to 4294967295) */
  mask?: number[];
  /** in the order of the channels */
  scalars?: ObservedScalar[];
  /** as they were added */
  tools?: ObservedTool[];
  /** in the scene's order */
  vessels?: ObservedVessel[];
  /** in the order of the request */
  regions?: RegionDamage[];
  /** of the whole session */
  energy?: ObservedEnergy;
}

/** sets the pace */
export interface SessionSpeed {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** simulated over wall time to aim at (0.01 to 10) */
  speed: number;
}

/** makes a new session from this one's state */
export interface SessionFork {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** wanted id of the new one, without the daemon's label; made up by default */
  name?: string;
  /** of the state; the present one by default (0 to 9007199254740991) */
  tick?: number;
  /** the new session starts paused; false by default */
  paused?: boolean;
}

/** stores the state under a name */
export interface SessionSnapshot {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** made up by default */
  name?: string;
}

/** a stored state */
export interface SnapshotResult {
  /** for session.restore */
  name: string;
  /** of the state (0 to 9007199254740991) */
  tick: number;
  /** of the whole state */
  hash: string;
  /** stored for it; 0: an earlier checkpoint and the log lead there (0 to 9007199254740991 B) */
  byte_count: number;
}

/** a state with a name */
export interface NamedSnapshot {
  /** for session.restore */
  name: string;
  /** of the state (0 to 9007199254740991) */
  tick: number;
  /** number of the branch that it was taken on (0 to 9007199254740991) */
  branch: number;
}

/** the session's states with a name */
export interface SnapshotList {
  /** by tick */
  snapshots: NamedSnapshot[];
}

/** restores a snapshot, energy off; a new branch */
export interface SessionRestore {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** of the snapshot */
  name: string;
}

/** rewinds to a tick, energy off; a new branch */
export interface SessionRewind {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** the timeline's oldest_tick or later, or what a refusal names (0 to 9007199254740991) */
  tick: number;
}

/** where a session is after a rewind, restore or reset */
export interface Restored {
  /** of the state (0 to 9007199254740991) */
  tick: number;
  /** of the frames from now on */
  epoch: string;
  /** number of the branch in the store (0 to 9007199254740991) */
  branch: number;
  /** false: written by another build or instruction set, so not bit-exact */
  exact: boolean;
}

/** asks for the tissue as a file */
export interface SessionExport {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** of the file */
  format: 'vtu' | 'obj';
}

/** asks for the command log as a script for cautery-sim */
export interface SessionLog {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** first tick; 0 by default (0 to 9007199254740991) */
  from_tick?: number;
  /** last tick; the present one by default (0 to 9007199254740991) */
  to_tick?: number;
}

/** a file that follows in binary chunks */
export interface Transfer {
  /** number in the chunks' headers (1 to 4294967295) */
  transfer: number;
  /** proposed */
  file_name: string;
  /** of the file */
  media_type: string;
  /** of the file (0 to 9007199254740991 B) */
  byte_count: number;
  /** of the file, 64 lower-case hex digits */
  sha256: string;
}

/** asks for what happened */
export interface SessionTimeline {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** first tick; 0 by default (0 to 9007199254740991) */
  from_tick?: number;
  /** newest events wanted at most; 1024 by default (1 to 4096) */
  count?: number;
}

/** something that happened on the present branch */
export interface TimelineEvent {
  /** when (0 to 9007199254740991) */
  tick: number;
  /** simulated (0 to 1000000000000 s) */
  time_s: number;
  /** what */
  kind: 'created' | 'cut' | 'tear' | 'inverted' | 'energy_gain' | 'bleeding' | 'bleeding_stopped' | 'sealed' | 'energy_on' | 'energy_off' | 'watchdog' | 'driver' | 'tool_added' | 'tool_removed' | 'refused' | 'fault' | 'rewind' | 'reset' | 'snapshot' | 'restore';
  /** with which tool */
  tool?: string;
  /** by whom */
  client?: string;
  /** cut: elements removed; refused: commands (0 to 9007199254740991) */
  count?: number;
  /** in words */
  detail?: string;
}

/** what happened, and how far back one can go */
export interface Timeline {
  /** the present (0 to 9007199254740991) */
  tick: number;
  /** from here on every tick can be reached (0 to 9007199254740991) */
  oldest_tick: number;
  /** number of the present branch (0 to 9007199254740991) */
  branch: number;
  /** oldest first; cuts within 30 ticks are one */
  events: TimelineEvent[];
}

/** when a change takes effect */
export interface TickResult {
  /** the tick border (0 to 9007199254740991) */
  tick: number;
}

/** asks what a session looked like; it goes on meanwhile, and nothing of it changes */
export interface SessionFrameAt {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** on the present line, from oldest_tick to the present (0 to 9007199254740991) */
  tick: number;
  /** by default those that the table of channels marks */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** quantisation; 5e-5 by default (1e-07 to 0.001 m) */
  step_m?: number;
  /** no section of the frame is in meshoptimizer's codec; false by default */
  plain?: boolean;
}

/** one key frame that follows in binary chunks, and what a decoder needs beside the session's topology; its tools have no drivers */
export interface PastFrame {
  /** number in the chunks' headers (1 to 4294967295) */
  transfer: number;
  /** proposed */
  file_name: string;
  /** of the file */
  media_type: string;
  /** of the frame (0 to 9007199254740991 B) */
  byte_count: number;
  /** of the frame, 64 lower-case hex digits */
  sha256: string;
  /** what it shows (0 to 9007199254740991) */
  tick: number;
  /** to the bit what was; false: replayed by another build or instruction set */
  exact: boolean;
  /** in the frame's header (0 to 4294967295) */
  session_number: number;
  /** in the frame's header (0 to 3) */
  profile: number;
  /** in the frame's header; that of no stream */
  epoch: string;
  /** in the frame */
  channels: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** of positions and scalars (0 to 16777216) */
  vertex_count: number;
  /** of the mask (0 to 16777216) */
  face_count: number;
  /** where the quantised zero is (-1000000 to 1000000 m) */
  origin_m: [number, number, number];
  /** one quantised step (1e-07 to 0.01 m) */
  step_m: number;
  /** one step of the stress channel (0.001 to 1000000000 Pa) */
  stress_step_pa: number;
}

/** how far a past view is */
export interface FrameProgress {
  /** its id */
  session: string;
  /** where it goes (0 to 9007199254740991) */
  tick: number;
  /** what it does */
  stage: 'building' | 'reading' | 'restoring' | 'replaying';
  /** where the replay began (0 to 9007199254740991) */
  from_tick: number;
  /** where it is (0 to 9007199254740991) */
  at_tick: number;
}

/** has the daemon copy its store */
export interface StoreBackup {
  /** of the copy, without .db; by default the time. Nothing is replaced */
  name?: string;
}

/** a copy of the store as it was at one moment, checked */
export interface StoreCopy {
  /** where it is, on the daemon's machine */
  file: string;
  /** its size (0 to 9007199254740991 B) */
  byte_count: number;
}

/** a session is to go to another daemon */
export interface MoveBegin {
  /** its id */
  session: string;
  /** its id there */
  target: string;
  /** of the daemon that is to have it */
  label: string;
  /** where that daemon is, for who asks for the old id; none where one address leads to all */
  url?: string;
}

/** a move has begun */
export interface MoveBegun {
  /** names it from here on */
  move: string;
}

/** names a move */
export interface MoveRef {
  /** its id on the daemon that is asked */
  session: string;
  /** of move.begin */
  move: string;
}

/** a state that a session stands at */
export interface MoveHeld {
  /** when (0 to 9007199254740991) */
  tick: number;
  /** of the state */
  hash: string;
  /** another daemon's state was read here to the bit; false: another build or instruction set wrote it, and what follows may differ in last digits */
  exact?: boolean;
}

/** what became of a move */
export interface MoveDecision {
  /** false: the session stays, and this move will never be */
  moved: boolean;
  /** its id there */
  target?: string;
  /** lets the other daemon serve it */
  proof?: string;
  /** where it stays: lets the other daemon forget the move */
  release?: string;
}

/** a piece of a session */
export interface MoveReceive {
  /** its id here */
  session: string;
  /** of move.begin */
  move: string;
  /** that holds the piece; it is gone with this */
  upload: string;
}

/** a piece is on the disk */
export interface MoveReceived {
  /** that are (0 to 9007199254740991) */
  pieces: number;
  /** of the last piece: proves to the other daemon that all are here */
  receipt?: string;
}

/** the other daemon has all pieces of a session */
export interface MoveCommit {
  /** its id here */
  session: string;
  /** of move.begin */
  move: string;
  /** of the other daemon's last move.receive */
  receipt: string;
}

/** the pieces of a move are to be removed */
export interface MoveForget {
  /** its id here */
  session: string;
  /** of move.begin */
  move: string;
  /** of move.cancel */
  release?: string;
  /** instead of a release: the other daemon is gone for good. If it had decided the move, the session is lost */
  source_lost?: boolean;
}

/** a session is to be served here */
export interface MoveAccept {
  /** its id here */
  session: string;
  /** of move.begin */
  move: string;
  /** of move.commit */
  proof: string;
}

/** a move, as this daemon knows it */
export interface MoveEntry {
  /** its id here */
  session: string;
  /** of move.begin */
  move: string;
  /** its id on the other daemon */
  other: string;
  /** leaving, held, deciding, gone; incoming, doubt (all is here, and whether it is to be served is known to the other daemon), accepting */
  state: string;
  /** gone: where the other daemon is, as it was said */
  url?: string;
}

/** moves of this daemon's sessions */
export interface MoveList {
  /** those that are not over first, then what has gone */
  moves: MoveEntry[];
}

/** a command that waits for a later tick */
export interface WaitingCommand {
  /** its own, for session.cancel (1 to 9007199254740991) */
  number: number;
  /** when it acts (1 to 9007199254740991) */
  tick: number;
  /** what it is, as tool.move */
  method: string;
  /** the tool that it is about */
  tool?: string;
  /** the driver's own count (0 to 9007199254740991) */
  sequence: number;
  /** the client that asked for it (1 to 4294967295) */
  client: number;
  /** that client's name */
  name: string;
}

/** the commands of a session that wait for later ticks */
export interface WaitingList {
  /** in the order in which they came; at most 64 of a client */
  commands: WaitingCommand[];
}

/** takes back commands that wait for later ticks */
export interface SessionCancel {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** the command's, of session.waiting; without it all of the caller's (1 to 9007199254740991) */
  number?: number;
}

/** what was taken back */
export interface Cancelled {
  /** commands (0 to 9007199254740991) */
  count: number;
}

/** asks for frames */
export interface SessionJoin {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** frames a wall second at most; 60 by default (0.1 to 1000 1/s) */
  rate_hz?: number;
  /** by default those that the table of channels marks */
  channels?: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** quantisation wanted; the server may choose a finer one; 5e-5 by default (1e-07 to 0.001 m) */
  step_m?: number;
  /** no section of the frames is in meshoptimizer's codec; false by default */
  plain?: boolean;
}

/** what a decoder needs; a topology frame and a key frame follow */
export interface StreamDescription {
  /** its id */
  session: string;
  /** in the frames' headers (0 to 4294967295) */
  session_number: number;
  /** in the frames' headers (0 to 3) */
  profile: number;
  /** at the time of joining */
  epoch: string;
  /** granted (0.1 to 1000 1/s) */
  rate_hz: number;
  /** granted */
  channels: ('positions' | 'mask' | 'exposure' | 'charring' | 'stress' | 'tools' | 'statistics' | 'temperature' | 'vessels' | 'blood' | 'tool_contact')[];
  /** of positions and scalars (0 to 16777216) */
  vertex_count: number;
  /** of mask and topology (0 to 16777216) */
  face_count: number;
  /** where the quantised zero is (-1000000 to 1000000 m) */
  origin_m: [number, number, number];
  /** one quantised step (1e-07 to 0.01 m) */
  step_m: number;
  /** one step of the stress channel (0.001 to 1000000000 Pa) */
  stress_step_pa: number;
  /** no section of its frames is in meshoptimizer's codec; absent from older servers */
  plain?: boolean;
}

/** how far the client has decoded; bounds what is in flight, shows delays */
export interface StreamAck {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** of the frame */
  epoch: string;
  /** of the frame (0 to 9007199254740991) */
  sequence: number;
}

/** names a tool of a session */
export interface ToolRef {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** its name */
  tool: string;
}

/** gives a tool up */
export interface ToolHandOver {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** its name */
  tool: string;
  /** to this connection; by default the tool has no driver (1 to 4294967295) */
  client?: number;
}

/** a command is in the log */
export interface CommandResult {
  /** the tick border at which it takes effect (0 to 9007199254740991) */
  tick: number;
  /** as given (0 to 9007199254740991) */
  sequence: number;
  /** false: the store was full; energy is off all the same */
  stored?: boolean;
}

/** announces a mesh file; takes the place of an upload of the same name, whole or not */
export interface UploadBegin {
  /** for scenes: meshes[].file of source bytes, with file_name's ending */
  name: string;
  /** for messages and the names of sessions; the format is found from the bytes */
  file_name: string;
  /** of the file, exactly (1 to 9007199254740991 B) */
  byte_count: number;
}

/** chunks may come */
export interface UploadBeginResult {
  /** number for the chunks' headers (1 to 4294967295) */
  transfer: number;
  /** of data in one chunk (1 to 9007199254740991 B) */
  chunk_bytes_max: number;
}

/** all chunks are sent */
export interface UploadEnd {
  /** as upload.begin answered (1 to 4294967295) */
  transfer: number;
  /** of the file, 64 lower-case hex digits */
  sha256: string;
}

/** an upload is a mesh to report on */
export interface MeshRead {
  /** as in upload.begin; whole */
  upload: string;
  /** metres in one unit of the file; guessed by default where it is clear (1e-09 to 1000 m) */
  unit_m?: number;
  /** fat (tetrahedra) or fascia (triangles); by default fat where there are tetrahedra, or an inside */
  as?: 'fascia' | 'membrane' | 'fat' | 'links';
  /** refuses a mesh that would have to be mended; false by default */
  strict?: boolean;
  /** never fills the mesh with tetrahedra, for a scene of one's own; false by default */
  as_it_is?: boolean;
  /** length of an edge of the tetrahedra that fill it; about 8,000 of them by default (1e-06 to 10 m) */
  edge_m?: number;
  /** of a segmentation: labels to keep, as in 1,3; all by default */
  labels?: string;
  /** sides that are pinned: bottom, top, left, right, front, back, with commas, or none; the bottom by default */
  pin?: string;
}

/** elements of one kind in the file */
export interface MeshKind {
  /** the kind: hexahedra */
  name: string;
  /** became elements of the mesh (0 to 9007199254740991) */
  read: number;
  /** were passed over (0 to 9007199254740991) */
  passed: number;
}

/** something that was mended */
export interface MeshMend {
  /** in words: duplicate vertices merged */
  what: string;
  /** how many (1 to 9007199254740991) */
  count: number;
}

/** a region of the mesh */
export interface MeshRegion {
  /** 2: of triangles, 3: of tetrahedra (2 to 3) */
  dimension: number;
  /** its number, as layers name it (-2147483648 to 2147483647) */
  region: number;
  /** elements (0 to 9007199254740991) */
  element_count: number;
  /** of the file, or empty */
  name: string;
}

/** what became of a mesh file */
export interface MeshReport {
  /** the whole report in words, one fact a line */
  text: string;
  /** Gmsh 4.1 */
  format: string;
  /** vertices in the file (0 to 9007199254740991) */
  vertices_read: number;
  /** elements in the file */
  kinds: MeshKind[];
  /** what was mended */
  mended: MeshMend[];
  /** vertices of the mesh (0 to 9007199254740991) */
  vertex_count: number;
  /** triangles (0 to 9007199254740991) */
  triangle_count: number;
  /** tetrahedra (0 to 9007199254740991) */
  tetrahedron_count: number;
  /** connected pieces (0 to 9007199254740991) */
  component_count: number;
  /** edges on the rim of a surface without tetrahedra; 0: closed (0 to 9007199254740991) */
  open_edge_count: number;
  /** the first regions */
  regions: MeshRegion[];
  /** of all regions (0 to 9007199254740991) */
  region_count: number;
  /** corner of the bounding box (-1000000 to 1000000 m) */
  least_m: [number, number, number];
  /** the opposite corner (-1000000 to 1000000 m) */
  most_m: [number, number, number];
  /** metres in one unit of the file, as used (1e-09 to 1000 m) */
  unit_m: number;
  /** elements by quality in tenths from 0 to 1 (mean ratio) (0 to 9007199254740991) */
  quality: number[];
  /** of all elements (0 to 1) */
  least_quality: number;
}

/** a mesh that was read */
export interface MeshReading {
  /** what became of the file */
  report: MeshReport;
  /** a scene around the upload, for session.create */
  definition: Scene;
  /** a choice that the user has: the surface was filled */
  note?: string;
}

/** an upload is not needed any more */
export interface UploadDiscard {
  /** as in upload.begin; it may be whole or still coming */
  name: string;
}

/** the file is kept until it is discarded, another takes its name, or the connection closes */
export interface UploadResult {
  /** as given */
  name: string;
  /** what a mesh of source bytes says in file */
  file: string;
  /** received (0 to 9007199254740991 B) */
  byte_count: number;
}

/** a session is no longer as it was */
export interface SessionChanged {
  /** why */
  change: 'created' | 'destroyed' | 'paused' | 'resumed' | 'stepped' | 'speed' | 'reset' | 'rewound' | 'restored' | 'restarted' | 'moved' | 'tools' | 'tissue';
  /** as it is now */
  summary: SessionSummary;
  /** who did it */
  client?: string;
  /** moved: the address of the daemon that has it now, if it is another */
  target?: string;
  /** moved: its id there */
  moved_to?: string;
}

/** the simulation met numerical trouble; rewind or reset */
export interface SessionFaulted {
  /** its id */
  session: string;
  /** when (0 to 9007199254740991) */
  tick: number;
  /** in words */
  reason: string;
}

/** a tool has another driver or lost its energy */
export interface DriverChanged {
  /** its id */
  session: string;
  /** as it is now */
  driver: Driver;
}

/** commands to a tool were refused; sent at most once a second and tool */
export interface ToolRefused {
  /** its id */
  session: string;
  /** the tool */
  tool: string;
  /** refused since the last such message (1 to 9007199254740991) */
  count: number;
  /** of the last one (0 to 9007199254740991) */
  sequence: number;
  /** why the last one was refused: a status of the error table */
  status: string;
  /** its offending member */
  path?: string;
  /** in words */
  reason: string;
}

/** another client asks the driver for a tool; answer with tool.hand_over or not at all */
export interface TakeoverRequested {
  /** its id */
  session: string;
  /** the tool */
  tool: string;
  /** who asks (1 to 4294967295) */
  client: number;
  /** the client's name in its hello */
  name: string;
}

/** something happened, as it will stand in the timeline */
export interface EventNotice {
  /** its id */
  session: string;
  /** what */
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
  /** a mesh file, relative to the scene file */
  file?: string;
  /** metres in one unit of the file (1e-09 to 1000 m) */
  unit_m?: number;
  /** 1: refuses a mesh that would have to be mended (0 to 1) */
  strict?: number;
  /** moves the mesh, after the unit (-100 to 100 m) */
  translate_m?: [number, number, number];
}

/** a choice of vertices by rest position */
export interface Selection {
  /** which vertices */
  kind: 'rim' | 'box' | 'sphere' | 'nearest';
  /** only of this layer; any if absent */
  layer?: string;
  /** least corner of the box (-100 to 100 m) */
  least_m?: [number, number, number];
  /** largest corner (-100 to 100 m) */
  most_m?: [number, number, number];
  /** centre of the sphere, or the place (-100 to 100 m) */
  center_m?: [number, number, number];
  /** radius of the sphere (0 to 100 m) */
  radius_m?: number;
}

/** a tool of a scene */
export interface Tool {
  /** name of the tool */
  name: string;
  /** profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none */
  instrument?: string;
  /** mode of the instrument; its first by default */
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
  /** spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** alpha of eq. 18 (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** faster commands are followed at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** fastest turning of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** of the attachment of one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** an attached vertex slips above this force (0 to 1000 N) */
  slip_force_n?: number;
  /** the tool pushes with this at most; drivers read it (0.01 to 1000 N) */
  force_max_n?: number;
  /** its jaws press what they hold with this at most (0.01 to 1000 N) */
  close_force_n?: number;
  /** power that is set, with energy `tissue` (0 to 400 W) */
  power_w?: number;
  /** most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** of the voltage: its peak over its root mean square (1.4 to 20) */
  crest_factor?: number;
  /** most current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of its filtered force; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100) */
  load_rise_off?: number;
  /** first place of the tip (-100 to 100 m) */
  position_m?: [number, number, number];
  /** unit quaternion w, x, y, z: tool frame (shaft along +z) to world */
  rotation?: [number, number, number, number];
}

/** a point of the middle line of a vessel */
export interface VesselPoint {
  /** a place of the line, at rest (-100 to 100 m) */
  at_m: [number, number, number];
}

/** a blood vessel in a layer of fat */
export interface Vessel {
  /** name of the vessel */
  name: string;
  /** layer of fat in which it lies */
  layer: string;
  /** outer radius of the tube (0.0001 to 0.01 m) */
  radius_m?: number;
  /** thickness of its wall; less than the radius (1e-05 to 0.005 m) */
  wall_m?: number;
  /** of the blood, at its first point (0 to 40000 Pa) */
  pressure_pa?: number;
  /** of the blood that comes back, at its last point (0 to 40000 Pa) */
  end_pressure_pa?: number;
  /** length of such a tube that blood has come through (0.001 to 10 m) */
  supply_m?: number;
  /** its middle line */
  points?: VesselPoint[];
}

/** a scripted pull, for measurements */
export interface Pull {
  /** way of the chosen vertices (-1 to 1 m) */
  move_m?: [number, number, number];
  /** time of the way (0.001 to 3600 s) */
  duration_s?: number;
  /** vertices that are pulled */
  selection: Selection;
}

/** a scripted cut, for measurements */
export interface Cut {
  /** tool of the scene */
  tool: string;
  /** where the tip dwells (-100 to 100 m) */
  from_m: [number, number, number];
  /** where it is drawn to (-100 to 100 m) */
  to_m: [number, number, number];
  /** unit quaternion w, x, y, z of the tool */
  rotation?: [number, number, number, number];
  /** time before it is drawn (0 to 3600 s) */
  dwell_s?: number;
  /** speed of drawing (1e-05 to 1 m/s) */
  speed_m_s?: number;
}

/** a layer of tissue */
export type Layer = FasciaLayer | MembraneLayer | FatLayer | LinksLayer;

/** what differs from the layer's material in a region */
export interface FasciaRegion {
  /** of the mesh file (0 to 2147483647) */
  region: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface FasciaLayer {
  /** tissue */
  kind: 'fascia';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: what heat and current find in it */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** what differs in regions of the mesh file */
  regions?: FasciaRegion[];
}

/** what differs from the layer's material in a region */
export interface MembraneRegion {
  /** of the mesh file (0 to 2147483647) */
  region: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface MembraneLayer {
  /** tissue */
  kind: 'membrane';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** membrane: the fat whose boundary it is; links: the upper layer */
  of?: string;
  /** material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: what heat and current find in it */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** what differs in regions of the mesh file */
  regions?: MembraneRegion[];
}

/** what differs from the layer's material in a region */
export interface FatRegion {
  /** of the mesh file (0 to 2147483647) */
  region: number;
  /** elastic energy */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99) */
  shear_max?: number;
  /** gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10) */
  yield_strain?: number;
  /** gamma_2; 0: no plasticity (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** a layer of this kind, with its material */
export interface FatLayer {
  /** tissue */
  kind: 'fat';
  /** name of the layer */
  name: string;
  /** mesh whose triangles or tetrahedra the layer takes */
  mesh?: string;
  /** material direction where the mesh has no UV; fat: first axis (-1000000 to 1000000) */
  fibre?: [number, number, number];
  /** with energy `tissue`: what heat and current find in it */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** retardation time, viscosity over stiffness: a swing at f Hz has a damping ratio of pi f times it; not with solver `diagonal` (0 to 10 s) */
  viscosity_s?: number;
  /** elastic energy */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99) */
  shear_max?: number;
  /** gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10) */
  yield_strain?: number;
  /** gamma_2; 0: no plasticity (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
  /** what differs in regions of the mesh file */
  regions?: FatRegion[];
}

/** a layer of this kind, with its material */
export interface LinksLayer {
  /** tissue */
  kind: 'links';
  /** name of the layer */
  name: string;
  /** membrane: the fat whose boundary it is; links: the upper layer */
  of?: string;
  /** the lower layer */
  to?: string;
  /** with energy `tissue`: what heat and current find in it */
  tissue?: 'connective' | 'fat' | 'liver' | 'muscle';
  /** with energy `tissue`: blood flow, as a share of that of the living tissue; 0: none (0 to 10) */
  perfusion?: number;
  /** share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more (0.01 to 1) */
  coagulated_tear?: number;
  /** Young's modulus of a truss (1 to 100000000000 Pa) */
  young_modulus_pa?: number;
  /** cross section of a truss (1e-12 to 1 m^2) */
  area_m2?: number;
  /** longest truss (1e-06 to 1 m) */
  reach_m?: number;
  /** trusses from each vertex of the upper sheet (1 to 8) */
  per_vertex?: number;
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** the plain data from which a session is made */
export interface Scene {
  /** name of the scene */
  name: string;
  /** a sentence for people */
  description?: string;
  /** time step; one tick (0.001 to 0.03333333333333333 s) */
  step_s?: number;
  /** v <- v exp(-c dt) (0 to 1000 1/s) */
  damping_per_s?: number;
  /** temperature of the body around the tools (-20 to 60 degC) */
  ambient_c?: number;
  /** stop a step at this relative residual; 0: never (0 to 1) */
  tolerance?: number;
  /** end a step at this error relative to its motion; 0: never (0 to 1) */
  accuracy?: number;
  /** tissue keeps this far from tissue; 0: it crosses (0 to 0.01 m) */
  contact_thickness_m?: number;
  /** of tissue on tissue (0 to 2) */
  contact_friction?: number;
  /** side of the cells of heat, with energy `tissue` (0.0001 to 0.005 m) */
  cell_m?: number;
  /** iterations of a step at most (small tissue: up to 64); with `accuracy` 0, of each (1 to 1000) */
  iterations?: number;
  /** global system; `newton`: and Newton's method for all sheets */
  solver?: 'cholesky' | 'diagonal' | 'newton';
  /** of the local and global steps */
  precision?: 'single' | 'double';
  /** how a tick advances motion: `euler` damps by the step; `sdirk2`, of second order, keeps 0.997 of a 5 Hz swing a period at 60 steps/s, for two solves a tick */
  integrator?: 'euler' | 'sdirk2';
  /** what heat parts: edges with all that share them, as in the paper, or elements one by one, so that a cut does not depend on the mesh */
  parting?: 'edges' | 'elements';
  /** what an energized tool does: `paper` holds a temperature; `tissue` gives power, boils water and parts elements, and needs parting `elements` */
  energy?: 'paper' | 'tissue';
  /** of everything drawn at random (0 to 9007199254740991) */
  seed?: number;
  /** gravity (-100 to 100 m/s^2) */
  gravity_m_s2?: [number, number, number];
  /** meshes that layers take */
  meshes?: Mesh[];
  /** layers of tissue */
  layers?: Layer[];
  /** vertices that are held */
  pins?: Selection[];
  /** tools that are there from the start */
  tools?: Tool[];
  /** blood vessels */
  vessels?: Vessel[];
  /** a scripted pull */
  pull?: Pull;
  /** a scripted cut */
  cut?: Cut;
}

/** a new tool, driven by the caller */
export interface ToolAdd {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
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
  /** spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** alpha of eq. 18 (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** faster commands are followed at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** fastest turning of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** of the attachment of one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** an attached vertex slips above this force (0 to 1000 N) */
  slip_force_n?: number;
  /** the tool pushes with this at most; drivers read it (0.01 to 1000 N) */
  force_max_n?: number;
  /** its jaws press what they hold with this at most (0.01 to 1000 N) */
  close_force_n?: number;
  /** power that is set, with energy `tissue` (0 to 400 W) */
  power_w?: number;
  /** most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** of the voltage: its peak over its root mean square (1.4 to 20) */
  crest_factor?: number;
  /** most current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of its filtered force; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100) */
  load_rise_off?: number;
  /** name of the tool */
  name: string;
  /** first place of the tip (-100 to 100 m) */
  position_m?: [number, number, number];
  /** unit quaternion w, x, y, z: tool frame (shaft along +z) to world */
  rotation?: [number, number, number, number];
  /** profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none */
  instrument?: string;
  /** mode of the instrument; its first by default */
  mode?: string;
}

/** takes it away */
export interface ToolRemove {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
}

/** replaces shape and sizes; an absent member takes the instrument's value, or the default */
export interface ToolConfigure {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
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
  /** spacing dl of the heat grid; at most the thinnest hot radius (5e-05 to 0.01 m) */
  grid_step_m?: number;
  /** alpha of eq. 18 (0 to 0.001 m^2/s) */
  diffusivity_m2_s?: number;
  /** faster commands are followed at this speed (0.001 to 5 m/s) */
  max_speed_m_s?: number;
  /** fastest turning of the tool (0.1 to 100 rad/s) */
  max_turn_rad_s?: number;
  /** Coulomb coefficient of the cold parts (0 to 2) */
  friction?: number;
  /** viscous drag of the hot part on each vertex in it (0 to 100 N s/m) */
  drag_ns_m?: number;
  /** of the attachment of one grasped vertex (1 to 1000000 N/m) */
  grasp_stiffness_n_m?: number;
  /** an attached vertex slips above this force (0 to 1000 N) */
  slip_force_n?: number;
  /** the tool pushes with this at most; drivers read it (0.01 to 1000 N) */
  force_max_n?: number;
  /** its jaws press what they hold with this at most (0.01 to 1000 N) */
  close_force_n?: number;
  /** power that is set, with energy `tissue` (0 to 400 W) */
  power_w?: number;
  /** most voltage, peak; from 200 V on it sparks and cuts (1 to 10000 V) */
  peak_v?: number;
  /** of the voltage: its peak over its root mean square (1.4 to 20) */
  crest_factor?: number;
  /** most current, root mean square (0.01 to 10 A) */
  current_max_a?: number;
  /** time constant of its filtered force; 0: no filter (0 to 1 s) */
  force_filter_s?: number;
  /** heat capacity of the hot part, with energy `tissue`; 0: that of its shape (0 to 100 J/K) */
  blade_heat_j_k?: number;
  /** heat that the hot part loses along the shaft; 0: that of its shape (0 to 1 W/K) */
  blade_cooling_w_k?: number;
  /** power ends when the load is so many times its least; off and on begins again; 0: never (0 to 100) */
  load_rise_off?: number;
  /** profile of an instrument (`deploy/instruments`): it has its shape, sizes and settings where this object has none */
  instrument?: string;
  /** mode of the instrument; its first by default */
  mode?: string;
}

/** moves it, at its speed limit; needs to be its driver */
export interface ToolMove {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
  /** place of the tip (-100 to 100 m) */
  position_m: [number, number, number];
  /** unit quaternion w, x, y, z */
  rotation: [number, number, number, number];
  /** 0 closed to 1 open (0 to 1) */
  jaw?: number;
}

/** energy on (driver only), for as many ticks as `ticks` says; or off */
export interface ToolEnergize {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
  /** on or off */
  energized: boolean;
  /** of an enable: its energy goes off after so many ticks; 0: no limit (0 to 2147483647) */
  ticks?: number;
}

/** closes the jaws on what is between them; driver only */
export interface ToolGrasp {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
}

/** opens them; driver only */
export interface ToolRelease {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
}

/** keeps the tool where it is, until it is moved again; driver only */
export interface ToolHold {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which tool */
  tool: string;
}

/** holds vertices where they are */
export interface Pin {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which vertices */
  selection: Selection;
}

/** lets them go */
export interface Unpin {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** which vertices */
  selection: Selection;
}

/** replaces a layer's material */
export type MaterialSet = MaterialSetFascia | MaterialSetMembrane | MaterialSetFat | MaterialSetLinks;

/** replaces a layer's material */
export interface MaterialSetFascia {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** the layer's kind */
  kind: 'fascia';
  /** which layer */
  layer: string;
  /** of the mesh file; 0: the layer's default (0 to 2147483647) */
  region?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces a layer's material */
export interface MaterialSetMembrane {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** the layer's kind */
  kind: 'membrane';
  /** which layer */
  layer: string;
  /** of the mesh file; 0: the layer's default (0 to 2147483647) */
  region?: number;
  /** sheet thickness (1e-06 to 0.05 m) */
  thickness_m?: number;
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** stiffness k of the strain limit (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_12| / sqrt(k_11 k_22) stays below (0 to 0.99) */
  shear_max?: number;
  /** bending; 0: no hinges (0 to 10 N m) */
  bending_stiffness_nm?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_01 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces a layer's material */
export interface MaterialSetFat {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** the layer's kind */
  kind: 'fat';
  /** which layer */
  layer: string;
  /** of the mesh file; 0: the layer's default (0 to 2147483647) */
  region?: number;
  /** elastic energy */
  model?: 'neohookean' | 'corotated' | 'stvk' | 'energy';
  /** mass density (1 to 25000 kg/m^3) */
  density_kg_m3?: number;
  /** Young's modulus (1 to 10000000000 Pa) */
  young_modulus_pa?: number;
  /** Poisson's ratio; at most 1/3 for model energy (0 to 0.45) */
  poisson_ratio?: number;
  /** stiffness of the strain limit and shrinkage (1 to 10000000000 Pa) */
  limit_stiffness_pa?: number;
  /** range: |k_ab| / sqrt(k_aa k_bb) stays below (0 to 0.99) */
  shear_max?: number;
  /** gamma_1 (strain with the half); plastic if gamma_2 > 0 (0 to 10) */
  yield_strain?: number;
  /** gamma_2; 0: no plasticity (0 to 10) */
  plastic_strain_max?: number;
  /** strain limit */
  limit?: 'none' | 'target' | 'range';
  /** how a target is projected */
  projection?: 'closed_form' | 'linearised';
  /** target: t_00, t_11, t_22, t_01, t_02, t_12 of F^T F; positive definite (-100 to 100) */
  target?: [number, number, number, number, number, number];
  /** range: least engineering strain along each axis (-0.99 to 0) */
  strain_min?: [number, number, number];
  /** range: largest (0 to 100) */
  strain_max?: [number, number, number];
  /** S of eq. 21: squared stretches; 1: no shrinkage (0.01 to 4) */
  shrink?: [number, number, number];
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** replaces a layer's material */
export interface MaterialSetLinks {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** the layer's kind */
  kind: 'links';
  /** which layer */
  layer: string;
  /** Young's modulus of a truss (1 to 100000000000 Pa) */
  young_modulus_pa?: number;
  /** cross section of a truss (1e-12 to 1 m^2) */
  area_m2?: number;
  /** longest truss (1e-06 to 1 m) */
  reach_m?: number;
  /** trusses from each vertex of the upper sheet (1 to 8) */
  per_vertex?: number;
  /** it parts when its exposure exceeds this (1 to 2000 degC) */
  ignition_c?: number;
  /** standard deviation, drawn by seed (0 to 500 degC) */
  ignition_spread_c?: number;
  /** width of bundles that part alike; 0: none (0 to 0.1 m) */
  ignition_bundle_m?: number;
  /** xi of eq. 20 (0 to 1000 1/s) */
  absorption_per_s?: number;
  /** energy that a tear takes by its area; 0: none does (0 to 1000000 J/m^2) */
  tear_energy_j_m2?: number;
}

/** for the whole session */
export interface GravitySet {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** gravity (-100 to 100 m/s^2) */
  gravity_m_s2: [number, number, number];
}

/** an outer force on vertices */
export interface ForceSet {
  /** its id; that of the connection's URL by default */
  session?: string;
  /** see session_change (1 to 9007199254740991) */
  client_sequence?: number;
  /** applied at the first tick border at or after this; 0: the next (0 to 9007199254740991) */
  tick?: number;
  /** the driver's own count (0 to 9007199254740991) */
  sequence?: number;
  /** on each chosen vertex (-1000 to 1000 N) */
  force_n: [number, number, number];
  /** which vertices */
  selection: Selection;
}

/** Requests: params and result of each method. */
export interface Requests {
  /** first of all; nothing else is served before it */
  'hello': { params: Hello; result: HelloResult };
  /** sign of life of a driver, every 100 ms while energy is on */
  'heartbeat': { params: Heartbeat; result: HeartbeatResult };
  /** scenes of the daemon */
  'scene.list': { params: Nothing; result: SceneList };
  /** one of them whole */
  'scene.get': { params: SceneRef; result: SceneResult };
  /** profiles of instruments */
  'instrument.list': { params: Nothing; result: InstrumentList };
  /** sessions of the daemon */
  'session.list': { params: Nothing; result: SessionList };
  /** makes a session */
  'session.create': { params: SessionCreate; result: SessionDescription };
  /** layers, drivers, scene */
  'session.describe': { params: SessionRef; result: SessionDescription };
  /** asks for frames; again to change the profile */
  'session.join': { params: SessionJoin; result: StreamDescription };
  /** no more frames */
  'session.leave': { params: SessionRef; result: Nothing };
  /** stops time at a tick border; cuts energy */
  'session.pause': { params: SessionChange; result: SessionSummary };
  /** lets time run */
  'session.resume': { params: SessionChange; result: SessionSummary };
  /** advances a paused session; answered when done */
  'session.step': { params: SessionStep; result: TickResult };
  /** lock-step: commands, ticks and what came of them in one request. The session must be paused. It has no client_sequence: `tick` says whether it was done */
  'session.advance': { params: SessionAdvance; result: Advanced };
  /** sets the pace */
  'session.speed': { params: SessionSpeed; result: SessionSummary };
  /** back to tick 0; a new branch */
  'session.reset': { params: SessionChange; result: Restored };
  /** ends it and removes it from the store, also one that the daemon could not bring up */
  'session.destroy': { params: SessionChange; result: Nothing };
  /** a new session from this state, energy off */
  'session.fork': { params: SessionFork; result: SessionDescription };
  /** stores the state under a name */
  'session.snapshot': { params: SessionSnapshot; result: SnapshotResult };
  /** the snapshots that session.restore can restore, those of other branches too */
  'session.snapshots': { params: SessionRef; result: SnapshotList };
  /** back to a snapshot */
  'session.restore': { params: SessionRestore; result: Restored };
  /** back to a tick */
  'session.rewind': { params: SessionRewind; result: Restored };
  /** the tissue as a file; binary chunks follow */
  'session.export': { params: SessionExport; result: Transfer };
  /** the command log as a script; binary chunks follow */
  'session.log': { params: SessionLog; result: Transfer };
  /** cuts and other events */
  'session.timeline': { params: SessionTimeline; result: Timeline };
  /** the key frame of a past tick; nothing is rewound; binary chunks follow. A second request of a client cancels its first */
  'session.frame_at': { params: SessionFrameAt; result: PastFrame };
  /** gives up the client's session.frame_at that is under way, if there is one */
  'session.frame_cancel': { params: SessionRef; result: Nothing };
  /** the commands that wait for later ticks */
  'session.waiting': { params: SessionRef; result: WaitingList };
  /** takes back commands that wait for later ticks: the caller's own; with a number and role admin anybody's. Each is answered with `bad_state` */
  'session.cancel': { params: SessionCancel; result: Cancelled };
  /** asks for a key frame; at most one a second */
  'stream.key_frame': { params: SessionRef; result: Nothing };
  /** a new tool, driven by the caller */
  'tool.add': { params: ToolAdd; result: CommandResult };
  /** takes it away */
  'tool.remove': { params: ToolRemove; result: CommandResult };
  /** replaces shape and sizes; an absent member takes the instrument's value, or the default */
  'tool.configure': { params: ToolConfigure; result: CommandResult };
  /** moves it, at its speed limit; needs to be its driver */
  'tool.move': { params: ToolMove; result: CommandResult };
  /** energy on (driver only), for as many ticks as `ticks` says; or off */
  'tool.energize': { params: ToolEnergize; result: CommandResult };
  /** closes the jaws on what is between them; driver only */
  'tool.grasp': { params: ToolGrasp; result: CommandResult };
  /** opens them; driver only */
  'tool.release': { params: ToolRelease; result: CommandResult };
  /** keeps the tool where it is, until it is moved again; driver only */
  'tool.hold': { params: ToolHold; result: CommandResult };
  /** becomes the driver: of a tool without a driver, or with role admin; energy off */
  'tool.take_over': { params: ToolRef; result: Driver };
  /** asks its driver, who sees takeover.requested */
  'tool.request_takeover': { params: ToolRef; result: Nothing };
  /** gives it up; energy off; driver only */
  'tool.hand_over': { params: ToolHandOver; result: Driver };
  /** holds vertices where they are */
  'pin': { params: Pin; result: CommandResult };
  /** lets them go */
  'unpin': { params: Unpin; result: CommandResult };
  /** replaces a layer's material */
  'material.set': { params: MaterialSet; result: CommandResult };
  /** for the whole session */
  'gravity.set': { params: GravitySet; result: CommandResult };
  /** an outer force on vertices */
  'force.set': { params: ForceSet; result: CommandResult };
  /** announces a mesh file */
  'upload.begin': { params: UploadBegin; result: UploadBeginResult };
  /** checks its length and hash */
  'upload.end': { params: UploadEnd; result: UploadResult };
  /** reads an upload as a mesh: the report, and a scene around it for session.create */
  'mesh.read': { params: MeshRead; result: MeshReading };
  /** forgets it; sessions made of it stay */
  'upload.discard': { params: UploadDiscard; result: Nothing };
  /** copies the daemon's store while everybody goes on, to a file on its machine; one at a time */
  'store.backup': { params: StoreBackup; result: StoreCopy };
  /** a session is to go to another daemon; it is served meanwhile */
  'move.begin': { params: MoveBegin; result: MoveBegun };
  /** the next piece of it; binary chunks follow */
  'move.read': { params: MoveRef; result: Transfer };
  /** suspends the session, energy off; requests to it wait */
  'move.hold': { params: MoveRef; result: MoveHeld };
  /** by the receipt that the other daemon has all pieces on its disk, the session ends here; the answer lets the other daemon serve it */
  'move.commit': { params: MoveCommit; result: MoveDecision };
  /** it stays, unless it has moved: the answer says which */
  'move.cancel': { params: MoveRef; result: MoveDecision };
  /** an upload is a piece of a session that comes here; answered when it is on the disk */
  'move.receive': { params: MoveReceive; result: MoveReceived };
  /** builds what has come, and answers when it could be served soon */
  'move.ready': { params: MoveRef; result: MoveHeld };
  /** it is this daemon's, by the proof of move.commit; answered when it is served */
  'move.accept': { params: MoveAccept; result: SessionDescription };
  /** removes the pieces of a move, by the release of move.cancel */
  'move.forget': { params: MoveForget; result: Nothing };
  /** sessions that come, are in doubt, are leaving, or have gone */
  'move.list': { params: Nothing; result: MoveList };
}

/** Notifications from the client. */
export interface Notices {
  /** sign of life of a driver, every 100 ms while energy is on */
  'heartbeat': Heartbeat;
  /** how far the client has decoded */
  'stream.ack': StreamAck;
  /** moves it, at its speed limit; needs to be its driver */
  'tool.move': ToolMove;
}

/** Notifications from the server. */
export interface Pushes {
  /** to everybody who joined the session, and to all for created and destroyed */
  'session.changed': SessionChanged;
  /** to everybody who joined the session */
  'session.faulted': SessionFaulted;
  /** to everybody who joined the session */
  'tool.driver_changed': DriverChanged;
  /** to the tool's driver */
  'tool.refused': ToolRefused;
  /** to the tool's driver */
  'takeover.requested': TakeoverRequested;
  /** to who waits for session.frame_at, about ten times a second */
  'session.frame_progress': FrameProgress;
  /** to everybody who joined the session */
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
  1002: 'the WebSocket protocol was broken',
  1003: 'a binary message that is no chunk of an upload',
  1007: 'a text message that is not UTF-8',
  1009: 'a message beyond the limit',
  1011: 'the server met an error of its own',
  1013: 'too many connections',
  4001: 'no hello within 5 s',
  4002: 'the token is missing or not known',
  4003: 'no common version',
  4004: 'frames were not read fast enough',
  4005: 'too many messages a second',
  4006: 'pings were not answered',
  4007: 'another connection resumed this one',
  4008: 'too many malformed messages',
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
  /** the largest of the vertex's edges': heat taken up over what ignites it, 0 to 1 */
  exposure: { section: 3, byDefault: true, least: 0, step: 0.00392156862745098, most: 255, unit: '1' },
  /** share of the vertex's edges that have parted, 0 to 1 */
  charring: { section: 4, byDefault: true, least: 0, step: 0.00392156862745098, most: 255, unit: '1' },
  /** von Mises stress of fat, volume weighted */
  stress: { section: 5, byDefault: false, least: 0, step: 0, most: 65535, unit: 'Pa' },
  /** what the tools' heat grids say at the vertex, elsewhere the scene's ambient_c */
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
  capsule: { hot: true, jaws: false, meaning: 'hot needle of tip_length_m, cold shaft' },
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
      meaning: "v <- v exp(-c dt)" },
    { name: 'ambient_c', unit: 'degC', least: -20, most: 60, default: 37,
      meaning: "temperature of the body around the tools" },
    { name: 'tolerance', unit: '1', least: 0, most: 1, default: 0,
      meaning: "stop a step at this relative residual; 0: never" },
    { name: 'accuracy', unit: '1', least: 0, most: 1, default: 0.01,
      meaning: "end a step at this error relative to its motion; 0: never" },
    { name: 'contact_thickness_m', unit: 'm', least: 0, most: 0.01, default: 0,
      meaning: "tissue keeps this far from tissue; 0: it crosses" },
    { name: 'contact_friction', unit: '1', least: 0, most: 2, default: 0.1,
      meaning: "of tissue on tissue" },
    { name: 'cell_m', unit: 'm', least: 0.0001, most: 0.005, default: 0.00025,
      meaning: "side of the cells of heat, with energy `tissue`" },
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
      meaning: "spacing dl of the heat grid; at most the thinnest hot radius" },
    { name: 'diffusivity_m2_s', unit: 'm^2/s', least: 0, most: 0.001, default: 4.2e-06,
      meaning: "alpha of eq. 18" },
    { name: 'max_speed_m_s', unit: 'm/s', least: 0.001, most: 5, default: 0.5,
      meaning: "faster commands are followed at this speed" },
    { name: 'max_turn_rad_s', unit: 'rad/s', least: 0.1, most: 100, default: 12,
      meaning: "fastest turning of the tool" },
    { name: 'friction', unit: '1', least: 0, most: 2, default: 0.2,
      meaning: "Coulomb coefficient of the cold parts" },
    { name: 'drag_ns_m', unit: 'N s/m', least: 0, most: 100, default: 0.05,
      meaning: "viscous drag of the hot part on each vertex in it" },
    { name: 'grasp_stiffness_n_m', unit: 'N/m', least: 1, most: 1000000, default: 200,
      meaning: "of the attachment of one grasped vertex" },
    { name: 'slip_force_n', unit: 'N', least: 0, most: 1000, default: 2,
      meaning: "an attached vertex slips above this force" },
    { name: 'force_max_n', unit: 'N', least: 0.01, most: 1000, default: 20,
      meaning: "the tool pushes with this at most; drivers read it" },
    { name: 'close_force_n', unit: 'N', least: 0.01, most: 1000, default: 8,
      meaning: "its jaws press what they hold with this at most" },
    { name: 'power_w', unit: 'W', least: 0, most: 400, default: 30,
      meaning: "power that is set, with energy `tissue`" },
    { name: 'peak_v', unit: 'V', least: 1, most: 10000, default: 1150,
      meaning: "most voltage, peak; from 200 V on it sparks and cuts" },
    { name: 'crest_factor', unit: '1', least: 1.4, most: 20, default: 1.4,
      meaning: "of the voltage: its peak over its root mean square" },
    { name: 'current_max_a', unit: 'A', least: 0.01, most: 10, default: 2,
      meaning: "most current, root mean square" },
    { name: 'force_filter_s', unit: 's', least: 0, most: 1, default: 0.02,
      meaning: "time constant of its filtered force; 0: no filter" },
    { name: 'blade_heat_j_k', unit: 'J/K', least: 0, most: 100, default: 0,
      meaning: "heat capacity of the hot part, with energy `tissue`; 0: that of its shape" },
    { name: 'blade_cooling_w_k', unit: 'W/K', least: 0, most: 1, default: 0,
      meaning: "heat that the hot part loses along the shaft; 0: that of its shape" },
    { name: 'load_rise_off', unit: '1', least: 0, most: 100, default: 0,
      meaning: "power ends when the load is so many times its least; off and on begins again; 0: never" },
  ],
  fascia: [
    { name: 'thickness_m', unit: 'm', least: 1e-06, most: 0.05, default: 0.0005,
      meaning: "sheet thickness" },
    { name: 'density_kg_m3', unit: 'kg/m^3', least: 1, most: 25000, default: 1100,
      meaning: "mass density" },
    { name: 'limit_stiffness_pa', unit: 'Pa', least: 1, most: 10000000000, default: 1000000,
      meaning: "stiffness k of the strain limit" },
    { name: 'shear_max', unit: '1', least: 0, most: 0.99, default: 0,
      meaning: "range: |k_12| / sqrt(k_11 k_22) stays below" },
    { name: 'bending_stiffness_nm', unit: 'N m', least: 0, most: 10, default: 0,
      meaning: "bending; 0: no hinges" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 172,
      meaning: "it parts when its exposure exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation, drawn by seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of bundles that part alike; 0: none" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "xi of eq. 20" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy that a tear takes by its area; 0: none does" },
  ],
  membrane: [
    { name: 'thickness_m', unit: 'm', least: 1e-06, most: 0.05, default: 0.0005,
      meaning: "sheet thickness" },
    { name: 'density_kg_m3', unit: 'kg/m^3', least: 1, most: 25000, default: 1100,
      meaning: "mass density" },
    { name: 'limit_stiffness_pa', unit: 'Pa', least: 1, most: 10000000000, default: 1000000,
      meaning: "stiffness k of the strain limit" },
    { name: 'shear_max', unit: '1', least: 0, most: 0.99, default: 0,
      meaning: "range: |k_12| / sqrt(k_11 k_22) stays below" },
    { name: 'bending_stiffness_nm', unit: 'N m', least: 0, most: 10, default: 0,
      meaning: "bending; 0: no hinges" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 96.40000000000001,
      meaning: "it parts when its exposure exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation, drawn by seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of bundles that part alike; 0: none" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "xi of eq. 20" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy that a tear takes by its area; 0: none does" },
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
      meaning: "range: |k_ab| / sqrt(k_aa k_bb) stays below" },
    { name: 'yield_strain', unit: '1', least: 0, most: 10, default: 0,
      meaning: "gamma_1 (strain with the half); plastic if gamma_2 > 0" },
    { name: 'plastic_strain_max', unit: '1', least: 0, most: 10, default: 0,
      meaning: "gamma_2; 0: no plasticity" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 76,
      meaning: "it parts when its exposure exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation, drawn by seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of bundles that part alike; 0: none" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "xi of eq. 20" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy that a tear takes by its area; 0: none does" },
  ],
  links: [
    { name: 'young_modulus_pa', unit: 'Pa', least: 1, most: 100000000000, default: 100000,
      meaning: "Young's modulus of a truss" },
    { name: 'area_m2', unit: 'm^2', least: 1e-12, most: 1, default: 1e-06,
      meaning: "cross section of a truss" },
    { name: 'reach_m', unit: 'm', least: 1e-06, most: 1, default: 0.005,
      meaning: "longest truss" },
    { name: 'per_vertex', unit: '1', least: 1, most: 8, default: 3,
      meaning: "trusses from each vertex of the upper sheet" },
    { name: 'ignition_c', unit: 'degC', least: 1, most: 2000, default: 172,
      meaning: "it parts when its exposure exceeds this" },
    { name: 'ignition_spread_c', unit: 'degC', least: 0, most: 500, default: 0,
      meaning: "standard deviation, drawn by seed" },
    { name: 'ignition_bundle_m', unit: 'm', least: 0, most: 0.1, default: 0,
      meaning: "width of bundles that part alike; 0: none" },
    { name: 'absorption_per_s', unit: '1/s', least: 0, most: 1000, default: 0.4,
      meaning: "xi of eq. 20" },
    { name: 'tear_energy_j_m2', unit: 'J/m^2', least: 0, most: 1000000, default: 0,
      meaning: "energy that a tear takes by its area; 0: none does" },
  ],
} satisfies Record<string, Parameter[]>;
