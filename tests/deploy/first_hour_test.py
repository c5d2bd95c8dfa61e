# SPDX-License-Identifier: GPL-3.0-or-later
"""The README's two commands in a fresh clone: in its order, again, and on trees that others left.

Usage: first_hour_test.py REPOSITORY      Exit code 77: skipped, and the reason is printed.

`deploy/run.sh` and `deploy/test.sh` work on one build tree. Here they take turns on it, with real
compilers and a real daemon. deploy/test.sh runs one small test each time (--only): what is shown is
that it finds, or makes, a tree that has tests.
"""

import http.client
import os
import re
import select
import shutil
import socket
import subprocess
import sys
import tempfile

SMALL_TEST = "^protocol_wire_frame_size$"  # links protocol alone, which compiles in seconds
COMMAND_LIMIT_S = 600  # a whole build on a busy machine
END_LIMIT_S = 60  # of a daemon that was told to end


class Clone:
    def __init__(self, repository, folder):
        self.folder = os.path.join(folder, "clone")
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith(("CAUTERY", "CMAKE_", "CCACHE_BASEDIR"))}  # a clone's own
        self.environment["XDG_STATE_HOME"] = os.path.join(folder, "state")
        subprocess.run(["git", "clone", "--quiet", repository, self.folder], check=True)

    def call(self, *command, code=0, show=True):
        """Runs a command in the clone; returns what it said."""
        print("$", *command, flush=True)
        done = subprocess.run(command, cwd=self.folder, env=self.environment, text=True, timeout=COMMAND_LIMIT_S,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        print(done.stdout if show else "", flush=True)
        assert done.returncode == code, f"exit code {done.returncode}, expected {code}"
        return done.stdout

    def test(self):
        said = self.call("deploy/test.sh", "--no-install", "--only", SMALL_TEST)
        assert "100% tests passed, 0 tests failed out of 1\n" in said

    def run(self, *flags, code=0):
        return self.call("deploy/run.sh", "--no-install", "--detach", "--port", "0", *flags, code=code)


class Daemon:
    """What `deploy/run.sh --detach` left running, by what it printed."""

    def __init__(self, said):
        self.process = int(re.search(r"cauteryd is running \(process (\d+)\)", said).group(1))
        self.address = re.search(r"open +http://([\d.:]+)/", said).group(1)
        self.handle = os.pidfd_open(self.process)

    def ask(self, page):
        connection = http.client.HTTPConnection(self.address, timeout=END_LIMIT_S)
        connection.request("GET", page)
        return connection.getresponse().status

    def end(self):
        os.kill(self.process, 15)
        ended, _, _ = select.select([self.handle], [], [], END_LIMIT_S)
        os.close(self.handle)
        assert ended, "the daemon did not end"


def run_and_end(clone):
    daemon = Daemon(clone.run())
    try:
        assert daemon.ask("/readyz") == 200, "it was said to be running and is not ready"
    finally:
        daemon.end()


def in_any_order(clone):
    run_and_end(clone)
    # The README's commands by hand find tests in the tree that run.sh made.
    listed = clone.call("ctest", "--test-dir", "build", "--show-only=json-v1", show=False)
    assert SMALL_TEST.strip("^$") in listed
    clone.test()
    run_and_end(clone)
    clone.test()


def a_second_daemon_is_refused(clone):
    daemon = Daemon(clone.run())
    try:
        said = clone.run(code=1)
        assert f"is running already: process {daemon.process}" in said
        assert daemon.ask("/readyz") == 200
    finally:
        daemon.end()


def a_taken_port_is_named(clone):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        assert f"port {port}" in clone.run("--port", port, code=1)


def one_that_is_not_ready_is_ended(clone):
    said = clone.run("--patience", "0", "--store", os.path.join(clone.folder, "build", "other.db"), code=1)
    assert "was not ready after 0 s and has been ended" in said
    assert not os.path.exists(os.path.join(clone.folder, "build", "other.db-lock"))


def a_tree_of_other_hands(clone):
    """Without tests, by Makefiles; then in a folder that has been renamed."""
    tree = os.path.join(clone.folder, "build")
    shutil.rmtree(tree)
    clone.call("cmake", "-G", "Unix Makefiles", "-S", ".", "-B", "build", "-DCAUTERY_TESTS=OFF")
    clone.test()
    assert os.path.exists(os.path.join(tree, "Makefile")), "its generator is kept"
    os.rename(clone.folder, clone.folder + "-renamed")
    clone.folder += "-renamed"
    clone.test()


def a_tree_that_was_never_finished(clone):
    """cmake leaves a cache and no build files where it stopped half-way."""
    tree = os.path.join(clone.folder, "build")
    for name in ("build.ninja", "Makefile"):
        if os.path.exists(os.path.join(tree, name)):
            os.remove(os.path.join(tree, name))
    run_and_end(clone)


def main(repository):
    if subprocess.run(["git", "-C", repository, "rev-parse"], capture_output=True, check=False).returncode:
        print("skipped: not a git checkout, so nothing to clone")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        clone = Clone(repository, folder)
        for check in (in_any_order, a_second_daemon_is_refused, a_taken_port_is_named,
                      one_that_is_not_ready_is_ended, a_tree_that_was_never_finished,
                      a_tree_of_other_hands):
            print("==", check.__name__, flush=True)
            check(clone)


if __name__ == "__main__":
    main(sys.argv[1])
