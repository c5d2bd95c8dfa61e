#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes haproxy.cfg for the daemons of a list: a line each, of a label, an address with its port, and the
port of its agent-check (the daemon's settings label, listen, port and agent_port); # begins a comment.

    d1 10.0.0.11:8740 8741
    d2 10.0.0.12:8740 8741
"""

import argparse
import os
import re
import string
import sys

TEMPLATE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "haproxy.cfg.in")
# A name of the wire (protocol/README.md) without "-", which ends the label in a session's id.
LABEL = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
LABEL_BYTES_MAX = 32  # the rest of an id's 48 is the session's name
# What paths and the proxy's own answers are called.
TAKEN_LABELS = {"api", "assets"}
ADDRESS = re.compile(r"([A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\]):([0-9]{1,5})")
HOST = re.compile(r"[A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\]")
FILE = re.compile(r"[A-Za-z0-9_./@+-]+")  # nothing that HAProxy would read otherwise
USER = re.compile(r"[a-z_][a-z0-9_-]*")
EACH = re.compile(r"^[ \t]*# for each daemon\n(.*?)^[ \t]*# end\n", re.MULTILINE | re.DOTALL)


class Refused(Exception):
    pass


def port_of(text, where):
    if not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise Refused(f"{where}: {text!r} is no port from 1 to 65535")
    return int(text)


def read_daemon(line, where):
    words = line.split()
    if len(words) != 3:
        raise Refused(f"{where}: wants LABEL ADDRESS:PORT AGENT_PORT")
    label, address, agent_port = words
    found = ADDRESS.fullmatch(address)
    if not LABEL.fullmatch(label) or len(label) > LABEL_BYTES_MAX or label in TAKEN_LABELS:
        raise Refused(f"{where}: {label!r} is no label of a daemon in a fleet")
    if not found:
        raise Refused(f"{where}: {address!r} is no ADDRESS:PORT")
    port_of(found.group(2), where)
    return {"label": label, "address": address, "agent_address": found.group(1).strip("[]"),
            "agent_port": port_of(agent_port, where)}


def read_daemons(lines, name):
    daemons = []
    for number, line in enumerate(lines, 1):
        line = line.split("#")[0].strip()
        if line:
            daemons.append(read_daemon(line, f"{name}:{number}"))
    for key in ("label", "address"):
        values = [daemon[key] for daemon in daemons]
        twice = sorted({value for value in values if values.count(value) > 1})
        if twice:
            raise Refused(f"{name}: {twice[0]} is there twice")
    if not daemons:
        raise Refused(f"{name}: it names no daemon")
    return daemons


def make(template, daemons, common):
    """The text of haproxy.cfg. `common` maps the template's names that are the same for all."""
    labels = [daemon["label"] for daemon in daemons]
    common = dict(common, first_label=labels[0],
                  quoted_labels=", ".join(f'"{label}"' for label in labels))

    def for_each(found):
        # The rest of the template's names, and $$, are for the second pass.
        return "".join(re.sub(r"\$(label|address|agent_address|agent_port)\b",
                              lambda name: str(daemon[name.group(1)]), found.group(1))
                       for daemon in daemons)

    return string.Template(EACH.sub(for_each, template)).substitute(common)


def read_arguments(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("daemons", help="file of the list")
    parser.add_argument("--host", required=True,
                        help="the fleet's name, as users see it; every daemon's setting `hosts` has it")
    tls = parser.add_mutually_exclusive_group(required=True)
    tls.add_argument("--certificate", help="file of certificate, chain and key in one (PEM)")
    tls.add_argument("--no-tls", action="store_true", help="for loopback, or behind another proxy")
    parser.add_argument("--bind", help="where to listen (*:443; without TLS 127.0.0.1:8740)")
    parser.add_argument("--socket", default="/run/haproxy/admin.sock",
                        help="HAProxy's own socket, for its operator (%(default)s)")
    parser.add_argument("--user", default="haproxy",
                        help="HAProxy starts as root and serves as this user and its group of the same name "
                             "(%(default)s, which Debian's package makes)")
    parser.add_argument("--chroot", default="/var/lib/haproxy", help="the folder that it is confined to (%(default)s)")
    parser.add_argument("--without-root", action="store_true",
                        help="for HAProxy that is not started as root: it stays who it is, in no folder of its own")
    parser.add_argument("--template", default=TEMPLATE, help="the template (%(default)s)")
    given = parser.parse_args(arguments)
    given.bind = given.bind or ("127.0.0.1:8740" if given.no_tls else "*:443")
    return given


def check_words(given):
    for text, form, what in ((given.host, HOST, "host's name"),
                             (given.socket, FILE, "file's name that HAProxy takes"),
                             (given.chroot, FILE, "folder's name that HAProxy takes"),
                             (given.user, USER, "user's name"),
                             (given.certificate or "x", FILE, "file's name that HAProxy takes")):
        if not form.fullmatch(text):
            raise Refused(f"{text!r} is no {what}")
    if not re.fullmatch(r"(\*|" + HOST.pattern + r"):[0-9]{1,5}", given.bind):
        raise Refused(f"{given.bind!r} is no ADDRESS:PORT")


def rights(given):
    """Whose rights HAProxy serves with. It needs root's to take port 443 and to read the certificate's key."""
    if given.without_root:
        return "# started without root's rights: no user, group or chroot"
    return f"chroot {given.chroot}\n\tuser {given.user}\n\tgroup {given.user}"


def main(arguments):
    given = read_arguments(arguments)
    try:
        check_words(given)
        with open(given.daemons, encoding="utf-8") as listing:
            daemons = read_daemons(listing, given.daemons)
        with open(given.template, encoding="utf-8") as file:
            template = file.read()
    except (OSError, UnicodeDecodeError, Refused) as error:
        print(f"make_haproxy.py: {error}", file=sys.stderr)
        return 2
    common = {"bind": given.bind, "host": given.host, "scheme": "http" if given.no_tls else "https",
              "tls": "" if given.no_tls else f"ssl crt {given.certificate} alpn http/1.1",
              "rights": rights(given),
              "socket": f"stats socket {given.socket} mode 600 level admin"}
    sys.stdout.write(make(template, daemons, common))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
