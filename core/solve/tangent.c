// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/tangent.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"

// Longest motion of a vertex, m, in the two positions between which forces are compared. It is far
// above the rounding of single precision, and so short that curvature does not matter to a tool.
static const double way_m = 2e-5;

static bool make_vectors(cau_tangent *tangent, const cau_step_solver *solver)
{
	cau_arena *arena = &tangent->arena;
	cau_step_solver *probe = &tangent->probe;
	cau_elements *elements = &probe->elements;
	size_t n = (size_t)solver->tissue->vertex_count, real = solver->kernels->vectors->real_bytes;
	tangent->position = cau_arena_array(arena, 3 * n, sizeof(double));
	tangent->load = cau_arena_array(arena, 4 * n, real);
	tangent->base = cau_arena_array(arena, 4 * n, real);
	probe->iterate.displacement = cau_arena_array(arena, 4 * n, real);
	probe->iterate.gradient = cau_arena_array(arena, 4 * n, real);
	probe->chunks.energy = cau_arena_array(arena, (size_t)solver->chunks.count, sizeof(double));
	elements->gradient = cau_arena_array(arena, 4 * (size_t)elements->record_count, real);
	elements->energy =
		cau_arena_array(arena, (size_t)solver->slots.work_count, sizeof *elements->energy);
	elements->slack =
		cau_arena_array(arena, (size_t)solver->slots.work_count, sizeof *elements->slack);
	bool made = tangent->position && tangent->load && tangent->base &&
	            probe->iterate.displacement && probe->iterate.gradient && probe->chunks.energy &&
	            elements->gradient && elements->energy && elements->slack;
	for (int i = 0; i < CAU_TANGENT_MOTIONS; i++) {
		tangent->motion[i] = cau_arena_array(arena, 4 * n, real);
		tangent->change[i] = cau_arena_array(arena, 4 * n, real);
		made = made && tangent->motion[i] && tangent->change[i];
	}
	for (int i = 0; i < 6; i++) {
		elements->sheet.polar[i] = cau_arena_array(arena, (size_t)elements->sheet.slot_count, real);
		made = made && elements->sheet.polar[i];
	}
	for (int i = 0; i < 4; i++) {
		elements->fat.polar[i] = cau_arena_array(arena, (size_t)elements->fat.slot_count, real);
		made = made && elements->fat.polar[i];
	}
	return made;
}

cau_status cau_tangent_create(cau_tangent *tangent, const cau_step_solver *solver, cau_error *error)
{
	memset(tangent, 0, sizeof *tangent);
	tangent->probe = *solver;
	if (make_vectors(tangent, solver))
		return CAU_OK;
	cau_tangent_finish(tangent);
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the contact of tools");
}

void cau_tangent_finish(cau_tangent *tangent)
{
	cau_arena_finish(&tangent->arena);
}

// Copies the solver's present state to the probe, except for the probe's own vectors. A restore or
// new pins may have changed the solver since the last call.
static void borrow(cau_tangent *tangent, const cau_step_solver *solver)
{
	cau_step_solver own = tangent->probe, *probe = &tangent->probe;
	*probe = *solver;
	// with the predicted state at the position, inertia is 0
	probe->position = probe->predicted = tangent->position;
	probe->iterate.displacement = own.iterate.displacement;
	probe->iterate.gradient = own.iterate.gradient;
	probe->chunks.energy = own.chunks.energy;
	probe->forces.drag_count = 0;
	probe->collide = NULL;
	probe->contact = NULL;
	probe->now_s = NULL;
	probe->elements.rate_per_s = 0; // without viscosity, because a hand is slow
	probe->elements.gradient = own.elements.gradient;
	probe->elements.energy = own.elements.energy;
	probe->elements.slack = own.elements.slack;
	memcpy(probe->elements.sheet.polar, own.elements.sheet.polar,
	       sizeof probe->elements.sheet.polar);
	memcpy(probe->elements.fat.polar, own.elements.fat.polar, sizeof probe->elements.fat.polar);
}

void cau_tangent_begin(cau_tangent *tangent, cau_step_solver *solver)
{
	borrow(tangent, solver);
	const cau_elements *from = &solver->elements;
	cau_elements *to = &tangent->probe.elements;
	size_t real = cau_real_bytes(from->single), n = (size_t)solver->tissue->vertex_count;
	for (int i = 0; i < 6 && from->sheet.slot_count; i++)
		memcpy(to->sheet.polar[i], from->sheet.polar[i], (size_t)from->sheet.slot_count * real);
	for (int i = 0; i < 4 && from->fat.slot_count; i++)
		memcpy(to->fat.polar[i], from->fat.polar[i], (size_t)from->fat.slot_count * real);
	memcpy(tangent->position, solver->position, 3 * n * sizeof(double));
	cau_solver_evaluate(&tangent->probe);
	// later evaluations write to the other gradient vector
	cau_reals *made = tangent->probe.iterate.gradient;
	tangent->probe.iterate.gradient = tangent->base;
	tangent->base = made;
}

