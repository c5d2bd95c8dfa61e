// SPDX-License-Identifier: GPL-3.0-or-later
// A courier that takes a session from one daemon to the other (protocol/README.md, "Moving a
// session"). After a failure it asks the source for the outcome, as a later courier would do.
#pragma once

#include <stdbool.h>
#include <stddef.h>

void courier_begin(void);
void courier_move(int session); // begins a move unless one is in progress
bool courier_is_idle(void);
void courier_chunk(int client, const unsigned char *bytes, size_t count);
