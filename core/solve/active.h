// SPDX-License-Identifier: GPL-3.0-or-later
// The rows that push, solved together. Points of neighbouring faces hang on the same vertices, so
// that what one row takes off the next puts back: pass by pass Gauss-Seidel converges hopelessly
// slowly there, and tissue under a tool never comes to rest. It does find which rows push and which
// of these slip, and with that known the rest is linear: it is solved by conjugate gradients, over
// the normals of rows that slip and all directions of rows that stick, as far as none begins to
// pull or to slip (Z. Dostal's method of active sets has these two by turns, too).
#pragma once

#include "solve/contact.h"

// Brings the reactions of the rows that push now nearer to their common solution, set->step and the
// tools' offsets with them. Attached rows stay as they are.
void cau_active_solve(cau_contact_set *set, const cau_step_solver *solver);
