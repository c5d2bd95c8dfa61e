// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/contact.h"

#include <string.h>

#include "cautery/assert.h"
#include "solve/hold.h"

cau_status cau_contact_create(cau_contact_set *set, const cau_tissue *tissue,
                              const cau_vectors *vectors, cau_arena *arena, cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count;
	set->inverse = cau_arena_array(arena, CAU_MAX_CONTACTS * CAU_MAX_CONTACTS, sizeof(double));
	set->hold = cau_arena_array(arena, CAU_MAX_CONTACTS * CAU_MAX_CONTACTS, sizeof(double));
	set->step = cau_arena_array(arena, 3 * CAU_MAX_CONTACTS, sizeof(double));
	set->before = cau_arena_array(arena, 3 * CAU_MAX_CONTACTS, sizeof(double));
	set->unit = cau_arena_array(arena, 4 * n, vectors->real_bytes);
	set->solution = cau_arena_array(arena, 4 * n, vectors->real_bytes);
	bool missing =
		!set->inverse || !set->hold || !set->step || !set->before || !set->unit || !set->solution;
	for (int32_t k = 0; k < CAU_MAX_CONTACTS && !missing; k++) {
		set->column[k] = cau_arena_array(arena, n, vectors->real_bytes);
		missing = !set->column[k];
	}
	return missing ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for contacts") : CAU_OK;
}

bool cau_contact_add(cau_contact_set *set, const cau_contact_row *row)
{
	CAU_ASSERT(set->row_count >= 0 && set->row_count <= CAU_MAX_CONTACTS, "%d rows",
	           set->row_count);
	CAU_ASSERT_INDEX(row->tool, set->tool_count);
	CAU_ASSERT(row->vertex >= 0, "a row of vertex %d", row->vertex);
	if (set->row_count == CAU_MAX_CONTACTS) {
		set->left_out_count++;
		return false;
	}
	set->row[set->row_count++] = *row;
	return true;
}

// ---- columns of A^-1

// Solves for up to three columns at once, one unit load in each of x, y and z, and enters them in
// S.
static void make_columns(cau_contact_set *set, cau_step_solver *solver, const int32_t *place,
                         int32_t count)
{
	CAU_ASSERT(count >= 1 && count <= 3, "%d columns at once", count);
	static const double load[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	static const double unload[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
	const cau_vectors *vectors = solver->kernels->vectors;
	for (int32_t c = 0; c < count; c++)
		vectors->add(set->unit, set->column_vertex[place[c]], load[c]);
	cau_solver_apply_inverse(solver, set->unit, set->solution, 1);
	for (int32_t c = 0; c < count; c++) {
		int32_t p = place[c];
		CAU_ASSERT_INDEX(p, set->column_count);
		vectors->take_coordinate(set->column[p], set->solution, c, solver->tissue->vertex_count);
		for (int32_t i = 0; i < set->column_count; i++) {
			double s = vectors->at(set->column[p], set->column_vertex[i]);
			set->inverse[p * CAU_MAX_CONTACTS + i] = set->inverse[i * CAU_MAX_CONTACTS + p] = s;
		}
		set->column_version[p] = solver->factor_version;
		vectors->add(set->unit, set->column_vertex[p], unload[c]);
	}
}

static int32_t find_column(const cau_contact_set *set, int32_t vertex)
{
	for (int32_t k = 0; k < set->column_count; k++)
		if (set->column_vertex[k] == vertex)
			return k;
	return -1;
}

// Keeps only the columns that rows use, in their order.
static void drop_unused(cau_contact_set *set)
{
	uint8_t used[CAU_MAX_CONTACTS] = {0};
	int32_t kept = 0, from[CAU_MAX_CONTACTS];
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].column >= 0)
			used[set->row[i].column] = 1;
	for (int32_t k = 0; k < set->column_count; k++) {
		if (!used[k])
			continue;
		cau_reals *column = set->column[kept];
		set->column[kept] = set->column[k];
		set->column[k] = column;
		set->column_vertex[kept] = set->column_vertex[k];
		set->column_version[kept] = set->column_version[k];
		from[kept++] = k;
	}
	for (int32_t i = 0; i < kept; i++) // rows and columns move towards the start only
		for (int32_t j = 0; j < kept; j++)
			set->inverse[i * CAU_MAX_CONTACTS + j] =
				set->inverse[from[i] * CAU_MAX_CONTACTS + from[j]];
	set->column_count = kept;
	CAU_ASSERT(kept <= set->row_count, "%d columns kept for %d rows", kept, set->row_count);
}

