// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/contact.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"
#include "tool/tool_shape.h"

cau_status cau_contact_create(cau_contact_set *set, const cau_tissue *tissue,
                              const cau_vectors *vectors, cau_arena *arena, cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count, columns = CAU_MAX_COLUMNS;
	set->columns.inverse = cau_arena_array(arena, columns * columns, sizeof(double));
	set->answer = cau_arena_array(arena, (CAU_MAX_POINT_ROWS + 1) * columns, sizeof(double));
	set->step = cau_arena_array(arena, 3 * columns, sizeof(double));
	set->change = cau_arena_array(arena, 3 * columns, sizeof(double));
	set->holds.factor = cau_arena_array(arena, CAU_MAX_HELD * CAU_MAX_HELD, sizeof(double));
	set->before = cau_arena_array(arena, 3 * CAU_MAX_CONTACTS, sizeof(double));
	set->unit = cau_arena_array(arena, 4 * n, vectors->real_bytes);
	set->solution = cau_arena_array(arena, 4 * n, vectors->real_bytes);
	set->active.between = cau_arena_array(arena, CAU_MAX_ACTIVE * CAU_MAX_ACTIVE, sizeof(double));
	bool missing = !set->active.between || !set->columns.inverse || !set->answer || !set->step ||
	               !set->change || !set->holds.factor || !set->before || !set->unit ||
	               !set->solution;
	for (int32_t k = 0; k < CAU_WHOLE_COLUMNS && !missing; k++) {
		set->columns.whole[k] = cau_arena_array(arena, n, vectors->real_bytes);
		missing = !set->columns.whole[k];
	}
	return missing ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for contacts") : CAU_OK;
}

cau_contact_row cau_contact_at_vertex(int32_t vertex, int32_t tool)
{
	CAU_ASSERT(vertex >= 0, "a row of vertex %d", vertex);
	return (cau_contact_row){
		.corner_count = 1, .vertex = {vertex}, .weight = {1}, .free = {true}, .tool = tool};
}

double cau_contact_slack(double start_m, double step_s)
{
	const double release_m_s = 0.1;
	CAU_ASSERT(step_s > 0, "a tick of %g s", step_s);
	return fmax(-start_m - release_m_s * step_s, 0);
}

static bool is_corner(const cau_contact_set *set, int32_t vertex)
{
	for (int32_t i = 0; i < set->columns.corner_count; i++)
		if (set->columns.corner[i] == vertex)
			return true;
	return false;
}

void cau_contact_clear(cau_contact_set *set)
{
	set->row_count = set->columns.corner_count = set->face_count = set->point_count = 0;
}

// ---- sides of faces

static int compare_memory(const void *a, const void *b)
{
	const cau_contact_memory *x = a, *y = b;
	if (x->tool != y->tool)
		return x->tool < y->tool ? -1 : 1;
	return (x->face > y->face) - (x->face < y->face);
}

void cau_contact_touch(cau_contact_set *set, int32_t tool, int32_t face, int32_t above, bool pushed)
{
	CAU_ASSERT_INDEX(tool, set->tool_count);
	CAU_ASSERT(above == 1 || above == -1, "side %d of face %d", above, face);
	if (set->sides.touched_count == CAU_MAX_MEMORY)
		set->left_out_count++;
	else
		set->sides.touched[set->sides.touched_count++] =
			(cau_contact_memory){.tool = tool, .face = face, .pushed = pushed, .above = above};
}

static void keep(cau_contact_set *set, const cau_contact_memory *memory)
{
	if (set->sides.memory_count < CAU_MAX_MEMORY)
		set->sides.memory[set->sides.memory_count++] = *memory;
}

