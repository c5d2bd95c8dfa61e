// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a session.advance order besides its ticks. A cau_advance lies directly after its
// order, in the same memory block.
#pragma once

#include "cautery/command.h"
#include "cautery/messages.h"

enum {
	CAU_ADVANCE_COMMANDS = 32,
	CAU_ADVANCE_VERTICES = 16384, // most vertices that a request may choose
	CAU_ADVANCE_REGIONS = 8,
	// most numbers (positions and scalars) in an answer: 2.5 MB of text
	CAU_ADVANCE_NUMBERS = 131072,
};

typedef struct cau_advance_region {
	char name[CAU_NAME_BYTES];
	cau_selection where; // selection of kind BOX or SPHERE
} cau_advance_region;

typedef struct cau_advance {
	int64_t ticks;
	uint64_t began_tick; // tick at which the order took effect
	uint32_t channels;   // channels to observe: CAU_CHANNEL_* bits
	bool chosen;         // observe only the vertices in `vertices`
	bool energy;         // include the energy ledger of the instruments in the answer
	int32_t command_count, vertex_count, region_count;
	cau_command *commands; // in the memory block of the order
	int32_t *vertices;     // in the memory block of the order
	cau_advance_region regions[CAU_ADVANCE_REGIONS];
} cau_advance;
