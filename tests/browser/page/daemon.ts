// SPDX-License-Identifier: GPL-3.0-or-later
// A real cauteryd with a store of its own. It serves the built viewer.
import { spawn, type ChildProcess } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../../..', import.meta.url));

export class Daemon {
  private child: ChildProcess | null = null;
  private readonly folder = mkdtempSync(join(tmpdir(), 'cautery-viewer-'));
  readonly log: string[] = [];
  port = 0;

  constructor(private readonly settings: readonly string[]) {}

  get url(): string {
    return `http://127.0.0.1:${this.port}/`;
  }

  /** Starts the daemon, or restarts it on the same port and store. Resolves when the daemon listens. */
  async start(): Promise<void> {
    const program = process.env['CAUTERYD'];
    if (program === undefined) throw new Error('CAUTERYD names no daemon');
    const child = spawn(program, [
      '--port', String(this.port),
      '--store', join(this.folder, 'cautery.db'),
      '--scenes', join(root, 'deploy/scenes'),
      '--viewer', join(root, 'clients/web/dist'),
      // Software drawing beside other tests may stop a page for longer than the usual deadline of a driver.
      '--browser-deadline-s', '5',
      ...this.settings,
    ], { env: { PATH: process.env['PATH'] } }); // otherwise each CAUTERY_* variable would be a setting
    this.child = child;
    await new Promise<void>((resolve, reject) => {
      createInterface({ input: child.stderr }).on('line', (line) => {
        this.log.push(line);
        const port = /event=listening .*port=(\d+)/.exec(line)?.[1];
        if (port === undefined) return;
        this.port = Number(port);
        resolve();
      });
      child.once('exit', (code) => reject(new Error(`cauteryd ended with ${code}:\n${this.log.join('\n')}`)));
      child.once('error', reject);
    });
  }

  /** Kills the daemon, as a loss of power would. */
  async kill(): Promise<void> {
    const { child } = this;
    this.child = null;
    if (!child || child.exitCode !== null) return;
    const gone = once(child, 'exit');
    child.kill('SIGKILL');
    await gone;
  }

  async end(): Promise<void> {
    await this.kill();
    rmSync(this.folder, { recursive: true, force: true });
  }
}
