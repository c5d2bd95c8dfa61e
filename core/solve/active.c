// SPDX-License-Identifier: GPL-3.0-or-later
// Solves the active contact constraints together. Points of neighbouring faces share vertices, so
// each constraint undoes part of its neighbours' correction. So Gauss-Seidel converges far too
// slowly, and tissue under a tool never comes to rest. But Gauss-Seidel finds which constraints are
// active and which of the active constraints slip. Once that is known, the problem is linear and is
// solved by conjugate gradients. The unknowns are the normal part of constraints that slip, and all
// directions of constraints that stick. The reactions move towards the solution only until a
// constraint begins to pull or to slip. (Z. Dostal's active set method also alternates between
// finding the active set and solving.)
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"

enum { MOST_STEPS = 24, MOST_ROUNDS = 2 };
// least squared residual, relative to the first one, for a further step of conjugate gradients
static const double enough = 1e-12;
// Share of the largest friction force up to which a contact constraint sticks. Above it, the
// constraint slips.
static const double on_the_cone = 0.9999;
// share of the old reaction; if the new push is not larger than this, the new reaction is set to 0
static const double lost = 1e-9;
// Bound on all changes of reactions, relative to the largest change that a constraint would have if
// it were solved alone.
static const double most_times = 20;

typedef struct over_rows { // a vector by coordinate, for each active constraint
	double of[3][CAU_MAX_ACTIVE];
} over_rows;

typedef struct active {
	cau_contact_set *set;
	int32_t count;
	over_rows left, along, image, change; // m, N, m, N
	double *between;                      // m/N, (CAU_MAX_ACTIVE x CAU_MAX_ACTIVE)
} active;

static cau_contact_row *row_of(const active *a, int32_t i)
{
	CAU_ASSERT_INDEX(i, a->count);
	return &a->set->row[a->set->active.row[i]];
}

static cau_vec3 get(const over_rows *v, int32_t i)
{
	return (cau_vec3){v->of[0][i], v->of[1][i], v->of[2][i]};
}

static void put(over_rows *v, int32_t i, cau_vec3 value)
{
	v->of[0][i] = value.x;
	v->of[1][i] = value.y;
	v->of[2][i] = value.z;
}

static cau_vec3 tangent_of(const cau_contact_row *row, cau_vec3 v)
{
	cau_vec3 normal = cau_vec3_of(row->normal);
	return cau_add_scaled(v, -cau_dot(v, normal), normal);
}

static double friction_of(const active *a, const cau_contact_row *row)
{
	return a->set->tool[row->tool].def->friction;
}

// ---- choose the active constraints

static bool sticks(const active *a, const cau_contact_row *row, cau_vec3 reaction)
{
	double bears = friction_of(a, row) * cau_dot(reaction, cau_vec3_of(row->normal));
	return cau_length(tangent_of(row, reaction)) < on_the_cone * bears;
}

// Lists the active constraints. Returns false if there are none or more than CAU_MAX_ACTIVE.
static bool choose(active *a)
{
	cau_contact_set *set = a->set;
	a->count = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		cau_vec3 reaction = cau_vec3_of(row->reaction);
		if (row->attached || !(cau_dot(reaction, cau_vec3_of(row->normal)) > 0))
			continue;
		if (a->count == CAU_MAX_ACTIVE)
			return false;
		set->active.sticks[a->count] = sticks(a, row, reaction);
		set->active.row[a->count++] = i;
	}
	return a->count > 0;
}

static void find_between(const active *a)
{
	for (int32_t i = 0; i < a->count; i++)
		for (int32_t j = 0; j <= i; j++)
			a->between[i * CAU_MAX_ACTIVE + j] = a->between[j * CAU_MAX_ACTIVE + i] =
				cau_contact_between(a->set, row_of(a, i), row_of(a, j));
}

// ---- the change of their reactions

// Finds the residual of each active constraint: the way, m, from its point to the target of the
// point.
static void find_left(active *a, const cau_step_solver *solver)
{
	for (int32_t i = 0; i < a->count; i++) {
		const cau_contact_row *row = row_of(a, i);
		cau_vec3 apart, slip, normal = cau_vec3_of(row->normal);
		cau_contact_motion(a->set, solver, row, &apart, &slip);
		cau_vec3 off = cau_scale(row->gap + cau_dot(apart, normal), normal);
		if (a->set->active.sticks[i])
			off = cau_add(off, tangent_of(row, slip));
		put(&a->left, i, cau_scale(-1, off));
	}
}

// Keeps only the normal part of `v` for constraints that slip.
static void keep_free(const active *a, over_rows *v)
{
	for (int32_t i = 0; i < a->count; i++) {
		cau_vec3 normal = cau_vec3_of(row_of(a, i)->normal);
		if (!a->set->active.sticks[i])
			put(v, i, cau_scale(cau_dot(get(v, i), normal), normal));
	}
}

static void apply(active *a)
{
	for (int c = 0; c < 3; c++) {
		double *image = a->image.of[c];
		memset(image, 0, (size_t)a->count * sizeof *image);
		for (int32_t j = 0; j < a->count; j++) {
			const double *between = a->between + (size_t)j * CAU_MAX_ACTIVE;
			double along = a->along.of[c][j];
			for (int32_t i = 0; i < a->count; i++)
				image[i] += between[i] * along;
		}
	}
	keep_free(a, &a->image);
}

