// SPDX-License-Identifier: GPL-3.0-or-later
// The point of a face at which a tool pushes goes with what is nearest to the tool, iteration by
// iteration: as a face tilts, another of its points touches.
//
// Taken at once, that would not end: a face that is pushed at its nearest point tilts away there,
// another point is nearest, and pushed there it tilts back. How much it does is known before. A
// push r on a point that is moved by dw, in weights, tilts the face by r S dw, with S of its
// corners; a tip of radius R is then nearest elsewhere by R times that, which is r R L S dw in
// weights, with L_kl = grad w_k . grad w_l. So of the way dw_n to what is nearest the point goes
//
//     (I + r R L S)^-1 dw_n,
//
// after which it is where it is nearest, as far as the face answers linearly.
#pragma once

#include "solve/contact.h"

// Of a row of a face that the tool has not passed, at solver->position.
void cau_contact_follow(cau_contact_set *set, const cau_step_solver *solver, int32_t row);
