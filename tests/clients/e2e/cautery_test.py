# SPDX-License-Identifier: GPL-3.0-or-later
"""cautery, the command line, against a daemon whose tissue is a double."""

import json
import os
import re
import signal
import socket
import subprocess
import threading
import time
import unittest
import urllib.parse

import programs


def script(*commands):
    return "".join(json.dumps(command) + "\n" for command in commands)


def move(tick, x, tool="hook"):
    return {"tick": tick, "command": "tool.move", "tool": tool, "position_m": [x, 0, 0],
            "rotation": [1, 0, 0, 0], "jaw": 0}


def energize(tick, on, tool="hook"):
    return {"tick": tick, "command": "tool.energize", "tool": tool, "energized": on}


class Sessions(programs.Case):
    def test_life_of_a_session(self):
        session = self.create("fascia", "--name", "knee")
        self.assertEqual(session, "d1-knee")
        listed = self.json("ls")["sessions"]
        self.assertEqual([(s["session"], s["scene"]) for s in listed], [("d1-knee", "fascia")])
        self.assertIn("d1-knee", self.cautery("ls")[0])
        self.assertEqual(self.json("info")["summary"]["session"], "d1-knee")  # the only one
        self.assertIn("tool hook", self.cautery("info", session)[0])
        self.assertIn("fascia ", self.cautery("scenes")[0])

    def test_time(self):
        session = self.create("fascia", "--paused")
        first = self.json("info", session)["summary"]
        self.assertEqual(first["state"], "paused")
        self.assertEqual(self.json("step", session, "--ticks", 5)["tick"], first["tick"] + 5)
        self.assertEqual(self.json("speed", session, 0.5)["speed"], 0.5)
        self.assertEqual(self.json("resume", session)["state"], "running")
        self.assertEqual(self.json("pause", session)["state"], "paused")
        self.assertEqual(self.json("reset", session)["tick"], 0)

    def test_history(self):
        session = self.create("fascia", "--paused")
        self.cautery("step", session, "--ticks", 20)
        self.assertEqual(self.json("snapshot", session, "--name", "before")["tick"], 20)
        self.cautery("step", session, "--ticks", 20)
        self.assertEqual(self.json("restore", session, "before")["tick"], 20)
        back = self.json("rewind", session, 10)
        self.assertEqual(back["tick"], 10)
        named = self.json("snapshots", session)["snapshots"]
        self.assertEqual(named, [{"name": "before", "tick": 20, "branch": 0}])
        self.assertIn("20  before, branch 0", self.cautery("snapshots", session)[0])
        kinds = [e["kind"] for e in self.json("timeline", session)["events"]]
        self.assertIn("rewind", kinds)
        fork = self.json("fork", session, "--name", "twin", "--paused")
        self.addCleanup(self.cautery, "rm", "d1-twin")
        self.assertEqual(fork["summary"]["session"], "d1-twin")
        self.assertEqual(fork["summary"]["tick"], 10)

    def test_the_session_must_be_said_where_there_are_two(self):
        self.create("fascia", "--name", "one")
        self.create("fascia", "--name", "two")
        self.assertIn("2 sessions", self.cautery("pause", code=2)[1])


class Backups(programs.Case):
    def test_a_copy_is_a_store(self):
        self.cautery("create", "fascia", "--name", "kept", "--paused")
        said = self.cautery("backup", "evening")[0]
        file, size = re.fullmatch(r"(.*/backups/evening\.db): (\d+) bytes\n", said).groups()
        self.assertEqual(os.path.getsize(file), int(size))
        self.assertEqual(file, os.path.join(self.daemon.folder, "backups", "evening.db"))
        self.assertIn("a file of this name exists", self.cautery("backup", "evening", code=1)[1])
        made = self.json("backup")
        self.assertGreater(made["byte_count"], 0)
        self.cautery("create", "fascia", "--name", "later", "--paused")
        restored = programs.Daemon(store=file)
        try:
            listed = self.cautery("ls", url=restored.url)[0]
            self.assertIn("d1-kept", listed)
            self.assertNotIn("d1-later", listed)
        finally:
            restored.stop()

    def test_usage(self):
        self.cautery("backup", "x" * 49, code=2)
        self.cautery("backup", "a", "b", code=2)


