// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of tools: which vertices are in contact, held or dragged, and what force the tools feel.
// The contact constraints themselves are in solve/contact.c.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Greatest drag, as a share of a vertex's diagonal entry in A.
static const double drag_share = 0.25;

// Returns the part of the tool that pushes. Cold parts always push. The hot part pushes with energy
// off, and with energy `tissue` always, because there the tissue is removed instead.
static cau_tool_part pushing_part(const cau_session *session, const cau_tool *tool)
{
	return tool->state.energized && !session->heat.cells ? CAU_PART_COLD : CAU_PART_BOTH;
}

static cau_contact_row contact_row(const cau_session *session, const cau_tool *tool, int32_t index,
                                   int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, session->tissue.vertex_count);
	CAU_ASSERT_INDEX(index, session->tool_count);
	cau_contact_row row = cau_contact_at_vertex(vertex, index);
	row.free[0] = !session->vertices.fixed[vertex];
	cau_vec3 side;
	cau_vec3 start = cau_vec3_of(session->vertices.start + 3 * (size_t)vertex);
	cau_vec3 local = cau_pose_to_local(&tool->pose_before, start);
	cau_vec3_to(cau_pose_to_world(&tool->anchor, local), row.no_slip[0]);
	double start_m = cau_tool_distance(&tool->state.definition, tool->state.jaw,
	                                   pushing_part(session, tool), local, &side);
	if (cau_session_feels_faces(tool) && start_m > 0)
		cau_vec3_to(side, row.side); // otherwise the vertex may leave in any direction
	row.slack_m = cau_contact_slack(start_m, session->substep.length_s);
	row.way_m = cau_length(cau_sub(cau_pose_to_local(&tool->state.pose, start), local)) +
	            2 * tool->state.definition.hot_radius_m;
	return row;
}

// Whether a vertex is left over: it is fixed, and its last element was removed.
static bool is_left_over(const cau_session *session, int32_t vertex)
{
	return session->vertices.fixed[vertex] && !session->dissection.live_elements[vertex];
}

static bool is_grasped(const cau_tool *tool, int32_t vertex)
{
	CAU_ASSERT(tool->grasp_count >= 0 && tool->grasp_count <= CAU_MAX_GRASPED,
	           "%d vertices grasped", tool->grasp_count);
	for (int32_t k = 0; k < tool->grasp_count; k++)
		if (tool->grasp[k].face < 0 && tool->grasp[k].vertex[0] == vertex)
			return true;
	return false;
}

// Returns the signed distance from the pushing part to a vertex at the tick's end: at its guessed
// position, or at its start if that is nearer and within the margin. A vertex that was pushed out
// in the last tick is guessed to move on. With the guess alone its constraint would be lost in
// every second tick.
static double least_gap(const cau_session *session, const cau_tool *tool, int32_t vertex,
                        double margin_m)
{
	const cau_tool_state *state = &tool->state;
	cau_tool_part part = pushing_part(session, tool);
	size_t at = 3 * (size_t)vertex;
	double least = cau_tool_distance_at(&state->definition, &state->pose, state->jaw, part,
	                                    cau_vec3_of(session->vertices.position + at), NULL);
	CAU_ASSERT_INDEX(vertex, session->tissue.vertex_count);
	cau_vec3 start = cau_vec3_of(session->vertices.start + at);
	double way = cau_length(cau_sub(cau_vec3_of(session->vertices.position + at), start));
	if (least > 2 * margin_m + way) // the start is not nearer than the margin either
		return least;
	double was =
		cau_tool_distance_at(&state->definition, &state->pose, state->jaw, part, start, NULL);
	return was < least ? was : least;
}

// Adds a vertex to the list. If the list is full, replaces the least deep vertex, unless the new
// one is less deep.
static void list_touching(cau_session *session, cau_touching *list, int32_t *count,
                          cau_touching touching)
{
	int32_t least = 0;
	if (*count < CAU_MAX_TOUCHING) {
		list[(*count)++] = touching;
		return;
	}
	for (int32_t k = 1; k < CAU_MAX_TOUCHING; k++)
		if (list[k].gap > list[least].gap)
			least = k;
	session->contact.left_out_count++;
	if (touching.gap < list[least].gap)
		list[least] = touching;
}

