// SPDX-License-Identifier: GPL-3.0-or-later
// Solves all attachments together. One by one they converge far too slowly. The reason is that the
// vertices of a light strip of tissue move together. So all entries of S are nearly equal, and are
// many times an attachment's own compliance 1/k.
#pragma once

#include "solve/contact.h"

// Factors S + 1/k over the attachments. Called once a step, after the columns are ready.
void cau_hold_prepare(cau_contact_set *set);

// Sets the attachments' reactions to the solution for set->step, and updates set->step. Does
// nothing if an attachment would slip: Gauss-Seidel then finds which attachments slip.
void cau_hold_solve(cau_contact_set *set, const cau_step_solver *solver);
