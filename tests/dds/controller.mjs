// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the controller program (environment variable CONTROLLER) and listens to it.
import { CYCLONE } from './domain.mjs';
import { Program } from './program.mjs';

export class Controller extends Program {
	static alive = new Set();

	// For the end of a test, however it ended.
	static killAll() {
		return Promise.all([...Controller.alive].map((robot) => robot.kill()));
	}

	// Resolves once it has found the daemon.
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

	// The first word of the operating state that is so.
	untilCrtk(condition) {
		return this.until(condition, 'crtk');
	}
}
