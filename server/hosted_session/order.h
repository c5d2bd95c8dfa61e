// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of a session. Orders wait in one queue, whatever transport they came by; the
// queue's order is the truth. They take effect at tick borders.
#pragma once

#include "cautery/command.h"
#include "cautery/messages.h"
#include "hosted_session/sink.h"
#include "session/asker.h"

typedef enum cau_order_kind {
	CAU_ORDER_COMMAND, // as.command
	CAU_ORDER_PAUSE,
	CAU_ORDER_RESUME,
	CAU_ORDER_STEP,  // as.ticks
	CAU_ORDER_SPEED, // as.speed
	CAU_ORDER_RESET,
	CAU_ORDER_REWIND,   // as.tick
	CAU_ORDER_SNAPSHOT, // as.name
	CAU_ORDER_RESTORE,  // as.name
	CAU_ORDER_FORK,     // as.fork
	CAU_ORDER_DESTROY,
	CAU_ORDER_TAKE_OVER,        // as.tool
	CAU_ORDER_HAND_OVER,        // as.tool
	CAU_ORDER_REQUEST_TAKEOVER, // as.tool
	CAU_ORDER_DESCRIBE,
	CAU_ORDER_TIMELINE, // as.timeline
	CAU_ORDER_EXPORT,   // as.format
	CAU_ORDER_LOG,      // as.log
	CAU_ORDER_JOIN,     // as.join
} cau_order_kind;

typedef struct cau_order {
	struct cau_order *next;
	cau_order_kind kind;
	bool motion; // a tool.move that nobody waits for: only the newest of a tick counts
	cau_asker asker;
	int64_t client_sequence; // 0: none
	cau_reply reply;
	union {
		cau_command command;
		int64_t ticks;
		double speed;
		uint64_t tick;
		char name[CAU_NAME_BYTES];
		struct {
			char tool[CAU_NAME_BYTES];
			uint32_t to; // HAND_OVER: this client; 0: nobody
			char to_name[65];
			double to_deadline_s;
			cau_role to_role;
		} tool;
		struct {
			char name[CAU_NAME_BYTES];
			bool has_tick, paused;
			uint64_t tick;
		} fork;
		struct {
			uint64_t from_tick;
			int32_t count;
		} timeline;
		int32_t format;
		struct {
			uint64_t from_tick, to_tick;
		} log;
		struct {
			double rate_hz, step_m;
			uint32_t channels;
		} join;
	} as;
} cau_order;
