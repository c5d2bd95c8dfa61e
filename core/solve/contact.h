// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that touch: unilateral contact with Coulomb friction and grasped
// attachments, inside the solve. Points of tissue at a tool are rows: a vertex, or a point of a
// face, W x of its corners x with weights W >= 0 of sum 1. With C the corners' columns of A^-1, S
// its block on the corners (a Schur complement: the factor is not touched) and W^T the rows' loads
// on them, each global step d, taken with the present reactions r on the right-hand side, is
// corrected to d + C W^T dr, where r + dr solves, by projected Gauss-Seidel,
//
//     contact      r_n >= 0,  gap + n.W (d + S W^T dr) >= 0, complementary;  |r_t| <= friction r_n
//     against slip attachment   r = -k (x + d + S dr - anchor), its length at most the slip force
//
// The tool itself is an unknown of the same correction: it hangs on the pose that is asked by a
// spring (coupling.h), so S gains that spring's compliance between all rows of one tool.
//
// A row knows on which side of the tool it belongs: a face that the tool has passed within the tick
// is pushed back to where it was, not on.
//
// Of the columns beyond the first CAU_WHOLE_COLUMNS only what S has of them is kept (G. Saupin,
// C. Duriez, S. Cotin and L. Grisoni 2008): where there are such, C W^T dr is one further
// back-substitution of the rows' loads instead, which costs less than reading that many columns.
//
// Columns are kept from tick to tick. Because r is on the right-hand side, the fixed point does not
// depend on C: after a cut its columns may lag, and a few are renewed every tick.
#pragma once

#include "base/memory.h"
#include "base/vector.h"
#include "solve/solver.h"
#include "tool/tool_shape.h"

enum {
	CAU_MAX_CONTACTS = 1024,   // rows
	CAU_MAX_VERTEX_ROWS = 768, // of them of vertices, held or near: the rest is for faces
	CAU_NEAR_ROWS = 192,       // of these where some only are near
	CAU_MAX_POINT_ROWS = 256,  // of points of faces
	CAU_MAX_COLUMNS = 960,     // vertices that are corners of rows
	CAU_WHOLE_COLUMNS = 288,   // of them with the whole of their column
	CAU_MAX_MEMORY = 2048,     // faces whose side is kept
	CAU_MAX_POINTS = 2,        // of a face that are kept: a tool may touch it with two of its arms
	CAU_MAX_HELD = 192,        // rows of attachments that are solved at once
	CAU_MAX_ACTIVE = 96,       // rows that push and are solved together
	CAU_CONTACT_SWEEPS = 30,
	CAU_CONTACT_FEW_SWEEPS = 16, // where columns are not whole: eight take the force 2 % off
	CAU_COLUMNS_RENEWED = 3,     // of those that lag, each tick
};

// A tool as the contact sees it during one step.
typedef struct cau_contact_tool {
	const cau_tool_def *def;
	cau_pose anchor; // where it is asked to be at the tick's end
	double jaw;
	int part;           // cau_tool_part that pushes
	double offset[3];   // m, of where it is from where it is asked to be: coupling.h
	double measured[3]; // m, the offset at which the rows' gaps were measured
	double compliance;  // m/N, of the coupling
	bool passing;       // it would pass tissue that the rows do not hold
	bool held_back;     // and did in this tick
} cau_contact_tool;

typedef struct cau_contact_row {
	int32_t corner_count; // 1: a vertex; 3: a point of a face
	int32_t face, above;  // as in cau_contact_memory
	int32_t vertex[3];    // its corners
	double weight[3];     // their shares in the point
	double went;          // by how much these changed in this iteration, summed: follow.h
	bool free[3];         // whether they can move
	int32_t column[3];    // the free ones' places among the kept columns; else -1
	int32_t answer;       // place of its S W^T; -1: it is its column's row of S
	int32_t tool;
	bool attached;
	bool slipping;        // attachment at its slip force in the last solve
	double side[3];       // unit, in the tool's frame: where the tissue belongs; 0: wherever it is
	double way_m;         // how far the point may have to go that way at most
	double slack_m;       // how deep it may stay inside in this tick
	double normal[3];     // outward from the tool
	double gap;           // m, signed distance at the present iterate, and slack_m
	double no_slip[3][3]; // m, where its corners would be if they stuck to the tool at its anchor
	double anchor[3];     // m, attachment's target, likewise
	double reaction[3];   // N, of the tool on the point
} cau_contact_row;

