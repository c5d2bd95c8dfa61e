# SPDX-License-Identifier: GPL-3.0-or-later
"""The clients' programs against the real daemon: tissue is cut, meshes are uploaded."""

import json
import os
import signal
import subprocess
import sys
import time
import unittest

import programs

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "server", "mesher"))
import solid_files  # noqa: E402


def sheet(cells, size):
    """A flat square sheet as .obj with texture coordinates."""
    side = cells + 1
    lines = [f"v {size * (i % side) / cells} {size * (i // side) / cells} 0" for i in range(side * side)]
    lines += [f"vt {(i % side) / cells} {(i // side) / cells}" for i in range(side * side)]
    for y in range(cells):
        for x in range(cells):
            a = y * side + x + 1
            b, c, d = a + 1, a + side + 1, a + side
            lines += [f"f {a}/{a} {b}/{b} {c}/{c}", f"f {a}/{a} {c}/{c} {d}/{d}"]
    return "\n".join(lines) + "\n"


class Tissue(programs.Case):
    real = True
    settings = {"browser_deadline_s": 10}  # longer than a loaded machine keeps a driver waiting

    def test_the_script_of_a_scene_cuts_it(self):
        session = self.create("fascia")
        scene = os.path.join(os.environ["SCENES"], "fascia.json")
        script, _ = self.program("cautery-sim", "--scene", scene, "--print-cut")
        first = [line for line in script.splitlines(True) if json.loads(line)["tick"] <= 420]
        result = self.json("run", session, self.path("cut.jsonl", "".join(first)))
        self.assertEqual(result["refused"], 0)
        self.assertGreater(result["faces_gone"], 0)
        self.assertGreater(result["edges_parted"], 0)
        self.assertGreaterEqual(self.json("watch", session, "--seconds", 0.2)["edges_parted"],
                                result["edges_parted"])

    def test_the_teaching_client_cuts(self):
        out, _ = self.program("cautery-teaching", self.daemon.url)
        gone = [int(line.split(" faces gone")[0].split()[-1]) for line in out.splitlines()
                if "faces gone" in line]
        self.assertEqual(gone[0], 0)
        self.assertGreater(gone[-1], 0)
        self.assertEqual(gone, sorted(gone))
        self.assertIn("energy on", out)

    def test_a_simulated_device_feels_the_tissue(self):
        """How still it holds is not judged here: a busy machine makes too few ticks (clients_haptics_fat judges it)."""
        out, _ = self.program("cautery-device", self.daemon.url)
        *reports, last = out.splitlines()
        forces = [float(line.split()[-2]) for line in reports]
        self.assertEqual(forces[0], 0)
        self.assertGreater(max(forces), 0.01)
        self.assertTrue(last.startswith("held with "), last)

    def test_a_mesh_is_uploaded(self):
        file = self.path("Left Knee.obj", sheet(12, 60))
        session = self.create("--mesh", file, "--unit-m", 0.001)
        info = self.json("info", session)
        self.assertEqual(info["summary"]["scene"], "left-knee")
        self.assertEqual(info["summary"]["vertex_count"], 169)
        self.assertEqual(info["triangle_count"], 288)
        self.assertEqual([d["tool"] for d in info["drivers"]], ["ball", "grasper"])
        self.assertAlmostEqual(info["definition"]["tools"][0]["position_m"][0], 0.03, places=4)
        self.assertEqual(len(self.json("ls")["sessions"]), 1)

    def test_a_scene_file_brings_its_mesh(self):
        self.path("flat.obj", sheet(4, 0.05))
        scene = {"name": "flat", "meshes": [{"source": "file", "name": "flat", "file": "flat.obj"}],
                 "layers": [{"kind": "fascia", "name": "fascia", "mesh": "flat"}],
                 "pins": [{"kind": "rim", "layer": "fascia"}]}
        session = self.create("--definition", self.path("flat.json", json.dumps(scene)))
        self.assertEqual(self.json("info", session)["summary"]["vertex_count"], 25)

    def test_the_meshes_of_a_scene_file_are_reported(self):
        """On standard error and in the log, and in the words of a scene file."""
        mend = sheet(4, 0.05).replace("f ", "f 1/1 2/2 2/2\nf ", 1)
        scene = {"name": "flat", "meshes": [{"source": "file", "name": "flat", "file": "mend.obj"}],
                 "layers": [{"kind": "fascia", "name": "fascia", "mesh": "flat"}],
                 "pins": [{"kind": "rim", "layer": "fascia"}]}
        file = self.path("mend.json", json.dumps(scene))
        self.path("mend.obj", mend)
        with open(self.path("log"), "w", encoding="utf-8") as log:
            daemon = programs.Daemon(real=True, log=log, log_level="info")
        self.addCleanup(daemon.stop)
        _, told = self.cautery("create", file, url=daemon.url)
        with open(self.path("log"), encoding="utf-8") as log:
            lines = [line for line in log if "event=mesh_read" in line]
        for report in told, "".join(lines):
            self.assertIn("1 degenerate triangles left out", report)
            self.assertIn("mesh: 25 vertices, 32 triangles", report)
        self.assertEqual(len([line for line in lines if "mesh=flat" in line]), len(lines))
        _, told = self.cautery("create", file, "--strict", code=1)
        self.assertIn("mend.obj: the mesh", told)
        self.assertIn("strict refuses to repair this mesh: 1 degenerate triangles left out", told)
        self.path("mend.obj", sheet(4, 160))
        _, told = self.cautery("create", file, code=1)
        self.assertIn("did you mean millimetres (unit_m 0.001)?", told)

    def test_regions_that_no_mesh_has_are_refused(self):
        file = self.path("parts.obj", sheet(4, 0.05).replace("f ", "usemtl liver\nf ", 1))
        session = self.create(file)
        change = "material", session, "fascia", "thickness_m=0.001", "--region"
        self.cautery(*change, 1)
        _, told = self.cautery(*change, 99, code=1)
        self.assertIn("has no region 99; its regions are: 1", told)

    def test_a_bad_mesh_is_refused(self):
        file = self.path("bad.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        _, told = self.cautery("create", "--mesh", file, code=1)
        self.assertIn("every element is degenerate", told)
        self.assertNotIn("params", told)
        _, told = self.cautery("create", self.path("none.stl", ""), code=4)
        self.assertRegex(told, "none.stl: .*the file is empty")

    def test_a_mesh_needs_no_option(self):
        """By its content, whatever its name; the report says what became of it."""
        file = self.path("LEFT", sheet(4, 0.05).replace("f ", "f 1/1 2/2 2/2\nf ", 1))
        session, told = self.cautery("create", file)
        self.assertIn("1 degenerate triangles left out", told)
        self.assertIn("open surface with 16 edges on its rim", told)
        self.assertIn("a sheet (--as fascia)", told)
        self.assertEqual(self.json("info", session.strip())["triangle_count"], 32)
        _, told = self.cautery("create", file, "--strict", code=1)
        self.assertIn("--strict refuses to repair this mesh: 1 degenerate triangles left out", told)
        _, told = self.cautery("create", file, "--as", "fat", code=1)
        self.assertIn("nothing is inside this surface", told)

    def test_a_unit_is_proposed(self):
        _, told = self.cautery("create", self.path("large.obj", sheet(4, 40)), code=1)
        self.assertIn("did you mean millimetres (--unit-m 0.001)?", told)
        self.assertNotIn("params", told)
        _, told = self.cautery("create", self.path("mean.obj", sheet(4, 8)))
        self.assertIn("--unit-m 0.01 (centimetres, guessed)", told)


def meshers(daemon):
    """Processes of cautery-mesh that a daemon has."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue  # it has ended meanwhile
        if int(parent) == daemon.process.pid and state != "Z":
            found.append(pid)
    return found


def wait_until(holds, seconds=60):
    end = time.monotonic() + seconds
    while not holds() and time.monotonic() < end:
        time.sleep(0.05)
    return holds()


class Solids(programs.Case):
    """What has an inside becomes a solid."""
    real = True

    def test_a_closed_surface_is_filled(self):
        session, told = self.cautery("create", self.file("ball.stl", solid_files.stl(solid_files.ball())))
        for line in ("--unit-m 0.001 (millimetres, guessed)", "surface: 1520 triangles, 1 component, 0 open edges",
                     "solid: ", "least angle between faces", "the surface was filled with tetrahedra (--as fat); it can be a sheet (--as fascia)"):
            self.assertIn(line, told)
        info = self.json("info", session.strip())
        self.assertGreater(info["tetrahedron_count"], 5000)
        self.assertEqual([layer["kind"] for layer in info["definition"]["layers"]], ["fat", "membrane"])

    def test_a_nearly_closed_one_too_and_a_wide_hole_makes_a_sheet(self):
        ball = solid_files.ball()
        _, told = self.cautery("create", self.file("hole.stl", solid_files.stl(ball[40:])), "--as", "fat", "--edge-mm", 6)
        self.assertIn("edge: 6 of a longest side of 40 (asked for)", told)
        _, told = self.cautery("create", self.file("bowl.stl", solid_files.stl(ball[len(ball) // 2:])), "--unit-m", 0.001)
        self.assertIn("the surface became a sheet (--as fascia), as its holes are too wide to fill it", told)
        _, told = self.cautery("create", self.path("sheet.stl"), code=4)
        _, told = self.cautery("create", self.file("ball.stl", solid_files.stl(ball)), "--as", "fascia")
        self.assertIn("mesh: 762 vertices, 1520 triangles", told)

    def test_a_segmentation_is_filled_with_its_names(self):
        """Nothing of its header is kept, said or logged but the names of segments."""
        data = next(data for name, data, *_ in solid_files.CASES if name == "gzip.nrrd")
        with open(self.path("log"), "w", encoding="utf-8") as log:
            daemon = programs.Daemon(real=True, log=log, log_level="debug")
        self.addCleanup(daemon.stop)
        session, told = self.cautery("create", self.file("gzip.nrrd", data), url=daemon.url)
        self.assertIn('regions: 2 "liver" (', told)
        self.assertIn("orientation: the file's axes run to LPS", told)
        info = self.json("info", session.strip(), url=daemon.url)
        self.assertEqual([r["region"] for r in info["definition"]["layers"][0]["regions"]], [2, 7])
        _, only = self.cautery("create", self.path("gzip.nrrd"), "--labels", "7", url=daemon.url)
        self.assertIn('regions: 7 "vena cava" (', only)
        with open(self.path("log"), encoding="utf-8") as log:
            said = log.read() + told + only
        self.assertIn("event=mesh_read", said)
        self.assertNotIn("Jane", said)
        for name in os.listdir(daemon.folder):
            with open(os.path.join(daemon.folder, name), "rb") as file:
                self.assertNotIn(b"Jane", file.read(), name)

    def test_pins_are_at_named_sides(self):
        file = self.file("ball.stl", solid_files.stl(solid_files.ball()))
        session = self.create(file, "--pin", "left,top")
        pins = self.json("info", session)["definition"]["pins"]
        self.assertEqual(len(pins), 2)
        self.assertAlmostEqual(pins[0]["most_m"][0], -0.016, places=3)
        self.assertAlmostEqual(pins[1]["least_m"][2], 0.016, places=3)
        self.assertEqual(self.json("info", self.create(file, "--pin", "none"))["definition"]["pins"], [])
        self.assertIn("'up' is not a side", self.cautery("create", file, "--pin", "up", code=1)[1])

    def test_refusals_have_remedies(self):
        ball = self.file("ball.stl", solid_files.stl(solid_files.ball()))
        cases = {name: data for name, data, *_ in solid_files.CASES}
        segmentation = self.file("raw.nrrd", cases["raw.nrrd"])
        for arguments, words in (((ball, "--edge-mm", 300), "an edge of 300 is longer than the tissue is thick: choose a shorter one"),
                                 ((ball, "--edge-mm", 0.01), "choose a longer one"),
                                 ((ball, "--labels", 1), "this file is not a segmentation"),
                                 ((segmentation, "--labels", 5), "no voxel has label 5"),
                                 ((segmentation, "--as", "fascia"), "a segmentation cannot become a sheet: use it as a solid (--as fat)"),
                                 ((self.file("image.nrrd", cases["image.nrrd"]),), "more than 63 different labels: choose some of them (--labels)"),
                                 ((self.file("short.nrrd", cases["short_file.nrrd"]),), "the file ends early"),
                                 ((self.file("mixed.obj", solid_files.obj(solid_files.turned(solid_files.ball(), 7)).encode()), "--strict"),
                                  "--strict refuses to turn 218 triangles whose normal points inward")):
            with self.subTest(arguments):
                _, told = self.cautery("create", *arguments, code=1)
                self.assertIn(words, told)
                self.assertNotIn("params", told)

    def test_the_command_fills_a_file_without_a_daemon(self):
        file = self.file("ball.stl", solid_files.stl(solid_files.ball()))
        _, told = self.cautery("mesh", file, "--out", self.path("ball.msh"), "--edge", 5, url="ws://127.0.0.1:1")
        self.assertIn("edge: 5 of a longest side of 40 (asked for)", told)
        session, told = self.cautery("create", self.path("ball.msh"))
        self.assertIn("format: Gmsh 2.2", told)
        self.assertGreater(self.json("info", session.strip())["tetrahedron_count"], 1000)
        self.assertIn("nothing is inside", self.cautery("mesh", self.path("flat.obj", sheet(4, 5)), "--out", self.path("flat.msh"), code=3)[1])


class Bounds(programs.Case):
    """Of the process that fills an upload."""
    real = True
    settings = {"mesh_time_s": 600}

    def heavy(self, daemon, edge_mm=0.25):
        """A client whose upload takes seconds to fill."""
        file = self.file("fine.stl", solid_files.stl(solid_files.ball(n=60)))
        command = [os.path.join(programs.PROGRAMS, "cautery"), "--url", daemon.url, "create", file, "--edge-mm", str(edge_mm), "--unit-m", "0.001"]
        return subprocess.Popen(command, env=programs.CLEAN, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def test_it_ends_with_its_client(self):
        client = self.heavy(self.daemon)
        self.assertTrue(wait_until(lambda: meshers(self.daemon)))
        client.kill()
        client.communicate()
        self.assertTrue(wait_until(lambda: not meshers(self.daemon)))
        self.json("ls")

    def test_it_ends_with_its_daemon(self):
        daemon = programs.Daemon(real=True, mesh_time_s=600)
        client = self.heavy(daemon)
        self.assertTrue(wait_until(lambda: meshers(daemon)))
        pid = meshers(daemon)[0]
        daemon.process.send_signal(signal.SIGKILL)
        daemon.kill()
        client.communicate()
        self.assertTrue(wait_until(lambda: not os.path.exists(f"/proc/{pid}")))

    def test_a_daemon_ends_soon_beside_it(self):
        daemon = programs.Daemon(real=True, mesh_time_s=600)
        client = self.heavy(daemon)
        self.assertTrue(wait_until(lambda: meshers(daemon)))
        daemon.stop()
        client.communicate()

    def test_time_is_bounded(self):
        daemon = programs.Daemon(real=True, mesh_time_s=1)
        self.addCleanup(daemon.stop)
        _, told = self.heavy(daemon).communicate()
        self.assertIn("meshing took more than 1 s (setting mesh_time_s): choose a longer edge", told)
        self.json("ls", url=daemon.url)

    @unittest.skipIf(os.environ.get("E2E_SLOW") == "1", "sanitizers reserve more than any bound on memory")
    def test_memory_is_bounded(self):
        daemon = programs.Daemon(real=True, mesh_memory_mb=64, mesh_time_s=600)
        self.addCleanup(daemon.stop)
        for edge_mm in (0.4, 0.55):  # the second where a table of cuts cannot grow
            _, told = self.heavy(daemon, edge_mm).communicate()
            self.assertIn("meshing needs more than 64 MB (setting mesh_memory_mb)", told)
        self.json("ls", url=daemon.url)


class Forces(programs.Case):
    real = True

    def extent(self, session):
        """Least and largest z of the tissue, m."""
        file = self.path("now.obj")
        self.cautery("export", session, file)
        with open(file, encoding="utf-8") as lines:
            heights = [float(line.split()[3]) for line in lines if line.startswith("v ")]
        return min(heights), max(heights)

    def test_tissue_is_pulled_pinned_and_let_go(self):
        session = self.create("fascia", "--paused")
        rest = self.extent(session)
        self.json("force", session, 0, 0, 0.2, "--nearest", "0,0,0")
        self.json("step", session, "--ticks", 40)
        pulled = self.extent(session)
        self.assertGreater(pulled[1], rest[1] + 2e-4)
        self.json("pin", session, "--sphere", "0,0,0,0.004")
        self.json("force", session, 0, 0, 0, "--nearest", "0,0,0")
        self.json("step", session, "--ticks", 40)
        self.assertAlmostEqual(self.extent(session)[1], pulled[1], delta=2e-5)  # it is held there
        self.json("unpin", session, "--sphere", "0,0,0,0.004")
        self.json("step", session, "--ticks", 200)
        self.assertLess(self.extent(session)[1], rest[1] + 1e-4)
        self.json("gravity", session, 0, 0, 9)
        self.assertEqual(self.json("info", session)["definition"]["gravity_m_s2"], [0, 0, 9])

    def test_a_material_is_changed_member_by_member(self):
        session = self.create("fascia", "--paused")
        before = self.json("material", session, "fascia")
        self.assertIn(f"ignition_c={before['ignition_c']:g}",
                      self.cautery("material", session, "fascia")[0].splitlines())
        self.cautery("material", session, "fascia", "ignition_c=250", "limit=range")
        self.cautery("step", session)
        after = self.json("material", session, "fascia")
        self.assertEqual((after["ignition_c"], after["limit"]), (250, "range"))
        self.assertEqual({k: v for k, v in before.items() if k not in ("ignition_c", "limit")},
                         {k: v for k, v in after.items() if k not in ("ignition_c", "limit")})
        for arguments, told in ((("fasca",), "did you mean \"fascia\""),
                                (("fascia", "ignition=2"), "no member \"ignition\""),
                                (("fascia", "ignition_c"), "NAME=VALUE"),
                                (("fascia", "ignition_c=hot"), "ignition_c"),
                                (("fascia", "limit=tight"), "limit")):
            self.assertIn(told, self.cautery("material", session, *arguments, code=2)[1])
        self.assertEqual(self.json("material", session, "fascia"), after)

    def test_which_vertices_must_be_said(self):
        self.create("fascia", "--paused")
        self.assertIn("one of --box", self.cautery("pin", code=2)[1])
        self.assertIn("one of --box", self.cautery("pin", "--rim", "--nearest", "0,0,0", code=2)[1])
        self.assertIn("6 numbers", self.cautery("pin", "--box", "0,0,0,1,1", code=2)[1])
        self.assertIn("4 numbers", self.cautery("pin", "--sphere", "0,0,0,1,1", code=2)[1])
        self.cautery("pin", "--rim", "--layer", "fascia")

    def test_a_scene_file_is_told_by_its_ending(self):
        file = os.path.join(os.environ["SCENES"], "fascia.json")
        self.assertEqual(self.json("info", self.create(file))["summary"]["scene"], "fascia")


class Tools(programs.Case):
    real = True
    settings = {"browser_deadline_s": 2}  # longer than this process can be kept waiting

    def test_actions(self):
        session = self.create("fascia")
        out, _ = self.cautery("tool", session, "needle", "add", "capsule", "move", 0, 0, 0.001, "on",
                              "wait", 5, "line", 0.02, 0, 0.001, 0.1, "off", "give")
        self.assertEqual(out.count("tick"), 5)
        events = self.json("timeline", session)["events"]
        kinds = [e["kind"] for e in events if e.get("tool") == "needle"]
        for kind in ("tool_added", "energy_on", "energy_off"):
            self.assertIn(kind, kinds)
        self.assertNotIn("watchdog", kinds)  # heartbeats kept the energy on beyond the deadline
        tools = {d["tool"]: d for d in self.json("info", session)["drivers"]}
        self.assertEqual(tools["needle"]["client"], 0)
        self.assertFalse(tools["needle"]["energized"])
        moved = [t for t in self.json("watch", session, "--seconds", 0.3)["tools"]
                 if t["tool"] == "needle"][0]
        self.assertAlmostEqual(moved["asked_m"][0], 0.02, places=6)  # single precision
        self.assertAlmostEqual(moved["position_m"][0], 0.02, places=3)  # tissue keeps it back a little

    def test_mistakes(self):
        session = self.create("fascia")
        self.assertIn("no action", self.cautery("tool", session, "hook", "fly", code=2)[1])
        self.assertIn("3 numbers", self.cautery("tool", session, "hook", "move", 1, 2, code=2)[1])
        self.assertIn("shape", self.cautery("tool", session, "a", "add", "spoon", code=2)[1])
        self.assertIn("is not a valid name", self.cautery("tool", session, "A B", "on", code=2)[1])
        self.assertIn("params.tool", self.cautery("tool", session, "nobody", "off", code=1)[1])


if __name__ == "__main__":
    unittest.main()
