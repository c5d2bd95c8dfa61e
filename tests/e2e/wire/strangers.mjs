// SPDX-License-Identifier: GPL-3.0-or-later
// A program that opens COUNT connections to PORT from ADDRESS and says no hello on them. Each that ends is opened
// again. Sends a message once all were open. KIND says what each sends: `silent` nothing, `partial` the beginning of a
// request, `upgrade` a request for WebSocket, `chatty` such a request and then pings without end.
import { connect } from 'node:net';

const [port, address, count, kind] = process.argv.slice(2);
const upgrade = `GET /v1 HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n`
	+ 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n';

const PING = Buffer.from([0x89, 0x80, 0, 0, 0, 0]);
const FIRST = { silent: '', partial: upgrade.slice(0, 20), upgrade, chatty: upgrade };
const PING_MS = 100;
const open_now = new Set();
if (kind === 'chatty')
	setInterval(() => open_now.forEach((socket) => socket.write(PING)), PING_MS);

let opened = 0;
function open() {
	const socket = connect({ port: Number(port), host: '127.0.0.1', localAddress: address });
	socket.on('connect', () => {
		socket.write(FIRST[kind]);
		open_now.add(socket);
		if (++opened === Number(count))
			process.send('open');
	});
	socket.on('data', () => {});
	socket.on('end', () => socket.destroy());
	socket.on('error', () => {});
	socket.on('close', () => {
		open_now.delete(socket);
		open();
	});
}
for (let i = 0; i < Number(count); i++)
	open();
