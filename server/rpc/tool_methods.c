// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue commands, and who drives a tool.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

static bool is_about_tool(int kind)
{
	return kind >= CAU_COMMAND_TOOL_REMOVE && kind <= CAU_COMMAND_TOOL_RELEASE;
}

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
	if (is_about_tool(order->as.command.kind)) { // any message about a tool is a sign of life
		cau_hosted *hosted = cau_call_session(call);
		if (!hosted) {
			free(order);
			return;
		}
		cau_hosted_feed(hosted, order->asker.client);
		cau_hosted_release(hosted);
	}
	cau_call_submit(call, order);
}

static cau_status read_tool(const cau_call *call, cau_order *order, cau_error *error)
{
	cau_wire_tool_ref params = {0};
	cau_status status = cau_rpc_params(call->message, &params, error);
	memcpy(order->as.tool.tool, params.tool, sizeof order->as.tool.tool);
	return status;
}

static cau_status read_hand_over(const cau_call *call, cau_order *order, cau_error *error)
{
	cau_wire_tool_hand_over params = {0};
	cau_asker to;
	cau_status status = cau_rpc_params(call->message, &params, error);
	memcpy(order->as.tool.tool, params.tool, sizeof order->as.tool.tool);
	if (status || !params.has_client)
		return status;
	if (!cau_hub_find_client(call->peer->service->hub, (uint32_t)params.client, &to) ||
	    to.role < CAU_ROLE_OPERATE)
		return cau_fail(error, CAU_NOT_FOUND, "params.client",
		                "no such client, or it may not operate");
	order->as.tool.to = to.client;
	memcpy(order->as.tool.to_name, to.name, sizeof order->as.tool.to_name);
	order->as.tool.to_deadline_s = to.deadline_s;
	order->as.tool.to_role = to.role;
	return CAU_OK;
}

void cau_call_tool_order(cau_call *call)
{
	cau_error error = {0};
	cau_method method = call->message->method;
	cau_order_kind kind = method == CAU_METHOD_TOOL_TAKE_OVER   ? CAU_ORDER_TAKE_OVER
	                      : method == CAU_METHOD_TOOL_HAND_OVER ? CAU_ORDER_HAND_OVER
	                                                            : CAU_ORDER_REQUEST_TAKEOVER;
	cau_order *order = cau_call_order(call, kind);
	if (!order)
		return;
	cau_status status = kind == CAU_ORDER_HAND_OVER ? read_hand_over(call, order, &error)
	                                                : read_tool(call, order, &error);
	if (status) {
		cau_call_fail(call, &error, 0);
		free(order);
		return;
	}
	cau_call_submit(call, order);
}
