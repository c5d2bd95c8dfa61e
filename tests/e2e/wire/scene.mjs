// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene for tests: the fascia with fewer cells, its hook low enough to touch.
export async function smallScene(client, cells = [24, 20]) {
	const { definition } = await client.call('scene.get', { scene: 'fascia' });
	definition.meshes[0].cells.splice(0, 2, ...cells);
	definition.name = 'small';
	delete definition.cut;
	Object.assign(definition.layers[0], { ignition_c: 80, absorption_per_s: 20 }); // parts at once
	return definition;
}

export async function smallSession(client, name, options = {}) {
	const definition = await smallScene(client, options.cells);
	delete options.cells;
	const made = await client.call('session.create', { name, definition, ...options });
	return made.summary.session;
}

export const AT_REST = [1, 0, 0, 0];

// Drives the hook into the middle of the sheet with energy on, as fast as the session steps.
export async function cutMiddle(client, session, ticks = 120) {
	await client.call('tool.take_over', { session, tool: 'hook' });
	await client.call('tool.move', { session, tool: 'hook', position_m: [-0.02, 0, 0.001], rotation: AT_REST });
	await client.call('session.step', { session, ticks: 30 });
	await client.call('tool.energize', { session, tool: 'hook', energized: true });
	await client.call('tool.move', { session, tool: 'hook', position_m: [0.02, 0, 0.001], rotation: AT_REST });
	return client.call('session.step', { session, ticks });
}

// What a picture is made of: the mask, and the positions of vertices that a drawn face uses. Others are sent no more, so
// that where they were last depends on the ticks that came to a frame of their own.
export function picture(state, faces = state.faces) {
	const drawn = new Map();
	for (let face = 0; face < faces.length / 3; face++)
		if (!(state.mask[face >> 5] >>> (face & 31) & 1))
			for (const v of [0, 1, 2].map((corner) => faces[3 * face + corner]))
				drawn.set(v, [...state.quantised.slice(3 * v, 3 * v + 3)]);
	return { mask: [...state.mask], drawn };
}
