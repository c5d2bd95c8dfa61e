// SPDX-License-Identifier: Apache-2.0
// Declarations for the files of the haptic library.
#pragma once

#include <math.h>
#include <stdbool.h>

#include "cautery/channels.h"

// ---- vectors -----------------------------------------------------------------------------------
// Vectors of three numbers. Symmetric matrices are stored as xx, yy, zz, xy, xz, yz.
static inline double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double length3(const double a[3])
{
	return sqrt(dot3(a, a));
}

// Computes to = a + scale * b.
static inline void add_scaled3(double to[3], const double a[3], double scale, const double b[3])
{
	for (int i = 0; i < 3; i++)
		to[i] = a[i] + scale * b[i];
}

static inline bool is_finite3(const double a[3])
{
	return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

// Computes to = m a.
static inline void symmetric_times(double to[3], const double m[6], const double a[3])
{
	double x = m[0] * a[0] + m[3] * a[1] + m[4] * a[2];
	double y = m[3] * a[0] + m[1] * a[1] + m[5] * a[2];
	double z = m[4] * a[0] + m[5] * a[1] + m[2] * a[2];
	to[0] = x, to[1] = y, to[2] = z;
}

// ---- local contact (local_contact.c) -----------------------------------------------------------
// The linear contact of one record, and its force at any position of the device.

// A checked record with derived values. All zero means a contact that never pushes.
typedef struct local_contact {
	bool valid;
	double place_m[3];    // commanded position of the record
	double force_n[3];    // force of the planes and friction at the record, without the grasp
	double compliance[6]; // m/N, with a lower bound
	double stiffness[6];  // inverse of the compliance, N/m
	double record_n;      // force of the planes at the record's position, or 0
	double coupling[CAU_CONTACT_PLANES][CAU_CONTACT_PLANES]; // n_i . C n_j, m/N
	double pressing_n[CAU_CONTACT_PLANES];                   // f_i of the last evaluation
	int32_t plane_count;
	cau_contact_plane plane[CAU_CONTACT_PLANES];
	double friction, damping_ns_m, grasp_n_m, grasp_anchor_m[3];
} local_contact;

// The force on the device, with the values that damping needs.
typedef struct local_force {
	double force_n[3];
	double normal[3];    // unit normal of the contact; 0 without contact
	double normal_n;     // force of the planes along the normal
	double pressed_n;    // sum of the planes' forces; friction is proportional to it
	double normal_n_m;   // stiffness along the normal
	double grasp_n_m;    // stiffness of the grasp, the same in all directions
	double damping_ns_m; // damping of the tissue along the normal
	double tissue_m_s;   // speed of the tissue along the normal
} local_force;

// Returns why a record cannot be rendered, or NULL.
const char *local_contact_check(const cau_tool_contact *record);

// Takes a record. Limits the stiffness to stiffness_max_n_m. A record that is not valid, or that
// local_contact_check refuses, makes a contact that never pushes.
void local_contact_set(local_contact *contact, const cau_tool_contact *record,
                       double stiffness_max_n_m);

// Returns the force at a commanded position (m).
local_force local_contact_force(local_contact *contact, const double place_m[3]);

// ---- energy guard (energy_guard.c) -------------------------------------------------------------
// Keeps a force passive and smooth, whatever computes the force. The guard is a tank of energy and
// a limit on the change of the force. It follows J.-H. Ryu, D.-S. Kwon and B. Hannaford 2004
// (time-domain passivity control), whose controller lets the force jump. This guard looks ahead: a
// force is allowed only if the tank also has the energy to reduce it as fast as the limit allows,
// while the hand pushes the device away with its largest force.

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
