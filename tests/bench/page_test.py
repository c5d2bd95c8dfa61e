# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of one machine are merged and compared, runs of two are refused; the page's line names it."""

import copy
import json
import os
import subprocess
import sys
import tempfile
import unittest

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, FOLDER)
sys.dont_write_bytecode = True
import machine  # noqa: E402
import page  # noqa: E402

EPYC = {"vendor": "AuthenticAMD", "name": "AMD EPYC", "family": 25, "model": 17, "stepping": 1, "mhz_most": None,
        "mhz_present": 2596.13, "cores": 2, "caches": {"L1d": 32768, "L2": 1048576, "L3": 33554432},
        "load_before": 0.1, "others": 0.01, "steal": 0.0, "instruction_set": "avx512"}
SILENT = {**EPYC, "vendor": None, "name": None, "family": None, "model": None, "stepping": None,
          "mhz_present": None, "caches": {}, "load_before": None, "others": None, "steal": None}


class Fake(page.Bench):
    """A bench whose runs take as many milliseconds as it is told."""

    def __init__(self, where, ms):
        super().__init__(None, 300)
        for scene in page.SCENES:
            for threads in (1, 2):
                self.runs.append({"arguments": [scene, threads, None], "result": {"ms_median": ms, "machine": where}})


def compared(before, after):
    with tempfile.TemporaryDirectory() as folder:
        names = [os.path.join(folder, name) for name in ("before", "after")]
        before.keep(names[0])
        after.keep(names[1])
        return subprocess.run([sys.executable, "-B", os.path.join(FOLDER, "page.py"), "--compare", *names],
                              capture_output=True, text=True, check=False)


class Machines(unittest.TestCase):
    def test_one_machine_is_compared(self):
        moved = {**EPYC, "mhz_present": 2601.0, "load_before": 1.5, "steal": 0.01}
        ended = compared(Fake(EPYC, 4.0), Fake(moved, 2.0))
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertIn("| `fat` | 2 | 4.000 | 2.000 | 0.50 |", ended.stdout)

    def test_each_difference_is_refused_and_named(self):
        others = {"vendor": "GenuineIntel", "name": "AMD EPYC 9R14", "family": 26, "model": 1, "stepping": 2,
                  "mhz_most": 3700.0, "cores": 4, "caches": {"L1d": 32768}, "instruction_set": "avx2"}
        self.assertEqual(set(others), set(machine.IDENTITY))
        for name, value in others.items():
            ended = compared(Fake(EPYC, 4.0), Fake({**EPYC, name: value}, 2.0))
            self.assertNotEqual(ended.returncode, 0, name)
            self.assertIn(f"runs of two machines: {name}: ", ended.stderr)
            self.assertEqual(ended.stdout, "")

    def test_runs_that_do_not_name_their_machine_are_refused(self):
        ended = compared(Fake(SILENT, 4.0), Fake(SILENT, 2.0))
        self.assertIn("do not say which machine", ended.stderr)

    def test_a_run_among_others_is_found_out(self):
        bench = Fake(EPYC, 4.0)
        bench.runs[3] = copy.deepcopy(bench.runs[3])
        bench.runs[3]["result"]["machine"]["model"] = 1
        with self.assertRaisesRegex(ValueError, "two machines: model: 17 and 1"):
            page.check_machines([bench])

    def test_kept_runs_are_given_in_their_order(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "kept")
            bench = Fake(EPYC, 4.0)
            bench.runs[0]["result"]["round"] = 1
            bench.runs.append({"arguments": ["fascia", 1, None], "result": {"round": 2, "machine": EPYC}})
            bench.runs.append({"arguments": ["fat", 1, None, "--scaling"], "result": {"round": 3, "machine": EPYC}})
            bench.keep(name)
            kept = page.Kept(name)
            self.assertEqual([kept.run("fascia", 1)["round"], kept.run("fascia")["round"]], [1, 2])
            self.assertEqual(kept.run("fat", 1, None, "--scaling")["round"], 3)
            with self.assertRaisesRegex(ValueError, "has no run of"):
                kept.run("fascia", 1)
            with open(name, encoding="utf-8") as file:
                self.assertEqual(json.load(file)["steps"], 300)


class Line(unittest.TestCase):
    def test_it_names_everything(self):
        text = machine.line([EPYC, {**EPYC, "others": 0.04, "load_before": 0.3}])
        for part in ("AMD EPYC (AuthenticAMD)", "family 25", "model 17", "stepping 1", "2596 MHz", "2 cores",
                     "L1d 32 KiB", "L2 1 MiB", "L3 32 MiB", "avx512", "load before it 0.30", "4.0 %", "steal 0.0 %"):
            self.assertIn(part, text)
        self.assertNotIn("not idle", text)

    def test_it_flags_a_busy_machine(self):
        self.assertIn("not idle", machine.line([EPYC, {**EPYC, "others": 0.2}]))
        self.assertIn("not idle", machine.line([EPYC, {**EPYC, "steal": 0.1}]))

    def test_it_says_what_is_not_told(self):
        text = machine.line([SILENT])
        for part in ("processor not named", "clock not told", "caches not told", "load before it unknown",
                     "unknown of the cores' time", "steal unknown"):
            self.assertIn(part, text)


if __name__ == "__main__":
    unittest.main()
