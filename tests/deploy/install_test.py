# SPDX-License-Identifier: GPL-3.0-or-later
"""What `cmake --install` makes, used as installed: in a place that the build knows nothing of.

Usage: install_test.py CMAKE TREE SOURCES      Exit code 77: skipped, and the reason is printed.
"""

import glob
import http.client
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, TREE, SOURCES = sys.argv[1:]
PATIENCE_S = 120
CLEAN = {name: value for name, value in os.environ.items()
         if not name.startswith(("CAUTERY", "CMAKE_", "PKG_CONFIG", "MAN"))}
PROGRAMS = {"cauteryd": 8, "cautery-sim": 1, "cautery-mesh": 1, "cautery": 1, "cautery-load": 1, "cautery-robot": 1}


def run(*command, **options):
    done = subprocess.run(command, env={**CLEAN, **options.pop("environment", {})}, text=True, timeout=PATIENCE_S,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, **options)
    assert done.returncode == 0, f"{command} ended with {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="cautery-install-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        staged = os.path.join(cls.folder, "staged")
        run(CMAKE, "--install", TREE, "--prefix", "/usr", environment={"DESTDIR": staged})
        cls.beside = sorted(os.listdir(staged))
        # Moved after it was installed: nothing in it may know where it was.
        cls.prefix = os.path.join(cls.folder, "elsewhere")
        os.rename(os.path.join(staged, "usr"), cls.prefix)

    def path(self, *names):
        return os.path.join(self.prefix, *names)

    def one(self, pattern):
        found = glob.glob(self.path(pattern), recursive=True)
        self.assertEqual(len(found), 1, f"{pattern}: {found}")
        return found[0]

    def start(self, *settings, store=None):
        """The installed daemon, with nothing said about its files. Returns its port."""
        store = store or os.path.join(tempfile.mkdtemp(dir=self.folder), "store.db")
        self.store = store
        daemon = subprocess.Popen([self.path("bin/cauteryd"), "--json", "--port", "0", "--store", store, *settings],
                                  stdout=subprocess.PIPE, env=CLEAN, cwd="/", text=True)

        def end():
            daemon.terminate()
            self.assertEqual(daemon.wait(PATIENCE_S), 0)
            daemon.stdout.close()

        self.addCleanup(end)
        return json.loads(daemon.stdout.readline())["port"]

    def test_nothing_goes_beyond_the_prefix(self):
        self.assertEqual(self.beside, ["usr"])
        self.assertTrue(os.path.exists(self.path("etc/cautery/cauteryd.json")))

    def test_session_by_the_installed_command_line(self):
        port = self.start()
        url = {"CAUTERYD_URL": f"ws://127.0.0.1:{port}"}
        session = run(self.path("bin/cautery"), "create", "fascia", environment=url).stdout.strip()
        self.assertIn(session, run(self.path("bin/cautery"), "ls", environment=url).stdout)

    def test_a_copy_of_a_store_in_use_holds_its_sessions(self):
        port, copy = self.start(), os.path.join(self.folder, "copy.db")
        session = run(self.path("bin/cautery"), "create", "fascia",
                      environment={"CAUTERYD_URL": f"ws://127.0.0.1:{port}"}).stdout.strip()
        run(self.path("bin/cauteryd"), "--store", self.store, "--backup", copy)
        self.assertEqual(os.stat(copy).st_mode & 0o777, 0o600)
        again = {"CAUTERYD_URL": f"ws://127.0.0.1:{self.start(store=copy)}"}
        self.assertIn(session, run(self.path("bin/cautery"), "info", session, environment=again).stdout)
        twice = subprocess.run([self.path("bin/cauteryd"), "--store", self.store, "--backup", copy], env=CLEAN,
                               capture_output=True, check=False)
        self.assertEqual(twice.returncode, 1)

    def test_viewer_is_served(self):
        viewer = os.path.join(SOURCES, "clients/web/dist/index.html")
        connection = http.client.HTTPConnection("127.0.0.1", self.start(), timeout=PATIENCE_S)
        connection.request("GET", "/")
        page = connection.getresponse().read()
        connection.close()
        if os.path.exists(viewer):
            with open(viewer, "rb") as file:
                self.assertEqual(page, file.read())
        else:
            self.assertFalse(os.path.exists(self.path("share/cautery/viewer")))
            print("note: the viewer is not built (npm run build in clients/web), so a plain page is served")

    def test_manual_is_served(self):
        """The installed one, without a setting."""
        manual = os.path.join(SOURCES, "clients/web/dist-manual/index.html")
        connection = http.client.HTTPConnection("127.0.0.1", self.start(), timeout=PATIENCE_S)
        connection.request("GET", "/manual/")
        answer = connection.getresponse()
        page = answer.read()
        connection.close()
        if os.path.exists(manual):
            with open(manual, "rb") as file:
                self.assertEqual((answer.status, page), (200, file.read()))
        else:
            self.assertEqual(answer.status, 404)
            print("note: the manual is not built (npm run manual in clients/web)")

    def test_scene_without_a_server(self):
        said = run(self.path("bin/cautery-sim"), "--scene", "fascia", "--seconds", "0.1", "--json", cwd="/")
        self.assertIn("hash", json.loads(said.stdout.splitlines()[-1]))

    def test_pkg_config_links_a_client(self):
        url = f"ws://127.0.0.1:{self.start()}"
        config = {"PKG_CONFIG_PATH": os.path.dirname(self.one("lib/**/cautery-client.pc"))}
        flags = run("pkg-config", "--cflags", "--libs", "cautery-client", environment=config).stdout.split()
        program = os.path.join(self.folder, "greet")
        run("cc", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-std=c17", "-o", program,
            os.path.join(SOURCES, "tests/deploy/client/greet.c"), *flags)
        self.assertRegex(run(program, url).stdout, r"^cauteryd \d")

    def test_a_client_in_cpp(self):
        """The headers' functions have C linkage, and client.hpp frees what it owns and throws what failed."""
        url = f"ws://127.0.0.1:{self.start()}"
        config = {"PKG_CONFIG_PATH": os.path.dirname(self.one("lib/**/cautery-client.pc"))}
        flags = run("pkg-config", "--cflags", "--libs", "cautery-client", environment=config).stdout.split()
        program = os.path.join(self.folder, "session")
        run("c++", "-Wall", "-Wextra", "-Werror", "-std=c++17", "-o", program,
            os.path.join(SOURCES, "tests/deploy/client/session.cc"), *flags)
        said = run(program, url).stdout.splitlines()
        self.assertRegex(said[0], r"^tick \d+, [1-9]\d+ vertices$")
        self.assertRegex(said[1], r"^refused: .*name")

    def test_first_client_of_the_readme(self):
        """In C, by the command that stands above it, but for where this daemon listens."""
        with open(os.path.join(SOURCES, "README.md"), encoding="utf-8") as file:
            page = file.read()
        [program] = re.findall(r"^```c\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
        command = "cc first.c $(pkg-config --cflags --libs cautery-client)"
        self.assertIn(f"`{command}`", page)
        listens = "cau_default_client_def();"
        self.assertIn(listens, program)
        port = self.start("--demo", "layers")
        with open(os.path.join(self.folder, "first.c"), "w", encoding="utf-8") as file:
            file.write(program.replace(listens, f'{listens} def.url = "ws://127.0.0.1:{port}";'))
        run("sh", "-c", command + " -Wall -Wextra -Werror", cwd=self.folder,
            environment={"PKG_CONFIG_PATH": os.path.dirname(self.one("lib/**/cautery-client.pc"))})
        with subprocess.Popen(["./a.out"], cwd=self.folder, env=CLEAN, stdout=subprocess.PIPE, text=True) as first:
            said = [first.stdout.readline() for _ in range(20)]
            first.kill()
        self.assertRegex(said[-1], r"^tick [1-9]\d*, \d+ of [1-9]\d+ vertices moved$")

    def test_find_package_builds_the_example(self):
        url = f"ws://127.0.0.1:{self.start()}"
        tree = os.path.join(self.folder, "stranger")
        run(CMAKE, "-S", os.path.join(SOURCES, "tests/deploy/client"), "-B", tree, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DEXAMPLE={self.one('share/doc/cautery/examples/teaching.c')}")
        run(CMAKE, "--build", tree)
        self.assertIn("cauteryd", run(os.path.join(tree, "example"), url).stdout)

    def core_flags(self):
        config = {"PKG_CONFIG_PATH": os.path.dirname(self.one("lib/**/cautery-core.pc"))}
        return run("pkg-config", "--cflags", "--libs", "cautery-core", environment=config).stdout.split()

    def core_page(self, kind):
        """The one block of a kind on the page that is installed with the core."""
        with open(self.path("share/doc/cautery/core/README.md"), encoding="utf-8") as file:
            [block] = re.findall(rf"^```{kind}\n(.*?)^```$", file.read(), re.DOTALL | re.MULTILINE)
        return block

    def run_with_core(self, program):
        """A program that is linked with the core, on the installed scene."""
        where = {"LD_LIBRARY_PATH": os.path.dirname(self.one("lib/**/libcautery-core.so"))}
        said = run(program, self.path("share/cautery/scenes/fascia.json"), environment=where).stdout
        self.assertRegex(said, r"^3111 vertices, the first at -0\.06")

    def test_first_program_with_the_core(self):
        """Of its page, by the command that the page has; a scene that is none is an error that says where."""
        source = os.path.join(self.folder, "core.c")
        with open(source, "w", encoding="utf-8") as file:
            file.write(self.core_page("c"))
        with open(self.path("share/doc/cautery/core/README.md"), encoding="utf-8") as file:
            self.assertIn("`cc core.c $(pkg-config --cflags --libs cautery-core)`", file.read())
        program = os.path.join(self.folder, "core")
        run("cc", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-std=c17", "-o", program, source, *self.core_flags())
        self.run_with_core(program)
        where = {**CLEAN, "LD_LIBRARY_PATH": os.path.dirname(self.one("lib/**/libcautery-core.so"))}
        none = subprocess.run([program, "/nowhere.json"], env=where, capture_output=True, text=True, check=False)
        self.assertEqual((none.returncode, none.stdout), (1, ""))
        self.assertIn("/nowhere.json: : cannot open: ", none.stderr)

    def test_find_package_links_the_core(self):
        folder = os.path.join(self.folder, "with_core")
        os.makedirs(folder)
        with open(os.path.join(folder, "core.c"), "w", encoding="utf-8") as file:
            file.write(self.core_page("c"))
        with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("cmake_minimum_required(VERSION 3.25)\nproject(stranger LANGUAGES C)\n"
                       "add_executable(program core.c)\n" + self.core_page("cmake"))
        tree = os.path.join(folder, "tree")
        run(CMAKE, "-S", folder, "-B", tree, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        run(CMAKE, "--build", tree)
        self.run_with_core(os.path.join(tree, "program"))

    def test_the_core_in_cpp(self):
        program = os.path.join(self.folder, "core_in_cpp")
        run("c++", "-Wall", "-Wextra", "-Werror", "-std=c++17", "-o", program,
            os.path.join(SOURCES, "tests/deploy/core/session.cc"), *self.core_flags())
        self.run_with_core(program)

    def test_python_packages(self):
        """Both in Debian's own Python, with the library as installed; the wire's without the core."""
        packages = os.path.dirname(self.one("lib/python3/dist-packages/cautery_core"))
        where = {"PYTHONPATH": packages, "PYTHONDONTWRITEBYTECODE": "1",
                 "LIBCAUTERY_CORE": self.one("lib/**/libcautery-core.so.0.1")}
        program = f"import cautery_core; print(cautery_core.Session('{self.path('share/cautery/scenes/fascia.json')}').step(3))"
        self.assertEqual(run("/usr/bin/python3", "-c", program, environment=where).stdout, "3\n")
        program = "import sys, cautery.environments; print('cautery_core' in sys.modules)"
        self.assertEqual(run("/usr/bin/python3", "-c", program, environment=where).stdout, "False\n")

    def core_headers(self):
        """{header: its text}, of what the component of the core's development adds."""
        staged = os.path.join(self.folder, "core-development")
        if not os.path.exists(staged):
            run(CMAKE, "--install", TREE, "--component", "coredevelopment", "--prefix", "/usr",
                environment={"DESTDIR": staged})
        found = {}
        for file in glob.glob(f"{staged}/usr/include/**/*.*", recursive=True):
            with open(file, encoding="utf-8") as header:
                found[os.path.relpath(file, f"{staged}/usr/include")] = header.read()
        return found

    def test_profiles_of_instruments_are_installed_as_they_are(self):
        profiles = os.path.join(SOURCES, "deploy/instruments")
        names = sorted(name for name in os.listdir(profiles) if name.endswith(".json"))
        self.assertEqual(sorted(os.listdir(self.path("share/cautery/instruments"))), names)
        for name in names:
            with open(os.path.join(profiles, name), "rb") as one, \
                    open(self.path("share/cautery/instruments", name), "rb") as other:
                self.assertEqual(one.read(), other.read())

    def test_only_public_headers_of_the_core_are_installed(self):
        self.assertEqual(sorted(self.core_headers()), [
            "cautery/embed.h", "cautery/mesh_scene.h", "cautery/session.h", "cautery/solid.h"])

    def test_the_core_exports_what_its_headers_declare(self):
        """And nothing else, all with its version; the name under which it is found has the version, too."""
        texts = list(self.core_headers().values())
        for name in ("scene_json.h", "command_json.h"):
            with open(self.path("include/cautery", name), encoding="utf-8") as header:
                texts.append(header.read())
        code = re.sub(r"//[^\n]*", "", "\n".join(texts))
        declared = set(re.findall(r"^[a-z][\w *]*?\b(cau_\w+)\(", code, re.MULTILINE))
        self.assertGreater(len(declared), 40)
        library = self.one("lib/**/libcautery-core.so")
        listed = run("nm", "-D", "--defined-only", library).stdout
        exported = re.findall(r"^\w+ T (\w+)@@(\S+)$", listed, re.MULTILINE)
        self.assertEqual({name for name, _ in exported}, declared)
        self.assertEqual({version for _, version in exported}, {"CAUTERY_CORE_0.1"})
        self.assertEqual(len(listed.splitlines()), len(exported) + 1)  # and the version itself
        self.assertIn("[libcautery-core.so.0.1]", run("readelf", "-d", library).stdout)

    def test_pages(self):
        pages = [f"man{section}/{name}.{section}.gz" for name, section in PROGRAMS.items()]
        for page in [*pages, "man5/cauteryd.json.5.gz"]:
            file = self.path("share/man", page)
            shown = run("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", file)
            self.assertEqual(shown.stderr, "", page)
            if shutil.which("mandoc"):
                lint = subprocess.run(["mandoc", "-T", "lint", "-W", "error", file], capture_output=True, check=False)
                self.assertEqual(lint.stdout, b"", page)

    def test_pages_say_all_that_the_programs_do(self):
        """Each option of the help text is on the page; each command, and each setting."""
        for name, section in PROGRAMS.items():
            said = run(self.path("bin", name), "--help").stdout
            shown = run("man", "-l", self.path(f"share/man/man{section}/{name}.{section}.gz"),
                        environment={"MANWIDTH": "200", "LC_ALL": "C"}).stdout
            for line in said.splitlines():
                if line.startswith("  ") and name != "cautery":
                    self.assertIn(line.split()[0], shown)
        settings = json.loads(run(self.path("bin/cauteryd"), "--settings-schema").stdout)["properties"]
        shown = run("man", "-l", self.path("share/man/man5/cauteryd.json.5.gz"), environment={"LC_ALL": "C"}).stdout
        for setting in settings:
            self.assertRegex(shown, rf" {setting}\s+\(")

    def test_completions_are_what_shells_take(self):
        run("bash", "-n", self.path("share/bash-completion/completions/cautery"))
        if shutil.which("zsh"):
            run("zsh", "-n", self.one("share/zsh/*/_cautery"))

    def test_nothing_knows_the_build(self):
        """A path of the machine that built it would be a path that its user does not have."""
        for folder, _, names in os.walk(self.prefix):
            for name in names:
                file = os.path.join(folder, name)
                if not name.endswith(".a"):
                    with open(file, "rb") as stream:
                        self.assertNotIn(SOURCES.encode() + b"/", stream.read(), file)

    def test_schema_has_the_defaults(self):
        settings = json.loads(run(self.path("bin/cauteryd"), "--settings-schema").stdout)["properties"]
        printed = json.loads(run(self.path("bin/cauteryd"), "--print-config").stdout)
        self.assertEqual({name: setting["default"] for name, setting in settings.items()}, printed)

    def test_versions(self):
        for name in PROGRAMS:
            self.assertRegex(run(self.path("bin", name), "--version").stdout, rf"^{name} \d+\.\d+\.\d+")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
