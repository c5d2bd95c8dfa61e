# SPDX-License-Identifier: GPL-3.0-or-later
"""Sessions of the core in this process. PYTHONPATH has the package; SIM: cautery-sim; SCENES: the folder of scenes."""

import gc
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import cautery_core
from cautery_core import CommandRefused, CoreError, Session

PACKAGE = os.path.dirname(os.path.dirname(cautery_core.__file__))
SCENES = os.environ["SCENES"]
FASCIA = os.path.join(SCENES, "fascia.json")
PATIENCE_S = 120


def small(**members):
    """A sheet of 8 by 8 cells with a hook and a grasper above it."""
    return {"name": "small", "meshes": [{"source": "sheet", "name": "sheet", "cells": [8, 8]}],
            "layers": [{"kind": "fascia", "name": "fascia", "mesh": "sheet", "absorption_per_s": 50}],
            "pins": [{"kind": "rim", "layer": "fascia"}],
            "tools": [{"name": "hook", "shape": "sphere", "hot_radius_m": 0.004, "temperature_c": 700},
                      {"name": "grasper", "shape": "grasper", "position_m": [0.02, 0, 0.02]}], **members}


def play(session, script, ticks):
    """Plays a script of commands, one a line, as cautery-sim does."""
    commands = [json.loads(line) for line in script.splitlines()]
    for tick in range(ticks):
        while commands and commands[0]["tick"] <= tick:
            session.submit(**commands.pop(0))
        session.step()


