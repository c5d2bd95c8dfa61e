// SPDX-License-Identifier: GPL-3.0-or-later
// Energy gain of a tick: kinetic, elastic and gravitational energy at its end, less those at its
// start and less the work done on the tissue in it. Implicit Euler loses energy, so a converged
// step has a gain of 0 or less. A positive gain is the error of unfinished iterations.
//
// Work is force times displacement of the point where it acts. It includes gravity, forces of
// commands, reactions of tools, drag in char, and moved supports. Changes after a tick's solve
// (elements that part or shrink) change the elastic energy without work. So the shares of the local
// step that contain such elements are evaluated again at the present positions. The next tick
// starts from that energy. Plastic flow and friction between tissue count as loss. A material law
// without an energy has no gain; nothing is reported. If the solver skipped the evaluation at the
// step's end, the elastic energy there is computed from the objective (eq. 4) less inertia and
// viscosity.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Sums of a chunk: work, kinetic energy before and after, inertia's part of eq. 4.
enum { SUMS = 4 };

cau_status cau_session_make_energy(cau_session *session, cau_error *error)
{
	cau_energy *energy = &session->energy;
	const cau_step_solver *solver = &session->solver;
	energy->dirty = cau_arena_array(&session->memory.arena, (size_t)solver->slots.work_count, 1);
	energy->sum_j = cau_arena_array(&session->memory.arena, SUMS * (size_t)solver->chunks.count,
	                                sizeof(double));
	energy->stale = true;
	if (!energy->dirty || !energy->sum_j)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	return CAU_OK;
}

// ---- shares whose laws have changed

// Returns the share of a slot. The shares of a kind are in the order of their slots.
static int32_t share_of(const cau_element_slots *slots, int kind, int32_t slot)
{
	CAU_ASSERT(slots->work_count > 0, "slot %d of kind %d in no share", slot, kind);
	int32_t least = 0, most = slots->work_count - 1;
	while (least < most && slots->work[least].kind != kind)
		least++;
	while (least < most && slots->work[most].kind != kind)
		most--;
	while (least < most) {
		int32_t middle = least + (most - least) / 2;
		if (slots->work[middle].last <= slot)
			least = middle + 1;
		else
			most = middle;
	}
	CAU_ASSERT(slots->work[least].kind == kind && slots->work[least].first <= slot &&
	               slot < slots->work[least].last,
	           "slot %d of kind %d is not in share %d", slot, kind, least);
	return least;
}

static void mark(cau_session *session, int kind, int32_t element)
{
	const cau_element_slots *slots = &session->solver.slots;
	session->energy.dirty[share_of(slots, kind, slots->slot_of[kind][element])] = 1;
	session->energy.marked = true;
}

void cau_session_mark_changed(cau_session *session)
{
	for (int32_t k = 0; k < session->dissection.removed_count; k++)
		mark(session, session->dissection.removed[k].kind, session->dissection.removed[k].element);
	if (session->shrink.active_count == session->shrink.active_capacity)
		session->energy.stale = true; // an element for which the list was full has shrunk at once
	for (int32_t k = 0; k < session->shrink.active_count; k++)
		mark(session, session->shrink.active[k].kind, session->shrink.active[k].element);
}

// Copies of the rotations that a share's elements keep between evaluations. Reading energies must
// not change them.
enum { MOST_POLARS = 6 };
typedef struct kept_polars {
	int count;
	void *const *array;
	double bytes[MOST_POLARS][CAU_SHARE]; // large enough for either precision
} kept_polars;

static void keep_polars(const cau_elements *elements, const cau_local_work *work, kept_polars *kept)
{
	CAU_ASSERT(work->last - work->first <= CAU_SHARE, "a share of slots %d to %d", work->first,
	           work->last);
	size_t real = cau_real_bytes(elements->single);
	kept->array = work->kind == CAU_ELEMENT_TRIANGLE ? elements->sheet.polar : elements->fat.polar;
	kept->count = work->kind == CAU_ELEMENT_TRIANGLE      ? 6
	              : work->kind == CAU_ELEMENT_TETRAHEDRON ? 4
	                                                      : 0;
	for (int i = 0; i < kept->count; i++)
		memcpy(kept->bytes[i], (const char *)kept->array[i] + (size_t)work->first * real,
		       (size_t)(work->last - work->first) * real);
}

