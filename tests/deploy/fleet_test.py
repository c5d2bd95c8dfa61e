# SPDX-License-Identifier: GPL-3.0-or-later
"""deploy/fleet: HAProxy, the real one, in front of daemons whose tissue is a double.
Usage: fleet_test.py SOURCE_FOLDER, with the environment of tests/clients/e2e/programs.py."""

import base64
import csv
import grp
import http.client
import json
import os
import pwd
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = os.path.abspath(sys.argv.pop(1))
sys.path.insert(0, os.path.join(SOURCE, "tests", "clients", "e2e"))
import programs  # noqa: E402
import together  # noqa: E402

MAKE = os.path.join(SOURCE, "deploy", "fleet", "make_haproxy.py")
# Debian's is in a folder that is not in everybody's PATH.
HAPROXY = shutil.which("haproxy", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
NAME = "cautery.test"
HANDSHAKE = {"Host": NAME, "Upgrade": "websocket", "Connection": "Upgrade",
             "Sec-WebSocket-Version": "13", "Sec-WebSocket-Protocol": "cautery.v1",
             "Sec-WebSocket-Key": base64.b64encode(bytes(16)).decode()}


def await_true(what, condition):
    """What HAProxy learns by asking has no event to await."""
    until = time.monotonic() + programs.PATIENCE_S
    while not condition():
        if time.monotonic() > until:
            raise AssertionError(f"never: {what}")
        time.sleep(0.05)


def make(folder, lines, *options):
    listing = os.path.join(folder, "daemons")
    with open(listing, "w", encoding="utf-8") as file:
        file.write("".join(line + "\n" for line in lines))
    rights = [] if os.geteuid() == 0 else ["--without-root"]
    return subprocess.run([sys.executable, "-B", MAKE, listing, "--host", NAME, *rights, *options],
                          capture_output=True, text=True, check=False)


def make_certificate(folder):
    """A file of certificate and key for NAME and this machine, which is its own authority."""
    both, key = os.path.join(folder, "both.pem"), os.path.join(folder, "key.pem")
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
                    "-nodes", "-keyout", key, "-out", both, "-days", "2", "-subj", f"/CN={NAME}",
                    "-addext", f"subjectAltName=DNS:{NAME},IP:127.0.0.1"],
                   check=True, capture_output=True)
    with open(both, "a", encoding="utf-8") as out, open(key, encoding="utf-8") as secret:
        out.write(secret.read())
    return both


def is_served(port):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=programs.PATIENCE_S)
    try:
        connection.request("GET", "/healthz", headers={"Host": NAME})
        return connection.getresponse().status == 200
    except OSError:
        return False
    finally:
        connection.close()


