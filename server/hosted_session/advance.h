// SPDX-License-Identifier: GPL-3.0-or-later
// What session.advance asks for besides ticks. It lies behind its order, in the same memory.
#pragma once

#include "cautery/command.h"
#include "cautery/messages.h"

enum {
	CAU_ADVANCE_COMMANDS = 32,
	CAU_ADVANCE_VERTICES = 16384, // chosen ones
	CAU_ADVANCE_REGIONS = 8,
	CAU_ADVANCE_NUMBERS = 131072, // of positions and scalars in an answer: 2.5 MB of text
};

typedef struct cau_advance_region {
	char name[CAU_NAME_BYTES];
	cau_selection where; // BOX or SPHERE
} cau_advance_region;

typedef struct cau_advance {
	int64_t ticks;
	uint64_t began_tick; // set when it takes effect
	uint32_t channels;   // CAU_CHANNEL_*, to be observed
	bool chosen;         // `vertices` alone
	bool energy;         // where the energy of instruments went
	int32_t command_count, vertex_count, region_count;
	cau_command *commands; // in this memory
	int32_t *vertices;     // likewise
	cau_advance_region regions[CAU_ADVANCE_REGIONS];
} cau_advance;
