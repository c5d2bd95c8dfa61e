# SPDX-License-Identifier: GPL-3.0-or-later
"""No file needs itself by way of others, and no room does. Usage: circles.py OBJECT_LIST

A file needs another if its object needs a symbol that the other's defines. Within a folder, files that
need each other in a circle can be neither read nor tested one by one, and folders that do are one room
with several doors. OBJECT_LIST has one line per object file: folder of its target, '|', path.
"""

import os
import sys
from collections import defaultdict

import project
import symbols

# Folders whose files may be in a circle, each with the reason. One that is in none any more is to be
# taken out.
ALLOWED = {}


def needs_of(objects):
    """{source: {other source: {symbols}}} over (folder, path) pairs; sources without needs too."""
    defined_by, undefined_in = defaultdict(set), {}
    symbols_of = symbols.read_symbols([path for _, path in objects])
    for folder, path in objects:
        source = symbols.source_of(folder, path)
        undefined, defined = symbols_of[path]
        undefined_in.setdefault(source, set()).update(undefined)
        for symbol in defined:
            defined_by[symbol].add(source)
    needs = {source: defaultdict(set) for source in undefined_in}
    for source, undefined in undefined_in.items():
        for symbol in undefined:
            others = defined_by.get(symbol, set()) - {source}
            near = {o for o in others if os.path.dirname(o) == os.path.dirname(source)}
            for other in near or others:  # programs may have functions of the same name
                needs[source][other].add(symbol)
    return needs


def circles(graph):
    """The sets of two nodes or more that reach each other, sorted. `graph`: {node: its successors}"""
    order, seen = [], set()

    def walk(start, successors, leave):
        seen.add(start)
        stack = [(start, iter(sorted(successors[start])))]
        while stack:
            node, rest = stack[-1]
            onward = next((n for n in rest if n not in seen), None)
            if onward is None:
                leave(node)
                stack.pop()
            else:
                seen.add(onward)
                stack.append((onward, iter(sorted(successors[onward]))))

    for node in sorted(graph):
        if node not in seen:
            walk(node, graph, order.append)
    back = {node: set() for node in graph}
    for node, successors in graph.items():
        for successor in successors:
            back[successor].add(node)
    seen, found = set(), []
    for node in reversed(order):
        if node not in seen:
            group = []
            walk(node, back, group.append)
            if len(group) > 1:
                found.append(sorted(group))
    return sorted(found)


def arrows_within(circle, needs):
    return ", ".join(f"{os.path.basename(a)} needs {sorted(needs[a][b])[0]} of {os.path.basename(b)}"
                     for a in circle for b in circle if b in needs[a])


def file_violations(needs, allowed):
    found = []
    for folder in sorted({os.path.dirname(source) for source in needs}):
        graph = {source: {other for other in needs[source] if os.path.dirname(other) == folder}
                 for source in needs if os.path.dirname(source) == folder}
        round_trips = circles(graph)
        if folder in allowed and not round_trips:
            found.append(f"{folder}: has no circle any more: take it off the list in circles.py")
        if folder not in allowed:
            found += [f"{folder}: {len(circle)} of {len(graph)} files need each other in a circle: "
                      + arrows_within(circle, needs) for circle in round_trips]
    return found


def folder_violations(needs):
    between = defaultdict(lambda: defaultdict(set))
    for source, others in needs.items():
        folder = os.path.dirname(source)
        between[folder].update({})
        for other in others:
            if os.path.dirname(other) != folder:
                between[folder][os.path.dirname(other)] |= others[other]
                between[os.path.dirname(other)].update({})
    return ["rooms need each other in a circle: " + arrows_within(circle, between)
            for circle in circles({folder: set(others) for folder, others in between.items()})]


def violations(objects, allowed=None):
    needs = needs_of(objects)
    return file_violations(needs, ALLOWED if allowed is None else allowed) + folder_violations(needs)


if __name__ == "__main__":
    pairs, missing = symbols.read_list(sys.argv[1])
    project.finish(missing or violations(pairs), len(pairs))
