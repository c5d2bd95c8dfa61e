# SPDX-License-Identifier: GPL-3.0-or-later
"""The JavaScript package as its users get it: packed, installed, typed, and its page's program on a daemon.

SOURCES names the source tree, GOLDEN the program that writes golden frames; the rest is as tests/clients/e2e/programs.py has it."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

from programs import PATIENCE_S, Daemon

PACKAGE = os.path.join(os.environ["SOURCES"], "clients", "javascript")
WEB = os.path.join(os.environ["SOURCES"], "clients", "web")
WITH_NODE = os.path.join(WEB, "with_node.sh")
PROGRAM_LINES_MOST = 39
RIGHT = "import { Client } from 'cautery';\nconst client = await Client.connect('ws://127.0.0.1');\n" \
        "const { tick } = await client.call('session.step', { session: 'd1-x', ticks: 1 });\nconst n: number = tick;\n"
WRONG = {  # a change of RIGHT, and what the compiler says of it
    "ticks: 1": ("ticks: '1'", "not assignable to type 'number'"),
    "session.step": ("session.fly", "session.fly"),
    "n: number": ("n: string", "not assignable to type 'string'")}


def run(command, folder):
    return subprocess.run(command, cwd=folder, text=True, timeout=PATIENCE_S, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="cautery-javascript-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        packed = run(["npm", "pack", "--silent", "--pack-destination", cls.folder], PACKAGE)
        if packed.returncode:
            raise RuntimeError(packed.stdout)
        # As `npm install` puts it, without a registry.
        modules = os.path.join(cls.folder, "node_modules")
        with tarfile.open(os.path.join(cls.folder, packed.stdout.split()[-1])) as archive:
            cls.names = archive.getnames()
            archive.extractall(modules)  # npm made it just now
        os.rename(os.path.join(modules, "package"), os.path.join(modules, "cautery"))
        os.symlink(os.path.join(WEB, "node_modules", "meshoptimizer"), os.path.join(modules, "meshoptimizer"))

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def test_it_has_what_its_users_need_and_no_more(self):
        for name in ("LICENSE", "README.md", "package.json", "dist/cautery.js", "dist/javascript/src/index.d.ts"):
            self.assertIn(f"package/{name}", self.names)
        self.assertEqual([name for name in self.names if not re.search(r"\.(js|d\.ts|md|json)$|LICENSE$", name)], [])

    def test_the_program_of_its_page(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            program = re.search(r"```js\n(.*?)```", file.read(), re.S).group(1)
        self.assertLessEqual(program.count("\n"), PROGRAM_LINES_MOST)
        self.write("cut.mjs", program)
        daemon = Daemon(real=True)
        self.addCleanup(daemon.stop)
        done = run([WITH_NODE, "node", "cut.mjs", daemon.url], self.folder)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertRegex(done.stdout, r"(?s)\d{3,} vertices.* [1-9]\d* of \d+ faces are gone\n.*\.obj \d{4,} bytes")

    def test_the_conformance_suite(self):
        suite = os.path.join(os.environ["SOURCES"], "tests", "conformance")
        shutil.copy(os.path.join(suite, "javascript_client.mjs"), self.folder)
        golden = os.path.join(self.folder, "golden")
        os.mkdir(golden)
        subprocess.run([os.environ["GOLDEN"], golden], check=True)
        daemon = Daemon(real=True)
        self.addCleanup(daemon.stop)
        done = run([sys.executable, "-B", os.path.join(suite, "client.py"), "--golden", golden, "--url", daemon.url, "--",
                    WITH_NODE, "node", "javascript_client.mjs"], self.folder)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("1..13", done.stdout)

    def compile(self, text):
        self.write("use.mts", text)
        return run([WITH_NODE, os.path.join(WEB, "node_modules", ".bin", "tsc"), "--noEmit", "--strict", "--target", "es2022",
                    "--lib", "es2022,webworker", "--module", "nodenext", "use.mts"], self.folder)

    def test_its_types(self):
        done = self.compile(RIGHT)
        self.assertEqual(done.returncode, 0, done.stdout)
        for right, (wrong, complaint) in WRONG.items():
            with self.subTest(wrong):
                done = self.compile(RIGHT.replace(right, wrong))
                self.assertNotEqual(done.returncode, 0, "it was compiled")
                self.assertIn(complaint, done.stdout)


if __name__ == "__main__":
    if not shutil.which("npm") or not os.path.isdir(os.path.join(WEB, "node_modules", "vite")):
        print("skipped: no npm, or no packages in clients/web/node_modules (npm ci there installs them)")
        sys.exit(77)
    unittest.main()
