// SPDX-License-Identifier: GPL-3.0-or-later
// Turns samples into orders: checks who may move a tool, and treats energy and grasp as levels.
#include <string.h>

#include "transport_dds/internal.h"

#define CLAIM_S 0.1 // a claim that waits in the queue is not repeated within this time, s

// ---- the driver of a tool
// Returns the hand of a DDS client that drives this tool and has been silent for its deadline; NULL
// if there is none.
static cau_dds_hand *silent_driver(const cau_dds_tool *tool, uint32_t driver, double now_s)
{
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		if (hand->client->asker.client == driver &&
		    now_s - hand->past.pose_s > hand->client->asker.deadline_s)
			return hand;
	return NULL;
}

// True if another client's claim to the tool waits in the session's queue.
static bool is_claimed(const cau_dds_tool *tool, const cau_dds_client *client, double now_s)
{
	for (const cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		if (hand->client != client && now_s < hand->claim_until_s)
			return true;
	return false;
}

// True if this client is the driver, or would become the driver by a motion. `client` is NULL for a
// writer that is not a client yet.
static bool would_drive(const cau_dds_tool *tool, const cau_dds_client *client, uint32_t driver,
                        double now_s)
{
	if (client && client->asker.client == driver)
		return true;
	return (!driver || silent_driver(tool, driver, now_s)) && !is_claimed(tool, client, now_s);
}

static bool ask_for_tool(cau_dds_hand *hand, cau_dds_hand *silent)
{
	if (silent)
		return cau_dds_hand_over(silent, &hand->client->asker);
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
	if (order)
		memcpy(order->as.tool.tool, hand->tool->name, sizeof hand->tool->name);
	return order && cau_dds_submit(hand, order);
}

// Returns CAU_OK if the hand's client drives the tool, or will before the next submitted order
// takes effect.
static cau_status claim(cau_dds_hand *hand, const cau_hosted_tool *tool, double now_s,
                        cau_error *error)
{
	uint32_t driver = tool->driver.client;
	if (driver == hand->client->asker.client) {
		hand->claim_until_s = 0;
		return CAU_OK;
	}
	if (now_s < hand->claim_until_s)
		return CAU_OK;
	hand->claim_until_s = 0;
	if (!would_drive(hand->tool, hand->client, driver, now_s))
		return cau_fail(error, CAU_BAD_STATE, "tool", "%s drives the tool",
		                driver ? tool->driver.name : "another DDS client, which asked earlier,");
	if (!ask_for_tool(hand, driver ? silent_driver(hand->tool, driver, now_s) : NULL))
		return cau_fail(error, CAU_LIMIT, "tool", "the session takes no orders at the moment");
	hand->claim_until_s = now_s + CLAIM_S;
	hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	hand->grasp_asked = tool->state.grasping;
	return CAU_OK;
}

// Checks a motion and its writer's permission, before the writer may become a client.
static cau_status check_motion(const cau_door *door, const cau_dds_writer *writer,
                               const cau_dds_tool *tool, cau_dds_motion *motion,
                               cau_hosted_tool *state, cau_error *error)
{
	cau_status status = cau_motion_check_pose(&motion->pose, motion->jaw, error);
	if (status)
		return status;
	if (!cau_hosted_find_tool(door->session->hosted, tool->name, state))
		return cau_fail(error, CAU_NOT_FOUND, "tool", "there is no such tool");
	status = cau_dds_check_role(writer, error);
	return status ? status : cau_dds_check_ready(door->session, tool->name, error);
}

static void note_motion(cau_dds_hand *hand, const cau_dds_motion *motion, double now_s)
{
	hand->past.has_pose = true;
	hand->past.pose = motion->pose;
	hand->past.pose_s = now_s;
	hand->past.sequence = motion->sequence;
	hand->past.source_time_ns = motion->source_time_ns;
	hand->jaw = motion->jaw;
	hand->client->accepted = true;
}

cau_dds_hand *cau_dds_move(cau_dds *dds, const cau_door *door, cau_dds_tool *tool,
                           cau_dds_writer *writer, cau_dds_motion motion)
{
	cau_error error = {0};
	cau_hosted_tool state;
	cau_dds_hand *hand = NULL;
	double now_s = cau_monotonic_s();
	cau_status status = check_motion(door, writer, tool, &motion, &state, &error);
	if (!status) {
		bool now = would_drive(tool, writer->client, state.driver.client, now_s);
		hand = cau_dds_take_hand(dds, writer, door->session, tool, now, &error);
		if (hand)
			hand->client->alive_s = writer->sign.alive_s;
		// CAU_LIMIT, or no memory: `error` says which
		status = hand ? claim(hand, &state, now_s, &error) : CAU_LIMIT;
	}
	if (!status)
		status = cau_motion_check_leap(&hand->past, &motion.pose, now_s, &state.state.definition,
		                               &error);
	if (status) {
		cau_dds_refuse(door->session, tool->name, writer, motion.sequence, &error);
		return NULL;
	}
	if (!cau_dds_order_move(hand, &motion.pose, motion.jaw, motion.sequence))
		return NULL;
	note_motion(hand, &motion, now_s);
	cau_hosted_feed_tool(door->session->hosted, hand->client->asker.client, tool->name,
	                     writer->sign.alive_s);
	return hand;
}

// ---- levels
static bool may_drive(const cau_dds_hand *hand)
{
	cau_hosted_tool tool;
	return cau_hosted_find_tool(hand->session->hosted, hand->tool->name, &tool) &&
	       (tool.driver.client == hand->client->asker.client ||
	        cau_monotonic_s() < hand->claim_until_s);
}

void cau_dds_energy(cau_dds_hand *hand, const cau_dds_writer *writer, bool level, int32_t ticks)
{
	if (!level) {
		hand->energy_ready = true;
		if (hand->energy_asked && may_drive(hand))
			hand->energy_asked = !cau_dds_order_command(hand, CAU_COMMAND_TOOL_ENERGIZE,
			                                            CAU_METHOD_TOOL_ENERGIZE, false);
		return;
	}
	cau_error error = {0};
	if (!hand->energy_ready)
		return;
	cau_status status = cau_dds_check_ready(hand->session, hand->tool->name, &error);
	if (!status && !may_drive(hand))
		status =
			cau_fail(&error, CAU_BAD_STATE, "tool", "only the driver of a tool may turn energy on");
	if (status) {
		hand->energy_ready = false;
		cau_dds_refuse(hand->session, hand->tool->name, writer, hand->past.sequence, &error);
		return;
	}
	hand->energy_asked = cau_dds_order_energy(hand, ticks);
	hand->energy_ready = !hand->energy_asked;
}

void cau_dds_grasp(cau_dds_hand *hand, bool level)
{
	if (level == hand->grasp_asked)
		return;
	bool asked =
		level
			? cau_dds_order_command(hand, CAU_COMMAND_TOOL_GRASP, CAU_METHOD_TOOL_GRASP, true)
			: cau_dds_order_command(hand, CAU_COMMAND_TOOL_RELEASE, CAU_METHOD_TOOL_RELEASE, false);
	if (asked)
		hand->grasp_asked = level;
}
