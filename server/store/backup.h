// SPDX-License-Identifier: GPL-3.0-or-later
// Copies a store as of one moment, while its daemon continues to use it.
#pragma once

#include "cautery/status.h"

// Copies the store at `path` to `file`, which must not exist. A daemon may be writing the store.
// The copy has everything that was committed when the copy began, and nothing later. It is checked
// page by page like a store before opening, synced, and only then linked to `file`. Errors:
// CAU_ALREADY_EXISTS: `file` exists; CAU_NOT_FOUND: no store at `path`; CAU_CORRUPT: the copy is
// damaged; CAU_IO.
cau_status cau_store_backup(const char *path, const char *file, cau_error *error);
