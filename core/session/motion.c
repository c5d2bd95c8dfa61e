// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the vertices in a tick: its substeps, the prediction before each solve, and the
// velocities after it.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- substeps

// The substeps of a tick. Implicit Euler has one. The integrator `sdirk2` has two, each a solve of
// eq. 4 with the same h = gamma dt and the same A (R. Alexander 1977, SIAM J. Numer. Anal. 14):
//
//     first   x1 = s1 + h^2 M^-1 f(x1),  s1 = x + h v
//             v1 = (x1 - x) / h,  a1 = (v1 - v) / h
//     second  x2 = s2 + h^2 M^-1 f(x2),  s2 = x + q v1 + h (v + q a1),  q = (1 - gamma) dt
//             v2 = (x2 - x - q v1) / h
//
// The first substep is an implicit Euler step to gamma dt. So nothing is explicit, and no force at
// the tick's start is needed. After a cut, no force of a removed element remains. TR-BDF2 has the
// same stability function, but needs such a force (core/EXPERIMENTS.md).
//
// Tools and moved supports make their motion in two parts. The second substep begins where the
// first substep ended. The tools' reported forces are those of the second substep, to which their
// poses belong.
//
// A method of second order makes an impact rebound: a stop within the first substep is continued as
// a force. A mass that came at 1 m/s leaves at 1.4 m/s. So tissue pushed by a tool may not leave
// faster than the tool moves: v + q a1 and v2 lose the part of the velocity that would separate
// tissue and tool. With friction, v2 along the tool is the mean of the substep. If a substep was
// shortened, v2 is the mean velocity of the tick, as with implicit Euler. If the tick gained
// energy, v2 is mixed with that mean (energy.c).

static bool has_two(const cau_session *session)
{
	return session->scene->integrator == CAU_INTEGRATOR_SDIRK2;
}

cau_status cau_session_make_substeps(cau_session *session, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count;
	cau_substep *substep = &session->substep;
	substep->count = has_two(session) ? 2 : 1;
	if (has_two(session)) {
		substep->tick_start = cau_arena_array(&session->memory.arena, 3 * n, sizeof(double));
		substep->base = cau_arena_array(&session->memory.arena, 3 * n, sizeof(double));
		substep->push = cau_arena_array(&session->memory.arena, 3 * n, sizeof(double));
		if (!substep->tick_start || !substep->base || !substep->push)
			return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	}
	cau_session_begin_substeps(session);
	return CAU_OK;
}

void cau_session_begin_substeps(cau_session *session)
{
	cau_substep *substep = &session->substep;
	substep->index = 0;
	substep->part = has_two(session) ? CAU_SDIRK2_GAMMA : 1;
	substep->length_s = substep->part * session->solver.step_s;
	substep->disturbed = false;
}

// Notes whether the substep did not end at its solution, because a step was shortened or tools
// passed tissue.
static void note_disturbance(cau_session *session)
{
	const cau_collide *collide = session->solver.collide;
	bool any = session->contact.let_through;
	for (int32_t i = 0; i < session->tool_count; i++)
		any = any || session->contact.tool[i].held_back;
	if (collide)
		any = any || collide->filter.held_back || collide->cut_short_count > 0;
	session->substep.disturbed = session->substep.disturbed || any;
}

// ---- contact

static cau_vec3 velocity_at(const cau_contact_row *row, const double *place, const double *base,
                            double h)
{
	cau_vec3 at = cau_contact_point(row, place), from = cau_contact_point(row, base);
	return cau_scale(1 / h, cau_sub(at, from));
}

// Moves the constraint's point by `way`, by changing `place` at its corners according to their
// weights and masses.
static void move_point(const cau_session *session, const cau_contact_row *row, cau_vec3 way,
                       double *place)
{
	double sum = 0;
	const double *mass = session->tissue.mass;
	for (int32_t k = 0; k < row->corner_count; k++)
		sum += row->weight[k] * row->weight[k] / mass[row->vertex[k]];
	CAU_ASSERT(sum > 0, "a point of %d corners without a share", row->corner_count);
	for (int32_t k = 0; k < row->corner_count; k++) {
		size_t v = (size_t)row->vertex[k];
		double share = row->weight[k] / (mass[v] * sum);
		cau_vec3_to(cau_add_scaled(cau_vec3_of(place + 3 * v), share, way), place + 3 * v);
	}
}

