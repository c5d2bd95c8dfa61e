// SPDX-License-Identifier: GPL-3.0-or-later
// The decisions of a session: which client drives which tool, whether a tool's energy is on, what
// happens to an order, and when ticks begin. This is a pure state machine, without thread, clock,
// socket, store or core. It allocates nothing after its creation and has no pointers to other data.
// The caller guards it with one short lock.
//
//     cau_logic_take   takes one event from any thread: an order, a sign of life, a loss, the time
//     cau_logic_next   gives the worker the one act that it carries out now
//     cau_logic_done   takes the outcome of the act
//
// Events are numbered; the number of an event is its moment. Each event that turns off a tool's
// energy notes its moment in the tool. An order to enable the tool counts only if its own moment is
// later. A tick begins only with CAU_ACT_STEP from cau_logic_next. So no tick that begins after an
// energy cut-off is computed with energy, whatever waits in the queue.
//
// The rules, with the file of each:
//     energy off unless enabled, enabled means energy on,
//         one driver a tool                                         drive.c
//     off is never refused, order is kept, newest motion wins       queue.c
//     when a tick begins, pause, step, lock-step, speed              time.c
//     one answer to each order, refused means unchanged             logic.c
//     what holds between two calls, and what follows if it does not sound.c
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/energy_off.h"
#include "cautery/message_choices.h"
#include "cautery/scene.h"
#include "cautery/status.h"

// ---- askers
// The client that sends a request to a session: a client of a connection, or a DDS writer.
typedef struct cau_asker {
	uint32_t client; // number of the client, as in frames; 0: no client
	char name[65];
	char client_id[65];
	cau_role role;
	double deadline_s; // the client's energy is cut off after a silence of this length, s
} cau_asker;

// ---- orders -------------------------------------------------------------------------------------

// What an order asks for, as far as decisions depend on it. All of these orders change something.
// Requests that only read a session wait elsewhere (hosted_session/read_requests.c). The text
// after a colon names the clients that may send the order.
typedef enum cau_ask {
	CAU_ASK_TISSUE,    // pins, forces, gravity, materials: no tool is concerned
	CAU_ASK_TOOL_ADD,  // add a tool, which the client then drives
	CAU_ASK_TOOL_KEEP, // configure a tool: for its driver, or for any client if there is no driver
	CAU_ASK_TOOL_REMOVE, // remove a tool: for its driver, or for any client if there is no driver
	CAU_ASK_TOOL_USE,    // move, open or close a tool: for its driver
	// move a tool without an answer: for its driver; only the newest motion of a tick counts
	CAU_ASK_MOTION,
	CAU_ASK_ENERGY_ON,  // turn energy on: for the tool's driver
	CAU_ASK_ENERGY_OFF, // turn energy off: for the role operate; accepted even if the queue is full
	CAU_ASK_TAKE_OVER, // become the driver: for any client if there is none, otherwise for an admin
	CAU_ASK_HAND_OVER, // change the driver to another client or to none: for the tool's driver
	CAU_ASK_REQUEST_TAKEOVER, // ask the tool's driver to hand it over
	CAU_ASK_PAUSE,            // accepted even if the queue is full
	CAU_ASK_RESUME,
	CAU_ASK_STEP,
	CAU_ASK_SPEED,
	CAU_ASK_GO,      // rewind, reset, restore: another tick becomes the present
	CAU_ASK_HISTORY, // snapshot, fork: the present does not change
	CAU_ASK_DESTROY,
	CAU_ASK_ADVANCE, // commands, then ticks of a paused session, in lock-step
	CAU_ASK_COUNT
} cau_ask;

// What an ADVANCE does with one tool before its first tick.
typedef struct cau_part {
	char tool[CAU_NAME_BYTES];
	// index of the request's first command about this tool, for the path of an error
	int32_t command;
	bool uses;      // moves, opens, closes or holds the tool
	bool on, off;   // turns energy on or off; at most one of these is set
	uint64_t limit; // if `on`: number of ticks after which energy goes off; 0: no limit
} cau_part;

