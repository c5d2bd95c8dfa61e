// SPDX-License-Identifier: GPL-3.0-or-later
// What a session decides: who drives which tool, whether it is lit, what becomes of an order, when
// time runs. A pure state machine: no thread, clock, socket, store or core, no allocation after the
// struct is made, no pointer out of it. Whoever holds it guards it with one short lock.
//
//     cau_logic_take   one event, from any thread: an order, a sign of life, a loss, the time
//     cau_logic_next   asked by the worker: the one thing that it does now
//     cau_logic_done   what came of it
//
// Events have an order, their moment. Whatever darkens a tool is an event like any other and notes
// its moment in the tool; an order to enable counts only while its own moment is later. A tick
// begins with cau_logic_next's answer CAU_ACT_STEP and with nothing else, so that no tick which
// begins after a cut is computed with energy, whatever waited in the queue.
//
// The rules, with the file of each:
//     dark unless enabled, enabled means lit, one driver a tool     drive.c
//     off is never refused, order is kept, newest motion wins       queue.c
//     when a tick begins, pause, step, lock-step, speed              time.c
//     one answer to each order, refused means unchanged             logic.c
//     what holds between two calls, and what follows if it does not sound.c
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/energy_off.h"
#include "cautery/scene.h"
#include "cautery/status.h"
#include "session/asker.h"

// ---- orders -------------------------------------------------------------------------------------

// What an order asks for, as far as the decision goes. All of them change something; what only
// reads a session waits elsewhere (hosted_session/read_requests.c).
typedef enum cau_ask {
	CAU_ASK_TISSUE,           // pins, forces, gravity, materials: about no tool
	CAU_ASK_TOOL_ADD,         // whoever adds it drives it
	CAU_ASK_TOOL_KEEP,        // configured: by its driver, or by anybody if it has none
	CAU_ASK_TOOL_REMOVE,      // likewise
	CAU_ASK_TOOL_USE,         // moved, opened, closed: by its driver
	CAU_ASK_MOTION,           // the same; nobody waits for it, the newest of a tick counts
	CAU_ASK_ENERGY_ON,        // by its driver
	CAU_ASK_ENERGY_OFF,       // by anybody who may operate; never refused for want of room
	CAU_ASK_TAKE_OVER,        // of nobody's tool; of anybody's by an admin
	CAU_ASK_HAND_OVER,        // by its driver, to another or to nobody
	CAU_ASK_REQUEST_TAKEOVER, // a question to its driver
	CAU_ASK_PAUSE,            // never refused for want of room
	CAU_ASK_RESUME,
	CAU_ASK_STEP,
	CAU_ASK_SPEED,
	CAU_ASK_GO,      // rewind, reset, restore: elsewhere in time
	CAU_ASK_HISTORY, // snapshot, fork: the present is kept
	CAU_ASK_DESTROY,
	CAU_ASK_ADVANCE, // ticks of a paused session, in lock-step, with what its asker does first
	CAU_ASK_COUNT
} cau_ask;

// What an ADVANCE does with one tool before its first tick.
typedef struct cau_part {
	char tool[CAU_NAME_BYTES];
	int32_t command; // the first of the request's commands about this tool: where an error points
	bool uses;       // moves, opens, closes or holds it
	bool on, off;    // energy; at most one of these
	uint64_t limit;  // of `on`: energy is off again after so many ticks; 0: no limit
} cau_part;

typedef struct cau_asked {
	uint64_t ticket; // the holder's own, given back in effects and actions
	cau_ask ask;
	cau_asker asker;
	cau_asker to;              // HAND_OVER; client 0: nobody
	char tool[CAU_NAME_BYTES]; // "" if it is about none
	uint64_t tick;             // commands: wanted at this tick border; 0: the next one
	uint64_t limit;            // ENERGY_ON: energy is off again after so many ticks; 0: no limit
	bool numbered;             // it may be a resend of one that was answered; never MOTION
	int64_t ticks;             // STEP, ADVANCE; the latter may ask for none
	double speed;              // SPEED: simulated over wall time
	double alive_s;            // its asker's newest sign of life, monotonic; 0: this order is one
	int32_t part_count;        // ADVANCE: each tool at most once
	cau_part parts[CAU_MAX_TOOLS];
} cau_asked;

// Why an order that waits will not be done.
#define CAU_VOID_CAUSE_TABLE(X)                                                                    \
	X(NOT, "")                                                                                     \
	X(LOST, "the client that sent this request disconnected before it took effect")                \
	X(CHANGED_HANDS, "the tool has another driver since the request")                              \
	X(REMOVED, "the tool was removed since the request")                                           \
	X(CANCELLED, "the request was cancelled")                                                      \
	X(DARKENED, "energy was turned off after this request to turn it on")
typedef enum cau_void_cause {
#define X(code, words) CAU_VOIDED_##code,
	CAU_VOID_CAUSE_TABLE(X)
#undef X
} cau_void_cause;

