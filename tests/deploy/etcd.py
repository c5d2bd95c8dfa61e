# SPDX-License-Identifier: GPL-3.0-or-later
"""An etcd of the test's own: Debian's, with its data in a folder that goes with it."""

import http.client
import os
import shutil
import subprocess
import tempfile
import time

# Debian's is in a folder that is not in everybody's PATH.
ETCD = shutil.which("etcd", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


class Etcd:
    def __init__(self, host, client_port, peer_port, patience_s, prefix=(), folder=None):
        """`prefix`: words before the command, which run it elsewhere. A `folder` is the caller's."""
        assert ETCD, "etcd is missing: deploy/packages.txt"
        self.folder = folder or tempfile.mkdtemp(prefix="cautery-etcd-")
        self.host, self.port = host, client_port
        self.url, peer = f"http://{host}:{client_port}", f"http://{host}:{peer_port}"
        self.process = subprocess.Popen(
            [*prefix, ETCD, "--data-dir", os.path.join(self.folder, "data"), "--logger", "zap",
             "--listen-client-urls", self.url, "--advertise-client-urls", self.url,
             "--listen-peer-urls", peer, "--initial-advertise-peer-urls", peer,
             "--initial-cluster", f"default={peer}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.patience_s = patience_s

    def healthy(self):
        connection = http.client.HTTPConnection(self.host, self.port, timeout=1)
        try:
            connection.request("GET", "/health")
            return connection.getresponse().read() == b'{"health":"true"}'
        except (OSError, http.client.HTTPException):
            return False
        finally:
            connection.close()

    def await_healthy(self):
        """Nobody tells when it is, so it is asked."""
        until = time.monotonic() + self.patience_s
        while not self.healthy():
            if time.monotonic() > until or self.process.poll() is not None:
                raise AssertionError("etcd does not get ready")
            time.sleep(0.05)

    def stop(self):
        self.process.kill()  # one that is stopped by a signal, too
        self.process.wait()
        shutil.rmtree(self.folder)
