// SPDX-License-Identifier: GPL-3.0-or-later
// Generated interleavings of orders, signs of life, losses, time and the worker's acts. A failing
// one is shrunk and printed as a script of a few lines.
//     test_server_session_logic [SEQUENCES [FIRST_SEED]]
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/session/world.h"

enum { EVENTS_MOST = 40 };

typedef struct sequence {
	uint32_t codes[EVENTS_MOST];
	int count;
} sequence;

// splitmix64: every seed is as good as any other.
static uint64_t next_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

static void generate(sequence *s, uint64_t seed)
{
	uint64_t state = seed;
	s->count = 1 + (int)(next_random(&state) % EVENTS_MOST);
	for (int i = 0; i < s->count; i++)
		s->codes[i] = (uint32_t)next_random(&state);
}

static bool holds(world *w, const sequence *s)
{
	world_begin(w);
	for (int i = 0; i < s->count; i++)
		if (!world_do(w, s->codes[i]))
			return false;
	return world_end(w);
}

// Leaves out what the failure does not need.
static void shrink(world *w, sequence *s)
{
	for (int i = s->count; i-- > 0;) {
		sequence shorter = *s;
		memmove(&shorter.codes[i], &shorter.codes[i + 1],
		        (size_t)(shorter.count - i - 1) * sizeof *shorter.codes);
		shorter.count--;
		if (!holds(w, &shorter)) {
			*s = shorter;
			i = s->count;
		}
	}
}

static void print_failure(world *w, sequence *s, uint64_t seed)
{
	shrink(w, s);
	fprintf(stderr, "sequence %llu fails; the shortest like it:\n", (unsigned long long)seed);
	w->script = stderr;
	holds(w, s);
	fprintf(stderr, "-> %s\n{", w->wrong);
	for (int i = 0; i < s->count; i++)
		fprintf(stderr, "%s%#xu", i ? ", " : "", s->codes[i]);
	fprintf(stderr, "}\n");
}

int main(int argc, char **argv)
{
	uint64_t count = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000;
	uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	uint64_t events = 0;
	struct timespec began, ended;
	world *w = world_create();
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &began);
	for (uint64_t seed = first; seed < first + count; seed++) {
		sequence s;
		generate(&s, seed);
		events += (uint64_t)s.count;
		if (!holds(w, &s)) {
			print_failure(w, &s, seed);
			world_destroy(w);
			return EXIT_FAILURE;
		}
	}
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ended);
	double seconds =
		(double)(ended.tv_sec - began.tv_sec) + 1e-9 * (double)(ended.tv_nsec - began.tv_nsec);
	printf("%llu sequences, %llu events, %.2f million a second; %llu ticks began, %llu tools were "
	       "lit in them\n",
	       (unsigned long long)count, (unsigned long long)events, 1e-6 * (double)events / seconds,
	       (unsigned long long)w->steps, (unsigned long long)w->lit_steps);
	bool seen = w->steps > count / 100 && w->lit_steps > count / 1000; // else it shows nothing
	world_destroy(w);
	return seen ? EXIT_SUCCESS : EXIT_FAILURE;
}