static void return_polars(const cau_elements *elements, const cau_local_work *work,
                          const kept_polars *kept)
{
	CAU_ASSERT(kept->count >= 0 && kept->count <= MOST_POLARS, "%d rotations kept", kept->count);
	size_t real = cau_real_bytes(elements->single);
	for (int i = 0; i < kept->count; i++)
		memcpy((char *)kept->array[i] + (size_t)work->first * real, kept->bytes[i],
		       (size_t)(work->last - work->first) * real);
}

static void share_part(void *context, int32_t index)
{
	cau_session *session = context;
	CAU_ASSERT_INDEX(index, session->solver.slots.work_count);
	const cau_step_solver *solver = &session->solver;
	const cau_local_work *work = &solver->slots.work[index];
	kept_polars kept;
	if (!session->energy.stale && !session->energy.dirty[index])
		return;
	keep_polars(&solver->elements, work, &kept);
	solver->kernels->local(&solver->elements, work, solver->iterate.displacement,
	                       solver->settings.diagonal);
	return_polars(&solver->elements, work, &kept);
}

// Finds the elastic energy of the present positions, under the present material laws.
void cau_session_begin_energy(cau_session *session)
{
	cau_energy *energy = &session->energy;
	cau_step_solver *solver = &session->solver;
	if (!solver->settings.conservative)
		return;
	bool anew = energy->stale || energy->marked;
	if (anew) {
		// After a skipped evaluation no share belongs to the present positions.
		energy->stale |= solver->result.spared;
		cau_solver_displace(solver);
		cau_pool_run(session->pool, solver->slots.work_count, share_part, session);
		memset(energy->dirty, 0, (size_t)solver->slots.work_count);
	}
	energy->elastic_j =
		solver->result.spared && !anew ? energy->end_j : cau_solver_elastic_energy(solver);
	energy->stale = energy->marked = false;
}

// ---- work and motion of a tick, before velocities are updated

// Returns the work done at a moved support: the support's motion against the elements' forces.
static double support_work(const cau_session *session, int32_t vertex, const double move[3])
{
	CAU_ASSERT(session->vertices.fixed[vertex], "vertex %d is no support", vertex);
	const cau_incidence *incidence = &session->solver.slots.incidence;
	const cau_elements *elements = &session->solver.elements;
	double work = 0;
	for (int32_t k = incidence->first[vertex]; k < incidence->first[vertex + 1]; k++)
		for (int c = 0; c < 3; c++)
			work += move[c] * cau_real_get(elements->gradient, elements->single,
			                               4 * (int64_t)incidence->record[k] + c);
	return work;
}

static void vertex_part(void *context, int32_t chunk)
{
	cau_session *session = context;
	CAU_ASSERT_INDEX(chunk, session->solver.chunks.count);
	const cau_step_solver *solver = &session->solver;
	const double *x = session->vertices.position, *start = session->vertices.start;
	const double *velocity = session->vertices.velocity, *force = session->vertices.external;
	const double *push = session->substep.push; // tools' force in the first substep, or NULL
	const double *gravity = session->scene->gravity_m_s2;
	double work = 0, before = 0, after = 0, inertia = 0;
	double scale = cau_session_velocity_scale(session);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > session->tissue.vertex_count)
		last = session->tissue.vertex_count;
	for (int32_t v = first; v < last; v++) {
		double mass = session->tissue.mass[v], move[3], moved2 = 0, old2 = 0, new2 = 0, along = 0;
		for (int c = 0; c < 3; c++) {
			double away = x[3 * v + c] - solver->predicted[3 * v + c];
			inertia += mass * away * away;
			move[c] = x[3 * v + c] - start[3 * v + c];
			old2 += velocity[3 * v + c] * velocity[3 * v + c];
			double way = cau_session_way(session, v, c);
			moved2 += move[c] * move[c];
			new2 += way * way;
			along += (mass * gravity[c] + force[3 * v + c]) * move[c];
			if (push)
				along += push[3 * v + c] * move[c];
		}
		if (solver->fixed[v]) {
			work += moved2 > 0 ? support_work(session, v, move) : 0;
			continue;
		}
		work += along;
		before += mass * old2;
		after += mass * new2;
	}
	double *sum = session->energy.sum_j + SUMS * (size_t)chunk;
	sum[0] = work;
	sum[1] = before / 2;
	sum[2] = after * scale * scale / 2;
	sum[3] = inertia / (2 * solver->inertia_s * solver->inertia_s);
}

