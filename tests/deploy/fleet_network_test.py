# SPDX-License-Identifier: GPL-3.0-or-later
"""A fleet on machines of its own: three daemons and etcd, each in a network namespace, and HAProxy with
TLS in front; 60 sessions with a viewer each, ten of them driven, while one thing after another goes
wrong. Usage: fleet_network_test.py SOURCE_FOLDER, with the environment of programs.py; as root.

All of it is in namespaces that end with this program: no network, mount or process is left behind. Ends
in a table; exit code 77 where the system allows no namespaces."""

import asyncio
import http.client
import json
import os
import re
import shutil
import signal
import ssl
import subprocess
import sys
import tempfile
import time

SOURCE = os.path.abspath(sys.argv[1])
sys.path[:0] = [os.path.join(SOURCE, "tests", "clients", "e2e"), os.path.join(SOURCE, "tests", "deploy")]
import etcd  # noqa: E402
import fleet_client  # noqa: E402
import programs  # noqa: E402

INSIDE = "CAUTERYD_FLEET_INSIDE"
NAMESPACES = ["setpriv", "--pdeathsig", "KILL",  # a test that is killed takes all of it along
              "unshare", "--net", "--mount", "--propagation", "private", "--pid", "--fork", "--kill-child",
              "--mount-proc"]
HAPROXY = shutil.which("haproxy", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
NAME, TOKEN = "cautery.test", "f" * 40
SESSIONS, DRIVEN, MOVED = 60, 10, 10
DOWN_S = 10  # a machine's link
TTL_S = {"d1": 20, "d2": 20, "d3": 5}  # above that, and below
BACK_S = 5  # a client is back so long after its daemon could be reached again
SETTLE_S = 3  # of work between two troubles
ADDRESS = {"d1": "10.77.0.11", "d2": "10.77.0.12", "d3": "10.77.0.13", "etcd": "10.77.0.21"}
PROXY = "10.77.0.1"


def ip(*words):
    subprocess.run(["ip", *words], check=True)


# ---- the machines
def make_network():
    """A bridge, where the proxy and the clients are, and a namespace behind it for each machine."""
    os.makedirs("/run/netns", exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "none", "/run/netns"], check=True)
    ip("link", "set", "lo", "up")
    ip("link", "add", "hub", "type", "bridge")
    ip("address", "add", f"{PROXY}/24", "dev", "hub")
    ip("link", "set", "hub", "up")
    for machine, address in ADDRESS.items():
        ip("netns", "add", machine)
        ip("link", "add", f"to-{machine}", "type", "veth", "peer", "name", "net", "netns", machine)
        ip("link", "set", f"to-{machine}", "master", "hub", "up")
        for words in (("address", "add", f"{address}/24", "dev", "net"), ("link", "set", "lo", "up"),
                      ("link", "set", "net", "up")):
            ip("-n", machine, *words)


