# SPDX-License-Identifier: Apache-2.0
"""What goes wrong."""

from __future__ import annotations

from typing import Any, Mapping


class Error(Exception):
    """Any error of this package."""


class ConnectionRefused(Error):
    """The daemon, or what stands before it, does not open a connection. The text says why."""


class ConnectionClosed(Error):
    """The connection has ended. `code` is a key of `messages.CLOSE_REASONS`, or 1006: it was lost."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"closed with {code}: {reason}" if reason else f"closed with {code}")
        self.code = code
        self.reason = reason


class RequestError(Error):
    """The daemon has refused a request.

    `method`; `code`, a number of JSON-RPC; `status`, a word of `messages.ERROR_CODES`; `path`, the place in the
    request that is wrong (or ""); `reason`, a sentence.
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
    """What was waited for has not come in time. A request may act all the same."""


class BadFrame(Error, ValueError):
    """Bytes that are no frame of the wire."""
