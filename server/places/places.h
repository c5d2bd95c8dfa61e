// SPDX-License-Identifier: GPL-3.0-or-later
// Where the files are that belong to an installed program: beside it, wherever that is.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// The folder `../share/cautery/NAME` as seen from the folder of the running program, links
// followed. A tree can so be moved, unpacked anywhere or tried out with DESTDIR; the build puts
// links to the sources' folders at the same place in its own tree. False, and an empty `path`, if
// there is no such folder or its name does not fit.
bool cau_place_find(const char *name, char *path, size_t bytes);
