// SPDX-License-Identifier: GPL-3.0-or-later
// The contact of each tool, linearised about a tick, for clients that render forces between ticks
// (cautery/channels.h, cau_tool_contact). While a client watches the contact, it is computed after
// each step from the solved contact constraints. The computation changes no state.
//
// Compliance: displacement of a load's own position by a unit load, which is distributed over the
// contact constraints like their reactions. The compliance is that of the tissue alone
// (solve/tangent.h). The virtual coupling is in series with it.
//
// Planes: constraints with nearly the same normal form one plane. The plane's offset is where the
// linear contact would end. With this offset, the plane gives the tick's force at the tick's
// commanded pose.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"
#include "solve/tangent.h"

enum { MOST_LOADS = 3 * CAU_MAX_CONTACTS };
static const double alike = 0.9; // least cosine between normals of one plane: 26 degrees

struct cau_contact_watch {
	cau_tangent tangent;
	cau_tool_contact record[CAU_MAX_TOOLS];
	cau_tangent_load load[MOST_LOADS];
};

void cau_session_watch_contact(cau_session *session, bool watched)
{
	cau_contact_watch *watch = session->view.contact;
	cau_error error;
	if (!watched || watch) {
		if (!watched && watch) // the old records must not be shown when contact is watched again
			memset(watch->record, 0, sizeof watch->record);
		return;
	}
	watch = calloc(1, sizeof *watch);
	if (!watch)
		return; // no record becomes valid
	if (cau_tangent_create(&watch->tangent, &session->solver, &error)) {
		free(watch);
		return;
	}
	session->view.contact = watch;
}

void cau_session_unwatch_contact(cau_session *session)
{
	if (session->view.contact)
		cau_tangent_finish(&session->view.contact->tangent);
	free(session->view.contact);
	session->view.contact = NULL;
}

void cau_session_forget_contact(cau_session *session)
{
	if (session->view.contact)
		memset(session->view.contact->record, 0, sizeof session->view.contact->record);
}

// ---- compliance

// Returns the force along the normal, N; 0 for a constraint that does not push.
static double push_of(const cau_contact_row *row)
{
	return row->attached ? 0
	                     : fmax(cau_dot(cau_vec3_of(row->reaction), cau_vec3_of(row->normal)), 0);
}

// The constraints that carry a load, and the load's direction.
typedef struct carried {
	int32_t count;
	double share[CAU_MAX_CONTACTS]; // share of each constraint in the load; their sum is 1
	double along[3];                // unit vector
} carried;

// Chooses the constraints that carry the load. With `held` these are all of the grasp's. Otherwise
// they are the constraints that push; if none pushes, the nearest.
static void choose(const cau_session *session, int32_t index, bool held, carried *out)
{
	const cau_contact_set *set = &session->contact;
	int32_t nearest = -1;
	double sum = 0;
	cau_vec3 push = {0, 0, 0};
	out->count = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		out->share[i] = 0;
		if (row->tool != index || row->attached != held)
			continue;
		out->share[i] = held ? 1 : push_of(row);
		sum += out->share[i];
		out->count += out->share[i] > 0;
		push = cau_add(push, cau_vec3_of(row->reaction));
		if (nearest < 0 || row->gap < set->row[nearest].gap)
			nearest = i;
	}
	if (nearest >= 0 && !(sum > 0)) {
		out->count = 1;
		out->share[nearest] = sum = 1;
		push = cau_vec3_of(set->row[nearest].normal);
	}
	for (int32_t i = 0; i < set->row_count && sum > 0; i++)
		out->share[i] /= sum;
	cau_vec3_to(cau_unit_or(push, (cau_vec3){0, 0, 1}), out->along);
}

// Returns the motion of the tissue under a load.
static cau_tangent_answer answer_of(cau_session *session, const carried *by)
{
	cau_contact_watch *watch = session->view.contact;
	const cau_contact_set *set = &session->contact;
	int32_t loads = 0;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *row = &set->row[i];
		for (int32_t k = 0; k < row->corner_count; k++)
			if (row->free[k] && by->share[i] * row->weight[k] > 0)
				watch->load[loads++] =
					(cau_tangent_load){row->vertex[k], by->share[i] * row->weight[k]};
	}
	return cau_tangent_find(&watch->tangent, watch->load, loads, by->along);
}

