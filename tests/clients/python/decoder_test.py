# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package's decoder against the C encoder and decoder: frames of tests/browser/write_frames.c.

WRITE_FRAMES names that program."""

import os
import subprocess
import tempfile
import unittest

import numpy as np

from cautery import BadFrame
from cautery.messages import SCALARS, SECTION
from cautery.stream import Stream
from cautery.vertex_codec import decode_vertices

COLUMNS, ROWS, FRAMES = 40, 25, 24  # as in write_frames.c
VERTICES, FACES = COLUMNS * ROWS, 2 * (COLUMNS - 1) * (ROWS - 1)
CHANNELS = ["positions", "mask", *SCALARS, "tools", "statistics"]
# as cau_default_stream_def has them
DESCRIPTION = {"session": "d1-golden", "session_number": 3, "profile": 1, "epoch": "fedcba9876543210", "rate_hz": 60,
               "channels": CHANNELS, "vertex_count": VERTICES, "face_count": FACES, "origin_m": [0, 0, 0],
               "step_m": 5e-5, "stress_step_pa": 10}


class Decoder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        subprocess.run([os.environ["WRITE_FRAMES"], cls.folder.name], check=True)

    def read(self, name):
        with open(os.path.join(self.folder.name, name), "rb") as file:
            return file.read()

    def expect(self, stream, number):
        """That the stream holds what the C decoder held."""
        state = self.read(f"state-{number:02d}.bin")
        epoch, sequence, tick = np.frombuffer(state, "<u8", 3)
        quantised = np.frombuffer(state, "<i4", 3 * VERTICES, 24).reshape(VERTICES, 3)
        at = 24 + quantised.nbytes
        words = np.frombuffer(state, "<i4", -(-FACES // 32), at)
        at += words.nbytes
        self.assertEqual(stream.place(), (f"{epoch:016x}", sequence))
        seen = stream.wait(timeout_s=0)
        self.assertEqual(seen.tick, tick)
        self.assertTrue(np.array_equal(seen.positions, np.float64(5e-5) * quantised))
        self.assertTrue(np.array_equal(np.flatnonzero(seen.removed),
                                       [i for i in range(FACES) if words[i >> 5] >> (i & 31) & 1]))
        for i, (name, scalar) in enumerate(SCALARS.items()):
            held = np.frombuffer(state, "<u4", VERTICES, at + 4 * VERTICES * i)
            step = scalar.step or DESCRIPTION["stress_step_pa"]
            self.assertTrue(np.allclose(seen.scalars[name], scalar.least + step * held), name)
        return seen

    def test_every_frame_makes_what_the_c_decoder_holds(self):
        stream = Stream(DESCRIPTION)
        kinds = []
        for number in range(FRAMES):
            kinds.append(stream.take(self.read(f"frame-{number:02d}.bin")))
            self.expect(stream, number)
        self.assertEqual(kinds, ["key"] + ["delta"] * (FRAMES - 1))
        self.assertEqual(stream.skipped, 0)

    def test_a_key_frame_makes_what_the_deltas_made(self):
        stream = Stream(DESCRIPTION)
        self.assertEqual(stream.take(self.read(f"key-{FRAMES - 1:02d}.bin")), "key")
        self.expect(stream, FRAMES - 1)

    def test_a_delta_on_another_state_is_skipped(self):
        stream = Stream(DESCRIPTION)
        self.assertEqual(stream.take(self.read("frame-01.bin")), "skipped")
        stream.take(self.read("frame-00.bin"))
        self.assertEqual(stream.take(self.read("frame-02.bin")), "skipped")
        self.expect(stream, 0)
        self.assertEqual(stream.skipped, 2)

    def test_topology_has_faces_layers_and_rest(self):
        stream = Stream(DESCRIPTION)
        self.assertEqual(stream.take(self.read("topology-00.bin")), "topology")
        of = np.arange(FACES)[:, None]
        self.assertTrue(np.array_equal(stream.faces, (7 * of + np.arange(3)) % VERTICES))
        self.assertTrue(np.array_equal(stream.face_layers, np.arange(FACES) % 3))
        self.assertTrue(np.allclose(stream.texture[:, :, 0], 0.25 * of))
        self.assertTrue(np.allclose(stream.texture[:, :, 1], [[0, -0.5, -1]] * FACES))
        self.assertGreater(np.ptp(stream.rest[:, 0]), 0.07)

    def test_tools_and_statistics_are_told(self):
        stream = Stream(DESCRIPTION)
        for number in range(2):
            stream.take(self.read(f"frame-{number:02d}.bin"))
        seen = stream.wait(timeout_s=0)
        self.assertGreaterEqual(len(seen.tools), 1)
        for name, tool in seen.tools.items():
            self.assertEqual(tool.name, name)
            self.assertAlmostEqual(float(np.linalg.norm(tool.rotation)), 1, places=5)
            self.assertAlmostEqual(tool.position_m[0], 0.0005 * seen.tick, places=6)
        self.assertIn("iterations", seen.statistics)

    def test_raw_forces_are_as_sent_or_none(self):  # as tests/protocol/wire/tissue.c sends them
        stream, of = Stream(DESCRIPTION), np.arange(3)
        for number in range(FRAMES):
            stream.take(self.read(f"frame-{number:02d}.bin"))
            seen = stream.wait(timeout_s=0)
            for tool in seen.tools.values():
                if seen.tick % 5 == 4:
                    self.assertEqual((tool.raw_force_n, tool.raw_torque_nm, tool.force_filter_s), (None, None, None))
                    continue
                self.assertTrue(np.array_equal(tool.raw_force_n, 0.125 * (seen.tick + of)))
                self.assertTrue(np.array_equal(tool.raw_torque_nm, -0.0625 * (seen.tick + of)))
                self.assertAlmostEqual(tool.force_filter_s, 0.02 * (seen.tick % 3), places=7)

    def test_vessels_are_as_sent(self):  # as tests/protocol/wire/tissue.c sends them
        stream, found = Stream(DESCRIPTION), 0
        for number in range(FRAMES):
            stream.take(self.read(f"frame-{number:02d}.bin"))
            seen = stream.wait(timeout_s=0)
            self.assertEqual(list(seen.vessels), [] if seen.tick < 8 else ["artery-1"])
            for vessel in seen.vessels.values():
                found += 1
                count = 3 + seen.tick % 2
                self.assertEqual((vessel.parted, vessel.bleeds), (seen.tick % 2 == 1, seen.tick % 32 >= 16))
                self.assertAlmostEqual(vessel.radius_m, 0.0015, places=8)
                self.assertAlmostEqual(vessel.burst_pa, 100 * seen.tick, places=3)
                self.assertAlmostEqual(vessel.shed_m3 * 1e8, seen.tick, places=4)
                self.assertTrue(np.allclose(vessel.points[:, 0], 0.001 * np.arange(count)))
                self.assertTrue(np.allclose(vessel.open, [0.5, -1, 0.5, 0.5][:count]))
        self.assertGreater(found, 0)

    def test_contacts_are_as_sent(self):  # as tests/protocol/wire/tissue.c sends them
        stream, found = Stream(DESCRIPTION), 0
        for number in range(FRAMES):
            stream.take(self.read(f"frame-{number:02d}.bin"))
            seen = stream.wait(timeout_s=0)
            self.assertEqual(list(seen.contacts), [] if seen.tick < 8 else ["hook"])
            for contact in seen.contacts.values():
                found += 1
                self.assertEqual(contact.valid, seen.tick % 4 != 3)
                self.assertEqual(contact.asked_position_m.tolist(), [0.5, 0.25, -0.125 * seen.tick])
                self.assertEqual(contact.rotation.tolist(), [0.5] * 4)
                self.assertEqual(contact.force_n.tolist(), [0.125, -0.25, 0.5 * seen.tick])
                self.assertEqual(contact.compliance_m_n.tolist(), [[1, 0.125, 0.25], [0.125, 2, 0.5], [0.25, 0.5, 3]])
                self.assertEqual((contact.friction, contact.damping_ns_m), (0.25, 0.5))
                self.assertEqual(contact.grasp_n_m, 256 * (seen.tick % 2))
                self.assertEqual(contact.grasp_anchor_m.tolist(), [1, 2, 0.5 * seen.tick])
                self.assertEqual(contact.normals.tolist(), [[0, 0, 1], [0, 1, 0]][:seen.tick % 3])
                self.assertEqual(contact.offsets_m.tolist(), [0.25 * seen.tick] * (seen.tick % 3))
                self.assertEqual(contact.velocities_m_s.tolist(), [0, -0.5][:seen.tick % 3])
        self.assertGreater(found, 0)

    def test_spoilt_frames_raise_and_nothing_else(self):
        whole = {name: self.read(name) for name in ("frame-00.bin", "topology-00.bin")}
        random = np.random.default_rng(7)
        refused = 0
        for _ in range(600):
            name = ("frame-00.bin", "topology-00.bin")[random.integers(2)]
            spoilt = bytearray(whole[name])
            for at in random.integers(len(spoilt), size=random.integers(1, 4)):
                spoilt[at] = random.integers(256)
            if random.integers(3) == 0:
                del spoilt[random.integers(len(spoilt)):]
            try:
                Stream(DESCRIPTION).take(bytes(spoilt))
            except (BadFrame, ValueError, IndexError, KeyError):  # what the client takes for a bad frame
                refused += 1
            except Exception as error:  # pylint: disable=broad-except
                self.fail(f"{name}: {error!r}")
        self.assertGreater(refused, 100)


class Codec(unittest.TestCase):
    def test_what_is_no_packed_data_is_refused(self):
        for data in (b"", b"\xa0", b"\xa1" + bytes(64), b"\xa0" + bytes(64)):
            with self.assertRaises(BadFrame):
                decode_vertices(data, 100, 8)

    def test_one_vertex_is_the_tail(self):
        # a header of one group of zeros for each of four bytes, then the tail, whose end is the first vertex
        data = b"\xa0" + bytes(4) + bytes(28) + b"\x01\x02\x03\x04"
        self.assertEqual(decode_vertices(data, 1, 4).tolist(), [[1, 2, 3, 4]])


class Sections(unittest.TestCase):
    def test_every_scalar_has_a_section_of_its_own(self):
        self.assertEqual(len({scalar.section for scalar in SCALARS.values()}), len(SCALARS))
        self.assertTrue(all(SECTION[name] == scalar.section for name, scalar in SCALARS.items()))


if __name__ == "__main__":
    unittest.main()
