// SPDX-License-Identifier: GPL-3.0-or-later
// Commands are checked when submitted, queued in order, and applied at tick borders.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"
#include "tissue/tissue.h"

// ---- submission
// Checks a SET_MATERIAL. Region 0 is always accepted: it means the layer's default if the layer's
// mesh has no region 0.
static cau_status check_material(const cau_session *session, const cau_command *command,
                                 cau_error *error)
{
	int kind = command->as.material.kind;
	bool fat = kind == CAU_LAYER_FAT, links = kind == CAU_LAYER_LINKS;
	const void *material = fat     ? (const void *)&command->as.material.fat
	                       : links ? (const void *)&command->as.material.link
	                               : (const void *)&command->as.material.sheet;
	cau_status status = cau_material_check(kind, material, "material", error);
	int32_t index = cau_tissue_find_layer(&session->tissue, command->as.material.layer);
	int32_t region = fat ? command->as.material.fat.region : command->as.material.sheet.region;
	if (status || links || !region || index < 0)
		return status;
	const cau_tissue_layer *layer = &session->tissue.layer[index];
	return cau_region_list_check(&layer->regions, layer->def.name, region, "material.region",
	                             error);
}

cau_status cau_command_check(const cau_session *session, const cau_command *command,
                             cau_error *error)
{
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
		return cau_tool_check(&command->as.definition, "definition", session->solver.step_s, error);
	case CAU_COMMAND_TOOL_CONFIGURE: {
		// The tool's name is in `tool`, not in the definition.
		cau_tool_def named = command->as.definition;
		memcpy(named.name, command->tool, sizeof named.name);
		return cau_tool_check(&named, "definition", session->solver.step_s, error);
	}
	case CAU_COMMAND_TOOL_MOVE:
		if (!(command->as.move.jaw >= 0 && command->as.move.jaw <= 1))
			return cau_fail(error, CAU_BAD_VALUE, "jaw", "%g is not between 0 and 1",
			                command->as.move.jaw);
		return cau_pose_check(&command->as.move.pose, "pose", error);
	case CAU_COMMAND_TOOL_ENERGIZE:
		if (command->as.energized && command->as.ticks < 0)
			return cau_fail(error, CAU_BAD_VALUE, "ticks", "%d is below 0", command->as.ticks);
		return CAU_OK;
	case CAU_COMMAND_PIN:
	case CAU_COMMAND_UNPIN:
		return cau_selection_check(&command->as.selection, "selection", error);
	case CAU_COMMAND_SET_MATERIAL:
		return check_material(session, command, error);
	case CAU_COMMAND_SET_GRAVITY:
		for (int c = 0; c < 3; c++)
			if (!(fabs(command->as.gravity_m_s2[c]) <= CAU_GRAVITY_MOST_M_S2))
				return cau_fail(error, CAU_BAD_VALUE, "gravity_m_s2", "%g is not within %g m/s^2",
				                command->as.gravity_m_s2[c], CAU_GRAVITY_MOST_M_S2);
		return CAU_OK;
	case CAU_COMMAND_SET_FORCE:
		for (int c = 0; c < 3; c++)
			if (!(fabs(command->as.force.force_n[c]) <= CAU_FORCE_MOST_N))
				return cau_fail(error, CAU_BAD_VALUE, "force_n", "%g is not within %g N",
				                command->as.force.force_n[c], CAU_FORCE_MOST_N);
		return cau_selection_check(&command->as.force.selection, "selection", error);
	default:
		return CAU_OK;
	}
}

static bool is_added(const cau_session *session, const char *tool)
{
	for (int32_t k = 0; k < session->queue.count; k++)
		if (session->queue.command[k].kind == CAU_COMMAND_TOOL_ADD &&
		    strcmp(session->queue.command[k].as.definition.name, tool) == 0)
			return true;
	return cau_session_find_tool(session, tool) >= 0;
}

// True for an energy-off or a hold that is due: such a command acts at once and needs no capacity
// in the queue (still.c). If its tool does not exist, the command is queued, and the tick refuses
// it.
static bool acts_at_once(cau_session *session, const cau_command *command)
{
	bool off = command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized;
	bool hold = command->kind == CAU_COMMAND_TOOL_HOLD;
	if (!(off || hold) || command->tick > session->tick)
		return false;
	if (off)
		cau_session_energy_off(session, command->tool, command->sequence);
	else
		cau_session_hold_still(session, command->tool, command->sequence);
	return is_added(session, command->tool);
}

static cau_status check(const cau_session *session, const cau_command *command, cau_error *error)
{
	if (command->kind < 0 || command->kind >= CAU_COMMAND_COUNT)
		return cau_fail(error, CAU_BAD_VALUE, "command", "no command has the number %d",
		                command->kind);
	return cau_command_check(session, command, error);
}

