# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows that each architecture test fails on a violation of its rule, and passes without one."""

import os
import shutil
import subprocess
import tempfile
import unittest

import arrows
import assertions
import circles
import citation
import examples
import formatting
import includes
import known_bugs
import layout
import licences
import sizes
import symbols
import text_rules
import words


class Tree(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = self.folder.name
        self.addCleanup(self.folder.cleanup)

    def write(self, name, text):
        path = os.path.join(self.root, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path


class Layout(unittest.TestCase):
    def test_rooms_and_dotfiles_pass(self):
        self.assertEqual(layout.violations(["core/a.c", "README.md", ".clang-format"]), [])

    def test_a_stranger_is_named(self):
        self.assertEqual(len(layout.violations(["utils/a.c", "notes.md", "core/a.c"])), 2)


class Sizes(unittest.TestCase):
    def file(self, lines):
        return "\n" * lines

    def test_long_enough_files_and_small_structs_pass(self):
        struct = "struct a { int b, c[2]; struct { int d, e; } f; void (*g)(int, int); };"
        self.assertEqual(list(sizes.structs(struct))[0], ("a", 4))
        self.assertEqual(sizes.violations({"core/a.c": self.file(100) + struct, "core/b.c": self.file(600)}), [])

    def test_too_many_small_files(self):
        texts = {f"core/{i}.c": self.file(79 if i < 2 else 80) for i in range(8)}
        self.assertEqual(sizes.violations(texts), [])
        self.assertEqual(len(sizes.violations({**texts, "core/small.h": "\n"})), 1)

    def test_a_long_file(self):
        self.assertEqual(len(sizes.violations({"tests/a.c": self.file(601)})), 1)

    def test_a_struct_with_too_many_members(self):
        text = self.file(80) + "typedef struct a { int " + ", ".join(f"b{i}" for i in range(31)) + "; } a;"
        self.assertEqual(len(sizes.violations({"server/hub/a.h": text})), 1)
        self.assertEqual(sizes.violations({"core/mesh/a.h": text}), [])


class Citation(Tree):
    def found(self, version="0.1.0", authors="authors:\n  - name: The Cautery developers\n"):
        self.write("CMakeLists.txt", "project(cautery VERSION 0.1.0 LANGUAGES C)\n")
        self.write("CITATION.cff", f'cff-version: 1.2.0\ntitle: "A title"\nversion: {version}\nlicense: MIT\n{authors}')
        self.write("README.md", "  title   = {A title},\n  author  = {{The Cautery developers}},\n  version = {0.1.0},\n"
                   "## Licence\n\nMIT; why\n")
        return citation.violations(self.root)

    def test_the_same_everywhere_passes(self):
        self.assertEqual(self.found(), [])

    def test_another_version_and_no_author(self):
        self.assertEqual(len(self.found(version="0.2.0")), 1)
        self.assertEqual(len(self.found(authors="")), 2)


class TextRules(Tree):
    LICENCE = "// SPDX-License-Identifier: GPL-3.0-or-later\n"

    def found(self, name, text):
        self.write(name, text)
        return text_rules.violations(self.root, [name])

    def test_clean_file_passes(self):
        self.assertEqual(self.found("core/a.c", self.LICENCE + "int a; // /networks/x todo-list\n"), [])

    def test_licence_line(self):
        for name in ("a.c", "a.h", "a.ts", "a.sh", "a.py"):
            self.assertEqual(len(self.found(name, "x\n")), 1, name)
        self.assertEqual(len(self.found("run", "#!/bin/sh\ntrue\n")), 1)
        self.assertEqual(self.found("run", "#!/bin/sh\n# " + self.LICENCE[3:]), [])

    def test_the_edges_have_another_licence(self):
        apache = self.LICENCE.replace("GPL-3.0-or-later", "Apache-2.0")
        self.assertEqual(self.found("protocol/a.c", apache), [])
        self.assertEqual(len(self.found("protocol/a.c", self.LICENCE)), 1)
        self.assertEqual(len(self.found("core/a.c", apache)), 1)

    def test_leftovers(self):
        for word in ("TO" "DO", "FIX" "ME", "XX" "X"):
            self.assertEqual(len(self.found("a.md", f"see {word}: later\n")), 1, word)

    def test_machine_paths(self):
        for path in ("/wo" "rk/main", "/ro" "ot/.ssh", "/home/" "ann/src"):
            self.assertEqual(len(self.found("a.md", f"in {path}\n")), 1, path)

    def test_cited_pages(self):
        pages = {"core/README.md", "protocol/idl/README.md"}
        for cited, missing in (("core/README.md, \"Contact\"", 0), ("README.md says", 0), ("physics.md, 4", 1),
                               ("protocol/idl/README.md", 0), ("protocol/README.md", 1),
                               ("https://example.org/a.md", 0)):
            found = text_rules.missing_pages("core/tool/a.c", f"// as {cited}\n", pages)
            self.assertEqual(len(found), missing, cited)

    def test_registry_hosts(self):
        self.assertEqual(len(self.found("package-lock.json", "https://registry.np" "mjs.org/x")), 1)


class KnownBugs(Tree):
    def found(self, *rows):
        self.write(known_bugs.PAGE, "| bug | test |\n|---|---|\n" + "".join(f"{row}\n" for row in rows))
        self.write("tests/a/CMakeLists.txt", "cautery_test(NAME a_test SOURCES a.c)\nadd_test(NAME other_test COMMAND x)\n")
        return known_bugs.violations(self.root, [known_bugs.PAGE, "tests/a/CMakeLists.txt"])

    def test_bugs_with_their_tests_pass(self):
        self.assertEqual(self.found("| It leaks. | `a_test` |", "| It hangs. | `other_test` |"), [])

    def test_a_bug_without_a_test(self):
        for row in ("| It leaks. | |", "| It leaks `a_test`. | by hand |", "| It leaks. | `gone_test` |", "| It leaks. | `a_tes` |"):
            self.assertEqual(len(self.found("| It hangs. | `a_test` |", row)), 1, row)


class Words(Tree):
    SHORT = "A session runs. It has a tissue. A client joins it.\n"
    LONG = "One " + "word more " * 10 + "ends here. "

    def found(self, page, open_pages=(), name="a.md", others=()):
        self.write(name, page)
        for other, text in dict(others).items():
            self.write(other, text)
        return words.violations(self.root, sorted({name, *dict(others)}), dict(open_pages), {})

    def test_short_sentences_pass(self):
        self.assertEqual(self.found(self.SHORT), [])

    def test_long_sentences_fail_wherever_they_stand(self):
        for page in (self.LONG * 3, "- " + "\n- ".join([self.LONG] * 3), f"| a |\n|---|\n| {self.LONG} |\n| {self.LONG * 2} |\n",
                     "> " + self.LONG * 3, "  " + self.LONG * 3, "1. " + self.LONG + "\n\n   " + self.LONG * 2,
                     (self.LONG * 3).replace("here.", "here!"), (self.LONG * 3).replace("word", "**word**")):
            found = self.found(page)
            self.assertEqual(len(found), 1, page)
            self.assertIn("words in the mean sentence", found[0])

    def test_what_is_no_sentence_does_not_shorten_the_mean(self):
        for filler in ("## A heading\n\n" * 20, "```\nOne. Two. Three.\n```\n" * 20, "| a | b |\n|---|---|\n" + "| x. | y. |\n" * 20,
                       "    cautery ls. Two. Three.\n\n" * 20):
            self.assertEqual(len(self.found(filler + "\n" + self.LONG * 3)), 1, filler)

    def test_house_words(self):
        for text in ("The clients are told so.", "It is dark.", "Energy is *lit* again.", "It goes\nback.", "There is no room for it.",
                     "| state | meaning |\n|---|---|\n| off | it is made anew |\n", "# Somebody\n", "See [what it tells](a.md).",
                     "A thrown vertex.", "A contact row.", "Likewise, it ends."):
            found = self.found(self.SHORT + "\n" + text)
            self.assertEqual(len(found), 1, text)
            self.assertIn("house word", found[0])

    def test_words_of_the_field_and_code_pass(self):
        for text in ("The dark theme.", "Two rows of a table.", "The `dark` flag.", "```\ncautery tell\n```\n", "The rows of the matrix.",
                     "Legend, darkness-free and tellurium."):
            self.assertEqual(self.found(self.SHORT + "\n" + text), [], text)

    def test_the_list_shrinks_only(self):
        page = self.LONG * 3 + "The client is told. It is told.\n"
        mean = words.up(words.mean_words(page))
        self.assertEqual(self.found(page, {"a.md": (mean, 2)}), [])
        self.assertEqual(len(self.found(page, {"a.md": (mean, 1)})), 1)
        self.assertEqual(len(self.found(self.LONG * 9, {"a.md": (mean, 2)})), 1)
        self.assertIn("take it off", self.found(self.SHORT, {"a.md": (mean, 2)})[0])
        self.assertIn("no page", self.found(self.SHORT, {"gone.md": (20.0, 2)})[0])

    def test_links(self):
        others = {"b/c.md": "# The heading: one, `two`\n# Twice\n# Twice\n", "b/d.c": "int a;\n"}
        for link, broken in (("b/c.md", 0), ("b/", 0), ("b", 0), ("b/c.md#the-heading-one-two", 0), ("b/c.md#twice-1", 0),
                             ("https://example.org/x", 0), ("#here", 0), ("b/e.md", 1), ("c.md", 1), ("b/c.md#other", 1),
                             ("b/c.md#twice-2", 1), ("#there", 1), ("b/d.c#here", 1), ("../b/c.md", 1)):
            for page in (f"# Here\n[text]({link})\n", f'# Here\n[text]({link} "title")\n', f"# Here\n[text][1]\n\n[1]: {link}\n",
                         f'# Here\n<img src="{link}" alt="x">\n', f"# Here\n| [a]({link}) |\n"):
                self.assertEqual(len(self.found(page, others=others)), broken, page)
        self.assertEqual(self.found("```\n[text](gone.md)\n```\n`[text](gone.md)`\n"), [])

    def test_strings_that_users_read(self):
        for name, text, count in (("server/a/a.c", 'say("who is told");', 1), ("server/a/a.c", "// who is told\n", 0),
                                  ("server/a/a.c", '#include "told/a b.h"\n', 0), ("server/a/a.c", 'say("the client"\n " is told");', 1),
                                  ("clients/web/src/a.ts", "say('who is told');", 1), ("clients/web/src/a.ts", "say(`who is ${x} told`);", 1),
                                  ("clients/web/src/a.ts", "const dark = 'dark'; // who is told\n", 0),
                                  ("clients/web/src/a.ts", "x(`precision highp float; vec3 lit;`);", 0),
                                  ("server/store/a.c", 'say("%d rows committed");', 0),
                                  ("protocol/include/cautery/a.def", 'X(a, "it is made anew")', 1), ("core/heat/a.c", 'x("who is told");', 0)):
            self.write(name, text)
            folder = words.folder_of(name)
            self.assertEqual(len(words.violations(self.root, [name], {}, {})), count, text)
            self.assertEqual(words.violations(self.root, [name], {}, {folder: count}), [], text)
            self.assertEqual(len(words.violations(self.root, [name], {}, {folder: 5})), 0 if count else 1, text)


@unittest.skipUnless(shutil.which("clang-format"), "clang-format is not installed")
class Formatting(Tree):
    def test_a_crooked_file_differs_from_its_layout(self):
        self.write(".clang-format", "BasedOnStyle: LLVM\n")
        for text, same in (("int a;\n", True), ("int   a ;\n", False)):
            self.write("a.c", text)
            self.assertEqual(formatting.violations(self.root, ["a.c"]) == [], same)

    def test_tables_in_comments_are_kept_and_prose_is_filled(self):
        ours = os.path.join(os.path.dirname(__file__), "..", "..", ".clang-format")
        shutil.copy(ours, os.path.join(self.root, ".clang-format"))
        table = f"//     tool.move  {'tool ' * 20}\n//     tool.grasp  tool\n".replace(" \n", "\n")
        for text in (table, table.replace("    ", "  ")):
            self.write("a.c", text + "int a;\n")
            self.assertEqual(formatting.violations(self.root, ["a.c"]), [])
            self.assertEqual(len(formatting.all_wide_examples(self.root, ["a.c"])), 1)
        self.write("a.c", f"// {'prose ' * 20}end.\nint a;\n")
        self.assertEqual(len(formatting.violations(self.root, ["a.c"])), 1)
        self.assertEqual(formatting.wide_examples("a.c", "//     short  line\n"), [])


class Includes(Tree):
    FILES = {
        "core/types/cautery/status.h": "",
        "core/include/cautery/session.h": "#include <cautery/status.h>\n",
        "core/mesh/mesh.h": "",
        "core/solve/factor.c": '#include "mesh/mesh.h"\n#include <cholmod.h>\n',
        "protocol/include/cautery/frame.h": '#include "cautery/status.h"\n',
        "protocol/json/scan.h": "",
        "protocol/json/scan.c": '#include "scan.h"\n#include "json/scan.h"\n#include <cjson/cJSON.h>\n',
        "clients/c/client.c": "#include <cautery/frame.h>\n#include <libwebsockets.h>\n",
        "server/main.c": '#include <cautery/frame.h>\n#include <cautery/session.h>\n',
    }

    def found(self, name=None, text=""):
        files = dict(self.FILES)
        if name:
            files[name] = text
        for path, content in files.items():
            self.write(path, content)
        return includes.violations(self.root, sorted(files))

    def test_clean_tree_passes(self):
        self.assertEqual(self.found(), [])

    def test_each_wrong_include_is_found(self):
        wrong = (
            ("core/solve/system.c", "#include <cholmod.h>\n"),
            ("core/solve/system.c", "#include <suitesparse/cholmod.h>\n"),
            ("core/mesh/a.c", "#include <cautery/frame.h>\n"),
            ("core/mesh/a.c", '#include "json/scan.h"\n'),
            ("core/mesh/a.c", '#include "../../protocol/json/scan.h"\n'),
            ("core/mesh/a.c", '  #  include "cJSON.h"\n'),
            ("core/mesh/a.c", "#include <time.h>\n"),
            ("core/mesh/a.c", "#include <sys/socket.h>\n"),
            ("protocol/json/a.c", "#include <cautery/session.h>\n"),
            ("protocol/json/a.c", '#include "mesh/mesh.h"\n'),
            ("protocol/json/a.c", "#include <libwebsockets.h>\n"),
            ("server/a.c", "#include <cjson/cJSON.h>\n"),
            ("clients/c/a.c", "#include <cautery/session.h>\n"),
            ("clients/c/a.c", '#include "json/scan.h"\n'),
            ("clients/c/a.c", '#include "server/x.h"\n#include "core/mesh/mesh.h"\n'),
        )
        for name, text in wrong:
            with self.subTest(name=name, text=text):
                self.assertEqual(len(self.found(name, text)), 1)

    def test_the_shared_types_stay_small(self):
        self.assertEqual(len(self.found("core/types/cautery/a.c", "")), 1)
        self.assertEqual(self.found("core/types/assert.c", '#include "cautery/status.h"\n'), [])
        self.assertEqual(len(self.found("core/types/cautery/a.h", "#include <sys/stat.h>\n")), 1)
        many = [f"core/types/cautery/{i}.h" for i in range(9)]
        for name in many:
            self.write(name, "")
        self.assertEqual(len(includes.shared_type_violations(self.root, many)), 1)


class Examples(Tree):
    HEADER = """// What it is.
//
//     #include "cautery/a.h"
//
//     static int twice(void)
//     {
//         return 2 * %s;
//     }
#pragma once
enum { CAU_A = 1 };
"""

    def found(self, text):
        self.write("core/types/cautery/a.h", text)
        return examples.violations(self.root, ["core/types/cautery/a.h"], "cc")

    def test_a_use_that_compiles_passes(self):
        self.assertEqual(self.found(self.HEADER % "CAU_A"), [])

    def test_none_and_a_broken_one_are_found(self):
        self.assertEqual(len(self.found("// What it is.\n#pragma once\n")), 1)
        self.assertEqual(len(self.found(self.HEADER % "CAU_B")), 1)


class Compiled(Tree):
    def compiled(self, source, text):
        path = self.write(f"{source.split('/')[0]}/CMakeFiles/t.dir/{source.split('/', 1)[1]}", text)
        subprocess.run(["cc", "-w", "-O1", "-c", path, "-o", path + ".o"], check=True)
        return source.split("/")[0], path + ".o"

    @staticmethod
    def needing(name, *needed):
        """A file that defines cau_<name> and calls cau_<needed>."""
        calls = "".join(f"void cau_{n}(void);\n" for n in needed)
        return calls + f"void cau_{name}(void) {{ {' '.join(f'cau_{n}();' for n in needed)} }}\n"


class Circles(Compiled):
    def found(self, *sources, allowed=()):
        return circles.violations([self.compiled(*source) for source in sources], allowed)

    def test_files_above_files_pass(self):
        top, middle, low = self.needing("a", "b", "c"), self.needing("b", "c"), self.needing("c")
        self.assertEqual(self.found(("server/x/a.c", top), ("server/x/b.c", middle), ("server/x/c.c", low)), [])

    def test_a_circle_of_files_is_named(self):
        found = self.found(("server/x/a.c", self.needing("a", "b")), ("server/x/b.c", self.needing("b", "c")),
                           ("server/x/c.c", self.needing("c", "a")), ("server/x/d.c", self.needing("d", "a")))
        self.assertEqual(len(found), 1)
        self.assertIn("server/x: 3 of 4 files", found[0])
        self.assertIn("a.c needs cau_b of b.c", found[0])

    def test_a_room_on_the_list_must_have_a_circle(self):
        circle = ("server/x/a.c", self.needing("a", "b")), ("server/x/b.c", self.needing("b", "a"))
        self.assertEqual(self.found(*circle, allowed={"server/x": "a reason"}), [])
        found = self.found(("server/x/a.c", self.needing("a")), allowed={"server/x": "a reason"})
        self.assertEqual(len(found), 1)

    def test_a_circle_of_rooms_is_named(self):
        found = self.found(("server/x/a.c", self.needing("a", "b")), ("server/y/b.c", self.needing("b")),
                           ("server/y/c.c", self.needing("c", "d")), ("server/x/d.c", self.needing("d")))
        self.assertEqual(len(found), 1)
        self.assertIn("rooms need each other", found[0])

    def test_a_name_that_two_programs_have_is_the_near_one(self):
        self.assertEqual(self.found(("clients/x/a.c", self.needing("a", "b")), ("clients/x/b.c", self.needing("b")),
                                    ("clients/y/b.c", self.needing("b", "c")), ("clients/y/c.c", self.needing("c", "a"))),
                         [])


class Licences(Compiled):
    APACHE = "// SPDX-License-Identifier: Apache-2.0\n"
    GPL = "// SPDX-License-Identifier: GPL-3.0-or-later\n"
    FILES = {
        "protocol/LICENSE": "the text",
        "deploy/debian/copyright": "".join(f"Files: {folder}*\n" for folder in licences.EDGES),
        "core/types/cautery/status.h": APACHE,
        "core/include/cautery/session.h": GPL + '#include "cautery/status.h"\n',
        "core/mesh/mesh.h": GPL,
        "protocol/json/scan.h": APACHE,
        "protocol/json/scan.c": APACHE + '#include "json/scan.h"\n#include <cjson/cJSON.h>\n#include "cautery/status.h"\n',
        "clients/web/src/wire/header.ts": APACHE + "import { decode } from 'meshoptimizer/decoder';\n",
        "clients/web/src/wire/decoder.ts": APACHE + "import { header } from './header';\n",
        "clients/web/src/wire/worker.ts": GPL + "import { model } from '../model/model';\n",
        "clients/web/src/model/model.ts": GPL + "import { header } from '../wire/header';\n",
    }
    LINKS = [("core", "cautery_types", ["cautery_compiler"]), ("core", "cautery_core", ["cautery_types", "cholmod"]),
             ("protocol", "cautery_protocol", ["cautery_types", "cautery_compiler", "PkgConfig::CJSON"])]

    def found(self, files=(), links=(), objects=(), without=(), sources=()):
        every = {name: text for name, text in {**self.FILES, **dict(files)}.items() if name not in without}
        for path, content in every.items():
            self.write(path, content)
        return licences.violations(self.root, sorted(every), [self.compiled(*o) for o in objects],
                                   [*self.LINKS, *links], list(sources))

    def test_edges_that_stand_alone_pass(self):
        self.assertEqual(self.found(objects=[("protocol/a.c", self.needing("a", "b")),
                                             ("core/types/b.c", self.needing("b")),
                                             ("core/c.c", self.needing("c", "a"))]), [])

    def test_a_file_under_the_licence_of_the_other_side(self):
        for name, text in (("protocol/a.c", self.GPL), ("core/a.c", self.APACHE), ("clients/include/a.h", self.GPL),
                           ("clients/web/src/wire/new.ts", self.GPL), ("clients/web/src/wire/worker.ts", self.APACHE),
                           ("protocol/idl/a.idl", self.GPL), ("protocol/include/cautery/a.def", self.GPL),
                           ("protocol/make.sh", "#!/bin/sh\n# " + self.GPL[3:])):
            self.assertEqual(len(self.found({name: text})), 1, name)

    def test_an_include_or_import_of_what_is_under_the_gpl(self):
        for name, line in (("protocol/json/a.c", "#include <cautery/session.h>"),
                           ("protocol/json/a.c", '#  include "../../core/mesh/mesh.h"'),
                           ("protocol/json/a.c", '#include "mesh/mesh.h"'),
                           ("clients/library/a.c", '#include "cautery/session.h"'),
                           ("core/types/cautery/a.h", '#include "mesh/mesh.h"'),
                           ("core/types/cautery/a.h", "#include <suitesparse/cholmod.h>"),
                           ("clients/web/src/wire/a.ts", "import { model } from '../model/model';"),
                           ("clients/web/src/wire/a.ts", "import type { Model } from '../model/model';"),
                           ("clients/web/src/wire/a.ts", 'export * from "./worker";'),
                           ("clients/web/src/wire/a.ts", "const late = await import('../model/model');"),
                           ("clients/web/src/wire/a.ts", "import '../model/model.ts';"),
                           ("clients/web/src/wire/a.ts", "new Worker(new URL('./worker.ts', import.meta.url));"),
                           ("clients/web/src/wire/a.ts", '/// <reference path="../model/model.ts" />')):
            self.assertEqual(len(self.found({name: self.APACHE + line + "\n"})), 1, line)

    def test_a_python_module_of_the_edges_does_not_load_the_core(self):
        head = "# SPDX-License-Identifier: "
        for line in ("import cautery_core", "from cautery_core.environments import PartBand",
                     "importlib.import_module('cautery_core')", "ctypes.CDLL('libcautery-core.so.0.1')"):
            self.assertEqual(len(self.found({"clients/python/a.py": f"{head}Apache-2.0\n{line}\n"})), 1, line)
            self.assertEqual(self.found({"clients/python_core/a.py": f"{head}GPL-3.0-or-later\n{line}\n"},
                                        without=("clients/python/a.py",)), [], line)
        self.assertEqual(self.found({"clients/python/a.py": f"{head}Apache-2.0\n\"\"\"Not as cautery_core.\"\"\"\n"}), [])

    def test_a_call_of_what_is_under_the_gpl(self):
        found = self.found(objects=[("protocol/a.c", self.needing("a", "b")), ("core/b.c", self.needing("b"))])
        self.assertEqual(len(found), 1)
        self.assertIn("calls cau_b", found[0])

    def test_a_link_to_what_is_under_the_gpl(self):
        for folder, target, named in (("clients/library", "cautery_client", ["cautery_core"]),
                                      ("clients/library", "cautery_client", ["cautery_types", "SuiteSparse::CHOLMOD"]),
                                      ("protocol/json", "cautery_json", ["cautery_protocol", "cholmod"])):
            self.assertEqual(len(self.found(links=[(folder, target, named)])), 1, named)

    def test_a_target_that_is_made_from_what_is_under_the_gpl(self):
        self.write("core/mesh/mesh.c", "")
        self.write("build/protocol/generated.c", "")
        for sources in (["json/scan.c"], ["$<TARGET_OBJECTS:cautery_types>"], ["../build/protocol/generated.c"],
                        [os.path.join(self.root, "protocol/json/scan.c")]):
            self.assertEqual(self.found(sources=[("protocol", "cautery_protocol", sources)]), [], sources)
        for sources in (["../core/mesh/mesh.c"], ["$<TARGET_OBJECTS:cautery_core>"],
                        [os.path.join(self.root, "core/mesh/mesh.c")]):
            for folder, target in (("protocol", "cautery_protocol"), ("deploy", "cautery-client"), ("core", "cautery_types")):
                self.assertEqual(len(self.found(sources=[(folder, target, sources)])), 1, sources)
            self.assertEqual(self.found(sources=[("deploy", "other", sources)]), [])

    def test_the_text_and_the_package_go_with_it(self):
        self.assertEqual(len(self.found(without=["protocol/LICENSE"])), 1)
        self.assertEqual(len(self.found({"deploy/debian/copyright": "Files: *\n"})), 3)


class Arrows(Compiled):
    LINKS = [("server/low", "cautery_low", ["cautery_types"]), ("server/high", "cautery_high", ["cautery_low"])]
    PAGE = "| folder | what | knows |\n|---|---|---|\n| `low/` | x | |\n| `high/` | y | `low/` |\n"
    FILES = {
        "server/README.md": PAGE,
        "server/low/low.h": "",
        "server/low/low.c": '#include "low/low.h"\n',
        "server/high/high.h": "",
        "server/high/high.c": '#include "high/high.h"\n#include "low/low.h"\n#include <sys/stat.h>\n',
    }

    def found(self, files=(), links=None, objects=()):
        every = {**self.FILES, **dict(files)}
        for path, content in every.items():
            self.write(path, content)
        return arrows.violations(self.root, sorted(every), [self.compiled(*o) for o in objects],
                                 links or self.LINKS)

    def test_rooms_as_drawn_pass(self):
        self.assertEqual(self.found(objects=[("server/high/a.c", self.needing("a", "b")),
                                             ("server/low/b.c", self.needing("b"))]), [])

    def test_an_include_beside_the_link_lines(self):
        found = self.found({"server/low/low.c": '#include "high/high.h"\n'})
        self.assertEqual(len(found), 1)
        self.assertIn("includes from high/", found[0])

    def test_a_call_beside_the_link_lines(self):
        found = self.found(objects=[("server/low/a.c", self.needing("a", "b")),
                                    ("server/high/b.c", self.needing("b"))])
        self.assertEqual(len(found), 1)
        self.assertIn("calls high/", found[0])

    def test_link_lines_in_a_circle(self):
        links = [("server/low", "cautery_low", ["cautery_high"]), self.LINKS[1]]
        page = self.PAGE.replace("x | |", "x | `high/` |")
        found = self.found({"server/README.md": page}, links)
        self.assertEqual(len(found), 1)
        self.assertIn("circle", found[0])

    def test_a_page_that_draws_another_house(self):
        for page in (self.PAGE.replace("y | `low/` |", "y | |"), self.PAGE.replace("| `low/` | x | |\n", ""),
                     self.PAGE + "| `gone/` | z | |\n"):
            self.assertEqual(len(self.found({"server/README.md": page})), 1, page)

    def test_a_folder_without_a_target(self):
        self.assertEqual(len(self.found({"server/new/new.c": ""})), 1)


class Symbols(Compiled):
    def found(self, *sources):
        return symbols.violations([self.compiled(*source) for source in sources])

    @staticmethod
    def call(function):
        return f"void {function}(void);\nvoid cau_f(void) {{ {function}(); }}\n"

    def test_allowed_needs_pass(self):
        for source, function in (("core/solve/factor.c", "cholmod_solve2"), ("core/mesh/file.c", "fopen"),
                                 ("core/base/pool.c", "pthread_create"), ("protocol/json.c", "cJSON_Delete"),
                                 ("server/ws.c", "lws_service"), ("server/clock.c", "clock_gettime")):
            with self.subTest(source=source):
                self.assertEqual(self.found((source, self.call(function))), [])

    def test_each_wrong_need_is_found(self):
        for source, function in (("core/solve/system.c", "cholmod_solve2"), ("server/a.c", "cholmod_start"),
                                 ("core/mesh/a.c", "cJSON_Parse"), ("server/a.c", "cJSON_Parse"),
                                 ("protocol/a.c", "lws_write"), ("core/a.c", "dds_write"),
                                 ("core/heat/a.c", "socket"), ("core/heat/a.c", "connect"),
                                 ("core/heat/a.c", "clock_gettime"), ("core/heat/a.c", "time"),
                                 ("core/heat/a.c", "fopen"), ("core/heat/a.c", "fopen64"),
                                 ("core/heat/a.c", "pthread_create"), ("core/heat/a.c", "__printf_chk"),
                                 ("core/heat/a.c", "puts"), ("core/heat/a.c", "exit"),
                                 ("core/heat/a.c", "rand"), ("protocol/a.c", "fopen"),
                                 ("protocol/a.c", "getenv")):
            with self.subTest(source=source, function=function):
                self.assertEqual(len(self.found((source, self.call(function)))), 1)

    def test_a_weak_need_counts(self):
        text = "__attribute__((weak)) void dds_write(void);\nvoid cau_f(void) { if (dds_write) dds_write(); }\n"
        self.assertEqual(len(self.found(("core/a.c", text))), 1)

    def test_doors_between_rooms(self):
        core = ("core/step.c", "void cau_step(void) {}\n")
        use = "void cau_step(void);\nvoid {0}(void) {{ cau_step(); }}\n"
        self.assertEqual(self.found(core, ("server/a.c", use.format("cau_a"))), [])
        self.assertEqual(len(self.found(core, ("protocol/a.c", use.format("cau_a")))), 1)
        self.assertEqual(len(self.found(core, ("clients/a.c", use.format("cau_a")))), 1)

    def test_assertions_are_where_they_are_on_and_nowhere_else(self):
        failed = "void cau_assert_failed(void);\nvoid {0}(void) {{ cau_assert_failed(); }}\n"
        bare = [self.compiled("core/a.c", "int cau_a;\n")]
        asserting = [self.compiled("core/b.c", failed.format("cau_b"))]
        self.assertEqual(assertions.violations(bare, on=False), [])
        self.assertEqual(len(assertions.violations(bare + asserting, on=False)), 1)
        self.assertEqual(assertions.violations(bare + asserting, on=True), [])
        self.assertEqual(len(assertions.violations(bare, on=True)), 1)

    def test_a_failed_assertion_may_end_the_program_from_every_room(self):
        end = ("core/types/assert.c", "void abort(void);\nvoid cau_assert_failed(void) { abort(); }\n")
        use = "void cau_assert_failed(void);\nvoid {0}(void) {{ cau_assert_failed(); }}\n"
        self.assertEqual(self.found(end, ("core/a.c", use.format("cau_a")),
                                    ("protocol/a.c", use.format("cau_b"))), [])
        self.assertEqual(len(self.found(("core/a.c", "void abort(void);\nvoid cau_a(void) { abort(); }\n"))), 1)

    def test_exported_names(self):
        self.assertEqual(len(self.found(("core/a.c", "void helper(void) {}\n"))), 1)


if __name__ == "__main__":
    unittest.main()
