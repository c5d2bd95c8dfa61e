// SPDX-License-Identifier: GPL-3.0-or-later
// Replaces threads, locks and clocks. sim_threads_begin seeds the random numbers of the wrapped
// system calls.
#pragma once

#include <stdint.h>

void sim_threads_begin(uint64_t seed);
