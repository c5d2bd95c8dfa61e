// SPDX-License-Identifier: GPL-3.0-or-later
// A copy of a store as it is at one moment, while whoever has it goes on.
#pragma once

#include "cautery/status.h"

// Copies the store at `path`, which a daemon may be writing, into `file`, where nothing is: all
// that was committed when it began, and nothing of what came after. The copy is checked as a store
// that is to be opened is, page by page, synced, and only then there under its name. Errors:
// CAU_ALREADY_EXISTS, something is there; CAU_NOT_FOUND, no store; CAU_CORRUPT, the copy is not
// whole; CAU_IO.
cau_status cau_store_backup(const char *path, const char *file, cau_error *error);
