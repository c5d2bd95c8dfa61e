// SPDX-License-Identifier: GPL-3.0-or-later
// A session that a test watches with a browser's client.
import { smallSession } from './wire/scene.mjs';

// Makes a session, an admin's client in it and its stream for one test. After the test, `first` is called, and the
// session is destroyed.
export async function watchSession(t, daemon, name, { options, first = () => {} } = {}) {
	const client = await daemon.connect({ hello: { client: 'admin' } });
	const session = await smallSession(client, name, options);
	t.after(async () => {
		await first();
		if (client.closeCode === undefined) // the daemon may have ended
			await client.call('session.destroy', { session }).catch(() => {}); // the test may have destroyed the session
		await client.close();
	});
	return { client, session, stream: await client.join(session) };
}

export const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
