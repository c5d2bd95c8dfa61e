// SPDX-License-Identifier: GPL-3.0-or-later
// The coupling between the pose that a tool is asked to take and the one that it has (the
// god-object of C. B. Zilles and J. K. Salisbury 1995, on the virtual coupling of J. E. Colgate
// 1995).
//
// The tool hangs by a spring on the place that it is asked to take: it is off that by the sum of
// the forces that tissue puts on it, divided by the spring's stiffness, and not at all where
// nothing touches. The spring gives at most force_max_n: pulled out farther than it is at that
// force, its force stays. So the tool pushes with that at most, and where tissue bears more, it
// stands still and the place that is asked goes on without it. Its energy is quadratic, then
// linear; each iteration takes the parabola that touches it where the tool is, which lies above it
// everywhere, so that the iteration falls (P. Huber 1981). Within an iteration the tool is a
// further unknown of the contact's own system, in balance with all its rows: nothing of it is
// explicit, whatever the stiffness. It turns as it is asked to.
#pragma once

#include "solve/contact.h"

// How far (m) a tool is from where it is asked to be when it pushes with force_max_n. A driver's
// hand has moved as far as that before it feels all there is; and at 20 N the spring, 2,000 N/m, is
// twenty times as stiff as fat under a ball of 3 mm, so that light touch is where it is asked for.
static const double cau_coupling_reach_m = 0.004;

// The anchor's pose, off by so much (m); to the bit where that is nothing.
cau_pose cau_coupling_pose(const cau_pose *anchor, cau_vec3 offset);

// The spring's compliance by how far it is pulled out, and the offsets that the present reactions
// make. Returns whether a compliance has changed.
bool cau_coupling_begin(cau_contact_set *set);

// A reaction on the tissue (N) has changed by so much: the tool gives way the other way.
void cau_coupling_take(cau_contact_tool *tool, cau_vec3 by);
