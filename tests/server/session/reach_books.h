// SPDX-License-Identifier: GPL-3.0-or-later
// The books that the rules keep beside the machine: which enables still count, whose tools are
// wanted lit, and which order is next. Written from the wire page; they share no code with the
// machine.
#pragma once

#include "server/session/reach_state.h"

// What came in before does not light the tool any more; `client`: what this one asked for.
void reach_darken(reach_state *books, int tool, int client);
void reach_darken_all(reach_state *books, int client);
// What came in before this place does not light the tool.
void reach_darken_before(reach_state *books, int tool, int place);
void reach_note_silence(reach_state *books);
// By ticks where it is in lock-step, else by the clock.
bool reach_is_silent(const reach_state *books, const reach_tool *tool);
// The order at this place is answered; places are from 1.
void reach_drop_order(reach_state *books, int place);
// The place of the first that may be served, or 0: those for a later tick, and those whose first is
// on its way to the disk, stand aside.
int reach_head(const reach_state *books);
bool reach_waits_postponed(const reach_state *books, cau_ask ask);