def ids_of(process, what):
    with open(f"/proc/{process}/status", encoding="ascii") as file:
        line = next(line for line in file if line.startswith(what + ":"))
    return {int(word) for word in line.split()[1:]}


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        assert HAPROXY, "haproxy is missing: deploy/packages.txt"
        cls.folder = tempfile.mkdtemp(prefix="cautery-fleet-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)


class Configuration(Folder):
    def check(self, text):
        path = os.path.join(self.folder, "haproxy.cfg")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return subprocess.run([HAPROXY, "-c", "-f", path], capture_output=True, text=True, check=False)

    def test_haproxy_takes_it(self):
        certificate = make_certificate(self.folder)
        for count in (1, 3, 100):
            lines = [f"d{n} 10.0.0.{n}:8740 8741" for n in range(1, count + 1)]
            for options in (["--no-tls"], ["--certificate", certificate]):
                with self.subTest(count=count, options=options):
                    made = make(self.folder, lines, *options)
                    self.assertEqual(made.returncode, 0, made.stderr)
                    checked = self.check(made.stdout)
                    self.assertEqual(checked.returncode, 0, checked.stderr)
                    self.assertNotIn("WARNING", checked.stderr)
                    self.assertEqual(made.stdout.count("agent-check agent-addr"), count)

    def test_haproxy_would_not_take_anything(self):
        made = make(self.folder, ["d1 10.0.0.1:8740 8741"], "--no-tls")
        self.assertNotEqual(self.check(made.stdout.replace("use_backend", "use_backends")).returncode, 0)

    def test_it_keeps_what_debians_file_has(self):
        made = make(self.folder, ["d1 10.0.0.1:8740 8741"], "--no-tls", "--user", "haproxy")
        words = [" ".join(line.split()) for line in made.stdout.splitlines()]
        kept = ["daemon", "log /dev/log local0", "log /dev/log local1 notice", "stats timeout 30s", "ca-base /etc/ssl/certs",
                "crt-base /etc/ssl/private"]
        if os.geteuid() == 0:
            kept += ["chroot /var/lib/haproxy", "user haproxy", "group haproxy"]
        for line in kept:
            self.assertEqual(words.count(line), 1, line)

    @unittest.skipIf(os.geteuid() != 0, "only root can give its rights up")
    def test_it_does_not_serve_as_root(self):
        """As systemd's unit of Debian starts it: a master, and a worker that serves."""
        port, = together.free_ports(1)
        made = make(self.folder, ["d1 127.0.0.1:1 2"], "--no-tls", "--bind", f"127.0.0.1:{port}",
                    "--socket", os.path.join(self.folder, "admin.sock"))
        path = os.path.join(self.folder, "haproxy.cfg")
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.stdout)
        proxy = subprocess.Popen([HAPROXY, "-W", "-db", "-f", path], stderr=subprocess.DEVNULL)
        self.addCleanup(proxy.wait)
        self.addCleanup(proxy.terminate)
        await_true("it serves", lambda: is_served(port))
        with open(f"/proc/{proxy.pid}/task/{proxy.pid}/children", encoding="ascii") as file:
            workers = file.read().split()
        self.assertEqual(len(workers), 1)
        user, group = pwd.getpwnam("haproxy").pw_uid, grp.getgrnam("haproxy").gr_gid
        self.assertEqual(ids_of(workers[0], "Uid"), {user})
        self.assertEqual(ids_of(workers[0], "Gid"), {group})
        self.assertLessEqual(ids_of(workers[0], "Groups"), {group})
        self.assertEqual(os.readlink(f"/proc/{workers[0]}/root"), "/var/lib/haproxy")

    def test_names_that_are_none_are_refused(self):
        for options in (["--user", "root # x"], ["--user", ""], ["--chroot", "/var lib"]):
            made = make(self.folder, ["d1 10.0.0.1:8740 8741"], "--no-tls", *options)
            self.assertEqual((made.returncode, made.stdout), (2, ""))

    def test_the_example_and_addresses_of_ipv6(self):
        with open(os.path.join(SOURCE, "deploy", "fleet", "daemons.example"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        made = make(self.folder, [*lines, "d6 [fd00::6]:8740 8741"], "--no-tls", "--bind", "[::1]:8740")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.check(made.stdout).returncode, 0)
        self.assertIn('{"labels": ["d1", "d2", "d3", "d6"]}', made.stdout)

    def test_wrong_lists_are_refused_by_line(self):
        good = "d1 10.0.0.1:8740 8741"
        for lines, said in (([good, "d-2 10.0.0.2:8740 8741"], ":2: 'd-2' is no label"),
                            (["api 10.0.0.2:8740 8741"], ":1: 'api' is no label"),
                            ([good, "", good], "d1 is there twice"),
                            ([good, "d2 10.0.0.1:8740 8742"], "10.0.0.1:8740 is there twice"),
                            (["d1 10.0.0.1 8741"], "is no ADDRESS:PORT"),
                            (["d1 10.0.0.1:70000 8741"], "'70000' is no port"),
                            (["d1 10.0.0.1:8740 0"], "'0' is no port"),
                            (["d1 10.0.0.1:8740"], ":1: wants LABEL"),
                            (["# none"], "names no daemon")):
            with self.subTest(lines=lines):
                made = make(self.folder, lines, "--no-tls")
                self.assertEqual((made.returncode, made.stdout), (2, ""))
                self.assertIn(said, made.stderr)


class Fleet(Folder):
    """d1 and d2 behind one HAProxy, for each test anew."""
    certificate = None
    settings = {}  # of the daemons, besides those that a fleet wants

    def setUp(self):
        http_port, *self.agent_ports = together.free_ports(3)
        self.address = f"127.0.0.1:{http_port}"
        self.daemons = {}
        for label, agent_port in zip(("d1", "d2"), self.agent_ports):
            self.start_daemon(label, agent_port, **self.settings)
        self.control = os.path.join(self.folder, "control.sock")
        tls = ["--certificate", self.certificate] if self.certificate else ["--no-tls"]
        lines = [f"{label} 127.0.0.1:{daemon.port} {agent_port}"
                 for (label, daemon), agent_port in zip(self.daemons.items(), self.agent_ports)]
        made = make(self.folder, lines, "--bind", self.address, "--socket", self.control, *tls)
        self.assertEqual(made.returncode, 0, made.stderr)
        path = os.path.join(self.folder, "haproxy.cfg")
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.stdout)
        proxy = subprocess.Popen([HAPROXY, "-db", "-f", path], stderr=subprocess.DEVNULL)
        self.addCleanup(proxy.wait)
        self.addCleanup(proxy.terminate)
        await_true("both are known", lambda: all(
            self.new(label)["agent_status"] in ("L7OK", "CHECKED") for label in self.daemons))

    def start_daemon(self, label, agent_port, **settings):
        daemon = programs.Daemon(label=label, agent_port=agent_port, max_sessions=4, hosts=f"{NAME},127.0.0.1",
                                 trusted_proxies="127.0.0.1", hello_timeout_s=60, **settings)
        self.addCleanup(daemon.stop)
        self.daemons[label] = daemon

    def new(self, label):
        """HAProxy's row of the daemon as one for new sessions."""
        try:
            with socket.socket(socket.AF_UNIX) as control:
                control.connect(self.control)
                control.sendall(b"show stat\n")
                text = control.makefile(encoding="utf-8").read().lstrip("# ")
        except OSError:
            return {"agent_status": "", "weight": "0", "status": ""}
        rows = csv.DictReader(text.splitlines())
        return next(row for row in rows if (row["pxname"], row["svname"]) == ("new_" + label, label))

    def connect(self):
        host, port = self.address.split(":")
        if not self.certificate:
            return http.client.HTTPConnection(host, int(port), timeout=programs.PATIENCE_S)
        return http.client.HTTPSConnection(host, int(port), timeout=programs.PATIENCE_S,
                                           context=ssl.create_default_context(cafile=self.certificate))

    def get(self, path, headers=None):
        connection = self.connect()
        connection.request("GET", path, headers=headers or {"Host": NAME})
        answer = connection.getresponse()
        body = b"" if answer.status == 101 else answer.read()
        self.addCleanup(answer.close)
        self.addCleanup(connection.close)
        return answer, body.decode()

    def connections(self, label):
        _, text = self.get(f"/{label}/metrics")
        return int(next(line for line in text.splitlines()
                        if line.startswith("cautery_connections ")).split()[1])

    def cautery(self, *arguments, code=0, at=None):
        """By default through the proxy."""
        scheme = "wss" if self.certificate else "ws"
        environment = dict(programs.CLEAN, CAUTERYD_URL=at or f"{scheme}://{self.address}")
        if self.certificate:
            environment["SSL_CERT_FILE"] = self.certificate
        done = subprocess.run([os.path.join(programs.PROGRAMS, "cautery"), *arguments], text=True,
                              capture_output=True, env=environment, timeout=programs.PATIENCE_S, check=False)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return (done.stdout + done.stderr).strip()

    def fill(self, label, count):
        """Sessions at the daemon itself, until HAProxy has heard of them."""
        before = int(self.new(label)["weight"])
        for _ in range(count):
            self.cautery("create", "fascia", "--paused", at=self.daemons[label].url)
        await_true(f"{label} has less room", lambda: int(self.new(label)["weight"]) < before - 20 * count)

    def expect_refused(self, path, status, word):
        for headers in (None, HANDSHAKE):
            answer, body = self.get(path, headers)
            self.assertEqual(answer.status, status)
            told = json.loads(body)
            self.assertEqual((told["status"], told["error"]), (status, word))
            self.assertEqual(answer.getheader("cautery-reason"), told["reason"])
            self.assertTrue(told["where"] and told["remedy"])


