# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that a README, a project page or the manual shows is run by a test: here, or by the one that is named below.

Usage: readme_commands_test.py SOURCES PROGRAMS      (PROGRAMS: the folder of the built programs)

A command is a line of a block that says it is shell, or a line of another block that begins with the name of a
program of ours, of a shell's own or of Debian's common ones (`FIRST`). One that neither this file nor
`ELSEWHERE` knows fails the test, and so does an entry that no README shows any more. Of a place elsewhere the
file must hold the words that run it. What no test runs is listed with its reason, and printed. Steps (`tests/steps`) are run to the letter, whole sections of a page. So are
tutorials of the manual (`TUTORIALS`): programs are saved, commands run, and what is printed is what the page says.
"""

import concurrent.futures
import glob
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

SOURCES, PROGRAMS = sys.argv[1:3]
sys.path.insert(0, os.path.join(SOURCES, "tests/server/mesher"))
import solid_files  # noqa: E402
PATIENCE_S = 120
FIRST = re.compile(
    r"\(?(cmake|ctest|npm|cd|curl|cautery(-robot|-load|-sim|-bench)?|cauteryd(?! is )|apt-get|install|systemctl|promtool|haproxy|export|node|python3"
    r"|docker|git|openssl|[A-Z_]+=\S+|(\./|deploy/|tests/|build/|clients/|/usr/|/etc/|/opt/)\S+"
    r"|alias|bash|cat|ch(grp|mod|own)|cmp|cp|crontab|dd|debootstrap|diff|dpkg|echo|env|etcd(ctl)?|eval|ffmpeg|find|gcc|groupadd"
    r"|grep|gzip|head|ip|journalctl|jq|kill(all)?|kubectl|ln|logger|ls|make|mkdir|mount|mv|nano|nc|nft|ninja|nohup|pip3?|pkill|printf"
    r"|ps|python|rm|rsync|scp|sed|set|setcap|sh|sleep|socat|source|sqlite3|ss|ssh|sudo|sysctl|systemd-\S+|tail|tar|tee|time(out)?"
    r"|touch|ufw|umount|unset|unshare|user(add|mod)|vi|wait|wget|which|xargs|zsh|\[)( |$)")
DDS_DOMAINS, DDS_PORT = range(201, 231), 21000  # beyond those that tests/dds takes, and taken as it does
LABEL = re.compile(r"^(look|next|stop) +")  # of what run.sh prints
ESCAPES = re.compile(r"\x1b\[[0-9;]*m")  # colours, which some programs write where CI is set
COMMENT = re.compile(r" +# .*| {2,}\S.*")
SHELLS = {"sh", "bash", "shell", "console"}  # of a block's fence: every line is a command
NOT_RUN = {  # command: why
    "systemctl reload haproxy": "a container has no service manager",
    "systemctl restart prometheus": "a container has no service manager",
    "ps -C haproxy -o user=,args=": "a container has no HAProxy that systemd started",
    "OMP_NUM_THREADS=1 /usr/bin/python3 tests/reference/generate.py":
        "ten minutes of finite elements, with packages of their own; what it wrote is in the tree, and tests read it",
}

TUTORIALS = ("deploy/manual/web.md", "deploy/manual/research.md")
BLOCK = re.compile(r"(?:Save this as `([\w.-]+)`[^:]*:\n\n)?^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.-])\d+(?:\.\d+)?(?![\w-])")
AS_SAID = 0.2  # numbers that a tutorial prints, relative: processors of another tier part other edges

SIMULATION = "tests/simulation/CMakeLists.txt"
FIRST_HOUR, INSTALL = "tests/deploy/first_hour_test.py", "tests/deploy/install_test.py"
VIEWER, SECURITY = "tests/browser/run_viewer_tests.sh", "tests/dds/security.test.mjs"
CONFORMANCE = "tests/conformance/suite_test.py"
ELSEWHERE = {  # command: (file, words in it...)
    "ninja -C build cautery_simulation": (SIMULATION, "add_executable(cautery_simulation"),
    "build/tests/cautery_simulation --seconds 60": (SIMULATION, 'simulation_test(minute "e2e;full" 180 --seconds 60)'),
    "build/tests/cautery_simulation --long": (SIMULATION, 'simulation_test(hour "e2e;long" 4200 --long)'),
    "build/tests/cautery_simulation --faults": (SIMULATION, "simulation_test(list e2e 60 --faults)"),
    "build/tests/cautery_simulation --help": (SIMULATION, "simulation_test(help e2e 60 --help)"),
    'cautery move d1-knee d2 --to-url wss://other.example.org':
        ('tests/e2e/move.test.mjs', "'move', session, 'd2'", "'--to-url'"),
    "deploy/run.sh": (FIRST_HOUR, '"deploy/run.sh"'),
    "deploy/test.sh": (FIRST_HOUR, '"deploy/test.sh"'),
    "deploy/test.sh --no-install --only protocol_wire_frame_size": (FIRST_HOUR, '"deploy/test.sh", "--no-install", "--only", SMALL_TEST',
                                                                    'SMALL_TEST = "^protocol_wire_frame_size$"'),
    "deploy/test.sh --no-install --only architecture": (FIRST_HOUR, '"deploy/test.sh", "--no-install", "--only"'),  # that small test
    "cmake -S . -B build -DCMAKE_BUILD_TYPE=Release && cmake --build build":
        ("deploy/package.sh", 'cmake -S "$source_folder" -B "$tree" -DCMAKE_BUILD_TYPE=Release'),  # deploy_packages
    "ctest --test-dir build": (FIRST_HOUR, '"ctest", "--test-dir", "build"'),
    "kill 15703": (FIRST_HOUR, "os.kill(self.process, 15)"),  # the process that run.sh named
    "cmake --install build --prefix /usr/local": (INSTALL, 'CMAKE, "--install", TREE, "--prefix", "/usr"'),
    "npm run types && npm run lint && npm run unit": (VIEWER, "npm run --silent types", "npm run --silent lint", "npm run --silent unit"),
    "(cd clients/web && npm run manual)": (VIEWER, 'cd "$web"', "npm run --silent manual"),
    "npm run manual": (VIEWER, "npm run --silent manual"),
    "npm run browser": (VIEWER, "npm run --silent browser"),
    "cauteryd --dds --dds-config deploy/dds/network.xml --dds-security keys/enclaves/daemon":
        (SECURITY, "'--dds-security', enclave('daemon')"),
    "CYCLONEDDS_URI=file://$PWD/deploy/dds/network.xml,file://$PWD/keys/enclaves/knee-robot/cyclonedds.xml "
    "cautery-robot d1-knee hook": (SECURITY, "CYCLONEDDS_URI: identity ? `${LOOPBACK},file://${identity}/cyclonedds.xml`"),  # its own controller
    "(cd clients/javascript && npm pack)": ("tests/clients/javascript/package_test.py", '"npm", "pack"'),
    "build/bin/cautery_golden GOLDEN_FOLDER": (CONFORMANCE, 'os.environ["GOLDEN"], cls.golden'),
    "export PYTHONPATH=clients/python": ("tests/conformance/CMakeLists.txt", "PYTHONPATH=${PROJECT_SOURCE_DIR}/clients/python"),
    "tests/conformance/client.py --golden GOLDEN_FOLDER -- ADAPTER": (CONFORMANCE, '"client.py"), "--golden"'),
    "tests/conformance/client.py --golden GOLDEN_FOLDER --url ws://127.0.0.1:8740 -- ADAPTER": (CONFORMANCE, '"--url", self.daemon.url'),
    "tests/conformance/server.py ws://127.0.0.1:8740": (CONFORMANCE, '"server.py"), self.daemon.url'),
    "tests/bench/page.py": ("tests/bench/page_test.py", 'os.path.join(FOLDER, "page.py"), "--compare"'),  # of runs kept
    "tests/paper/run.py": ("tests/paper/CMakeLists.txt", "run.py\" --quick"),
}


def commands_of(page):
    """[command] of a page's blocks of shell: continued lines joined, comments left out."""
    found, shell, fenced, before = [], None, False, ""  # shell: whether a fenced block says it is; None: it says nothing
    for line in page.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            kind = line.strip()[3:]
            shell = None if not kind else kind in SHELLS
            continue
        if not (shell is not False if fenced else line.startswith("    ")):
            before = ""
            continue
        line = before + LABEL.sub("", line.strip())
        if line.endswith("\\"):
            before = line[:-1].rstrip() + " "
            continue
        before = ""
        if line and (fenced and shell or FIRST.match(line)) and not line.startswith("#"):
            found.append(COMMENT.sub("", line).rstrip())
    return found