static const double in_float_m = 1e-6; // m, largest error of a box in single precision

// Collects the vertices within the margin of the pushing part. Fixed vertices are included: there
// the tool yields.
static int32_t collect(cau_session *session, int32_t index, cau_touching *list)
{
	const cau_tool *tool = &session->tool[index];
	const cau_tool_def *def = &tool->state.definition;
	double margin = cau_session_margin(def), radius;
	int32_t count = 0;
	cau_vec3 center;
	cau_tool_bound(def, pushing_part(session, tool), &center, &radius);
	center = cau_pose_to_world(&tool->state.pose, center);
	for (int32_t b = 0; b < session->heat.near.block_count; b++) {
		const cau_box *box = &session->heat.near.vertex_box[b];
		if (!cau_box_meets(box, center, radius + margin) ||
		    !cau_session_may_meet(tool, pushing_part(session, tool), box, margin + in_float_m))
			continue;
		int32_t last = (b + 1) * CAU_NEAR_BLOCK;
		for (int32_t i = b * CAU_NEAR_BLOCK; i < last && i < session->tissue.vertex_count; i++) {
			int32_t v = session->heat.near.vertex[i];
			if (is_left_over(session, v) || is_grasped(tool, v))
				continue;
			double gap = least_gap(session, tool, v, margin);
			if (!(gap <= margin)) // true also if the position is not a number
				continue;
			list_touching(session, list, &count, (cau_touching){v, i, gap});
		}
	}
	return count;
}

static void add_attachments(cau_session *session, int32_t index)
{
	cau_tool *tool = &session->tool[index];
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_contact_row row = cau_session_row_of_hold(session, &tool->grasp[k], index);
		cau_vec3_to(cau_pose_to_world(&tool->anchor, cau_vec3_of(tool->grasp[k].local)),
		            row.anchor);
		cau_contact_add(&session->contact, &row);
	}
}

// Adds drag. Energized surfaces do not push. They drag the tissue inside them along, viscously,
// while it chars.
static void add_drag(cau_session *session, int32_t index)
{
	const cau_tool *tool = &session->tool[index];
	const cau_tool_def *def = &tool->state.definition;
	cau_step_solver *solver = &session->solver;
	double radius;
	cau_vec3 center;
	if (!tool->state.energized || session->heat.cells || def->drag_ns_m == 0)
		return;
	cau_tool_bound(def, CAU_PART_HOT, &center, &radius);
	center = cau_pose_to_world(&tool->state.pose, center);
	for (int32_t b = 0; b < session->heat.near.block_count; b++) {
		if (!cau_box_meets(&session->heat.near.vertex_box[b], center, radius))
			continue;
		int32_t last = (b + 1) * CAU_NEAR_BLOCK;
		for (int32_t i = b * CAU_NEAR_BLOCK; i < last && i < session->tissue.vertex_count; i++) {
			int32_t v = session->heat.near.vertex[i];
			cau_vec3 x = cau_vec3_of(session->vertices.start + 3 * (size_t)v);
			if (session->vertices.fixed[v] ||
			    solver->forces.drag_count == session->tissue.vertex_count ||
			    cau_tool_distance_at(def, &tool->state.pose, tool->state.jaw, CAU_PART_HOT, x,
			                         NULL) > 0)
				continue;
			double most = drag_share * solver->system.diagonal[v];
			cau_drag drag = {.vertex = v,
			                 .coefficient = fmin(def->drag_ns_m / session->substep.length_s, most)};
			cau_vec3 local = cau_pose_to_local(&tool->pose_before, x);
			cau_vec3_to(cau_pose_to_world(&tool->state.pose, local), drag.target);
			solver->forces.drag[solver->forces.drag_count++] = drag;
		}
	}
}