class Placing(Fleet):
    def test_a_new_session_lands_where_there_is_most_room(self):
        self.fill("d1", 2)
        self.assertRegex(self.cautery("create", "fascia", "--paused"), "^d2-")
        self.fill("d2", 3)
        self.assertRegex(self.cautery("create", "fascia", "--paused"), "^d1-")

    def test_many_at_once_are_not_all_sent_to_one(self):
        await_true("both have room, now that they have started",
                   lambda: all(int(self.new(label)["weight"]) >= 80 for label in self.daemons))
        opened = [self.get("/v1", HANDSHAKE)[0].status for _ in range(20)]
        self.assertEqual(opened, [101] * 20)
        counts = [self.connections(label) for label in self.daemons]
        self.assertEqual(sum(counts), 20)
        self.assertGreaterEqual(min(counts), 4, counts)

    def test_who_drains_gets_none_and_keeps_what_there_is(self):
        self.fill("d2", 2)
        self.daemons["d1"].process.send_signal(signal.SIGUSR1)
        await_true("d1 drains", lambda: self.new("d1")["status"].startswith("DRAIN"))
        self.assertRegex(self.cautery("create", "fascia", "--paused"), "^d2-")
        self.assertEqual(self.get("/v1?session=d1-knee", HANDSHAKE)[0].status, 101)
        self.daemons["d2"].process.send_signal(signal.SIGUSR1)
        await_true("d2 drains", lambda: self.new("d2")["status"].startswith("DRAIN"))
        self.expect_refused("/v1", 503, "no_daemon")
        self.assertIn("no daemon of this fleet takes new sessions", self.cautery("create", "fascia", code=3))
        self.daemons["d1"].process.send_signal(signal.SIGUSR2)
        await_true("d1 is back", lambda: self.new("d1")["status"] == "UP")
        self.assertRegex(self.cautery("create", "fascia", "--paused"), "^d1-")


