// SPDX-License-Identifier: GPL-3.0-or-later
// Tests random interleavings of orders, signs of life, losses, time and the worker's acts. A
// failing sequence is shortened and printed as a script of a few lines.
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

// splitmix64: all seeds are equally good.
static uint64_t next_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

// Raises the share of advances, because random sequences seldom pause a session and then advance
// it. Every fourth sequence begins paused. A quarter of the sequence's other codes are advances,
// most of them by the driver, and half are acts of the worker.
static void favour_advances(sequence *s)
{
	static const uint32_t pause[] = {0x008100a0, 0x00000034, 0x00000034};
	int begun = 0;
	for (; begun < s->count && begun < (int)(sizeof pause / sizeof *pause); begun++)
		s->codes[begun] = pause[begun];
	for (int i = begun; i < s->count; i++)
		if (s->codes[i] >> 30 == 0)
			s->codes[i] = (s->codes[i] & ~0x1fu) | WORLD_ADVANCES | s->codes[i] >> 29 << 5;
		else if (s->codes[i] >> 30 < 3)
			s->codes[i] = (s->codes[i] & ~0x1fu) | WORLD_WORKS;
}

static void generate(sequence *s, uint64_t seed)
{
	uint64_t state = seed;
	s->count = 1 + (int)(next_random(&state) % EVENTS_MOST);
	for (int i = 0; i < s->count; i++)
		s->codes[i] = (uint32_t)next_random(&state);
	if (seed % 4 == 0)
		favour_advances(s);
}

// Sequences that failed once, or that test a rule which random sequences seldom reach.
static const sequence found[] = {
	{{0xff0040a0, 0x7e7e7e7e, 0x7e7e7e7e, 0x7e7e7e7e, 0xff070707, 0x54545454, 0x54545454,
      0x57575757, 0x00054000, 0x54545401, 0x54545454, 0x57575757, 0x57575757, 0x47474747,
      0x4747bd47, 0x7e7e7ebd, 0x7e7e7e7e, 0x5656567e, 0x56565656, 0x56565656, 0x7e7e5656,
      0x7e7e7e7e, 0x7e7e7e7e, 0x7e7e7e7e, 0x57577e7e, 0x57575757},
     26}, // a tool is removed, enabled, turned off, and added again
	{{0xff0040a0, 0x7e7e7e7e, 0x7e7e7e7e, 0x7e7e7e7e, 0x2d7e0800, 0xbdb44747, 0x474747bd,
      0x56565656, 0x56565656, 0x47474747, 0xbd4747bd, 0x7e7e7e7e, 0x7e7e7e7e, 0x56565656,
      0x56565656, 0x56565656, 0x7e7e7e56},
     17}, // a tool is enabled before it is added
	{{0x006e0701, 0xb8b8b800, 0xe0b8b8b8, 0x0050f038, 0x92929292, 0xffffff92, 0xffffffff,
      0xffffc4ff, 0xfffbffff, 0xffffff29, 0xffffffff, 0xffffffff, 0x3fffffff, 0x2cffffff,
      0xffffffff, 0xffffffff, 0xffffffff},
     17}, // the store is full between the enable and the adding of the tool
	{{0xe5cb71c6, 0x0ff40913, 0x54e64909, 0x3dbb8778, 0x8fea5008, 0xc1046b99, 0xe7f04567,
      0x193ccc58, 0x5b3bb61e, 0x8628a593, 0x62ce6fdf, 0xa368a494, 0x06dcd659, 0xe7fef21a},
     14}, // a tool is turned off during a rewind to a state that has the tool
	{{0x329e74df, 0xba221c75, 0x2c75a1c6, 0x32ea6f20, 0xdee652e5, 0xfab88340, 0x84d39233,
      0xe9111eb3, 0xb41c207b, 0xddd509b8, 0xb0069d92, 0x1d616e1a, 0x68e20b7e, 0xb79ca257,
      0xc058681f, 0xa2648415, 0xaded6892, 0xbd394a5a, 0x7096e75d, 0xae5420da},
     20}, // the store is full during a rewind
	{{0x00000073, 0x00000073, 0x00810000, 0x00000073, 0x00000073, 0x0000008d,
      0x00000073, 0x00810000, 0x000000ed, 0x000000ed, 0x000000ed, 0x000000ed,
      0x00000011, 0x0000002a, 0x00000073, 0x00000073, 0x00000073, 0x00000073,
      0x00000073, 0x0000002a, 0x00000073, 0x00000073},
     22}, // a driver enables again, is silent, and then gives a sign of life
	{{0x00000073, 0x00000073, 0x02010180, 0x00000073, 0x00000133, 0x02810000, 0x00813700,
      0x00000073, 0x00000073, 0x00000032, 0x00000073, 0x00000073, 0x00000073, 0x00000073,
      0x0000008d, 0x00000073, 0x00000073, 0x0000008d, 0x0000002a, 0x00000073, 0x00000073,
      0x00000073, 0x00000073, 0x00000073, 0x00000073, 0x0000008d, 0x00000073, 0x00000073},
     28}, // a tool is enabled, removed, and added by an order that came before
	{{0x008101c0, 0x00000094, 0x000000b4, 0x00000094, 0x000000b4, 0x01200060, 0x01200000,
      0x00000012, 0x00000012, 0x00000214, 0x000000b4, 0x000000b4, 0x000000b4, 0x000000b4,
      0x000000b4, 0x000000b4, 0x000000ed, 0x000000b4, 0x000000b4},
     19}, // the store is full during a rewind to a state that has the tool
	{{0x008100a0, 0x00000034, 0x00000034, 0x00000034, 0x008101c0, 0x00000034, 0x00000034,
      0x01200060, 0x0001183c, 0x01a00040, 0x00000114, 0x00000034, 0x00000034, 0x00000034,
      0x00000034, 0x00000034, 0x00000034, 0x00000034, 0x00000034, 0x00000034, 0x00000034},
     21}, // an advance enables a tool, turned off in a rewind to a state that has the tool
	{{0x008100a0, 0x00000034, 0x00000034, 0x00000034, 0x00810000, 0x00000034, 0x00000034,
      0x00000034, 0x0001001c, 0x00000034, 0x00000034, 0x000000ed, 0x000000ed, 0x000000ed,
      0x00000034, 0x00000034, 0x00000034, 0x00000034},
     18}, // a driver is silent while another client advances
	{{0x008100a0, 0x00000034, 0x00000034, 0x00000034, 0x00810000, 0x00000034, 0x00000034,
      0x00000034, 0x0001053c, 0x000000ed, 0x000000ed, 0x000000ed, 0x00000011, 0x00000034,
      0x00000034, 0x00000034, 0x00000034, 0x00000034, 0x00000034},
     19}, // a driver is silent after its request to advance
};