// Remembers the face of a constraint, and the point at which it was pushed.
static void keep_pushed(cau_contact_set *set, const cau_contact_row *row)
{
	cau_contact_memory memory = {
		.tool = row->tool, .face = row->face, .pushed = 1, .above = row->above};
	int32_t at = 0;
	while (at < set->sides.memory_count && compare_memory(&set->sides.memory[at], &memory) != 0)
		at++;
	if (at == set->sides.memory_count)
		keep(set, &memory);
	cau_vec3 reaction = cau_vec3_of(row->reaction);
	if (at == set->sides.memory_count || !(cau_dot(reaction, reaction) > 0))
		return; // the list is full, or the constraint did not push
	cau_contact_memory *kept = &set->sides.memory[at];
	if (kept->point_count < CAU_MAX_POINTS)
		memcpy(kept->point[kept->point_count++], row->weight, sizeof row->weight);
}

void cau_contact_remember(cau_contact_set *set)
{
	set->sides.memory_count = 0;
	if (set->let_through)
		return;
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].corner_count == 3 && !set->row[i].attached)
			keep_pushed(set, &set->row[i]);
	int32_t pushed_count = set->sides.memory_count;
	for (int32_t i = 0; i < set->sides.touched_count; i++) {
		int32_t k = 0;
		while (k < pushed_count &&
		       compare_memory(&set->sides.memory[k], &set->sides.touched[i]) != 0)
			k++;
		if (k == pushed_count)
			keep(set, &set->sides.touched[i]);
	}
	qsort(set->sides.memory, (size_t)set->sides.memory_count, sizeof *set->sides.memory,
	      compare_memory);
	int32_t kept = 0; // keep only one entry of a face that was touched in several rounds
	for (int32_t i = 0; i < set->sides.memory_count; i++)
		if (!kept || compare_memory(&set->sides.memory[kept - 1], &set->sides.memory[i]) != 0)
			set->sides.memory[kept++] = set->sides.memory[i];
	set->sides.memory_count = kept;
}

void cau_contact_forget(cau_contact_set *set, int32_t tool)
{
	int32_t kept = 0;
	for (int32_t i = 0; i < set->sides.memory_count; i++)
		if (set->sides.memory[i].tool != tool)
			set->sides.memory[kept++] = set->sides.memory[i];
	set->sides.memory_count = kept;
}

const cau_contact_memory *cau_contact_recall(const cau_contact_set *set, int32_t tool, int32_t face)
{
	cau_contact_memory key = {.tool = tool, .face = face};
	return bsearch(&key, set->sides.memory, (size_t)set->sides.memory_count, sizeof key,
	               compare_memory);
}

// ---- constraints

bool cau_contact_add(cau_contact_set *set, const cau_contact_row *row)
{
	CAU_ASSERT(set->row_count >= 0 && set->row_count <= CAU_MAX_CONTACTS, "%d rows",
	           set->row_count);
	CAU_ASSERT_INDEX(row->tool, set->tool_count);
	CAU_ASSERT(row->corner_count == 1 || row->corner_count == 3, "a row of %d corners",
	           row->corner_count);
	int32_t added[3], count = 0;
	for (int32_t k = 0; k < row->corner_count; k++)
		if (row->free[k] && !is_corner(set, row->vertex[k]))
			added[count++] = row->vertex[k];
	bool point = row->corner_count > 1;
	if (set->row_count == CAU_MAX_CONTACTS || set->columns.corner_count + count > CAU_MAX_COLUMNS ||
	    (point && set->point_count == CAU_MAX_POINT_ROWS)) {
		set->left_out_count++;
		return false;
	}
	memcpy(set->columns.corner + set->columns.corner_count, added, (size_t)count * sizeof *added);
	set->columns.corner_count += count;
	set->row[set->row_count] = *row;
	set->row[set->row_count++].answer = point ? set->point_count++ : -1;
	set->face_count += row->corner_count == 3 && !row->attached;
	return true;
}

