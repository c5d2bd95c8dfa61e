# SPDX-License-Identifier: Apache-2.0
"""A connection to a daemon, with requests, streams and files."""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import os
import ssl
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator, Mapping, Sequence

from .errors import BadFrame, ConnectionClosed, Error, NoAnswer, RequestError
from .messages import EXPENSIVE_METHODS, SUBPROTOCOL, WIRE_VERSION, Calls, HelloResult, UploadResult
from .stream import Stream, session_number
from .websocket import WebSocket

_ACK_S = 0.1
_KEY_FRAME_S = 1.0  # between requests for key frames; the daemon sends them at most this often
_HEARTBEAT_S = 0.05  # five heartbeats in the silence after which the daemon turns energy off
_ALIVE = {"visible": True}
_CHUNK_HEAD = 16
_NOTICES_MOST = 1000
# Methods that may take long. The answer to session.join comes when the session is built.
_LONG = EXPENSIVE_METHODS | {"session.join"}
# Methods whose result announces a file in chunks.
_FILES = frozenset({"session.export", "session.log", "session.frame_at", "move.read"})


@dataclass
class _Pending:
    """A request that has no answer yet."""

    method: str
    done: threading.Event = field(default_factory=threading.Event)
    result: Any = None
    error: Exception | None = None


@dataclass
class _Download:
    announced: Mapping[str, Any]
    bytes: bytearray = field(default_factory=bytearray)
    done: threading.Event = field(default_factory=threading.Event)