static bool holds(world *w, const sequence *s)
{
	world_begin(w);
	for (int i = 0; i < s->count; i++)
		if (!world_do(w, s->codes[i]))
			return false;
	return world_end(w);
}

// Removes the codes that the failure does not need.
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

static void print_failure(world *w, sequence *s, const char *which, uint64_t seed)
{
	shrink(w, s);
	fprintf(stderr, "%s %llu fails; the shortest like it:\n", which, (unsigned long long)seed);
	w->script = stderr;
	holds(w, s);
	fprintf(stderr, "-> %s\n{", w->wrong);
	for (int i = 0; i < s->count; i++)
		fprintf(stderr, "%s%#xu", i ? ", " : "", s->codes[i]);
	fprintf(stderr, "}\n");
}

static bool old_ones_hold(world *w)
{
	for (size_t i = 0; i < sizeof found / sizeof *found; i++) {
		sequence s = found[i];
		if (!holds(w, &s)) {
			print_failure(w, &s, "found sequence", i);
			return false;
		}
	}
	return true;
}

int main(int argc, char **argv)
{
	uint64_t count = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000;
	uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	uint64_t events = 0;
	struct timespec began, ended;
	world *w = world_create();
	if (!old_ones_hold(w)) {
		world_destroy(w);
		return EXIT_FAILURE;
	}
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &began);
	for (uint64_t seed = first; seed < first + count; seed++) {
		sequence s;
		generate(&s, seed);
		events += (uint64_t)s.count;
		if (!holds(w, &s)) {
			print_failure(w, &s, "sequence", seed);
			world_destroy(w);
			return EXIT_FAILURE;
		}
	}
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ended);
	double seconds =
		(double)(ended.tv_sec - began.tv_sec) + 1e-9 * (double)(ended.tv_nsec - began.tv_nsec);
	printf("%llu sequences, %llu events, %.2f million a second; %llu ticks began, %llu tools were "
	       "energized in them, %llu of these in lock-step\n",
	       (unsigned long long)count, (unsigned long long)events, 1e-6 * (double)events / seconds,
	       (unsigned long long)w->steps, (unsigned long long)w->energized_steps,
	       (unsigned long long)w->energized_advances);
	// with fewer of these ticks and advances, the test would cover too little
	bool seen = w->steps > count / 100 && w->energized_steps > count / 1000 &&
	            w->energized_advances > count / 1000;
	world_destroy(w);
	return seen ? EXIT_SUCCESS : EXIT_FAILURE;
}
