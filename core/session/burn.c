// SPDX-License-Identifier: GPL-3.0-or-later
// Dissection of one tick: by the heat of tools with energy `paper`, and by stretch.
#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- heat

// Heat and dissection of one tick, tool by tool (sections 6.1 to 6.3).

// Divides the tool's motion in the tick into equal parts. In each part the heat grid follows the
// tool, and the edges that the tool meets are exposed to heat (eq. 18-20).
static void heat_edges(cau_session *session, cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	int parts = cau_heating_parts(def, &tool->pose_before, &tool->state.pose);
	CAU_ASSERT(parts >= 1, "a way in %d parts", parts);
	double duration = session->solver.step_s / parts;
	for (int part = 1; part <= parts; part++) {
		// the last part ends exactly at the tool's pose, where a restore looks for the tool's
		// surface
		cau_pose pose = tool->state.pose;
		if (part < parts)
			pose = cau_pose_between(&tool->pose_before, &pose, (double)part / parts);
		cau_heat_grid_advance(&tool->grid, def, &pose, tool->state.jaw, tool->state.energized,
		                      duration);
		if (cau_heat_grid_warmest(&tool->grid) > CAU_LIVING_C)
			tool->state.energy_j += cau_dissection_expose(&session->dissection, &session->heat.near,
			                                              session->vertices.position, &tool->grid,
			                                              def, &pose, tool->state.jaw, duration);
	}
	cau_vec3 tip = cau_vec3_of(tool->state.pose.position_m);
	tool->state.tip_temperature_c = cau_heat_grid_at(&tool->grid, tip);
}

void cau_session_take_out(cau_session *session, int32_t first)
{
	CAU_ASSERT(first >= 0 && first <= session->dissection.removed_count,
	           "from element %d on of %d removed", first, session->dissection.removed_count);
	for (int32_t k = first; k < session->dissection.removed_count; k++) {
		const cau_removed *removed = &session->dissection.removed[k];
		cau_elements_remove(&session->solver.elements, &session->solver.slots, removed->kind,
		                    removed->element);
		cau_matrix_update_remove(&session->update, removed->kind, removed->element,
		                         session->tick + 1);
	}
}

void cau_session_burn(cau_session *session)
{
	if (session->tool_count)
		cau_near_refit(&session->heat.near, session->vertices.position);
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		CAU_ASSERT(tool->grid.field[0].temperature != NULL, "tool %d has no heat grid", i);
		int32_t first = session->dissection.removed_count;
		uint32_t layers = 0;
		heat_edges(session, tool);
		cau_dissection_part(&session->dissection, &layers); // section 6.1
		cau_session_take_out(session, first);
		cau_shrink_expose(&session->shrink, &session->dissection, first, session->vertices.position,
		                  &tool->state.definition, &tool->state.pose, tool->state.jaw,
		                  &session->solver.elements, &session->solver.slots); // eq. 21
		tool->state.touched_layers = (int32_t)layers;
	}
}

void cau_session_end_burn(cau_session *session)
{
	cau_session_mark_changed(session); // energy.c
	cau_shrink_advance(&session->shrink, &session->tissue, session->solver.step_s,
	                   &session->solver.elements, &session->solver.slots);
}

// ---- tears

// Tears the elements that a tick's stretch breaks (dissect/tears.c). As with parted elements, a
// torn element leaves the local step at once and the factor in its turn. Nothing shrinks beside a
// tear.

// Whether the step has converged. Stretches of an unfinished iterate may be far too large.
static bool has_converged(const cau_session *session)
{
	const cau_accuracy *accuracy = &session->solver.accuracy;
	return accuracy->error <= accuracy->wanted;
}

void cau_session_tear(cau_session *session)
{
	int32_t first = session->dissection.removed_count;
	cau_dissection_tear(&session->dissection, session->vertices.position, has_converged(session),
	                    session->pool);
	cau_session_take_out(session, first);
}
