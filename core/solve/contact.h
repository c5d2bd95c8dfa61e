// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that touch: unilateral contact with Coulomb friction and grasped
// attachments, inside the solve. Vertices near a tool are rows. With C the rows' columns of A^-1
// and S its block on the rows (a Schur complement: the factor is not touched), each global step d,
// taken with the present reactions r on the right-hand side, is corrected to d + C dr, where r + dr
// solves, by projected Gauss-Seidel,
//
//     contact      r_n >= 0,  gap + n.(d + S dr) >= 0, complementary;  |r_t| <= friction r_n
//     against slip attachment   r = -k (x + d + S dr - anchor), its length at most the slip force
//
// Columns are kept from tick to tick. Because r is on the right-hand side, the fixed point does not
// depend on C: after a cut its columns may lag, and a few are renewed every tick.
#pragma once

#include "base/memory.h"
#include "base/vector.h"
#include "solve/solver.h"
#include "tool/tool_shape.h"

enum {
	CAU_MAX_CONTACTS = 192,
	CAU_CONTACT_SWEEPS = 30,
	CAU_COLUMNS_RENEWED = 3, // of those that lag, each tick
};

// A tool as the contact sees it during one step.
typedef struct cau_contact_tool {
	const cau_tool_def *def;
	cau_pose pose, pose_before; // at the tick's end and start
	double jaw;
	int part; // cau_tool_part that pushes
} cau_contact_tool;

typedef struct cau_contact_row {
	int32_t vertex;
	int32_t tool;
	bool attached;
	bool slipping;      // attachment at its slip force in the last solve
	double normal[3];   // outward from the tool
	double gap;         // m, signed distance at the present iterate
	double no_slip[3];  // m, where the vertex would be if it stuck to the tool
	double anchor[3];   // m, attachment's target
	double reaction[3]; // N, of the tool on the vertex
	int32_t column;     // its place among the kept columns
} cau_contact_row;

struct cau_contact_set {
	int32_t tool_count;
	cau_contact_tool tool[CAU_MAX_TOOLS];
	int32_t row_count;
	cau_contact_row row[CAU_MAX_CONTACTS];
	int32_t left_out_count; // rows that found no place in this step
	// Kept columns of A^-1: part of the session's state, since they lag after cuts.
	int32_t column_count;
	int32_t column_vertex[CAU_MAX_CONTACTS];
	uint64_t column_version[CAU_MAX_CONTACTS]; // of the factor they were made from
	cau_reals *column[CAU_MAX_CONTACTS];       // (vertex_count), m/N
	uint64_t epoch;                            // of the factor: another one empties the columns
	double *inverse;    // (CAU_MAX_CONTACTS x CAU_MAX_CONTACTS): S by columns' places, m/N
	double *step;       // (CAU_MAX_CONTACTS x 3): d before correction, m
	double *before;     // (CAU_MAX_CONTACTS x 3): reactions before correction, N
	int32_t hold_count; // attached rows, solved all at once: hold.h
	int32_t hold_row[CAU_MAX_CONTACTS];
	double *hold; // (CAU_MAX_CONTACTS x CAU_MAX_CONTACTS): factor of S + 1/k over them
	cau_reals *unit, *solution;
};

// `vectors`: of the solver's precision.
cau_status cau_contact_create(cau_contact_set *set, const cau_tissue *tissue,
                              const cau_vectors *vectors, cau_arena *arena, cau_error *error);

// Adds a row; counts it as left out and returns false when the set is full (the caller offers the
// deepest first).
bool cau_contact_add(cau_contact_set *set, const cau_contact_row *row);

// Finds or makes the rows' columns. Called once a step, after the rows are chosen. The step may
// make a new factor afterwards: the columns then lag behind it for the rest of the step, as they do
// after a downdate, and the next step makes them anew.
void cau_contact_prepare(cau_contact_set *set, cau_step_solver *solver);

// Takes the present reactions off solver->gradient, so that the next global step feels them.
void cau_contact_load(cau_contact_set *set, cau_step_solver *solver);

// Corrects solver->increment by new reactions, and takes their change off solver->gradient, so that
// A increment = -gradient still holds (as far as the columns are fresh).
void cau_contact_correct(cau_contact_set *set, cau_step_solver *solver);

// Work that the reactions may do along the trial step, J: what the objective may rise by.
double cau_contact_work(const cau_contact_set *set, const cau_step_solver *solver);