static int64_t reals_of(const cau_tangent *tangent)
{
	return 4 * (int64_t)tangent->probe.tissue->vertex_count;
}

static double dot(const cau_tangent *tangent, const cau_reals *a, const cau_reals *b)
{
	return tangent->probe.kernels->dot(a, b, 0, reals_of(tangent));
}

static void clear(const cau_tangent *tangent, cau_reals *vector)
{
	memset(vector, 0, (size_t)reals_of(tangent) * tangent->probe.kernels->vectors->real_bytes);
}

static void add_load(cau_tangent *tangent, const cau_tangent_load *load, int32_t count,
                     const double along[3])
{
	for (int32_t i = 0; i < count; i++)
		tangent->probe.kernels->vectors->add(tangent->load, load[i].vertex,
		                                     (double[]){load[i].share * along[0],
		                                                load[i].share * along[1],
		                                                load[i].share * along[2]});
}

// Returns the motion, m, of the load's point of application.
static void place_of(const cau_tangent *tangent, const cau_reals *motion,
                     const cau_tangent_load *load, int32_t count, double place[3])
{
	memset(place, 0, 3 * sizeof *place);
	for (int32_t i = 0; i < count; i++) {
		double moved[3];
		tangent->probe.kernels->vectors->read(motion, load[i].vertex, moved);
		for (int c = 0; c < 3; c++)
			place[c] += load[i].share * moved[c];
	}
}

// Computes change = H motion. First scales `motion` so that its longest vertex motion is 1.
static bool find_change(cau_tangent *tangent, cau_reals *motion, cau_reals *change)
{
	cau_step_solver *probe = &tangent->probe;
	const cau_kernels *kernels = probe->kernels;
	int32_t n = probe->tissue->vertex_count;
	double longest = kernels->vectors->longest(motion, n);
	if (!(longest > 0 && isfinite(longest)))
		return false;
	kernels->add_scaled(motion, 1 / longest - 1, motion, reals_of(tangent));
	for (int sign = 1; sign >= -1; sign -= 2) { // move, evaluate, and move back
		for (int32_t v = 0; v < n; v++) {
			double moved[3];
			kernels->vectors->read(motion, v, moved);
			for (int c = 0; c < 3; c++)
				tangent->position[3 * (size_t)v + (size_t)c] += sign * way_m * moved[c];
		}
		if (sign == 1)
			cau_solver_evaluate(probe);
	}
	memcpy(change, probe->iterate.gradient,
	       (size_t)reals_of(tangent) * kernels->vectors->real_bytes);
	kernels->add_scaled(change, -1, tangent->base, reals_of(tangent));
	kernels->add_scaled(change, 1 / way_m - 1, change, reals_of(tangent));
	return true;
}

// The space of the motions found so far.
typedef struct space {
	int count;
	double energy[CAU_TANGENT_MOTIONS][CAU_TANGENT_MOTIONS]; // v_i . H v_j of the motions v, J
	double place[CAU_TANGENT_MOTIONS][3]; // motion of the load's point of application, m
	// Cholesky factor of `energy`, lower triangle
	double factor[CAU_TANGENT_MOTIONS][CAU_TANGENT_MOTIONS];
} space;

// Adds the motion at index `count` to the space. Returns false if the energy is not positive
// definite with it.
static bool extend(cau_tangent *tangent, space *s, const cau_tangent_load *load, int32_t count)
{
	int k = s->count;
	if (!find_change(tangent, tangent->motion[k], tangent->change[k]))
		return false;
	place_of(tangent, tangent->motion[k], load, count, s->place[k]);
	for (int i = 0; i <= k; i++) {
		double energy = dot(tangent, tangent->motion[i], tangent->change[k]);
		if (i < k) // keep one of two equal entries: H is symmetric except for rounding
			energy = (energy + dot(tangent, tangent->motion[k], tangent->change[i])) / 2;
		s->energy[i][k] = s->energy[k][i] = energy;
	}
	for (int i = 0; i <= k; i++) {
		double sum = s->energy[k][i];
		for (int j = 0; j < i; j++)
			sum -= s->factor[k][j] * s->factor[i][j];
		// the motion has no new direction, or the tissue has no stiffness
		if (i == k && !(sum > 1e-6 * s->energy[k][k]))
			return false;
		s->factor[k][i] = i == k ? sqrt(sum) : sum / s->factor[i][i];
	}
	s->count++;
	return true;
}

