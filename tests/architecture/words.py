# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages are in plain English: short sentences, the terms of the glossary, links that lead somewhere.

Usage: words.py ROOT [--figures]

For each page (.md): at most MEAN_WORDS words in the mean sentence, no house word, every relative link and
anchor resolves. For the strings that users read, in sources: no house word. What did not pass when this
check was written stands in words_open.py with its figures. A page or folder that gets worse than its
figures fails. One that passes and still stands there fails, too: so the lists can only shrink.
--figures prints those lists as they are now. deploy/manual/glossary.md has the term for each house word.
"""

import collections
import os
import posixpath
import re
import sys

import project
import words_open

MEAN_WORDS = 18.0
FEW_SENTENCES = 3  # below that a mean says nothing
CELL_WORDS = 10  # a cell of a table with as many words is a sentence

# House words, and what the glossary says instead.
HOUSE = [(re.compile(rf"(?<![\w-])(?:{words})(?![\w-])", re.IGNORECASE), instead) for words, instead in (
    (r"told|tells?|telling", "reports, sends, notifies, shows"),
    (r"lets? go of|letting go of", "releases"),
    (r"lets? (?:it |them )?through", "drops the constraint, excludes from contact"),
    (r"touch(?:es)? nothing", "is excluded from contact"),
    (r"legs?", "substep"),
    (r"rows?", "contact constraint"),
    (r"throws?|thrown|throwing|threw", "moves too far, diverges"),
    (r"(?:pose|poses|where .{1,30}) (?:that )?(?:is|are) asked|asked poses?|pose that is", "commanded pose, actual pose"),
    (r"dark|darken(?:s|ed|ing)?", "energy off"),
    (r"lit|lights (?:it|them|nothing|its|the tool)", "energy on"),
    (r"is had|are had|to be had|who has (?:it|the tool)", "exists, holds it"),
    (r"go(?:es)? back|going back|went back|gone back", "rewinds, restores"),
    (r"looks? at the past|looking at the past", "a view of a past tick"),
    (r"stands? still|stood still|standing still", "is suspended, is at rest"),
    (r"(?:no|much|have|has|had|most|more) room|room for|want of room", "capacity"),
    (r"by turns", "alternating"),
    (r"anew", "again, rebuilt"),
    (r"likewise", "say it in full"),
    (r"nobody|somebody", "name the client, the driver or the user"),
    (r"asleep", "resting"),
    (r"burns? through|burnt through", "parts"),
)]
# Where a house word is the field's own.
FIELD = re.compile(
    r"(?:light|dark) (?:and|or) (?:light|dark)|dark (?:theme|mode|colou?rs?)|(?:in|of|the) the dark theme"
    r"|(?:table|matrix|database|SQL) rows?|rows? (?:of|in) (?:a|the|each|this|that) (?:\w+ )?(?:table|matrix|system|store|list)s?"
    r"|prefers-color-scheme: dark|rows? (?:committed|retired|that were removed)|(?:no|a) row (?:for|of the session)"
    r"|within a row|row is of no known table", re.IGNORECASE)

FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)")
REFERENCE = re.compile(r"^\[[^\]]+\]:\s*(\S+)", re.MULTILINE)
IMAGE = re.compile(r"<(?:img|a)\b[^>]*\b(?:src|href)=\"([^\"]+)\"")
HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*$")
ITEM = re.compile(r"^\s*(?:[-*+]|\d+[.)])\s+")
WORD = re.compile(r"[^\W_]+(?:['’.,/-][^\W_]+)*")

# Sources whose strings users read, and what a string is there.
READ_BY_USERS = (("protocol/include/", (".def", ".h")), ("protocol/json/", (".c",)), ("protocol/rpc/", (".c",)),
                 ("protocol/options/", (".c",)), ("core/types/", (".h",)), ("server/", (".c", ".h")),
                 ("clients/", (".c", ".h")), ("clients/web/src/", (".ts",)))
STRING = {".ts": re.compile(r"'((?:[^'\\\n]|\\.)*)'|\"((?:[^\"\\\n]|\\.)*)\"|`((?:[^`\\]|\\.)*)`")}
SHADER = re.compile(r"\bprecision highp\b|\bgl_\w|\bvec[234]\b")  # a program for the graphics card
C_STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
C_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|'(?:[^'\\\n]|\\.)'", re.DOTALL)
TS_COMMENT = re.compile(r"(?<![:'\"])//[^\n]*|/\*.*?\*/", re.DOTALL)


# ---- a page --------------------------------------------------------------------------------------

def without_code(page):
    """The page's lines with blocks of code taken out."""
    lines, fenced, before, in_list = [], False, "", False
    for line in page.splitlines():
        if FENCE.match(line):
            fenced = not fenced
            lines.append("")
            continue
        if ITEM.match(line):
            in_list = True
        elif line.strip() and not line.startswith(" "):
            in_list = False
        code = fenced or (line.startswith("    ") and not in_list and (not before.strip() or before == "code"))
        lines.append("" if code else line)
        before = "code" if code else line
    return lines


