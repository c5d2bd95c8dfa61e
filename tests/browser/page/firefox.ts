// SPDX-License-Identifier: GPL-3.0-or-later
// Drives Debian's Firefox without a window, by WebDriver BiDi. It has only what the tests of holds need.
import { spawn, type ChildProcess } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

export const FIREFOX = '/usr/bin/firefox-esr';
/** Firefox shows no first run and loads nothing of its own from the network. Elements get the focus although no
 * window has it. */
const PREFERENCES: Readonly<Record<string, boolean | number | string>> = {
  'app.update.disabledForTesting': true,
  'browser.shell.checkDefaultBrowser': false,
  'browser.startup.homepage_override.mstone': 'ignore',
  'browser.startup.page': 0,
  'datareporting.policy.dataSubmissionEnabled': false,
  'dom.w3c_touch_events.enabled': 1,
  'extensions.systemAddon.update.enabled': false,
  'focusmanager.testmode': true,
  'network.captive-portal-service.enabled': false,
  'network.connectivity-service.enabled': false,
  'services.settings.server': '',
  'toolkit.telemetry.reportingpolicy.firstRun': false,
};

interface Answer {
  id?: number;
  type: string;
  result?: unknown;
  error?: string;
  message?: string;
}

export class Firefox {
  private readonly profile = mkdtempSync(join(tmpdir(), 'cautery-firefox-'));
  private readonly waiting = new Map<number, (answer: Answer) => void>();
  private last = 0;
  private context = '';
  private child!: ChildProcess;
  private socket!: WebSocket;

  async start(width: number, height: number): Promise<void> {
    const lines = Object.entries(PREFERENCES).map(([name, value]) => `user_pref(${JSON.stringify(name)}, ${JSON.stringify(value)});\n`);
    writeFileSync(join(this.profile, 'user.js'), lines.join(''));
    this.child = spawn(FIREFOX, ['--headless', '--no-remote', '--profile', this.profile, '--remote-debugging-port', '0', 'about:blank'], {
      env: { PATH: process.env['PATH'], HOME: this.profile },
    });
    const url = await new Promise<string>((resolve, reject) => {
      createInterface({ input: this.child.stderr! }).on('line', (line) => {
        const found = /WebDriver BiDi listening on (ws:\S+)/.exec(line)?.[1];
        if (found !== undefined) resolve(found);
      });
      this.child.once('exit', (code) => reject(new Error(`Firefox ended with ${code}`)));
    });
    this.socket = new WebSocket(`${url}/session`);
    this.socket.onmessage = ({ data }) => this.take(JSON.parse(String(data)) as Answer);
    await once(this.socket, 'open');
    await this.call('session.new', { capabilities: {} });
    const { contexts } = (await this.call('browsingContext.getTree', {})) as { contexts: { context: string }[] };
    this.context = contexts[0].context;
    await this.call('browsingContext.activate', { context: this.context });
    await this.call('browsingContext.setViewport', { context: this.context, viewport: { width, height } });
  }

  /** Runs a function in each page before its scripts. */
  async prepare(work: () => void): Promise<void> {
    await this.call('script.addPreloadScript', { functionDeclaration: String(work) });
  }

  async open(url: string): Promise<void> {
    await this.call('browsingContext.navigate', { context: this.context, url, wait: 'interactive' });
  }

  async evaluate<A, R>(work: (argument: A) => R, argument: A): Promise<R> {
    const functionDeclaration = `async (text) => JSON.stringify((await (${String(work)})(JSON.parse(text))) ?? null)`;
    const { type, result, exceptionDetails } = (await this.call('script.callFunction', {
      functionDeclaration, target: { context: this.context }, awaitPromise: true,
      arguments: [{ type: 'string', value: JSON.stringify(argument) }],
    })) as { type: string; result: { value: string }; exceptionDetails?: { text: string } };
    if (type === 'exception') throw new Error(exceptionDetails?.text ?? 'an exception in the page');
    return JSON.parse(result.value) as R;
  }

  async perform(...actions: object[]): Promise<void> {
    await this.call('input.performActions', { context: this.context, actions });
  }

  async end(): Promise<void> {
    const gone = once(this.child, 'exit');
    this.child.kill('SIGKILL');
    await gone;
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }

  private call(method: string, params: object): Promise<unknown> {
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, ({ type, result, error, message }) => {
        if (type === 'success') resolve(result);
        else reject(new Error(`${method}: ${error}: ${message}`));
      });
      this.socket.send(JSON.stringify({ id, method, params }));
    });
  }

  private take(answer: Answer): void {
    const waits = this.waiting.get(answer.id ?? -1);
    this.waiting.delete(answer.id ?? -1);
    waits?.(answer);
  }
}
