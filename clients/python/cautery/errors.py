# SPDX-License-Identifier: Apache-2.0
"""The exceptions of this package."""

from __future__ import annotations

from typing import Any, Mapping


class Error(Exception):
    """Any error of this package."""


class ConnectionRefused(Error):
    """The daemon, or a proxy in front of it, refuses the connection. The text gives the reason."""


class ConnectionClosed(Error):
    """The connection has ended. `code` is a key of `messages.CLOSE_REASONS`, or 1006 if the connection was lost."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"the connection was closed with {code}" + (f": {reason}" if reason else ""))
        self.code = code
        self.reason = reason


class RequestError(Error):
    """The daemon has refused a request.

    `method` is the method of the request. `code` is the error number of JSON-RPC. `status` is a key of
    `messages.ERROR_CODES`. `path` is the wrong member of the request, or "". `reason` is a sentence.
    """

    def __init__(self, method: str, error: Mapping[str, Any]) -> None:
        data = error.get("data") or {}
        self.method = method
        self.code = int(error.get("code", 0))
        self.status = str(data.get("status", ""))
        self.path = str(data.get("path", ""))
        self.reason = str(data.get("reason") or error.get("message", ""))
        place = f" ({self.path})" if self.path else ""
        super().__init__(f"{method}: {self.reason}{place}")


class NoAnswer(Error, TimeoutError):
    """An answer, a frame or a file has not arrived in time. The request may still take effect."""


class BadFrame(Error, ValueError):
    """Received bytes are not a valid frame."""
