# SPDX-License-Identifier: GPL-3.0-or-later
"""The clients' programs and daemons for them. Where they are comes from the environment:
PROGRAMS (folder of cautery, cautery-load, cautery-teaching, cautery-sim, cauteryd), DOUBLE (a cauteryd without
physics) and SCENES."""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import unittest

PROGRAMS = os.environ["PROGRAMS"]
# Far beyond what any program needs; only failing tests reach it.
PATIENCE_S = 1200 if os.environ.get("E2E_SLOW") == "1" else 120

# The daemon takes every CAUTERY_ variable for a setting.
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith(("CAUTERY_", "CAUTERYD_"))}


class Daemon:
    def __init__(self, real=False, port=0, store=None, log=None, **settings):
        """`log`: an open file for what it logs."""
        self.folder = tempfile.mkdtemp(prefix="cautery-e2e-")
        self.store = store or os.path.join(self.folder, "store.db")
        settings.setdefault("log_level", "warning")
        program = os.path.join(PROGRAMS, "cauteryd") if real else os.environ["DOUBLE"]
        command = [program, "--json", "--port", str(port), "--store", self.store,
                   "--scenes", os.environ["SCENES"]]
        for name, value in settings.items():
            command.append(f"--{name.replace('_', '-')}={value}")
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, env=CLEAN,
                                        text=True)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"{program} did not start")
        self.port = json.loads(line)["port"]
        self.url = f"ws://127.0.0.1:{self.port}"

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            code = self.process.wait(PATIENCE_S)
            self.process.stdout.close()
            shutil.rmtree(self.folder)
            if code:
                raise RuntimeError(f"the daemon ended with {code}")


class Case(unittest.TestCase):
    """One daemon for each test class; `real` says which kind."""
    real = False
    settings = {}  # of the daemon

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(real=cls.real, **cls.settings)
        cls.addClassCleanup(cls.daemon.stop)
        cls.folder = tempfile.mkdtemp(prefix="cautery-e2e-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    def path(self, name, text=None):
        path = os.path.join(self.folder, name)
        if text is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        return path

    def file(self, name, data):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    def program(self, name, *arguments, code=0, url=None, environment=None, **options):
        """Runs a client and expects its exit code. Returns (standard output, standard error).
        With an `environment` that alone is added to a clean one, and no URL."""
        environment = dict(CLEAN, **(environment or {"CAUTERYD_URL": url or self.daemon.url}))
        done = subprocess.run([os.path.join(PROGRAMS, name), *map(str, arguments)], text=True,
                              capture_output=True, env=environment, timeout=PATIENCE_S,
                              check=False, **options)
        self.assertEqual(done.returncode, code,
                         f"{name} {arguments}\n{done.stdout}\n{done.stderr}")
        return done.stdout, done.stderr

    def cautery(self, *arguments, code=0, **options):
        return self.program("cautery", *arguments, code=code, **options)

    def json(self, *arguments, code=0, program="cautery", **options):
        """The JSON object that is the last line of standard output."""
        out, _ = self.program(program, *arguments, "--json", code=code, **options)
        return json.loads(out.splitlines()[-1])

    def create(self, *arguments):
        session = self.cautery("create", *arguments)[0].strip()
        self.addCleanup(self.cautery, "rm", session)
        return session