class Routing(Fleet):
    def test_a_session_is_found_by_its_label(self):
        self.fill("d2", 3)  # the other has more room
        for number, query in enumerate(("session=d2-knee", "label=d2", "session=d2%2Dknee", "x=1&session=d2-a-b"), 1):
            answer, _ = self.get("/v1?" + query, HANDSHAKE)
            self.assertEqual(answer.status, 101)
            self.assertEqual(answer.getheader("sec-websocket-protocol"), "cautery.v1")
            self.assertEqual((self.connections("d1"), self.connections("d2")), (0, number))

    def test_pages_are_those_of_a_label(self):
        self.fill("d2", 1)
        for label in self.daemons:
            _, text = self.get(f"/{label}/api/sessions")
            self.assertEqual(json.loads(text)["daemon"], label)
            self.assertEqual(self.get(f"/{label}/readyz")[0].status, 200)
        self.assertEqual(json.loads(self.get("/api/fleet")[1]), {"labels": ["d1", "d2"]})
        self.assertEqual(self.get("/healthz")[0].status, 200)
        for path in ("/metrics", "/api/sessions", "/readyz"):
            answer, body = self.get(path)
            self.assertEqual((answer.status, json.loads(body)["error"]), (404, "label_required"))

    def test_the_viewer_is_there(self):
        answer, text = self.get("/")
        self.assertEqual(answer.status, 200)
        self.assertIn("<html", text.lower())

    def test_the_viewer_of_a_label_is_at_that_daemon(self):
        self.fill("d2", 3)  # the other has more room
        answer, text = self.get("/d2/")
        self.assertEqual((answer.status, text), (200, self.get("/")[1]))
        self.assertEqual(self.get("/d2/v1", HANDSHAKE)[0].status, 101)
        self.assertEqual((self.connections("d1"), self.connections("d2")), (0, 1))

    def test_unknown_labels_are_said(self):
        for path in ("/v1?session=d3-knee", "/v1?session=knee", "/v1?session=", "/v1?label=d", "/d3/metrics", "/d3/v1"):
            with self.subTest(path=path):
                self.expect_refused(path, 404, "unknown_label")

    def test_a_daemon_that_is_gone_is_said(self):
        _, _ = self.get("/v1?session=d2-knee", HANDSHAKE)
        open_one, _ = self.get("/v1?session=d2-knee", HANDSHAKE)
        self.daemons["d2"].kill()
        await_true("d2 is missed", lambda: self.new("d2")["status"].startswith("DOWN"))
        self.expect_refused("/v1?session=d2-knee", 503, "daemon_down")
        self.assertEqual(open_one.fp.read(), b"")  # closed
        self.assertRegex(self.cautery("create", "fascia", "--paused"), "^d1-")


class Addresses(Fleet):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        tokens = os.path.join(cls.folder, "tokens")
        with open(os.open(tokens, os.O_CREAT | os.O_WRONLY, 0o600), "w", encoding="ascii") as file:
            file.write("admin " + "a" * 40 + "\n")
        cls.log = open(os.path.join(cls.folder, "log"), "w+", encoding="utf-8")
        cls.addClassCleanup(cls.log.close)
        cls.settings = {"tokens": tokens, "log": cls.log}

    def say_hello_from(self, source, label, headers):
        """With a token that there is not. Returns when the daemon has closed."""
        hello = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "hello",
                            "params": {"version": 1, "client": "test", "token": "b" * 40}}).encode()
        self.assertLess(len(hello), 126 + 65536)
        lines = [f"GET /v1?label={label} HTTP/1.1", *(f"{k}: {v}" for k, v in {**HANDSHAKE, **headers}.items())]
        host, port = self.address.split(":")
        with socket.create_connection((host, int(port)), programs.PATIENCE_S, (source, 0)) as client:
            client.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            answers = client.makefile("rb")
            self.assertIn(b" 101 ", answers.readline())
            while answers.readline().strip():
                pass
            # one text frame, masked with zeros
            client.sendall(bytes([0x81, 0x80 | 126]) + len(hello).to_bytes(2, "big") + bytes(4) + hello)
            answers.read()

    def test_the_daemon_counts_by_the_address_behind_the_proxy(self):
        for label, forged in (("d1", {}), ("d2", {"X-Forwarded-For": "10.9.9.9"})):
            self.say_hello_from("127.0.0.9", label, forged)
        with open(self.log.name, encoding="utf-8") as log:
            refused = [line for line in log if "event=token_refused" in line]
        self.assertEqual(len(refused), 2, refused)
        for line in refused:
            self.assertIn("address=127.0.0.9", line)


