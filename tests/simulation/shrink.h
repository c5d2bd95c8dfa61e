// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves out of a failing seed's steps what the failure does not need.
#pragma once

#include <stdbool.h>

#include "simulation/run.h"

// Leaves out steps while the same promise is still broken; *result is of the last run that did.
void shrink(uint64_t seed, workload *work, run_result *result);
// The steps that are left, as `0-3,7`.
void shrink_print(const workload *work);
// Leaves out all steps but these; NULL: none. False, and a complaint: it is no such list.
bool shrink_choose(workload *work, const char *list);