// An order in the queue.
typedef struct cau_waiting {
	cau_asked asked;
	uint64_t moment;     // of its coming in
	uint64_t cut_moment; // since when it is void, an enable does not count; 0: it is not
	cau_void_cause void_cause;
	uint64_t off_moment; // TOOL_ADD: the newest order since to turn the coming tool off; 0: none
	double alive_s;      // its asker's newest sign of life
	bool gone, to_gone;  // the asker, or the one it hands over to, will not come back
	bool looked;         // it is no resend
	bool postponed;      // it is one, whose first is not on the disk yet: waits for that
	bool overtaken;      // RESUME: a pause that came in later was served before it
} cau_waiting;

// ---- drivers ------------------------------------------------------------------------------------

enum { CAU_CAUSE_BYTES = 40 };

// A tool and who drives it.
typedef struct cau_drive {
	char tool[CAU_NAME_BYTES];
	cau_asker driver;    // client 0: nobody
	double alive_s;      // the driver's last sign of life
	bool enabled;        // its newest event about energy is an enable that counts
	uint64_t limit_tick; // while enabled: its energy goes off at this border; 0: it has no limit
	bool lit;            // the core was told to heat it
	bool freeze;         // the tool is to stay where it is, from the next border on
	bool frozen;         // and does, until its driver moves it
	bool by_order;       // the newest cut is an order of the queue, which tells the core itself
	int energy_off;      // CAU_ENERGY_OFF_*: why it is dark; meaningless while enabled
	uint64_t cut_moment; // no enable counts that came before
	int cut_off;         // the newest cut's CAU_ENERGY_OFF_*
	char cut_cause[CAU_CAUSE_BYTES];
} cau_drive;

// ---- events and effects -------------------------------------------------------------------------

typedef enum cau_logic_event_kind {
	CAU_LOGIC_ORDER,     // asked
	CAU_LOGIC_ALIVE,     // client, alive_s; tool: "" for all that it drives
	CAU_LOGIC_AWAY,      // client, cause: it looks away, or its connection is lost
	CAU_LOGIC_FORGET,    // client: it will not come back
	CAU_LOGIC_TIME,      // time has passed: drivers may be silent for too long
	CAU_LOGIC_STORE,     // store_takes, cause
	CAU_LOGIC_CANCEL,    // client, number: its order for a later tick; client 0: anybody's
	CAU_LOGIC_COMMITTED, // nothing of this session is on its way to the disk any more
	CAU_LOGIC_ARRIVED,   // tools, tick, state: after a start, rewind, reset or restore
	CAU_LOGIC_STAYED,    // what was to be gone to cannot be
	CAU_LOGIC_FAULT, // cause: numerical trouble outside a step, in a replay or in what is streamed
	CAU_LOGIC_DRAIN, // the daemon ends
	CAU_LOGIC_END,   // the session could not be brought up or kept
	CAU_LOGIC_EVENT_COUNT
} cau_logic_event_kind;

typedef struct cau_arrived_tool {
	char name[CAU_NAME_BYTES];
	bool lit;
} cau_arrived_tool;

typedef struct cau_logic_event {
	cau_logic_event_kind kind;
	double time_s;  // monotonic, of every event; never goes back by more than threads race
	double alive_s; // ALIVE: when the client gave the sign, at most time_s; 0: at time_s
	uint32_t client;
	uint64_t number;          // CANCEL: of cau_logic_later; 0: all of the client's
	const char *tool, *cause; // borrowed for the call; NULL: ""
	const cau_asked *asked;   // likewise
	bool store_takes;
	int state; // ARRIVED: CAU_SESSION_*
	uint64_t tick;
	double step_s; // ARRIVED
	const cau_arrived_tool *tools;
	int32_t tool_count;
} cau_logic_event;

typedef enum cau_effect_kind {
	CAU_EFFECT_REFUSE,   // ticket, status, code, path, reason
	CAU_EFFECT_REPLACED, // ticket: a newer motion stands in its place
	CAU_EFFECT_UNSTORED, // ticket: done at the next border, whatever the store says; answered now
	CAU_EFFECT_TELL,     // drive: who drives it, or its energy, changed
	CAU_EFFECT_WAKE,     // the worker has something to do
	CAU_EFFECT_ARMED,    // a tool is lit: CAU_LOGIC_TIME is due by cau_logic_look_s
} cau_effect_kind;

typedef struct cau_effect {
	cau_effect_kind kind;
	uint64_t ticket;
	int32_t code; // CAU_RPC_*; 0: the status's own
	cau_error error;
	cau_drive drive;
} cau_effect;

// One event tells of each tool at most once, and refuses, wakes and arms at most once.
enum { CAU_EFFECTS_MOST = CAU_MAX_TOOLS + 8 };

typedef struct cau_effects {
	int32_t count;
	cau_effect list[CAU_EFFECTS_MOST];
} cau_effects;

// ---- what the worker does -----------------------------------------------------------------------

