// SPDX-License-Identifier: GPL-3.0-or-later
// Fills any object of messages.def with good values, for tests that go through all of them.
#pragma once

#include "rpc/message_table.h"

typedef enum fill { FILL_LEAST, FILL_MOST } fill;

// Storage for the lists inside one object, given back by release_message.
void fill_message(cau_wire_object object, void *to, fill how, cau_scene_def *scene);
// Gives lists room as a reader needs it.
void prepare_message(cau_wire_object object, void *to, cau_scene_def *scene);
void release_message(cau_wire_object object, void *of);

// Whether both hold the same, as far as readers fill it (scenes are not compared).
bool same_message(cau_wire_object object, const void *a, const void *b);
