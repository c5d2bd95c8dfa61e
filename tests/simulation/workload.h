// SPDX-License-Identifier: GPL-3.0-or-later
// What clients, operators and disks do in a run: a list of steps, made only from the seed. A step
// that makes no sense at its time does nothing, so any step may be left out.
#pragma once

#include "simulation/world.h"

enum { STEPS_MOST = 512 };

// Columns: code, word. The comments name the step's arguments a, b, c.
#define STEP_TABLE(X)                                                                              \
	X(CONNECT, "connect") /* client, machine */                                                    \
	X(CUT, "cut")         /* client: its connection is lost */                                     \
	X(HIDE, "hide")       /* client: its page is hidden */                                         \
	X(SHOW, "show")       /* client: its page is visible */                                        \
	X(SILENT, "silent")   /* client: sends no heartbeats */                                        \
	X(BEAT, "beat")       /* client: sends heartbeats again */                                     \
	X(LATE, "late")       /* client, tenths of a second: its messages are delayed until then */    \
	X(STOP_READING, "unread") /* client: reads nothing */                                          \
	X(READ, "read")           /* client, largest number of frames a round */                       \
	X(CREATE, "create")       /* client, session, 0 to 5: 1 is paused, 5 is ephemeral */           \
	X(DESTROY, "destroy")     /* client, session */                                                \
	X(FORK, "fork")           /* client, session, index of the new session */                      \
	X(FORK_PAST, "fork_past") /* as fork, from the middle of the session's ticks */                \
	X(TAKE, "take")           /* client, session, tool */                                          \
	X(ON, "on")               /* client, session, tool */                                          \
	X(ON_LATER,                                                                                    \
	  "on_later") /* client, session, ticks of delay; their remainder by TOOLS is the tool */      \
	X(OFF, "off") /* client, session, tool */                                                      \
	X(HAND_OVER, "hand_over")         /* client, session, tool */                                  \
	X(MOVE, "move")                   /* client, session, tool */                                  \
	X(GRAVITY, "gravity")             /* client, session */                                        \
	X(BURST, "burst")                 /* client, session, number of gravities sent at once */      \
	X(GRAVITY_LATER, "gravity_later") /* client, session, ticks of delay */                        \
	X(CANCEL, "cancel")               /* client, session: removes commands for later ticks */      \
	X(PAUSE, "pause")                 /* client, session */                                        \
	X(RESUME, "resume")               /* client, session */                                        \
	X(STEP, "step")                   /* client, session, ticks */                                 \
	X(ADVANCE, "advance")     /* client, session, c: 1 + c/2 ticks, energy on of tool c % TOOLS */ \
	X(REWIND, "rewind")       /* client, session, tick in hundredths of its ticks */               \
	X(RESET, "reset")         /* client, session */                                                \
	X(SNAPSHOT, "snapshot")   /* client, session, name */                                          \
	X(RESTORE, "restore")     /* client, session, name */                                          \
	X(PAST, "past")           /* client, session, hundredths of its ticks: views that tick */      \
	X(SPEED, "speed")         /* client, session, c: (c + 1) / 2 times the pace of the clock */    \
	X(HOLD, "hold")           /* client, session, tool */                                          \
	X(REMOVE, "remove")       /* client, session: removes the last tool */                         \
	X(ADD, "add")             /* client, session: adds the last tool again */                      \
	X(AGAIN, "again")         /* client: resends its newest change */                              \
	X(JOIN, "join")           /* client, session */                                                \
	X(KEY_FRAME, "key_frame") /* client, session */                                                \
	X(MOVE_SESSION, "migrate") /* session: moves to the other machine */                           \
	X(KILL, "kill")            /* machine: kill -9 */                                              \
	X(POWER, "power")          /* machine: loses power */                                          \
	X(RESTART, "restart")      /* machine: SIGTERM, then a start */                                \
	X(STOP, "stop")            /* machine, tenths of a second: SIGSTOP, then SIGCONT */            \
	X(FULL, "full")            /* machine: its disk is full */                                     \
	X(ROOM, "room")            /* machine: its disk has space again */                             \
	X(SLOW_DISK, "slow_disk")  /* machine, duration of a sync in ms */                             \
	X(BAD_DISK, "bad_disk")    /* machine, -, c: one in c writes or syncs fails */                 \
	X(GOOD_DISK, "good_disk")  /* machine: its disk is fast and without errors */
typedef enum step_kind {
#define X(code, word) STEP_##code,
	STEP_TABLE(X)
#undef X
		STEP_KINDS
} step_kind;

typedef struct work_step {
	int64_t at_ns; // time since the start of the run
	step_kind kind;
	int a, b, c;
	bool left_out;
} work_step;

typedef struct workload {
	int machines; // number of machines with a daemon
	int count;
	work_step steps[STEPS_MOST];
} workload;

void workload_make(workload *work, uint64_t seed, const sim_profile *profile);
void workload_print(const workload *work);
void workload_begin(void);
void workload_do(const work_step *step);