// Velocities are (place - base) / h. Changes `base` so that pushed tissue does not move away from
// the tool. `sticks`: with friction, the velocity along the tool becomes the substep's mean.
static void stay_at_tools(const cau_session *session, double *place, double *base, bool sticks)
{
	double h = session->solver.inertia_s, length_s = session->substep.length_s;
	for (int32_t i = 0; i < session->contact.row_count; i++) {
		const cau_contact_row *row = &session->contact.row[i];
		cau_vec3 reaction = cau_vec3_of(row->reaction), n = cau_vec3_of(row->normal);
		double push = cau_dot(reaction, n);
		if (row->attached || !(push > 0))
			continue;
		const cau_tool *tool = &session->tool[row->tool];
		cau_vec3 start = cau_contact_point(row, session->vertices.start);
		cau_vec3 local = cau_pose_to_local(&tool->pose_before, start);
		cau_vec3 carried = cau_sub(cau_pose_to_world(&tool->state.pose, local), start);
		cau_vec3 of_tool = cau_scale(1 / length_s, carried);
		cau_vec3 velocity = velocity_at(row, place, base, h);
		double parting = cau_dot(cau_sub(velocity, of_tool), n);
		cau_vec3 change = cau_scale(-fmax(parting, 0), n);
		if (sticks && cau_length(cau_add_scaled(reaction, -push, n)) > 0) {
			cau_vec3 mean =
				velocity_at(row, session->vertices.position, session->vertices.start, length_s);
			cau_vec3 other = cau_sub(mean, velocity);
			change = cau_add(change, cau_add_scaled(other, -cau_dot(other, n), n));
		}
		move_point(session, row, cau_scale(-h, change), base);
	}
}

// ---- from the first substep to the second

// Sets `base` to x + q v1 and `predicted` to s2, still without the forces' part (h^2).
static void carry_on(cau_session *session)
{
	cau_substep *substep = &session->substep;
	double *predicted = session->solver.predicted, h = session->solver.inertia_s;
	double rest_s = (1 - CAU_SDIRK2_GAMMA) * session->solver.step_s;
	size_t n = 3 * (size_t)session->tissue.vertex_count;
	for (size_t i = 0; i < n; i++) { // v + q a1 is (predicted - base) / h
		double before = session->vertices.velocity[i], start = session->vertices.start[i];
		double speed = (session->vertices.position[i] - start) / h;
		double carried = before + rest_s * (speed - before) / h;
		predicted[i] = h * carried;
		substep->base[i] = 0;
	}
	stay_at_tools(session, predicted, substep->base, false);
	for (size_t i = 0; i < n; i++) {
		double start = session->vertices.start[i], way = session->vertices.position[i] - start;
		double carried = predicted[i] - substep->base[i];
		substep->base[i] = start + rest_s * (way / h);
		predicted[i] = substep->base[i] + carried;
	}
}

double cau_session_last_share(const cau_session *session)
{
	return session->substep.count == 2 ? CAU_SDIRK2_GAMMA : 1;
}

static void add_push(double *push, int32_t vertex, double share, const double force[3])
{
	CAU_ASSERT(vertex >= 0, "vertex %d", vertex);
	for (int c = 0; c < 3; c++)
		push[3 * (size_t)vertex + (size_t)c] += share * force[c];
}

static void keep_pushes(cau_session *session)
{
	double *push = session->substep.push, first = 1 - CAU_SDIRK2_GAMMA;
	memset(push, 0, 3 * (size_t)session->tissue.vertex_count * sizeof *push);
	for (int32_t i = 0; i < session->contact.row_count; i++) {
		const cau_contact_row *row = &session->contact.row[i];
		for (int32_t k = 0; k < row->corner_count; k++)
			add_push(push, row->vertex[k], first * row->weight[k], row->reaction);
	}
	for (int32_t k = 0; k < session->solver.forces.drag_count; k++) {
		const cau_drag *drag = &session->solver.forces.drag[k];
		double away[3];
		for (int c = 0; c < 3; c++)
			away[c] =
				session->vertices.position[3 * (size_t)drag->vertex + (size_t)c] - drag->target[c];
		add_push(push, drag->vertex, -first * drag->coefficient, away);
	}
}

static void keep_statistics(cau_substep *substep, const cau_step_solver *solver)
{
	substep->iterations = solver->result.iterations;
	substep->backtracks = solver->result.backtracks;
	substep->local_s = solver->result.local_s;
	substep->contact_s = solver->result.contact_s;
	substep->residual = solver->result.residual;
	substep->error = solver->accuracy.error;
}

static void add_statistics(const cau_substep *substep, cau_step_solver *solver)
{
	solver->result.iterations += substep->iterations;
	solver->result.backtracks += substep->backtracks;
	solver->result.local_s += substep->local_s;
	solver->result.contact_s += substep->contact_s;
	solver->result.residual = fmax(solver->result.residual, substep->residual);
	// An error of x2 is larger in v2 by 1 / gamma.
	solver->accuracy.error = fmax(solver->accuracy.error, substep->error) / CAU_SDIRK2_GAMMA;
}

void cau_session_next_substep(cau_session *session)
{
	cau_substep *substep = &session->substep;
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	CAU_ASSERT(substep->index == 0 && substep->count == 2, "substep %d of %d", substep->index,
	           substep->count);
	note_disturbance(session);
	cau_solver_take_strain(&session->solver, (1 - CAU_SDIRK2_GAMMA) / CAU_SDIRK2_GAMMA);
	carry_on(session);
	keep_pushes(session);
	keep_statistics(substep, &session->solver);
	substep->touching_j = session->solver.collide ? session->collide.start_energy_j : 0;
	cau_contact_remember(&session->contact);
	memcpy(substep->tick_start, session->vertices.start, bytes);
	memcpy(session->vertices.start, session->vertices.position, bytes);
	substep->index = 1;
	substep->part = 1 - CAU_SDIRK2_GAMMA;
	substep->length_s = substep->part * session->solver.step_s;
}

