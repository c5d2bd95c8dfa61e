// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between tools and tissue inside the solve: unilateral contact with Coulomb friction, and
// grasped attachments. A contact constraint is a point of tissue at a tool: a vertex, or a point of
// a face. The point is W x, where x are its corners and the weights W >= 0 have the sum 1. C are
// the corners' columns of A^-1. S is the block of C on the corners; it is a Schur complement, so
// the factor is not changed. W^T are the constraints' loads on the corners. Each global step d is
// computed with the present reactions r on the right-hand side. It is then corrected to d + C W^T
// dr, where projected Gauss-Seidel solves for r + dr:
//
//     contact      r_n >= 0,  gap + n.W (d + S W^T dr) >= 0, complementary;  |r_t| <= friction r_n
//     against slip attachment   r = -k (x + d + S dr - anchor), its length at most the slip force
//
// The tool itself is an unknown of the same correction. A spring connects it with the commanded
// pose (answer.c). So S gains the compliance of this spring between all constraints of one tool.
//
// A constraint stores its side of the tool. A face that the tool has passed within the tick is
// pushed back to its own side.
//
// Beyond the first CAU_WHOLE_COLUMNS columns, only their entries in S are kept (G. Saupin, C.
// Duriez, S. Cotin and L. Grisoni 2008). If there are such columns, C W^T dr is computed by one
// further back-substitution of the constraints' loads. This costs less than reading so many
// columns.
//
// Columns are kept from tick to tick. Because r is on the right-hand side, the fixed point does not
// depend on C. So after a cut the columns may lag behind the factor, and only a few are renewed
// every tick.
#pragma once

#include "base/memory.h"
#include "base/vector.h"
#include "solve/solver.h"
#include "tool/tool_shape.h"

enum {
	CAU_MAX_CONTACTS = 1024, // contact constraints of all tools
	// most constraints, of CAU_MAX_CONTACTS, at vertices that are held or near; the rest is for
	// faces
	CAU_MAX_VERTEX_ROWS = 768,
	CAU_NEAR_ROWS = 192, // most constraints, of CAU_MAX_VERTEX_ROWS, at vertices that are only near
	CAU_MAX_POINT_ROWS = 256, // constraints at points of faces
	CAU_MAX_COLUMNS = 960,    // distinct free vertices of contact constraints
	CAU_WHOLE_COLUMNS = 288,  // columns that are kept whole
	CAU_MAX_MEMORY = 2048,    // faces whose side of the tool is remembered
	// most remembered points of one face: two arms of a tool may touch a face
	CAU_MAX_POINTS = 2,
	CAU_MAX_HELD = 192,  // attachments that are solved together
	CAU_MAX_ACTIVE = 96, // active constraints that are solved together
	CAU_CONTACT_SWEEPS = 30,
	// sweeps if some columns are not whole; with eight sweeps the force was 2 % too small
	CAU_CONTACT_FEW_SWEEPS = 16,
	CAU_COLUMNS_RENEWED = 3, // lagging columns that are renewed each tick
};

// A tool's state in contact during one step.
typedef struct cau_contact_tool {
	const cau_tool_def *def;
	cau_pose anchor; // commanded pose at the tick's end
	double jaw;
	int part;           // the cau_tool_part that pushes
	double offset[3];   // m, from the commanded to the actual position: answer.c
	double measured[3]; // m, value of offset[] when the gaps were measured
	double compliance;  // m/N, of the virtual coupling
	bool passing;       // the tool would pass tissue that no contact constraint holds
	bool held_back;     // contact held the tool back in this tick
} cau_contact_tool;

