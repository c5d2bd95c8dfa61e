# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 7 by the real viewer: its cuts, run by a daemon of the build and looked at in headless Chromium."""

import json
import os
import subprocess
import tempfile

import dissection
from sim import ROOT

# Azimuth and elevation in degrees, distance and target in mm: obliquely, as the paper looks, the cut from left to right.
CAMERAS = {"x": "-90,55,140,0,0,0", "y": "0,55,140,0,0,0"}
WEB = os.path.join(ROOT, "clients", "web")
PICTURES = "pictures"  # in this folder
MOST_BYTES = 200_000  # of a picture


def file_stem(name):
    return f"figure-7-{name.replace(', ', '-')}"


def commands_of(sim, scene, folder):
    path = os.path.join(folder, "scene.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(scene, file)
    printed = subprocess.run([sim.program, "--scene", path, "--print-cut"], stdout=subprocess.PIPE, text=True, check=True)
    return [json.loads(line) for line in printed.stdout.splitlines()]


def job(sim, folder, pictures):
    """What pictures.test.ts reads: the cuts of figure 7, at the times of its drawing."""
    cuts = []
    for name, make, way, _ in dissection.CASES:
        scene = make(sim)
        ticks = [dissection.ticks_of(scene) * k // dissection.STATES for k in dissection.DRAWN]
        cuts.append({"name": file_stem(name), "scene": scene, "camera": CAMERAS[way],
                     "commands": commands_of(sim, scene, folder), "ticks": ticks})
    return {"folder": pictures, "cuts": cuts}


def npm(*arguments, **environment):
    """Runs a script of the viewer's package; what it printed is told where it fails."""
    done = subprocess.run(["npm", "run", "--silent", *arguments], cwd=WEB, env=os.environ | environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode:
        raise OSError(f"npm run {arguments[0]} failed: {done.stdout[-2000:]}")


def run(sim, folder, _quick):
    pictures = os.path.join(folder, PICTURES)
    os.makedirs(pictures, exist_ok=True)
    if not os.path.isdir(os.path.join(WEB, "node_modules", "vite")):
        raise OSError("no packages in clients/web/node_modules (npm ci there installs them)")
    npm("build")
    with tempfile.TemporaryDirectory() as work:
        path = os.path.join(work, "job.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(job(sim, work, pictures), file)
        npm("browser", "--", "--dir", folder, CAUTERY_PAPER_JOB=path,
            CAUTERYD=os.path.join(os.path.dirname(sim.program), "cauteryd"))
    cases = [(name, dissection.ticks_of(make(sim))) for name, make, _, _ in dissection.CASES]
    for name, _ in cases:
        for k in range(len(dissection.DRAWN)):
            size = os.path.getsize(os.path.join(pictures, f"{file_stem(name)}-{k + 1}.png"))
            if size > MOST_BYTES:
                raise ValueError(f"{file_stem(name)}-{k + 1}.png has {size} bytes")
    return {}, cases


def page(cases):
    rows = []
    for name, ticks in cases:
        times = [ticks * k // dissection.STATES / dissection.STEPS_PER_S for k in dissection.DRAWN]
        rows.append(" | ".join(["", name, *(f"![{name}, {time:.0f} s]({PICTURES}/{file_stem(name)}-{k + 1}.png)"
                                            for k, time in enumerate(times)), ""]).strip())
    return f"""### Figure 7 by the viewer

`cauteryd` runs the same four cuts command by command. The viewer ([clients/web](../../clients/web/README.md)) shows
them obliquely, in headless Chromium, at the times of the drawing above. From the same states the viewer also draws char in
blotches, and fringes of torn fibres along a lip. It adds the surroundings. Only the daemon decides which tissue
exists. Figures 4 to 6 are drawings, because pictures of the viewer would not show single triangles and motions of a
millimetre better. As in the paper's figure 7, the fascia gapes and the fat opens with its membrane drawn back.

| | cutting | | | at rest |
|---|---|---|---|---|
{chr(10).join(rows)}
"""
