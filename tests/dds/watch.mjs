// SPDX-License-Identifier: GPL-3.0-or-later
// A session that a test watches from a browser's side.
import { smallSession } from './wire/scene.mjs';

// A session of its own for the test, an admin's client in it, and its stream. After the test `first` is
// done, and the session is gone.
export async function watchSession(t, daemon, name, { options, first = () => {} } = {}) {
	const client = await daemon.connect({ hello: { client: 'admin' } });
	const session = await smallSession(client, name, options);
	t.after(async () => {
		await first();
		if (client.closeCode === undefined) // its daemon may have ended
			await client.call('session.destroy', { session }).catch(() => {}); // a test may have done it
		await client.close();
	});
	return { client, session, stream: await client.join(session) };
}

export const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
