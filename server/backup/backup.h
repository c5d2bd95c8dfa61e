// SPDX-License-Identifier: GPL-3.0-or-later
// store.backup: copies of the daemon's store. The builder makes them while sessions run.
#pragma once

#include <stdatomic.h>

#include "builder/builder.h"
#include "config/config.h"
#include "hosted_session/sink.h"
#include "store/store.h"

typedef struct cau_backups {
	const cau_config *config; // borrowed, like all members here
	cau_store *store;
	cau_builder *builder;
	atomic_bool copying; // a copy is being made; only one at a time
} cau_backups;

// Makes a copy of the store, named `name` ("": the time), in the folder of the settings. After
// CAU_OK the result comes through `reply`: store_copy or an error. CAU_BAD_STATE: another copy is
// being made. Any thread may call it; `backups` must outlive the builder's jobs.
cau_status cau_backups_make(cau_backups *backups, const char *name, const cau_reply *reply,
                            cau_error *error);