// ---- reactions
// Measures the signed distance and normal of a constraint's point at the present iterate. If the
// tool has passed the point, the distance is minus the way that the point must go to return to its
// own side of the tool.
static void measure_gap(const cau_contact_set *set, const cau_step_solver *solver,
                        cau_contact_row *row)
{
	const cau_contact_tool *tool = &set->tool[row->tool];
	cau_tool_part part = (cau_tool_part)tool->part;
	cau_vec3 normal, side = cau_vec3_of(row->side);
	CAU_ASSERT_INDEX(row->tool, set->tool_count);
	cau_pose pose = cau_coupling_pose(&tool->anchor, cau_vec3_of(tool->offset));
	cau_vec3 point = cau_pose_to_local(&pose, cau_contact_point(row, solver->position));
	row->gap = cau_tool_distance(tool->def, tool->jaw, part, point, &normal);
	if (cau_dot(normal, side) < 0 || (row->corner_count == 3 && row->gap < 0)) {
		cau_vec3 out;
		double way = cau_tool_way_out(tool->def, tool->jaw, part, point, side, row->way_m, &out);
		if (way > 0) {
			normal = cau_dot(out, side) > 0 ? out : side;
			row->gap = -way * cau_dot(normal, side);
		}
	}
	row->gap += row->slack_m;
	cau_vec3_to(cau_rotate(pose.rotation, normal), row->normal);
}

// Limits the length of a vector. If `most` is not a number, `a` is unchanged and the step later
// ends as a fault.
static cau_vec3 clamp_length(cau_vec3 a, double most, bool *clamped)
{
	CAU_ASSERT(!(most < 0), "at most %g N", most);
	double length = cau_length(a);
	*clamped = length > most;
	return *clamped ? cau_scale(most / length, a) : a;
}

// Solves r = -k (x + d - anchor), with d = away + S_ii (r - r_old), for r. S_ii is `s`, r_old is
// `old`.
static cau_vec3 attachment_reaction(const cau_contact_set *set, cau_contact_row *row, cau_vec3 away,
                                    double s, cau_vec3 old)
{
	const cau_tool_def *def = set->tool[row->tool].def;
	double compliance = 1 / def->grasp_stiffness_n_m;
	CAU_ASSERT(compliance > 0, "a compliance of %g m/N", compliance);
	cau_vec3 r = cau_scale(1 / (s + compliance), cau_sub(cau_scale(s, old), away));
	return clamp_length(r, cau_contact_slips_at(set, row), &row->slipping);
}

// The normal part follows from the gap, the tangential part from the slip. The tangential part is
// limited to the friction cone.
static cau_vec3 contact_reaction(const cau_contact_set *set, const cau_contact_row *row,
                                 cau_vec3 step, cau_vec3 slip, double s, cau_vec3 old)
{
	cau_vec3 n = cau_vec3_of(row->normal);
	double normal = cau_dot(old, n) - (row->gap + cau_dot(step, n)) / s;
	if (normal <= 0)
		return (cau_vec3){0, 0, 0};
	normal = fmin(normal, cau_contact_bears(set, row));
	cau_vec3 tangent = cau_add_scaled(old, -cau_dot(old, n), n);
	cau_vec3 along = cau_add_scaled(slip, -cau_dot(slip, n), n);
	bool clamped;
	tangent = clamp_length(cau_add_scaled(tangent, -1 / s, along),
	                       set->tool[row->tool].def->friction * normal, &clamped);
	return cau_add_scaled(tangent, normal, n);
}

// Least change of a reaction in a sweep, relative to the largest reaction, for which Gauss-Seidel
// makes another sweep. Columns in single precision do not resolve smaller changes.
static const double SETTLED = 1e-6;

static cau_vec3 relaxed(const cau_contact_set *set, const cau_step_solver *solver,
                        cau_contact_row *row, double own)
{
	cau_vec3 apart, slip, old = cau_vec3_of(row->reaction);
	if (row->attached)
		return attachment_reaction(
			set, row, cau_sub(cau_contact_place(set, solver, row), cau_vec3_of(row->anchor)), own,
			old);
	cau_contact_motion(set, solver, row, &apart, &slip);
	return contact_reaction(set, row, apart, slip, own, old);
}

