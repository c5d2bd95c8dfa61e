// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated hand on a simulated device, the renderer at 1 kHz, a link with a delay each way, and
// a session of the scene `fat` at 60 Hz.
#pragma once

#include "cautery/haptics.h"
#include "core/session/stage.h"

// What is tried.
typedef struct loop_def {
	double young_modulus_pa; // of the fat
	double delay_s;          // of the link, each way
	double seconds;
	void (*lead)(const struct loop_def *def, double time_s, double wanted_m[3]); // of the hand
	double deep_m, swing_m;                                                      // for `lead`
} loop_def;

// What came of it, each millisecond.
typedef struct loop_log {
	int count;
	double (*place_m)[3];  // of the device
	double (*force_n)[3];  // rendered
	double (*wanted_m)[3]; // of the hand
	double tick_s;         // mean processor time of a tick, with its record
	double most_given_j;   // net energy that the hand had got at most
	double most_jump_n;    // in a millisecond
	int limited;           // milliseconds in which energy changed the force
} loop_log;

// The scene `fat` with the fat's stiffness; the caller frees it.
cau_scene_def *loop_scene(double young_modulus_pa);

// Runs it. The caller frees the log with loop_finish.
loop_log loop_run(const loop_def *def);
void loop_finish(loop_log *log);

// The raw force of the same scene at step_s along the device's places: each millisecond, N, on the
// heap. Without delay; a force holds until the next step.
double (*loop_reference(const loop_def *def, const loop_log *log, double step_s))[3];
