# SPDX-License-Identifier: GPL-3.0-or-later
"""What cauteryd tells systemd: READY once it serves, WATCHDOG while it lives, STOPPING when told to end.

Usage: notify.py CAUTERYD SCENES
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


def expect(listener, wanted):
    while True:
        got = listener.recv(4096).decode()
        if wanted in got.split("\n"):
            return


def main(program, scenes):
    with tempfile.TemporaryDirectory() as folder:
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        listener.settimeout(PATIENCE_S)
        listener.bind(f"{folder}/notify")
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("CAUTERY")}
        environment["NOTIFY_SOCKET"] = f"{folder}/notify"
        daemon = subprocess.Popen(
            [program, "--port", "0", "--json", "--store", f"{folder}/store.db", "--scenes", scenes],
            env=environment, stdout=subprocess.PIPE)
        try:
            expect(listener, "READY=1")
            port = json.loads(daemon.stdout.readline())["port"]
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
            connection.request("GET", "/healthz")
            assert connection.getresponse().status == 200
            expect(listener, "WATCHDOG=1")
            expect(listener, "WATCHDOG=1")
            daemon.send_signal(signal.SIGTERM)
            expect(listener, "STOPPING=1")
            assert daemon.wait(PATIENCE_S) == 0
        finally:
            if daemon.poll() is None:
                daemon.kill()
                daemon.wait()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
