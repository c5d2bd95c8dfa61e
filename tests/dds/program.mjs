// SPDX-License-Identifier: GPL-3.0-or-later
// A program that gets lines on its standard input and writes JSON objects, one a line. Other output, such as the log of
// Fast DDS, is passed on.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';
import { PATIENCE_S } from './wire/client.mjs';

export class Program {
	// `environment` is added to the environment of this process; `wrap` are words before the command.
	constructor(command, words, { environment = {}, wrap = [] } = {}) {
		const [file, ...rest] = [...wrap, command, ...words.map(String)];
		this.waiters = [];
		this.process = spawn(file, rest,
			{ stdio: ['pipe', 'pipe', 'inherit'], env: { ...process.env, ...environment } });
		this.process.stdin.on('error', () => {}); // the program has ended; a wait for it will report this
		this.exited = new Promise((resolve) => this.process.on('exit', (code, signal) => {
			this.waiters.forEach((w) => w.reject(new Error(`it ended (${code ?? signal}) before: ${w.what}`)));
			resolve({ code, signal });
		}));
		createInterface({ input: this.process.stdout }).on('line', (line) =>
			line.startsWith('{') ? this.onLine(JSON.parse(line)) : console.error(line));
	}

	onLine(event) {
		this.waiters = this.waiters.filter((w) => !(w.match(event) && (w.resolve(event), true)));
	}

	tell(line) {
		this.process.stdin.write(`${line}\n`);
	}

	event(match, what, seconds = PATIENCE_S) {
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`it never told: ${what}`)), seconds * 1000);
			const settle = (how) => (value) => (clearTimeout(timer), how(value));
			this.waiters.push({ match, what, resolve: settle(resolve), reject: settle(reject) });
		});
	}

	ask(line, event = line, seconds = PATIENCE_S) {
		const answer = this.event((e) => e.event === event, event, seconds);
		this.tell(line);
		return answer;
	}

	// Sends `line` again and again. Returns the first answer that meets the condition.
	async until(condition, line = 'state', seconds = PATIENCE_S) {
		const end = Date.now() + seconds * 1000;
		let answer;
		while (Date.now() < end)
			if (condition(answer = await this.ask(line)))
				return answer;
		throw new Error(`never: ${condition}; at last ${JSON.stringify(answer)}`);
	}

	end() {
		this.process.stdin.end();
		return this.exited;
	}

	kill(signal = 'SIGKILL') {
		this.process.kill(signal);
		return this.exited;
	}
}
