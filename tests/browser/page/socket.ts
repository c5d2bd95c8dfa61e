// SPDX-License-Identifier: GPL-3.0-or-later
// The part of RFC 6455 that tests need to stand between a page and a daemon: whole messages, at either end.
import { createHash, randomBytes } from 'node:crypto';
import { request, type IncomingMessage } from 'node:http';
import type { Duplex } from 'node:stream';

const GUID = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';
const TEXT = 1;
const BINARY = 2;
const CLOSE = 8;
const PING = 9;
const PONG = 10;
const FINAL = 0x80;

export class MessageSocket {
  onText: (text: string) => void = () => undefined;
  onBinary: (bytes: Buffer) => void = () => undefined;
  onClose: () => void = () => undefined;
  private received = Buffer.alloc(0);
  private parts: Buffer[] = [];
  private opcode = 0;

  /** `masks` is true at the client's end. */
  constructor(
    private readonly stream: Duplex,
    private readonly masks: boolean,
  ) {
    stream.on('data', (bytes: Buffer) => this.take(bytes));
    stream.on('close', () => this.onClose());
    stream.on('error', () => stream.destroy());
  }

  /** Returns the client's end of a new connection. */
  static connect(url: URL, protocol: string): Promise<MessageSocket> {
    return new Promise((resolve, reject) => {
      const headers = {
        'Connection': 'Upgrade', 'Upgrade': 'websocket', 'Sec-WebSocket-Version': '13',
        'Sec-WebSocket-Key': randomBytes(16).toString('base64'), 'Sec-WebSocket-Protocol': protocol,
      };
      const asked = request(url, { headers });
      asked.on('upgrade', (_answer, stream, head) => {
        const made = new MessageSocket(stream, true);
        if (head.length > 0) stream.unshift(head);
        resolve(made);
      });
      asked.on('response', (answer) => reject(new Error(`no upgrade but ${answer.statusCode}`)));
      asked.on('error', reject);
      asked.end();
    });
  }

  /** Returns the server's end of a connection that requests an upgrade. */
  static accept(asked: IncomingMessage, stream: Duplex): MessageSocket {
    const key = asked.headers['sec-websocket-key'] ?? '';
    const accepted = createHash('sha1').update(key + GUID).digest('base64');
    stream.write(
      'HTTP/1.1 101 Switching Protocols\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n' +
        `Sec-WebSocket-Accept: ${accepted}\r\nSec-WebSocket-Protocol: ${asked.headers['sec-websocket-protocol'] ?? ''}\r\n\r\n`,
    );
    return new MessageSocket(stream, false);
  }

  sendText(text: string): void {
    this.send(TEXT, Buffer.from(text));
  }

  sendBinary(bytes: Buffer): void {
    this.send(BINARY, bytes);
  }

  close(): void {
    this.stream.destroy();
  }

  private send(opcode: number, payload: Buffer): void {
    const long = payload.length > 0xffff;
    const extra = long ? 8 : payload.length > 125 ? 2 : 0;
    const head = Buffer.alloc(2 + extra);
    head[0] = FINAL | opcode;
    head[1] = (this.masks ? 0x80 : 0) | (long ? 127 : extra > 0 ? 126 : payload.length);
    if (long) head.writeBigUInt64BE(BigInt(payload.length), 2);
    else if (extra > 0) head.writeUInt16BE(payload.length, 2);
    // A mask of zeros is allowed. Masks protect from attacks that tests do not have.
    this.stream.write(Buffer.concat([head, Buffer.alloc(this.masks ? 4 : 0), payload]));
  }

  private take(bytes: Buffer): void {
    this.received = Buffer.concat([this.received, bytes]);
    for (;;) {
      const used = this.frame(this.received);
      if (used === 0) return;
      this.received = this.received.subarray(used);
    }
  }

  /** Takes one frame from the front. Returns the frame's bytes, or 0 while the frame is incomplete. */
  private frame(bytes: Buffer): number {
    if (bytes.length < 2) return 0;
    const short = bytes[1] & 0x7f;
    const masked = (bytes[1] & 0x80) !== 0;
    let at = 2 + (short === 127 ? 8 : short === 126 ? 2 : 0);
    if (bytes.length < at + (masked ? 4 : 0)) return 0;
    const length = short === 127 ? Number(bytes.readBigUInt64BE(2)) : short === 126 ? bytes.readUInt16BE(2) : short;
    const mask = masked ? bytes.subarray(at, at + 4) : null;
    at += mask ? 4 : 0;
    if (bytes.length < at + length) return 0;
    const payload = Buffer.from(bytes.subarray(at, at + length));
    if (mask) for (let i = 0; i < length; i++) payload[i] ^= mask[i & 3];
    this.arrived(bytes[0] & 0x0f, (bytes[0] & FINAL) !== 0, payload);
    return at + length;
  }

  private arrived(opcode: number, final: boolean, payload: Buffer): void {
    if (opcode === PING) this.send(PONG, payload);
    if (opcode === CLOSE) this.stream.end();
    if (opcode >= CLOSE) return;
    if (opcode !== 0) this.opcode = opcode;
    this.parts.push(payload);
    if (!final) return;
    const whole = Buffer.concat(this.parts);
    this.parts = [];
    if (this.opcode === TEXT) this.onText(whole.toString());
    else this.onBinary(whole);
  }
}
