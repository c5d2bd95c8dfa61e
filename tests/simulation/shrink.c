// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/shrink.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_S 30. // longest real time for shrinking, s

static bool still_fails(uint64_t seed, const workload *work, run_result *result)
{
	run_result tried;
	run_seed(seed, work, &tried);
	bool same = tried.failed && strcmp(tried.promise, result->promise) == 0;
	if (same)
		*result = tried;
	return same;
}

// Leaves out `count` steps from `first`. Restores them if the failure needs one of them.
static bool leave_out(uint64_t seed, workload *work, int first, int count, run_result *result)
{
	workload tried = *work;
	bool any = false;
	for (int i = first; i < first + count && i < work->count; i++) {
		any = any || !tried.steps[i].left_out;
		tried.steps[i].left_out = true;
	}
	if (!any || !still_fails(seed, &tried, result))
		return false;
	*work = tried;
	return true;
}

void shrink(uint64_t seed, workload *work, run_result *result)
{
	double end = real_s() + MOST_S;
	bool smaller = true;
	while (smaller && real_s() < end) {
		smaller = false;
		for (int count = work->count; count >= 1; count /= 2)
			for (int first = work->count - 1 - (work->count - 1) % count; first >= 0;
			     first -= count)
				if (real_s() < end)
					smaller = leave_out(seed, work, first, count, result) || smaller;
	}
}

void shrink_print(const workload *work)
{
	const char *comma = "";
	for (int i = 0; i < work->count; i++) {
		int last = i;
		if (work->steps[i].left_out)
			continue;
		while (last + 1 < work->count && !work->steps[last + 1].left_out)
			last++;
		printf(last > i ? "%s%d-%d" : "%s%d", comma, i, last);
		comma = ",";
		i = last;
	}
	if (!*comma)
		printf("none");
}

bool shrink_choose(workload *work, const char *list)
{
	if (!list)
		return true;
	for (int i = 0; i < work->count; i++)
		work->steps[i].left_out = true;
	for (const char *at = strcmp(list, "none") == 0 ? "" : list; *at;) {
		char *end;
		long first = strtol(at, &end, 10), last = first;
		bool read = end != at;
		if (read && *end == '-')
			last = strtol(end + 1, &end, 10);
		if (!read || first < 0 || last < first || last >= work->count || (*end && *end != ',')) {
			fprintf(stderr, "cautery_simulation: --steps: `%s`: wanted numbers of steps, 0 to %d\n",
			        at, work->count - 1);
			return false;
		}
		for (long i = first; i <= last; i++)
			work->steps[i].left_out = false;
		at = *end ? end + 1 : end;
	}
	return true;
}