cau_status cau_session_may_submit(const cau_session *session, const cau_command *commands,
                                  int32_t count, int32_t *index, cau_error *error)
{
	CAU_ASSERT(count >= 0, "%d commands", count);
	for (*index = 0; *index < count; ++*index) {
		cau_status status = check(session, &commands[*index], error);
		if (status)
			return status;
		if (session->queue.count + *index >= session->queue.capacity)
			return cau_fail(error, CAU_LIMIT, NULL,
			                "%d commands are waiting already, which is the limit",
			                session->queue.count);
	}
	return CAU_OK;
}

cau_status cau_session_submit(cau_session *session, const cau_command *command, cau_error *error)
{
	cau_status status = check(session, command, error);
	if (status)
		return status;
	if (acts_at_once(session, command))
		return CAU_OK;
	if (session->queue.count == session->queue.capacity)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "%d commands are waiting already, which is the limit",
		                session->queue.count);
	cau_command *queued = &session->queue.command[session->queue.count++];
	*queued = *command;
	if (queued->kind == CAU_COMMAND_TOOL_ENERGIZE && !queued->as.energized)
		queued->as.ticks = 0; // only an enable has `ticks`
	return CAU_OK;
}

// ---- application
// True if the tool's heat grid and grasp also suit the new definition. They depend only on the
// members that are compared here.
static bool has_form(const cau_tool_def *now, const cau_tool_def *def)
{
	return now->shape == def->shape && now->hot_radius_m == def->hot_radius_m &&
	       now->tip_length_m == def->tip_length_m && now->shaft_radius_m == def->shaft_radius_m &&
	       now->shaft_length_m == def->shaft_length_m && now->jaw_open_rad == def->jaw_open_rad &&
	       now->grid_cells == def->grid_cells && now->grid_step_m == def->grid_step_m &&
	       now->diffusivity_m2_s == def->diffusivity_m2_s;
}

// Gives the tool another shape or other sizes. The heat grid is created again, cold, and the jaws
// open.
static cau_status change_form(cau_session *session, cau_tool *tool, const cau_tool_def *def,
                              cau_error *error)
{
	cau_heat_grid grid;
	cau_status status = cau_heat_grid_create(&grid, def, session->scene->ambient_c,
	                                         session->solver.step_s, &tool->state.pose, error);
	if (status)
		return status;
	cau_heat_grid_finish(&tool->grid);
	tool->grid = grid;
	cau_session_release(tool);
	return CAU_OK;
}

static cau_status configure_tool(cau_session *session, cau_tool *tool, const cau_tool_def *def,
                                 cau_error *error)
{
	cau_tool_def *now = &tool->state.definition;
	if (!has_form(now, def)) {
		cau_status status = change_form(session, tool, def, error);
		if (status)
			return status;
	}
	double blade_c = tool->blade.temperature_c;
	tool->blade = cau_session_blade_of(session, def);
	tool->blade.temperature_c = blade_c;
	cau_pose pose = now->pose;
	*now = *def;
	now->pose = pose;
	memcpy(now->name, tool->state.name, sizeof now->name);
	return CAU_OK;
}

static cau_status apply_to_tool(cau_session *session, const cau_command *command, cau_error *error)
{
	CAU_ASSERT(command->tool[0] != 0, "command %d is for no tool", command->kind);
	int32_t index = cau_session_find_tool(session, command->tool);
	if (index < 0)
		return cau_fail(error, CAU_NOT_FOUND, "tool", "there is no tool \"%s\"", command->tool);
	cau_tool *tool = &session->tool[index];
	bool ends = command->kind == CAU_COMMAND_TOOL_HOLD ||
	            (command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized);
	if (command->sequence || !ends) // commands of the server itself have sequence 0
		tool->state.sequence = command->sequence;
	switch (command->kind) {
	case CAU_COMMAND_TOOL_REMOVE:
		cau_session_drop_tool(session, index);
		return CAU_OK;
	case CAU_COMMAND_TOOL_CONFIGURE:
		return configure_tool(session, tool, &command->as.definition, error);
	case CAU_COMMAND_TOOL_MOVE:
		tool->target = command->as.move.pose;
		if (!tool->state.grasping)
			tool->jaw_target = command->as.move.jaw;
		return CAU_OK;
	case CAU_COMMAND_TOOL_ENERGIZE:
		if (!tool->state.energized)
			tool->least_ohm = 0;
		tool->state.energized = command->as.energized != 0;
		return CAU_OK;
	case CAU_COMMAND_TOOL_GRASP:
		return tool->state.grasping ? CAU_OK : cau_session_grasp(session, tool, error);
	case CAU_COMMAND_TOOL_HOLD:
		cau_session_stay(tool);
		return CAU_OK;
	default:
		cau_session_release(tool);
		return CAU_OK;
	}
}