class Keeper:
    """A daemon on its machine, started again a second after it ended, as systemd would."""

    def __init__(self, fleet, label):
        self.fleet, self.label = fleet, label
        self.store = os.path.join(fleet.folder, label + ".db")
        self.process, self.listens = None, asyncio.Event()
        self.starts, self.ended = [], []  # when it listened; (when, code)
        self.log = open(os.path.join(fleet.folder, label + ".log"), "w", encoding="utf-8")

    def command(self, store, machine, *more):
        settings = {"label": self.label, "store": store, "listen": ADDRESS[machine], "port": 8740, "agent_port": 8741,
                    "tokens": self.fleet.tokens, "hosts": f"{NAME},{PROXY}", "trusted_proxies": PROXY, "etcd": self.fleet.etcd.url,
                    "etcd_ttl_s": TTL_S[self.label], "scenes": os.environ["SCENES"], "log_level": "notice",
                    "quota_address": 100000, "quota_connection": 100000, "quota_admin": 100000, "quota_all": 100000}
        return ["ip", "netns", "exec", machine, os.path.join(programs.PROGRAMS, "cauteryd"), "--json",
                "--tls-by-proxy", *(f"--{k.replace('_', '-')}={v}" for k, v in settings.items()), *more]

    async def keep(self):
        while True:
            self.process = await asyncio.create_subprocess_exec(
                *self.command(self.store, self.label), stdout=asyncio.subprocess.PIPE, stderr=self.log,
                env=programs.CLEAN)
            if await self.process.stdout.readline():
                self.starts.append(time.monotonic())
                self.listens.set()
            code = await self.process.wait()
            self.listens.clear()
            self.ended.append((time.monotonic(), code))
            await asyncio.sleep(1)

    async def rival(self, machine):
        """What a copy of the store says that is started elsewhere."""
        copy = os.path.join(self.fleet.folder, "copy.db")
        for end in ("", "-wal"):
            if os.path.exists(self.store + end):
                shutil.copy(self.store + end, copy + end)
        process = await asyncio.create_subprocess_exec(*self.command(copy, machine, "--port=8750", "--agent-port=0"),
                                                       stdout=asyncio.subprocess.DEVNULL,
                                                       stderr=asyncio.subprocess.PIPE, env=programs.CLEAN)
        _, said = await asyncio.wait_for(process.communicate(), programs.PATIENCE_S)
        return process.returncode, said.decode()


