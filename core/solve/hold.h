// SPDX-License-Identifier: GPL-3.0-or-later
// Attachments solved all at once. Row by row they converge hopelessly slowly: the vertices of a
// light strip move together, so that S is nearly the same number everywhere, many times an
// attachment's own compliance.
#pragma once

#include "solve/contact.h"

// Factors S + 1/k over the attached rows. Called once a step, after the columns are there.
void cau_hold_prepare(cau_contact_set *set);

// Gives the attachments the reactions that fit set->step, and brings the step along; does nothing
// when one would slip, since only row by row can that be told.
void cau_hold_solve(cau_contact_set *set, const cau_step_solver *solver);
