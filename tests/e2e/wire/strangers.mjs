// SPDX-License-Identifier: GPL-3.0-or-later
// A program that opens COUNT connections to PORT from ADDRESS and says no hello on them. Each that ends is opened
// again. KIND is `upgrade` for WebSocket, `silent` for sockets that send nothing. Sends a message once all were open.
import { connect } from 'node:net';

const [port, address, count, kind] = process.argv.slice(2);
const upgrade = `GET /v1 HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n`
	+ 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: cautery.v1\r\n\r\n';

let opened = 0;
function open() {
	const socket = connect({ port: Number(port), host: '127.0.0.1', localAddress: address });
	socket.on('connect', () => {
		if (kind === 'upgrade')
			socket.write(upgrade);
		if (++opened === Number(count))
			process.send('open');
	});
	socket.on('data', () => {});
	socket.on('end', () => socket.destroy());
	socket.on('error', () => {});
	socket.on('close', open);
}
for (let i = 0; i < Number(count); i++)
	open();
