# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that cautery keeps and completes, and what it tells as it happens."""

import json
import os
import shutil
import stat
import subprocess
import unittest

import programs


class Contexts(programs.Case):
    def setUp(self):
        self.config = self.path(self.id())
        self.at_home = {"XDG_CONFIG_HOME": self.config}

    def context(self, *arguments, code=0, **environment):
        return self.cautery("context", *arguments, code=code,
                            environment=dict(self.at_home, **environment))

    def test_a_daemon_is_found_by_its_name(self):
        self.assertEqual(self.context()[0], "")
        self.context("set", "here", "--url", self.daemon.url)
        self.context("set", "gone", "--url", "ws://127.0.0.1:1")
        self.assertEqual(self.context("ls")[0].splitlines(), [
            f"* {'here':16} {self.daemon.url}", f"  {'gone':16} ws://127.0.0.1:1"])
        self.cautery("ls", environment=self.at_home)
        self.cautery("ls", "--context", "gone", environment=self.at_home, code=3)
        self.context("use", "gone")
        self.cautery("ls", environment=self.at_home, code=3)
        # nearer to the command: the environment, then options
        nearer = dict(self.at_home, CAUTERYD_URL=self.daemon.url)
        self.cautery("ls", environment=nearer)
        self.cautery("ls", "--context", "gone", environment=nearer, code=3)
        self.cautery("ls", "--url", self.daemon.url, "--context", "gone", environment=self.at_home)
        self.context("rm", "gone")
        self.assertNotIn("gone", self.context("ls")[0])
        told = json.loads(self.context("ls", "--json")[0])
        self.assertEqual(told, {"contexts": {"here": {"url": self.daemon.url}}})

    def test_without_a_home_there_are_no_contexts(self):
        nowhere = {"XDG_CONFIG_HOME": "", "HOME": ""}
        self.assertEqual(self.cautery("context", "ls", environment=nowhere)[0], "")
        self.cautery("ls", "--context", "here", environment=nowhere, code=4)
        said = self.cautery("context", "set", "here", "--url", self.daemon.url, environment=nowhere, code=4)[1]
        self.assertIn("HOME", said)

    def test_a_context_brings_its_token(self):
        tokens = self.path("tokens", "admin master-token-0123456789\n")
        os.chmod(tokens, 0o600)
        daemon = programs.Daemon(tokens=tokens)
        self.addCleanup(daemon.stop)
        token = self.path("master", "master-token-0123456789\n")
        self.context("set", "locked", "--url", daemon.url, "--token-file", token)
        self.cautery("ls", environment=self.at_home)
        self.assertIn("token in " + token, self.context("ls")[0])
        file = os.path.join(self.config, "cautery", "contexts.json")
        self.assertEqual(stat.S_IMODE(os.stat(file).st_mode), 0o600)
        with open(file, encoding="utf-8") as text:
            self.assertNotIn("master-token", text.read())
        # It is for its own daemon alone.
        self.cautery("ls", "--url", daemon.url, environment=self.at_home, code=1)

    def test_mistakes_are_told(self):
        self.context("set", "theatre", "--url", self.daemon.url)
        self.assertIn("did you mean \"theatre\"?", self.context("use", "theater", code=2)[1])
        self.assertIn("`cautery context ls` lists them", self.cautery(
            "ls", "--context", "nowhere", environment=self.at_home, code=4)[1])
        self.assertIn("is not a valid name", self.context("set", "no name", code=2)[1])
        self.assertIn("no command", self.cautery("contxt", environment=self.at_home, code=2)[1])
        with open(os.path.join(self.config, "cautery", "contexts.json"), "w", encoding="utf-8") as file:
            file.write("{")
        self.assertIn("repair or remove it", self.context("ls", code=4)[1])
        self.cautery("ls", environment=self.at_home, code=4)
        self.cautery("ls", "--url", self.daemon.url, environment=self.at_home)  # does not need it


def words_after(text):
    return set(text.split())


