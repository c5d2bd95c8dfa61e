// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the columns of A^-1 that contact needs, and keeps them from tick to tick: one column for
// each corner. The first CAU_WHOLE_COLUMNS columns are whole. Further columns have only their
// entries of S.
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"

// Solves for up to three columns at once, with one unit load each in x, y and z. Enters the columns
// in S.
static void make_columns(cau_contact_set *set, cau_step_solver *solver, const int32_t *place,
                         int32_t count)
{
	CAU_ASSERT(count >= 1 && count <= 3, "%d columns at once", count);
	static const double load[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	static const double unload[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
	const cau_vectors *vectors = solver->kernels->vectors;
	for (int32_t c = 0; c < count; c++)
		vectors->add(set->unit, set->columns.vertex[place[c]], load[c]);
	cau_solver_apply_inverse(solver, set->unit, set->solution, 1);
	for (int32_t c = 0; c < count; c++) {
		int32_t p = place[c];
		CAU_ASSERT_INDEX(p, set->columns.count);
		if (p < CAU_WHOLE_COLUMNS)
			vectors->take_coordinate(set->columns.whole[p], set->solution, c,
			                         solver->tissue->vertex_count);
		for (int32_t i = 0; i < set->columns.count; i++) {
			double moved[3];
			vectors->read(set->solution, set->columns.vertex[i], moved);
			double s = moved[c];
			set->columns.inverse[p * CAU_MAX_COLUMNS + i] =
				set->columns.inverse[i * CAU_MAX_COLUMNS + p] = s;
		}
		set->columns.version[p] = solver->age.version;
		vectors->add(set->unit, set->columns.vertex[p], unload[c]);
	}
}

static int32_t find_column(const cau_contact_set *set, int32_t vertex)
{
	for (int32_t k = 0; k < set->columns.count; k++)
		if (set->columns.vertex[k] == vertex)
			return k;
	return -1;
}

// Computes the columns that have moved to an index below CAU_WHOLE_COLUMNS, where columns are
// whole.
static void make_whole(cau_contact_set *set, cau_step_solver *solver, const int32_t *from)
{
	int32_t place[3], waiting = 0;
	for (int32_t k = 0; k < set->columns.count && k < CAU_WHOLE_COLUMNS; k++) {
		if (from[k] >= CAU_WHOLE_COLUMNS)
			place[waiting++] = k;
		if (waiting == 3) {
			make_columns(set, solver, place, waiting);
			waiting = 0;
		}
	}
	if (waiting)
		make_columns(set, solver, place, waiting);
}

static void move_column(cau_contact_set *set, int32_t from, int32_t to)
{
	CAU_ASSERT(to <= from, "column %d to %d", from, to);
	if (from < CAU_WHOLE_COLUMNS) {
		cau_reals *column = set->columns.whole[to];
		set->columns.whole[to] = set->columns.whole[from];
		set->columns.whole[from] = column;
	}
	set->columns.vertex[to] = set->columns.vertex[from];
	set->columns.version[to] = set->columns.version[from];
}

// Keeps only the columns that constraints use, in the same order.
static void drop_unused(cau_contact_set *set, cau_step_solver *solver)
{
	uint8_t used[CAU_MAX_COLUMNS] = {0};
	int32_t kept = 0, from[CAU_MAX_COLUMNS];
	for (int32_t i = 0; i < set->columns.corner_count; i++) {
		int32_t k = find_column(set, set->columns.corner[i]);
		if (k >= 0)
			used[k] = 1;
	}
	for (int32_t k = 0; k < set->columns.count; k++) {
		if (!used[k])
			continue;
		move_column(set, k, kept);
		from[kept++] = k;
	}
	// in place: from[i] >= i, so nothing is overwritten before it is read
	for (int32_t i = 0; i < kept; i++)
		for (int32_t j = 0; j < kept; j++)
			set->columns.inverse[i * CAU_MAX_COLUMNS + j] =
				set->columns.inverse[from[i] * CAU_MAX_COLUMNS + from[j]];
	set->columns.count = kept;
	CAU_ASSERT(kept <= set->columns.corner_count, "%d columns kept for %d corners", kept,
	           set->columns.corner_count);
	make_whole(set, solver, from);
}

static int32_t count_missing(const cau_contact_set *set)
{
	int32_t missing = 0;
	for (int32_t i = 0; i < set->columns.corner_count; i++)
		missing += find_column(set, set->columns.corner[i]) < 0;
	return missing;
}

// Lists the columns with the oldest versions, at most CAU_COLUMNS_RENEWED. Returns their number.
static int32_t find_lagging(const cau_contact_set *set, uint64_t version, int32_t *place)
{
	int32_t count = 0;
	for (int32_t i = 0; i < set->columns.corner_count; i++) {
		int32_t p = find_column(set, set->columns.corner[i]), k = count;
		CAU_ASSERT_INDEX(p, set->columns.count);
		if (set->columns.version[p] == version)
			continue;
		if (count < CAU_COLUMNS_RENEWED)
			count++;
		else if (set->columns.version[place[count - 1]] <= set->columns.version[p])
			continue;
		else
			k = count - 1;
		for (; k > 0 && set->columns.version[place[k - 1]] > set->columns.version[p]; k--)
			place[k] = place[k - 1];
		place[k] = p;
	}
	return count;
}

static void make_missing(cau_contact_set *set, cau_step_solver *solver)
{
	int32_t waiting = 0, place[3];
	for (int32_t i = 0; i < set->columns.corner_count; i++) {
		if (find_column(set, set->columns.corner[i]) >= 0)
			continue;
		CAU_ASSERT_INDEX(set->columns.count, CAU_MAX_COLUMNS);
		set->columns.vertex[set->columns.count] = set->columns.corner[i];
		place[waiting++] = set->columns.count++;
		if (waiting == 3) {
			make_columns(set, solver, place, waiting);
			waiting = 0;
		}
	}
	if (waiting)
		make_columns(set, solver, place, waiting);
}

bool cau_contact_is_wide(const cau_contact_set *set)
{
	return set->columns.corner_count > CAU_WHOLE_COLUMNS;
}

static bool holds_anything(const cau_contact_set *set)
{
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].attached)
			return true;
	return false;
}

