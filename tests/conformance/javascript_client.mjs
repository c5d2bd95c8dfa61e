// SPDX-License-Identifier: GPL-3.0-or-later
// The adapter of the JavaScript package `cautery` (README.md).
import { createHash } from 'node:crypto';
import { createInterface } from 'node:readline';
import { Client, FrameDecoder, RpcError, SCALARS, WireError, decoderReady } from 'cautery';

const CODES = { not_here: -32040, bad_value: -32602, method_not_found: -32601 }; // the package has the words alone
let client, description, held; // held(): the state

function stateOf(state, of) {
  const numbers = Array.from(state.quantised, (q, i) => of.origin_m[i % 3] + of.step_m * q);
  const removed = Array.from({ length: of.face_count }, (_, face) => face).filter((face) => (state.mask[face >>> 5] >>> (face & 31)) & 1);
  const scalars = Object.entries(SCALARS).filter(([name]) => of.channels.includes(name));
  return {
    epoch: state.epoch.toString(16).padStart(16, '0'), sequence: state.sequence, tick: state.tick, positions_m: numbers, removed,
    tools: state.tools.map(({ name, sequence, energized, positionM }) => ({ name, sequence, energized, position_m: [...positionM] })),
    ...Object.fromEntries(scalars.map(([name, { least, step }]) =>
      [name, Array.from(state[name], (n) => least + (step || of.stress_step_pa) * n)])),
  };
}

const call = ({ method, params }) => client.call(method, params).then(
  (result) => ({ result }),
  (error) => {
    if (!(error instanceof RpcError)) throw error;
    return { error: { code: CODES[error.status] ?? error.status, path: error.path } };
  });

let decoder, stream;
const commands = {
  decode({ description: of }) {
    [description, decoder] = [of, new FrameDecoder(of)];
    held = () => stateOf(decoder.state, description);
    return {};
  },
  frame({ bytes }) {
    try {
      return { took: decoder.decode(new Uint8Array(Buffer.from(bytes, 'base64'))).kind === 'applied' ? 'yes' : 'no' };
    } catch (error) {
      if (!(error instanceof WireError)) throw error;
      return { took: 'bad' };
    }
  },
  state: () => held(),
  async connect({ url }) {
    client = await Client.connect(url);
    return {};
  },
  call,
  together: async ({ calls }) => ({ answers: await Promise.all(calls.map(call)) }),
  async join({ params: { session, ...options } }) {
    stream = await client.join(session, options);
    held = () => stateOf(stream.state, stream.description);
    return { description: stream.description };
  },
  async settle({ tick }) {
    await stream.until(({ state }) => state.tick >= tick);
    return held();
  },
  async file({ method, params }) {
    const { bytes } = await client.download(method, params);
    return { sha256: createHash('sha256').update(bytes).digest('hex') };
  },
};

await decoderReady;
console.log(JSON.stringify({ lacks: [] }));
for await (const line of createInterface({ input: process.stdin })) {
  const { do: what, ...more } = JSON.parse(line);
  const answer = await Promise.resolve().then(() => commands[what](more)).catch((error) => ({ failed: String(error) }));
  console.log(JSON.stringify(answer));
}
client?.close();