typedef struct cau_asked {
	uint64_t ticket; // the caller's own number, given back in effects and actions
	cau_ask ask;
	cau_asker asker;
	cau_asker to;              // HAND_OVER: the new driver; client 0: none
	char tool[CAU_NAME_BYTES]; // "" if the order concerns no tool
	uint64_t tick;      // commands: the tick border at which they take effect; 0: the next one
	uint64_t limit;     // ENERGY_ON: number of ticks after which energy goes off; 0: no limit
	bool numbered;      // the order may be a resend of an answered order; never set for MOTION
	int64_t ticks;      // STEP, ADVANCE: number of ticks; ADVANCE may ask for 0
	double speed;       // SPEED: simulated time over wall time
	double alive_s;     // newest sign of life of the asker, monotonic; 0: the order is the newest
	int32_t part_count; // ADVANCE: each tool occurs at most once
	cau_part parts[CAU_MAX_TOOLS];
} cau_asked;

// Why a waiting order will not be done.
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
	uint64_t moment; // moment of its arrival
	// moment since when the order is void and an enable does not count; 0: it is not void
	uint64_t cut_moment;
	cau_void_cause void_cause;
	// TOOL_ADD: moment of the newest order to turn the future tool off; 0: none
	uint64_t off_moment;
	double alive_s; // newest sign of life of the asker
	// the asker (`gone`) or the new driver of a hand-over (`to_gone`) will not return
	bool gone, to_gone;
	bool looked;    // the store was searched: the order is not a resend
	bool postponed; // the order is a resend that waits until the earlier order is on the disk
	bool overtaken; // RESUME: a later pause was served first
} cau_waiting;

// ---- drivers ------------------------------------------------------------------------------------

enum { CAU_CAUSE_BYTES = 40 };

// A tool and its driver.
typedef struct cau_drive {
	char tool[CAU_NAME_BYTES];
	cau_asker driver;    // client 0: no driver
	double alive_s;      // the driver's newest sign of life
	bool enabled;        // the newest event about energy is an enable that counts
	uint64_t limit_tick; // if enabled: energy goes off at the border of this tick; 0: no limit
	bool energized;      // the core heats the tool
	bool freeze;         // the worker must stop the tool where it is, at the next border
	bool frozen;         // the tool stays where it is until its driver moves it
	// the newest cut-off comes from an order in the queue, and that order turns the core's energy
	// off
	bool by_order;
	int energy_off;      // CAU_ENERGY_OFF_*: why energy is off; not used while enabled
	uint64_t cut_moment; // enables from before this moment do not count
	int cut_off;         // CAU_ENERGY_OFF_* of the newest cut-off
	char cut_cause[CAU_CAUSE_BYTES];
} cau_drive;

// ---- events and effects -------------------------------------------------------------------------

// The kinds of events, and the members of cau_logic_event that a kind uses.
typedef enum cau_logic_event_kind {
	CAU_LOGIC_ORDER, // uses `asked`
	CAU_LOGIC_ALIVE, // uses client, alive_s, and tool ("": all tools that the client drives)
	CAU_LOGIC_AWAY, // uses client and cause: the client's page is hidden, or its connection is lost
	CAU_LOGIC_FORGET, // uses client: the client will not return
	CAU_LOGIC_TIME,   // time has passed, so drivers may have been silent for too long
	CAU_LOGIC_STORE,  // uses store_takes and cause
	// uses client and number: cancels an order for a later tick; client 0: of any client
	CAU_LOGIC_CANCEL,
	CAU_LOGIC_COMMITTED, // all batches of this session are on the disk
	// uses tools, tick and state: the core has a new state after a start, rewind, reset or restore
	CAU_LOGIC_ARRIVED,
	CAU_LOGIC_STAYED, // the rewind, reset or restore has failed, or a move was given up
	// uses cause: numerical trouble outside a step, in a replay or in streamed values
	CAU_LOGIC_FAULT,
	CAU_LOGIC_DRAIN, // the daemon ends
	CAU_LOGIC_END,   // the session could not be built or kept
	CAU_LOGIC_EVENT_COUNT
} cau_logic_event_kind;

