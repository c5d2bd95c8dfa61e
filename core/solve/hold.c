// SPDX-License-Identifier: GPL-3.0-or-later
// Solves all attachments together. One by one they converge far too slowly. The reason is that the
// vertices of a light strip of tissue move together. So all entries of S are nearly equal, and are
// many times an attachment's own compliance 1/k.
#include "cautery/assert.h"
#include "solve/contact.h"

static const cau_tool_def *tool_of(const cau_contact_set *set, const cau_contact_row *row)
{
	CAU_ASSERT_INDEX(row->tool, set->tool_count);
	return set->tool[row->tool].def;
}

// Computes the lower triangle, by rows, over holds.row. Returns false if the matrix is not positive
// definite.
static bool factor(cau_contact_set *set)
{
	for (int32_t i = 0; i < set->holds.count; i++) {
		double *at = set->holds.factor + (size_t)i * CAU_MAX_HELD;
		for (int32_t j = 0; j <= i; j++) {
			const double *other = set->holds.factor + (size_t)j * CAU_MAX_HELD;
			double sum = cau_contact_between(set, &set->row[set->holds.row[i]],
			                                 &set->row[set->holds.row[j]]);
			if (i == j)
				sum += 1 / tool_of(set, &set->row[set->holds.row[i]])->grasp_stiffness_n_m;
			for (int32_t k = 0; k < j; k++)
				sum -= at[k] * other[k];
			if (i == j && !(sum > 0))
				return false;
			at[j] = i == j ? sqrt(sum) : sum / other[j];
		}
	}
	return true;
}

void cau_hold_prepare(cau_contact_set *set)
{
	set->holds.count = 0;
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].attached && set->holds.count < CAU_MAX_HELD)
			set->holds.row[set->holds.count++] = i;
	if (!factor(set))
		// lagging columns can make the matrix indefinite; cau_hold_solve then does nothing
		set->holds.count = 0;
}

// Solves with the factor for one coordinate of the attachments. `x` (holds.count) is the right-hand
// side on entry and the solution on return.
static void substitute(const cau_contact_set *set, double *x)
{
	int32_t n = set->holds.count;
	for (int32_t i = 0; i < n; i++) {
		const double *at = set->holds.factor + (size_t)i * CAU_MAX_HELD;
		for (int32_t k = 0; k < i; k++)
			x[i] -= at[k] * x[k];
		x[i] /= at[i];
	}
	for (int32_t i = n - 1; i >= 0; i--) {
		x[i] /= set->holds.factor[(size_t)i * CAU_MAX_HELD + (size_t)i];
		for (int32_t k = 0; k < i; k++)
			x[k] -= set->holds.factor[(size_t)i * CAU_MAX_HELD + (size_t)k] * x[i];
	}
}

// Finds the change dr of each reaction: (S + 1/k) dr = anchor + offset - x - step - r / k. S
// includes the springs that couple the tools to their commanded poses.
static void changes(const cau_contact_set *set, const cau_step_solver *solver,
                    double dr[3][CAU_MAX_HELD])
{
	for (int32_t i = 0; i < set->holds.count; i++) {
		int32_t at = set->holds.row[i];
		const cau_contact_row *row = &set->row[at];
		CAU_ASSERT(row->attached, "row %d is solved as held and is not", at);
		double compliance = 1 / tool_of(set, row)->grasp_stiffness_n_m, step[3] = {0};
		double point[3] = {0};
		const double *offset = set->tool[row->tool].offset;
		for (int32_t k = 0; k < row->corner_count; k++)
			for (int c = 0; c < 3; c++) {
				size_t at_corner = 3 * (size_t)row->vertex[k] + (size_t)c;
				point[c] += row->weight[k] * solver->position[at_corner];
				if (row->column[k] >= 0)
					step[c] += row->weight[k] * set->step[c * CAU_MAX_COLUMNS + row->column[k]];
			}
		for (int c = 0; c < 3; c++)
			dr[c][i] =
				row->anchor[c] + offset[c] - point[c] - step[c] - compliance * row->reaction[c];
	}
	for (int c = 0; c < 3; c++)
		substitute(set, dr[c]);
}

static bool would_slip(const cau_contact_set *set, double dr[3][CAU_MAX_HELD])
{
	for (int32_t i = 0; i < set->holds.count; i++) {
		const cau_contact_row *row = &set->row[set->holds.row[i]];
		cau_vec3 by = {dr[0][i], dr[1][i], dr[2][i]};
		if (row->slipping ||
		    cau_length(cau_add(cau_vec3_of(row->reaction), by)) > cau_contact_slips_at(set, row))
			return true;
	}
	return false;
}

void cau_hold_solve(cau_contact_set *set, const cau_step_solver *solver)
{
	CAU_ASSERT_INDEX(set->holds.count, set->row_count + 1);
	double dr[3][CAU_MAX_HELD];
	if (!set->holds.count)
		return;
	changes(set, solver, dr);
	if (would_slip(set, dr))
		return;
	for (int32_t i = 0; i < set->holds.count; i++)
		for (int c = 0; c < 3; c++)
			set->row[set->holds.row[i]].reaction[c] += dr[c][i];
	for (int32_t i = 0; i < set->holds.count; i++) {
		const cau_contact_row *row = &set->row[set->holds.row[i]];
		cau_vec3 by = {dr[0][i], dr[1][i], dr[2][i]};
		cau_contact_move(set, row, by);
		cau_coupling_take(&set->tool[row->tool], by);
	}
}
