// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the contact point of a face to the point that is nearest to the tool, in every iteration.
// The nearest point changes as the face tilts.
//
// A move to the nearest point in one go would oscillate. A face that is pushed at its nearest point
// tilts away there. Then another point is nearest, and a push there tilts the face back. But the
// tilt can be predicted. If the point of a push r moves by dw, in weights, the face tilts by r S
// dw, where S belongs to the face's corners. The nearest point of a tip of radius R then moves by r
// R L S dw, in weights, with L_kl = grad w_k . grad w_l. So of the way dw_n to the nearest point,
// the contact point moves by
//
//     (I + r R L S)^-1 dw_n.
//
// The moved point is then the nearest one, if the face responds linearly.
#pragma once

#include "solve/contact.h"

// Moves the point of constraint `row`, at solver->position. The tool must not have passed its face;
// otherwise the point stays.
void cau_contact_follow(cau_contact_set *set, const cau_step_solver *solver, int32_t row);