class Shells(programs.Case):
    def complete(self, *words):
        return words_after(self.cautery("complete", "--", *words)[0])

    def test_words_are_completed_by_what_there_is(self):
        session = self.create("fascia", "--name", "knee")
        self.assertEqual(self.complete("re"), {"record", "reset", "resume", "restore", "rewind"})
        self.assertIn("context", self.complete(""))
        self.assertEqual(self.complete("context", ""), {"ls", "set", "use", "rm"})
        self.assertEqual(self.complete("snapshot", ""), {"ls", session})
        self.assertEqual(self.complete("rewind", "d1-"), {session})
        self.assertEqual(self.complete("rewind", session, ""), set())
        self.assertEqual(self.complete("rm", session, ""), {session})
        self.assertTrue({"fascia", "fat"} <= self.complete("create", "fa"))
        self.assertEqual(self.complete("fork", "--p"), {"--paused"})
        self.assertIn("--url", self.complete("--"))
        self.assertEqual(self.complete("create", "--mesh", ""), set())  # the shell's own: files

    def test_without_a_daemon_nothing_is_said(self):
        out, told = self.cautery("complete", "--", "rewind", "", url="ws://127.0.0.1:1")
        self.assertEqual((out, told), ("", ""))

    def shell(self, name, script):
        if not shutil.which(name):
            self.skipTest(f"{name} is not here")
        environment = dict(programs.CLEAN, CAUTERYD_URL=self.daemon.url,
                           PATH=programs.PROGRAMS + ":" + programs.CLEAN["PATH"])
        done = subprocess.run([name, "-c", script], text=True, capture_output=True, check=True,
                              env=environment, timeout=programs.PATIENCE_S)
        self.assertEqual(done.stderr, "")
        return words_after(done.stdout)

    def test_bash(self):
        session = self.create("fascia", "--name", "bash")
        script = """source <(cautery completion bash)
            COMP_WORDS=(cautery %s) COMP_CWORD=%d
            $(complete -p cautery | sed 's/.*-F \\([^ ]*\\).*/\\1/')
            echo "${COMPREPLY[@]}" """
        self.assertEqual(self.shell("bash", script % ("fo", 1)), {"fork", "force"})
        self.assertEqual(self.shell("bash", script % ("fork ''", 2)), {session})

    def test_zsh(self):
        session = self.create("fascia", "--name", "zsh")
        # what compadd would be given, outside of a line that is edited
        script = """autoload -Uz compinit; compinit -D -u
            source <(cautery completion zsh)
            function compadd { print -l ${(P)2} }
            function _files { print files }
            words=(cautery %s) CURRENT=%d
            $_comps[cautery]"""
        self.assertEqual(self.shell("zsh", script % ("fo", 2)), {"fork", "force"})
        self.assertEqual(self.shell("zsh", script % ("fork ''", 3)), {session})
        self.assertEqual(self.shell("zsh", script % ("create --mesh ''", 4)), {"files"})

    def test_an_unknown_shell(self):
        self.assertIn("did you mean \"bash\"", self.cautery("completion", "bahs", code=2)[1])


class Events(programs.Case):
    def test_what_happens_is_told_as_it_happens(self):
        session = self.create("fascia", "--paused")
        following = subprocess.Popen(
            [os.path.join(programs.PROGRAMS, "cautery"), "events", session, "--follow", "--json",
             "--url", self.daemon.url], stdout=subprocess.PIPE, text=True)
        self.addCleanup(following.stdout.close)
        self.addCleanup(following.wait)
        self.addCleanup(following.kill)
        before = json.loads(following.stdout.readline())
        self.assertEqual([e["kind"] for e in before["events"]], ["created"])
        self.cautery("snapshot", session, "--name", "one")
        self.cautery("restore", session, "one")
        told = [json.loads(following.stdout.readline()) for _ in range(2)]
        self.assertEqual([e["kind"] for e in told], ["snapshot", "restore"])
        self.assertEqual(told[0]["client"], "cautery")
        self.cautery("rm", session)
        self.assertEqual(following.wait(programs.PATIENCE_S), 1)  # it is gone
        self.cleanups_of_session_are_done(session)

    def cleanups_of_session_are_done(self, session):
        self.assertNotIn(session, self.cautery("ls")[0])
        self._cleanups = [c for c in self._cleanups if session not in c[1]]

    def test_following_ends_in_time(self):
        session = self.create("fascia", "--paused")
        out, _ = self.cautery("events", session, "--follow", "--seconds", 0.3)
        self.assertIn("created", out)

    def test_ping(self):
        told = self.json("ping", "--count", 3, "--every", 0.01)
        self.assertEqual(told["count"], 3)
        self.assertTrue(0 < told["least_ms"] <= told["mean_ms"] <= told["most_ms"])
        self.cautery("ping", url="ws://127.0.0.1:1", code=3)

    def test_version(self):
        self.assertRegex(self.cautery("--version")[0], r"^cautery \d+\.\d+\.\d+ \(cautery\.v1\)$")
        self.assertIn("restore", self.cautery("restore", "-h")[0])


if __name__ == "__main__":
    unittest.main()