class CommandLine(Fleet):
    def test_sessions_are_reached_wherever_they_are(self):
        made = [self.cautery("create", "fascia", "--name", "knee", "--paused", "--label", label)
                for label in self.daemons]
        self.assertEqual(made, ["d1-knee", "d2-knee"])
        for session in made:
            self.assertIn(f"{session}: scene fascia", self.cautery("info", session))
            self.cautery("step", session, "--ticks", "20")
            self.cautery("tool", session, "hook", "move", "0", "0", "0.01")
        listed = json.loads(self.cautery("ls", "--label", "d2,d1", "--json"))["sessions"]
        self.assertEqual([(one["session"], one["tick"]) for one in listed], [("d1-knee", 20), ("d2-knee", 20)])
        self.assertNotIn("d1-knee", self.cautery("ls", "--label", "d2"))
        everywhere = json.loads(self.cautery("ls", "--json"))["sessions"]
        self.assertEqual([one["session"] for one in everywhere], ["d1-knee", "d2-knee"])
        alone = json.loads(self.cautery("ls", "--json", at=self.daemons["d2"].url))["sessions"]
        self.assertEqual([one["session"] for one in alone], ["d2-knee"])
        self.cautery("rm", *made)
        self.assertEqual(json.loads(self.cautery("ls", "--label", "d1,d2", "--json"))["sessions"], [])

    def test_a_daemon_that_is_gone_hides_no_others(self):
        self.cautery("create", "fascia", "--name", "knee", "--paused", "--label", "d2")
        self.daemons["d1"].kill()
        await_true("d1 is missed", lambda: self.new("d1")["status"].startswith("DOWN"))
        listed = self.cautery("ls", code=3)
        self.assertIn("d2-knee", listed)
        self.assertIn("the sessions of d1 are not in the list", listed)

    def test_what_is_wrong_is_said(self):
        for arguments, code, said in ((("info", "d3-knee"), 3, "no daemon of this fleet has the label"),
                                      (("ls", "--label", "d1,d3"), 3, "no daemon of this fleet has the label"),
                                      (("ls", "--label", "d1,,d2"), 2, '"" is not a label'),
                                      (("ls", "--label", "D 1"), 2, '"D 1" is not a label'),
                                      (("create", "fascia", "--label", "d1,d2"), 2, "takes one label here")):
            with self.subTest(arguments=arguments):
                self.assertIn(said, self.cautery(*arguments, code=code))


class Clients(Fleet):
    """Programs that were written for one daemon."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.certificate = make_certificate(cls.folder)

    def test_over_tls_the_command_line_works_as_with_one(self):
        self.daemons["d2"].process.send_signal(signal.SIGUSR1)
        await_true("d2 drains", lambda: self.new("d2")["status"].startswith("DRAIN"))
        session = self.cautery("create", "fascia", "--name", "knee", "--paused")
        self.assertEqual(session, "d1-knee")
        self.assertIn(session, self.cautery("ls"))
        self.assertIn("fascia", self.cautery("info", session))
        self.assertIn("20", self.cautery("step", session, "--ticks", "20"))
        self.cautery("tool", session, "hook", "move", "0", "0", "0.01")
        self.cautery("export", session, os.path.join(self.folder, "knee.obj"))
        self.cautery("rm", session)
        self.assertNotIn(session, self.cautery("ls"))

    def test_a_plain_connection_is_none(self):
        connection = http.client.HTTPConnection(*self.address.split(":"), timeout=programs.PATIENCE_S)
        self.addCleanup(connection.close)
        connection.request("GET", "/healthz")
        with self.assertRaises((http.client.HTTPException, OSError)):
            connection.getresponse()


if __name__ == "__main__":
    together.main(at_once=3, by_class=True)
