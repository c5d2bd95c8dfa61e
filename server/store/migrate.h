// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a database to this build's schema.
#pragma once

#include <sqlite3.h>

#include "cautery/status.h"

// Runs the schema steps that the database lacks, in one transaction. A failure leaves the database
// unchanged.
cau_status cau_store_migrate(sqlite3 *database, cau_error *error);
