// SPDX-License-Identifier: Apache-2.0
// The package `cautery`: the viewer's wire module (clients/web/src/wire), and a client that combines its parts.
export { Client, type ClientOptions } from './client';
export { Stream } from './stream';
export type { ContactPlane, ContactState } from '../../web/src/wire/contacts';
export { Connection, RpcError, type ConnectionEvents, type ConnectionOptions, type LinkState, type Socket } from '../../web/src/wire/connection';
export { FrameDecoder, type Changes, type Outcome, type StreamShape, type StreamState } from '../../web/src/wire/decoder';
export { decoderReady } from '../../web/src/wire/elements';
export { Downloads, upload, type ReceivedFile } from '../../web/src/wire/files';
export { readHeader, WireError, type FrameHeader } from '../../web/src/wire/header';
export type { Statistics, ToolState } from '../../web/src/wire/records';
export type { VesselState } from '../../web/src/wire/vessels';
export { Subscription, type SubscriptionEvents } from '../../web/src/wire/subscription';
export { decodeTopology, type Topology } from '../../web/src/wire/topology';
export * from '../../web/src/wire/messages.gen';
