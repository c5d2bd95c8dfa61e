// SPDX-License-Identifier: GPL-3.0-or-later
// The SQL that makes the tables, in steps: step i takes schema version i to i + 1. A new store runs
// all steps, an older one those that it lacks. A released step is never changed.
#pragma once

#define CAU_STORE_APPLICATION_ID 0x43617574 // "Caut", SQLite's application_id
#define CAU_STORE_SCHEMA_VERSION 7          // SQLite's user_version

extern const char *const cau_store_schema_steps[CAU_STORE_SCHEMA_VERSION];
