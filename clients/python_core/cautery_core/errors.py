# SPDX-License-Identifier: GPL-3.0-or-later
"""The exceptions of this package, with the reasons of the core."""

from __future__ import annotations


class CoreError(Exception):
    """The core has refused a call.

    `status` is a word such as "bad_value" or "numerical". `file` and `path` name the wrong file and member, or are "".
    `reason` is a sentence.
    """

    def __init__(self, status: str, file: str, path: str, reason: str) -> None:
        self.status, self.file, self.path, self.reason = status, file, path, reason
        place = ": ".join(part for part in (file, path) if part)
        super().__init__(f"{place}: {reason}" if place else reason)


class CommandRefused(CoreError):
    """A command was refused at its tick. The tick is done, and the session continues."""