class Scripts(programs.Case):
    settings = {"browser_deadline_s": 5}  # the watchdog is not what is tested here

    def test_a_script_cuts(self):
        session = self.create("fascia")
        self.cautery("speed", session, 0.25)  # eight ticks of lead are half a second then
        file = self.path("cut.jsonl", script(move(1, -0.02), energize(5, True), move(20, 0),
                                             move(40, 0.02), energize(60, False)))
        result = self.json("run", session, file)
        self.assertEqual((result["commands"], result["sent"], result["refused"]), (5, 5, 0))
        self.assertEqual(result["late"], 0)
        self.assertGreater(result["faces_gone"], 0)
        self.assertGreaterEqual(result["last_tick"] - result["first_tick"], 60)
        # What was applied is what the log has, at the script's distances.
        log = self.path("log.jsonl")
        self.cautery("log", session, log)
        with open(log, encoding="utf-8") as lines:
            logged = [json.loads(line) for line in lines]
        ticks = [c["tick"] for c in logged if c["command"] == "tool.energize"]
        self.assertEqual(ticks[1] - ticks[0], 55)

    def test_progress_is_told(self):
        session = self.create("fascia")
        file = self.path("long.jsonl", script(*[move(10 * i, 0.0001 * i) for i in range(10)]))
        out, told = self.cautery("run", session, file)
        self.assertIn("10 commands, 0 refused", out)
        self.assertIn("running 50 %", told)

    def test_standard_input(self):
        self.create("fascia")
        result = self.json("run", "-", input=script(move(1, 0)))
        self.assertEqual(result["sent"], 1)

    def test_refused_commands_are_told_by_line(self):
        session = self.create("fascia")
        file = self.path("bad.jsonl", script(move(1, 0), energize(2, False, "nobody"), move(4, 0), {
            "command": "tool.add", "tick": 5, "name": "hook", "shape": "hook"}))
        out, told = self.cautery("run", session, file, code=5)
        self.assertIn("2 refused", out)
        self.assertIn("line 2: params.tool", told)
        self.assertIn("line 4: ", told)
        self.assertNotIn("line 3", told)

    def test_a_script_that_cannot_be_read(self):
        session = self.create("fascia")
        file = self.path("broken.jsonl", script(move(1, 0)) + "{\"command\": \"fly\"}\n")
        self.assertIn("line 2", self.cautery("run", session, file, code=4)[1])
        self.assertIn("the script has no command", self.cautery("run", session, os.devnull, code=4)[1])
        self.cautery("run", session, self.path("absent.jsonl"), code=4)

    def test_a_paused_session_is_not_waited_for(self):
        session = self.create("fascia", "--paused")
        file = self.path("one.jsonl", script(move(1, 0)))
        self.assertIn("paused", self.cautery("run", session, file, code=1)[1])


