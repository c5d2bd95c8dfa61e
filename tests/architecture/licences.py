# SPDX-License-Identifier: GPL-3.0-or-later
"""The edges that others link or generate from are under Apache-2.0, and nothing under the GPL gets into them.

Usage: licences.py ROOT OBJECT_LIST LINK_LIST SOURCE_LIST

Everything else is under GPL-3.0-or-later, because it is, or embeds, the core, which needs CHOLMOD. Each
file says its own licence. A file of the edges includes, imports and calls only files of the edges, and
a target of the edges is made from and links nothing that is outside them. OBJECT_LIST and LINK_LIST are as in
arrows.py; SOURCE_LIST has the sources of each target in the form of LINK_LIST. deploy/manual/licences.md says what this means for those who use Cautery.
"""

import os
import posixpath
import re
import sys

import arrows
import circles
import project
import symbols

GPL = "GPL-3.0-or-later"
APACHE = "Apache-2.0"

EDGES = ("protocol/", "core/types/", "clients/library/", "clients/haptics/", "clients/include/", "clients/python/",
         "clients/javascript/", "clients/web/src/wire/", "deploy/instruments/")
# The viewer's own workers, and the link to them: they stand beside the wire module and need the viewer's model.
OUTSIDE = {"clients/web/src/wire/" + name
           for name in ("feed.ts", "link.ts", "mcap_worker.ts", "worker.ts", "worker_messages.ts")}

# Targets that are built from files of the edges in a folder outside (the second is what is installed), and build
# flags, which hold no code.
EDGE_TARGETS = {"cautery_types", "cautery-client"}
NO_CODE = {"cautery_compiler"}
# Libraries under the GPL, as link lines and includes name them.
GPL_LIBRARY = re.compile(r"(?i)(cholmod|suitesparse|amd\.h|camd\.h|colamd)")

LICENCE = re.compile(r"SPDX-License-Identifier: ([\w.-]+)")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
IMPORT = re.compile(r"""(?:\bfrom|\bimport|\bimport\(|\brequire\(|\bnew URL\(|<reference path=)\s*['"](\.[^'"]+)['"]""")
# The Python package that loads the core, in an import or in the words of one.
PYTHON_CORE = re.compile(r"\b(import|from)\s+cautery_core\b|['\"]cautery_core['\"]|\blibcautery-core\b")
INCLUDE_FOLDERS = ("core/include", "core/types", "protocol/include", "clients/include", "core", "protocol",
                   "server", "clients", "tests")
HEAD_LINES = 3  # a #! line may come first


def is_edge(name):
    return name.startswith(EDGES) and name not in OUTSIDE


def licence_of(name):
    return APACHE if is_edge(name) else GPL


def licence_violation(name, text):
    said = [found for line in text.splitlines()[:HEAD_LINES] for found in LICENCE.findall(line)]
    if said and said != [licence_of(name)]:
        return f"{name}: is under {' and '.join(said)}, and its place is under {licence_of(name)}"
    return None


def needed_files(name, text, files):
    """Files of the project that `text` includes or imports, as far as their names say it."""
    here = posixpath.dirname(name)
    found = set()
    for header in INCLUDE.findall(text):
        places = [posixpath.normpath(posixpath.join(folder, header)) for folder in (here, *INCLUDE_FOLDERS)]
        found.update(next(([place] for place in places if place in files), []))
    for path in IMPORT.findall(text):
        beside = posixpath.normpath(posixpath.join(here, path))
        places = [beside + ending for ending in ("", ".ts", ".mjs", ".js", "/index.ts")]
        found.update(next(([place] for place in places if place in files), []))
    return found


def file_violations(root, files):
    found, known = [], set(files)
    for name in files:
        text = project.read_text(root, name)
        if text is None:
            continue
        violation = licence_violation(name, text)
        found += [violation] if violation else []
        if is_edge(name) and os.path.splitext(name)[1] != ".md":
            found += [f"{name}: needs {other}, which is under {GPL}"
                      for other in sorted(needed_files(name, text, known)) if not is_edge(other)]
            found += [f"{name}: includes <{header}>, a library under the GPL"
                      for header in INCLUDE.findall(text) if GPL_LIBRARY.search(header)]
        if is_edge(name) and name.endswith(".py") and PYTHON_CORE.search(text):
            found.append(f"{name}: imports the core, which is under {GPL}")
    return found


def call_violations(objects):
    return [f"{source}: calls {sorted(names)[0]} of {other}, which is under {GPL}"
            for source, others in sorted(circles.needs_of(objects).items()) if is_edge(source)
            for other, names in sorted(others.items()) if not is_edge(other)]


def edge_targets(lines):
    return {target for folder, target, _ in lines if is_edge(folder + "/")} | EDGE_TARGETS


def is_built(path):
    return path.startswith("build")


def link_violations(links):
    edges = edge_targets(links)
    ours = {target for _, target, _ in links} | NO_CODE
    return [f"{folder}: {target} links {name}, which is under the GPL"
            for folder, target, named in links if target in edges for name in named
            if (name in ours and name not in edges | NO_CODE) or GPL_LIBRARY.search(name)]


def source_violations(root, sources):
    """`sources`: (folder, target, its sources), each a path, a target's objects, or a path in a build tree."""
    edges = edge_targets(sources)
    found = []
    for folder, target, named in sources:
        for name in named if target in edges else []:
            objects = re.fullmatch(r"\$<TARGET_OBJECTS:([\w-]+)>", name)
            path = posixpath.relpath(posixpath.join(root, folder, name), root)
            ours = not path.startswith("..") and os.path.exists(os.path.join(root, path))
            if (objects and objects.group(1) not in edges) or (ours and not is_edge(path) and not is_built(path)):
                found.append(f"{folder}: {target} is made from {name}, which is under {GPL}")
    return found


def text_violations(root, files):
    """The edges carry their licence's text with them, and the packages name it."""
    found = [] if "protocol/LICENSE" in files else ["protocol/LICENSE: the edges carry no text of their licence"]
    page = project.read_text(root, "deploy/debian/copyright") if "deploy/debian/copyright" in files else ""
    found += [f"deploy/debian/copyright: does not name {folder}" for folder in EDGES
              if any(name.startswith(folder) for name in files) and f"{folder}*" not in page]
    return found


def violations(root, files, objects, links, sources):
    return (file_violations(root, files) + call_violations(objects) + link_violations(links)
            + source_violations(root, sources) + text_violations(root, files))


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    pairs, missing = symbols.read_list(sys.argv[2])
    links, sources = arrows.read_links(sys.argv[3]), arrows.read_links(sys.argv[4])
    missing += [f"{name}: lists no target" for name, lines in zip(sys.argv[3:5], (links, sources)) if not lines]
    project.finish(missing or violations(sys.argv[1], every, pairs, links, sources), len(every))
