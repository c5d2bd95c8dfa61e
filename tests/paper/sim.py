# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs cautery-sim on scenes that are shipped, or made from them."""

import csv
import glob
import json
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import vtu

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))


@dataclass
class Run:
    """What a run gave: `result` as --json has it, `ticks` as --csv has them, `states` and the tools' `tips` by tick."""

    result: dict
    ticks: list
    states: dict
    tips: dict


def at_once(jobs):
    """What each job returns, in their order; as many at a time as there are processors."""
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        return [future.result() for future in [pool.submit(job) for job in jobs]]


def printed(sim, program, *arguments, check=True, environment=None):
    """What a program of the tests prints; with `check` it must succeed."""
    command = [os.path.join(os.path.dirname(os.path.dirname(sim.program)), "tests", program), *arguments]
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=check,
                          env=os.environ | (environment or {})).stdout


def table(sim, program, *arguments):
    """The CSV that it prints, as numbers by column."""
    return [{name: float(value) for name, value in row.items()}
            for row in csv.DictReader(printed(sim, program, *arguments).splitlines())]


class Sim:
    """cautery-sim; the programs beside it are found by where it is."""

    def __init__(self, program):
        self.program = os.path.abspath(program)

    @staticmethod
    def scene(name):
        with open(os.path.join(ROOT, "deploy", "scenes", f"{name}.json"), encoding="utf-8") as file:
            return json.load(file)

    def run(self, scene, script=None, states_every=None, cut=False, seconds=None):
        """`scene` and the commands of `script` as in their files; `states_every` in ticks."""
        with tempfile.TemporaryDirectory() as folder:
            return self._run(folder, scene, script, states_every, cut, seconds)

    def _run(self, folder, scene, script, states_every, cut, seconds):
        path = os.path.join(folder, f"{scene['name']}.json")
        table = os.path.join(folder, "ticks.csv")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        command = [self.program, "--scene", path, "--json", "--csv", table]
        if script is not None:
            with open(os.path.join(folder, "script.jsonl"), "w", encoding="utf-8") as file:
                file.writelines(json.dumps(line) + "\n" for line in script)
            command += ["--script", file.name]
        if states_every:
            command += ["--vtu", os.path.join(folder, "states"), "--vtu-every", str(states_every)]
        command += ["--cut"] if cut else []
        command += ["--seconds", str(seconds)] if seconds is not None else []
        answer = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        with open(table, encoding="utf-8", newline="") as file:
            ticks = list(csv.DictReader(file))
        states = {int(os.path.basename(name)[7:-4]): vtu.read(name)
                  for name in sorted(glob.glob(os.path.join(folder, "states", "tissue-*.vtu")))}
        tips = {int(os.path.basename(name)[6:-4]): vtu.read_tips(name)
                for name in sorted(glob.glob(os.path.join(folder, "states", "tools-*.vtu")))}
        return Run(json.loads(answer.stdout.splitlines()[-1]), ticks, states, tips)
