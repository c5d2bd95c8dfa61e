// SPDX-License-Identifier: GPL-3.0-or-later
// The branches and the named snapshots of a session. Only the session's owning thread (internal.h)
// uses them.
#pragma once

#include "hosted_session/identity.h"

enum { SNAPSHOT_COUNT = 64 };

typedef struct cau_named_snapshot {
	char name[CAU_NAME_BYTES];
	int64_t branch;
	uint64_t tick;
} cau_named_snapshot;

typedef struct cau_hosted_history {
	int64_t branch, next_branch;
	uint64_t first_tick;
	cau_named_snapshot snapshots[SNAPSHOT_COUNT];
	int32_t snapshot_count;
} cau_hosted_history;

const cau_named_snapshot *cau_history_find(const cau_hosted_history *history, const char *name);
// Reads the branches and the snapshots of a session from the store.
cau_status cau_history_load(cau_hosted_history *history, const cau_hosted_identity *identity,
                            cau_error *error);
