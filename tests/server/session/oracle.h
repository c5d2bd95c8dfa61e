// SPDX-License-Identifier: GPL-3.0-or-later
// Whether what a session decides may be. Written from protocol/README.md ("Roles and driving"); it
// keeps its own books, looks at what the worker is told to do and never into the machine.
#pragma once

#include "server/session/world.h"

tool_book *oracle_book(world *w, const char *tool); // NULL: it is about none
ticket_book *oracle_ticket(world *w, uint64_t number);

// What came in by then does not light the tool.
void oracle_darken(tool_book *tool, uint64_t came);
void oracle_darken_all(world *w, uint64_t came);

// An order came in; was answered; was done by the worker.
void oracle_note_coming(world *w, const ticket_book *ticket);
void oracle_answered(world *w, uint64_t number);
void oracle_note_done(world *w, ticket_book *ticket);
// It was or was not refused when it came in: there is room unless others have taken it.
void oracle_check_room(world *w, const ticket_book *ticket);
// A client is lost; it takes back what it asked for at later ticks: one order, or (0) all.
void oracle_note_loss(world *w, int client, bool for_good);
// Of a tool that is not there; `before` the coming in of the off.
void oracle_note_off_of_none(world *w, const char *tool, uint64_t before);
void oracle_note_cancel(world *w, int client, uint64_t ticket);
// Somebody looked for silence: a later sign of life does not undo it.
void oracle_note_silence(world *w);
// A sign of life that was given at `alive_s` comes in; `name` "": for all tools.
void oracle_note_life(world *w, int client, const char *name, double alive_s);
// The worker cuts a tool: something that came in must be the reason.
void oracle_note_cut(world *w);

// The worker is told to do or to refuse an order; to begin a tick.
void oracle_check_decision(world *w);
void oracle_check_tick(world *w);
// Lock-step is over, and with it the ticks that are left.
void oracle_end_lockstep(world *w);
// What asked for ticks is answered: they are made, or lock-step has ended.
void oracle_check_stepped(world *w);
