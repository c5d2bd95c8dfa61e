# SPDX-License-Identifier: GPL-3.0-or-later
"""follow.py does what a page says, and nothing that it does not say."""

import os
import tempfile
import unittest

import follow

PAGE = """# Page

## Adding a thing

1. The row. In `table.h`, above the line `/* the end */`:

   ```c
   	ROW(new)
   ```

2. What makes it. Make `things/new.c`:

   ```c
   int thing(void)
   {
   	return 1;
   }
   ```

3. Its place: in `list.txt`, below the line `first`:

   ```
   second
   ```

   And in `list.txt`, in place of the line `last`:

   ```
   third
   last
   ```

4. Try it. Run:

   ```sh
   cat list.txt
   grep -c ROW table.h
   ```

## Another

Nothing.
"""


def write(folder, name, text):
    path = os.path.join(folder, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def read(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return file.read()


class Following(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.copy = folder.name
        write(self.copy, "table.h", "\tROW(old)\n\t/* the end */\n")
        write(self.copy, "list.txt", "first\n  last\n")

    def follow(self, page):
        steps = follow.steps_of(follow.section_of(page, "Adding a thing"))
        follow.edit_all(self.copy, steps)
        return follow.run_all(self.copy, steps)

    def refuse(self, page, words):
        with self.assertRaisesRegex(follow.Wrong, words):
            self.follow(page)

    def test_every_kind_of_step(self):
        said = self.follow(PAGE)
        self.assertEqual(read(self.copy, "table.h"), "\tROW(old)\n\tROW(new)\n\t/* the end */\n")
        self.assertEqual(read(self.copy, "things/new.c"), "int thing(void)\n{\n\treturn 1;\n}\n")
        self.assertEqual(read(self.copy, "list.txt"), "first\nsecond\nthird\nlast\n")
        self.assertEqual(said, "first\nsecond\nthird\nlast\n2\n")

    def test_what_does_not_fit_is_refused(self):
        self.refuse(PAGE.replace("`first`", "`fist`"), "is there 0 times")
        self.refuse(PAGE, "is there already")
        os.remove(os.path.join(self.copy, "things/new.c"))
        write(self.copy, "list.txt", "first\nfirst\nlast\n")
        self.refuse(PAGE, "is there 2 times")

    def test_nothing_is_left_to_the_reader(self):
        self.refuse(PAGE.replace("Make `things/new.c`:", "A new file:"), "without a sentence")
        self.refuse(PAGE.replace("4. Try it. Run:", "Make `a`:\n\n4. Try it. Run:"), "no block follows")
        self.refuse(PAGE.replace("## Adding a thing", "## Adding"), "no section")
        self.refuse("## Adding a thing\n\nThink.\n", "no steps")

    def test_edits_alone_run_nothing(self):
        steps = follow.steps_of(follow.section_of(PAGE.replace("cat list.txt", "false"), "Adding a thing"))
        self.assertEqual(follow.edit_all(self.copy, steps), {"table.h", "things/new.c", "list.txt"})
        self.assertEqual(read(self.copy, "list.txt"), "first\nsecond\nthird\nlast\n")

    def lists(self, *texts, tests="t"):
        for number, text in enumerate(texts):
            write(self.copy, f"{number}.md", f"# P\n\n## S\n\n{text}")
        return [follow.List(self.copy, f"{number}.md", "S", 1, tests) for number in range(len(texts))]

    def test_each_list_runs_its_own_tests(self):
        passes = "Run:\n\n```sh\necho ' t ...   Passed '\n```\n"
        one, other = self.lists(passes, "Run:\n\n```sh\ntrue\n```\n")
        one.run(self.copy)
        with self.assertRaisesRegex(follow.Wrong, "the test t was not run"):
            other.run(self.copy)

    def test_what_is_written_counts_for_its_page(self):
        writes = "Make `{}.txt`:\n\n```\na\n```\n\nRun:\n\n```sh\necho ' t ...   Passed '; date >written.txt\n```\n"
        one, other = self.lists(writes.format("one"), writes.format("other").replace("date >written.txt", "true"))
        for each in (one, other):
            each.edit(self.copy)
        follow.run_lists(self.copy, [one, other])
        self.assertEqual((one.changed, other.changed), ({"one.txt", "written.txt"}, {"other.txt"}))
        other.page = one.page
        follow.run_lists(self.copy, [one, other])
        with self.assertRaisesRegex(follow.Wrong, "more than 1 files"):
            one.count()

    def test_what_runs_ends_a_list(self):
        self.refuse(PAGE.replace("## Another", "5. Make `late.txt`:\n\n   ```\n   late\n   ```\n\n## Another"),
                    "after what is to be run")

    def test_a_script_that_fails_ends_it(self):
        self.refuse(PAGE.replace("cat list.txt", "false"), "exit code 1")

    def test_changes_are_counted(self):
        write(self.copy, "kept.txt", "kept\n")
        before = follow.fingerprints(self.copy)
        write(self.copy, "build/made.o", "")
        self.follow(PAGE)
        self.assertEqual(follow.changed_files(self.copy, before), ["list.txt", "table.h", "things/new.c"])


if __name__ == "__main__":
    unittest.main()
