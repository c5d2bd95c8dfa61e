# SPDX-License-Identifier: GPL-3.0-or-later
"""What cauteryd tells systemd: READY once it serves, WATCHDOG while it lives, STOPPING when told to end,
and how far it is with the sessions of its store.

Usage: notify.py CAUTERYD SCENES CAUTERY
"""

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile

PATIENCE_S = 60
SESSIONS = 5


def expect(listener, wanted):
    while True:
        got = listener.recv(4096).decode()
        if wanted in got.split("\n"):
            return


def make_sessions(client, port, count):
    for number in range(count):
        subprocess.run([client, "create", "fascia", "--name", f"s{number}", "--paused",
                        "--url", f"ws://127.0.0.1:{port}"], check=True, stdout=subprocess.DEVNULL)


def expect_restart(listener, log, count):
    """Each session that is up is told once at most, in order, and the last clears the line."""
    told = []
    while not told or told[-1] != "":
        told += [line[len("STATUS="):] for line in listener.recv(4096).decode().split("\n")
                 if line.startswith("STATUS=")]
    numbers = [int(line.split()[0]) for line in told[:-1]]
    assert told[:-1] == [f"{number} of {count} sessions are up" for number in numbers], told
    assert numbers == sorted(set(numbers)) and all(0 < n < count for n in numbers), told
    with open(log) as lines:
        assert f"event=all_resumed sessions={count} of={count} " in lines.read()


def run(program, scenes, folder, listener, use):
    """Starts a daemon, waits until it is ready, has `use` use its port, and ends it."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}
    environment["NOTIFY_SOCKET"] = f"{folder}/notify"
    with open(f"{folder}/log", "w") as log:
        daemon = subprocess.Popen(
            [program, "--port", "0", "--json", "--store", f"{folder}/store.db", "--scenes", scenes],
            env=environment, stdout=subprocess.PIPE, stderr=log)
        try:
            expect(listener, "READY=1")
            use(json.loads(daemon.stdout.readline())["port"])
            daemon.send_signal(signal.SIGTERM)
            expect(listener, "STOPPING=1")
            assert daemon.wait(PATIENCE_S) == 0
        finally:
            if daemon.poll() is None:
                daemon.kill()
                daemon.wait()


def main(program, scenes, client):
    with tempfile.TemporaryDirectory() as folder:
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        listener.settimeout(PATIENCE_S)
        listener.bind(f"{folder}/notify")

        def live(port):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
            connection.request("GET", "/healthz")
            assert connection.getresponse().status == 200
            expect(listener, "WATCHDOG=1")
            expect(listener, "WATCHDOG=1")
            make_sessions(client, port, SESSIONS)

        run(program, scenes, folder, listener, live)
        run(program, scenes, folder, listener,
            lambda port: expect_restart(listener, f"{folder}/log", SESSIONS))


if __name__ == "__main__":
    main(*sys.argv[1:])
