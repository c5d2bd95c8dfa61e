# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong, in the core's words."""

from __future__ import annotations


class CoreError(Exception):
    """The core has refused something.

    `status`, a word such as "bad_value" or "numerical"; `file` and `path`, the place that is wrong (or ""); `reason`, a
    sentence.
    """

    def __init__(self, status: str, file: str, path: str, reason: str) -> None:
        self.status, self.file, self.path, self.reason = status, file, path, reason
        place = ": ".join(part for part in (file, path) if part)
        super().__init__(f"{place}: {reason}" if place else reason)


class CommandRefused(CoreError):
    """A command was refused at its tick. The tick has passed, and the session goes on."""