static cau_status set_material(cau_session *session, const cau_command *command, cau_error *error)
{
	int32_t index = cau_tissue_find_layer(&session->tissue, command->as.material.layer);
	if (index < 0)
		return cau_fail(error, CAU_NOT_FOUND, "layer", "there is no layer \"%s\"",
		                command->as.material.layer);
	cau_layer_def changed = session->tissue.layer[index].def;
	if (!cau_layer_take_material(&changed, command))
		return cau_fail(error, CAU_BAD_VALUE, "kind", "layer \"%s\" is of another kind of tissue",
		                changed.name);
	if (cau_session_has_material(session, command))
		return CAU_OK;
	cau_matrix_update_stop(&session->update); // the factorisation in progress reads the materials
	session->tissue.layer[index].def = changed;
	cau_elements_set_materials(&session->solver.elements, &session->solver.slots, &session->tissue,
	                           session->dissection.alive.element, session->shrink.shrunk);
	session->solver.settings.conservative =
		cau_solver_is_conservative(&session->tissue, session->solver.settings.diagonal);
	session->energy.stale = true;
	return cau_matrix_update_refactor(&session->update, &session->dissection.alive, error);
}

static cau_status set_force(cau_session *session, const cau_command *command, cau_error *error)
{
	memset(session->vertices.chosen, 0, (size_t)session->tissue.vertex_count);
	int32_t count =
		cau_tissue_select(&session->tissue, &command->as.force.selection, session->vertices.chosen);
	if (count <= 0)
		return cau_fail(error, CAU_NOT_FOUND, "selection", "no vertex lies in this selection");
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		if (session->vertices.chosen[v])
			memcpy(session->vertices.external + 3 * (size_t)v, command->as.force.force_n,
			       3 * sizeof(double));
	return CAU_OK;
}

static cau_status apply(cau_session *session, const cau_command *command, cau_error *error)
{
	CAU_ASSERT(command->tick <= session->tick, "a command for tick %llu at tick %llu",
	           (unsigned long long)command->tick, (unsigned long long)session->tick);
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
		return cau_session_add_tool(session, &command->as.definition, error);
	case CAU_COMMAND_PIN:
	case CAU_COMMAND_UNPIN:
		return cau_session_set_pins(session, &command->as.selection,
		                            command->kind == CAU_COMMAND_PIN, error);
	case CAU_COMMAND_SET_MATERIAL:
		return set_material(session, command, error);
	case CAU_COMMAND_SET_GRAVITY:
		memcpy(session->scene->gravity_m_s2, command->as.gravity_m_s2, 3 * sizeof(double));
		return CAU_OK;
	case CAU_COMMAND_SET_FORCE:
		return set_force(session, command, error);
	default:
		return apply_to_tool(session, command, error);
	}
}

// Removes the kept commands that wait for a later tick and would undo this command. Returns how
// many of `kept` remain.
static int32_t void_older(cau_session *session, const cau_command *command, int32_t kept)
{
	CAU_ASSERT(kept >= 0 && kept <= session->queue.count, "%d commands kept of %d", kept,
	           session->queue.count);
	if (command->kind == CAU_COMMAND_TOOL_ENERGIZE)
		return cau_session_void(session->queue.command, kept, command->tool,
		                        command->as.energized ? CAU_VOID_LIMITS : CAU_VOID_ENABLES);
	if (command->kind == CAU_COMMAND_TOOL_REMOVE || command->kind == CAU_COMMAND_TOOL_HOLD)
		return cau_session_void(session->queue.command, kept, command->tool, CAU_VOID_ALL);
	return kept;
}

// Applies the commands that are due. A command that does not suit the present state is refused and
// reported. Only a numerical error or lack of memory ends the step.
cau_status cau_session_apply_commands(cau_session *session, cau_error *error)
{
	cau_status status = CAU_OK;
	int32_t kept = 0;
	for (int32_t k = 0; k < session->queue.count; k++) {
		const cau_command command = session->queue.command[k];
		if (status || command.tick > session->tick) {
			session->queue.command[kept++] = command;
			continue;
		}
		cau_error refusal = {0};
		kept = void_older(session, &command, kept);
		cau_status applied = apply(session, &command, &refusal);
		if (!applied &&
		    cau_session_limit_energy(&command, session->tick, &session->queue.command[kept]))
			kept++; // the end of the enable takes the queue slot of the enable, or of a command
			        // before it
		if (applied == CAU_NUMERICAL || applied == CAU_NO_MEMORY) {
			status = applied;
			if (error)
				*error = refusal;
		} else if (applied && session->queue.refusal_count < CAU_MAX_REFUSALS) {
			session->queue.refusal[session->queue.refusal_count++] = refusal;
		}
	}
	session->queue.count = kept;
	return status;
}
