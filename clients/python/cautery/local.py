# SPDX-License-Identifier: Apache-2.0
"""A daemon that a program starts for itself and ends."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import subprocess
import tempfile

from .errors import Error

_END_S = 30.0


class LocalDaemon:
    """Starts `cauteryd` on a free port of this machine, with a temporary store.

    `program` is the path of cauteryd. By default it comes from the environment variable CAUTERYD, or `cauteryd` is
    searched on the path. `settings` are settings of the daemon, such as `scenes="deploy/scenes"` or `workers=2`.
    `cauteryd --help` lists all settings.
    """

    def __init__(self, program: str | None = None, **settings: object) -> None:
        found = program or os.environ.get("CAUTERYD") or shutil.which("cauteryd")
        if not found:
            raise Error("cauteryd was not found: install it, or set the environment variable CAUTERYD to its path")
        self._folder = tempfile.mkdtemp(prefix="cautery-")
        command = [found, "--json", "--port", "0", "--store", os.path.join(self._folder, "store.db")]
        for name, value in {"log_level": "warning", **settings}.items():
            command.append(f"--{name.replace('_', '-')}={value}")
        # A daemon reads every variable CAUTERY_... as a setting.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True)
        atexit.register(self.close)  # the daemon must also end if the program ends by an error
        line = self._process.stdout.readline() if self._process.stdout else ""
        if not line:
            self.close()
            raise Error(f"{found} did not start: see the reason in its log")
        self.url = f"ws://127.0.0.1:{json.loads(line)['port']}"

    def close(self) -> None:
        """Ends the daemon and removes its store. A second call does nothing."""
        atexit.unregister(self.close)
        self._process.terminate()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout:
            self._process.stdout.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> LocalDaemon:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
