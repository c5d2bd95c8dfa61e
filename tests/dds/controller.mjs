// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the controller program (environment variable CONTROLLER) and listens to it.
import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';

export class Controller {
	static alive = new Set();

	// For the end of a test, however it ended.
	static killAll() {
		return Promise.all([...Controller.alive].map((robot) => robot.kill()));
	}

	static async start({ domain, session, tool, via, deadline = 0 }) {
		const robot = new Controller();
		Controller.alive.add(robot);
		robot.waiters = [];
		robot.process = spawn(process.env.CONTROLLER,
			[domain, session, tool, via, Math.round(1000 * deadline)].map(String),
			{ stdio: ['pipe', 'pipe', 'inherit'], env: { ...process.env, CYCLONEDDS_URI: process.env.LOOPBACK } });
		robot.exited = new Promise((resolve) => robot.process.on('exit', resolve));
		robot.exited.then(() => Controller.alive.delete(robot));
		createInterface({ input: robot.process.stdout }).on('line', (line) => robot.onLine(JSON.parse(line)));
		await robot.event((e) => e.event === 'matched', 'matched');
		robot.firstDriver = (await robot.state()).driver;
		return robot;
	}

	onLine(event) {
		this.waiters = this.waiters.filter((w) => !(w.match(event) && (w.resolve(event), true)));
	}

	tell(line) {
		this.process.stdin.write(`${line}\n`);
	}

	event(match, what, seconds = 20) {
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`the controller never told: ${what}`)), seconds * 1000);
			this.waiters.push({ match, resolve: (event) => (clearTimeout(timer), resolve(event)) });
		});
	}

	ask(line, event, seconds) {
		const answer = this.event((e) => e.event === event, event, seconds);
		this.tell(line);
		return answer;
	}

	state() {
		return this.ask('state', 'state');
	}

	crtk() {
		return this.ask('crtk', 'crtk');
	}

	// The first word of the operating state that is so.
	async untilCrtk(condition, seconds = 20) {
		const end = Date.now() + seconds * 1000;
		for (let told; Date.now() < end;)
			if (condition(told = await this.crtk()))
				return told;
		throw new Error(`CRTK never told: ${condition}`);
	}

	// The first state, asked for again and again, that is so.
	async until(condition, seconds = 20) {
		const end = Date.now() + seconds * 1000;
		for (let state; Date.now() < end;)
			if (condition(state = await this.state()))
				return state;
		throw new Error(`no such state: ${condition}`);
	}

	end() {
		this.process.stdin.end();
		return this.exited;
	}

	kill() {
		this.process.kill('SIGKILL');
		return this.exited;
	}
}
