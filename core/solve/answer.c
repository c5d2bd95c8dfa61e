// SPDX-License-Identifier: GPL-3.0-or-later
// How a load on a contact constraint moves tissue, and how its reaction moves the tool.
#include <math.h>

#include "cautery/assert.h"
#include "solve/contact.h"

// ---- tissue

// Computes S W^T of a contact constraint: how a load on the constraint moves the vertices of the
// kept columns, and the constraint's own point.

// True if the list of used columns has all columns. Reading all columns is faster, because a loop
// over all columns handles two at a time (find_used).
static bool all_are_used(const cau_contact_set *set)
{
	CAU_ASSERT(set->columns.used_count <= set->columns.count, "%d of %d columns are used",
	           set->columns.used_count, set->columns.count);
	return set->columns.used_count == set->columns.count;
}

// answer += weight * s
static void add_weighted(const cau_contact_set *set, double *answer, double weight, const double *s)
{
	if (all_are_used(set))
		for (int32_t c = 0; c < set->columns.count; c++)
			answer[c] += weight * s[c];
	else
		for (int32_t i = 0; i < set->columns.used_count; i++)
			answer[set->columns.used[i]] += weight * s[set->columns.used[i]];
}

void cau_contact_find_answer(cau_contact_set *set, int32_t row)
{
	const cau_contact_row *of = &set->row[row];
	if (of->answer < 0 || of->answer == CAU_MAX_POINT_ROWS)
		return;
	double *answer = set->answer + (size_t)of->answer * CAU_MAX_COLUMNS;
	for (int32_t i = 0; i < set->columns.used_count; i++)
		answer[set->columns.used[i]] = 0;
	for (int32_t k = 0; k < of->corner_count; k++)
		if (of->column[k] >= 0 && of->weight[k] != 0)
			add_weighted(set, answer, of->weight[k],
			             set->columns.inverse + (size_t)of->column[k] * CAU_MAX_COLUMNS);
}

const double *cau_contact_answer(const cau_contact_set *set, const cau_contact_row *row)
{
	if (row->answer < 0)
		return set->columns.inverse + (size_t)row->column[0] * CAU_MAX_COLUMNS;
	return set->answer + (size_t)row->answer * CAU_MAX_COLUMNS;
}

static inline void move_vertex(double *step, int32_t column, double answer, cau_vec3 by)
{
	step[column] += answer * by.x;
	step[CAU_MAX_COLUMNS + column] += answer * by.y;
	step[2 * CAU_MAX_COLUMNS + column] += answer * by.z;
}

void cau_contact_move(cau_contact_set *set, const cau_contact_row *row, cau_vec3 by)
{
	const double *answer = cau_contact_answer(set, row);
	double *step = set->step;
	if (all_are_used(set))
		for (int32_t c = 0; c < set->columns.count; c++)
			move_vertex(step, c, answer[c], by);
	else
		for (int32_t i = 0; i < set->columns.used_count; i++)
			move_vertex(step, set->columns.used[i], answer[set->columns.used[i]], by);
}

double cau_contact_slips_at(const cau_contact_set *set, const cau_contact_row *row)
{
	return fmin(set->tool[row->tool].def->slip_force_n, cau_most_at_a_point_n);
}

double cau_contact_bears(const cau_contact_set *set, const cau_contact_row *row)
{
	const double of_the_tools = 2;
	return of_the_tools * set->tool[row->tool].def->force_max_n;
}

double cau_contact_between(const cau_contact_set *set, const cau_contact_row *row,
                           const cau_contact_row *other)
{
	const double *answer = cau_contact_answer(set, other);
	double sum = row->tool == other->tool ? set->tool[row->tool].compliance : 0;
	for (int32_t k = 0; k < row->corner_count; k++)
		if (row->column[k] >= 0)
			sum += row->weight[k] * answer[row->column[k]];
	return sum;
}

cau_vec3 cau_contact_weighted(const cau_contact_row *row, const double *corner)
{
	cau_vec3 sum = {0, 0, 0};
	for (int32_t k = 0; k < row->corner_count; k++)
		sum = cau_add_scaled(sum, row->weight[k], cau_vec3_of(corner + 3 * (size_t)k));
	return sum;
}

