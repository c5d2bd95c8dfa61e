// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the state machine of a session. Each four bytes are one event or act in the world of the
// property test (world.h). A fuzzer that sees the branches taken finds sequences that random tests
// do not.
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "server/session/world.h"

// most events of a run; each event has at most one order, and TICKETS is larger
enum { EVENTS_MOST = 200 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static world *w;
	if (!w)
		w = world_create();
	world_begin(w);
	for (size_t i = 0; i + sizeof(uint32_t) <= bytes && i / sizeof(uint32_t) < EVENTS_MOST;
	     i += sizeof(uint32_t)) {
		uint32_t code;
		memcpy(&code, data + i, sizeof code);
		if (!world_do(w, code))
			break;
	}
	if (*w->wrong || !world_end(w)) {
		fprintf(stderr, "%s\n", w->wrong);
		abort();
	}
	return 0;
}