static double tool_work(const cau_session *session)
{
	double work = 0;
	for (int32_t k = 0; k < session->contact.row_count; k++) {
		const cau_contact_row *row = &session->contact.row[k];
		cau_vec3 way = cau_sub(cau_contact_point(row, session->vertices.position),
		                       cau_contact_point(row, session->vertices.start));
		work += cau_dot(cau_vec3_of(row->reaction), way);
	}
	for (int32_t k = 0; k < session->solver.forces.drag_count; k++) {
		const cau_drag *drag = &session->solver.forces.drag[k];
		for (size_t c = 0, at = 3 * (size_t)drag->vertex; c < 3; c++)
			work -= drag->coefficient * (session->vertices.position[at + c] - drag->target[c]) *
			        (session->vertices.position[at + c] - session->vertices.start[at + c]);
	}
	return cau_session_last_share(session) * work;
}

static void measure_gain(cau_session *session)
{
	cau_energy *energy = &session->energy;
	cau_pool_run(session->pool, session->solver.chunks.count, vertex_part, session);
	double of_tools_j = tool_work(session), gain_j = -energy->elastic_j - of_tools_j;
	double inertia_j = 0, work_j = 0, kinetic_j = 0, touching_j = 0;
	if (session->solver.collide) {
		touching_j = session->collide.start_energy_j;
		gain_j += session->collide.result.energy_j - touching_j;
	}
	for (int32_t k = 0; k < session->solver.chunks.count; k++) {
		const double *sum = energy->sum_j + SUMS * (size_t)k;
		gain_j += sum[2] - sum[1] - sum[0];
		work_j += sum[0];
		kinetic_j += sum[1];
		inertia_j += sum[3];
	}
	energy->end_j = session->solver.result.spared ? session->solver.result.objective - inertia_j -
	                                                    cau_solver_viscous_energy(&session->solver)
	                                              : cau_solver_elastic_energy(&session->solver);
	energy->gain_j = gain_j + energy->end_j;
	energy->scale_j = energy->elastic_j + kinetic_j + touching_j + fabs(work_j) + fabs(of_tools_j);
}

// Largest energy gain of a tick with two substeps, as a share of the tick's energy. Iterations that
// leave such a tick far from its solution could otherwise feed an oscillation.
static const double most_gain = 1e-4;

// Mixes the tick's mean velocity into the velocities until the gain is 0, if the mean has less
// energy. The share is that of linear interpolation, which suffices because kinetic energy is
// convex.
static void take_gain_off(cau_session *session)
{
	double gain_j = session->energy.gain_j;
	cau_session_take_mean(session, 1); // motion.c
	measure_gain(session);
	double with_mean_j = session->energy.gain_j;
	double share = with_mean_j < gain_j ? fmin(gain_j / (gain_j - with_mean_j), 1) : 0;
	if (share == 1)
		return;
	cau_session_take_mean(session, share);
	measure_gain(session);
}

void cau_session_end_energy(cau_session *session)
{
	cau_energy *energy = &session->energy;
	const cau_substep *substep = &session->substep;
	CAU_ASSERT(!session->solver.settings.conservative || (!energy->stale && !energy->marked),
	           "tick %llu ends with an energy that it did not begin with",
	           (unsigned long long)session->tick);
	energy->gain_j = energy->scale_j = 0;
	if (!session->solver.settings.conservative)
		return;
	measure_gain(session);
	if (substep->count == 2 && !substep->disturbed && energy->gain_j > most_gain * energy->scale_j)
		take_gain_off(session);
}
