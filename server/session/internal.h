// SPDX-License-Identifier: GPL-3.0-or-later
// Functions that the files of this folder share. Calls between the files: logic.c -> queue.c,
// time.c -> drive.c -> effects.c.
#pragma once

#include <string.h>

#include "session/logic.h"

// ---- effects.c: reports of a session to other parts
void cau_effect_tell(cau_effects *effects, const cau_drive *drive);
void cau_effect_wake(cau_effects *effects);
void cau_effect_armed(cau_effects *effects);
cau_effect *cau_effect_add(cau_effects *effects, cau_effect_kind kind, uint64_t ticket);

// ---- drive.c
cau_drive *cau_drive_find(cau_logic *logic, const char *tool);
// Turns the tool's energy off. Every enable that came before `moment` is void.
void cau_drive_cut(cau_drive *drive, uint64_t moment, int energy_off, const char *cause,
                   cau_effects *effects);
void cau_drive_cut_energized(cau_logic *logic, uint64_t moment, int energy_off, const char *cause,
                             cau_effects *effects);
void cau_drive_cut_client(cau_logic *logic, uint32_t client, const char *cause,
                          cau_effects *effects);
// True if the tool's energy is on and its driver gave no sign of life for longer than the deadline.
// In lock-step, the deadline is a number of ticks: the client is silent if its advance goes beyond
// this number.
bool cau_drive_is_silent(const cau_logic *logic, const cau_drive *drive, double now_s);
// Ends lock-step without turning energy off. The caller turns off the client's energy.
void cau_drive_end_lockstep(cau_logic *logic);
void cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects);
void cau_drive_forget(cau_logic *logic, uint32_t client, cau_effects *effects);
void cau_drive_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s);
void cau_drive_match(cau_logic *logic, const cau_logic_event *event);
// Finds the next energy cut-off that the core needs. Returns false if there is none. `forced`: also
// finds cut-offs for which an order in the queue is waiting.
bool cau_drive_next_cut(cau_logic *logic, bool forced, cau_action *action);
void cau_drive_cut_done(cau_logic *logic, cau_effects *effects);
void cau_drive_cut_itself(cau_logic *logic, const char *tool);
bool cau_drive_is_to_cut(const cau_logic *logic);
// True if the order is allowed to use its tool. Otherwise fills the action with the refusal.
bool cau_drive_allows(cau_logic *logic, const cau_waiting *order, cau_action *action);
// True if the core can take another tool, with this name. Otherwise fills the action with the
// refusal.
bool cau_drive_may_be_added(cau_logic *logic, const char *tool, cau_action *action);
// True if an ADVANCE is allowed to use all of its tools. Otherwise fills the action with the
// refusal.
bool cau_drive_allows_parts(cau_logic *logic, const cau_waiting *order, cau_action *action);
// Changes the driver of a tool. `to` with client 0 leaves the tool without a driver. Returns false
// if the tool's energy is on: then an energy cut-off comes first.
bool cau_drive_change(cau_drive *drive, const cau_waiting *order, const cau_asker *to,
                      cau_effects *effects);
// Notes that the core has accepted an enable, from an order or from a part of an ADVANCE.
void cau_drive_enabled(cau_logic *logic, cau_drive *drive, const cau_waiting *order, uint64_t limit,
                       cau_effects *effects);
// Turns off the energy of tools whose limit of ticks is reached.
void cau_drive_cut_limits(cau_logic *logic, cau_effects *effects);
void cau_drive_add(cau_logic *logic, const cau_waiting *order);
void cau_drive_remove(cau_logic *logic, const char *tool);

// ---- queue.c
void cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects);
// Returns the time of the asker's newest sign of life; `now_s` is the arrival time of the order.
double cau_order_alive_s(const cau_asked *asked, double now_s);
void cau_queue_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s);
// Each of the next four functions makes waiting orders void: orders that move, hold or heat a tool,
// and commands of the tool's driver for later ticks. The four functions are for a client that is
// lost, for tools whose driver is silent now, for a tool that changes its driver, and for a tool
// that is removed. A function with `moment` affects only orders from before `moment`. An energy-off
// becomes void only if its sender drives the tool. If a client will not return, all of its commands
// for later ticks are void.
void cau_queue_cut(cau_logic *logic, uint32_t client);
void cau_queue_cut_silent(cau_logic *logic, double now_s);
void cau_queue_change_hands(cau_logic *logic, const cau_drive *drive, uint64_t moment);
void cau_queue_remove_tool(cau_logic *logic, const char *tool, uint64_t moment);
void cau_queue_cancel(cau_logic *logic, uint32_t client, uint64_t number, cau_effects *effects);
// Makes resume orders from before `moment` ineffective, because a later pause was served.
void cau_queue_overtake(cau_logic *logic, uint64_t moment);
void cau_queue_forget(cau_logic *logic, uint32_t client);
// Makes enables from before `moment` void, for a tool that does not exist yet.
void cau_queue_switch_off(cau_logic *logic, const char *tool, uint64_t moment);
void cau_queue_committed(cau_logic *logic, cau_effects *effects);
// Returns the first order that may be served at this border, or NULL.
cau_waiting *cau_queue_head(cau_logic *logic);
cau_waiting *cau_queue_find(cau_logic *logic, uint64_t ticket);
const cau_waiting *cau_queue_find_ask(const cau_logic *logic, cau_ask ask);
// Returns true if an energy-off of the tool waits for this border, not for a later tick.
bool cau_queue_off_waits(const cau_logic *logic, const char *tool);
void cau_queue_remove(cau_logic *logic, cau_waiting *order);
bool cau_queue_is_due(const cau_logic *logic);

// ---- time.c
// True if a tick may begin now, by the clock, by session.step or by session.advance.
bool cau_time_is_due(const cau_logic *logic, double now_s);
void cau_time_begin_tick(cau_logic *logic, double now_s);
void cau_time_end_tick(cau_logic *logic);
// The next three functions serve orders about time. They return false after filling the action with
// a refusal or with an act that comes first.
bool cau_time_resume(cau_logic *logic, const cau_waiting *order, cau_action *action,
                     cau_effects *effects);
bool cau_time_step(cau_logic *logic, const cau_waiting *order, cau_action *action,
                   cau_effects *effects);
bool cau_time_advance(cau_logic *logic, const cau_waiting *order, cau_action *action);
// call this once the core has accepted the advance
void cau_time_advanced(cau_logic *logic, const cau_waiting *order);
// True if the order that asked for ticks must be answered now. Fills the action.
bool cau_time_end_of_steps(cau_logic *logic, cau_action *action);
bool cau_time_go(const cau_logic *logic, cau_action *action);
void cau_time_speed(cau_logic *logic, double speed, double now_s);
double cau_time_due_s(const cau_logic *logic);

// ---- sound.c
// Faults the session with this reason. All energy must be cut off.
void cau_logic_fault(cau_logic *logic, const char *reason, cau_effects *effects);
// Checks the conditions that hold between any two calls, for any input.
void cau_logic_expect_sound(const cau_logic *logic);
// Repairs the machine after a broken rule: the session is faulted, and the energy of every tool
// must be cut off. The order with this ticket (0: none) is refused, unless it is in the queue.
// `give_up`: drops all waiting orders if a rule was broken before. The caller must still end the
// worker's act.
void cau_logic_break_off(cau_logic *logic, const char *reason, uint64_t ticket, bool give_up,
                         cau_effects *effects);
// Ends the worker's act.
void cau_logic_end_act(cau_logic *logic);
