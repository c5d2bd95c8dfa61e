// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the double of the core. For each core, it knows the session and the machine, and whether
// the worker computes a tick, executes an order or replays the log.
#pragma once

#include "simulation/world.h"

void core_watch_begin(uint64_t seed, const sim_profile *profile);
void core_watch_killed(int machine);
void core_watch_advance(int64_t to_ns); // checks every core
// Reads the state of a session on a machine: the number of its gravity, and its tick. Returns false
// if the machine does not have the session.
bool core_watch_state(int session, int machine, int *gravity, int64_t *tick);