class Physics(unittest.TestCase):
    def test_a_cut_has_the_bits_of_cautery_sim(self):
        sim = [os.environ["SIM"], "--scene", FASCIA]
        script = subprocess.run([*sim, "--print-cut"], check=True, capture_output=True, text=True).stdout
        said = subprocess.run([*sim, "--cut", "--seconds", "6", "--json"], check=True, capture_output=True, text=True)
        result = json.loads(said.stdout.splitlines()[-1])
        for threads in (1, 2):
            with Session(FASCIA, threads=threads) as session:
                play(session, script, 360)
                self.assertEqual(session.tick, result["ticks"])
                self.assertEqual(f"{session.hash():016x}", result["hash"])
                self.assertGreater(session.statistics["edges_parted"], 0)

    def test_what_is_seen_of_a_cut(self):
        with Session(small()) as session:
            self.assertEqual((session.name, session.tick, session.vertex_count, session.face_count), ("small", 0, 81, 128))
            self.assertEqual([(layer.name, layer.kind, layer.face_count) for layer in session.layers],
                             [("fascia", "fascia", 128)])
            self.assertEqual((session.faces.shape, session.faces.max()), ((128, 3), 80))
            self.assertFalse(session.removed.any())
            self.assertTrue(session.visible.all())
            before = session.positions
            session.move_tool("hook", [0, 0, -0.002])
            session.energize("hook")
            self.assertEqual(session.step(60), 60)
            self.assertAlmostEqual(session.time_s, 1.0)
            self.assertTrue(session.removed.any())
            self.assertGreater(np.abs(session.positions - before).max(), 1e-4)
            self.assertTrue(np.array_equal(before, before.copy()) and before.base is None)
            self.assertEqual(session.velocities.shape, (81, 3))
            self.assertEqual(session.scalar("exposure").max(), 1)
            self.assertAlmostEqual(session.scalar("temperature").max(), 700, delta=30)
            hook = session.tools["hook"]
            self.assertTrue(hook.energized)
            self.assertTrue(np.allclose(hook.position_m, [0, 0, -0.002]))
            self.assertEqual(hook.tip_temperature_c, 700)
            self.assertGreater(hook.energy_j, 0)
            session.energize("hook", False)
            session.step()
            self.assertFalse(session.tools["hook"].energized)

    def test_jaws_hold_and_release(self):
        with Session(small()) as session:
            session.move_tool("grasper", [0.02, 0, -0.002], jaw=1)
            session.step(60)
            session.move_tool("grasper", [0.02, 0, -0.002], jaw=0)
            session.grasp("grasper")
            session.step(60)
            held = session.tools["grasper"]
            self.assertTrue(held.grasping)
            self.assertGreater(held.grasped_vertices, 0)
            session.release("grasper")
            session.step()
            self.assertEqual(session.tools["grasper"].grasped_vertices, 0)

    def test_a_tool_is_configured_member_by_member(self):
        with Session(small()) as session:
            session.configure_tool("hook", temperature_c=300)
            session.step()
            hook = session.tools["hook"]
            self.assertEqual((hook.shape, hook.sizes["temperature_c"], hook.sizes["hot_radius_m"]), ("sphere", 300, 0.004))
            with self.assertRaises(CoreError):
                session.configure_tool("nothing", temperature_c=300)

    def test_a_tool_becomes_an_instrument(self):
        with Session(small()) as session:
            session.configure_tool("hook", friction=0.7)
            session.configure_tool("hook", instrument="monopolar-spatula", mode="blend", power_w=20)
            session.step()
            hook = session.tools["hook"]
            self.assertEqual((hook.shape, hook.sizes["power_w"], hook.sizes["crest_factor"]), ("spatula", 20, 2))
            self.assertEqual((hook.sizes["blade_heat_j_k"], hook.sizes["friction"]), (0.14, 0.2))
            with self.assertRaisesRegex(CoreError, "none of advanced-bipolar, .*ultrasonic-shears"):
                session.configure_tool("hook", instrument="spoon")

    def test_the_raw_force_is_beside_the_filtered_one(self):
        with Session(small()) as session:
            filtered, tau_s = np.zeros(3), session.tools["hook"].sizes["force_filter_s"]
            for tick in range(1, 31):
                session.move_tool("hook", [0, 0, 0.005 - 0.0004 * tick])
                session.step()
                hook = session.tools["hook"]
                filtered += session.step_s / (session.step_s + tau_s) * (hook.raw_force_n - filtered)
                self.assertLess(np.abs(hook.force_n - filtered).max(), 1e-12)
            self.assertEqual(tau_s, 0.02)
            self.assertGreater(hook.raw_force_n[2], hook.force_n[2])
            session.configure_tool("hook", force_filter_s=0)
            session.step()
            hook = session.tools["hook"]
            self.assertTrue(np.array_equal(hook.force_n, hook.raw_force_n))
            self.assertTrue(np.array_equal(hook.torque_nm, hook.raw_torque_nm))

    def test_a_cut_vessel_bleeds_and_a_restore_makes_it_whole(self):
        with Session(os.path.join(SCENES, "pedicle.json")) as session:
            whole = session.snapshot()
            artery = session.vessels["artery"]
            self.assertEqual((artery.parted, artery.bleeds, artery.shed_m3), (False, False, 0))
            self.assertTrue(np.allclose(artery.points[[0, -1], 0], [-0.02, 0.02], atol=1e-6))
            session.move_tool("needle", [0, -0.006, -0.007])
            session.step(30)
            session.energize("needle")
            for tick in range(60):
                session.move_tool("needle", [0, -0.006 + 0.0002 * tick, -0.007])
                session.step()
            artery = session.vessels["artery"]
            self.assertEqual((artery.parted, artery.bleeds, artery.sealed), (True, True, False))
            self.assertGreater(artery.shed_m3, 0)
            self.assertLess(artery.open.min(), 0)
            self.assertGreater(session.scalar("blood").max(), 0)
            session.restore(whole)
            self.assertEqual((session.vessels["artery"].parted, session.vessels["artery"].shed_m3), (False, 0))

    def test_a_restore_brings_back_the_bits(self):
        with Session(small()) as session:
            session.move_tool("hook", [0, 0, -0.002])
            session.energize("hook")
            session.step(10)
            kept = session.snapshot()
            ends = []
            for _ in range(2):
                session.step(30)
                ends.append((session.hash(), session.positions))
                self.assertTrue(session.restore(kept))
                self.assertEqual(session.tick, 10)
            with Session(small()) as other:
                self.assertTrue(other.restore(kept))
                other.step(30)
                ends.append((other.hash(), other.positions))
            self.assertEqual(len({end[0] for end in ends}), 1)
            self.assertTrue(all(np.array_equal(end[1], ends[0][1]) for end in ends))

    def test_sessions_of_an_instruction_set(self):
        with Session(small(), instruction_set="baseline") as session:
            self.assertEqual(session.instruction_set, "baseline")
            session.step()

    def test_mesh_files_are_looked_up_in_the_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "square.obj"), "w", encoding="ascii") as file:
                file.write("v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n")
            scene = small(meshes=[{"source": "file", "name": "sheet", "file": "square.obj"}])
            with Session(scene, directory=folder) as session:
                self.assertEqual(session.vertex_count, 4)
            with self.assertRaises(CoreError) as raised:
                Session(scene)
            self.assertEqual((raised.exception.status, raised.exception.file), ("io", "square.obj"))


