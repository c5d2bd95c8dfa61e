// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the files that belong to an installed program. They are beside the program, wherever it is.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Finds the folder `../share/cautery/NAME` as seen from the folder of the running program, with
// links followed. So an installed tree can be moved, unpacked anywhere, or tried with DESTDIR. The
// build makes links to the sources' folders at the same place in its own tree. Returns false and an
// empty `path` if there is no such folder or its name does not fit.
bool cau_place_find(const char *name, char *path, size_t bytes);
