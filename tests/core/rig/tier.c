// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rig/tier.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solve/kernels.h"

enum { SKIPPED = 77 };

static bool is_a_tier(const char *name)
{
	return !strcmp(name, "baseline") || !strcmp(name, "avx2") || !strcmp(name, "avx512");
}

static void end(int status, const char *tier, const char *reason)
{
	fprintf(stderr, "CAUTERY_TEST_TIER is %s: %s\n", tier, reason);
	exit(status);
}

const char *test_tier(void)
{
	const char *tier = getenv("CAUTERY_TEST_TIER");
	if (!tier || !*tier)
		return NULL;
	if (!is_a_tier(tier))
		end(EXIT_FAILURE, tier, "no tier has this name");
	if (strcmp(cau_kernels_choose(false, tier)->instruction_set, tier) != 0)
		end(SKIPPED, tier, "this machine does not have it");
	if (!strcmp(cau_kernels_choose(false, NULL)->instruction_set, tier))
		end(SKIPPED, tier, "the test without the variable runs on it here");
	return tier;
}