// One Gauss-Seidel sweep over the constraints. Returns the largest change relative to the largest
// reaction.
static double relax_rows(cau_contact_set *set, const cau_step_solver *solver)
{
	double change = 0, size = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		cau_contact_row *row = &set->row[i];
		// if no corner can move, the motion is that of the tool alone
		cau_vec3 next = relaxed(set, solver, row, cau_contact_between(set, row, row));
		cau_vec3 by = cau_sub(next, cau_vec3_of(row->reaction));
		double length = cau_length(by);
		size = fmax(size, cau_length(next));
		if (length == 0)
			continue;
		change = fmax(change, length);
		cau_vec3_to(next, row->reaction);
		cau_contact_move(set, row, by);
		cau_coupling_take(&set->tool[row->tool], by);
	}
	return size > 0 ? change / size : 0;
}

// Computes increment += C W^T dr by the columns whose load changed.
typedef struct spread {
	cau_step_solver *solver;
	int32_t count;
	const cau_reals *column[CAU_WHOLE_COLUMNS];
	double load[3 * CAU_WHOLE_COLUMNS];
} spread;

static void spread_part(void *context, int32_t chunk)
{
	const spread *work = context;
	cau_step_solver *solver = work->solver;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	solver->kernels->spread(solver->iterate.increment, work->column, work->load, work->count, first,
	                        last);
}

static void spread_changes(const cau_contact_set *set, cau_step_solver *solver)
{
	spread work;
	work.solver = solver;
	work.count = 0;
	CAU_ASSERT_INDEX(set->columns.count, CAU_WHOLE_COLUMNS + 1);
	for (int32_t c = 0; c < set->columns.count; c++) {
		const double *load = set->change + 3 * (size_t)c;
		if (load[0] == 0 && load[1] == 0 && load[2] == 0)
			continue;
		memcpy(work.load + 3 * work.count, load, 3 * sizeof *load);
		work.column[work.count++] = set->columns.whole[c];
	}
	if (work.count)
		cau_pool_run(solver->pool, solver->chunks.count, spread_part, &work);
}

// Computes increment += C W^T dr by one application of A^-1 to all loads. This is needed if there
// are columns beyond CAU_WHOLE_COLUMNS: only their entries in S exist.
static void substitute_back(cau_contact_set *set, cau_step_solver *solver)
{
	const cau_vectors *vectors = solver->kernels->vectors;
	for (int32_t c = 0; c < set->columns.count; c++)
		vectors->add(set->unit, set->columns.vertex[c], set->change + 3 * (size_t)c);
	cau_solver_apply_inverse(solver, set->unit, set->solution, 1);
	solver->kernels->add_scaled(solver->iterate.increment, 1, set->solution,
	                            4 * (int64_t)solver->tissue->vertex_count);
	for (int32_t c = 0; c < set->columns.count; c++) {
		double load[3]; // the load as it was rounded to reals
		vectors->read(set->unit, set->columns.vertex[c], load);
		vectors->add(set->unit, set->columns.vertex[c], (double[]){-load[0], -load[1], -load[2]});
	}
}

// Sums W^T of the reactions' changes since the last call in set->change, and subtracts them from
// the gradient.
static void take_off_gradient(cau_contact_set *set, cau_step_solver *solver)
{
	memset(set->change, 0, 3 * (size_t)set->columns.count * sizeof *set->change);
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		for (int32_t k = 0; k < row->corner_count; k++) {
			double off[3];
			if (row->column[k] < 0)
				continue;
			for (int c = 0; c < 3; c++) {
				double change = row->weight[k] * (row->reaction[c] - set->before[3 * i + c]);
				set->change[3 * row->column[k] + c] += change;
				off[c] = -change;
			}
			solver->kernels->vectors->add(solver->iterate.gradient, row->vertex[k], off);
		}
		memcpy(set->before + 3 * (size_t)i, row->reaction, sizeof row->reaction);
	}
}

void cau_contact_load(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT_INDEX(set->row_count, CAU_MAX_CONTACTS + 1);
	for (int32_t i = 0; i < set->tool_count; i++)
		memcpy(set->tool[i].measured, set->tool[i].offset, sizeof set->tool[i].measured);
	for (int32_t i = 0; i < set->row_count; i++)
		if (!set->row[i].attached) {
			if (set->row[i].corner_count == 3)
				cau_contact_follow(set, solver, i);
			measure_gap(set, solver, &set->row[i]);
		}
	memset(set->before, 0, 3 * (size_t)set->row_count * sizeof *set->before);
	take_off_gradient(set, solver);
}

