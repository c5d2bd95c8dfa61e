// SPDX-License-Identifier: GPL-3.0-or-later
// The store thread: group commits, retention, and new attempts while the disk is full.
#pragma once

// Runs the store thread. `store` is a struct cau_store.
void *cau_store_commit_run(void *store);
