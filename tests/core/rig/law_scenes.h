// SPDX-License-Identifier: GPL-3.0-or-later
// One scene for each law of the elements, on a small mesh.
#pragma once

#include "core/rig/rig.h"

typedef struct law_scene {
	const char *name;
	void (*add)(rig *r); // adds the law's layers to a rig after rig_begin
	int has_energy;      // 1: the gradient is that of an energy
} law_scene;

enum { LAW_SCENES = 14 };
extern const law_scene law_scenes[LAW_SCENES];

// Adds a roof of four triangles over six points, no two triangles in one plane, with its hinges.
cau_layer_def *law_add_roof(rig *r);
