# SPDX-License-Identifier: GPL-3.0-or-later
"""Etcds of the test's own: Debian's, with their data in folders that go with them."""

import http.client
import json
import os
import shutil
import subprocess
import tempfile
import time

# Debian's is in a folder that is not in everybody's PATH.
ETCD = shutil.which("etcd", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


class Etcd:
    def __init__(self, host, client_port, peer_port, patience_s, prefix=(), folder=None, name="default", peers=None):
        """`prefix`: words before the command, which run it elsewhere. A `folder` is the caller's. `peers`: the ports of
        all of a cluster by their names, itself among them."""
        assert ETCD, "etcd is missing: deploy/packages.txt"
        self.folder = folder or tempfile.mkdtemp(prefix="cautery-etcd-")
        self.host, self.port = host, client_port
        self.url, peer = f"http://{host}:{client_port}", f"http://{host}:{peer_port}"
        cluster = ",".join(f"{other}=http://{host}:{port}" for other, port in (peers or {name: peer_port}).items())
        self.command = [*prefix, ETCD, "--name", name, "--data-dir", os.path.join(self.folder, "data"), "--logger", "zap",
                        "--listen-client-urls", self.url, "--advertise-client-urls", self.url,
                        "--listen-peer-urls", peer, "--initial-advertise-peer-urls", peer,
                        "--initial-cluster", cluster]
        self.patience_s = patience_s
        self.start()

    def start(self):
        """Again, with what it had, after it was killed."""
        self.process = subprocess.Popen(self.command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def leads(self):
        connection = http.client.HTTPConnection(self.host, self.port, timeout=self.patience_s)
        connection.request("POST", "/v3/maintenance/status", body=b"{}")
        status = json.loads(connection.getresponse().read())
        connection.close()
        return status["leader"] == status["header"]["member_id"]

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

    def kill(self):
        self.process.kill()  # one that is stopped by a signal, too
        self.process.wait()

    def stop(self):
        self.kill()
        shutil.rmtree(self.folder)