static void describe_tools(cau_session *session)
{
	CAU_ASSERT(session->tool_count <= CAU_MAX_TOOLS, "%d tools", session->tool_count);
	session->contact.tool_count = session->tool_count;
	for (int32_t i = 0; i < session->tool_count; i++) {
		const cau_tool *tool = &session->tool[i];
		bool held_back = session->contact.tool[i].held_back; // set in the attempt before
		session->contact.tool[i] = (cau_contact_tool){
			.held_back = held_back,
			.def = &tool->state.definition,
			.jaw = tool->state.jaw,
			.part = (int)pushing_part(session, tool),
		};
	}
	cau_session_couple(session);
}

// Adds the constraints of the vertices at a tool. These constraints leave capacity for faces, which
// a tool could otherwise pass.
static void add_vertices(cau_session *session, int32_t index)
{
	cau_touching list[CAU_MAX_TOUCHING];
	cau_contact_set *set = &session->contact;
	int32_t count = collect(session, index, list);
	int32_t left_out, rows = cau_session_thin(session, list, count, set->row_count, &left_out);
	set->left_out_count += left_out;
	for (int32_t k = 0; k < rows; k++) {
		cau_contact_row row = contact_row(session, &session->tool[index], index, list[k].vertex);
		cau_contact_add(set, &row);
	}
}

void cau_session_find_contacts(cau_session *session)
{
	cau_contact_clear(&session->contact);
	session->contact.left_out_count = 0;
	session->contact.begun.count = -1;
	session->contact.torn = session->dissection.tears.elements_torn > 0;
	session->contact.let_through = false;
	session->solver.forces.drag_count = 0;
	if (!session->tool_count)
		return;
	cau_near_refit(&session->heat.near, session->vertices.position);
	cau_near_cover(&session->heat.near, session->vertices.start);
	describe_tools(session);
	for (int32_t i = 0; i < session->tool_count; i++)
		add_attachments(session, i);
	for (int32_t i = 0; i < session->tool_count; i++) {
		add_vertices(session, i);
		if (cau_session_feels_faces(&session->tool[i]))
			cau_session_reach_again(session, i, pushing_part(session, &session->tool[i]));
		add_drag(session, i);
	}
	if (session->contact.row_count)
		cau_contact_prepare(&session->contact, &session->solver);
}

static void keep_unheld(cau_session *session, int32_t rows)
{
	cau_contact_set *set = &session->contact;
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	set->begun.count = rows;
	memcpy(session->touch.unheld, session->vertices.position, bytes);
	session->touch.unheld_farthest_m = session->touch.farthest_m;
	for (int32_t i = 0; i < rows; i++)
		memcpy(set->begun.reaction[i], set->row[i].reaction, sizeof set->begun.reaction[i]);
	for (int32_t i = 0; i < set->tool_count; i++)
		memcpy(set->begun.offset[i], set->tool[i].offset, sizeof set->begun.offset[i]);
}

static const double missed_m = 1e-4; // a face deeper than this at its constraint is not held yet

// Whether tissue is where it cannot have come. Then the step continues with constraints for the
// missed faces, and for the constraints inside which it ended.
bool cau_session_find_missed(cau_session *session)
{
	cau_contact_set *set = &session->contact;
	int32_t rows = set->row_count, feeling = 0;
	cau_session_take_poses(session);
	bool first = set->begun.count < 0;
	set->sides.touched_count = 0;
	for (int32_t i = 0; i < session->tool_count; i++)
		feeling += cau_session_feels_faces(&session->tool[i]);
	if (!feeling)
		return false;
	cau_near_refit(&session->heat.near, session->vertices.position);
	session->touch.farthest_m = cau_session_farthest(session);
	for (int32_t i = 0; i < session->tool_count; i++)
		if (cau_session_feels_faces(&session->tool[i]))
			cau_session_reach(session, i, pushing_part(session, &session->tool[i]));
	if (set->row_count == rows && !set->face_count)
		return false;
	if (first)
		keep_unheld(session, rows);
	if (set->row_count > rows)
		cau_contact_prepare(set, &session->solver);
	bool more = set->row_count > rows;
	bool deep = cau_contact_is_deep(set, &session->solver, missed_m, 0);
	set->crossing =
		more || (deep && cau_contact_is_deep(set, &session->solver, missed_m, cau_missed_share));
	return more || deep;
}