// A face that a tool pushed, or that was inside it, at the end of a step.
typedef struct cau_contact_memory {
	int32_t tool, face;
	int32_t pushed; // whether it was a row, or is to be one
	int32_t above;  // 1: the tool is on the side to which the face's normal points; -1: below
	// since snapshots of version 6: weights of the points at which the tool pushed
	int32_t point_count, unused;
	double point[CAU_MAX_POINTS][3];
} cau_contact_memory;

struct cau_contact_set {
	int32_t tool_count;
	cau_contact_tool tool[CAU_MAX_TOOLS];
	int32_t row_count;
	cau_contact_row row[CAU_MAX_CONTACTS];
	int32_t face_count;  // rows of faces
	int32_t point_count; // rows of several corners, attached ones too
	// Tissue has been torn: what hangs in jaws may hang by little, and columns that lag behind by
	// what went would throw it about. So all are fresh.
	bool torn;
	bool let_through;    // tools passed what could not be held: no side is remembered
	uint64_t pushing;    // which rows push after the last correction
	bool others;         // others than after the one before it
	bool elsewhere;      // or at points that have gone on since
	bool crossing;       // what the solve ended with would be beyond a tool, not only deep in it
	int32_t begun_count; // rows that the step began with, and their reactions before more came
	double begun_reaction[CAU_MAX_CONTACTS][3];
	double begun_offset[CAU_MAX_TOOLS][3]; // m
	int32_t left_out_count;                // of the step: points that touch and found no place
	int32_t memory_count; // of the last step, by tool and face: part of the session's state
	cau_contact_memory memory[CAU_MAX_MEMORY];
	int32_t touched_count; // what the present step has found of it
	cau_contact_memory touched[CAU_MAX_MEMORY];
	// Kept columns of A^-1: part of the session's state, since they lag after cuts.
	int32_t column_count;
	int32_t column_vertex[CAU_MAX_COLUMNS];
	uint64_t column_version[CAU_MAX_COLUMNS]; // of the factor they were made from
	cau_reals *column[CAU_WHOLE_COLUMNS];     // (vertex_count), m/N
	// Those that rows have, ascending, where these are few; else all: answers and steps are of
	// them.
	int32_t used_count;
	int32_t used[CAU_MAX_COLUMNS];
	uint64_t epoch;       // of the factor: another one empties the columns
	int32_t corner_count; // distinct vertices of the rows that are free
	int32_t corner[CAU_MAX_COLUMNS];
	double *inverse;    // (CAU_MAX_COLUMNS x CAU_MAX_COLUMNS): S by columns' places, m/N
	double *answer;     // (CAU_MAX_POINT_ROWS + 1 x CAU_MAX_COLUMNS): S W^T, m/N; the last is 0
	double *step;       // (3 x CAU_MAX_COLUMNS): d at the columns' vertices, m
	double *change;     // (CAU_MAX_COLUMNS x 3): of the load on them, N
	double *before;     // (CAU_MAX_CONTACTS x 3): reactions before correction, N
	int32_t hold_count; // attached rows, solved all at once: hold.h
	int32_t hold_row[CAU_MAX_HELD];
	double *hold; // (CAU_MAX_HELD x CAU_MAX_HELD): factor of S + 1/k over them
	cau_reals *unit, *solution;
	// Rows that push, solved together: active.h.
	int32_t active_row[CAU_MAX_ACTIVE];
	bool active_sticks[CAU_MAX_ACTIVE];
	double *active; // (CAU_MAX_ACTIVE x CAU_MAX_ACTIVE)
};

// `vectors`: of the solver's precision.
cau_status cau_contact_create(cau_contact_set *set, const cau_tissue *tissue,
                              const cau_vectors *vectors, cau_arena *arena, cau_error *error);

// The row of a free vertex, and nothing else about it.
cau_contact_row cau_contact_at_vertex(int32_t vertex, int32_t tool);

// Forgets all rows.
void cau_contact_clear(cau_contact_set *set);

// Notes that a face is inside or beyond a tool, on which of its sides the tool belongs (`above` as
// in cau_contact_memory), and whether the next step is to begin with a row for it. Past
// CAU_MAX_MEMORY faces nothing is kept.
void cau_contact_touch(cau_contact_set *set, int32_t tool, int32_t face, int32_t above,
                       bool pushed);