class Mistakes(unittest.TestCase):
    def refused(self, status, path, *arguments, **named):
        with self.assertRaises(CoreError) as raised:
            Session(*arguments, **named)
        self.assertEqual((raised.exception.status, raised.exception.path), (status, path))
        self.assertTrue(raised.exception.reason)
        return raised.exception

    def test_scenes_in_the_words_of_the_core(self):
        error = self.refused("bad_value", "layers[0].thickness_m", small(layers=[
            {"kind": "fascia", "name": "fascia", "mesh": "sheet", "thickness_m": -1}]))
        self.assertIn("layers[0].thickness_m: ", str(error))
        self.assertIn("m", error.reason)
        self.refused("bad_value", "strange", small(strange=1))
        self.refused("bad_value", "thread_count", small(), threads=17)
        self.refused("bad_value", "thread_count", small(), threads=0)
        self.assertEqual(self.refused("io", "", "/nowhere/scene.json").file, "/nowhere/scene.json")
        with self.assertRaisesRegex(ValueError, "baseline"):
            Session(small(), instruction_set="vax")
        with self.assertRaises(ValueError):
            Session(small(step_s=float("nan")))
        with self.assertRaises(ValueError):
            Session("a\0b.json")
        for strange in (5, None, b"\xff\0"):
            with self.assertRaises((TypeError, ValueError)):
                Session(strange)
        with self.assertRaises(TypeError):
            Session(small(strange={1, 2}))

    def test_commands(self):
        with Session(small(), command_capacity=2) as session:
            with self.assertRaises(CoreError) as raised:
                session.submit("tool.fly", tool="hook")
            self.assertEqual((raised.exception.status, raised.exception.path), ("bad_value", "command"))
            for position in ([0, 0], [[0, 0, 0]], [1e9, 0, 0]):
                with self.assertRaises(CoreError) as raised:
                    session.move_tool("hook", position)
                self.assertIn("position_m", raised.exception.path)
            with self.assertRaises(ValueError):
                session.move_tool("hook", [np.nan, 0, 0])
            session.grasp("nothing")
            session.move_tool("hook", [0, 0, 0.04])
            with self.assertRaises(CoreError) as raised:
                session.energize("hook")
            self.assertEqual(raised.exception.status, "limit")
            with self.assertRaises(CommandRefused) as raised:
                session.step(5)
            self.assertEqual((raised.exception.status, session.tick), ("not_found", 1))
            self.assertEqual(session.step(), 2)

    def test_arrays_of_wrong_shapes(self):
        with Session(small()) as session:
            shape = session.positions.shape
            read_only = np.empty(shape)
            read_only.flags.writeable = False
            for out in (np.empty(shape[::-1]), np.empty(3), np.empty(shape, np.float32), np.empty((shape[0], 6))[:, ::2],
                        np.empty(shape, order="F"), read_only, [[0.0] * 3] * shape[0], None):
                with self.assertRaises(ValueError):
                    session.read_positions(out)
            kept = np.zeros(shape)
            self.assertIs(session.read_positions(kept), kept)
            self.assertTrue(np.array_equal(kept, session.positions))
            with self.assertRaises(ValueError):
                session.scalar("colour")

    def test_damaged_snapshots_leave_the_session_alone(self):
        with Session(small()) as session:
            session.step(3)
            kept, before = session.snapshot(), session.hash()
            turned = bytes([*kept[:-9], kept[-9] ^ 1, *kept[-8:]])
            for bad in (b"", b"x" * 100, kept[:-1], kept + b"x", turned):
                with self.assertRaises(CoreError) as raised:
                    session.restore(bad)
                self.assertEqual(raised.exception.status, "corrupt")
                self.assertEqual(session.hash(), before)
            with Session(FASCIA) as other, self.assertRaises(CoreError):
                other.restore(kept)
            session.step()

    def test_a_fault_is_an_error_that_a_restore_ends(self):
        with Session(small()) as session:
            kept = session.snapshot()
            session.submit("force.set", selection={"kind": "box", "layer": "fascia", "least_m": [-1, -1, -1],
                                                   "most_m": [1, 1, 1]}, force_n=[0, 0, 1000])
            with self.assertRaises(CoreError) as raised:
                session.step(200)
            self.assertEqual(raised.exception.status, "numerical")
            with self.assertRaises(CoreError) as raised:
                session.step()
            self.assertEqual(raised.exception.status, "faulted")
            session.restore(kept)
            self.assertEqual(session.step(), 1)