// Computes x = E^-1 x in place, where E is the matrix `energy`.
static void solve(const space *s, double x[CAU_TANGENT_MOTIONS])
{
	for (int i = 0; i < s->count; i++) {
		for (int j = 0; j < i; j++)
			x[i] -= s->factor[i][j] * x[j];
		x[i] /= s->factor[i][i];
	}
	for (int i = s->count - 1; i >= 0; i--) {
		for (int j = i + 1; j < s->count; j++)
			x[i] -= s->factor[j][i] * x[j];
		x[i] /= s->factor[i][i];
	}
}

// Finds the motion in the space by which tissue responds to a load along `along`, in shares of the
// space's motions.
static void answer_in(const space *s, const double along[3], double share[CAU_TANGENT_MOTIONS])
{
	for (int i = 0; i < s->count; i++)
		share[i] =
			s->place[i][0] * along[0] + s->place[i][1] * along[1] + s->place[i][2] * along[2];
	solve(s, share);
}

// Starts the space with s = A^-1 p along each axis; A is the same for all axes. Returns p . s.
static double begin_space(cau_tangent *tangent, const cau_tangent_load *load, int32_t count,
                          double *mass_kg)
{
	cau_step_solver *probe = &tangent->probe;
	const cau_vectors *vectors = probe->kernels->vectors;
	double place[3];
	clear(tangent, tangent->load);
	add_load(tangent, load, count, (double[]){1, 0, 0});
	cau_solver_apply_inverse(probe, tangent->load, tangent->motion[0], 1);
	place_of(tangent, tangent->motion[0], load, count, place);
	clear(tangent, tangent->motion[1]);
	clear(tangent, tangent->motion[2]);
	*mass_kg = 0;
	for (int32_t v = 0; v < probe->tissue->vertex_count; v++) {
		double moved[3], share;
		vectors->read(tangent->motion[0], v, moved);
		share = moved[0] / place[0];
		*mass_kg += probe->tissue->mass[v] * share * share;
		vectors->add(tangent->motion[1], v, (double[]){0, moved[0], 0});
		vectors->add(tangent->motion[2], v, (double[]){0, 0, moved[0]});
	}
	return place[0];
}

// Adds the next motion of conjugate gradients: A^-1 of the residual of the load in the space.
static void add_motion(cau_tangent *tangent, const space *s, const cau_tangent_load *load,
                       int32_t count, const double along[3])
{
	double share[CAU_TANGENT_MOTIONS];
	answer_in(s, along, share);
	clear(tangent, tangent->load);
	add_load(tangent, load, count, along);
	for (int i = 0; i < s->count; i++)
		tangent->probe.kernels->add_scaled(tangent->load, -share[i], tangent->change[i],
		                                   reals_of(tangent));
	cau_solver_apply_inverse(&tangent->probe, tangent->load, tangent->motion[s->count], 1);
}

cau_tangent_answer cau_tangent_find(cau_tangent *tangent, const cau_tangent_load *load,
                                    int32_t count, const double direction[3])
{
	cau_tangent_answer answer = {0};
	space s = {0};
	double c = begin_space(tangent, load, count, &answer.mass_kg);
	if (!(c > 0))
		return (cau_tangent_answer){0};
	answer.of_matrix = answer.compliance[0] = answer.compliance[1] = answer.compliance[2] = c;
	for (int axis = 0; axis < CAU_TANGENT_AXES; axis++)
		if (!extend(tangent, &s, load, count))
			return answer;
	while (s.count < CAU_TANGENT_MOTIONS) {
		add_motion(tangent, &s, load, count, direction);
		if (!extend(tangent, &s, load, count))
			break;
	}
	static const int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
	for (int axis = 0; axis < 3; axis++) {
		double along[3] = {axis == 0, axis == 1, axis == 2}, share[CAU_TANGENT_MOTIONS];
		answer_in(&s, along, share);
		for (int other = 0; other <= axis; other++) {
			answer.compliance[at[axis][other]] = 0;
			for (int i = 0; i < s.count; i++)
				answer.compliance[at[axis][other]] += share[i] * s.place[i][other];
		}
	}
	return answer;
}