static void read_step(cau_contact_set *set, const cau_step_solver *solver)
{
	for (int32_t i = 0; i < set->columns.used_count; i++) {
		int32_t k = set->columns.used[i];
		double step[3];
		solver->kernels->vectors->read(solver->iterate.increment, set->columns.vertex[k], step);
		for (int32_t c = 0; c < 3; c++)
			set->step[c * CAU_MAX_COLUMNS + k] = step[c];
	}
}

// sweeps that find the active constraints, before the active constraints are solved together
enum { PASSES = 4 };

// True if constraints of faces are to be solved together. If some columns are not whole, this would
// cost more than it gains.
static bool is_worth_solving_together(const cau_contact_set *set)
{
	return set->face_count && !cau_contact_is_wide(set);
}

void cau_contact_begin(cau_contact_set *set)
{
	set->pushing = 0;
	set->others = set->elsewhere = false;
}

// Sets `others` if the active constraints changed in this correction, and `elsewhere` if a point
// moved along its face.
static void note_changes(cau_contact_set *set)
{
	// Largest sum of changes of a point's weights (barycentric, in its face) with which the point
	// counts as unmoved.
	const double as_it_was = 0.006;
	uint64_t before = set->pushing;
	set->pushing = CAU_HASH_START;
	set->elsewhere = false;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		if (!(cau_length(cau_vec3_of(row->reaction)) > 0))
			continue;
		set->pushing = cau_hash_word(set->pushing, (uint64_t)i);
		set->elsewhere = set->elsewhere || row->went > as_it_was;
	}
	set->others = before && before != set->pushing;
}

void cau_contact_correct(cau_contact_set *set, cau_step_solver *solver)
{
	CAU_ASSERT_INDEX(set->row_count, CAU_MAX_CONTACTS + 1);
	read_step(set, solver);
	if (cau_coupling_begin(set) && set->holds.count)
		cau_hold_prepare(set);
	bool wide = cau_contact_is_wide(set), together = is_worth_solving_together(set);
	int sweeps = wide ? CAU_CONTACT_FEW_SWEEPS : CAU_CONTACT_SWEEPS;
	for (int sweep = 0; sweep < sweeps; sweep++) {
		cau_hold_solve(set, solver);
		if (relax_rows(set, solver) < SETTLED)
			break;
		if (together && sweep % PASSES == PASSES - 1)
			cau_active_solve(set, solver);
	}
	note_changes(set);
	take_off_gradient(set, solver);
	if (wide)
		substitute_back(set, solver);
	else
		spread_changes(set, solver);
}

bool cau_contact_is_deep(cau_contact_set *set, const cau_step_solver *solver, double most_m,
                         double most_share)
{
	bool any = false;
	for (int32_t i = 0; i < set->row_count; i++) {
		// measures in a copy: set->row keeps the gap from which its reaction was computed
		cau_contact_row row = set->row[i];
		if (row.corner_count == 1 || row.attached)
			continue;
		measure_gap(set, solver, &row);
		double share_m = most_share * set->tool[row.tool].def->hot_radius_m;
		if (row.gap >= -fmax(most_m, share_m))
			continue;
		any = set->tool[row.tool].passing = true;
	}
	return any;
}

double cau_contact_work(const cau_contact_set *set, const cau_step_solver *solver)
{
	double work = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		double way[3][3];
		for (int32_t k = 0; k < row->corner_count; k++)
			solver->kernels->vectors->read(solver->iterate.trial, row->vertex[k], way[k]);
		cau_vec3 along = cau_contact_weighted(row, way[0]);
		work += fabs(row->reaction[0] * along.x) + fabs(row->reaction[1] * along.y) +
		        fabs(row->reaction[2] * along.z);
	}
	return 2 * work;
}
