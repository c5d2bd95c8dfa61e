// SPDX-License-Identifier: GPL-3.0-or-later
// The instruction set of a test program's kernels. The last bits of results differ between tiers,
// so a test of exact bits may hold for one tier only.
#pragma once

// Returns the highest tier that the program may use: the environment's CAUTERY_TEST_TIER
// (`baseline`, `avx2` or `avx512`). Returns NULL if the variable is not set: the best tier of the
// machine. The program ends as skipped, with the reason, if the machine does not have the tier, or
// has no higher one: a run without the variable would then be the same. It ends as failed if no
// tier has that name.
const char *test_tier(void);