typedef enum cau_act {
	CAU_ACT_NOTHING,    // wait until cau_logic_due_s
	CAU_ACT_REFUSE,     // ticket, motion, error, code
	CAU_ACT_LOOK,       // ticket: was it sent before, and answered? If not it is done
	CAU_ACT_ORDER,      // ticket: do it; cau_logic_done says what came of it
	CAU_ACT_CUT,        // drive, was_lit: energy off and, if drive.freeze, the tool stays
	CAU_ACT_PAUSE,      // an order to pause that was answered when it came
	CAU_ACT_STEP,       // a tick begins
	CAU_ACT_STEPPED,    // ticket: session.step or session.advance has made its ticks
	CAU_ACT_STEP_FAILED // ticket: the session faulted within them, or is gone
} cau_act;

typedef struct cau_action {
	cau_act act;
	uint64_t ticket;
	bool motion;  // REFUSE: nobody waits for an answer
	bool was_lit; // CUT, ORDER of ENERGY_OFF
	bool changed; // ORDER: the driver is another now, or time's state
	cau_error error;
	int32_t code;
	cau_drive drive; // CUT, and ORDER about a tool: as it is now
} cau_action;

typedef enum cau_outcome_kind {
	CAU_DONE,      // the core took it, or it is as asked; LOOK: it is no resend
	CAU_NOT_DONE,  // refused, and answered; LOOK: answered from the store
	CAU_POSTPONED, // LOOK: its first is not on the disk yet
} cau_outcome_kind;

// ---- the machine --------------------------------------------------------------------------------

typedef struct cau_logic {
	int32_t capacity; // of the queue, for orders of the next border; as many wait for later ticks
	uint64_t moment;  // of the newest event
	double now_s;     // of the newest event
	// time
	int state;  // CAU_SESSION_*
	bool going; // elsewhere in time: orders wait
	bool draining, ended;
	uint64_t pause_moment; // of an order to pause that found no room; 0: none
	uint64_t tick;
	double step_s, speed, next_step_s;
	int64_t steps_left;
	uint64_t stepping; // ticket of session.step or session.advance; 0: none
	// Lock-step. Its client's silence is counted in ticks. Only its client's advances make ticks,
	// and when it ends, so do the ticks that are left and all energy of its client.
	uint32_t lockstep;     // client; 0: none
	uint64_t advance_tick; // when its newest ADVANCE took effect
	char fault[320];       // FAULTED: why
	char broken[320];      // the safety rule that was broken (cautery/assert.h); "": none was
	// the store
	bool store_takes;
	char store_reason[160];
	// tools
	cau_drive drives[CAU_MAX_TOOLS];
	int32_t drive_count;
	uint64_t dark_moment; // of the newest cut of all, of tools too that are still to come
	// the queue, in the order of coming in
	bool border;            // the worker is between two ticks, and takes what came before
	uint64_t border_moment; // this
	cau_act acting;         // what the worker is at
	cau_waiting serving;    // ACT_ORDER, LOOK
	char cutting[CAU_NAME_BYTES];
	int32_t count;
	cau_waiting waiting[]; // twice the capacity; what is beyond `count` means nothing
} cau_logic;

// Orders for later ticks that one client may have waiting.
enum { CAU_LATER_OF_CLIENT = 64 };
int32_t cau_logic_later_most(int32_t capacity); // the same with a queue so small

// Bytes of a machine whose queue holds so many orders.
size_t cau_logic_bytes(int32_t capacity);
// `bytes` is what cau_logic_bytes said. It is starting, and takes orders.
void cau_logic_init(cau_logic *logic, int32_t capacity);

// The four calls below check safety rules in every build. If one is broken the session is faulted:
// all tools are to be cut, and `broken` says why. Orders but GO and DESTROY are refused until it
// has gone elsewhere in time.

// Takes one event. `effects` is emptied first; they are to be done in order, before the lock is
// given back if others must not see them turned round.
void cau_logic_take(cau_logic *logic, const cau_logic_event *event, cau_effects *effects);
// The one thing that the worker does now; cau_logic_done must follow every action but NOTHING.
void cau_logic_next(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects);
void cau_logic_done(cau_logic *logic, double now_s, cau_outcome_kind outcome, cau_effects *effects);
// After a step, in place of cau_logic_done: it has ended, well (`fault` is NULL) or in numerical
// trouble.
void cau_logic_stepped(cau_logic *logic, double now_s, const char *fault, cau_effects *effects);

// When the worker is to ask again: 0 now, INFINITY when woken.
double cau_logic_due_s(const cau_logic *logic);
// When CAU_LOGIC_TIME is due: INFINITY if nothing is lit.
double cau_logic_look_s(const cau_logic *logic);
// The drive of this tool, or NULL.
const cau_drive *cau_logic_drive(const cau_logic *logic, const char *tool);
// Orders that wait, postponed ones and those for later ticks too.
int32_t cau_logic_waiting(const cau_logic *logic);
// The next order for a later tick at or behind the place *i, which moves behind it; NULL: there is
// none. Its moment is its number.
const cau_waiting *cau_logic_later(const cau_logic *logic, int32_t *i);