// ---- planes

static cau_vec3 normal_of(const cau_contact_plane *plane)
{
	return cau_vec3_of(plane->normal);
}

// Returns the speed of the tissue at a constraint, along a direction.
static double speed_of(const cau_session *session, const cau_contact_row *row, cau_vec3 along)
{
	cau_vec3 velocity = cau_contact_point(row, session->vertices.velocity);
	return cau_dot(velocity, along);
}

// Adds a pushing constraint to the plane of its normal, or to a new plane. Until all are added, a
// plane's normal is the sum of reactions, and its velocity the sum of speeds times forces. Its
// offset is the gap of a constraint that does not push.
static void take_pushing(const cau_session *session, const cau_contact_row *row,
                         cau_tool_contact *out)
{
	cau_vec3 normal = cau_scale(-1, cau_vec3_of(row->normal));
	double push = push_of(row), best = -1;
	int32_t at = -1;
	for (int32_t i = 0; i < out->plane_count; i++) {
		cau_vec3 other = normal_of(&out->plane[i]);
		double cosine = cau_dot(other, normal) / cau_length(other);
		if (cosine > best) {
			best = cosine;
			at = i;
		}
	}
	if (best < alike && out->plane_count < CAU_CONTACT_PLANES) {
		at = out->plane_count++;
		out->plane[at] = (cau_contact_plane){0};
	}
	cau_contact_plane *plane = &out->plane[at];
	cau_vec3_to(cau_add_scaled(normal_of(plane), push, normal), plane->normal);
	plane->velocity_m_s += push * speed_of(session, row, normal);
}

static void take_near(const cau_session *session, const cau_contact_row *row, cau_tool_contact *out)
{
	cau_vec3 normal = cau_scale(-1, cau_vec3_of(row->normal));
	for (int32_t i = 0; i < out->plane_count; i++) {
		cau_contact_plane *plane = &out->plane[i];
		if (cau_dot(normal_of(plane), normal) < alike)
			continue;
		// The gap of a pushing constraint is 0.
		plane->offset_m = fmin(plane->offset_m, fmax(row->gap, 0));
		return;
	}
	if (out->plane_count == CAU_CONTACT_PLANES)
		return;
	cau_contact_plane *plane = &out->plane[out->plane_count++];
	*plane = (cau_contact_plane){.offset_m = fmax(row->gap, 0),
	                             .velocity_m_s = speed_of(session, row, normal)};
	cau_vec3_to(normal, plane->normal);
}

static void make_planes(const cau_session *session, int32_t index, cau_tool_contact *out)
{
	const cau_contact_set *set = &session->contact;
	cau_vec3 push = {0, 0, 0};
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].tool == index && push_of(&set->row[i]) > 0)
			take_pushing(session, &set->row[i], out);
	for (int32_t i = 0; i < out->plane_count; i++) {
		cau_contact_plane *plane = &out->plane[i];
		double length = cau_length(normal_of(plane));
		push = cau_add(push, normal_of(plane));
		plane->velocity_m_s /= length;
		cau_vec3_to(cau_scale(1 / length, normal_of(plane)), plane->normal);
	}
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].tool == index && !set->row[i].attached && !(push_of(&set->row[i]) > 0))
			take_near(session, &set->row[i], out);
	const double *c = out->compliance_m_n;
	cau_vec3 moved = {c[0] * push.x + c[3] * push.y + c[4] * push.z,
	                  c[3] * push.x + c[1] * push.y + c[5] * push.z,
	                  c[4] * push.x + c[5] * push.y + c[2] * push.z};
	cau_vec3 place = cau_add(cau_vec3_of(out->asked_pose.position_m), moved);
	for (int32_t i = 0; i < out->plane_count; i++)
		out->plane[i].offset_m = cau_dot(normal_of(&out->plane[i]), place) - out->plane[i].offset_m;
}

// ---- records

