// SPDX-License-Identifier: GPL-3.0-or-later
// The methods for tissue commands and for the driver of a tool.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

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