// Keeps, at a step's end, the faces that were pushed or touched: the next step knows their sides.
void cau_contact_remember(cau_contact_set *set);

// Forgets the sides of a tool.
void cau_contact_forget(cau_contact_set *set, int32_t tool);

// What was kept of a face; NULL: nothing.
const cau_contact_memory *cau_contact_recall(const cau_contact_set *set, int32_t tool,
                                             int32_t face);

// How deep (m) a point that was at `start_m` from the tool as the tick began may stay inside: what
// a tool begins to push from within is let out at a bounded speed.
double cau_contact_slack(double start_m, double step_s);

// Of values by corner, (corner_count x 3): at the row's point.
cau_vec3 cau_contact_weighted(const cau_contact_row *row, const double *corner);

// Where a row's point is at positions x (m, vertex_count x 3).
cau_vec3 cau_contact_point(const cau_contact_row *row, const double *x);

// Adds a row; counts it as left out and returns false when there is no room for it or for the
// columns of its corners (the caller offers the deepest first).
bool cau_contact_add(cau_contact_set *set, const cau_contact_row *row);

// Finds or makes the rows' columns. Called once a step, after the rows are chosen. The step may
// make a new factor afterwards: the columns then lag behind it for the rest of the step, as they do
// after a downdate, and the next step makes them anew.
void cau_contact_prepare(cau_contact_set *set, cau_step_solver *solver);

// S W^T of a row, after its weights changed.
void cau_contact_find_answer(cau_contact_set *set, int32_t row);

// The same, to read (column_count, of the used ones): what a load on the row moves, m/N.
const double *cau_contact_answer(const cau_contact_set *set, const cau_contact_row *row);

// A load (N) on the row more: where the columns' vertices go by it.
void cau_contact_move(cau_contact_set *set, const cau_contact_row *row, cau_vec3 by);

// No point of tissue that is held bears more, N: over a cell of 2 mm it would be 12 MPa, at which
// fascia breaks. What jaws that never slip hold of torn or crushed tissue would bear hundreds, in
// steps that are far from their solution, and be thrown about until nothing is left of it.
static const double cau_most_at_a_point_n = 50;

// At what force (N) a held point slips.
double cau_contact_slips_at(const cau_contact_set *set, const cau_contact_row *row);

// What a row pushes with at most, N. A tool has less; but of tissue that is caught between its
// sides rows push against each other, and would without end.
double cau_contact_bears(const cau_contact_set *set, const cau_contact_row *row);

// How far (m) a force of 1 N on the point of one row moves that of the other, seen from the tool.
double cau_contact_between(const cau_contact_set *set, const cau_contact_row *row,
                           const cau_contact_row *other);

// Where (m) the step as it is takes a row's point, as seen from where its tool is asked to be.
cau_vec3 cau_contact_place(const cau_contact_set *set, const cau_step_solver *solver,
                           const cau_contact_row *row);

// How far (m) that is, seen from the tool, from where its gap was measured (`apart`) and from where
// it would be if it stuck (`slip`).
void cau_contact_motion(const cau_contact_set *set, const cau_step_solver *solver,
                        const cau_contact_row *row, cau_vec3 *apart, cau_vec3 *slip);

// Whether rows have columns of which the set has S alone.
bool cau_contact_is_wide(const cau_contact_set *set);

// Before a descent's first correction: it changes nothing.
void cau_contact_begin(cau_contact_set *set);

// Measures the rows' gaps, and takes the present reactions off solver->gradient, so that the next
// global step feels them.
void cau_contact_load(cau_contact_set *set, cau_step_solver *solver);

// Corrects solver->increment by new reactions, and takes their change off solver->gradient, so that
// A increment = -gradient still holds (as far as the columns are fresh).
void cau_contact_correct(cau_contact_set *set, cau_step_solver *solver);

// Whether a row of a face is deeper inside its tool at solver->position than it may be, in m or as
// a share of the tip's radius, whichever is more: such tools are passing.
bool cau_contact_is_deep(cau_contact_set *set, const cau_step_solver *solver, double most_m,
                         double most_share);

// Work that the reactions may do along the trial step, J: what the objective may rise by.
double cau_contact_work(const cau_contact_set *set, const cau_step_solver *solver);
