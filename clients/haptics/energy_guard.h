// SPDX-License-Identifier: Apache-2.0
// Keeps a force passive and smooth, whatever computes the force. The guard is a tank of energy and
// a limit on the change of the force. It follows J.-H. Ryu, D.-S. Kwon and B. Hannaford 2004
// (time-domain passivity control), whose controller lets the force jump. This guard looks ahead: a
// force is allowed only if the tank also has the energy to reduce it as fast as the limit allows,
// while the hand pushes the device away with its largest force.
#pragma once

#include <stdbool.h>

// Limits of a guard.
typedef struct energy_guard_def {
	double period_s;  // time between two calls
	double slew_n;    // largest change of the force between two calls
	double mass_kg;   // least mass of device and hand
	double hand_n;    // largest force of the hand
	double reserve_j; // initial energy of the tank
	double tank_j;    // largest energy of the tank
} energy_guard_def;

// The state of a guard. Before its first call a guard is all zero except its definition.
typedef struct energy_guard {
	energy_guard_def def;
	bool begun;
	double tank_j;     // energy that may be given
	double given_j;    // energy given since the first call, minus the energy that came back
	double force_n[3]; // force of the present period
	double place_m[3]; // position of the device at the start of the period
} energy_guard;

// Returns the largest energy, J, that a force of `force_n` N along a direction can give until it is
// reduced to 0. The device moves at speed_m_s along the direction at first.
double energy_guard_need(const energy_guard_def *def, double force_n, double speed_m_s);

// Begins a period at position `place_m` of the device. Accounts the energy of the last period.
void energy_guard_account(energy_guard *guard, const double place_m[3]);

// Changes a wanted force (N) to an allowed force for this period. Returns true if the energy limit
// changed it.
bool energy_guard_bound(energy_guard *guard, const double velocity_m_s[3], double force_n[3]);
