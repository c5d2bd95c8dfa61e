// SPDX-License-Identifier: GPL-3.0-or-later
// The store's thread: group commits, retention, and attempts while the disk is
// full.
#pragma once

// The thread's body; `store` is a struct cau_store.
void *cau_store_commit_run(void *store);
