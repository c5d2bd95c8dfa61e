# SPDX-License-Identifier: GPL-3.0-or-later
"""The unit file as it is installed: what systemd says of it, and the daemon run as it says.

Usage: unit_test.py CMAKE TREE      Exit code 77: skipped, and the reason is printed.

The daemon is started the way the unit's lines ask for, as far as that needs no systemd: as another
user without capabilities, with the unit's limits, in its state folder, with the unit's command, told
where to notify. Its sandbox (namespaces, system call filter) is systemd's to make; what systemd
thinks of it is asked of systemd-analyze.
"""

import configparser
import ctypes
import glob
import json
import os
import pwd
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

CMAKE, TREE = sys.argv[1:]
PATIENCE_S = 60
# Without a sign of life for this long a daemon hangs; it gives four a second.
SILENCE_S = 3
EXPOSURE_MOST = "20"  # tenths: systemd-analyze's "OK" begins at 3.9
CLEAN = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}

RLIMIT_NICE = 13  # which Python does not name
PTRACE_SEIZE, PTRACE_INTERRUPT, PTRACE_DETACH = 0x4206, 0x4207, 17
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def ptrace(request, thread):
    if libc.ptrace(request, thread, None, None) != 0:
        raise OSError(ctypes.get_errno(), f"ptrace {request} of {thread}")


class Unit(configparser.ConfigParser):
    """A unit file; a setting that is given more than once has its last value."""

    def __init__(self, file):
        super().__init__(interpolation=None, strict=False, delimiters=["="])
        self.optionxform = str
        self.read(file)


def threads_of(process):
    """{name: [threads that are called so]}"""
    found = {}
    for folder in glob.glob(f"/proc/{process}/task/*"):
        with open(f"{folder}/comm", encoding="ascii") as file:
            found.setdefault(file.read().strip(), []).append(int(os.path.basename(folder)))
    return found


def may_limit(nice):
    """Whether a process that is made here may have this limit."""
    child = os.fork()
    if child == 0:
        try:
            resource.setrlimit(RLIMIT_NICE, nice)
            os._exit(0)
        except ValueError:
            os._exit(1)
    return os.waitpid(child, 0)[1] == 0


