// SPDX-License-Identifier: GPL-3.0-or-later
// Every law of the elements on a small mesh of its own.
#pragma once

#include "core/rig/rig.h"

typedef struct law_scene {
	const char *name;
	void (*add)(rig *r); // to a rig that was begun
	int has_energy;      // its gradient is that of its energy
} law_scene;

enum { LAW_SCENES = 14 };
extern const law_scene law_scenes[LAW_SCENES];

// A roof of four triangles over six points, no two in one plane, and its hinges.
cau_layer_def *law_add_roof(rig *r);