class Client(Calls):
    """A connection to one daemon, with a function for each request (`session_create`, `tool_move`, ...).

        with Client("ws://127.0.0.1:8740") as client:
            made = client.session_create(name="lesson", scene="fascia", paused=True)

    `token` is the access token, if the daemon needs one. `role` may be lower than the role of the token. `timeout_s`
    limits connecting and each answer. Requests that may take long (building, rewinding, files, joining) wait longer, as
    long as the daemon answers heartbeats. `tls` is for wss (default: the system's authorities). All functions
    may be called from any thread. A thread of the client receives messages. It calls `on_notice` with the method and
    params of each notification; `on_notice` must not wait. A client does not reconnect: after the connection is lost,
    every function raises ConnectionClosed.
    """

    def __init__(self, url: str = "ws://127.0.0.1:8740", *, token: str | None = None, role: str | None = None,
                 name: str = "cautery for Python", timeout_s: float = 30.0, tls: ssl.SSLContext | None = None,
                 on_notice: Callable[[str, Mapping[str, Any]], None] | None = None) -> None:
        self.timeout_s = timeout_s
        self.notices: deque[tuple[str, Mapping[str, Any]]] = deque(maxlen=_NOTICES_MOST)  # the newest
        self._on_notice = on_notice
        self._ids = itertools.count(1)
        self._lock = threading.Lock()
        self._pending: dict[int, _Pending] = {}
        self._streams: dict[int, Stream] = {}
        self._downloads: dict[int, _Download] = {}
        self._acknowledged_s = self._asked_s = 0.0
        self._over: Exception | None = None
        self._socket = WebSocket(url, SUBPROTOCOL, timeout_s, tls)
        self._thread = threading.Thread(target=self._receive, name="cautery", daemon=True)
        self._thread.start()
        try:
            self.server: HelloResult = self.call(
                "hello", {"version": WIRE_VERSION, "client": name, "token": token, "role": role})
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection. Energy of the tools that this client drives goes off."""
        self._socket.close()
        if threading.current_thread() is not self._thread:
            self._thread.join(self.timeout_s)
        self._socket.abandon()

    # ---- requests
    def call(self, method: str, params: Mapping[str, Any] | None = None) -> Any:
        """Sends a request and waits for its result. Raises RequestError if the daemon refuses the request."""
        return self._wait_for(self._send_request(method, params or {}))

    def notify(self, method: str, params: Mapping[str, Any] | None = None) -> None:
        """Sends a notification, which is never answered: `tool.move`, `heartbeat`, `stream.ack`."""
        self._send({"method": method, "params": _without_none(params or {})})

    # ---- streams
    def join(self, session: str, *, rate_hz: float | None = None, channels: Sequence[str] | None = None,
             step_m: float | None = None, plain: bool | None = None) -> Stream:
        """Joins a session. Returns the stream after its first frame: faces, rest and a state are known."""
        description = self.call("session.join", {"session": session, "rate_hz": rate_hz, "channels": channels,
                                                 "step_m": step_m, "plain": plain})
        stream = self._streams[description["session_number"]]
        stream.wait(timeout_s=self.timeout_s)
        return stream

    @contextlib.contextmanager
    def heartbeats(self) -> Iterator[None]:
        """Sends heartbeats to the daemon every 50 ms while the block runs.

        Without it energy goes off once a driver has been silent for `server["limits"]["heartbeat_s"]`. With it energy
        stays on while this program computes, and also while it hangs. Use it only for
        simulated tissue, where a tool whose energy stays on can do no harm.
        """
        over = threading.Event()

        def beat() -> None:
            with contextlib.suppress(ConnectionClosed):
                self.notify("heartbeat", _ALIVE)
                while not over.wait(_HEARTBEAT_S):
                    self.notify("heartbeat", _ALIVE)

        thread = threading.Thread(target=beat, name="cautery heartbeats", daemon=True)
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()

    # ---- files
    def upload(self, name: str, file: str | os.PathLike[str], data: bytes | None = None) -> UploadResult:
        """Uploads a mesh file under a name. With `data`, these bytes are sent and `file` only gives the file name."""
        if data is None:
            with open(file, "rb") as opened:
                data = opened.read()
        begun = self.upload_begin(name=name, file_name=os.path.basename(file), byte_count=len(data))
        most = min(begun["chunk_bytes_max"], 1 << 18)
        for offset in range(0, len(data), most):
            head = b"CAUC" + begun["transfer"].to_bytes(4, "little") + offset.to_bytes(8, "little")
            self._socket.send_binary(head + data[offset:offset + most])
        return self.upload_end(transfer=begun["transfer"], sha256=hashlib.sha256(data).hexdigest())

    def download(self, method: str, params: Mapping[str, Any]) -> bytes:
        """Calls `session.export`, `session.log`, `session.frame_at` or `move.read`. Returns the file that follows."""
        if method not in _FILES:
            raise ValueError(f"{method} does not send a file")
        announced = self.call(method, params)
        with self._lock:
            download = self._downloads[announced["transfer"]]
        if not download.done.wait(self.timeout_s):
            raise NoAnswer(f"{method}: the file did not arrive within {self.timeout_s:g} s")
        with self._lock:
            del self._downloads[announced["transfer"]]
        if self._over:
            raise self._over
        if hashlib.sha256(download.bytes).hexdigest() != announced["sha256"]:
            raise Error(f"{method}: the received file does not have the announced hash")
        return bytes(download.bytes)

    # ---- sending
    def _send(self, message: dict[str, Any]) -> None:
        if self._over:
            raise self._over
        self._socket.send_text(json.dumps({"jsonrpc": "2.0", **message}, allow_nan=False))

    def _send_request(self, method: str, params: Mapping[str, Any]) -> _Pending:
        pending, number = _Pending(method), next(self._ids)
        with self._lock:
            self._pending[number] = pending
        try:
            self._send({"id": number, "method": method, "params": _without_none(params)})
        except BaseException:
            with self._lock:
                self._pending.pop(number, None)
            raise
        return pending

    def _is_heard(self) -> bool:
        return self._send_request("heartbeat", _ALIVE).done.wait(self.timeout_s)

    def _wait_for(self, pending: _Pending) -> Any:
        while not pending.done.wait(self.timeout_s):
            if pending.method in _LONG and self._is_heard():
                continue
            raise NoAnswer(f"{pending.method}: no answer within {self.timeout_s:g} s")
        if pending.error:
            raise pending.error
        return pending.result

    # ---- the thread that receives
    def _receive(self) -> None:
        try:
            while True:
                message = self._socket.receive()
                if isinstance(message, str):
                    self._take_text(json.loads(message))
                else:
                    self._take_binary(message)
        except Exception as error:  # pylint: disable=broad-except
            self._end(error)
            self._socket.close(1000 if isinstance(error, ConnectionClosed) else 1002)

    def _end(self, error: Exception) -> None:
        self._over = error
        with self._lock:
            pending, self._pending = list(self._pending.values()), {}
            downloads = list(self._downloads.values())
        for one in pending:
            one.error = error
            one.done.set()
        for download in downloads:
            download.done.set()
        for stream in self._streams.values():
            stream.end(error)

    def _take_text(self, message: Mapping[str, Any]) -> None:
        if "method" in message:
            self.notices.append((message["method"], message.get("params", {})))
            if self._on_notice:
                self._on_notice(message["method"], message.get("params", {}))
            return
        with self._lock:
            pending = self._pending.pop(message.get("id"), None)  # type: ignore[arg-type]
        if pending is None:
            return
        if "error" in message:
            pending.error = RequestError(pending.method, message["error"])
        else:
            pending.result = message["result"]
            self._prepare(pending.method, message["result"])
        pending.done.set()

    def _prepare(self, method: str, result: Any) -> None:
        """Prepares for the frames or chunks that follow this answer."""
        if method == "session.join":
            self._streams[result["session_number"]] = Stream(result)
        elif method in _FILES:
            download = _Download(result)
            with self._lock:
                self._downloads[result["transfer"]] = download
            if result["byte_count"] == 0:
                download.done.set()

    def _take_binary(self, message: bytes) -> None:
        if message[:4] == b"CAUC":
            self._take_chunk(message)
            return
        stream = self._streams.get(session_number(message))
        if stream is None:
            return
        try:
            kind = stream.take(message)
        except BadFrame as error:
            raise BadFrame(f"a frame of {stream.description['session']} could not be read: {error}") from error
        self._follow(stream, kind)

    def _take_chunk(self, message: bytes) -> None:
        with self._lock:
            download = self._downloads.get(int.from_bytes(message[4:8], "little"))
        if download is None:
            return
        if int.from_bytes(message[8:16], "little") != len(download.bytes):
            raise Error("a chunk of a file came out of order")
        download.bytes += message[_CHUNK_HEAD:]
        if len(download.bytes) >= download.announced["byte_count"]:
            download.done.set()

    def _follow(self, stream: Stream, kind: str) -> None:
        """Acknowledges frames. Asks for a key frame if the stream missed a delta."""
        now_s, session = time.monotonic(), stream.description["session"]
        place = stream.place()
        if kind == "skipped" and now_s - self._asked_s >= _KEY_FRAME_S:
            self._asked_s = now_s
            self._send_request("stream.key_frame", {"session": session})
        elif place and kind != "topology" and now_s - self._acknowledged_s >= _ACK_S:
            self._acknowledged_s = now_s
            self.notify("stream.ack", {"session": session, "epoch": place[0], "sequence": place[1]})


def _without_none(params: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in params.items() if value is not None}
