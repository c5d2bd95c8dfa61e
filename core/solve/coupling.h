// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual coupling between the commanded and the actual pose of a tool (J. E. Colgate 1995; the
// actual pose is the god-object of C. B. Zilles and J. K. Salisbury 1995).
//
// A spring connects the tool with its commanded position. The tool's offset from this position is
// the sum of the forces of tissue on the tool over the spring's stiffness, and 0 without contact.
// The spring's force grows with its extension up to force_max_n, and is constant from there. So the
// tool pushes with at most force_max_n. If tissue resists more, the tool stops and the commanded
// position moves on.
//
// The energy of the spring is quadratic in the extension up to force_max_n, then linear. Each
// iteration uses a parabola that touches this energy at the tool's present offset and is nowhere
// below it. So the iteration lowers the energy (P. Huber 1981). Within an iteration the tool is a
// further unknown of the contact system, in balance with all its constraints. So the method is
// implicit, whatever the stiffness. The tool's rotation is always the commanded rotation.
#pragma once

#include "solve/contact.h"

// Distance (m) between the commanded and the actual position of a tool that pushes with
// force_max_n. A hand moves that far before the driver feels the full force. At 20 N the spring has
// 5,000 N/m, many times the stiffness of fat under a ball of 3 mm. So a light touch moves the tool
// hardly away from its commanded position.
static const double cau_coupling_reach_m = 0.004;

// Returns the anchor's pose moved by `offset` (m). If `offset` is 0, the result is bit for bit the
// anchor.
cau_pose cau_coupling_pose(const cau_pose *anchor, cau_vec3 offset);

// Sets each spring's compliance from its extension, and the offsets from the present reactions.
// Returns true if a compliance has changed.
bool cau_coupling_begin(cau_contact_set *set);

// Moves the tool for a reaction on the tissue that changed by `by` (N), in the opposite direction.
void cau_coupling_take(cau_contact_tool *tool, cau_vec3 by);
