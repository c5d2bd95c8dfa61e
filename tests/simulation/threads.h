// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds the random numbers of the wrapped system calls.
#pragma once

#include <stdint.h>

void sim_threads_begin(uint64_t seed);