typedef struct cau_arrived_tool {
	char name[CAU_NAME_BYTES];
	bool energized;
} cau_arrived_tool;

typedef struct cau_logic_event {
	cau_logic_event_kind kind;
	// time of the event, monotonic; later events are earlier only by a race of threads
	double time_s;
	double alive_s; // ALIVE: time of the sign of life, at most time_s; 0: time_s
	uint32_t client;
	uint64_t number;          // CANCEL: number from cau_logic_later; 0: all orders of the client
	const char *tool, *cause; // borrowed for the call; NULL means ""
	const cau_asked *asked;   // borrowed for the call
	bool store_takes;
	int state; // ARRIVED: CAU_SESSION_*
	uint64_t tick;
	double step_s; // ARRIVED: length of a tick, simulated s
	const cau_arrived_tool *tools;
	int32_t tool_count;
} cau_logic_event;

// The kinds of effects, and the members of cau_effect that a kind has.
typedef enum cau_effect_kind {
	CAU_EFFECT_REFUSE,   // with ticket, status, code, path, reason
	CAU_EFFECT_REPLACED, // with ticket: a newer motion has replaced the order
	// with ticket: the order takes effect at the next border, stored or not; answer it now
	CAU_EFFECT_UNSTORED,
	CAU_EFFECT_TELL,  // with drive: its driver or its energy changed
	CAU_EFFECT_WAKE,  // the worker has something to do
	CAU_EFFECT_ARMED, // energy came on: CAU_LOGIC_TIME is due by cau_logic_look_s
} cau_effect_kind;

typedef struct cau_effect {
	cau_effect_kind kind;
	uint64_t ticket;
	int32_t code; // CAU_RPC_*; 0: the code of the status
	cau_error error;
	cau_drive drive;
} cau_effect;

// Largest number of effects of one event. An event reports each tool at most once, and refuses,
// wakes and arms at most once.
enum { CAU_EFFECTS_MOST = CAU_MAX_TOOLS + 8 };

typedef struct cau_effects {
	int32_t count;
	cau_effect list[CAU_EFFECTS_MOST];
} cau_effects;

// ---- the worker's acts --------------------------------------------------------------------------

// The acts of the worker, and the members of cau_action that an act has.
typedef enum cau_act {
	CAU_ACT_NOTHING, // wait until cau_logic_due_s
	CAU_ACT_REFUSE,  // with ticket, motion, error, code: refuse the order
	// with ticket: look for an earlier answer to the order. If there is none, the order is done
	// later.
	CAU_ACT_LOOK,
	CAU_ACT_ORDER, // with ticket: do the order; cau_logic_done takes the outcome
	// with drive and was_energized: turn energy off and, if drive.freeze, stop the tool where it is
	CAU_ACT_CUT,
	CAU_ACT_PAUSE,      // pause the session; the order to pause was answered on arrival
	CAU_ACT_STEP,       // compute a tick
	CAU_ACT_STEPPED,    // with ticket: session.step or session.advance has its ticks
	CAU_ACT_STEP_FAILED // with ticket: the session faulted within the ticks, or has ended
} cau_act;

typedef struct cau_action {
	cau_act act;
	uint64_t ticket;
	bool motion;        // REFUSE: the order needs no answer
	bool was_energized; // CUT, and ORDER of ENERGY_OFF: the core heated the tool
	bool changed;       // ORDER: the driver or the state of time has changed
	cau_error error;
	int32_t code;
	cau_drive drive; // CUT, and ORDER about a tool: its present state
} cau_action;

typedef enum cau_outcome_kind {
	// the core accepted the order, or nothing was to change; LOOK: the order is not a resend
	CAU_DONE,
	CAU_NOT_DONE,  // the order was refused and answered; LOOK: answered from the store
	CAU_POSTPONED, // LOOK: the earlier order is not on the disk yet
} cau_outcome_kind;

// ---- the machine --------------------------------------------------------------------------------

