// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the controller program (environment variable CONTROLLER) and listens to it.
import { CYCLONE } from './domain.mjs';
import { Program } from './program.mjs';

export class Controller extends Program {
	static alive = new Set();

	// Kills all controllers at the end of a test, however the test ended.
	static killAll() {
		return Promise.all([...Controller.alive].map((robot) => robot.kill()));
	}

	// Resolves once the controller has found the daemon.
	static async start({ domain, session, tool, via, deadline = 0 }) {
		const robot = new Controller(process.env.CONTROLLER,
			[domain, session, tool, via, Math.round(1000 * deadline)], { environment: CYCLONE });
		Controller.alive.add(robot);
		robot.exited.then(() => Controller.alive.delete(robot));
		await robot.event((e) => e.event === 'matched', 'matched');
		robot.firstDriver = (await robot.state()).driver;
		return robot;
	}

	state() {
		return this.ask('state');
	}

	crtk() {
		return this.ask('crtk');
	}

	// Returns the first operating state that meets the condition.
	untilCrtk(condition) {
		return this.until(condition, 'crtk');
	}
}
