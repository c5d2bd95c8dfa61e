// SPDX-License-Identifier: GPL-3.0-or-later
// Solves the active contact constraints together. Points of neighbouring faces share vertices, so
// each constraint undoes part of its neighbours' correction. So Gauss-Seidel converges far too
// slowly, and tissue under a tool never comes to rest. But Gauss-Seidel finds which constraints are
// active and which of the active constraints slip. Once that is known, the problem is linear and is
// solved by conjugate gradients. The unknowns are the normal part of constraints that slip, and all
// directions of constraints that stick. The reactions move towards the solution only until a
// constraint begins to pull or to slip. (Z. Dostal's active set method also alternates between
// finding the active set and solving.)
#pragma once

#include "solve/contact.h"

// Moves the reactions of the active constraints towards their common solution, and updates
// set->step and the tools' offsets. Attachments keep their reactions.
void cau_active_solve(cau_contact_set *set, const cau_step_solver *solver);
