# SPDX-License-Identifier: Apache-2.0
"""A daemon of one's own, for as long as a program wants it."""

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
    """Starts `cauteryd` on a free port of this machine, with a store that goes with it.

    `program`: by default the environment's CAUTERYD, or `cauteryd` on the path. `settings`: further ones, such as
    `scenes="deploy/scenes"`, `workers=2`; `cauteryd --help` lists them.
    """

    def __init__(self, program: str | None = None, **settings: object) -> None:
        found = program or os.environ.get("CAUTERYD") or shutil.which("cauteryd")
        if not found:
            raise Error("there is no cauteryd: install it, or name it in the environment's CAUTERYD")
        self._folder = tempfile.mkdtemp(prefix="cautery-")
        command = [found, "--json", "--port", "0", "--store", os.path.join(self._folder, "store.db")]
        for name, value in {"log_level": "warning", **settings}.items():
            command.append(f"--{name.replace('_', '-')}={value}")
        # A daemon takes every CAUTERY_ variable for a setting.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True)
        atexit.register(self.close)  # an error of the program must not leave it behind
        line = self._process.stdout.readline() if self._process.stdout else ""
        if not line:
            self.close()
            raise Error(f"{found} did not start: its log says why")
        self.url = f"ws://127.0.0.1:{json.loads(line)['port']}"

    def close(self) -> None:
        """Ends it. A second call does nothing."""
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