static void describe_grasp(cau_session *session, int32_t index, double coupling,
                           cau_tool_contact *out)
{
	carried by;
	choose(session, index, true, &by);
	const cau_contact_set *set = &session->contact;
	memcpy(out->grasp_anchor_m, out->asked_pose.position_m, sizeof out->grasp_anchor_m);
	if (!by.count)
		return;
	cau_tangent_answer answer = answer_of(session, &by);
	const double *c = answer.compliance;
	double each = 1 / session->tool[index].state.definition.grasp_stiffness_n_m;
	double compliance = (c[0] + c[1] + c[2]) / 3 + each / by.count + coupling;
	cau_vec3 pull = {0, 0, 0};
	for (int32_t i = 0; i < set->row_count; i++)
		if (set->row[i].tool == index && set->row[i].attached)
			pull = cau_sub(pull, cau_vec3_of(set->row[i].reaction));
	out->grasp_n_m = 1 / compliance;
	cau_vec3_to(cau_add_scaled(cau_vec3_of(out->asked_pose.position_m), compliance, pull),
	            out->grasp_anchor_m);
}

static void describe(cau_session *session, int32_t index, cau_tool_contact *out)
{
	const cau_tool_state *state = &session->tool[index].state;
	carried by;
	double coupling = session->contact.tool[index].compliance;
	if (!(coupling > 0)) // no tissue was near any tool yet
		coupling = cau_coupling_reach_m / state->definition.force_max_n;
	*out = (cau_tool_contact){
		.valid = true,
		.asked_pose = state->asked_pose,
		.pose = state->pose,
		.friction = state->definition.friction,
		.compliance_m_n = {coupling, coupling, coupling},
	};
	memcpy(out->name, state->name, sizeof out->name);
	memcpy(out->force_n, state->raw_force_n, sizeof out->force_n);
	choose(session, index, false, &by);
	if (by.count) {
		cau_tangent_answer answer = answer_of(session, &by);
		for (int i = 0; i < 6; i++)
			out->compliance_m_n[i] += answer.compliance[i];
		out->damping_ns_m = answer.mass_kg * session->scene->damping_per_s;
	}
	make_planes(session, index, out);
	describe_grasp(session, index, coupling, out);
}

static bool are_finite(const double *numbers, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(numbers[i]))
			return false;
	return true;
}

// Whether all numbers of a record are finite. Columns that do not include many cuts yet may give
// numbers that are not finite.
static bool is_finite(const cau_tool_contact *record)
{
	bool finite = are_finite(record->force_n, 3) && are_finite(record->compliance_m_n, 6) &&
	              are_finite(record->grasp_anchor_m, 3) && are_finite(&record->damping_ns_m, 1) &&
	              are_finite(&record->grasp_n_m, 1);
	for (int32_t i = 0; i < record->plane_count; i++)
		finite = finite && are_finite(record->plane[i].normal, 3) &&
		         are_finite(&record->plane[i].offset_m, 1) &&
		         are_finite(&record->plane[i].velocity_m_s, 1);
	return finite;
}

// Makes an invalid record with the tool's name and poses.
static void show_nothing(const cau_tool_state *state, cau_tool_contact *record)
{
	*record = (cau_tool_contact){.asked_pose = state->asked_pose, .pose = state->pose};
	memcpy(record->name, state->name, sizeof record->name);
}

void cau_session_read_contact(cau_session *session)
{
	cau_contact_watch *watch = session->view.contact;
	if (!watch || !(session->view.watched & CAU_CHANNEL_TOOL_CONTACT))
		return;
	if (session->contact.row_count)
		cau_tangent_begin(&watch->tangent, &session->solver);
	for (int32_t i = 0; i < session->tool_count; i++) {
		describe(session, i, &watch->record[i]);
		if (!is_finite(&watch->record[i]))
			show_nothing(&session->tool[i].state, &watch->record[i]);
	}
}

const cau_tool_contact *cau_session_show_contact(const cau_session *session)
{
	cau_contact_watch *watch = session->view.contact;
	if (!watch || !(session->view.watched & CAU_CHANNEL_TOOL_CONTACT))
		return NULL;
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool_contact *record = &watch->record[i];
		const cau_tool_state *state = &session->tool[i].state;
		// The tool was added, or its contact is not computed yet.
		if (strcmp(record->name, state->name) != 0)
			show_nothing(state, record);
		record->time_s = (double)session->tick * session->solver.step_s;
	}
	return watch->record;
}