def shown():
    """{command: [pages]} of all READMEs, without the sections that tests/steps follows."""
    with open(os.path.join(SOURCES, "tests/steps/CMakeLists.txt"), encoding="utf-8") as file:
        steps = re.findall(r'PAGE (\S+) SECTION "([^"]+)"', file.read())
    listed = subprocess.run(["git", "-C", SOURCES, "ls-files", "*README.md", ".github/*.md", "deploy/manual/*.md"], check=True, text=True, stdout=subprocess.PIPE)
    found = {}
    for name in listed.stdout.split():
        with open(os.path.join(SOURCES, name), encoding="utf-8") as file:
            page = file.read()
        for followed, section in steps:
            if followed == name:
                page = re.sub(rf"^(#+) {re.escape(section)}\n.*?(?=^#{{1,3}} |\Z)", "", page, flags=re.DOTALL | re.MULTILINE)
        for command in commands_of(page):
            found.setdefault(command, []).append(name)
    return found


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="cautery-readme-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        for name in ("build", "clients"):
            os.makedirs(os.path.join(cls.folder, name))
        for name in ("deploy", "tests", "clients/python", "clients/python_core"):
            os.symlink(os.path.join(SOURCES, name), os.path.join(cls.folder, name))
        os.symlink(PROGRAMS, os.path.join(cls.folder, "build/bin"))
        os.symlink(os.path.join(os.path.dirname(PROGRAMS), "deploy"), os.path.join(cls.folder, "build/deploy"))
        cls.environment = {**os.environ, "PATH": f"{PROGRAMS}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
        cls.shown, cls.ran = shown(), set()

    def start(self, *settings):
        daemon = subprocess.Popen(
            ["cauteryd", "--json", "--port", "0", "--store", tempfile.mktemp(dir=self.folder), *settings],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=self.environment, cwd=self.folder, text=True)
        url = re.search(r'"port": (\d+)', daemon.stdout.readline()).group(1)

        def end():
            daemon.terminate()
            self.assertEqual(daemon.wait(PATIENCE_S), 0)
            daemon.stdout.close()
        self.addCleanup(end)
        return f"127.0.0.1:{url}"

    def dds_domain(self):
        """One that nobody on this machine has: who listens on its port has it, until the test ends."""
        for domain in DDS_DOMAINS:
            place = socket.socket()
            try:
                place.bind(("127.0.0.1", DDS_PORT + domain))
                place.listen()
            except OSError:
                place.close()
                continue
            self.addCleanup(place.close)
            return domain
        raise AssertionError("every DDS domain is taken")

    def run_it(self, command, says="", at=None, until=False, instead=()):
        """Runs a command that a README shows. `at`: the daemon in place of the README's; `until`: it goes on by
        itself and is ended (Ctrl-C) once it has said what `says` wants; `instead`: what this machine has for what
        the README's has, [(of the README, of this machine)]."""
        self.assertIn(command, self.shown, "no README shows it")
        self.ran.add(command)
        text = command
        for of_readme, of_machine in (*instead, *((("127.0.0.1:8740", at),) if at else ())):
            self.assertTrue(of_readme in text or of_readme == "127.0.0.1:8740", f"{of_readme} is not in {command}")
            text = text.replace(of_readme, of_machine)
        environment = {**self.environment, **({"CAUTERYD_URL": f"ws://{at}"} if at else {})}
        process = subprocess.Popen(["bash", "-c", text], cwd=self.folder, env=environment, text=True, start_new_session=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        said = ""
        if until:
            patience = threading.Timer(PATIENCE_S, os.killpg, (process.pid, signal.SIGKILL))
            patience.start()
            while not re.search(says, ESCAPES.sub("", said)):
                line = process.stdout.readline()
                self.assertTrue(line, f"{text} ended, or was ended after {PATIENCE_S} s:\n{said}")
                said += line
            patience.cancel()
            os.killpg(process.pid, signal.SIGINT)
            process.communicate(timeout=PATIENCE_S)
        else:
            said = process.communicate(timeout=PATIENCE_S)[0]
            self.assertEqual(process.returncode, 0, f"{text}:\n{said}")
            self.assertRegex(said, says or ".*")
        process.stdout.close()
        return said

    def follow(self, name):
        """All blocks of a page in their order. A command that another test has run is not run again."""
        with open(os.path.join(SOURCES, name), encoding="utf-8") as file:
            blocks = BLOCK.findall(file.read())
        at, said, did = None, "", {"sh": 0, "saved": 0, "text": 0}
        for saved_as, kind, text in blocks:
            if saved_as:
                did["saved"] += 1
                with open(os.path.join(self.folder, saved_as), "w", encoding="utf-8") as file:
                    file.write(text.replace("127.0.0.1:8740", at or "127.0.0.1:8740"))
            elif kind == "sh":
                for command in [command for command in text.splitlines() if command not in self.ran]:
                    did["sh"] += 1
                    if command.startswith("cauteryd "):  # in a terminal of its own
                        at = self.start(*command.split()[1:])
                        self.ran.add(command)
                    else:
                        said = self.run_it(command, at=at)
            elif kind == "text":
                did["text"] += 1
                self.compare(said.splitlines()[-len(text.splitlines()):], text.splitlines())
            else:
                self.fail(f"{name}: a block of {kind} that nothing saves")
        self.assertTrue(all(did.values()), f"{name}: {did}")

    def compare(self, said, shown):
        for one, other in zip(said, shown, strict=True):
            self.assertEqual(NUMBER.sub("N", one), NUMBER.sub("N", other))
            for number, expected in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True):
                self.assertAlmostEqual(float(number), float(expected), delta=AS_SAID * float(expected), msg=f"{one} / {other}")

    def test_b_tutorials(self):
        node = glob.glob(os.path.join(SOURCES, "clients/web/node_modules/node-linux-*/bin"))  # Debian's has no WebSocket
        self.environment["PATH"] = ":".join([*node, self.environment["PATH"]])
        for name in TUTORIALS:
            with self.subTest(name):
                self.follow(name)

    def test_1_the_demo(self):
        at = self.start("--demo", "layers")
        self.run_it("curl http://127.0.0.1:8740/api/sessions", '"d1-layers"', at)
        for _ in range(2):
            self.run_it("build/bin/cautery --url ws://127.0.0.1:8740/ watch d1-layers", r"tick \d+ .*hook", at, until=True)
        self.run_it("build/bin/cautery-sim --scene layers --print-cut | build/bin/cautery --url ws://127.0.0.1:8740/ run d1-layers -",
                    r"\d", at, until=True)

    def test_1_the_python_package(self):
        self.run_it("PYTHONPATH=clients/python /usr/bin/python3 -c 'import cautery; help(cautery.Client.session_create)'",
                    "makes a session")
        self.run_it("PYTHONPATH=clients/python /usr/bin/python3 clients/python/examples/learn_part_band.py "
                    "--daemon build/bin/cauteryd --scenes deploy/scenes", "generation 1, policy 1 of", until=True)

    def test_1_the_core_in_python(self):
        self.run_it("LIBCAUTERY_CORE=build/deploy/libcautery-core.so PYTHONPATH=clients/python:clients/python_core "
                    "/usr/bin/python3 -c 'import cautery_core; help(cautery_core.Session)'", "A session of a scene")
        self.run_it("/usr/bin/python3 clients/python_core/benchmark.py --build build", r"\d+ ticks/s here, \d+ in cautery-sim",
                    until=True)

    def test_2_the_command_line(self):
        at = self.start()
        self.make_mesh("knee.msh")
        self.run_it("cautery create layers --name demo", "d1-demo", at)

        def drive():
            self.run_it("cautery-sim --scene layers --print-cut | cautery run d1-demo -", r"\d", at, until=True)
            self.run_it("cautery tool d1-demo hook move 0 0 0 on wait 3 line 0.02 0 0 0.002 off", "", at)
            self.run_it("cautery tool d1-demo hook configure --instrument monopolar-hook --mode blend --power-w 25", "", at)

        def look():
            self.run_it("cautery watch d1-demo", r"tick \d+", at, until=True)
            self.run_it("cautery create knee.msh --unit-m 0.001", "d1-", at)
            self.run_it("cautery material d1-demo fascia ignition_c=200", "", at)
            self.run_it("cautery events d1-demo --follow", r"\S", at, until=True)

        def record():
            self.run_it("cautery record d1-demo stream.bin --seconds 10 && cautery watch --recording stream.bin", r"tick \d+", at)
        with concurrent.futures.ThreadPoolExecutor() as hands:
            for done in [hands.submit(each) for each in (drive, look, record)]:
                done.result()

    def test_2c_a_class(self):
        at = self.start()
        self.run_it("cautery create layers --name anna", "d1-anna", at)
        self.run_it("cautery reset d1-anna", "", at)
        self.run_it("cautery events d1-anna", "", at)
        self.run_it("cautery backup", r"\.db", at)

    def make_mesh(self, name):
        """A tetrahedron of 20 mm, as Gmsh writes it."""
        with open(os.path.join(self.folder, name), "w", encoding="ascii") as file:
            file.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 20 0 0\n3 0 20 0\n4 0 0 20\n"
                       "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n")

    def test_2b_your_own_anatomy(self):
        at = self.start()
        for name, like in (("liver.stl", "ball.stl"), ("liver.nrrd", "raw.nrrd")):
            with open(os.path.join(self.folder, name), "wb") as file:
                file.write(next(data for other, data, *_ in solid_files.CASES if other == like))
        self.run_it("cautery create liver.stl", "d1-liver", at)
        self.run_it("cautery create liver.nrrd --labels 2,7 --pin bottom,left", "d1-liver", at)
        self.run_it("cautery mesh liver.nrrd --out liver.msh")

    def test_3_settings(self):
        self.run_it("build/bin/cauteryd --help", "--listen")
        self.run_it("build/bin/cauteryd --print-config", '"listen"')
        self.run_it("cauteryd --help", "--listen")
        self.run_it("cauteryd --print-config", '"listen"')

    def test_4_identities_for_dds(self):
        make = "deploy/dds/security/make.sh"
        for arguments in ("keys", "keys controller knee-robot", "--session d1-knee keys controller guest",
                          "--revoke knee-robot keys"):
            self.run_it(f"{make} {arguments}")

    def test_5_a_watching_machine(self):
        etc = os.path.join(self.folder, "etc")
        for name in ("prometheus", "haproxy"):
            os.makedirs(os.path.join(etc, name))
        here = (("/etc/", f"{etc}/"),)
        self.run_it("cautery token operate --name anna --days 90 --out anna.token", "^operate sha256:")
        self.run_it("cautery token view --name prometheus --days 365 --out cautery.token")
        mine = "install -m 600" if os.getuid() else "install -o root -g root -m 600"
        self.run_it("install -o prometheus -g prometheus -m 600 cautery.token /etc/prometheus/cautery.token",
                    instead=(("install -o prometheus -g prometheus -m 600", mine), *here))
        for name in ("prometheus.yml", "cautery.rules.yml"):
            shutil.copy(os.path.join(SOURCES, "deploy/monitoring", name), self.folder)
        self.run_it("install -m 644 prometheus.yml cautery.rules.yml /etc/prometheus/", instead=here)
        with open(os.path.join(etc, "prometheus/prometheus.yml"), encoding="utf-8") as file:
            config = file.read()
        with open(os.path.join(etc, "prometheus/prometheus.yml"), "w", encoding="utf-8") as file:
            file.write(config.replace("/etc/", f"{etc}/"))
        self.run_it("promtool check config /etc/prometheus/prometheus.yml", "SUCCESS", instead=here)

    def test_6_a_proxy(self):
        certificate = os.path.join(self.folder, "etc/haproxy/cautery.pem")
        os.makedirs(os.path.dirname(certificate), exist_ok=True)
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=cautery.example.org",
                        "-keyout", certificate, "-out", certificate + ".crt"], check=True, capture_output=True)
        with open(certificate, "ab") as whole, open(certificate + ".crt", "rb") as crt:
            whole.write(crt.read())
        shutil.copy(os.path.join(SOURCES, "deploy/fleet/daemons.example"), os.path.join(self.folder, "daemons"))
        here = (("/etc/", f"{self.folder}/etc/"),)
        self.run_it("deploy/fleet/make_haproxy.py daemons --host cautery.example.org "
                    "--certificate /etc/haproxy/cautery.pem > haproxy.cfg", instead=here)
        shutil.copy("/etc/haproxy/haproxy.cfg", os.path.dirname(certificate))  # Debian's
        self.run_it("cp --no-clobber /etc/haproxy/haproxy.cfg /etc/haproxy/haproxy.cfg.debian",
                    instead=(("/etc/haproxy/haproxy.cfg /etc/", f"{self.folder}/etc/haproxy/haproxy.cfg {self.folder}/etc/"),))
        self.run_it("haproxy -c -f haproxy.cfg && install -m 644 haproxy.cfg /etc/haproxy/haproxy.cfg", instead=here)

    def test_7_packages_exist(self):
        for command in [command for command in self.shown if command.startswith("apt-get install ")]:
            self.run_it(command, instead=(("apt-get install", "apt-get -s install"),))

    @unittest.skipUnless(shutil.which("npm"), "npm is not installed")
    def test_8_the_viewer_is_built(self):
        """In a copy: what is there serves other tests."""
        copy = os.path.join(self.folder, "clients/web")
        shutil.copytree(os.path.join(SOURCES, "clients/web"), copy, symlinks=True,
                        ignore=shutil.ignore_patterns("node_modules", "dist", "dist-manual*"))
        whole = "(cd clients/web && npm ci && npm run build)"
        self.run_it(whole, "built in")
        for part in ("npm ci", "npm run build"):  # of what ran just now
            self.assertIn(f"&& {part}", whole)
            self.ran.add(part)
        self.assertTrue(os.path.exists(os.path.join(copy, "dist/index.html")))
        self.run_it("npm run dev", r"Local:", until=True, instead=(("npm ", "cd clients/web && npm "),))

    def test_9_uniaxial_reference(self):
        """Standard library only; what it writes is what is there."""
        copy = os.path.join(self.folder, "copy/tests")
        shutil.copytree(os.path.join(SOURCES, "tests/reference"), os.path.join(copy, "reference"))
        self.run_it("/usr/bin/python3 tests/reference/uniaxial.py", instead=(("tests/", "copy/tests/"),))

    def test_a_robot_over_dds(self):
        """The three lines after one another in one shell, in a domain of their own."""
        lines = ("export CYCLONEDDS_URI=file://$PWD/deploy/dds/loopback.xml", "cauteryd --dds --demo fascia &",
                 "cautery-robot --energy --from=-0.02,0,0.001 --to=0.02,0,0.001 d1-fascia hook")
        for line in lines:
            self.assertIn(line, self.shown, "no README shows it")
        self.ran.update(lines)
        domain = self.dds_domain()
        text = "\n".join(lines).replace("cauteryd ", f"cauteryd --dds-domain {domain} 2>daemon.log >daemon.out ")
        text = text.replace("cautery-robot ", f"cautery-robot --domain {domain} ")
        text += "\ncode=$?; kill %1; wait %1 && exit $code"  # the daemon ends well, too
        environment = {**self.environment, "CAUTERY_PORT": "0", "CAUTERY_STORE": tempfile.mktemp(dir=self.folder)}
        done = subprocess.run(["bash", "-c", text], cwd=self.folder, env=environment, text=True, timeout=PATIENCE_S,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertRegex(done.stdout, r"(?s)drives.* [1-9]\d* commands")

    def test_z_all_are_known(self):
        for command, (place, *words) in ELSEWHERE.items():
            with open(os.path.join(SOURCES, place), encoding="utf-8") as file:
                text = file.read()
            for each in words:
                self.assertIn(each, text, f"{place} does not run: {command}")
        print("run by no test:", *(f"{command} ({why})" for command, why in NOT_RUN.items()), sep="\n  ")
        known = self.ran | set(ELSEWHERE) | set(NOT_RUN)
        strange = {command: pages for command, pages in self.shown.items() if command not in known}
        self.assertEqual(strange, {}, "commands of READMEs that no test runs")
        self.assertEqual({command for command in known if command not in self.shown}, set(), "no README shows these")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
