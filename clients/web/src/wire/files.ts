// SPDX-License-Identifier: Apache-2.0
// Files in both directions: uploads in chunks with progress, exports put together and checked.
import type { Chunk } from './chunk';
import { writeChunk } from './chunk';
import type { Connection } from './connection';
import { RpcError } from './connection';
import type { Transfer, UploadResult } from './messages.gen';

async function sha256(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
  // A page from another machine without TLS has no SubtleCrypto.
  if (typeof crypto === 'undefined' || !('subtle' in crypto) || !crypto.subtle)
    throw new RpcError('unsupported', 'uploads need a secure page: use https, or the daemon on this machine');
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

export async function upload(
  connection: Connection,
  name: string,
  fileName: string,
  bytes: Uint8Array<ArrayBuffer>,
  progress: (sent: number) => void,
): Promise<UploadResult> {
  const hash = await sha256(bytes);
  const begun = await connection.request('upload.begin', { name, file_name: fileName, byte_count: bytes.byteLength });
  const { transfer, chunk_bytes_max: most } = begun;
  for (let offset = 0; offset < bytes.byteLength; offset += most) {
    connection.sendBytes(writeChunk({ transfer, offset, data: bytes.subarray(offset, offset + most) }));
    progress(Math.min(offset + most, bytes.byteLength));
    // gives other answers and the progress bar a chance
    await new Promise((resolve) => setTimeout(resolve));
  }
  return connection.request('upload.end', { transfer, sha256: hash });
}

export interface ReceivedFile {
  name: string;
  mediaType: string;
  bytes: Uint8Array<ArrayBuffer>;
  /** whether the hash is the announced one */
  sound: boolean;
}

type Done = (file: ReceivedFile) => void;

interface Download {
  transfer: Transfer;
  bytes: Uint8Array<ArrayBuffer>;
  got: number;
  done: Done;
}

/** Collects the chunks of announced transfers until the files are complete. */
export class Downloads {
  private readonly open = new Map<number, Download>();

  constructor(private readonly done: Done) {}

  /** Expects a transfer. `done` receives this file instead of the common receiver. */
  announce(transfer: Transfer, done = this.done): void {
    const download = { transfer, bytes: new Uint8Array(transfer.byte_count), got: 0, done };
    if (transfer.byte_count === 0) void this.finish(download);
    else this.open.set(transfer.transfer, download);
  }

  take(chunk: Chunk): void {
    const download = this.open.get(chunk.transfer);
    if (!download) return;
    const end = chunk.offset + chunk.data.byteLength;
    if (chunk.offset !== download.got || end > download.bytes.byteLength) {
      this.open.delete(chunk.transfer);
      return;
    }
    download.bytes.set(chunk.data, chunk.offset);
    download.got = end;
    if (end < download.bytes.byteLength) return;
    this.open.delete(chunk.transfer);
    void this.finish(download);
  }

  private async finish({ transfer, bytes, done }: Download): Promise<void> {
    const sound = await sha256(bytes).then(
      (hash) => hash === transfer.sha256,
      () => true, // without SubtleCrypto the hash cannot be checked
    );
    done({ name: transfer.file_name, mediaType: transfer.media_type, bytes, sound });
  }
}
