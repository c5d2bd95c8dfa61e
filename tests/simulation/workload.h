// SPDX-License-Identifier: GPL-3.0-or-later
// What clients, operators and disks do in a run: a list of steps, made from the seed alone. A step
// that makes no sense when its time has come does nothing, so any of them may be left out.
#pragma once

#include "simulation/world.h"

enum { STEPS_MOST = 512 };

// code, word: the step's arguments a, b, c
#define STEP_TABLE(X)                                                                              \
	X(CONNECT, "connect")     /* client, machine */                                                \
	X(CUT, "cut")             /* client: its connection is lost */                                 \
	X(HIDE, "hide")           /* client: its page is hidden */                                     \
	X(SHOW, "show")           /* sim_client */                                                     \
	X(SILENT, "silent")       /* client: no heartbeats */                                          \
	X(BEAT, "beat")           /* client: again */                                                  \
	X(LATE, "late")           /* client, tenths of a second: what it sends arrives after them */   \
	X(STOP_READING, "unread") /* client takes nothing */                                           \
	X(READ, "read")           /* client, frames a round */                                         \
	X(CREATE, "create")       /* client, session, 1: paused, of 6; 5: ephemeral */                 \
	X(DESTROY, "destroy")     /* client, sim_session */                                            \
	X(FORK, "fork")           /* client, session, the session that it makes */                     \
	X(FORK_PAST, "fork_past") /* the same, from the middle of its ticks */                         \
	X(TAKE, "take")           /* client, session, tool */                                          \
	X(ON, "on")               /* client, session, tool */                                          \
	X(ON_LATER, "on_later")   /* client, session, after how many ticks, with a tool of TOOLS */    \
	X(OFF, "off")             /* client, session, tool */                                          \
	X(HAND_OVER, "hand_over") /* client, session, tool */                                          \
	X(MOVE, "move")           /* client, session, tool */                                          \
	X(GRAVITY, "gravity")     /* client, sim_session */                                            \
	X(BURST, "burst")         /* client, session, how many gravities at once */                    \
	X(GRAVITY_LATER, "gravity_later") /* client, session, after how many ticks */                  \
	X(CANCEL, "cancel")               /* client, session: what waits for later ticks */            \
	X(PAUSE, "pause")                 /* client, sim_session */                                    \
	X(RESUME, "resume")               /* client, sim_session */                                    \
	X(STEP, "step")                   /* client, session, ticks */                                 \
	X(ADVANCE, "advance")   /* client, session, twice the ticks and a tool of TOOLS: energy on */  \
	X(REWIND, "rewind")     /* client, session, hundredths of its ticks */                         \
	X(RESET, "reset")       /* client, sim_session */                                              \
	X(SNAPSHOT, "snapshot") /* client, session, name */                                            \
	X(RESTORE, "restore")   /* client, session, name */                                            \
	X(PAST, "past")         /* client, session, hundredths of its ticks: it is looked at */        \
	X(SPEED, "speed")       /* client, session, halves of the clock's, less one */                 \
	X(HOLD, "hold")         /* client, session, tool */                                            \
	X(REMOVE, "remove")     /* client, session: its last tool */                                   \
	X(ADD, "add")           /* client, session: that tool again */                                 \
	X(AGAIN, "again")       /* client sends its newest change again */                             \
	X(JOIN, "join")         /* client, sim_session */                                              \
	X(KEY_FRAME, "key_frame")  /* client, sim_session */                                           \
	X(MOVE_SESSION, "migrate") /* session: to the other machine */                                 \
	X(KILL, "kill")            /* machine: kill -9 */                                              \
	X(POWER, "power")          /* machine: power is lost */                                        \
	X(RESTART, "restart")      /* machine: SIGTERM, and a start */                                 \
	X(STOP, "stop")            /* machine, tenths of a second: SIGSTOP, then SIGCONT */            \
	X(FULL, "full")            /* machine: its disk takes no more */                               \
	X(ROOM, "room")            /* machine: it does again */                                        \
	X(SLOW_DISK, "slow_disk")  /* machine, ms of a sync */                                         \
	X(BAD_DISK, "bad_disk")    /* machine: one in c writes or syncs fails */                       \
	X(GOOD_DISK, "good_disk")  /* machine: fast and without errors */
typedef enum step_kind {
#define X(code, word) STEP_##code,
	STEP_TABLE(X)
#undef X
		STEP_KINDS
} step_kind;

typedef struct work_step {
	int64_t at_ns; // after the begin
	step_kind kind;
	int a, b, c;
	bool left_out;
} work_step;

typedef struct workload {
	int machines; // that have a daemon
	int count;
	work_step steps[STEPS_MOST];
} workload;

void workload_make(workload *work, uint64_t seed, const sim_profile *profile);
void workload_print(const workload *work);
void workload_begin(void);
void workload_do(const work_step *step);
