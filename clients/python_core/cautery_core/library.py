# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds libcautery-core and loads it, once. ctypes releases Python's lock while a function of it runs."""

from __future__ import annotations

import ctypes
import functools
import os

from .layout import FUNCTIONS

ABI = "0.1"  # the minor version whose structs layout.py has
_NAME = f"libcautery-core.so.{ABI}"


def _place() -> str:
    """Path of the library: LIBCAUTERY_CORE, else in the folder of this package, else its name for the loader."""
    named = os.environ.get("LIBCAUTERY_CORE")
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), _NAME)
    return named or (beside if os.path.exists(beside) else _NAME)


@functools.cache
def core() -> ctypes.CDLL:
    """Returns the library, with the types of its functions set."""
    place = _place()
    try:
        library = ctypes.CDLL(place)
    except OSError as error:
        raise ImportError(f"libcautery-core cannot be loaded ({error}): install it (Debian's package libcautery-core{ABI}), "
                          f"or set the environment variable LIBCAUTERY_CORE to the path of {_NAME}") from error
    for name, (result, parameters) in FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError as error:
            raise ImportError(f"{place} has no function {name}: it is not libcautery-core {ABI}") from error
        function.restype, function.argtypes = result, parameters
    version = library.cau_core_version().decode()
    if version.rsplit(".", 1)[0] != ABI:
        raise ImportError(f"{place} has version {version}, but this package needs {ABI}")
    return library
