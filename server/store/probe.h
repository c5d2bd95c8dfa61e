// SPDX-License-Identifier: GPL-3.0-or-later
// Checks a file before the store opens it for writing. Changes nothing.
#pragma once

#include "cautery/status.h"

enum cau_store_found {
	CAU_STORE_ABSENT, // no file: a store may be made
	CAU_STORE_OURS,   // a sound store, of this schema version or an older one
};

// Checks the file at `path`. The caller holds the store's lock. If the store has a label, `label`
// (may be NULL) must be equal to it. Errors are those of cau_store_open().
cau_status cau_store_probe(const char *path, const char *label, enum cau_store_found *found,
                           cau_error *error);
