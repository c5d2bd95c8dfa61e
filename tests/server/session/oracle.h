// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether the decisions of a session are allowed. The oracle is written from
// protocol/README.md ("Roles and driving"). It keeps its own books, and reads the worker's acts,
// but never the state of the machine.
#pragma once

#include "server/session/world.h"

tool_book *oracle_book(world *w, const char *tool); // NULL: the tool's name is empty
ticket_book *oracle_ticket(world *w, uint64_t number);

// Enables that came in by `came` do not turn the tool's energy on.
void oracle_switch_off(tool_book *tool, uint64_t came);
void oracle_switch_all_off(world *w, uint64_t came);

// Called when an order came in, when it was answered, and when the worker has done it.
void oracle_note_coming(world *w, const ticket_book *ticket);
void oracle_answered(world *w, uint64_t number);
void oracle_note_done(world *w, ticket_book *ticket);
// Checks whether the order was rightly refused for lack of capacity, or rightly queued.
void oracle_check_room(world *w, const ticket_book *ticket);
// Notes that a client is lost.
void oracle_note_loss(world *w, int client, bool for_good);
// Notes an energy-off for a tool that does not exist. Enables that came in before `before` have no
// effect when the tool is added.
void oracle_note_off_of_none(world *w, const char *tool, uint64_t before);
// Notes that the client cancels one order for a later tick, or (0) all.
void oracle_note_cancel(world *w, int client, uint64_t ticket);
// Notes a check for silent drivers. A later sign of life does not undo a silence that it found.
void oracle_note_silence(world *w);
// Notes a sign of life that was given at `alive_s`; `name` "": for all tools.
void oracle_note_life(world *w, int client, const char *name, double alive_s);
// Notes that the worker cuts off a tool's energy. An event that came in must be the reason.
void oracle_note_cut(world *w);

// The next two functions check the worker's act: to do or refuse an order; to begin a tick.
void oracle_check_decision(world *w);
void oracle_check_tick(world *w);
// Ends lock-step and drops the remaining ticks.
void oracle_end_lockstep(world *w);
// Checks the answer to an order that asked for ticks: they are computed, or lock-step has ended.
void oracle_check_stepped(world *w);
