# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package against a real daemon. PYTHONPATH has the package and tests/clients/e2e."""

import os
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import cautery
from cautery import ConnectionClosed, ConnectionRefused, NoAnswer, RequestError

import programs

PACKAGE = os.path.dirname(os.path.dirname(cautery.__file__))
ATTEMPTS = 5  # beside other programs this one may stand still for as long as the daemon waits


class Sessions(programs.Case):
    real = True

    def setUp(self):
        self.client = cautery.Client(self.daemon.url, timeout_s=programs.PATIENCE_S)
        self.addCleanup(self.client.close)

    def paused(self, name, scene="fascia"):
        made = self.client.session_create(name=name, scene=scene, paused=True)
        session = made["summary"]["session"]
        self.addCleanup(self.destroy, session)
        return session

    def destroy(self, session):
        with cautery.Client(self.daemon.url, timeout_s=programs.PATIENCE_S) as client:
            client.session_destroy(session=session)

    def test_what_takes_long_is_waited_for_while_the_daemon_is_heard(self):
        """`layers` is built for longer than half a second."""
        with cautery.Client(self.daemon.url, timeout_s=0.5) as client:
            began = time.monotonic()
            made = client.session_create(name="large", scene="layers", paused=True)
            took_s = time.monotonic() - began
        self.addCleanup(self.destroy, made["summary"]["session"])
        self.assertGreater(took_s, 0.5, "it must outlast the timeout to show anything")

    def test_a_stream_is_the_tissue(self):
        session = self.paused("stream")
        stream = self.client.join(session)
        first = stream.wait()
        self.assertEqual((first.tick, first.paused, first.faulted), (0, True, False))
        self.assertLess(np.abs(first.positions - stream.rest).max(), 0.005)
        self.assertEqual(stream.faces.max(), len(stream.rest) - 1)
        self.assertFalse(first.removed.any())
        self.client.tool_take_over(session=session, tool="hook")
        self.client.tool_move(session=session, tool="hook", position_m=[0, 0, -0.003], rotation=[1, 0, 0, 0])
        self.client.session_step(session=session, ticks=30)
        later = stream.wait(30)
        self.assertEqual(later.tick, 30)
        self.assertGreater(np.abs(later.positions - first.positions).max(), 0.001)
        self.assertTrue(np.array_equal(first.positions, first.positions.copy()))
        with self.assertRaises(NoAnswer):
            stream.next(30, timeout_s=0.2)

    def test_a_stream_has_the_raw_force_of_its_tick(self):
        name = self.paused("felt")
        session = cautery.Session(self.client, self.client.session_describe(session=name)["summary"])
        stream = self.client.join(name, channels=["positions", "tools"])
        self.client.tool_take_over(session=name, tool="hook")
        for tick in range(1, 41):
            move = {"method": "tool.move", "tool": "hook", "position_m": [0, 0, 0.005 - 0.0002 * tick], "rotation": [1, 0, 0, 0]}
            seen = session.advance(1, [move], {"channels": ["tools"]}).tools["hook"]
        tool = stream.wait(tick).tools["hook"]
        self.assertEqual(stream.wait(tick).tick, tick)
        self.assertGreater(seen["raw_force_n"][2], seen["force_n"][2])
        self.assertTrue(np.array_equal(tool.raw_force_n, np.float32(seen["raw_force_n"])))
        self.assertTrue(np.array_equal(tool.raw_torque_nm, np.float32(seen["raw_torque_nm"])))
        self.assertEqual(tool.force_filter_s, np.float32(0.02))

    def test_what_a_stream_holds_is_what_a_second_client_is_sent_whole(self):
        session = self.paused("cut")
        stream = self.client.join(session, channels=["positions", "mask", "temperature", "tools", "statistics"])
        self.client.tool_take_over(session=session, tool="hook")
        self.client.tool_configure(session=session, tool="hook", shape="hook", temperature_c=900)
        with self.client.heartbeats():
            for step in range(60):
                self.client.tool_move(session=session, tool="hook", position_m=[-0.01 + 0.0003 * step, 0, 0.0005],
                                      rotation=[1, 0, 0, 0])
                self.client.tool_energize(session=session, tool="hook", energized=True)
                tick = self.client.session_step(session=session, ticks=2)["tick"]
        state = stream.wait(tick)
        self.assertGreater(int(state.removed.sum()), 10)
        self.assertGreaterEqual(state.statistics["elements_removed"], state.removed.sum())
        self.assertTrue(state.tools["hook"].energized)
        self.assertGreater(state.tools["hook"].tip_temperature_c, 800)
        self.assertGreater(state.scalars["temperature"].max(), 100)
        with cautery.Client(self.daemon.url) as other:
            whole = other.join(session, channels=["positions", "mask", "temperature", "tools", "statistics"]).wait(tick)
        self.assertTrue(np.array_equal(whole.removed, state.removed))
        self.assertTrue(np.array_equal(whole.positions, state.positions))
        self.assertTrue(np.array_equal(whole.scalars["temperature"], state.scalars["temperature"]))
        self.assertEqual(stream.skipped, 0)

    def test_energy_goes_off_without_heartbeats(self):
        session = self.paused("silent")
        stream = self.client.join(session)
        self.client.tool_take_over(session=session, tool="hook")
        self.client.session_resume(session=session)
        self.client.tool_energize(session=session, tool="hook", energized=True)
        lit = stream.wait().tick
        while not (state := stream.next(lit, programs.PATIENCE_S)).tools["hook"].energized:
            lit = state.tick
        while (state := stream.next(state.tick, programs.PATIENCE_S)).tools["hook"].energized:
            pass
        self.assertEqual(state.tools["hook"].energy_off, "watchdog")

    def test_energy_stays_on_with_heartbeats_alone(self):
        session = self.paused("alive")
        stream = self.client.join(session)
        self.client.tool_take_over(session=session, tool="hook")
        self.client.session_resume(session=session)
        silence_s = self.client.server["limits"]["heartbeat_s"]
        for attempt in range(1, ATTEMPTS + 1):
            with self.client.heartbeats():
                self.client.tool_energize(session=session, tool="hook", energized=True)
                lit = time.monotonic()
                while time.monotonic() < lit + 8 * silence_s:
                    state = stream.next(stream.wait().tick, programs.PATIENCE_S)
            if state.tools["hook"].energized:
                break
            self.assertLess(attempt, ATTEMPTS, "energy goes off each time, though heartbeats are sent")
        tick = state.tick
        while stream.next(tick, programs.PATIENCE_S).tools["hook"].energized:
            tick += 1

    def test_files_go_both_ways(self):
        session = self.paused("files")
        self.client.session_step(session=session, ticks=2)
        data = self.client.download("session.export", {"session": session, "format": "vtu"})
        self.assertTrue(data.startswith(b"<?xml"))
        uploaded = self.client.upload("again", "tissue.vtu", data)
        self.assertEqual(uploaded["byte_count"], len(data))
        reading = self.client.mesh_read(upload="again", unit_m=1, as_="fascia")
        self.assertGreater(reading["report"]["vertices_read"], 100)

    def test_a_refusal_says_what_where_and_why(self):
        with self.assertRaises(RequestError) as caught:
            self.client.session_create(name="Not A Name", scene="fascia")
        self.assertEqual((caught.exception.method, caught.exception.path), ("session.create", "params.name"))
        self.assertTrue(caught.exception.reason)
        self.assertIn("params.name", str(caught.exception))
        self.assertTrue(self.client.scene_list()["scenes"])

    def test_threads_share_a_connection(self):
        session = self.paused("shared")
        found = []

        def ask():
            for _ in range(20):
                found.append(self.client.session_describe(session=session)["summary"]["session"])

        threads = [threading.Thread(target=ask) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [session] * 160)

    def test_notices_are_kept_and_called_back(self):
        heard = threading.Event()
        with cautery.Client(self.daemon.url, on_notice=lambda method, params: heard.set()) as watcher:
            session = self.paused("noticed")
            self.client.session_step(session=session, ticks=1)
            self.assertTrue(heard.wait(programs.PATIENCE_S))
            self.assertTrue(watcher.notices)

    def test_the_example_of_the_readme_runs(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            example, *_ = re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL)
        self.assertLess(example.count("\n"), 40)
        done = subprocess.run([sys.executable, "-B", "-c", example.replace("ws://127.0.0.1:8740", self.daemon.url)],
                              capture_output=True, text=True, check=False, timeout=programs.PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        parted, all_faces, hottest = map(int, re.search(r"^(\d+) of (\d+) faces .*\n.* (\d+) degC", done.stdout).groups())
        self.assertGreater(parted, 50)
        self.assertLess(parted, all_faces / 2)
        self.assertGreater(hottest, 60)


class Connections(unittest.TestCase):
    def test_a_daemon_that_ends_ends_everything_that_waits(self):
        daemon = programs.Daemon()
        client = cautery.Client(daemon.url)
        daemon.kill()
        with self.assertRaises(ConnectionClosed):
            while True:
                client.session_list()
        with self.assertRaises(ConnectionClosed):
            client.notify("heartbeat", {})
        client.close()
        daemon.stop()

    def test_a_wrong_token_is_refused_in_words(self):
        token_file = os.path.join(self.enterContext(tempfile.TemporaryDirectory()), "tokens")
        with open(token_file, "w", encoding="utf-8", opener=lambda p, f: os.open(p, f, 0o600)) as file:
            file.write("operate secret-0123456789abcdef\n")
        daemon = programs.Daemon(tokens=token_file)
        self.addCleanup(daemon.stop)
        with self.assertRaises((RequestError, ConnectionClosed)) as caught:
            cautery.Client(daemon.url, token="secret-of-somebody-else")
        self.assertIn("token", str(caught.exception))
        with cautery.Client(daemon.url, token="secret-0123456789abcdef", role="view") as client:
            self.assertEqual(client.server["role"], "view")

    def test_what_is_no_daemon_is_refused_in_words(self):
        daemon = programs.Daemon()
        self.addCleanup(daemon.stop)
        with self.assertRaises(ConnectionRefused) as caught:
            cautery.Client(f"{daemon.url}/nothing-here")
        self.assertIn("404", str(caught.exception))
        with self.assertRaises(ValueError):
            cautery.Client("127.0.0.1:8740")


if __name__ == "__main__":
    unittest.main()
