// SPDX-License-Identifier: GPL-3.0-or-later
// Fills any object of messages.def with valid values, for tests of all objects.
#pragma once

#include "rpc/message.h"

typedef enum fill { FILL_LEAST, FILL_MOST } fill;

// Fills an object. The lists inside it are allocated, and release_message frees them.
void fill_message(cau_wire_object object, void *to, fill how, cau_scene_def *scene);
// Allocates the lists of an object, as a reader needs them.
void prepare_message(cau_wire_object object, void *to, cau_scene_def *scene);
void release_message(cau_wire_object object, void *of);

// True if a reader has restored all of `a` in `b`. Scenes are not compared.
bool same_message(cau_wire_object object, const void *a, const void *b);
