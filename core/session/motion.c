// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the vertices in a tick: their prediction before the solve, and their velocities after
// it.
#include <math.h>

#include "session/session_internal.h"

// Predicts s = x + dt v + dt^2 M^-1 f_ext (eq. 4), and the first guess x + dt v. With implicit
// Euler both are rotated for pieces that turn freely (spin.c). With two substeps, dt is the h of
// each substep (substep.c).
void cau_session_predict(cau_session *session)
{
	double dt = session->solver.inertia_s;
	if (session->substep.index) {
		cau_session_predict_on(session); // substep.c
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