typedef struct cau_contact_row {
	int32_t corner_count; // 1: a vertex; 3: a point of a face
	int32_t face, above;  // face of the point, and its side at the tool, as in cau_contact_memory
	int32_t vertex[3];    // vertices of the point's corners
	double weight[3];     // shares of the corners in the point, sum 1
	double went;          // sum of the changes of weight[] in this iteration (follow.c)
	bool free[3];         // whether each corner can move
	int32_t column[3];    // index of each free corner's kept column; -1 for a fixed corner
	int32_t answer;       // index of S W^T in cau_contact_set.answer; -1: the row of S of column[0]
	int32_t tool;
	bool attached;
	bool slipping; // the attachment was at its slip force in the last solve
	// unit vector in the tool's frame, towards the tissue's side; 0: the point may leave in any
	// direction
	double side[3];
	double way_m;     // largest distance that the point may have to move along side[]
	double slack_m;   // penetration that is allowed in this tick
	double normal[3]; // unit normal, outward from the tool
	double gap;       // m, signed distance at the present iterate, plus slack_m
	// m, positions that the corners would have if they stuck to the tool at its anchor
	double no_slip[3][3];
	double anchor[3];   // m, target of an attachment if the tool were at its anchor
	double reaction[3]; // N, force of the tool on the point
} cau_contact_row;

// A face that a tool pushed or penetrated at the end of a step.
typedef struct cau_contact_memory {
	int32_t tool, face;
	int32_t pushed; // 1: the face had a contact constraint, or the next step begins with one
	int32_t above;  // 1: the tool is on the side to which the face's normal points; -1: below
	// Weights of the points at which the tool pushed. Snapshots have them since version 6.
	int32_t point_count, unused;
	double point[CAU_MAX_POINTS][3];
} cau_contact_memory;

// Kept columns of A^-1. They are part of the session's state, because they lag behind the factor
// after cuts.
typedef struct cau_contact_columns {
	int32_t count;
	int32_t vertex[CAU_MAX_COLUMNS];
	uint64_t version[CAU_MAX_COLUMNS];   // version of the factor from which each column was made
	cau_reals *whole[CAU_WHOLE_COLUMNS]; // (vertex_count): whole columns of A^-1, m/N
	// Indices of the columns that constraints use, ascending. If more than half of all columns are
	// used, the list has all columns. Only the listed columns of answer[] and step[] are up to
	// date.
	int32_t used_count;
	int32_t used[CAU_MAX_COLUMNS];
	uint64_t epoch;       // epoch of the factor; the columns are discarded when it changes
	int32_t corner_count; // distinct free vertices of the constraints
	int32_t corner[CAU_MAX_COLUMNS];
	double *inverse; // (CAU_MAX_COLUMNS x CAU_MAX_COLUMNS): S by column index, m/N
} cau_contact_columns;

// The constraints at the start of the step.
typedef struct cau_contact_begun {
	int32_t count; // number of constraints
	double reaction[CAU_MAX_CONTACTS][3];
	double offset[CAU_MAX_TOOLS][3]; // m: offsets of the tools
} cau_contact_begun;

// Faces whose side of a tool is known.
typedef struct cau_contact_sides {
	int32_t memory_count; // faces of the last step, sorted by tool and face: part of the session's
	                      // state
	cau_contact_memory memory[CAU_MAX_MEMORY];
	int32_t touched_count; // faces that the present step has found so far
	cau_contact_memory touched[CAU_MAX_MEMORY];
} cau_contact_sides;

// Attachments, all solved together (hold.c).
typedef struct cau_contact_holds {
	int32_t count;
	int32_t row[CAU_MAX_HELD];
	double *factor; // (CAU_MAX_HELD x CAU_MAX_HELD): factor of S + 1/k over the attachments
} cau_contact_holds;

// Active constraints, solved together (active.c).
typedef struct cau_contact_active {
	int32_t row[CAU_MAX_ACTIVE];
	bool sticks[CAU_MAX_ACTIVE];
	double *between; // (CAU_MAX_ACTIVE x CAU_MAX_ACTIVE)
} cau_contact_active;