bool cau_session_find_thrown(cau_session *session)
{
	double room = 0;
	if (session->contact.begun.count < 0)
		return false;
	for (int32_t i = 0; i < session->tool_count; i++) {
		const cau_tool *tool = &session->tool[i];
		// The actual pose may have diverged, so the anchor's motion is used.
		cau_vec3 from = cau_vec3_of(tool->anchor_before.position_m);
		double way = cau_length(cau_sub(cau_vec3_of(tool->anchor.position_m), from));
		room = fmax(room, way + 2 * tool->state.definition.hot_radius_m);
	}
	bool thrown = !(session->touch.farthest_m <= session->touch.unheld_farthest_m + room);
	for (int32_t i = 0; i < session->tool_count && thrown; i++)
		session->contact.tool[i].passing = true;
	return thrown;
}

void cau_session_let_through(cau_session *session)
{
	cau_contact_set *set = &session->contact;
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	CAU_ASSERT_INDEX(set->begun.count, set->row_count + 1);
	memcpy(session->vertices.position, session->touch.unheld, bytes);
	set->row_count = set->begun.count;
	for (int32_t i = 0; i < set->row_count; i++)
		memcpy(set->row[i].reaction, set->begun.reaction[i], sizeof set->row[i].reaction);
	for (int32_t i = 0; i < set->tool_count; i++)
		memcpy(set->tool[i].offset, set->begun.offset[i], sizeof set->tool[i].offset);
	cau_session_take_poses(session);
	set->let_through = true;
}

// ---- after the solve

// Whether a constraint carries the greatest force that tissue bears at one point, and would be torn
// out.
static bool bears_too_much(const cau_contact_row *row)
{
	const double nearly = 0.999;
	return cau_length(cau_vec3_of(row->reaction)) > nearly * cau_most_at_a_point_n;
}

// Lets an attachment slip that is at its slip force: its anchor follows the vertex so far that the
// force stays the same. The attachment is lost beyond the length of the jaws. It is also lost at
// once, however firm the jaws are, if it carries more than tissue bears at one point.
static void slip(cau_tool *tool, const cau_contact_row *row, const double *position)
{
	const cau_tool_def *def = &tool->state.definition;
	cau_grasp *grasp = cau_session_hold_of_row(tool, row);
	if (!grasp)
		return;
	cau_vec3 anchor = cau_add_scaled(cau_contact_point(row, position), 1 / def->grasp_stiffness_n_m,
	                                 cau_vec3_of(row->reaction));
	cau_vec3 local = cau_pose_to_local(&tool->state.pose, anchor);
	cau_vec3_to(local, grasp->local);
	tool->state.slipping = true;
	if (cau_length(cau_sub(local, cau_vec3_of(grasp->start))) > def->tip_length_m ||
	    bears_too_much(row))
		*grasp = tool->grasp[--tool->grasp_count];
}

static void add_force(cau_tool_state *state, cau_vec3 force, cau_vec3 at)
{
	cau_vec3 arm = cau_sub(at, cau_vec3_of(state->pose.position_m));
	cau_vec3_to(cau_add(cau_vec3_of(state->raw_force_n), force), state->raw_force_n);
	cau_vec3_to(cau_add(cau_vec3_of(state->raw_torque_nm), cau_cross(arm, force)),
	            state->raw_torque_nm);
}

