// SPDX-License-Identifier: Apache-2.0
// What keeps a force passive and smooth, whatever it is made of: a tank of energy, and a bound on
// its change. After J.-H. Ryu, D.-S. Kwon and B. Hannaford 2004 (time-domain passivity control),
// whose controller lets the force jump. This one looks ahead: a force is allowed only while the
// tank also pays for taking it back as fast as the bound allows, should the device be pushed away
// with all that there is.
#pragma once

#include <stdbool.h>

// Bounds of a guard.
typedef struct energy_guard_def {
	double period_s;  // from call to call
	double slew_n;    // change of the force from call to call, at most
	double mass_kg;   // least mass of device and hand
	double hand_n;    // force that the hand gives at most
	double reserve_j; // the tank begins with this
	double tank_j;    // and has this at most
} energy_guard_def;

// The state of a guard. All zero, with its definition, is a guard before its first call.
typedef struct energy_guard {
	energy_guard_def def;
	bool begun;
	double tank_j;     // energy that may be given
	double given_j;    // energy given since the first call, less what came back
	double force_n[3]; // given in the present period
	double place_m[3]; // at its start
} energy_guard;

// Energy that a force of `force_n` N along a direction gives at most until it is taken back, J. The
// device moves along it with speed_m_s at first.
double energy_guard_need(const energy_guard_def *def, double force_n, double speed_m_s);

// Begins a period at a place of the device: the energy of the last one is known now.
void energy_guard_account(energy_guard *guard, const double place_m[3]);

// Brings a wanted force (N) to what may be given in this period. Returns whether energy had to
// change it.
bool energy_guard_bound(energy_guard *guard, const double velocity_m_s[3], double force_n[3]);
