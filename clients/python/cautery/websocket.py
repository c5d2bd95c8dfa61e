# SPDX-License-Identifier: Apache-2.0
"""The part of WebSocket (RFC 6455) that the protocol uses, over a socket of the standard library.

No extensions. One thread may receive while others send.
"""

from __future__ import annotations

import base64
import hashlib
import os
import socket
import ssl
import struct
import threading
from urllib.parse import urlsplit

from .errors import ConnectionClosed, ConnectionRefused

_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_CONTINUATION, _TEXT, _BINARY, _CLOSE, _PING, _PONG = 0, 1, 2, 8, 9, 10
_RESPONSE_BYTES_MOST = 65536
_CLOSE_S = 2.0  # time that a closing connection waits for the close frame of the peer


def _masked(payload: bytes, mask: bytes) -> bytes:
    """Returns `payload` XOR the repeated mask."""
    count = len(payload)
    key = int.from_bytes((mask * (count // 4 + 1))[:count], "little")
    return (int.from_bytes(payload, "little") ^ key).to_bytes(count, "little")


class WebSocket:
    """A WebSocket connection. Its functions raise exceptions of `errors`.

    `url` begins with ws:// or wss://. `timeout_s` limits connecting. `tls` is for wss (default: the
    system's authorities).
    """

    def __init__(self, url: str, subprotocol: str, timeout_s: float, tls: ssl.SSLContext | None = None) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("ws", "wss") or not parts.hostname:
            raise ValueError(f"{url!r} is not an address such as ws://127.0.0.1:8740")
        secured = parts.scheme == "wss"
        port = parts.port or (443 if secured else 80)
        self._socket = socket.create_connection((parts.hostname, port), timeout=timeout_s)
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if secured:
                context = tls or ssl.create_default_context()
                self._socket = context.wrap_socket(self._socket, server_hostname=parts.hostname)
            self._held = b""  # received, not yet used
            path = (parts.path if parts.path not in ("", "/") else "/v1") + (f"?{parts.query}" if parts.query else "")
            self._shake_hands(path, parts.netloc.rpartition("@")[2], subprotocol)
            self._socket.settimeout(None)
        except BaseException:
            self._socket.close()
            raise
        self._sending = threading.Lock()
        self._closing = False

    # ---- sending
    def send_text(self, text: str) -> None:
        self._send(_TEXT, text.encode())

    def send_binary(self, payload: bytes) -> None:
        self._send(_BINARY, payload)

    def _send(self, opcode: int, payload: bytes) -> None:
        count, mask = len(payload), os.urandom(4)
        if count < 126:
            head = struct.pack("!BB", 0x80 | opcode, 0x80 | count)
        elif count < 65536:
            head = struct.pack("!BBH", 0x80 | opcode, 0x80 | 126, count)
        else:
            head = struct.pack("!BBQ", 0x80 | opcode, 0x80 | 127, count)
        try:
            with self._sending:
                self._socket.sendall(head + mask + _masked(payload, mask))
        except OSError as error:
            raise ConnectionClosed(1006, str(error)) from error

    # ---- receiving
    def receive(self) -> str | bytes:
        """Returns the next message, text or bytes. Answers pings. Raises ConnectionClosed at the end."""
        parts: list[bytes] = []
        first = _CONTINUATION
        while True:
            final, opcode, payload = self._receive_frame()
            if opcode == _PING:
                self._send(_PONG, payload)
            elif opcode == _CLOSE:
                self._end(payload)
            elif opcode in (_TEXT, _BINARY, _CONTINUATION):
                first = opcode or first
                parts.append(payload)
                if final:
                    whole = b"".join(parts)
                    return whole.decode() if first == _TEXT else whole

    def close(self, code: int = 1000) -> None:
        """Ends the connection; `receive` raises ConnectionClosed. A second call does nothing."""
        if self._closing:
            return
        self._closing = True
        try:
            self._send(_CLOSE, struct.pack("!H", code))
            self._socket.settimeout(_CLOSE_S)
        except (ConnectionClosed, OSError):
            pass

    def abandon(self) -> None:
        """Frees the socket. The peer sees a lost connection unless it was closed before."""
        self._closing = True
        self._socket.close()

    def _end(self, payload: bytes) -> None:
        code = struct.unpack("!H", payload[:2])[0] if len(payload) >= 2 else 1005
        self.close(code if code != 1005 else 1000)
        self._socket.close()
        raise ConnectionClosed(code, payload[2:].decode(errors="replace"))

    def _receive_frame(self) -> tuple[bool, int, bytes]:
        one, two = self._read(2)
        count = two & 0x7F
        if count == 126:
            (count,) = struct.unpack("!H", self._read(2))
        elif count == 127:
            (count,) = struct.unpack("!Q", self._read(8))
        return bool(one & 0x80), one & 0x0F, self._read(count)

    def _read(self, count: int) -> bytes:
        parts, missing = [self._held[:count]], count - len(self._held)
        self._held = self._held[count:]
        while missing > 0:
            try:
                got = self._socket.recv(max(missing, 65536))
            except OSError as error:
                raise ConnectionClosed(1006, str(error)) from error
            if not got:
                raise ConnectionClosed(1006, "the connection was lost")
            parts.append(got[:missing])
            self._held = got[missing:]
            missing -= len(parts[-1])
        return b"".join(parts)

    # ---- the handshake
    def _shake_hands(self, path: str, host: str, subprotocol: str) -> None:
        key = base64.b64encode(os.urandom(16))
        self._socket.sendall(
            f"GET {path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key.decode()}\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Protocol: {subprotocol}\r\n\r\n".encode())
        status, headers = self._read_response()
        if status != 101:
            reason = headers.get("cautery-reason", "the server is not a cauteryd, or a proxy refuses WebSocket")
            raise ConnectionRefused(f"HTTP status {status}: {reason}")
        wanted = base64.b64encode(hashlib.sha1(key + _GUID).digest()).decode()
        if headers.get("sec-websocket-accept") != wanted or headers.get("sec-websocket-protocol") != subprotocol:
            raise ConnectionRefused("the server does not support this protocol")

    def _read_response(self) -> tuple[int, dict[str, str]]:
        held = b""
        while b"\r\n\r\n" not in held:
            got = self._socket.recv(4096)
            if not got or len(held) > _RESPONSE_BYTES_MOST:
                raise ConnectionRefused("the server does not answer with HTTP")
            held += got
        text, _, self._held = held.partition(b"\r\n\r\n")
        first, *lines = text.decode("latin-1").split("\r\n")
        words = first.split()
        if len(words) < 2 or not words[0].startswith("HTTP/1.") or not words[1].isdigit():
            raise ConnectionRefused("the server does not answer with HTTP")
        pairs = (line.partition(":") for line in lines)
        return int(words[1]), {name.strip().lower(): value.strip() for name, _, value in pairs}