// Advances a low-pass filter of first order by one tick, by the implicit Euler method. The result
// is at most `most` long. With a time constant tau_s of 0 the result is the raw value, to the bit.
static void filter(double filtered[3], const double raw[3], double tau_s, double most, double dt)
{
	CAU_ASSERT(dt > 0 && most > 0, "a filter of ticks of %g s, up to %g", dt, most);
	cau_vec3 now = cau_vec3_of(filtered), goal = cau_vec3_of(raw);
	now = tau_s > 0 ? cau_add_scaled(now, dt / (dt + tau_s), cau_sub(goal, now)) : goal;
	double length = cau_length(now);
	cau_vec3_to(length > most ? cau_scale(most / length, now) : now, filtered);
}

void cau_session_read_forces(cau_session *session)
{
	cau_contact_remember(&session->contact);
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool_state *state = &session->tool[i].state;
		memset(state->raw_force_n, 0, sizeof state->raw_force_n);
		memset(state->raw_torque_nm, 0, sizeof state->raw_torque_nm);
		state->contact_vertices = 0;
		state->slipping = false;
		cau_session_read_pinch(session, &session->tool[i], i);
	}
	for (int32_t k = 0; k < session->contact.row_count; k++) {
		const cau_contact_row *row = &session->contact.row[k];
		CAU_ASSERT_INDEX(row->tool, session->tool_count);
		cau_tool *tool = &session->tool[row->tool];
		cau_vec3 reaction = cau_vec3_of(row->reaction);
		add_force(&tool->state, cau_scale(-1, reaction),
		          cau_contact_point(row, session->vertices.position));
		tool->state.contact_vertices += !row->attached && cau_dot(reaction, reaction) > 0;
		if (row->attached && (row->slipping || bears_too_much(row)))
			slip(tool, row, session->vertices.position);
	}
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool_state *state = &session->tool[i].state;
		const cau_tool_def *def = &state->definition;
		double most = def->force_max_n, tau_s = def->force_filter_s, dt = session->solver.step_s;
		filter(state->force_n, state->raw_force_n, tau_s, most, dt);
		filter(state->torque_nm, state->raw_torque_nm, tau_s, most * def->tip_length_m, dt);
		state->grasped_vertices = session->tool[i].grasp_count;
	}
}

// ---- grasping
cau_status cau_session_grasp(cau_session *session, cau_tool *tool, cau_error *error)
{
	const cau_tool_def *def = &tool->state.definition;
	if (!cau_tool_has_jaws(def))
		return cau_fail(error, CAU_BAD_STATE, "tool", "tool \"%s\" has no jaws to grasp with",
		                def->name);
	tool->state.grasping = true;
	tool->grasp_count = 0;
	for (int32_t i = 0; i < session->tissue.vertex_count; i++) {
		int32_t v = session->heat.near.vertex[i];
		double across;
		cau_vec3 local = cau_pose_to_local(&tool->state.pose,
		                                   cau_vec3_of(session->vertices.position + 3 * (size_t)v));
		if (session->vertices.fixed[v] || tool->grasp_count == CAU_MAX_GRASPED ||
		    !cau_tool_between_jaws(def, tool->state.jaw, local, &across))
			continue;
		cau_grasp grasp = cau_session_hold_vertex(v);
		cau_vec3_to(local, grasp.local);
		cau_vec3_to(local, grasp.start);
		tool->grasp[tool->grasp_count++] = grasp;
	}
	cau_session_grasp_faces(session, tool);
	cau_session_begin_pinch(session, tool);
	tool->jaw_target = 0;
	return CAU_OK;
}

void cau_session_release(cau_tool *tool)
{
	tool->state.grasping = false;
	tool->grasp_count = 0;
	tool->jaw_target = 1;
	tool->state.asked_jaw = tool->state.jaw;
	tool->state.jaw_force_n = 0;
}

void cau_session_drop_frozen_grasps(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		for (int32_t k = tool->grasp_count - 1; k >= 0; k--)
			if (!cau_session_hold_is_left(session, &tool->grasp[k]))
				tool->grasp[k] = tool->grasp[--tool->grasp_count];
		tool->state.grasped_vertices = tool->grasp_count;
	}
}