static void predict_on(cau_session *session)
{
	const cau_substep *substep = &session->substep;
	double h = session->solver.inertia_s, rest_s = session->solver.step_s - h;
	const double *gravity = session->scene->gravity_m_s2;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		for (int c = 0; c < 3; c++) {
			size_t i = 3 * (size_t)v + (size_t)c;
			double push = gravity[c] + session->vertices.external[i] / session->tissue.mass[v];
			session->solver.predicted[i] += h * h * push;
			// The guess is s2 with the first substep's acceleration in place of the second's. If
			// there is any contact, that would lead too far, so the guess follows the first
			// substep's velocity.
			double speed = (substep->base[i] - substep->tick_start[i]) / rest_s;
			double rate = (speed - session->vertices.velocity[i]) / h;
			if (session->vertices.fixed[v])
				continue;
			if (session->solver.collide || session->contact.row_count)
				session->vertices.position[i] += rest_s * speed;
			else
				session->vertices.position[i] =
					session->solver.predicted[i] + h * h * (rate - push);
		}
}

// ---- the end of a tick's motion

void cau_session_end_substeps(cau_session *session)
{
	cau_substep *substep = &session->substep;
	if (substep->index == 0)
		return;
	note_disturbance(session);
	if (!substep->disturbed)
		stay_at_tools(session, session->vertices.position, substep->base, true);
	add_statistics(substep, &session->solver);
	session->collide.start_energy_j = substep->touching_j;
	memcpy(session->vertices.start, substep->tick_start,
	       3 * (size_t)session->tissue.vertex_count * sizeof(double));
	if (!substep->disturbed)
		cau_session_keep_momentum(session); // spin.c
	// tick_start is not needed any more. From here on it stores `base`.
	memcpy(substep->tick_start, substep->base,
	       3 * (size_t)session->tissue.vertex_count * sizeof *substep->base);
	if (substep->disturbed)
		cau_session_take_mean(session, 1);
}

void cau_session_take_mean(cau_session *session, double share)
{
	cau_substep *substep = &session->substep;
	const double *x = session->vertices.position, *start = session->vertices.start;
	CAU_ASSERT(substep->count == 2 && share >= 0 && share <= 1, "a share of %g of %d substeps",
	           share, substep->count);
	for (size_t i = 0; i < 3 * (size_t)session->tissue.vertex_count; i++) {
		double mean = x[i] - CAU_SDIRK2_GAMMA * (x[i] - start[i]);
		substep->base[i] = substep->tick_start[i] + share * (mean - substep->tick_start[i]);
	}
	cau_session_keep_momentum(session);
}

double cau_session_way(const cau_session *session, int32_t vertex, int c)
{
	const cau_substep *substep = &session->substep;
	size_t i = 3 * (size_t)vertex + (size_t)c;
	if (substep->count == 1)
		return session->vertices.position[i] - session->vertices.start[i];
	return (session->vertices.position[i] - substep->base[i]) / CAU_SDIRK2_GAMMA;
}

// ---- prediction and velocities

// Motion of the vertices in a tick: their prediction before the solve, and their velocities after
// it.

// Predicts s = x + dt v + dt^2 M^-1 f_ext (eq. 4), and the first guess x + dt v. With implicit
// Euler both are rotated for pieces that turn freely (spin.c). With two substeps, dt is the h of
// each substep.
void cau_session_predict(cau_session *session)
{
	double dt = session->solver.inertia_s;
	if (session->substep.index) {
		predict_on(session);
		return;
	}
	const double *gravity = session->scene->gravity_m_s2;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		for (int c = 0; c < 3; c++) {
			size_t i = 3 * (size_t)v + (size_t)c;
			double guess = session->vertices.start[i] + dt * session->vertices.velocity[i];
			double push = gravity[c] + session->vertices.external[i] / session->tissue.mass[v];
			session->solver.predicted[i] = guess + dt * dt * push;
			session->vertices.position[i] =
				session->vertices.fixed[v] ? session->vertices.start[i] : guess;
		}
	if (session->substep.count == 1)
		cau_session_turn_prediction(session);
}

double cau_session_velocity_scale(const cau_session *session)
{
	double dt = session->solver.step_s;
	return exp(-session->scene->damping_per_s * dt) / dt;
}

// Sets v = (x - x_t) / dt (eq. 2), or the velocity after two substeps, damped by exp(-c dt).
void cau_session_update_velocities(cau_session *session)
{
	double scale = cau_session_velocity_scale(session);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		for (int c = 0; c < 3; c++) {
			size_t i = 3 * (size_t)v + (size_t)c;
			session->vertices.velocity[i] =
				session->vertices.fixed[v] ? 0 : scale * cau_session_way(session, v, c);
		}
}
