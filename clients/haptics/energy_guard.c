// SPDX-License-Identifier: Apache-2.0
// A force F that is held for one period does the work F . d, where d is the motion of the device.
// In the worst case the force and the hand accelerate the device along F, and the force is then
// reduced by slew_n a period. energy_guard_need sums the work of this case.
//
// The tank has this energy for the present force. So in the next period the tank has the energy for
// a force that is slew_n less. Therefore some force is always allowed, and the tank is never empty.
// The guard searches between that reduced force and the wanted force. Every force between them
// differs by slew_n at most from the last one. The guard takes the force nearest to the wanted one
// for which the tank has the energy.
#include "haptics/internal.h"

#include <string.h>

double energy_guard_need(const energy_guard_def *def, double force_n, double speed_m_s)
{
	double need = 0, h = def->period_s, speed = speed_m_s;
	double acceleration = (force_n + def->hand_n) / def->mass_kg;
	int periods = (int)ceil(force_n / def->slew_n);
	for (int k = 0; k < periods; k++) {
		double force = force_n - k * def->slew_n;
		need += force * (speed + acceleration * h / 2) * h;
		speed += acceleration * h;
	}
	return need;
}

void energy_guard_account(energy_guard *guard, const double place_m[3])
{
	double way[3];
	if (!guard->begun)
		guard->tank_j = guard->def.reserve_j;
	else {
		add_scaled3(way, place_m, -1, guard->place_m);
		double given = dot3(guard->force_n, way);
		guard->given_j += given;
		guard->tank_j = fmin(guard->tank_j - given, guard->def.tank_j);
	}
	guard->begun = true;
	memcpy(guard->place_m, place_m, sizeof guard->place_m);
}

// Limits the change of a force from the last force to slew_n.
static void bound_change(const energy_guard *guard, double force_n[3])
{
	double change[3];
	add_scaled3(change, force_n, -1, guard->force_n);
	double length = length3(change), most = guard->def.slew_n;
	if (length > most)
		add_scaled3(force_n, guard->force_n, most / length, change);
}

static bool pays(const energy_guard *guard, const double velocity_m_s[3], const double force_n[3])
{
	double length = length3(force_n);
	if (!(length > 0))
		return true;
	double speed = dot3(velocity_m_s, force_n) / length;
	return energy_guard_need(&guard->def, length, speed) <= guard->tank_j;
}

bool energy_guard_bound(energy_guard *guard, const double velocity_m_s[3], double force_n[3])
{
	// Number of bisections. They reduce the interval, which is 2 slew_n at most, to about a
	// thousandth.
	enum { HALVINGS = 10 };
	bool bound = false;
	bound_change(guard, force_n);
	if (!pays(guard, velocity_m_s, force_n)) {
		double last = length3(guard->force_n), low = 0, high = 1;
		double left = last > guard->def.slew_n ? 1 - guard->def.slew_n / last : 0;
		double least[3], towards[3];
		add_scaled3(least, (double[3]){0, 0, 0}, left, guard->force_n);
		add_scaled3(towards, force_n, -1, least);
		for (int k = 0; k < HALVINGS; k++) {
			double share = (low + high) / 2;
			add_scaled3(force_n, least, share, towards);
			if (pays(guard, velocity_m_s, force_n))
				low = share;
			else
				high = share;
		}
		add_scaled3(force_n, least, low, towards);
		bound = true;
	}
	memcpy(guard->force_n, force_n, sizeof guard->force_n);
	return bound;
}
