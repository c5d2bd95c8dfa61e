// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the orders of a hand and submits them to its session.
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "transport_dds/internal.h"

bool cau_dds_submit(const cau_dds_hand *hand, cau_order *order)
{
	cau_error error = {0};
	if (!cau_hosted_submit(hand->session->hosted, order, &error))
		return true;
	cau_log(CAU_LOG_WARNING, cau_hosted_id(hand->session->hosted), "dds_order_lost",
	        "tool=%s reason=\"%s\"", hand->tool->name, error.reason);
	free(order);
	return false;
}

cau_order *cau_dds_make_order(const cau_dds_hand *hand, cau_order_kind kind, cau_method method)
{
	cau_order *order = calloc(1, sizeof *order);
	if (order) {
		order->kind = kind;
		order->asker = hand->client->asker;
		order->alive_s = hand->client->alive_s;
		order->reply.method = method;
	}
	return order;
}

bool cau_dds_order_command(const cau_dds_hand *hand, int kind, cau_method method, bool on)
{
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_COMMAND, method);
	if (!order)
		return false;
	cau_default_command(&order->as.command, kind);
	memcpy(order->as.command.tool, hand->tool->name, sizeof hand->tool->name);
	order->as.command.sequence = hand->past.sequence;
	if (kind == CAU_COMMAND_TOOL_ENERGIZE)
		order->as.command.as.energized = on;
	return cau_dds_submit(hand, order);
}

bool cau_dds_order_energy(const cau_dds_hand *hand, int32_t ticks)
{
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	if (!order)
		return false;
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	memcpy(order->as.command.tool, hand->tool->name, sizeof hand->tool->name);
	order->as.command.sequence = hand->past.sequence;
	order->as.command.as.energized = 1;
	order->as.command.as.ticks = ticks > 0 ? ticks : 0;
	return cau_dds_submit(hand, order);
}

bool cau_dds_hand_over(cau_dds_hand *hand, const cau_asker *to)
{
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_HAND_OVER, CAU_METHOD_TOOL_HAND_OVER);
	if (!order)
		return false;
	memcpy(order->as.tool.tool, hand->tool->name, sizeof hand->tool->name);
	if (to) {
		order->as.tool.to = to->client;
		order->as.tool.to_deadline_s = to->deadline_s;
		order->as.tool.to_role = to->role;
		memcpy(order->as.tool.to_name, to->name, sizeof to->name);
	}
	return cau_dds_submit(hand, order);
}

bool cau_dds_order_move(const cau_dds_hand *hand, const cau_pose *pose, double jaw,
                        uint64_t sequence)
{
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_MOVE);
	if (!order)
		return false;
	order->motion = true;
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_MOVE);
	memcpy(order->as.command.tool, hand->tool->name, sizeof hand->tool->name);
	order->as.command.sequence = sequence;
	order->as.command.as.move.pose = *pose;
	order->as.command.as.move.jaw = jaw;
	cau_error error = {0};
	if (!cau_hosted_submit(hand->session->hosted, order, &error))
		return true;
	free(order); // the session has counted the refusal
	return false;
}

// ---- orders of CRTK's states
void cau_dds_stop_tool(cau_dds_session *session, cau_dds_tool *tool, const cau_asker *by)
{
	cau_hosted_tool state;
	cau_dds_client asking = {.asker = *by};
	const cau_dds_hand hand_of_asker = {.client = &asking, .session = session, .tool = tool};
	if (!cau_hosted_find_tool(session->hosted, tool->name, &state))
		return;
	if (state.energized)
		cau_dds_order_command(&hand_of_asker, CAU_COMMAND_TOOL_ENERGIZE, CAU_METHOD_TOOL_ENERGIZE,
		                      false);
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next) {
		if (state.driver.client == hand->client->asker.client)
			cau_dds_order_command(hand, CAU_COMMAND_TOOL_HOLD, CAU_METHOD_TOOL_HOLD, false);
		hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	}
}

void cau_dds_restart_tool(cau_dds_tool *tool)
{
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		hand->past.pose_s = cau_monotonic_s();
}
