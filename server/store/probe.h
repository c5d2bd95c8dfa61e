// SPDX-License-Identifier: GPL-3.0-or-later
// Looks at a file before the store opens it for writing, and changes nothing.
#pragma once

#include "cautery/status.h"

enum cau_store_found {
	CAU_STORE_ABSENT, // nothing there: a store may be made
	CAU_STORE_OURS,   // whole, of this schema version or an older one
};

// The caller holds the store's lock. `label` (may be NULL) must be the stored one if one is stored.
// Errors as cau_store_open().
cau_status cau_store_probe(const char *path, const char *label, enum cau_store_found *found,
                           cau_error *error);