static void find_columns(cau_contact_set *set, int32_t *missing)
{
	*missing = false;
	for (int32_t i = 0; i < set->row_count; i++) {
		set->row[i].column = find_column(set, set->row[i].vertex);
		*missing += set->row[i].column < 0;
	}
}

// The columns that lag furthest, by version and place.
static int32_t find_lagging(const cau_contact_set *set, uint64_t version, int32_t *place)
{
	int32_t count = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		int32_t p = set->row[i].column, k = count;
		CAU_ASSERT_INDEX(p, set->column_count);
		if (set->column_version[p] == version)
			continue;
		if (count < CAU_COLUMNS_RENEWED)
			count++;
		else if (set->column_version[place[count - 1]] <= set->column_version[p])
			continue;
		else
			k = count - 1;
		for (; k > 0 && set->column_version[place[k - 1]] > set->column_version[p]; k--)
			place[k] = place[k - 1];
		place[k] = p;
	}
	return count;
}

void cau_contact_prepare(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT(set->row_count > 0 && set->row_count <= CAU_MAX_CONTACTS, "%d rows", set->row_count);
	int32_t missing, place[3];
	if (set->epoch != solver->factor_epoch)
		set->column_count = 0;
	set->epoch = solver->factor_epoch;
	find_columns(set, &missing);
	if (set->column_count + missing > CAU_MAX_CONTACTS) {
		drop_unused(set);
		find_columns(set, &missing);
	}
	int32_t waiting = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		if (set->row[i].column >= 0)
			continue;
		set->row[i].column = find_column(set, set->row[i].vertex);
		if (set->row[i].column < 0) {
			CAU_ASSERT_INDEX(set->column_count, CAU_MAX_CONTACTS);
			set->column_vertex[set->column_count] = set->row[i].vertex;
			set->row[i].column = place[waiting++] = set->column_count++;
		}
		if (waiting == 3) {
			make_columns(set, solver, place, waiting);
			waiting = 0;
		}
	}
	if (waiting)
		make_columns(set, solver, place, waiting);
	int32_t lagging = find_lagging(set, solver->factor_version, place);
	if (lagging)
		make_columns(set, solver, place, lagging);
	cau_hold_prepare(set);
}

// ---- reactions
// Signed distance and normal of a contact row at the present iterate.
static void measure_gap(const cau_contact_set *set, const cau_step_solver *solver,
                        cau_contact_row *row)
{
	if (row->attached)
		return;
	const cau_contact_tool *tool = &set->tool[row->tool];
	CAU_ASSERT_INDEX(row->tool, set->tool_count);
	CAU_ASSERT_INDEX(row->vertex, solver->tissue->vertex_count);
	cau_vec3 normal;
	row->gap =
		cau_tool_distance_at(tool->def, &tool->pose, tool->jaw, (cau_tool_part)tool->part,
	                         cau_vec3_of(solver->position + 3 * (size_t)row->vertex), &normal);
	cau_vec3_to(normal, row->normal);
}

// A bound that is not a number leaves `a` as it is: the step ends as a fault.
static cau_vec3 clamp_length(cau_vec3 a, double most, bool *clamped)
{
	CAU_ASSERT(!(most < 0), "at most %g N", most);
	double length = cau_length(a);
	*clamped = length > most;
	return *clamped ? cau_scale(most / length, a) : a;
}

// r = -k (x + d - anchor) with d = away + S_ii (r - r_old): solved for r.
static cau_vec3 attachment_reaction(const cau_contact_set *set, cau_contact_row *row, cau_vec3 away,
                                    double s, cau_vec3 old)
{
	const cau_tool_def *def = set->tool[row->tool].def;
	double compliance = 1 / def->grasp_stiffness_n_m;
	CAU_ASSERT(compliance > 0, "a compliance of %g m/N", compliance);
	cau_vec3 r = cau_scale(1 / (s + compliance), cau_sub(cau_scale(s, old), away));
	return clamp_length(r, def->slip_force_n, &row->slipping);
}

