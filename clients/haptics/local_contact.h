// SPDX-License-Identifier: Apache-2.0
// The linear contact of one record, and the force that it gives at any place of the device.
#pragma once

#include <stdbool.h>

#include "cautery/channels.h"

// A checked record, with what follows from it. All zero is a contact that never pushes.
typedef struct local_contact {
	bool valid;
	double place_m[3];    // commanded place of the record
	double force_n[3];    // force of its planes and friction there, without the grasp
	double compliance[6]; // m/N, bounded from below
	double stiffness[6];  // its inverse, N/m
	double record_n;      // force of the planes at the record's place; 0: none
	double coupling[CAU_CONTACT_PLANES][CAU_CONTACT_PLANES]; // n_i . C n_j, m/N
	double pressing_n[CAU_CONTACT_PLANES];                   // f_i of the last evaluation
	int32_t plane_count;
	cau_contact_plane plane[CAU_CONTACT_PLANES];
	double friction, damping_ns_m, grasp_n_m, grasp_anchor_m[3];
} local_contact;

// Force on the device, and what damps it there.
typedef struct local_force {
	double force_n[3];
	double normal[3];    // of the contact, unit; 0 where nothing touches
	double normal_n;     // force of the planes, along it
	double pressed_n;    // sum of the planes' forces, which friction goes by
	double normal_n_m;   // stiffness along it
	double grasp_n_m;    // stiffness in all directions
	double damping_ns_m; // of the tissue along the normal
	double tissue_m_s;   // speed of the tissue along the normal
} local_force;

// Why a record cannot be rendered, or NULL.
const char *local_contact_check(const cau_tool_contact *record);

// Takes a record. A stiffness is stiffness_max_n_m at most. One that is not valid, or that
// local_contact_check refuses, makes a contact that never pushes.
void local_contact_set(local_contact *contact, const cau_tool_contact *record,
                       double stiffness_max_n_m);

// The force at a commanded place (m).
local_force local_contact_force(local_contact *contact, const double place_m[3]);
