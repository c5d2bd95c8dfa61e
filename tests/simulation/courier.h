// SPDX-License-Identifier: GPL-3.0-or-later
// A courier: takes a session from one daemon to the other (protocol/README.md, "Moving a session").
// Where something fails it does what a later courier would: it asks the source for the outcome.
#pragma once

#include <stdbool.h>
#include <stddef.h>

void courier_begin(void);
void courier_move(int session); // begins, if none is under way
bool courier_is_idle(void);
void courier_chunk(int client, const unsigned char *bytes, size_t count);
