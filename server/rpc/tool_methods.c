// SPDX-License-Identifier: GPL-3.0-or-later
// The methods for tissue commands, for the driver of a tool, and session.advance, which has
// commands.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "hosted_session/order.h"
#include "rpc/internal.h"

// ---- tissue commands and the driver of a tool
void cau_call_command(cau_call *call)
{
	cau_error error = {0};
	cau_order *order = cau_call_order(call, CAU_ORDER_COMMAND);
	if (!order)
		return;
	if (cau_rpc_command(call->message, &order->as.command, &error)) {
		cau_call_fail(call, &error, 0);
		free(order);
		return;
	}
	order->motion = call->message->kind == CAU_RPC_NOTIFICATION;
	cau_call_submit(call, order);
}

static void submit_about_tool(const cau_call *call, cau_order_kind kind)
{
	cau_wire_tool_ref params = {0};
	cau_order *order = cau_call_order_with(call, kind, &params);
	if (!order)
		return;
	memcpy(order->as.tool.tool, params.tool, sizeof order->as.tool.tool);
	cau_call_submit(call, order);
}

void cau_call_tool_take_over(cau_call *call)
{
	submit_about_tool(call, CAU_ORDER_TAKE_OVER);
}

void cau_call_tool_request_takeover(cau_call *call)
{
	submit_about_tool(call, CAU_ORDER_REQUEST_TAKEOVER);
}

// Sets the client that gets the tool. Without a client in the params, the tool becomes free.
static cau_status choose_next(const cau_call *call, const cau_wire_tool_hand_over *params,
                              cau_order *order, cau_error *error)
{
	cau_asker to;
	if (!params->has_client)
		return CAU_OK;
	if (!cau_hub_find_client(call->peer->service->hub, (uint32_t)params->client, &to) ||
	    to.role < CAU_ROLE_OPERATE)
		return cau_fail(error, CAU_NOT_FOUND, "params.client",
		                "no such client in this session, or its role is below operate");
	order->as.tool.to = to.client;
	memcpy(order->as.tool.to_name, to.name, sizeof order->as.tool.to_name);
	order->as.tool.to_deadline_s = to.deadline_s;
	order->as.tool.to_role = to.role;
	return CAU_OK;
}

void cau_call_tool_hand_over(cau_call *call)
{
	cau_error error = {0};
	cau_wire_tool_hand_over params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_HAND_OVER, &params);
	if (!order)
		return;
	memcpy(order->as.tool.tool, params.tool, sizeof order->as.tool.tool);
	if (choose_next(call, &params, order, &error)) {
		cau_call_fail(call, &error, 0);
		free(order);
		return;
	}
	cau_call_submit(call, order);
}

// ---- session.advance
// Turns the params into one order. Everything that the params request follows the order in the same
// memory.

// Memory into which the params are read.
typedef struct wanted {
	cau_wire_session_advance params;
	cau_wire_advance_command commands[CAU_ADVANCE_COMMANDS];
	int64_t vertices[CAU_ADVANCE_VERTICES];
	cau_wire_observed_region regions[CAU_ADVANCE_REGIONS];
} wanted;

// ---- commands -----------------------------------------------------------------------------------

static cau_status fail_at(cau_error *error, int32_t index, const char *list, const char *member,
                          const char *reason)
{
	cau_fail(error, CAU_BAD_VALUE, "", "%s", reason);
	snprintf(error->path, sizeof error->path, "params.%s[%d]%s%s", list, index, *member ? "." : "",
	         member);
	return CAU_BAD_VALUE;
}

// Returns the name of a member that belongs to another method; NULL if there is none.
static const char *odd_member(const cau_wire_advance_command *from)
{
	bool moves = from->method == CAU_ADVANCE_TOOL_MOVE;
	bool energizes = from->method == CAU_ADVANCE_TOOL_ENERGIZE;
	const struct {
		bool has, may;
		const char *name;
	} members[] = {{from->has_position_m, moves, "position_m"},
	               {from->has_rotation, moves, "rotation"},
	               {from->has_jaw, moves, "jaw"},
	               {from->has_energized, energizes, "energized"},
	               {from->has_ticks, energizes, "ticks"}};
	for (size_t i = 0; i < sizeof members / sizeof *members; i++)
		if (members[i].has && !members[i].may)
			return members[i].name;
	return NULL;
}

