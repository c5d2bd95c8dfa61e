// SPDX-License-Identifier: GPL-3.0-or-later
// The instruction set that a test program's kernels are for. Results differ between these tiers in
// the last bits, and what holds for the bits of one tier alone does not hold.
#pragma once

// The highest tier that the program may use: CAUTERY_TEST_TIER of the environment (`baseline`,
// `avx2` or `avx512`). NULL: the best that the machine has, where the variable is not set. Ends the
// program as skipped, with the reason, where the machine has no such tier or has none above it, so
// that a run without the variable is the same; ends it as failed where no tier has that name.
const char *test_tier(void);