class Silence(programs.Case):
    settings = {"browser_deadline_s": 1}

    def test_a_script_that_lost_its_energy_says_so(self):
        session = self.create("fascia")
        file = self.path("held.jsonl", script(move(1, -0.02), energize(2, True), move(200, 0.02)))
        running = subprocess.Popen(
            [os.path.join(programs.PROGRAMS, "cautery"), "run", session, file, "--json", "--url",
             self.daemon.url], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.await_event(session, "energy_on")
        running.send_signal(signal.SIGSTOP)  # no sign of life any more, as from a laptop that sleeps
        self.await_event(session, "watchdog")
        running.send_signal(signal.SIGCONT)
        out, told = running.communicate(timeout=programs.PATIENCE_S)
        self.assertEqual(running.returncode, 5, told)
        self.assertEqual(json.loads(out.splitlines()[-1])["watchdog_cuts"], 1)
        self.assertIn("the watchdog turned off the energy of `hook`", told)

    def await_event(self, session, kind):
        deadline = time.monotonic() + programs.PATIENCE_S
        while kind not in [e["kind"] for e in self.json("timeline", session)["events"]]:
            self.assertLess(time.monotonic(), deadline, kind)
            time.sleep(0.05)  # before it is asked again


class Streams(programs.Case):
    def test_watch_tells_the_same_as_text_and_json(self):
        session = self.create("fascia")
        out, _ = self.cautery("watch", session, "--seconds", 2, "--rate", 5)
        self.assertGreaterEqual(len(out.splitlines()), 4)
        for word in ("tick", "rate", "moved", "gone", "parted"):
            self.assertIn(word, out.splitlines()[0])
        lines = [json.loads(line) for line in
                 self.cautery("watch", session, "--seconds", 1, "--rate", 5, "--json")[0].splitlines()]
        ticks = [line["tick"] for line in lines]
        self.assertEqual(ticks, sorted(ticks))
        self.assertGreater(ticks[-1], ticks[0])

    def test_a_recording_decodes_to_its_end(self):
        session = self.create("fascia")
        file = self.path("stream.bin")
        recorded = self.json("record", session, file, "--seconds", 1)
        self.assertGreater(recorded["frames"], 10)
        watched = self.json("watch", "--recording", file)
        self.assertEqual(watched["tick"], recorded["last_tick"])
        with open(file, "r+b") as stream:
            stream.seek(-20, os.SEEK_END)
            stream.truncate()
        self.assertIn("truncated", self.cautery("watch", "--recording", file, code=4)[1])

    def test_a_recording_as_mcap_ends_whole(self):
        session = self.create("fascia")
        file = self.path("scene.mcap")
        recorded = self.json("record", session, file, "--mcap", "--seconds", 1)
        self.assertGreater(recorded["messages"], 2)
        with open(file, "rb") as stream:
            content = stream.read()
        self.assertEqual(len(content), recorded["bytes"])
        self.assertEqual((content[:8], content[-8:]), (b"\x89MCAP0\r\n",) * 2)
        self.assertEqual(content.count(b'{"deletions":['), recorded["messages"])

    def test_watch_comes_back_after_a_crash(self):
        daemon = programs.Daemon(checkpoint_s=0.2)
        self.cautery("create", "fascia", "--name", "knee", url=daemon.url)
        watch = subprocess.Popen(
            [os.path.join(programs.PROGRAMS, "cautery"), "watch", "--url", daemon.url, "--rate", "20",
             "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("tick", watch.stdout.readline())
        daemon.kill()
        self.assertIn("is lost", watch.stderr.readline())
        again = programs.Daemon(port=daemon.port, store=daemon.store)
        self.addCleanup(again.stop)
        self.assertIn("connected again", watch.stderr.readline())
        while "\"paused\":false" not in watch.stdout.readline():
            self.assertIsNone(watch.poll())
        watch.send_signal(signal.SIGINT)
        self.assertEqual(watch.wait(programs.PATIENCE_S), 0)
        watch.stdout.close()
        watch.stderr.close()

    def test_watch_ends_with_its_session(self):
        session = self.cautery("create", "fascia")[0].strip()
        watch = subprocess.Popen(
            [os.path.join(programs.PROGRAMS, "cautery"), "watch", session, "--url", self.daemon.url],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("tick", watch.stdout.readline())
        self.cautery("rm", session)
        _, told = watch.communicate(timeout=programs.PATIENCE_S)
        self.assertEqual(watch.returncode, 1)
        self.assertIn("no longer exists", told)

    def test_export(self):
        session = self.create("fascia")
        for ending, start in (("obj", "#"), ("vtu", "<?xml")):
            file = self.path("tissue." + ending)
            self.cautery("export", session, file)
            with open(file, encoding="utf-8") as text:
                self.assertTrue(text.read().startswith(start), ending)
        self.cautery("export", session, self.path("tissue.stl"), code=2)
        self.cautery("export", session, self.path("no/such/folder.obj"), code=4)
        out, _ = self.cautery("export", session, "-", "--format", "obj")
        self.assertIn("\nv ", out)


class Ends(programs.Case):
    def test_exit_codes(self):
        for arguments, code in ((("--help",), 0), (("ls",), 0), (("info", "d1-none"), 1),
                                (("create", "no-such-scene"), 1), ((), 2), (("ls", "--fast"), 2),
                                (("create",), 2), (("speed", "d1-none", "fast"), 2),
                                (("ls", "--url", "somewhere"), 2),
                                (("ls", "--url", "ws://127.0.0.1:1"), 3),
                                (("create", "--definition", "/nowhere/at/all.json"), 4)):
            with self.subTest(arguments=arguments):
                self.cautery(*arguments, code=code)

    def test_errors_are_json_too(self):
        error = self.json("info", "d1-none", code=1)["error"]
        self.assertEqual(error["path"], "params.session")
        self.assertTrue(error["reason"])

    def test_a_token_is_made_and_used_and_expires(self):
        secret, brief = self.path("anna.token"), self.path("brief.token")
        lines = self.cautery("token", "operate", "--name", "anna", "--days", "1", "--out", secret)[0]
        lines += self.cautery("token", "view", "--days", "0.001", "--out", brief)[0]  # 86 s
        with open(secret, encoding="ascii") as file:
            token = file.read().strip()
        self.assertEqual(os.stat(secret).st_mode & 0o777, 0o600)
        self.assertNotIn(token, lines)
        tokens = self.path("tokens", lines)
        os.chmod(tokens, 0o600)
        daemon = programs.Daemon(tokens=tokens)
        self.addCleanup(daemon.stop)
        self.cautery("create", "fascia", "--token-file", secret, url=daemon.url)
        self.cautery("ls", "--token-file", brief, url=daemon.url)
        self.cautery("create", "fascia", "--token-file", brief, url=daemon.url, code=1)
        self.program("cautery-load", "--seconds", "0.5", "--warm-up", "0", "--token-file", secret, url=daemon.url)
        self.program("cautery-load", "--token", token, url=daemon.url, code=2)
        # what stands there already may be in somebody's hands
        self.cautery("token", "view", "--out", secret, code=4)
        self.assertIn("did you mean", self.cautery("token", "opperate", "--out", self.path("x"), code=2)[1])
        self.cautery("token", "view", code=2)

    def test_a_token_may_be_for_some_sessions(self):
        line, _ = self.cautery("token", "operate", "--sessions", "d1-a-*,d1-b", "--quota", 60, "--out", self.path("some.token"))
        self.assertRegex(line, r"^operate sha256:[0-9a-f]{64} sessions=d1-a-\*,d1-b quota=60\n$")
        for wrong in ("", "a,,b", "a,", "*a", "a b", "x" * 152):
            self.cautery("token", "operate", "--sessions", wrong, "--out", self.path("wrong.token"), code=2)
        self.assertFalse(os.path.exists(self.path("wrong.token")))
        self.cautery("token", "operate", "--quota", 0, "--out", self.path("wrong.token"), code=2)

    def test_tokens(self):
        tokens = self.path("tokens", "view watcher-token-0123456789\nadmin master-token-0123456789\n")
        os.chmod(tokens, 0o600)
        daemon = programs.Daemon(tokens=tokens)
        self.addCleanup(daemon.stop)
        wrong = self.path("wrong", "wrong\n")
        watcher = self.path("watcher", "watcher-token-0123456789\n")
        master = self.path("master", "master-token-0123456789")
        self.cautery("ls", url=daemon.url, code=1)
        self.cautery("ls", "--token-file", wrong, url=daemon.url, code=1)
        self.cautery("ls", "--token-file", watcher, url=daemon.url)
        self.cautery("create", "fascia", "--token-file", watcher, url=daemon.url, code=1)
        self.cautery("create", "fascia", "--token-file", master, url=daemon.url)
        self.assertIn("the first line of the file has no token", self.cautery(
            "ls", "--token-file", self.path("empty", "\n"), url=daemon.url, code=4)[1])
        self.cautery("ls", "--token-file", self.path("nowhere"), url=daemon.url, code=4)
        # for every user of the machine to see
        self.assertIn("--token-file", self.cautery("ls", "--token", "x", url=daemon.url, code=2)[1])


def pass_on(listening, port):
    """Passes each connection's request on to the daemon at `port` and its answer back."""
    while True:
        try:
            client, _ = listening.accept()
        except OSError:
            return  # closed: the test is over
        with client, socket.create_connection(("127.0.0.1", port)) as daemon:
            daemon.sendall(client.recv(65536))
            for part in iter(lambda: daemon.recv(65536), b""):
                client.sendall(part)


class Refusals(programs.Case):
    def test_a_refused_handshake_is_shown_with_its_reason(self):
        # By another port than its own the daemon is not what the Host header names.
        listening = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(listening.close)
        self.addCleanup(listening.shutdown, socket.SHUT_RDWR)
        port = urllib.parse.urlsplit(self.daemon.url).port
        threading.Thread(target=pass_on, args=(listening, port), daemon=True).start()
        url = f"ws://127.0.0.1:{listening.getsockname()[1]}"
        told = r"the server answered HTTP 421: the Host header does not name this daemon \(setting hosts\)"
        self.assertRegex(self.cautery("ls", url=url, code=3)[1], told)
        self.assertRegex(self.json("ls", url=url, code=3)["error"]["reason"], told)
        self.assertRegex(self.program("cautery-load", "--seconds", 1, url=url, code=3)[1], told)

    def test_who_finds_no_room_is_told(self):
        daemon = programs.Daemon(max_connections=1)
        self.addCleanup(daemon.stop)
        self.cautery("create", "fascia", "--name", "full", url=daemon.url)
        watching = subprocess.Popen([os.path.join(programs.PROGRAMS, "cautery"), "watch", "d1-full",
                                     "--url", daemon.url], stdout=subprocess.PIPE, text=True)
        self.addCleanup(watching.stdout.close)
        self.addCleanup(watching.wait)
        self.addCleanup(watching.kill)
        watching.stdout.readline()  # it is connected
        # The code is not looked at: libwebsockets makes 1002 of 1013, which it does not know.
        self.assertRegex(self.cautery("ls", url=daemon.url, code=3)[1],
                         r"too many connections \(setting max_connections\)")


class Load(programs.Case):
    def test_every_figure_is_measured(self):
        figures = self.json("--sessions", 2, "--viewers", 3, "--slow", 25, "--seconds", 2,
                            "--warm-up", 0.5, program="cautery-load")
        self.assertEqual((figures["sessions"], figures["viewers"], figures["slow"]), (2, 3, 1))
        for field in ("decode_errors", "gaps_unrecovered", "lost_acknowledged", "refused"):
            self.assertEqual(figures[field], 0, field)
        self.assertGreater(figures["acknowledged"], 0)
        self.assertGreater(figures["realtime_factor_min"], 0)
        self.assertGreaterEqual(figures["steal_pct"], 0)
        self.assertIsInstance(figures["rss_per_viewer"], (int, float))
        self.assertGreater(figures["bytes_per_vertex"], 0)
        for field in ("frame_ms", "command_ms"):
            figure = figures[field]
            self.assertGreater(figure["count"], 10)
            self.assertLessEqual(figure["p50"], figure["p99"])
            self.assertLessEqual(figure["p99"], figure["max"])
            self.assertGreater(figure["p50"], -1)  # the clocks agree
        self.assertEqual(self.json("ls")["sessions"], [])

    def test_exit_codes(self):
        for arguments, code in ((("--help",), 0), (("--scene", "no-such-scene"), 1),
                                (("--sessions", 0), 2), (("--url", "ws://127.0.0.1:1"), 3)):
            with self.subTest(arguments=arguments):
                self.program("cautery-load", *arguments, code=code)


if __name__ == "__main__":
    unittest.main()