static bool read_rotation(const double from[4], double to[4])
{
	double square = 0;
	for (int i = 0; i < 4; i++)
		square += from[i] * from[i];
	double length = sqrt(square);
	for (int i = 0; i < 4; i++)
		to[i] = from[i] / length;
	return fabs(length - 1) <= CAU_UNIT_TOLERANCE;
}

static cau_status read_move(const cau_wire_advance_command *from, int32_t index, cau_command *to,
                            cau_error *error)
{
	if (!from->has_position_m)
		return fail_at(error, index, "commands", "position_m",
		               "missing: tool.move needs this member");
	if (!from->has_rotation)
		return fail_at(error, index, "commands", "rotation",
		               "missing: tool.move needs this member");
	memcpy(to->as.move.pose.position_m, from->position_m, sizeof from->position_m);
	to->as.move.jaw = from->has_jaw ? from->jaw : 0;
	if (!read_rotation(from->rotation, to->as.move.pose.rotation))
		return fail_at(error, index, "commands", "rotation", "not a unit quaternion");
	return CAU_OK;
}

static cau_status read_command(const cau_wire_advance_command *from, int32_t index, cau_command *to,
                               cau_error *error)
{
	static const int kinds[CAU_ADVANCE_METHOD_COUNT] = {
#define X(code, name) [CAU_ADVANCE_##code] = CAU_COMMAND_##code,
		CAU_ADVANCE_METHOD_TABLE(X)
#undef X
	};
	const char *odd = odd_member(from);
	if (odd)
		return fail_at(error, index, "commands", odd, "this method has no such member");
	cau_default_command(to, kinds[from->method]);
	memcpy(to->tool, from->tool, sizeof to->tool);
	to->sequence = from->has_sequence ? (uint64_t)from->sequence : 0;
	if (from->method == CAU_ADVANCE_TOOL_MOVE)
		return read_move(from, index, to, error);
	if (from->method != CAU_ADVANCE_TOOL_ENERGIZE)
		return CAU_OK;
	if (!from->has_energized)
		return fail_at(error, index, "commands", "energized",
		               "missing: tool.energize needs this member");
	to->as.energized = from->energized;
	to->as.ticks = from->has_ticks && from->energized ? (int32_t)from->ticks : 0;
	return CAU_OK;
}

// Checks that each tool's energy is in one command only, and that the commands name no more tools
// than a session can have.
static cau_status check_tools(const cau_advance *advance, int32_t index, cau_error *error)
{
	const cau_command *newest = &advance->commands[index];
	int32_t tools = 1;
	for (int32_t i = 0; i < index; i++) {
		const cau_command *older = &advance->commands[i];
		bool first = true;
		for (int32_t k = 0; k < i; k++)
			first = first && strcmp(advance->commands[k].tool, older->tool) != 0;
		tools += first && strcmp(older->tool, newest->tool) != 0;
		if (newest->kind == CAU_COMMAND_TOOL_ENERGIZE && older->kind == newest->kind &&
		    strcmp(newest->tool, older->tool) == 0)
			return fail_at(
				error, index, "commands", "tool",
				"an earlier command of this request sets the energy of this tool already");
	}
	if (tools > CAU_MAX_TOOLS)
		return fail_at(error, index, "commands", "tool", "a session has at most 8 tools");
	return CAU_OK;
}

static cau_status read_commands(const wanted *from, cau_advance *to, cau_error *error)
{
	cau_status status = CAU_OK;
	for (int32_t i = 0; i < to->command_count && !status; i++) {
		status = read_command(&from->commands[i], i, &to->commands[i], error);
		if (!status)
			status = check_tools(to, i, error);
	}
	return status;
}

// ---- observations -------------------------------------------------------------------------------

