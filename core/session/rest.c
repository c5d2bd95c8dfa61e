// SPDX-License-Identifier: GPL-3.0-or-later
// Rest. Tissue that no longer moves is kept in place, and its steps cost nothing, until something
// wakes it. Tissue does not stop completely by itself: rounding, rotations that are found again,
// and the error that iterations leave in each step keep changing the last digits.
//
// Rest is a change of state that every run makes at the same tick, not an optional shortcut.
// Velocities become zero and positions stay exactly the same. So rest is part of snapshots.
//
// Tissue rests when all of this held for half a second:
// - No vertex was farther than a micrometre from its position at the start of the half second. Any
//   motion left is then at most 2 um/s, while the streams' steps are 50 um. The test is on the
//   position, not the path, because noise around a position is not motion. Half a second is longer
//   than the slow turning point of an oscillation.
// - Every tool was still and had energy off, with its heat grid at ambient (0.01 degC). Heat
//   continues to part edges, and viewers see it spread.
// - No tool's filtered force was still following its raw force. A filter of long force_filter_s
//   makes the wait longer, because at rest both forces stay as they are.
// - Nothing was cut, nothing shrank, no cut waited for the factor, and no factor was being
//   computed.
// - No step was shortened to keep tissue from crossing tissue.
//
// A command that is due wakes the tissue, and so does a moved support. A command that repeats the
// present level does not (level.c): drivers send a tool's pose at the rate of their screens.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static const double quiet_s = 0.5;
// Wait for a filter, in time constants. After this time a filtered force differs by 0.02 % of the
// last change, in ticks of 1/60 s. With the default force_filter_s this is less than quiet_s.
static const double filter_constants = 10;
static const double still_m = 1e-6;
// Largest motion at rest, as a share of the tissue's size; the limit is the smaller of this motion
// and still_m.
static const double still_share = 1e-5;

cau_status cau_session_make_rest(cau_session *session, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count;
	session->rest.from = cau_arena_array(&session->memory.arena, 3 * n, sizeof *session->rest.from);
	if (!session->rest.from)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	return CAU_OK;
}

static int32_t ticks_to_rest(const cau_session *session)
{
	CAU_ASSERT(session->solver.step_s > 0, "a tick of %g s", session->solver.step_s);
	double wait_s = quiet_s;
	for (int32_t i = 0; i < session->tool_count; i++)
		wait_s = fmax(wait_s, filter_constants * session->tool[i].state.definition.force_filter_s);
	return (int32_t)ceil(wait_s / session->solver.step_s);
}

// ---- coming to rest

static bool is_same_pose(const cau_pose *a, const cau_pose *b)
{
	return cau_pose_is_same_place(a, b) && cau_pose_is_same_turn(a, b);
}

// Whether the tool kept its pose in the tick. A tool in contact trembles with the tissue below it.
static bool has_stayed(const cau_tool *tool)
{
	if (is_same_pose(&tool->state.pose, &tool->state.asked_pose))
		return is_same_pose(&tool->state.pose, &tool->pose_before);
	cau_vec3 way = cau_sub(cau_vec3_of(tool->state.pose.position_m),
	                       cau_vec3_of(tool->pose_before.position_m));
	return cau_length(way) <= still_m &&
	       cau_pose_is_same_turn(&tool->state.pose, &tool->pose_before);
}

// Whether the jaws kept their opening. Held tissue yields to them less and less.
static bool have_jaws_stayed(const cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	double turned = fabs(tool->state.jaw - tool->jaw_before) * def->jaw_open_rad;
	return tool->state.asked_jaw == tool->jaw_target && turned * def->tip_length_m <= still_m &&
	       (tool->grasp_count || tool->state.jaw == tool->jaw_target);
}

static bool is_still(const cau_tool *tool)
{
	return !tool->state.energized && cau_heat_grid_is_ambient(&tool->grid) &&
	       have_jaws_stayed(tool) && is_same_pose(&tool->state.asked_pose, &tool->target) &&
	       is_same_pose(&tool->anchor, &tool->target) && has_stayed(tool);
}

// Whether nothing outside the tissue could move it.
static bool is_left_alone(const cau_session *session)
{
	const cau_matrix_update *update = &session->update;
	if (session->dissection.removed_count || session->shrink.active_count ||
	    update->waiting_count || update->making ||
	    (session->solver.collide && session->collide.held_back_count))
		return false;
	if (!cau_session_has_cooled(session) || cau_session_bleeds(session))
		return false;
	for (int32_t i = 0; i < session->tool_count; i++)
		if (!is_still(&session->tool[i]))
			return false;
	return true;
}

static double most_m(const cau_session *session)
{
	CAU_ASSERT(session->watch.size_m >= 0, "a tissue of %g m", session->watch.size_m);
	return fmin(still_m, still_share * session->watch.size_m);
}

// Whether the tick moved a vertex farther than the limit for tissue at rest. possible.c has
// computed these motions.
static bool has_moved(const cau_session *session)
{
	double most = most_m(session);
	for (int32_t chunk = 0; chunk < session->solver.chunks.count; chunk++)
		if (!(session->watch.farthest2_m2[chunk] <= most * most))
			return true;
	return false;
}

static bool has_strayed(const cau_session *session)
{
	double most = most_m(session);
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++) {
		cau_vec3 way = cau_sub(cau_vec3_of(session->vertices.position + 3 * v),
		                       cau_vec3_of(session->rest.from + 3 * v));
		if (!(cau_dot(way, way) <= most * most))
			return true;
	}
	return false;
}

void cau_session_fall_asleep(cau_session *session)
{
	cau_rest *rest = &session->rest;
	CAU_ASSERT(!rest->resting, "tick %llu was solved at rest", (unsigned long long)session->tick);
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	if (!is_left_alone(session) || has_moved(session)) {
		rest->quiet_ticks = 0;
	} else if (!rest->quiet_ticks || has_strayed(session)) {
		memcpy(rest->from, session->vertices.position, bytes);
		rest->quiet_ticks = 1;
	} else if (++rest->quiet_ticks >= ticks_to_rest(session)) {
		memset(session->vertices.velocity, 0, bytes);
		rest->resting = true;
	}
}

// ---- waking

static bool is_disturbed(cau_session *session)
{
	CAU_ASSERT(session->driven.count >= 0, "%d vertices led", session->driven.count);
	if (session->driven.count)
		return true;
	for (int32_t k = 0; k < session->queue.count; k++)
		if (session->queue.command[k].tick <= session->tick &&
		    !cau_session_changes_nothing(session, &session->queue.command[k]))
			return true;
	return false;
}

bool cau_session_rests(cau_session *session)
{
	if (is_disturbed(session)) {
		session->rest.resting = false;
		session->rest.quiet_ticks = 0;
	}
	return session->rest.resting;
}

cau_status cau_session_rest_tick(cau_session *session, cau_error *error)
{
	CAU_ASSERT(session->rest.resting, "tick %llu is not at rest",
	           (unsigned long long)session->tick);
	cau_step_solver *solver = &session->solver;
	memset(session->timing.stage_s, 0, sizeof session->timing.stage_s);
	session->queue.refusal_count = 0;
	solver->result.iterations = solver->result.backtracks = 0;
	solver->result.residual = solver->accuracy.error = session->energy.gain_j = 0;
	cau_dissection_begin(&session->dissection);
	// Refusals and sequence numbers are reported as in every tick.
	cau_status status = cau_session_apply_commands(session, error);
	cau_frame_stand_still(&session->view.frame);
	session->tick++;
	return status;
}
