# SPDX-License-Identifier: GPL-3.0-or-later
"""The structs of the package are those of the headers. PYTHONPATH has the package; INCLUDES, CC: how headers compile."""

import ctypes
import os
import re
import subprocess
import tempfile
import unittest

from cautery_core import layout



def compiled(lines):
    """What a C program with these lines in main prints, as words of each line."""
    with tempfile.TemporaryDirectory() as folder:
        source, program = os.path.join(folder, "a.c"), os.path.join(folder, "a")
        with open(source, "w", encoding="utf-8") as file:
            file.write("#include <stddef.h>\n#include <stdio.h>\n#include \"cautery/embed.h\"\nint main(void)\n{\n"
                       + "\n".join(lines) + "\nreturn 0;\n}\n")
        includes = [f"-I{folder}" for folder in os.environ["INCLUDES"].split(":")]
        subprocess.run([os.environ["CC"], "-std=gnu17", "-o", program, *includes, source], check=True)
        return [line.split() for line in subprocess.run([program], check=True, capture_output=True,
                                                        text=True).stdout.splitlines()]


class Layout(unittest.TestCase):
    def test_sizes_and_places_of_all_members(self):
        lines, expected = [], []
        for kind, name in layout.C_NAMES.items():
            lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
            expected.append([name, str(ctypes.sizeof(kind))])
            for member, *_ in kind._fields_:
                field = getattr(kind, member)
                lines.append(f'printf("{name}.{member} %zu %zu\\n", offsetof({name}, {member}), '
                             f'sizeof(({{ {name} *x = 0; x; }})->{member}));')
                expected.append([f"{name}.{member}", str(field.offset), str(field.size)])
        self.assertGreater(len(expected), 100)
        self.assertEqual(compiled(lines), expected)

    def test_words_are_those_of_the_tables_in_order(self):
        tables = {"CAU_STATUS_TABLE": layout.STATUSES, "CAU_LAYER_TABLE": layout.LAYER_KINDS,
                  "CAU_STAGE_TABLE": layout.STAGES}
        for table, words in tables.items():
            with self.subTest(table):
                found = compiled(["#define X(code, name, ...) printf(\"%s\\n\", name);", f"{table}(X)"])
                self.assertEqual([word for word, in found], list(words))
        shapes = compiled(["#define X(code, name, ...) printf(\"%s\\n\", #name);", "CAU_TOOL_SHAPE_TABLE(X)"])
        self.assertEqual([word for word, in shapes], list(layout.SHAPES))
        sizes = compiled(["#define X(name, ...) printf(\"%s\\n\", #name);", "CAU_TOOL_TABLE(X)"])
        self.assertEqual([word for word, in sizes], list(layout.TOOL_SIZES))

    def test_scalars_have_their_place_and_their_bit(self):
        found = compiled(["#define ROW(X, code, name, ...) printf(\"%s %d\\n\", #name, CAU_CHANNEL_##code);",
                          "CAU_CHANNEL_ROWS(CAU_NO_ROW, ROW, )"])
        self.assertEqual(found, [[name, str(bit)] for name, bit in layout.SCALARS.items()])

    def test_functions_have_as_many_parameters(self):
        text = ""
        for folder in os.environ["INCLUDES"].split(":"):
            for name in ("embed.h", "session.h"):
                path = os.path.join(folder, "cautery", name)
                if os.path.exists(path):
                    with open(path, encoding="utf-8") as file:
                        text += re.sub(r"//[^\n]*", "", file.read())
        for name, (_, parameters) in layout.FUNCTIONS.items():
            with self.subTest(name):
                [found] = re.findall(rf"\b{name}\(([^;]*)\);", text)
                count = 0 if found.strip() == "void" else found.count(",") + 1
                self.assertEqual(len(parameters), count)


if __name__ == "__main__":
    unittest.main()
