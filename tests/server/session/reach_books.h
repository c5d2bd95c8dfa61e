// SPDX-License-Identifier: GPL-3.0-or-later
// Books that the rules keep beside the machine: which enables still count, which tools should be
// energized, and which order is next. They are written from protocol/README.md and share no code
// with the machine.
#pragma once

#include "server/session/reach_state.h"

// Makes earlier enables of the tool ineffective; `client`: only enables of this client.
void reach_switch_off(reach_state *books, int tool, int client);
void reach_switch_all_off(reach_state *books, int client);
// Makes enables before this place in the queue ineffective for the tool.
void reach_switch_off_before(reach_state *books, int tool, int place);
void reach_note_silence(reach_state *books);
// True if the tool's driver is silent: counted in ticks in lock-step, otherwise by the clock.
bool reach_is_silent(const reach_state *books, const reach_tool *tool);
// Removes the order at this place, which was answered. Places count from 1.
void reach_drop_order(reach_state *books, int place);
// Returns the place of the first order that may be served, or 0. Orders for a later tick, and
// resends whose earlier order is on its way to the disk, are skipped.
int reach_head(const reach_state *books);
bool reach_waits_postponed(const reach_state *books, cau_ask ask);