class Listener:
    """What a daemon tells systemd."""

    def __init__(self, folder):
        self.path = os.path.join(folder, "notify")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        os.chmod(self.path, 0o666)

    def tells(self, wanted, within_s):
        """Whether `wanted` comes within this time; all that came before is heard too."""
        until = time.monotonic() + within_s
        while (left := until - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                if wanted in self.socket.recv(4096).decode().split("\n"):
                    return True
            except TimeoutError:
                pass
        return False

    def forget(self):
        self.socket.settimeout(0)
        try:
            while True:
                self.socket.recv(4096)
        except BlockingIOError:
            pass


class TestUnit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="cautery-unit-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        os.chmod(cls.folder, 0o755)
        cls.root = os.path.join(cls.folder, "root")
        subprocess.run([CMAKE, "--install", TREE], check=True, stdout=subprocess.DEVNULL,
                       env={**CLEAN, "DESTDIR": cls.root})
        [cls.file] = glob.glob(f"{cls.root}/**/systemd/system/cauteryd.service", recursive=True)
        cls.unit = Unit(cls.file)

    def start(self):
        """The daemon as the unit starts it. Returns (process, listener)."""
        service = self.unit["Service"]
        state = tempfile.mkdtemp(dir=self.folder)
        listener = Listener(tempfile.mkdtemp(dir=self.folder))
        os.chmod(os.path.dirname(listener.path), 0o755)
        # nobody: the user is made when a package is installed
        user = pwd.getpwnam("nobody") if os.geteuid() == 0 else None
        if user:
            os.chown(state, user.pw_uid, user.pw_gid)
        command = [self.root + word if word.startswith("/") else word for word in service["ExecStart"].split()]

        def limit():
            if may_be_nice:
                resource.setrlimit(RLIMIT_NICE, nice)
            os.umask(int(service["UMask"], 8))

        nice = (20 - int(service["LimitNICE"]),) * 2  # it counts from 20 down
        may_be_nice = user and may_limit(nice)
        # Where root itself may not raise that limit (in some containers), the right stands in for it.
        rights = "-all" if may_be_nice else "-all,+sys_nice"
        ambient = [] if may_be_nice else ["--ambient-caps=+sys_nice"]
        program = ["setpriv", f"--reuid={user.pw_uid}", f"--regid={user.pw_gid}", "--clear-groups",
                   f"--bounding-set={rights}", f"--inh-caps={rights}", *ambient, "--no-new-privs"] if user else []
        daemon = subprocess.Popen(program + command + ["--port", "0", "--json"], cwd=state, text=True, preexec_fn=limit,
                                  env={**CLEAN, "NOTIFY_SOCKET": listener.path}, stdout=subprocess.PIPE)

        def end():
            if daemon.poll() is None:
                daemon.kill()
            daemon.wait()
            daemon.stdout.close()
            listener.socket.close()

        self.addCleanup(end)
        self.assertTrue(listener.tells("READY=1", PATIENCE_S))
        json.loads(daemon.stdout.readline())
        return daemon, listener, state

    def test_systemd_finds_no_fault(self):
        for name in ("cauteryd.service", "cauteryd@.service"):
            file = os.path.join(os.path.dirname(self.file), name)
            # The command is looked for where it will be; here it is under the root.
            with open(file, encoding="utf-8") as stream:
                text = stream.read().replace("ExecStart=", f"ExecStart={self.root}")
            copy = os.path.join(self.folder, name.replace("@", "@knee"))
            with open(copy, "w", encoding="utf-8") as stream:
                stream.write(text)
            said = subprocess.run(["systemd-analyze", "verify", "--man=no", copy], capture_output=True, text=True,
                                  check=False)
            ours = [line for line in said.stderr.splitlines() if "cauteryd" in line]
            self.assertEqual((said.returncode, ours), (0, []), said.stderr)

    def test_it_is_exposed_to_little(self):
        for name in ("cauteryd.service", "cauteryd@.service"):
            file = os.path.join(os.path.dirname(self.file), name)
            said = subprocess.run(["systemd-analyze", "security", "--offline=true", f"--threshold={EXPOSURE_MOST}", file],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(said.returncode, 0, said.stdout[-400:] + said.stderr)

    def test_a_user_is_made_for_it(self):
        if not shutil.which("systemd-sysusers"):
            self.skipTest("no systemd-sysusers")
        [file] = glob.glob(f"{self.root}/**/sysusers.d/cautery.conf", recursive=True)
        root = tempfile.mkdtemp(dir=self.folder)
        os.mkdir(f"{root}/etc")
        subprocess.run(["systemd-sysusers", f"--root={root}", file], check=True, capture_output=True)
        with open(f"{root}/etc/passwd", encoding="ascii") as users:
            self.assertIn(f"{self.unit['Service']['User']}:", users.read())

    def test_it_lives_as_its_user(self):
        daemon, listener, state = self.start()
        self.assertTrue(os.path.exists(f"{state}/cautery.db"), "its store stands in its state folder")
        self.assertEqual(os.stat(f"{state}/cautery.db").st_mode & 0o077, 0)
        for _ in range(3):
            self.assertTrue(listener.tells("WATCHDOG=1", PATIENCE_S))
        daemon.send_signal(signal.SIGHUP)
        self.assertTrue(listener.tells("RELOADING=1", PATIENCE_S))
        self.assertTrue(listener.tells("READY=1", PATIENCE_S))
        daemon.send_signal(signal.SIGTERM)
        self.assertTrue(listener.tells("STOPPING=1", PATIENCE_S))
        self.assertEqual(daemon.wait(PATIENCE_S), 0)

    @staticmethod
    def named_threads(daemon, names):
        """Each thread names itself, so a daemon that listens may have one that has not come to that."""
        end = time.monotonic() + PATIENCE_S
        while not set(names) <= threads_of(daemon.pid).keys() and time.monotonic() < end:
            time.sleep(0.01)
        return threads_of(daemon.pid)

    def test_threads_have_names_and_priorities(self):
        daemon, _, _ = self.start()
        nice = {"cautery-net": -5, "cautery-watch": -5, "cautery-store": 0, "cautery-memory": 0, "cautery-fold": 0, "cautery-work": 5,
                "cautery-build": 10, "cautery-move": 5}
        threads = self.named_threads(daemon, nice)
        for name, wanted in nice.items():
            self.assertIn(name, threads)
            if wanted >= 0 or os.geteuid() == 0:
                for thread in threads[name]:
                    self.assertEqual(os.getpriority(os.PRIO_PROCESS, thread), wanted, name)

    def test_systemd_is_not_told_that_it_lives_while_it_hangs(self):
        """Each of the three threads that energy and the store depend on is stopped in its turn."""
        daemon, listener, _ = self.start()
        watched = ("cautery-net", "cautery-store", "cautery-watch")
        threads = self.named_threads(daemon, watched)
        for name in watched:
            [thread] = threads[name]
            try:
                ptrace(PTRACE_SEIZE, thread)
            except OSError as error:
                self.skipTest(f"no thread may be stopped here ({error})")
            ptrace(PTRACE_INTERRUPT, thread)
            os.waitpid(thread, 0x40000000)  # __WALL
            listener.tells("WATCHDOG=1", 1)  # what had come round before
            listener.forget()
            silent = not listener.tells("WATCHDOG=1", SILENCE_S)
            ptrace(PTRACE_DETACH, thread)
            self.assertTrue(silent, f"{name} is stopped")
            self.assertTrue(listener.tells("WATCHDOG=1", PATIENCE_S), f"{name} goes on")


if __name__ == "__main__":
    if not shutil.which("systemd-analyze") or not shutil.which("setpriv"):
        print("skipped: systemd-analyze or setpriv is missing")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
