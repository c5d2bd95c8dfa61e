// SPDX-License-Identifier: Apache-2.0
// The linear contact of one record, and its force at any position of the device.
#pragma once

#include <stdbool.h>

#include "cautery/channels.h"

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
