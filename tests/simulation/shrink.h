// SPDX-License-Identifier: GPL-3.0-or-later
// Shortens a failing seed: leaves out the steps that the failure does not need.
#pragma once

#include <stdbool.h>

#include "simulation/run.h"

// Leaves out steps as long as the same promise is still broken. *result is the result of the last
// failing run.
void shrink(uint64_t seed, workload *work, run_result *result);
// Prints the remaining steps, such as `0-3,7`.
void shrink_print(const workload *work);
// Leaves out all steps except those of `list`; NULL keeps none. Returns false after printing a
// message if the list is invalid.
bool shrink_choose(workload *work, const char *list);
