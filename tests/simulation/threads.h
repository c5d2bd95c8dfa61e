// SPDX-License-Identifier: GPL-3.0-or-later
// What the wrapped calls of the system take from the seed.
#pragma once

#include <stdint.h>

void sim_threads_begin(uint64_t seed);