def plain(text):
    """Prose without marks: a link is its text, code is one word."""
    text = re.sub(r"`+[^`]+`+", "code", text)
    text = re.sub(r"<[^>]+>", " ", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", " ", text)
    text = re.sub(r"\[((?:[^\]\[]|\[[^\]]*\])*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"https?://\S+", "address", text)


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def blocks_of(page):
    """(kind, text) of each paragraph, item, heading and cell; kind is one of prose, heading, cell."""
    found, open_block = [], []

    def close():
        if open_block:
            found.append(("prose", plain(" ".join(open_block))))
        open_block.clear()

    for line in without_code(page):
        heading, stripped = HEADING.match(line), line.strip()
        if not stripped:
            close()
        elif heading:
            close()
            found.append(("heading", plain(heading.group(2))))
        elif stripped.startswith("|"):
            close()
            found += [("cell", plain(cell)) for cell in cells_of(stripped) if not re.fullmatch(r"[:\s-]*", cell)]
        else:
            if ITEM.match(line):
                close()
            open_block.append(ITEM.sub("", line).strip().lstrip(">").strip())
    close()
    return found


def sentences_of(page):
    """Number of words of each sentence in prose, and in cells that are as long as sentences."""
    lengths = []
    for kind, text in blocks_of(page):
        if kind == "heading" or (kind == "cell" and len(WORD.findall(text)) < CELL_WORDS):
            continue
        for sentence in re.split(r"(?<=[.!?])[\"')*_]*\s+(?=[\"'(*_]*[A-Z0-9])|(?<=[.!?])[\"')*_]*$", text):
            words = len(WORD.findall(sentence))
            if words:
                lengths.append(words)
    return lengths


def mean_words(page):
    lengths = sentences_of(page)
    return sum(lengths) / len(lengths) if len(lengths) >= FEW_SENTENCES else 0.0


def house_words(text):
    """[(house word, what to say instead)]"""
    text = FIELD.sub(" ", text)
    return [(found.group(0), instead) for pattern, instead in HOUSE for found in pattern.finditer(text)]


def house_words_of_page(page):
    return [word for _, text in blocks_of(page) for word in house_words(text)]


# ---- links ---------------------------------------------------------------------------------------

def anchors_of(page):
    """The anchors of a page's headings, as GitHub makes them."""
    found, seen = set(), collections.Counter()
    for line in without_code(page):
        heading = HEADING.match(line)
        if heading:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(2)).replace("`", "").lower()
            slug = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
            seen[slug] += 1
    return found


def link_violations(root, name, page, files):
    text = "\n".join(without_code(page))
    text = re.sub(r"`+[^`\n]+`+", "", text)
    folders = {posixpath.dirname(file) for file in files}
    folders |= {parent for folder in folders for parent in
                ("/".join(folder.split("/")[:n]) for n in range(1, folder.count("/") + 1))}
    found = []
    for link in LINK.findall(text) + REFERENCE.findall(text) + IMAGE.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = posixpath.normpath(posixpath.join(posixpath.dirname(name), path)) if path else name
        if target not in files and target not in folders:
            found.append(f"{name}: links {link}, which is not in the repository")
        elif anchor and (not target.endswith(".md") or anchor not in anchors_of(project.read_text(root, target))):
            found.append(f"{name}: links {link}, and {target} has no such heading")
    return found


# ---- strings -------------------------------------------------------------------------------------

def strings_of(name, text):
    """The strings of a source that are prose: with a blank in them."""
    ending = os.path.splitext(name)[1]
    if ending == ".ts":
        found = ["".join(parts) for parts in STRING[".ts"].findall(TS_COMMENT.sub("", text))]
    else:
        text = re.sub(r"^\s*#\s*include.*$", "", C_COMMENT.sub(lambda m: " ", text), flags=re.MULTILINE)
        found = C_STRING.findall(re.sub(r'"\s*\n?\s*"', "", text))
    return [string for string in found if " " in string and not SHADER.search(string)]


def folder_of(name):
    """A room and its folder, for which house words in strings are counted together."""
    return "/".join(name.split("/")[:2]) + "/"


def is_read_by_users(name):
    return any(name.startswith(folder) and name.endswith(endings) for folder, endings in READ_BY_USERS)


def strings_by_folder(root, files):
    """{folder: [(file, house word, what to say instead)]}"""
    found = collections.defaultdict(list)
    for name in files:
        if is_read_by_users(name):
            for string in strings_of(name, project.read_text(root, name) or ""):
                found[folder_of(name)] += [(name, *word) for word in house_words(string)]
    return found


# ---- the lists -----------------------------------------------------------------------------------

def up(mean):
    """To one digit behind the point, upwards, as the list has it."""
    return -(-round(mean * 1000) // 100) / 10


def page_violation(name, mean, words, figures):
    """`figures`: (mean, house words) of the list, or None."""
    passes = mean <= MEAN_WORDS and not words
    if figures and passes:
        return f"{name}: passes now: take it off the list in words_open.py"
    most_mean, most_words = figures or (MEAN_WORDS, 0)
    most_mean = max(most_mean, MEAN_WORDS)
    found = []
    if up(mean) > most_mean:
        found.append(f"{mean:.1f} words in the mean sentence, at most {most_mean}")
    if len(words) > most_words:
        said = ", ".join(f"'{word}' ({instead})" for word, instead in words[:6])
        found.append(f"{len(words)} house words, at most {most_words}: {said}")
    return f"{name}: " + "; ".join(found) if found else None


def string_violation(folder, found, most):
    if most and not found:
        return f"{folder}: strings pass now: take it off the list in words_open.py"
    if len(found) > most:
        said = ", ".join(f"'{word}' in {name} ({instead})" for name, word, instead in found[:6])
        return f"{folder}: {len(found)} house words in strings that users read, at most {most}: {said}"
    return None


def violations(root, files, open_pages=None, open_strings=None):
    open_pages = words_open.PAGES if open_pages is None else open_pages
    open_strings = words_open.STRINGS if open_strings is None else open_strings
    known, found = set(files), []
    pages = [name for name in files if name.endswith(".md")]
    for name in pages:
        page = project.read_text(root, name)
        words = [] if name in words_open.SHOWS_HOUSE_WORDS else house_words_of_page(page)
        found.append(page_violation(name, mean_words(page), words, open_pages.get(name)))
        found += link_violations(root, name, page, known)
    found += [f"{name}: is on the list in words_open.py and no page" for name in sorted(set(open_pages) - set(pages))]
    strings = strings_by_folder(root, files)
    found += [string_violation(folder, strings.get(folder, []), open_strings.get(folder, 0))
              for folder in sorted(set(strings) | set(open_strings))]
    return [violation for violation in found if violation]


def print_figures(root, files):
    print("PAGES = {")
    for name in files:
        if name.endswith(".md") and name not in words_open.SHOWS_HOUSE_WORDS:
            page = project.read_text(root, name)
            mean, words = mean_words(page), len(house_words_of_page(page))
            if mean > MEAN_WORDS or words:
                print(f'    "{name}": ({up(mean)}, {words}),')
    print("}\nSTRINGS = {")
    for folder, found in sorted(strings_by_folder(root, files).items()):
        if found:
            print(f'    "{folder}": {len(found)},')
    print("}")


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    if sys.argv[2:] == ["--figures"]:
        print_figures(sys.argv[1], every)
    else:
        project.finish(violations(sys.argv[1], every), sum(name.endswith(".md") for name in every))
