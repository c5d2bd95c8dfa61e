# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a manual page from what a program says of itself: `--help`, `--version`, its settings.

Usage: make_page.py PAGE PROGRAM FILE      PAGE is for example cautery.1; FILE ends with .gz

A help text is: a line of synopsis, lines that say what it is for, then paragraphs and options, the
latter two blanks in, each `--name ARGUMENT`, two blanks or more, what it means.
"""

import gzip
import json
import os
import re
import subprocess
import sys

OPTION = re.compile(r"^  (\S.*?)(?:  +|$)(.*)$")
COMMAND = re.compile(r"^  (\w+(?: \w+)?)  +(\S.*)$")

# What no program knows of itself: the line for `apropos`, and where to read on.
ABOUT = {
    "cauteryd.8": ("simulation server for energized soft-tissue dissection", ["cauteryd.json(5)", "cautery(1)"]),
    "cauteryd.json.5": ("settings of cauteryd", ["cauteryd(8)"]),
    "cautery.1": ("command line of cauteryd", ["cauteryd(8)", "cautery-load(1)"]),
    "cautery-sim.1": ("run a scene of Cautery without a server", ["cauteryd(8)", "cautery(1)"]),
    "cautery-mesh.1": ("fill a surface or a segmentation with tetrahedra", ["cautery(1)", "cauteryd(8)"]),
    "cautery-load.1": ("load a running cauteryd and measure what its clients see", ["cauteryd(8)", "cautery(1)"]),
    "cautery-robot.1": ("drive a tool of cauteryd over DDS", ["cauteryd(8)", "cautery(1)"]),
}


def ask(program, *arguments):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}
    return subprocess.run([program, *arguments], env=environment, check=True, text=True, timeout=60,
                          stdout=subprocess.PIPE).stdout


def text(words):
    """As running text: what roff would read as an order of its own is quoted; `code` becomes bold."""
    words = words.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    words = re.sub(r"`([^`]*)`", r"\\fB\1\\fR", words)
    return "\\&" + words if words.startswith(".") else words


def item(left, meaning):
    """An option or a command: its name bold, its argument in italics."""
    name, _, argument = left.partition(" ")
    tag = f"\\fB{text(name)}\\fR" + (f" \\fI{text(argument)}\\fR" if argument else "")
    return [".TP", tag, text(meaning) if meaning else "\\&"]


def body(lines):
    """Paragraphs and options of a help text."""
    made, before = [], ""
    for line in lines:
        option = OPTION.match(line)
        if not line:
            before = ""
            continue
        if line.startswith("   ") and before.startswith("  "):
            made.append(text(line.strip()))  # more about an option
        elif line.startswith("Exit code: "):
            made += [".SH EXIT STATUS", text(line[len("Exit code: "):])]
        elif option:
            made += item(option[1], option[2])
        elif before == "":
            made += [".PP", text(line)]
        else:
            made.append(text(line))
        before = line
    return made


def parts(said):
    """The synopsis, the lines that say what it is for, and the rest."""
    lines = said.rstrip("\n").split("\n")
    end = lines.index("") if "" in lines else len(lines)
    return lines[0].rstrip(), [line.rstrip() for line in lines[1:end]], lines[end:]


def synopsis(line):
    name, _, rest = line.partition(" ")
    return [".SH SYNOPSIS", f"\\fB{text(name)}\\fR \\fI{text(rest)}\\fR"]


def page_of_program(program):
    line, purpose, rest = parts(ask(program, "--help"))
    return synopsis(line) + [".SH DESCRIPTION"] + [text(words) for words in purpose] + body(rest)


def page_of_commands(program):
    """A program with commands: each has a help text of its own, less the options that all have."""
    said = ask(program, "--help")
    line, purpose, rest = parts(said)
    made = synopsis(line) + [".SH DESCRIPTION"] + [text(words) for words in purpose]
    names = [found[1] for found in map(COMMAND.match, rest) if found]
    assert names, "no commands in the help text"
    made += body([words for words in rest if not COMMAND.match(words)])
    made.append(".SH COMMANDS")
    for name in names:
        line, purpose, rest = parts(ask(program, *name.split(), "--help"))
        own = [words for words in rest if not words.startswith("  --") or words not in said.split("\n")]
        made += [f".SS {text(line)}", *map(text, purpose), *body(own)]
    # the exit codes are about all of it, so they stand behind the commands
    status = made.index(".SH EXIT STATUS")
    commands = made.index(".SH COMMANDS")
    return made[:status] + made[commands:] + made[status:commands]


def bounds_of(setting):
    if "minimum" in setting:
        return f"{setting['type']}, {setting['minimum']:.15g} to {setting['maximum']:.15g}"
    return {"string": "text", "boolean": "true or false"}[setting["type"]]


def page_of_settings(program):
    settings = json.loads(ask(program, "--settings-schema"))["properties"]
    made = [".SH DESCRIPTION",
            text("`cauteryd --config` reads a file with one JSON object. Its members are the settings below."),
            text("Each setting is also a flag and a variable of the environment: `max_sessions` is `--max-sessions` and"),
            text("`CAUTERY_MAX_SESSIONS`. A flag overrides the variable, and the variable overrides the file."),
            text("`cauteryd --settings-schema` prints a JSON Schema of the file."),
            ".SH SETTINGS"]
    for name, setting in settings.items():
        default = json.dumps(setting["default"])
        made += [".TP", f"\\fB{text(name)}\\fR ({text(bounds_of(setting))}; default {text(default)})",
                 text(setting["description"]) + "."]
    return made + [".SH EXAMPLES", ".nf", text('{"listen": "127.0.0.1", "port": 8740, "demo": "layers"}'), ".fi"]


def page(name, program):
    purpose, see = ABOUT[name]
    title, section = name.rsplit(".", 1)
    version = ask(program, "--version").split()[1]
    makers = {"cauteryd.json.5": page_of_settings, "cautery.1": page_of_commands}
    made = [f".TH {title.upper()} {section} \"\" \"Cautery {version}\"",
            ".SH NAME", f"{text(title)} \\- {text(purpose)}"]
    made += makers.get(name, page_of_program)(program)
    references = [f"\\fB{text(word[:-3])}\\fR{word[-3:]}" for word in see]
    return "\n".join(made + [".SH SEE ALSO", ",\n".join(references)]) + "\n"


if __name__ == "__main__":
    os.makedirs(os.path.dirname(sys.argv[3]), exist_ok=True)
    with open(sys.argv[3], "wb") as made_file:  # without a time, so that each build makes the same bytes
        with gzip.GzipFile("", "wb", 9, made_file, 0) as packed:
            packed.write(page(sys.argv[1], sys.argv[2]).encode())
