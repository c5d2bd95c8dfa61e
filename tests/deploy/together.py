# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tests of a program beside each other: for tests that wait for timers and other programs far longer than they
compute."""

import concurrent.futures
import io
import random
import socket
import sys
import unittest

# Below the ports that Linux gives to programs that ask for any. A daemon or a connection of another test would get one of
# those before its owner takes it.
PORTS = range(23000, 32768)
given = set()  # to the tests of this program


def free_ports(count):
    ports = []
    while len(ports) < count:
        port = random.choice(PORTS)
        if port in given:
            continue
        given.add(port)
        try:
            socket.create_server(("127.0.0.1", port)).close()
        except OSError:  # the port is in use
            continue
        ports.append(port)
    return ports


def units(suite, by_class):
    """Suites that may run beside each other: each class, or each test of a class that sets up nothing for all."""
    for one in suite:
        if isinstance(one, unittest.TestSuite) and not (by_class and all(isinstance(test, unittest.TestCase) for test in one)):
            yield from units(one, by_class)
        elif not isinstance(one, unittest.TestSuite) or one.countTestCases():
            yield one


def run(unit):
    said = io.StringIO()
    result = unittest.TextTestRunner(said, verbosity=2).run(unit)
    return result, said.getvalue()


def main(at_once, by_class):
    """As unittest.main, with `at_once` tests or classes at a time. Names of tests in the command: only these, in turn."""
    if [word for word in sys.argv[1:] if not word.startswith("-")]:
        unittest.main()
    all_units = list(units(unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"]), by_class))
    ran, failed = 0, 0
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        for result, said in pool.map(run, all_units):
            print(said, end="", file=sys.stderr, flush=True)
            ran += result.testsRun
            failed += not result.wasSuccessful()
    print(f"{ran} tests, {failed} of {len(all_units)} parts failed", file=sys.stderr)
    sys.exit(bool(failed) or not ran)