struct cau_contact_set {
	int32_t tool_count;
	cau_contact_tool tool[CAU_MAX_TOOLS];
	int32_t row_count;
	cau_contact_row row[CAU_MAX_CONTACTS];
	int32_t face_count;  // contact constraints at faces
	int32_t point_count; // constraints with several corners, attachments included
	// Tissue has been torn, so all columns are renewed. Jaws may hold tissue that hangs by little.
	// Columns that still contain removed elements would move such tissue too far.
	bool torn;
	bool let_through;       // tools passed tissue that no constraint could hold: no side is
	                        // remembered
	uint64_t pushing;       // hash of the active constraints after the last correction
	bool others;            // the active constraints changed in the last correction
	bool elsewhere;         // an active constraint's point moved along its face in the last
	                        // correction
	bool crossing;          // the solve ended with a face beyond a tool, not only deep in it
	int32_t left_out_count; // constraints of this step for which the capacity was too small
	cau_contact_begun begun;
	cau_contact_sides sides;
	cau_contact_columns columns;
	double *answer; // (CAU_MAX_POINT_ROWS + 1 x CAU_MAX_COLUMNS): S W^T, m/N; the last row is 0
	double *step;   // (3 x CAU_MAX_COLUMNS): d at the columns' vertices, m
	double *change; // (CAU_MAX_COLUMNS x 3): change of the load on the columns' vertices, N
	double *before; // (CAU_MAX_CONTACTS x 3): reactions before correction, N
	cau_reals *unit, *solution;
	cau_contact_holds holds;
	cau_contact_active active;
};

// Allocates the arrays in `arena`. `vectors` has the solver's precision. CAU_NO_MEMORY.
cau_status cau_contact_create(cau_contact_set *set, const cau_tissue *tissue,
                              const cau_vectors *vectors, cau_arena *arena, cau_error *error);

// Returns a contact constraint of a free vertex. The caller sets side and gap data.
cau_contact_row cau_contact_at_vertex(int32_t vertex, int32_t tool);

// Removes all contact constraints.
void cau_contact_clear(cau_contact_set *set);

// Notes that a face is inside or beyond a tool. `above` is the face's side on which the tool
// belongs, as in cau_contact_memory. If `pushed`, the next step begins with a constraint for the
// face. Beyond CAU_MAX_MEMORY faces, the face is only counted in left_out_count.
void cau_contact_touch(cau_contact_set *set, int32_t tool, int32_t face, int32_t above,
                       bool pushed);

// Called at the end of a step. Stores the faces that were pushed or touched, so that the next step
// knows on which side of the tool they are.
void cau_contact_remember(cau_contact_set *set);

// Forgets the sides of all faces at a tool.
void cau_contact_forget(cau_contact_set *set, int32_t tool);

// Returns the memory of a face at a tool; NULL if there is none.
const cau_contact_memory *cau_contact_recall(const cau_contact_set *set, int32_t tool,
                                             int32_t face);

// Returns how deep (m) a point may stay inside a tool in this tick. `start_m` is its signed
// distance from the tool at the start of the tick. Tissue in which a tool starts is pushed out at a
// bounded speed.
double cau_contact_slack(double start_m, double step_s);

// Returns the weighted sum of values of the corners (corner_count x 3): the value at the
// constraint's point.
cau_vec3 cau_contact_weighted(const cau_contact_row *row, const double *corner);

// Returns the constraint's point for vertex positions x (m, vertex_count x 3).
cau_vec3 cau_contact_point(const cau_contact_row *row, const double *x);

// Adds a constraint. If the capacity is too small for the constraint or its corners' columns,
// counts the constraint in left_out_count and returns false. The caller therefore adds the deepest
// constraints first.
bool cau_contact_add(cau_contact_set *set, const cau_contact_row *row);

// Finds or computes the columns of the constraints. Called once a step, after the constraints are
// chosen. If the step makes a new factor afterwards, the columns lag behind it for the rest of the
// step, as after a downdate. The next step computes them again.
void cau_contact_prepare(cau_contact_set *set, cau_step_solver *solver);

// Computes S W^T of a constraint after its weights have changed.
void cau_contact_find_answer(cau_contact_set *set, int32_t row);