// Normal part from the gap, tangential part from the slip, clamped to the friction cone.
static cau_vec3 contact_reaction(const cau_contact_set *set, const cau_contact_row *row,
                                 cau_vec3 step, cau_vec3 slip, double s, cau_vec3 old)
{
	cau_vec3 n = cau_vec3_of(row->normal);
	double normal = cau_dot(old, n) - (row->gap + cau_dot(step, n)) / s;
	if (normal <= 0)
		return (cau_vec3){0, 0, 0};
	cau_vec3 tangent = cau_add_scaled(old, -cau_dot(old, n), n);
	cau_vec3 along = cau_add_scaled(slip, -cau_dot(slip, n), n);
	bool clamped;
	tangent = clamp_length(cau_add_scaled(tangent, -1 / s, along),
	                       set->tool[row->tool].def->friction * normal, &clamped);
	return cau_add_scaled(tangent, normal, n);
}

// A pass that changes no reaction by more than this, of the largest, is the last: columns in single
// precision tell no smaller changes apart.
static const double SETTLED = 1e-6;

// One Gauss-Seidel pass over the rows. Returns the largest change relative to the largest reaction.
static double relax_rows(cau_contact_set *set, const cau_step_solver *solver)
{
	double change = 0, size = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		cau_contact_row *row = &set->row[i];
		CAU_ASSERT_INDEX(row->column, set->column_count);
		const double *s = set->inverse + (size_t)row->column * CAU_MAX_CONTACTS;
		cau_vec3 step = cau_vec3_of(set->step + 3 * i), old = cau_vec3_of(row->reaction);
		cau_vec3 x = cau_add(cau_vec3_of(solver->position + 3 * (size_t)row->vertex), step);
		double own = s[row->column];
		cau_vec3 next =
			row->attached
				? attachment_reaction(set, row, cau_sub(x, cau_vec3_of(row->anchor)), own, old)
				: contact_reaction(set, row, step, cau_sub(x, cau_vec3_of(row->no_slip)), own, old);
		cau_vec3 by = cau_sub(next, old);
		double length = cau_length(by);
		size = fmax(size, cau_length(next));
		if (length == 0)
			continue;
		change = fmax(change, length);
		cau_vec3_to(next, row->reaction);
		for (int32_t j = 0; j < set->row_count; j++) {
			double share = s[set->row[j].column];
			set->step[3 * j] += share * by.x;
			set->step[3 * j + 1] += share * by.y;
			set->step[3 * j + 2] += share * by.z;
		}
	}
	return size > 0 ? change / size : 0;
}

// increment += C dr over a chunk of vertices
typedef struct spread {
	const cau_contact_set *set;
	cau_step_solver *solver;
} spread;

static void spread_part(void *context, int32_t chunk)
{
	const spread *work = context;
	const cau_contact_set *set = work->set;
	cau_step_solver *solver = work->solver;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		double dr[3];
		for (int c = 0; c < 3; c++)
			dr[c] = row->reaction[c] - set->before[3 * i + c];
		if (dr[0] != 0 || dr[1] != 0 || dr[2] != 0)
			solver->kernels->spread(solver->increment, set->column[row->column], dr, first, last);
	}
}

static void take_off_gradient(cau_contact_set *set, cau_step_solver *solver)
{
	for (int32_t i = 0; i < set->row_count; i++) {
		double change[3];
		for (int c = 0; c < 3; c++) {
			change[c] = set->before[3 * i + c] - set->row[i].reaction[c];
			set->before[3 * i + c] = set->row[i].reaction[c];
		}
		solver->kernels->vectors->add(solver->gradient, set->row[i].vertex, change);
	}
}

void cau_contact_load(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT_INDEX(set->row_count, CAU_MAX_CONTACTS + 1);
	memset(set->before, 0, 3 * (size_t)set->row_count * sizeof *set->before);
	take_off_gradient(set, solver);
}

void cau_contact_correct(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT_INDEX(set->row_count, CAU_MAX_CONTACTS + 1);
	for (int32_t i = 0; i < set->row_count; i++) {
		cau_contact_row *row = &set->row[i];
		measure_gap(set, solver, row);
		solver->kernels->vectors->read(solver->increment, row->vertex, set->step + 3 * i);
	}
	for (int sweep = 0; sweep < CAU_CONTACT_SWEEPS; sweep++) {
		cau_hold_solve(set, solver);
		if (relax_rows(set, solver) < SETTLED)
			break;
	}
	cau_pool_run(solver->pool, solver->chunk_count, spread_part, &(spread){set, solver});
	take_off_gradient(set, solver);
}

double cau_contact_work(const cau_contact_set *set, const cau_step_solver *solver)
{
	double work = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		double way[3];
		solver->kernels->vectors->read(solver->trial_increment, set->row[i].vertex, way);
		for (int c = 0; c < 3; c++)
			work += fabs(set->row[i].reaction[c] * way[c]);
	}
	return 2 * work;
}
