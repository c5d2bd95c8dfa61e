# SPDX-License-Identifier: GPL-3.0-or-later
"""The conformance suite: the project's clients pass it, and a client with one planted fault fails it.

GOLDEN names the program that writes golden frames; the rest is as tests/clients/e2e/programs.py has it."""

import os
import subprocess
import sys
import tempfile
import unittest

from programs import PATIENCE_S, Daemon

HERE = os.path.dirname(os.path.abspath(__file__))
# Each fault of reference_client.py, with the check that must find it.
GOLDEN_FAULTS = {
    "any_base": "deltas_after_a_gap", "any_epoch": "other_epochs", "any_stream": "other_streams",
    "keeps": "bad_frames", "late": "golden_streams", "mask_order": "golden_streams", "no_names": "golden_streams",
    "no_previous": "golden_streams", "old_key": "older_key_frames", "only_known": "unknown_sections",
    "swallows_bad": "cut_frames", "unsigned": "golden_streams"}
LIVE_FAULTS = {
    "cuts_files": "files", "mixes_answers": "answers_by_id", "stays_behind": "a_cut", "swallows_errors": "requests"}


class Suite(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.golden = folder.name
        subprocess.run([os.environ["GOLDEN"], cls.golden], check=True)
        cls.daemon = Daemon(real=True)
        cls.addClassCleanup(cls.daemon.stop)

    def run_suite(self, adapter, *fault, live, only=()):
        command = [sys.executable, "-B", os.path.join(HERE, "client.py"), "--golden", self.golden]
        command += ["--url", self.daemon.url] if live else []
        command += [f"--only={check}" for check in only]
        command += ["--", sys.executable, "-B", os.path.join(HERE, adapter), *fault]
        return subprocess.run(command, text=True, capture_output=True, timeout=PATIENCE_S, check=False)

    def test_clients_pass(self):
        for adapter in ("reference_client.py", "python_client.py"):
            with self.subTest(adapter):
                done = self.run_suite(adapter, live=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
                self.assertIn("1..13", done.stdout)

    def test_the_daemon_passes(self):
        done = subprocess.run([sys.executable, "-B", os.path.join(HERE, "server.py"), self.daemon.url], text=True,
                              capture_output=True, timeout=PATIENCE_S, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertIn("1..10", done.stdout)

    def test_each_planted_fault_is_found(self):
        for faults, live in ((GOLDEN_FAULTS, False), (LIVE_FAULTS, True)):
            for fault, check in faults.items():
                with self.subTest(fault):
                    done = self.run_suite("reference_client.py", fault, live=live, only=[check])
                    self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                    self.assertRegex(done.stdout, rf"(?m)^not ok \d+ {check}: ")


if __name__ == "__main__":
    unittest.main()