class Life(unittest.TestCase):
    def test_nothing_reaches_a_closed_session(self):
        session = Session(small())
        kept = session.positions
        snapshot = session.snapshot()
        session.close()
        session.close()
        uses = (session.step, session.snapshot, session.hash, session.share, lambda: session.restore(snapshot),
                lambda: session.submit("tool.grasp", tool="hook"), lambda: session.positions, lambda: session.velocities,
                lambda: session.removed, lambda: session.visible, lambda: session.tools, lambda: session.tick,
                lambda: session.time_s, lambda: session.statistics, lambda: session.scalar("exposure"),
                lambda: session.set_threads(2), lambda: session.read_positions(kept))
        for use in uses:
            with self.assertRaisesRegex(ValueError, "closed"):
                use()
        self.assertTrue(np.isfinite(kept).all())
        self.assertEqual(session.faces.shape, (128, 3))

    def test_a_session_that_is_not_closed_ends_with_its_last_use(self):
        session = Session(small())
        ended = session._end  # pylint: disable=protected-access
        self.assertTrue(ended.alive)
        del session
        gc.collect()
        self.assertFalse(ended.alive)

    def test_it_is_closed_between_the_steps_of_another_thread(self):
        session, begun, ends = Session(small()), threading.Event(), []

        def work():
            try:
                while True:
                    session.step()
                    begun.set()
            except ValueError as error:
                ends.append(str(error))
        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        self.assertTrue(begun.wait(PATIENCE_S))
        session.close()
        for thread in threads:
            thread.join(PATIENCE_S)
        self.assertEqual(ends, ["the session is closed"] * 3)

    def test_other_threads_go_on_during_a_call(self):
        """A scene is built for tens of milliseconds; with Python's lock held, no other thread would run meanwhile."""
        over, ticks = threading.Event(), [0]

        def build():
            for _ in range(3):
                Session(FASCIA).close()
            over.set()
        thread = threading.Thread(target=build)
        thread.start()
        while not over.is_set():
            ticks[0] += 1
            time.sleep(0.001)
        thread.join()
        self.assertGreater(ticks[0], 10)

    def test_python_ends_with_sessions_open_and_in_use(self):
        program = ("import sys, threading, cautery_core\n"
                   "session = cautery_core.Session(sys.argv[1], threads=2)\n"
                   "threading.Thread(target=lambda: session.step(10**9), daemon=True).start()\n"
                   "other = cautery_core.Session(sys.argv[1])\n")
        for _ in range(3):
            done = subprocess.run([sys.executable, "-c", program, FASCIA], timeout=PATIENCE_S, capture_output=True, text=True,
                                  check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_missing_or_strange_library_is_named(self):
        for place, words in (("/nowhere/libcautery-core.so", "cannot be loaded"), ("libm.so.6", "not libcautery-core")):
            done = subprocess.run([sys.executable, "-c", "import cautery_core; cautery_core.Session({})"],
                                  env={**os.environ, "LIBCAUTERY_CORE": place}, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stderr)

    def test_the_block_of_the_readme_runs(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL)
        [block] = [one for one in blocks if "Session(" in one]
        self.assertIn('"deploy/scenes/fascia.json"', block)
        done = subprocess.run([sys.executable, "-c", block.replace("deploy/scenes/fascia.json", FASCIA)], check=True,
                              capture_output=True, text=True)
        self.assertRegex(done.stdout, r"^[1-9]\d* of 6000 faces have parted")


if __name__ == "__main__":
    unittest.main()