cau_vec3 cau_contact_point(const cau_contact_row *row, const double *x)
{
	cau_vec3 sum = {0, 0, 0};
	for (int32_t k = 0; k < row->corner_count; k++)
		sum = cau_add_scaled(sum, row->weight[k], cau_vec3_of(x + 3 * (size_t)row->vertex[k]));
	return sum;
}

static cau_vec3 step_of(const cau_contact_set *set, const cau_contact_row *row)
{
	cau_vec3 step = {0, 0, 0};
	const double *x = set->step, *y = x + CAU_MAX_COLUMNS, *z = y + CAU_MAX_COLUMNS;
	for (int32_t k = 0; k < row->corner_count; k++) {
		int32_t c = row->column[k];
		if (c >= 0)
			step = cau_add_scaled(step, row->weight[k], (cau_vec3){x[c], y[c], z[c]});
	}
	return step;
}

cau_vec3 cau_contact_place(const cau_contact_set *set, const cau_step_solver *solver,
                           const cau_contact_row *row)
{
	cau_vec3 x = cau_add(cau_contact_point(row, solver->position), step_of(set, row));
	return cau_sub(x, cau_vec3_of(set->tool[row->tool].offset));
}

void cau_contact_motion(const cau_contact_set *set, const cau_step_solver *solver,
                        const cau_contact_row *row, cau_vec3 *apart, cau_vec3 *slip)
{
	const cau_contact_tool *tool = &set->tool[row->tool];
	cau_vec3 given = cau_sub(cau_vec3_of(tool->offset), cau_vec3_of(tool->measured));
	*apart = cau_sub(step_of(set, row), given);
	*slip =
		cau_sub(cau_contact_place(set, solver, row), cau_contact_weighted(row, row->no_slip[0]));
}

// ---- the tool

// The virtual coupling between the commanded and the actual pose of a tool (J. E. Colgate 1995; the
// actual pose is the god-object of C. B. Zilles and J. K. Salisbury 1995).
//
// A spring connects the tool with its commanded position. The tool's offset from this position is
// the sum of the forces of tissue on the tool over the spring's stiffness, and 0 without contact.
// The spring's force grows with its extension up to force_max_n, and is constant from there. So the
// tool pushes with at most force_max_n. If tissue resists more, the tool stops and the commanded
// position moves on.
//
// The energy of the spring is quadratic in the extension up to force_max_n, then linear. Each
// iteration uses a parabola that touches this energy at the tool's present offset and is nowhere
// below it. So the iteration lowers the energy (P. Huber 1981). Within an iteration the tool is a
// further unknown of the contact system, in balance with all its constraints. So the method is
// implicit, whatever the stiffness. The tool's rotation is always the commanded rotation.

cau_pose cau_coupling_pose(const cau_pose *anchor, cau_vec3 offset)
{
	cau_pose pose = *anchor;
	if (cau_dot(offset, offset) != 0) // adding 0 would change a -0 to 0
		cau_vec3_to(cau_add(cau_vec3_of(anchor->position_m), offset), pose.position_m);
	return pose;
}

// Returns |offset| over the spring's force. Beyond cau_coupling_reach_m the force is force_max_n.
static double compliance_of(const cau_contact_tool *tool)
{
	double most = tool->def->force_max_n;
	CAU_ASSERT(most > 0, "a tool that pushes with %g N at most", most);
	return fmax(cau_coupling_reach_m, cau_length(cau_vec3_of(tool->offset))) / most;
}

bool cau_coupling_begin(cau_contact_set *set)
{
	bool changed = false;
	for (int32_t i = 0; i < set->tool_count; i++) {
		cau_contact_tool *tool = &set->tool[i];
		double before = tool->compliance;
		tool->compliance = compliance_of(tool);
		changed = changed || tool->compliance != before;
		cau_vec3_to((cau_vec3){0, 0, 0}, tool->offset);
	}
	for (int32_t i = 0; i < set->row_count; i++)
		cau_coupling_take(&set->tool[set->row[i].tool], cau_vec3_of(set->row[i].reaction));
	return changed;
}

void cau_coupling_take(cau_contact_tool *tool, cau_vec3 by)
{
	cau_vec3_to(cau_add_scaled(cau_vec3_of(tool->offset), -tool->compliance, by), tool->offset);
}
