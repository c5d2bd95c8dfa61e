// SPDX-License-Identifier: GPL-3.0-or-later
// Takes the paper's pictures: viewer.py names cuts, their commands, and the ticks at which the viewer is to be
// looked at. A daemon steps each cut, command by command, so that it is the same cut however busy the machine is;
// a page of the real viewer follows it.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import type { Scene } from '../../clients/web/src/wire/messages.gen';
import { PROTOCOL } from '../browser/page/door';
import { MessageSocket } from '../browser/page/socket';
import { Stage } from '../browser/page/stage';
import { ViewerPage } from '../browser/page/viewer_page';

interface Cut {
  name: string;
  scene: Scene;
  /** as in the viewer's address */
  camera: string;
  commands: { command: string; tick: number; tool: string }[];
  /** at which pictures are taken, rising */
  ticks: number[];
}

interface Job {
  /** where name-1.png and so on go */
  folder: string;
  cuts: Cut[];
}

const VIEW = { width: 360, height: 270 }; // of a picture, px
const PAGE = { width: 820, height: 560 }; // no larger: software draws it
const SHARP = 6; // pictures after which one that smoke keeps moving is as sharp as it gets
const ALIVE_MS = 50; // between signs of life, without which energy goes off
const MANY = '100000'; // requests a minute: a cut is a thousand steps

interface Answer {
  id?: number; // none: nobody asked
  result?: unknown;
  error?: { message: string };
}

/** A client that asks and awaits. */
class Client {
  private last = 0;
  private readonly waiting = new Map<number, (message: Answer) => void>();

  private constructor(private readonly socket: MessageSocket) {
    socket.onText = (text) => {
      const message = JSON.parse(text) as Answer;
      if (message.id !== undefined) this.waiting.get(message.id)?.(message);
    };
  }

  static async connect(url: string): Promise<Client> {
    const client = new Client(await MessageSocket.connect(new URL('v1', url), PROTOCOL));
    await client.call('hello', { version: 1, client: 'pictures of the paper' });
    return client;
  }

  call(method: string, params: object): Promise<unknown> {
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, ({ result, error }) => (error ? reject(new Error(`${method}: ${error.message}`)) : resolve(result)));
      this.socket.sendText(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    });
  }

  close(): void {
    this.socket.close();
  }
}

/** The tissue alone: what lies over the picture is told by the page's other tests. */
async function takePicture(viewer: ViewerPage, tick: number, path: string): Promise<void> {
  await viewer.until((wanted) => window.cautery.tick >= wanted, tick, `tick ${tick} is on the page`);
  await viewer.drawn();
  const { picturesDrawn } = await viewer.state();
  await viewer.until(([count, sharp]) => window.cautery.idle || window.cautery.picturesDrawn > count + sharp, [picturesDrawn, SHARP] as const, 'the sharp picture');
  await viewer.page.evaluate(() => {
    for (const over of document.querySelectorAll<HTMLElement>('main > :not(canvas)')) over.style.visibility = 'hidden';
  });
  const box = (await viewer.page.locator('#picture').boundingBox())!;
  const corner = { x: box.x + (box.width - VIEW.width) / 2, y: box.y + (box.height - VIEW.height) / 2 };
  await viewer.page.screenshot({ path, clip: { ...corner, ...VIEW } });
}

const { folder, cuts } = JSON.parse(readFileSync(process.env['CAUTERY_PAPER_JOB']!, 'utf8')) as Job;

describe('the paper’s cuts', () => {
  const stage = new Stage(['--quota-connection', MANY, '--quota-address', MANY, '--quota-admin', MANY, '--quota-all', MANY]);

  it.each(cuts)('$name', async ({ name, scene, camera, commands, ticks }) => {
    const client = await Client.connect(stage.daemon.url);
    const alive = setInterval(() => void client.call('heartbeat', { visible: true }), ALIVE_MS);
    const made = (await client.call('session.create', { name, definition: scene, paused: true })) as { summary: { session: string } };
    const { session } = made.summary;
    await client.call('tool.take_over', { session, tool: commands[0].tool });
    const viewer = await ViewerPage.openFirst(stage.browser, `${stage.daemon.url}?session=${session}&camera=${camera}`, { viewport: PAGE });
    await viewer.until((wanted) => window.cautery.session === wanted, session, 'the session is on the page');
    let now = 0;
    const stepTo = async (tick: number): Promise<void> => {
      if (tick > now) await client.call('session.step', { session, ticks: tick - now });
      now = Math.max(now, tick);
    };
    let next = 0;
    for (const [index, tick] of ticks.entries()) {
      for (; next < commands.length && commands[next].tick <= tick; next++) {
        const { command, tick: due, ...params } = commands[next];
        await stepTo(due);
        await client.call(command, { ...params, session, sequence: next + 1, tick: 0 });
      }
      await stepTo(tick);
      await takePicture(viewer, tick, join(folder, `${name}-${index + 1}.png`));
    }
    clearInterval(alive);
    await viewer.close();
    client.close();
  });
});
