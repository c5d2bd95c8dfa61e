// SPDX-License-Identifier: GPL-3.0-or-later
// The instruction set of a test program's kernels. The last bits of results differ between tiers,
// so a test of exact bits may hold for one tier only.
#pragma once

// Returns the highest tier that the program may use: the value of the environment variable
// CAUTERY_TEST_TIER (`baseline`, `avx2` or `avx512`). Returns NULL, for the best tier of the
// machine, if the variable is not set. Ends the program as failed if no tier has that name. Ends
// the program as skipped, with the reason, if the machine does not have the tier. Does the same if
// the machine has no higher tier, because the run would then be the same as without the variable.
const char *test_tier(void);
