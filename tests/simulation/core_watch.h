// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the double of the core: which session it belongs to, on which machine, and whether the
// worker computes a tick, executes an order or replays the log.
#pragma once

#include "simulation/world.h"

void core_watch_begin(uint64_t seed, const sim_profile *profile);
void core_watch_killed(int machine);
void core_watch_advance(int64_t to_ns); // checks every core
// Returns the state of a session on a machine: gravity's number and tick. Returns false if the
// session is not there.
bool core_watch_state(int session, int machine, int *gravity, int64_t *tick);
