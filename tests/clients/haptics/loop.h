// SPDX-License-Identifier: GPL-3.0-or-later
// A haptic loop: a simulated hand on a simulated device, the renderer at 1 kHz, a link with a delay
// each way, and a session of the scene `fat` at 60 Hz.
#pragma once

#include "cautery/haptics.h"
#include "core/session/stage.h"

// The parameters of a run.
typedef struct loop_def {
	double young_modulus_pa; // stiffness of the fat
	double delay_s;          // delay of the link, in each direction
	double seconds;
	// motion of the hand
	void (*lead)(const struct loop_def *def, double time_s, double wanted_m[3]);
	// parameters of `lead`
	double deep_m, swing_m;
} loop_def;

// The results of a run, for each millisecond.
typedef struct loop_log {
	int count;
	double (*place_m)[3];  // position of the device
	double (*force_n)[3];  // rendered force
	double (*wanted_m)[3]; // wanted position of the hand
	double tick_s;         // mean processor time of a tick, with its record
	double most_given_j;   // largest net energy that the hand has got
	double most_jump_n;    // largest change of the force in a millisecond
	int limited;           // number of milliseconds in which energy changed the force
} loop_log;

// Returns the scene `fat` with this stiffness. The caller frees it.
cau_scene_def *loop_scene(double young_modulus_pa);

// Runs the loop. The caller frees the log with loop_finish.
loop_log loop_run(const loop_def *def);
void loop_finish(loop_log *log);

// Returns the raw force of the same scene at the device's positions, N, for each millisecond, on
// the heap. The session has steps of `step_s` and no delay. A force stays until the next step.
double (*loop_reference(const loop_def *def, const loop_log *log, double step_s))[3];
