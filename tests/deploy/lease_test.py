# SPDX-License-Identifier: GPL-3.0-or-later
"""A daemon's label in etcd, the real one: which store may be served, and what becomes of a daemon
that etcd does not hear. Usage: lease_test.py SOURCE_FOLDER, with the environment of programs.py."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = os.path.abspath(sys.argv.pop(1))
sys.path[:0] = [os.path.join(SOURCE, "tests", "clients", "e2e"), os.path.join(SOURCE, "tests", "deploy")]
import etcd  # noqa: E402
import programs  # noqa: E402
import together  # noqa: E402

TTL_S = 2  # the least that there is
MARGIN_S = 0.5
LOST = (1, -signal.SIGALRM)  # it ends by itself, or by the kernel's signal where that takes long (the thread sanitizer)
# A machine that other tests keep busy runs a thread late, and a test. Under sanitizers more so.
LATE_S = 8 if os.environ.get("E2E_SLOW") == "1" else 2


class WithStores(unittest.TestCase):
    urls = None  # of the etcds

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="cautery-lease-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def settings(self, store, **more):
        return {"label": "d1", "etcd": self.urls, "etcd_ttl_s": TTL_S, "store": self.path(store), **more}

    def start(self, store, log=None, **more):
        daemon = programs.Daemon(log=log, **self.settings(store, **more))
        self.addCleanup(daemon.process.stdout.close)
        self.addCleanup(daemon.stop)
        return daemon

    def refusal(self, store, flags=(), **more):
        """What a daemon says that does not start."""
        command = [os.environ["DOUBLE"], "--port", "0", "--scenes", os.environ["SCENES"], *flags]
        for name, value in self.settings(store, **more).items():
            command += ["--" + name.replace("_", "-"), str(value)]
        done = subprocess.run(command, capture_output=True, text=True, env=programs.CLEAN,
                              timeout=programs.PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        return re.search(r'event=start_failed .*reason="(.*)"', done.stderr).group(1)

    def cautery(self, daemon, *arguments):
        done = subprocess.run([os.path.join(programs.PROGRAMS, "cautery"), *arguments], text=True, check=True,
                              capture_output=True, env=dict(programs.CLEAN, CAUTERYD_URL=daemon.url),
                              timeout=programs.PATIENCE_S)
        return done.stdout.strip()


class Lease(WithStores):
    def setUp(self):
        super().setUp()
        self.etcd = etcd.Etcd("127.0.0.1", *together.free_ports(2), programs.PATIENCE_S)
        self.addCleanup(self.etcd.stop)
        self.etcd.await_healthy()
        self.urls = self.etcd.url

    def test_a_daemon_that_was_killed_is_back_at_once(self):
        first = self.start("a.db")
        self.assertEqual(self.cautery(first, "create", "fascia", "--name", "knee", "--paused"), "d1-knee")
        first.kill()
        began = time.monotonic()
        second = self.start("a.db")
        # It waits for no lease of its own, which lasts for TTL_S yet.
        self.assertLess(time.monotonic() - began, TTL_S - MARGIN_S + LATE_S)
        self.assertIn("d1-knee", self.cautery(second, "ls"))

    def test_a_label_that_was_given_back_is_there_at_once(self):
        self.start("a.db").stop()
        with open(self.path("log"), "w+", encoding="utf-8") as log:
            self.start("a.db", log=log, log_level="notice").stop()
            log.seek(0)
            text = log.read()
        self.assertIn("event=label_taken label=d1 generation=2", text)
        self.assertNotIn("label_awaited", text)

    def test_a_copy_is_refused_and_taken_if_the_operator_says_so(self):
        first = self.start("a.db")
        self.cautery(first, "backup", "copy")
        first.stop()
        shutil.copy(self.path("backups/copy.db"), self.path("b.db"))  # by cautery
        shutil.copy(self.path("a.db"), self.path("c.db"))  # by other means
        self.assertIn("generation 0, etcd has 1", self.refusal("b.db"))
        self.assertIn("file is a copy of the store", self.refusal("c.db"))
        self.start("b.db", take_label="true").stop()
        self.start("b.db").stop()
        self.assertIn("generation 1, etcd has 3", self.refusal("a.db"))

    def test_nobody_takes_a_label_that_is_held(self):
        first = self.start("a.db")
        began = time.monotonic()
        self.assertIn("another daemon serves the label d1", self.refusal("b.db", ["--take-label"]))
        self.assertGreaterEqual(time.monotonic() - began, 2 * TTL_S - MARGIN_S)
        self.assertEqual(self.cautery(first, "create", "fascia", "--name", "knee", "--paused"), "d1-knee")

    def test_another_label_is_another_matter(self):
        self.start("a.db")
        self.start("b.db", label="d2")

    def test_without_etcd_none_starts(self):
        self.etcd.process.send_signal(signal.SIGSTOP)
        self.assertIn("timed out", self.refusal("a.db"))

    def test_who_etcd_does_not_hear_ends_in_time(self):
        with open(self.path("log"), "w+", encoding="utf-8") as log:
            daemon = self.start("a.db", log=log)
            self.etcd.process.send_signal(signal.SIGSTOP)
            began = time.monotonic()
            self.assertIn(daemon.process.wait(programs.PATIENCE_S), LOST)
            self.assertLess(time.monotonic() - began, TTL_S - MARGIN_S + LATE_S)
            log.seek(0)
            self.assertIn("event=label_lost label=d1", log.read())
        self.etcd.process.send_signal(signal.SIGCONT)
        self.etcd.await_healthy()
        self.start("a.db")

    def test_who_slept_through_the_end_says_nothing_more(self):
        daemon = self.start("a.db")
        asked = "".join(json.dumps({"jsonrpc": "2.0", "id": i, "method": method, "params": params}) + "\n"
                        for i, (method, params) in enumerate([
                            ("hello", {"version": 1, "client": "test"}),
                            ("session.create", {"name": "knee", "scene": "fascia", "paused": True})], 1))
        with socket.create_connection(("127.0.0.1", daemon.port), programs.PATIENCE_S) as client:
            client.sendall(b"GET /v1 HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                           b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: cautery.v1\r\n"
                           b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n")
            answers = client.makefile("rb")
            self.assertIn(b" 101 ", answers.readline())
            while answers.readline().strip():
                pass
            daemon.process.send_signal(signal.SIGSTOP)
            for line in asked.splitlines():  # masked with zeros
                client.sendall(bytes([0x81, 0x80 | 126]) + len(line).to_bytes(2, "big") + bytes(4) + line.encode())
            # Nobody tells when the lease has ended; its own clock does not know either.
            time.sleep(TTL_S)
            daemon.process.send_signal(signal.SIGCONT)
            self.assertIn(daemon.process.wait(programs.PATIENCE_S), LOST)
            try:
                said = answers.read()
            except ConnectionResetError:
                said = b""
            self.assertNotIn(b"d1-knee", said)


class Three(WithStores):
    TTL_S = 6  # longer than the others take to find a leader: one to two seconds

    def setUp(self):
        super().setUp()
        ports = together.free_ports(6)
        peers = {f"e{i}": ports[3 + i] for i in range(3)}
        self.etcds = [etcd.Etcd("127.0.0.1", ports[i], ports[3 + i], programs.PATIENCE_S, name=f"e{i}", peers=peers)
                      for i in range(3)]
        for one in self.etcds:
            self.addCleanup(one.stop)
        for one in self.etcds:
            one.await_healthy()
        self.etcds.sort(key=lambda one: not one.leads())  # it is asked first, and by default alone
        self.urls = ",".join(one.url for one in self.etcds)

    def test_one_may_fail_and_with_two_gone_the_daemon_ends_in_time(self):
        daemon = self.start("a.db", etcd_ttl_s=self.TTL_S)
        leader, second, _ = self.etcds
        leader.kill()
        with self.assertRaises(subprocess.TimeoutExpired):
            daemon.process.wait(self.TTL_S)  # without the two that are left it would have ended
        self.assertEqual(self.cautery(daemon, "create", "fascia", "--name", "knee", "--paused"), "d1-knee")
        second.kill()
        began = time.monotonic()
        self.assertIn(daemon.process.wait(programs.PATIENCE_S), LOST)
        self.assertLess(time.monotonic() - began, self.TTL_S - MARGIN_S + LATE_S)
        leader.start()
        leader.await_healthy()
        self.assertIn("d1-knee", self.cautery(self.start("a.db", etcd_ttl_s=self.TTL_S), "ls"))


if __name__ == "__main__":
    together.main(at_once=3, by_class=False)
