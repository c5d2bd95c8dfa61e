// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share. Arrows: logic.c -> queue.c, time.c -> drive.c -> effects.c.
#pragma once

#include <string.h>

#include "session/logic.h"

// ---- effects.c: what others must be told
void cau_effect_tell(cau_effects *effects, const cau_drive *drive);
void cau_effect_wake(cau_effects *effects);
void cau_effect_armed(cau_effects *effects);
cau_effect *cau_effect_add(cau_effects *effects, cau_effect_kind kind, uint64_t ticket);

// ---- drive.c
cau_drive *cau_drive_find(cau_logic *logic, const char *tool);
// Dark from now on, for every enable asked before `moment`.
void cau_drive_cut(cau_drive *drive, uint64_t moment, int energy_off, const char *cause,
                   cau_effects *effects);
void cau_drive_cut_lit(cau_logic *logic, uint64_t moment, int energy_off, const char *cause,
                       cau_effects *effects);
void cau_drive_cut_client(cau_logic *logic, uint32_t client, const char *cause,
                          cau_effects *effects);
// Lit, by a driver who gave no sign of life for longer than its deadline; in lock-step, by its
// client, which has asked for ticks that go beyond as many as its deadline has.
bool cau_drive_is_silent(const cau_logic *logic, const cau_drive *drive, double now_s);
// Only the flag and the ticks that are left. Whoever calls it turns off its client's energy.
void cau_drive_end_lockstep(cau_logic *logic);
void cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects);
void cau_drive_forget(cau_logic *logic, uint32_t client, cau_effects *effects);
void cau_drive_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s);
void cau_drive_match(cau_logic *logic, const cau_logic_event *event);
// The next cut that the core must be told; false: none. `forced`: of those too whose own order
// waits.
bool cau_drive_next_cut(cau_logic *logic, bool forced, cau_action *action);
void cau_drive_cut_done(cau_logic *logic, cau_effects *effects);
void cau_drive_cut_itself(cau_logic *logic, const char *tool);
bool cau_drive_is_to_cut(const cau_logic *logic);
// Whether the order may do what it asks with its tool; false after filling the action's refusal.
bool cau_drive_allows(cau_logic *logic, const cau_waiting *order, cau_action *action);
// Whether the core has room for a tool of this name; false after filling the action's refusal.
bool cau_drive_may_be_added(cau_logic *logic, const char *tool, cau_action *action);
// The same for all that an ADVANCE does with tools.
bool cau_drive_allows_parts(cau_logic *logic, const cau_waiting *order, cau_action *action);
// Another drives, or nobody. False: it is lit, and its cut comes first.
bool cau_drive_change(cau_drive *drive, const cau_waiting *order, const cau_asker *to,
                      cau_effects *effects);
// The core has taken an enable: an order's, or a part's of an ADVANCE.
void cau_drive_enabled(cau_logic *logic, cau_drive *drive, const cau_waiting *order, uint64_t limit,
                       cau_effects *effects);
// Off where the ticks of an enable are over.
void cau_drive_cut_limits(cau_logic *logic, cau_effects *effects);
void cau_drive_add(cau_logic *logic, const cau_waiting *order);
void cau_drive_remove(cau_logic *logic, const char *tool);

// ---- queue.c
void cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects);
// When the order's asker was alive; `now_s` is the time of its coming in.
double cau_order_alive_s(const cau_asked *asked, double now_s);
void cau_queue_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s);
// What moves, holds or heats a tool and waits is void where its asker is lost, and so is what that
// client asked for at later ticks: of all tools, of those whose driver is silent now, of one that
// changes hands or is removed (what came in before `moment`). An off is void only if its asker
// drives the tool. Of a client that will not come back all that is for later is void.
void cau_queue_cut(cau_logic *logic, uint32_t client);
void cau_queue_cut_silent(cau_logic *logic, double now_s);
void cau_queue_change_hands(cau_logic *logic, const cau_drive *drive, uint64_t moment);
void cau_queue_remove_tool(cau_logic *logic, const char *tool, uint64_t moment);
void cau_queue_cancel(cau_logic *logic, uint32_t client, uint64_t number, cau_effects *effects);
void cau_queue_overtake(cau_logic *logic, uint64_t moment); // orders to resume from before it
void cau_queue_forget(cau_logic *logic, uint32_t client);
// Enables from before `moment` of a tool that is not there do not count any more.
void cau_queue_darken(cau_logic *logic, const char *tool, uint64_t moment);
void cau_queue_committed(cau_logic *logic, cau_effects *effects);
// The first that may be served at this border, or NULL.
cau_waiting *cau_queue_head(cau_logic *logic);
cau_waiting *cau_queue_find(cau_logic *logic, uint64_t ticket);
const cau_waiting *cau_queue_find_ask(const cau_logic *logic, cau_ask ask);
bool cau_queue_off_waits(const cau_logic *logic, const char *tool); // for now, not for later
void cau_queue_remove(cau_logic *logic, cau_waiting *order);
bool cau_queue_is_due(const cau_logic *logic);

// ---- time.c
// True if a tick may begin now, by the clock, by session.step or by session.advance.
bool cau_time_is_due(const cau_logic *logic, double now_s);
void cau_time_begin_tick(cau_logic *logic, double now_s);
void cau_time_end_tick(cau_logic *logic);
// Orders about time; false after filling the action's refusal.
bool cau_time_resume(cau_logic *logic, const cau_waiting *order, cau_action *action,
                     cau_effects *effects);
bool cau_time_step(cau_logic *logic, const cau_waiting *order, cau_action *action,
                   cau_effects *effects);
bool cau_time_advance(cau_logic *logic, const cau_waiting *order, cau_action *action);
void cau_time_advanced(cau_logic *logic, const cau_waiting *order); // and the core took it
// What asked for ticks is to be answered.
bool cau_time_end_of_steps(cau_logic *logic, cau_action *action);
bool cau_time_go(const cau_logic *logic, cau_action *action);
void cau_time_speed(cau_logic *logic, double speed, double now_s);
double cau_time_due_s(const cau_logic *logic);

// ---- sound.c
// The session stands still with this reason, and its tools are to be cut.
void cau_logic_fault(cau_logic *logic, const char *reason, cau_effects *effects);
// What holds between two calls, whatever came in.
void cau_logic_expect_sound(const cau_logic *logic);
// After a broken rule: makes the machine sound again, faulted, with every tool to be cut. The order
// of `ticket` (0: none) is refused unless it waits. `give_up`: what waits is dropped if a rule was
// broken before. The worker's act, if there is one, is still to be ended.
void cau_logic_break_off(cau_logic *logic, const char *reason, uint64_t ticket, bool give_up,
                         cau_effects *effects);
// The worker's act is over.
void cau_logic_end_act(cau_logic *logic);