class Fleet:
    host, port, name, token = PROXY, 443, NAME, TOKEN

    def __init__(self, folder):
        self.folder = folder
        self.tokens = os.path.join(folder, "tokens")
        with open(os.open(self.tokens, os.O_CREAT | os.O_WRONLY, 0o600), "w", encoding="ascii") as file:
            file.write(f"admin {TOKEN}\n")
        self.token_file = os.path.join(folder, "token")
        with open(os.open(self.token_file, os.O_CREAT | os.O_WRONLY, 0o600), "w", encoding="ascii") as file:
            file.write(TOKEN + "\n")
        self.etcd = etcd.Etcd(ADDRESS["etcd"], 2379, 2380, programs.PATIENCE_S, ["ip", "netns", "exec", "etcd"],
                              os.path.join(folder, "etcd"))
        self.keepers = {label: Keeper(self, label) for label in TTL_S}
        self.people, self.twice = [], []
        self.stood_s = []  # of each session that moved
        self.tls, self.certificate = None, None

    def start_proxy(self):
        both, key = os.path.join(self.folder, "both.pem"), os.path.join(self.folder, "key.pem")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                        "-keyout", key, "-out", both, "-days", "2", "-subj", f"/CN={NAME}", "-addext",
                        f"subjectAltName=DNS:{NAME},IP:{PROXY}"], check=True, capture_output=True)
        with open(both, "a", encoding="utf-8") as out, open(key, encoding="utf-8") as secret:
            out.write(secret.read())
        self.certificate, self.tls = both, ssl.create_default_context(cafile=both)
        listing = os.path.join(self.folder, "daemons")
        with open(listing, "w", encoding="utf-8") as file:
            file.write("".join(f"{label} {ADDRESS[label]}:8740 8741\n" for label in TTL_S))
        made = subprocess.run([sys.executable, "-B", os.path.join(SOURCE, "deploy", "fleet", "make_haproxy.py"), listing,
                               "--host", NAME, "--certificate", both, "--bind", f"{PROXY}:443", "--socket",
                               os.path.join(self.folder, "control.sock")], capture_output=True, text=True, check=True)
        path = os.path.join(self.folder, "haproxy.cfg")
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.stdout)
        subprocess.run([HAPROXY, "-c", "-q", "-f", path], check=True)
        return subprocess.Popen([HAPROXY, "-db", "-f", path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def get(self, path):
        connection = http.client.HTTPSConnection(PROXY, 443, timeout=programs.PATIENCE_S, context=self.tls)
        try:
            connection.request("GET", path, headers={"Host": NAME, "Authorization": f"Bearer {TOKEN}"})
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        finally:
            connection.close()

    def is_ready(self, label):
        try:
            return self.get(f"/{label}/readyz")[0] == 200
        except OSError:  # the proxy does not listen yet
            return False

    async def cautery(self, *arguments):
        environment = dict(programs.CLEAN, SSL_CERT_FILE=self.certificate)
        process = await asyncio.create_subprocess_exec(
            os.path.join(programs.PROGRAMS, "cautery"), *arguments, "--url", f"wss://{PROXY}", "--token-file",
            self.token_file, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT, env=environment)
        out, _ = await asyncio.wait_for(process.communicate(), programs.PATIENCE_S)
        if process.returncode:
            raise AssertionError(f"cautery {arguments}: {out.decode()}")
        return out.decode().strip()


# ---- watching
async def await_true(what, condition):
    """What only asking tells has no event to await."""
    until = time.monotonic() + programs.PATIENCE_S
    while not condition():
        if time.monotonic() > until:
            raise AssertionError(f"never: {what}")
        await asyncio.sleep(0.05)


async def watch_labels(fleet):
    """Where etcd has no holder of a label any more, and another could take it, nobody serves it. The process is looked
    at after etcd was asked, so one that has just ended is not taken for one that serves."""
    body = b'{"key": "Y2F1dGVyeS8=", "range_end": "Y2F1dGVyeTA="}'  # cautery/ to cautery0
    request = b"POST /v3/kv/range HTTP/1.0\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body)
    while True:
        serving = {label: keeper.process for label, keeper in fleet.keepers.items() if keeper.listens.is_set()}
        reader, writer = await asyncio.open_connection(ADDRESS["etcd"], 2379)
        writer.write(request)
        answer = await reader.read()
        writer.close()
        held = json.loads(answer.split(b"\r\n\r\n", 1)[1]).get("kvs", [])
        held = [fleet_client.base64.b64decode(pair["key"]).decode() for pair in held]
        for label, process in serving.items():
            if f"cautery/{label}/holder" not in held and is_running(process.pid):
                fleet.twice.append((time.monotonic(), label))
        await asyncio.sleep(0.1)


def is_running(pid):
    """Neither gone nor a zombie that nobody has asked for yet."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


# ---- troubles: each returns the label that it concerns, and when its daemon could be reached again
async def nothing_happens(fleet):
    await asyncio.sleep(SETTLE_S)
    return "", time.monotonic()


async def a_daemon_is_killed(fleet):
    keeper = fleet.keepers["d1"]
    keeper.process.kill()
    await keeper.process.wait()
    await await_true("d1 is started again", lambda: len(keeper.starts) == 2)
    return "d1", keeper.starts[1]


async def a_daemon_drains(fleet):
    """It gets no new session, and nobody loses a connection."""
    process = fleet.keepers["d2"].process
    process.send_signal(signal.SIGUSR1)
    await asyncio.sleep(2.5)  # the agent-check comes every second
    made = [await fleet.cautery("create", "fascia", "--paused") for _ in range(6)]
    process.send_signal(signal.SIGUSR2)
    assert not [session for session in made if session.startswith("d2-")], made
    await fleet.cautery("rm", *sorted(made))
    return "d2", time.monotonic()


async def link_is_down(fleet, label):
    ip("link", "set", f"to-{label}", "down")
    await asyncio.sleep(DOWN_S)
    ip("link", "set", f"to-{label}", "up")
    return label, time.monotonic()


async def a_link_is_down_for_less_than_the_time_to_live(fleet):
    keeper = fleet.keepers["d2"]
    told = await link_is_down(fleet, "d2")
    assert len(keeper.starts) == 1, keeper.ended  # it serves on
    return told


async def a_link_is_down_for_more_than_the_time_to_live(fleet):
    keeper = fleet.keepers["d3"]
    rival = asyncio.ensure_future(keeper.rival("d1"))
    label, up = await link_is_down(fleet, "d3")
    assert keeper.ended and keeper.ended[0][1] == 1, keeper.ended  # it ended by itself
    code, said = await rival
    assert code == 1 and "copy" in said, said
    await await_true("d3 is started again", lambda: len(keeper.starts) == 2)
    return label, up


async def sessions_move(fleet):
    """From d1 to d2 under load, driven ones first. Who uses them goes after them."""
    driven = {one.session for one in fleet.people if one.drives}
    moving = sorted({one.session for one in fleet.people if one.label == "d1"},
                    key=lambda session: session not in driven)[:MOVED]
    assert len(moving) == MOVED and driven & set(moving), moving
    people = [one for one in fleet.people if one.session in moving]
    for session in moving:
        told = await fleet.cautery("move", session, "d2")
        fleet.stood_s.append(float(re.search(r"suspended for ([0-9.]+) s", told).group(1)))
    moved = time.monotonic()
    await await_true("all have followed", lambda: all(one.followed for one in people))
    return "d2", moved


TROUBLES = (nothing_happens, a_daemon_is_killed, a_daemon_drains, sessions_move,
            a_link_is_down_for_less_than_the_time_to_live,
            a_link_is_down_for_more_than_the_time_to_live)


async def go_through(fleet, trouble):
    began, acknowledged = time.monotonic(), sum(len(one.acknowledged) for one in fleet.people)
    label, reachable = await trouble(fleet)
    for one in fleet.people:
        await asyncio.wait_for(one.ready.wait(), programs.PATIENCE_S)
    await asyncio.sleep(SETTLE_S)
    outages = [(one, outage) for one in fleet.people for outage in one.outages if outage[0] >= began]
    return {"trouble": trouble.__name__.replace("_", " "), "lost": len({one for one, _ in outages}),
            "others": len([one for one, _ in outages if one.label != label]),
            "back_s": max(((outage[1] or time.monotonic()) - reachable for _, outage in outages), default=0),
            "acknowledged": sum(len(one.acknowledged) for one in fleet.people) - acknowledged,
            "began": began, "ended": time.monotonic()}


# ---- what came of it
async def compare_logs(fleet):
    """(acknowledged moves that no log has, moves that acted at another tick than their answer says). Nobody drives any
    more: a log ends with the tick at which it was asked for, and what is acknowledged while it comes is not in it. A
    move that was sent again and acted again would be answered with its second tick. A later line of the same sequence
    alone says nothing: the daemon notes where a tool stays whose driver is gone."""
    missing = repeated = 0
    for one in (one for one in fleet.people if one.drives):
        file = os.path.join(fleet.folder, one.session + ".jsonl")
        await fleet.cautery("log", one.session, file)
        with open(file, encoding="utf-8") as lines:
            moves = [move for move in map(json.loads, lines) if move["command"] == "tool.move"]
        first = {move["sequence"]: move["tick"] for move in reversed(moves)}
        lost = [f"move {move} at tick {tick}" for move, tick in one.acknowledged if move not in first]
        if lost:
            print(f"{one.session}: {lost} of {len(one.acknowledged)}; the log's last: {moves[-1]}", flush=True)
        missing += len(lost)
        repeated += len([move for move, tick in one.acknowledged if first.get(move, tick) != tick])
    return missing, repeated


async def begin_sessions(fleet):
    for number in range(SESSIONS):
        session = await fleet.cautery("create", os.path.join(fleet.folder, "small.json"), "--name", f"s{number}")
        drives = number % (SESSIONS // DRIVEN) == 0
        fleet.people += [fleet_client.Person(fleet, session, False)]
        fleet.people += [fleet_client.Person(fleet, session, True)] if drives else []


async def end_tasks(tasks):
    for task in tasks:
        if task.done():
            task.result()  # what went wrong in it
    while tasks:  # wait_for loses a cancel that comes with what it waits for
        for task in tasks:
            task.cancel()
        _, tasks = await asyncio.wait(tasks, timeout=1)


def check(fleet, rows, missing, repeated):
    wrong = [f"{row['trouble']}: back after {row['back_s']:.1f} s" for row in rows if row["back_s"] > BACK_S]
    wrong += [f"{row['trouble']}: {row['others']} connections of other daemons were lost" for row in rows if row["others"]]
    wrong += [f"{row['trouble']}: nothing was acknowledged" for row in rows if not row["acknowledged"]]
    wrong += [f"{count} {what}" for count, what in
              ((missing, "acknowledged moves are lost"), (repeated, "moves acted twice"),
               (len(fleet.twice), "times a label was served that another could take")) if count]
    return wrong


def show(fleet, rows, missing, repeated):
    print("\n| what happened | connections lost | all back after, s | acknowledged | lost | acted twice | label free and"
          " served |\n|---|---:|---:|---:|---:|---:|---:|")
    for row in rows:
        twice = len([when for when, _ in fleet.twice if row["began"] <= when < row["ended"]])
        print(f"| {row['trouble']} | {row['lost']} | {row['back_s']:.1f} | {row['acknowledged']} | | | {twice} |")
    print(f"| in all | | | {sum(len(one.acknowledged) for one in fleet.people)} | {missing} | {repeated} "
          f"| {len(fleet.twice)} |\n\nthose that moved stood still for {min(fleet.stood_s):.2f} to"
          f" {max(fleet.stood_s):.2f} s\n")


async def run(fleet):
    fleet.etcd.await_healthy()
    proxy = fleet.start_proxy()
    keeping = [asyncio.ensure_future(keeper.keep()) for keeper in fleet.keepers.values()]
    for keeper in fleet.keepers.values():
        await asyncio.wait_for(keeper.listens.wait(), programs.PATIENCE_S)
    for label in TTL_S:
        await await_true(f"the proxy knows {label}", lambda: fleet.is_ready(label))
    watching = asyncio.ensure_future(watch_labels(fleet))
    await begin_sessions(fleet)
    counts = {label: len([one for one in fleet.people if one.label == label and not one.drives]) for label in TTL_S}
    print(f"sessions: {counts}", flush=True)
    assert min(counts.values()) >= SESSIONS // 10, counts
    living = [asyncio.ensure_future(one.live()) for one in fleet.people]
    rows = []
    for trouble in TROUBLES:
        rows.append(await go_through(fleet, trouble))
        print(f"{rows[-1]['trouble']}: all back after {rows[-1]['back_s']:.1f} s", flush=True)
    assert len((await fleet.cautery("ls")).splitlines()) == 1 + SESSIONS  # of all daemons
    await end_tasks(living)
    missing, repeated = await compare_logs(fleet)
    await end_tasks([watching, *keeping])
    proxy.kill()
    show(fleet, rows, missing, repeated)
    return check(fleet, rows, missing, repeated)


def make_small_scene(folder):
    with open(os.path.join(os.environ["SCENES"], "fascia.json"), encoding="utf-8") as file:
        scene = json.load(file)
    scene["meshes"][0]["cells"][:2] = [8, 6]
    scene.pop("cut", None)
    with open(os.path.join(folder, "small.json"), "w", encoding="utf-8") as file:
        json.dump(scene, file)


def inside(folder):
    make_network()
    try:
        make_small_scene(folder)
        wrong = asyncio.run(run(Fleet(folder)))
    except BaseException:
        for label in TTL_S:
            with open(os.path.join(folder, label + ".log"), encoding="utf-8") as log:
                print(f"---- {label}\n{log.read()[-3000:]}", file=sys.stderr)
        raise
    print("\n".join(wrong) or "all as promised")
    return 1 if wrong else 0


def main():
    if os.environ.get(INSIDE):
        return inside(os.environ[INSIDE])
    assert HAPROXY and etcd.ETCD, "haproxy or etcd-server is missing: deploy/packages.txt"
    probe = subprocess.run([*NAMESPACES, "ip", "link", "add", "hub", "type", "bridge"], capture_output=True, text=True,
                           check=False)
    if probe.returncode:
        print(f"SKIPPED: this system allows no namespaces with a bridge: {probe.stderr.strip()}")
        return 77
    with tempfile.TemporaryDirectory(prefix="cautery-fleet-") as folder:
        return subprocess.run([*NAMESPACES, sys.executable, "-B", os.path.abspath(__file__), SOURCE],
                              env=dict(os.environ, **{INSIDE: folder}), check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
