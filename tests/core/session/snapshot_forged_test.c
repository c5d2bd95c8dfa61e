// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots with a right hash and wrong contents. Each is either refused, and the session is
// unchanged, or restored, and the session steps or faults. With `--long`: ten million restores, and
// 100,000 that step.
#include "core/session/forgery.h"

enum { CHANGES_MOST = 4, FORGERY_BYTES = 1 + 9 * CHANGES_MOST };

typedef struct dose {
	long restores, steps;
} dose;
static dose most = {CAU_TEST_SANITIZED ? 4000 : 20000, CAU_TEST_SANITIZED ? 100 : 400};

static uint64_t next_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

static size_t next_forgery(forgery *f, uint64_t *random)
{
	uint8_t data[FORGERY_BYTES];
	for (size_t i = 0; i < sizeof data; i++)
		data[i] = (uint8_t)(next_random(random) >> 24);
	return forgery_make(f, data, 1 + 9 * (1 + next_random(random) % CHANGES_MOST));
}

// Forges snapshots. All members of a record are included, such as a tool's shape and the points in
// its jaws.
static void forge(int kind)
{
	forgery *f = forgery_create(kind);
	uint64_t random = 0x9e3779b97f4a7c15ull;
	long restored = 0, stepped = 0;
	for (long k = 0; k < most.restores / FORGERY_KINDS; k++) {
		if (forgery_restore(f, next_forgery(f, &random)))
			continue;
		restored++;
		if (stepped < most.steps / FORGERY_KINDS) {
			forgery_step(f);
			stepped++;
		}
	}
	print_message("%ld of %ld forged snapshots were restored, %ld stepped\n", restored,
	              most.restores / FORGERY_KINDS, stepped);
	assert_in_range(restored, most.restores / 100, most.restores / FORGERY_KINDS - 1);
	assert_int_equal(stepped, most.steps / FORGERY_KINDS);
	forgery_destroy(f);
}

static void forged_numbers_are_refused_or_harmless(void **state)
{
	(void)state;
	for (int kind = 0; kind < FORGERY_KINDS; kind++)
		forge(kind);
}

// Unforged snapshots are restored, whatever was restored before.
static void shots_are_restored(void **state)
{
	(void)state;
	for (int kind = 0; kind < FORGERY_KINDS; kind++) {
		forgery *f = forgery_create(kind);
		for (uint8_t shot = 0; shot < FORGERY_SHOTS; shot++) {
			assert_int_equal(forgery_restore(f, forgery_make(f, &shot, 1)), CAU_OK);
			forgery_step(f);
		}
		forgery_destroy(f);
	}
}

int main(int count, char **argument)
{
	if (count == 2 && !strcmp(argument[1], "--long"))
		most = (dose){10000000, 100000};
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shots_are_restored),
		cmocka_unit_test(forged_numbers_are_refused_or_harmless),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