// Renews the columns that lag most, three at a time. If tissue is torn and something is grasped,
// renews all columns that lag.
static void renew(cau_contact_set *set, cau_step_solver *solver)
{
	int32_t place[CAU_COLUMNS_RENEWED];
	int32_t rounds = set->torn && holds_anything(set) ? CAU_MAX_COLUMNS / CAU_COLUMNS_RENEWED : 1;
	for (int32_t round = 0; round < rounds; round++) {
		int32_t lagging = find_lagging(set, solver->age.version, place);
		if (!lagging)
			return;
		make_columns(set, solver, place, lagging);
	}
}

// Lists the used columns. Columns are kept longer than constraints need them. If less than half of
// the columns are used, reading only these is faster. Otherwise the list has all columns, because a
// loop over all handles two at a time.
static void find_used(cau_contact_set *set)
{
	bool used[CAU_MAX_COLUMNS] = {0}, few = 2 * set->columns.corner_count < set->columns.count;
	for (int32_t i = 0; i < set->columns.corner_count && few; i++)
		used[find_column(set, set->columns.corner[i])] = true;
	set->columns.used_count = 0;
	for (int32_t k = 0; k < set->columns.count; k++)
		if (used[k] || !few)
			set->columns.used[set->columns.used_count++] = k;
}

// Finds the columns of a constraint's free corners, and the constraint's S W^T. For a fixed vertex
// S W^T is 0.
static void find_columns(cau_contact_set *set, int32_t index)
{
	cau_contact_row *row = &set->row[index];
	for (int32_t k = 0; k < row->corner_count; k++)
		row->column[k] = row->free[k] ? find_column(set, row->vertex[k]) : -1;
	if (row->corner_count == 1)
		row->answer = row->column[0] >= 0 ? -1 : CAU_MAX_POINT_ROWS;
	cau_contact_find_answer(set, index);
}

void cau_contact_prepare(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT(set->row_count > 0 && set->row_count <= CAU_MAX_CONTACTS, "%d rows", set->row_count);
	if (set->columns.epoch != solver->age.epoch)
		set->columns.count = 0;
	set->columns.epoch = solver->age.epoch;
	int32_t most = cau_contact_is_wide(set) ? CAU_MAX_COLUMNS : CAU_WHOLE_COLUMNS;
	if (set->columns.count + count_missing(set) > most)
		drop_unused(set, solver);
	make_missing(set, solver);
	renew(set, solver);
	find_used(set);
	for (int32_t i = 0; i < set->row_count; i++)
		find_columns(set, i);
	cau_hold_prepare(set);
}
