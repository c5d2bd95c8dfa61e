// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the hash is the same however cautery-sim is run, on the real core. The first argument
// is the program.
#include "program_run.h"

// Compares the hashes of several runs. Under sanitizers, where a run takes minutes, only one other
// run is made, with two threads and a snapshot while edges part. In this run a sanitizer would
// detect a race. Other builds compare all runs.
static void expect_one_hash(const char *scene, const char *seconds, const char *snapshots[3])
{
	char arguments[256], first[17], other[17];
	snprintf(arguments, sizeof arguments, "--scene %s --cut --seconds %s --json", scene, seconds);
	read_hash(arguments, first);
	int from = CAU_TEST_SANITIZED ? 1 : 0, to = CAU_TEST_SANITIZED ? 2 : 4;
	for (int i = from; i < to; i++) {
		if (i < 3)
			snprintf(arguments, sizeof arguments,
			         "--scene %s --cut --seconds %s --json --threads %d --snapshot-at %s", scene,
			         seconds, 1 + i % 2, snapshots[i]);
		else
			snprintf(arguments, sizeof arguments,
			         "--scene %s --cut --seconds %s --json --threads 2", scene, seconds);
		read_hash(arguments, other);
		if (strcmp(first, other) != 0)
			fail_msg("%s: %s, not %s", arguments, other, first);
	}
}

// Snapshots before, while and after edges part. The needle is hot from 1.0 s on and touches the
// tissue from 1.5 s on.
static void one_hash_over_threads_and_snapshots(void **state)
{
	(void)state;
	expect_one_hash("patterns", "12", (const char *[]){"0", "400", "650"});
	expect_one_hash("fascia", "5", (const char *[]){"30", "240", "270"});
}

int main(int argument_count, char **arguments)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_hash_over_threads_and_snapshots),
	};
	if (argument_count < 2) {
		fputs("the program to test is the first argument\n", stderr);
		return 1;
	}
	program = arguments[1];
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}
