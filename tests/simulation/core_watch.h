// SPDX-License-Identifier: GPL-3.0-or-later
// What the double of the core is told, and by whom: which session, on which machine, at a tick of
// the worker's, while an order is done, or while the log is replayed.
#pragma once

#include "simulation/world.h"

void core_watch_begin(uint64_t seed, const sim_profile *profile);
void core_watch_killed(int machine);
void core_watch_advance(int64_t to_ns); // looks at every core
// The state that a session is in on a machine: gravity's number and tick. False: it is not there.
bool core_watch_state(int session, int machine, int *gravity, int64_t *tick);