// Returns S W^T of a constraint (column_count, only used columns are valid): the motion of each
// column's vertex by a load of 1 N on the constraint, m/N.
const double *cau_contact_answer(const cau_contact_set *set, const cau_contact_row *row);

// Adds the motion by a load (N) on the constraint to set->step.
void cau_contact_move(cau_contact_set *set, const cau_contact_row *row, cau_vec3 by);

// Largest force, N, on one grasped point of tissue. Over a cell of 2 mm it is 12 MPa, at which
// fascia breaks. Jaws that never slip would otherwise load torn or crushed tissue with hundreds of
// newtons, in steps that are far from their solution. The tissue would move back and forth
// violently until it is torn to pieces.
static const double cau_most_at_a_point_n = 50;

// Returns the force (N) at which a grasped point slips.
double cau_contact_slips_at(const cau_contact_set *set, const cau_contact_row *row);

// Returns the largest push (N) of one constraint. Tools push with less. But constraints of tissue
// that is caught between the sides of a tool push against each other, and their reactions would
// grow without bound.
double cau_contact_bears(const cau_contact_set *set, const cau_contact_row *row);

// Returns the motion (m) of `row`'s point, relative to the tool, by a force of 1 N on the point of
// `other`.
double cau_contact_between(const cau_contact_set *set, const cau_contact_row *row,
                           const cau_contact_row *other);

// Returns the constraint's point (m) after the present step, relative to the tool's commanded
// position.
cau_vec3 cau_contact_place(const cau_contact_set *set, const cau_step_solver *solver,
                           const cau_contact_row *row);

// Finds the motion (m) of the constraint's point relative to the tool, after the present step:
// `apart` from the position at which its gap was measured, `slip` from the position in which it
// would stick to the tool.
void cau_contact_motion(const cau_contact_set *set, const cau_step_solver *solver,
                        const cau_contact_row *row, cau_vec3 *apart, cau_vec3 *slip);

// True if constraints have more corners than CAU_WHOLE_COLUMNS, so that some columns are kept only
// in S.
bool cau_contact_is_wide(const cau_contact_set *set);

// Called before a descent's first correction: the correction then reports no change of the active
// constraints.
void cau_contact_begin(cau_contact_set *set);

// Measures the gaps of all constraints. Subtracts the present reactions from solver->gradient, so
// that the next global step includes them.
void cau_contact_load(cau_contact_set *set, cau_step_solver *solver);

// Corrects solver->increment by new reactions. Subtracts the change of the reactions from
// solver->gradient, so that A increment = -gradient still holds (except for lagging columns).
void cau_contact_correct(cau_contact_set *set, cau_step_solver *solver);

// True if a constraint of a face penetrates its tool too deeply at solver->position. The limit is
// `most_m` or `most_share` of the tip's radius, whichever is larger. Marks these tools as passing.
bool cau_contact_is_deep(cau_contact_set *set, const cau_step_solver *solver, double most_m,
                         double most_share);

// Returns a bound for the work (J) of the reactions along the trial step. The objective may rise by
// this amount.
double cau_contact_work(const cau_contact_set *set, const cau_step_solver *solver);

// ---- answer.c: the virtual coupling of a tool

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

// ---- hold.c

// Factors S + 1/k over the attachments. Called once a step, after the columns are ready.
void cau_hold_prepare(cau_contact_set *set);

// Sets the attachments' reactions to the solution for set->step, and updates set->step. Does
// nothing if an attachment would slip: Gauss-Seidel then finds which attachments slip.
void cau_hold_solve(cau_contact_set *set, const cau_step_solver *solver);

// ---- active.c

// Moves the reactions of the active constraints towards their common solution, and updates
// set->step and the tools' offsets. Attachments keep their reactions.
void cau_active_solve(cau_contact_set *set, const cau_step_solver *solver);

// ---- follow.c

// Moves the point of constraint `row`, at solver->position. The tool must not have passed its face;
// otherwise the point stays.
void cau_contact_follow(cau_contact_set *set, const cau_step_solver *solver, int32_t row);