typedef struct cau_logic {
	// capacity of the queue, for orders of the next border; the same again for later ticks
	int32_t capacity;
	uint64_t moment; // moment of the newest event
	double now_s;    // time of the newest event
	// time
	int state;  // CAU_SESSION_*
	bool going; // the session is being rewound, reset or restored: orders wait
	bool draining, ended;
	// moment of an order to pause that came while the queue was full; 0: none
	uint64_t pause_moment;
	uint64_t tick;
	double step_s, speed, next_step_s;
	int64_t steps_left;
	// ticket of the session.step or session.advance whose ticks are being computed; 0: none
	uint64_t stepping;
	// Lock-step. The client's silence is counted in ticks. Only this client's advances make ticks.
	// The end of lock-step also ends the remaining ticks and all energy of the client.
	uint32_t lockstep;     // number of the client; 0: no lock-step
	uint64_t advance_tick; // tick at which the client's newest ADVANCE took effect
	char fault[320];       // FAULTED: the reason
	char broken[320];      // the safety rule that was broken (cautery/assert.h); "": none
	// the store
	bool store_takes;
	char store_reason[160];
	// tools
	cau_drive drives[CAU_MAX_TOOLS];
	int32_t drive_count;
	// moment of the newest cut-off of all energy; applies to tools that are added later, too
	uint64_t all_off_moment;
	// the queue, in the order of arrival
	bool border; // the worker is between two ticks, and serves orders from before border_moment
	uint64_t border_moment; // moment at which this border began
	cau_act acting;         // the worker's present act
	cau_waiting serving;    // the order of the act; for ORDER and LOOK
	char cutting[CAU_NAME_BYTES];
	int32_t count;
	cau_waiting waiting[]; // twice the capacity; entries beyond `count` have no meaning
} cau_logic;

// Largest number of one client's waiting orders for later ticks.
enum { CAU_LATER_OF_CLIENT = 64 };
// returns this largest number for a queue of `capacity`
int32_t cau_logic_later_most(int32_t capacity);

// Returns the bytes of a machine with a queue of this capacity.
size_t cau_logic_bytes(int32_t capacity);
// `logic` has cau_logic_bytes(capacity) bytes. The session is starting and accepts orders.
void cau_logic_init(cau_logic *logic, int32_t capacity);

// The four calls below check safety rules in every build. If a rule is broken, the session is
// faulted: the energy of all tools must be cut off, and `broken` has the reason. Orders except GO
// and DESTROY are refused until the session is rewound, reset or restored.

// Takes one event. First empties `effects`. The caller carries them out in order. Effects whose
// order matters to others must be carried out before the lock is released.
void cau_logic_take(cau_logic *logic, const cau_logic_event *event, cau_effects *effects);
// Writes the worker's next act to *action. A call of cau_logic_done must follow every act except
// NOTHING.
void cau_logic_next(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects);
void cau_logic_done(cau_logic *logic, double now_s, cau_outcome_kind outcome, cau_effects *effects);
// Takes the outcome of CAU_ACT_STEP, in place of cau_logic_done. `fault` is NULL, or describes the
// numerical trouble.
void cau_logic_stepped(cau_logic *logic, double now_s, const char *fault, cau_effects *effects);

// Returns the time of the next cau_logic_next: 0: now; INFINITY: when the worker is woken.
double cau_logic_due_s(const cau_logic *logic);
// Returns the time at which CAU_LOGIC_TIME is due; INFINITY: no energy is on.
double cau_logic_look_s(const cau_logic *logic);
// Returns the drive of this tool, or NULL.
const cau_drive *cau_logic_drive(const cau_logic *logic, const char *tool);
// Returns the number of waiting orders, with postponed orders and orders for later ticks.
int32_t cau_logic_waiting(const cau_logic *logic);
// Returns the next order for a later tick from index *i on, and moves *i behind it. Returns NULL if
// there is none. The order's moment is its number.
const cau_waiting *cau_logic_later(const cau_logic *logic, int32_t *i);