static cau_status read_region(const cau_wire_observed_region *from, int32_t index,
                              cau_advance_region *to, cau_error *error)
{
	bool box = from->has_least_m || from->has_most_m;
	bool ball = from->has_center_m || from->has_radius_m;
	bool whole =
		box ? from->has_least_m && from->has_most_m : from->has_center_m && from->has_radius_m;
	if (box == ball || !whole)
		return fail_at(
			error, index, "observe.regions", "",
			"a region needs least_m and most_m (a box), or center_m and radius_m (a ball)");
	memcpy(to->name, from->name, sizeof to->name);
	to->where = (cau_selection){.kind = box ? CAU_SELECT_BOX : CAU_SELECT_SPHERE,
	                            .radius_m = from->radius_m};
	memcpy(to->where.least_m, from->least_m, sizeof from->least_m);
	memcpy(to->where.most_m, from->most_m, sizeof from->most_m);
	memcpy(to->where.center_m, from->center_m, sizeof from->center_m);
	return CAU_OK;
}

static cau_status read_observed(const wanted *from, cau_advance *to, cau_error *error)
{
	const cau_wire_observe *observe = &from->params.observe;
	cau_status status = CAU_OK;
	to->channels = observe->has_channels ? observe->channels : 0;
	to->chosen = observe->has_vertices;
	to->energy = observe->has_energy && observe->energy;
	if (to->channels & CAU_CHANNEL_STATISTICS)
		return cau_fail(error, CAU_BAD_VALUE, "params.observe.channels",
		                "`statistics` is only in frames: call session.join");
	for (int32_t i = 0; i < to->vertex_count; i++)
		to->vertices[i] = (int32_t)from->vertices[i];
	for (int32_t i = 0; i < to->region_count && !status; i++)
		status = read_region(&from->regions[i], i, &to->regions[i], error);
	return status;
}

// ---- the order ----------------------------------------------------------------------------------

static cau_status read_params(const cau_call *call, wanted *to, cau_error *error)
{
	to->params.commands = (cau_wire_list){to->commands, 0, CAU_ADVANCE_COMMANDS};
	to->params.observe.vertices = (cau_wire_list){to->vertices, 0, CAU_ADVANCE_VERTICES};
	to->params.observe.regions = (cau_wire_list){to->regions, 0, CAU_ADVANCE_REGIONS};
	return cau_rpc_params(call->message, &to->params, error);
}

// Makes the order. The advance, its commands and its vertices follow the order in the same memory.
static cau_order *make_order(const cau_call *call, const wanted *from)
{
	const cau_wire_session_advance *params = &from->params;
	int32_t commands = params->has_commands ? params->commands.count : 0;
	int32_t vertices =
		params->has_observe && params->observe.has_vertices ? params->observe.vertices.count : 0;
	size_t bytes = sizeof(cau_advance) + (size_t)commands * sizeof(cau_command) +
	               (size_t)vertices * sizeof(int32_t);
	cau_order *order = cau_call_order_of(call, CAU_ORDER_ADVANCE, bytes);
	if (!order)
		return NULL;
	cau_advance *made = (cau_advance *)(void *)(order + 1);
	order->as.advance = made;
	made->ticks = params->has_ticks ? params->ticks : 1;
	made->command_count = commands;
	made->vertex_count = vertices;
	made->region_count =
		params->has_observe && params->observe.has_regions ? params->observe.regions.count : 0;
	made->commands = (cau_command *)(void *)(made + 1);
	made->vertices = (int32_t *)(void *)(made->commands + commands);
	return order;
}

void cau_call_session_advance(cau_call *call)
{
	cau_error error = {0};
	cau_order *order = NULL;
	wanted *from = calloc(1, sizeof *from);
	cau_status status = from ? read_params(call, from, &error)
	                         : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the request");
	if (!status) {
		order = make_order(call, from);
		status = order ? read_commands(from, order->as.advance, &error) : CAU_NO_MEMORY;
		if (order && !status)
			status = read_observed(from, order->as.advance, &error);
	}
	if (order && !status) {
		cau_call_submit(call, order);
	} else if (order || error.status) { // else the call is already answered
		cau_call_fail(call, &error, 0);
		free(order);
	}
	free(from);
}