static double dot(const active *a, const over_rows *x, const over_rows *y)
{
	double sum = 0;
	for (int c = 0; c < 3; c++)
		for (int32_t i = 0; i < a->count; i++)
			sum += x->of[c][i] * y->of[c][i];
	return sum;
}

static void add_scaled(const active *a, over_rows *to, double scale, const over_rows *by)
{
	for (int c = 0; c < 3; c++)
		for (int32_t i = 0; i < a->count; i++)
			to->of[c][i] += scale * by->of[c][i];
}

static void find_change(active *a)
{
	double size = dot(a, &a->left, &a->left), first = size;
	a->along = a->left;
	memset(&a->change, 0, sizeof a->change);
	for (int step = 0; step < MOST_STEPS && size > enough * first; step++) {
		apply(a);
		double stiff = dot(a, &a->along, &a->image);
		if (!(stiff > 0)) // columns that lag behind the factor can make `stiff` negative
			return;
		add_scaled(a, &a->change, size / stiff, &a->along);
		add_scaled(a, &a->left, -size / stiff, &a->image);
		double next = dot(a, &a->left, &a->left), part = next / size;
		for (int c = 0; c < 3; c++)
			for (int32_t i = 0; i < a->count; i++)
				a->along.of[c][i] = a->left.of[c][i] + part * a->along.of[c][i];
		size = next;
	}
}

// ---- the allowed share of the change

// Returns the smallest t in (0, 1) at which a + 2 b t + c t^2 is 0, with a > 0. Returns 1 if there
// is no such t.
static double first_root(double a, double b, double c)
{
	double inner = b * b - a * c;
	if (!(inner >= 0) || (b >= 0 && c >= 0))
		return 1;
	double root = a / (sqrt(inner) - b); // the smaller positive root
	return root > 0 && root < 1 ? root : 1;
}

// Returns the share of a constraint's change that the constraint can take. With a larger share the
// constraint would pull, exceed its largest push or, if it sticks, slip.
static double part_of_row(const active *a, int32_t i)
{
	const cau_contact_row *row = row_of(a, i);
	cau_vec3 normal = cau_vec3_of(row->normal), now = cau_vec3_of(row->reaction);
	cau_vec3 change = get(&a->change, i);
	double push = cau_dot(now, normal), more = cau_dot(change, normal);
	double part = more < -push ? -push / more : 1, room = cau_contact_bears(a->set, row) - push;
	part = more > room ? fmax(room, 0) / more : part;
	if (!a->set->active.sticks[i])
		return part;
	double bears = friction_of(a, row) * friction_of(a, row);
	cau_vec3 along = tangent_of(row, now), by = tangent_of(row, change);
	return fmin(part, first_root(bears * push * push - cau_dot(along, along),
	                             bears * push * more - cau_dot(along, by),
	                             bears * more * more - cau_dot(by, by)));
}

// Returns the largest change of a reaction, N, if each constraint were solved alone.
static double largest_alone(const active *a)
{
	double most = 0;
	for (int32_t i = 0; i < a->count; i++) {
		double own = a->between[(size_t)i * CAU_MAX_ACTIVE + (size_t)i];
		most = fmax(most, cau_length(get(&a->left, i)) / own);
	}
	return most;
}

// Returns the share of the change that all constraints can take. No reaction may change by more
// than most_n. The reason is that constraints of tissue that is caught between the sides of a tool
// push against each other. They have no solution, and their reactions would grow without bound.
static double part_of_all(const active *a, double most_n, bool *stopped)
{
	double largest = 0, part = 1;
	for (int32_t i = 0; i < a->count; i++) {
		part = fmin(part, part_of_row(a, i));
		largest = fmax(largest, cau_length(get(&a->change, i)));
	}
	*stopped = part < 1;
	return largest > most_n ? fmin(part, most_n / largest) : part;
}

static void take(const active *a, double part)
{
	for (int32_t i = 0; i < a->count; i++) {
		cau_contact_row *row = row_of(a, i);
		cau_vec3 by = cau_scale(part, get(&a->change, i)), old = cau_vec3_of(row->reaction);
		cau_vec3 next = cau_add(old, by);
		if (!(cau_dot(next, cau_vec3_of(row->normal)) > lost * cau_length(old))) {
			next = (cau_vec3){0, 0, 0};
			by = cau_scale(-1, old);
		}
		cau_vec3_to(next, row->reaction);
		cau_contact_move(a->set, row, by);
		cau_coupling_take(&a->set->tool[row->tool], by);
	}
}

void cau_active_solve(cau_contact_set *set, const cau_step_solver *solver)
{
	active a = {.set = set, .between = set->active.between};
	bool stopped = true;
	CAU_ASSERT(set->columns.count > 0, "%d columns", set->columns.count);
	for (int round = 0; round < MOST_ROUNDS && stopped && choose(&a); round++) {
		find_between(&a);
		find_left(&a, solver);
		double most_n = most_times * largest_alone(&a);
		find_change(&a);
		take(&a, part_of_all(&a, most_n, &stopped));
	}
}
