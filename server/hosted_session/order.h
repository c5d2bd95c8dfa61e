// SPDX-License-Identifier: GPL-3.0-or-later
// Orders to a session. Orders of all transports wait in one queue, and take effect in its order, at
// tick borders.
#pragma once

#include "cautery/command.h"
#include "cautery/messages.h"
#include "hosted_session/sink.h"
#include "session/logic.h"

// ---- the arguments of session.advance -----------------------------------------------------------
// They lie directly after their order, in the same memory block.

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

// ---- orders -------------------------------------------------------------------------------------

// The kinds of orders, and the functions that serve them at a tick border (slice.h).
//
//    CHANGE(KIND, ask, apply)  waits in the session's queue, and is decided as CAU_ASK_<ask> of
//                              session/logic.h; a COMMAND is decided by the kind of its command
//    READ(KIND, apply)         changes nothing, and waits in a queue of its own (read_requests.c)
#define CAU_ORDER_TABLE(CHANGE, READ)                                                              \
	CHANGE(COMMAND, TISSUE, cau_apply_command) /* as.command */                                    \
	CHANGE(PAUSE, PAUSE, cau_apply_pause)                                                          \
	CHANGE(RESUME, RESUME, cau_apply_resume)                                                       \
	CHANGE(STEP, STEP, cau_apply_step)          /* as.ticks */                                     \
	CHANGE(ADVANCE, ADVANCE, cau_apply_advance) /* as.advance */                                   \
	CHANGE(SPEED, SPEED, cau_apply_speed)       /* as.speed */                                     \
	CHANGE(RESET, GO, cau_apply_back)                                                              \
	CHANGE(REWIND, GO, cau_apply_back)            /* as.tick */                                    \
	CHANGE(SNAPSHOT, HISTORY, cau_apply_snapshot) /* as.name */                                    \
	CHANGE(RESTORE, GO, cau_apply_back)           /* as.name */                                    \
	CHANGE(FORK, HISTORY, cau_apply_fork)         /* as.fork */                                    \
	CHANGE(HOLD, GO, cau_apply_hold)                                                               \
	CHANGE(DESTROY, DESTROY, cau_apply_destroy)                                                    \
	CHANGE(TAKE_OVER, TAKE_OVER, cau_apply_drive)                          /* as.tool */           \
	CHANGE(HAND_OVER, HAND_OVER, cau_apply_drive)                          /* as.tool */           \
	CHANGE(REQUEST_TAKEOVER, REQUEST_TAKEOVER, cau_apply_request_takeover) /* as.tool */           \
	READ(DESCRIBE, cau_answer_describe)                                                            \
	READ(SNAPSHOTS, cau_apply_snapshots)                                                           \
	READ(TIMELINE, cau_apply_timeline) /* as.timeline */                                           \
	READ(EXPORT, cau_apply_export)     /* as.format */                                             \
	READ(LOG, cau_apply_log)           /* as.log */                                                \
	READ(JOIN, cau_apply_join)         /* as.join */                                               \
	READ(FRAME_AT, cau_apply_frame_at) /* as.frame_at */                                           \
	READ(FRAME_CANCEL, cau_apply_frame_cancel)                                                     \
	/* a new row goes above this line */

#define KIND(kind, ...) CAU_ORDER_##kind,
typedef enum cau_order_kind { CAU_ORDER_TABLE(KIND, KIND) CAU_ORDER_COUNT } cau_order_kind;
#undef KIND

// ---- arguments of some orders -------------------------------------------------------------------

typedef struct cau_tool_order {
	char tool[CAU_NAME_BYTES];
	uint32_t to; // HAND_OVER: number of the new driver; 0: no driver
	char to_name[65];
	double to_deadline_s;
	cau_role to_role;
} cau_tool_order;

typedef struct cau_fork_order {
	char name[CAU_NAME_BYTES];
	bool has_tick, paused;
	uint64_t tick;
} cau_fork_order;

typedef struct cau_timeline_order {
	uint64_t from_tick;
	int32_t count;
} cau_timeline_order;

typedef struct cau_log_order {
	uint64_t from_tick, to_tick;
} cau_log_order;

typedef struct cau_join_order {
	double rate_hz, step_m;
	bool plain;
	uint32_t channels;
} cau_join_order;

typedef struct cau_frame_at_order {
	uint64_t tick;
	double step_m;
	bool plain;
	uint32_t channels;
	int64_t branch; // this and the next member are filled in when the order is served
	uint64_t epoch;
} cau_frame_at_order;

typedef struct cau_order {
	struct cau_order *next;
	cau_order_kind kind;
	bool motion; // a tool.move without an answer: only the newest of a tick counts
	cau_asker asker;
	int64_t client_sequence; // 0: no sequence number
	double came_s;           // arrival at the session; set by cau_hosted_submit
	double alive_s; // newest sign of life of the client, monotonic; 0: this order is the newest
	cau_reply reply;
	union {
		cau_command command;
		int64_t ticks;
		cau_advance *advance; // follows the order in the same memory block
		double speed;
		uint64_t tick;
		char name[CAU_NAME_BYTES];
		cau_tool_order tool;
		cau_fork_order fork;
		cau_timeline_order timeline;
		int32_t format;
		cau_log_order log;
		cau_join_order join;
		cau_frame_at_order frame_at;
	} as;
} cau_order;

// Appends the order to a list.
static inline void cau_order_append(cau_order **list, cau_order *order)
{
	while (*list)
		list = &(*list)->next;
	order->next = NULL;
	*list = order;
}
