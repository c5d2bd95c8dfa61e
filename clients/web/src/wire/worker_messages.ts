// SPDX-License-Identifier: GPL-3.0-or-later
// The messages between page and worker.
import type { Surroundings } from '../model/field_shape';
import type { Moment } from '../model/history';
import type { LipShape } from '../model/lips';
import type { SurfaceShape } from '../model/surface';
import type { Batch, ShownScalar } from '../model/tissue';
import type { LinkState } from './connection';
import type { Pushes, Requests, Notices, SessionDescription, SessionJoin, StreamDescription } from './messages.gen';
import type { Statistics, ToolState } from './records';
import type { VesselState } from './vessels';

export type Channels = NonNullable<SessionJoin['channels']>;

export type ToWorker =
  | { type: 'connect'; url: string; client: string; clientId: string; token?: string }
  | { type: 'follow'; url: string }
  | { type: 'call'; call: number; method: keyof Requests; params: object }
  | { type: 'notice'; method: keyof Notices; params: object }
  /** `atUs`: when the page gave this sign of life, by its own clock that never goes back */
  | { type: 'heartbeat'; visible: boolean; atUs: number }
  | { type: 'watch'; session: string | null; channels: Channels; scalar: ShownScalar }
  | { type: 'inspect'; call: number; vertex: number }
  | { type: 'past'; call: number; session: string; tick: number }
  | { type: 'present' }
  | { type: 'upload'; call: number; name: string; fileName: string; bytes: ArrayBuffer }
  | { type: 'return'; buffers: FrameBuffers };

/** Arrays of a frame on their way to the page and back. */
export interface FrameBuffers {
  position: Float32Array;
  normal: Float32Array;
  burn: Uint8Array;
}

/** A vertex by the newest frame; null where the stream does not have it. */
export interface VertexState {
  vertex: number;
  /** 1: it parts */
  exposure: number;
  /** share of its edges that are burnt through */
  charring: number;
  stressPa: number | null;
  temperatureC: number | null;
}

/** One decoded frame for the plots. */
export interface Sample {
  /** the page's clock */
  atS: number;
  tick: number;
  latencyMs: number;
  bytes: number;
  decodeMs: number;
  statistics: Statistics | null;
  forceN: number;
  energyJ: number;
  moment: Moment;
}

export interface TissueBatch extends Omit<Batch, 'faces'> {
  faceCount: number;
}

/** Everything that stays while a session is watched. */
export interface Joined {
  description: SessionDescription;
  stream: StreamDescription;
  batches: TissueBatch[];
  rest: Float32Array;
  material: Float32Array;
  surroundings: Surroundings | null;
  /** the fourth byte of `burn` is the depth of blood */
  blood: boolean;
}

export interface PastState {
  tick: number;
  timeS: number;
  tools: ToolState[];
  vessels: VesselState[];
}

export interface Frame {
  session: string;
  epoch: string;
  sequence: number;
  tick: number;
  timeS: number;
  paused: boolean;
  faulted: boolean;
  /** tissue looks other than in the frame that was handed over before */
  changed: boolean;
  buffers: FrameBuffers;
  /** index of drawn faces by batch, where they changed since the last frame that was handed over; `plain` faces of
   * them, the first ones, are drawn as they are, the others as lips */
  drawn: { batch: number; index: Uint32Array; plain: number }[];
  /** what cuts lay bare, by batch; changed: those that have or had any */
  lips: ({ batch: number } & LipShape)[];
  /** walls at the borders of sheets, by batch */
  edges: ({ batch: number } & SurfaceShape)[];
  drawnFaces: Record<string, number>;
  stressScalePa: number;
  /** of the colours, degC; null where the stream has no temperature */
  temperatureRangeC: readonly [number, number] | null;
  tools: ToolState[];
  vessels: VesselState[];
  /** what buffers, faces and colours are of, where that is a past tick; all else is of the newest */
  past: PastState | null;
  samples: Sample[];
  framesDecoded: number;
  framesSkipped: number;
}

export type FromWorker =
  | { type: 'link'; state: LinkState }
  | { type: 'answer'; call: number; result: unknown }
  | { type: 'failure'; call: number; status: string; message: string; path?: string }
  | { type: 'push'; method: keyof Pushes; params: Pushes[keyof Pushes] }
  | { type: 'joined'; joined: Joined }
  | { type: 'not_joined'; session: string; message: string; status: string }
  | { type: 'moved'; session: string; to: string; url: string }
  | { type: 'frame'; frame: Frame }
  | { type: 'progress'; call: number; sent: number; total: number }
  | { type: 'file'; name: string; mediaType: string; bytes: Uint8Array<ArrayBuffer>; sound: boolean };
