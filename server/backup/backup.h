// SPDX-License-Identifier: GPL-3.0-or-later
// store.backup: copies of the daemon's store, made by the builder while sessions go on.
#pragma once

#include <stdatomic.h>

#include "builder/builder.h"
#include "config/config.h"
#include "hosted_session/sink.h"
#include "store/store.h"

typedef struct cau_backups {
	const cau_config *config; // borrowed, like all here
	cau_store *store;
	cau_builder *builder;
	atomic_bool copying; // a copy is being made: one at a time
} cau_backups;

// Has a copy of the store made, under a name ("": the time), in the folder of the settings. On
// CAU_OK it is answered through `reply`, with store_copy or why not. CAU_BAD_STATE: one is being
// made. Any thread; `backups` outlives the builder's jobs.
cau_status cau_backups_make(cau_backups *backups, const char *name, const cau_reply *reply,
                            cau_error *error);
