// SPDX-License-Identifier: GPL-3.0-or-later
// From samples to orders: who may move a tool, what is refused, energy and grasp as levels.
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "transport_dds/internal.h"

#define CLAIM_S 0.1       // a claim in the queue is not repeated for this
#define REFUSALS_TOLD_S 1 // between log lines

static void tell_refused(cau_dds_session *session, const char *tool, const char *client,
                         const cau_error *error)
{
	double now_s = cau_monotonic_s();
	if (now_s - session->refused_told_s < REFUSALS_TOLD_S)
		return;
	cau_log(CAU_LOG_INFO, cau_hosted_id(session->hosted), "dds_refused",
	        "count=%lld tool=%s client=\"%s\" path=%s reason=\"%s\"", (long long)session->refused,
	        tool, client, error->path, error->reason);
	session->refused = 0;
	session->refused_told_s = now_s;
}

void cau_dds_refuse(cau_dds_session *session, const char *tool, const cau_dds_client *client,
                    uint64_t sequence, const cau_error *error)
{
	cau_hosted_refuse(session->hosted, tool, &client->asker, sequence, error);
	session->refused++;
	tell_refused(session, tool, client->asker.name, error);
}

void cau_dds_count_dropped(cau_dds_session *session)
{
	cau_error error = {0};
	uint64_t dropped = cau_dds_keys_take_dropped(&session->keys);
	if (dropped) {
		cau_hosted_count_refused(session->hosted, dropped);
		session->refused += (int64_t)dropped;
		session->drops_untold = true;
	}
	if (!session->drops_untold || session->refused == 0) { // told with others' refusals
		session->drops_untold = false;
		return;
	}
	cau_fail(&error, CAU_LIMIT, "tool", "too many keys that are no tool of the session");
	tell_refused(session, "", "", &error);
	session->drops_untold = session->refused > 0;
}

// ---- orders
static bool submit(const cau_dds_hand *hand, cau_order *order)
{
	cau_error error = {0};
	if (!cau_hosted_submit(hand->session->hosted, order, &error))
		return true;
	cau_log(CAU_LOG_WARNING, cau_hosted_id(hand->session->hosted), "dds_order_lost",
	        "tool=%s reason=\"%s\"", hand->tool, error.reason);
	free(order);
	return false;
}

static cau_order *make_order(const cau_dds_hand *hand, cau_order_kind kind, cau_method method)
{
	cau_order *order = calloc(1, sizeof *order);
	if (order) {
		order->kind = kind;
		order->asker = hand->client->asker;
		order->reply.method = method;
	}
	return order;
}

static bool command(const cau_dds_hand *hand, int kind, cau_method method, bool on)
{
	cau_order *order = make_order(hand, CAU_ORDER_COMMAND, method);
	if (!order)
		return false;
	cau_default_command(&order->as.command, kind);
	memcpy(order->as.command.tool, hand->tool, sizeof hand->tool);
	order->as.command.sequence = hand->past.sequence;
	if (kind == CAU_COMMAND_TOOL_ENERGIZE)
		order->as.command.as.energized = on;
	return submit(hand, order);
}

bool cau_dds_hand_over(cau_dds_hand *hand, const cau_asker *to)
{
	cau_order *order = make_order(hand, CAU_ORDER_HAND_OVER, CAU_METHOD_TOOL_HAND_OVER);
	if (!order)
		return false;
	memcpy(order->as.tool.tool, hand->tool, sizeof hand->tool);
	if (to) {
		order->as.tool.to = to->client;
		order->as.tool.to_deadline_s = to->deadline_s;
		order->as.tool.to_role = to->role;
		memcpy(order->as.tool.to_name, to->name, sizeof to->name);
	}
	return submit(hand, order);
}

// ---- the driver
// The hand of a client of ours that drives this tool and has been silent for its deadline.
static cau_dds_hand *silent_driver(cau_dds *dds, const cau_dds_hand *hand, uint32_t driver,
                                   double now_s)
{
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *other = &dds->hands[i];
		if (other->client && other->client->asker.client == driver &&
		    other->session == hand->session && strcmp(other->tool, hand->tool) == 0 &&
		    now_s - other->past.pose_s > other->client->asker.deadline_s)
			return other;
	}
	return NULL;
}

// True if the hand's client drives the tool, or will before what is submitted next.
static bool drives(cau_dds *dds, cau_dds_hand *hand, const cau_hosted_tool *tool, double now_s,
                   cau_error *error)
{
	uint32_t driver = tool->driver.client;
	if (driver == hand->client->asker.client) {
		hand->claim_until_s = 0;
		return true;
	}
	if (now_s < hand->claim_until_s)
		return true;
	cau_dds_hand *silent = driver ? silent_driver(dds, hand, driver, now_s) : NULL;
	if (driver && !silent) {
		hand->claim_until_s = 0;
		cau_fail(error, CAU_BAD_STATE, "tool", "%s drives it", tool->driver.name);
		return false;
	}
	bool asked;
	if (silent) {
		asked = cau_dds_hand_over(silent, &hand->client->asker);
	} else {
		cau_order *order = make_order(hand, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
		if (order)
			memcpy(order->as.tool.tool, hand->tool, sizeof hand->tool);
		asked = order && submit(hand, order);
	}
	if (!asked) {
		cau_fail(error, CAU_LIMIT, "tool", "the session takes no orders now");
		return false;
	}
	hand->claim_until_s = now_s + CLAIM_S;
	hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	hand->grasp_asked = tool->state.grasping;
	return true;
}

static bool submit_move(const cau_dds_hand *hand, const cau_pose *pose, double jaw,
                        uint64_t sequence)
{
	cau_order *order = make_order(hand, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_MOVE);
	if (!order)
		return false;
	order->motion = true;
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_MOVE);
	memcpy(order->as.command.tool, hand->tool, sizeof hand->tool);
	order->as.command.sequence = sequence;
	order->as.command.as.move.pose = *pose;
	order->as.command.as.move.jaw = jaw;
	cau_error error = {0};
	if (!cau_hosted_submit(hand->session->hosted, order, &error))
		return true;
	free(order); // the session has counted it
	return false;
}

bool cau_dds_move(cau_dds *dds, cau_dds_hand *hand, cau_pose pose, double jaw, uint64_t sequence)
{
	cau_error error = {0};
	cau_hosted_tool tool;
	double now_s = cau_monotonic_s();
	cau_hosted *hosted = hand->session->hosted;
	cau_status status = cau_motion_check_pose(&pose, jaw, &error);
	if (!status && !cau_hosted_find_tool(hosted, hand->tool, &tool))
		status = cau_fail(&error, CAU_NOT_FOUND, "tool", "there is no such tool");
	if (!status && hand->client->asker.role < CAU_ROLE_OPERATE)
		status = cau_fail(&error, CAU_BAD_STATE, "", "the role does not allow this");
	if (!status)
		status = cau_dds_check_ready(hand->session, hand->tool, &error);
	if (!status && !drives(dds, hand, &tool, now_s, &error))
		status = error.status;
	if (!status)
		status = cau_motion_check_leap(&hand->past, &pose, now_s, &tool.state.definition, &error);
	if (status) {
		cau_dds_refuse(hand->session, hand->tool, hand->client, sequence, &error);
		return false;
	}
	if (!submit_move(hand, &pose, jaw, sequence))
		return false;
	hand->past.has_pose = true;
	hand->past.pose = pose;
	hand->past.pose_s = now_s;
	hand->past.sequence = sequence;
	hand->jaw = jaw;
	cau_hosted_feed_tool(hosted, hand->client->asker.client, hand->tool);
	return true;
}

// ---- levels
static bool may_drive(const cau_dds_hand *hand)
{
	cau_hosted_tool tool;
	return cau_hosted_find_tool(hand->session->hosted, hand->tool, &tool) &&
	       (tool.driver.client == hand->client->asker.client ||
	        cau_monotonic_s() < hand->claim_until_s);
}

void cau_dds_energy(cau_dds *dds, cau_dds_hand *hand, bool level)
{
	(void)dds;
	if (!level) {
		hand->energy_ready = true;
		if (hand->energy_asked && may_drive(hand))
			hand->energy_asked =
				!command(hand, CAU_COMMAND_TOOL_ENERGIZE, CAU_METHOD_TOOL_ENERGIZE, false);
		return;
	}
	cau_error error = {0};
	if (!hand->energy_ready)
		return;
	cau_status status = cau_dds_check_ready(hand->session, hand->tool, &error);
	if (!status && !may_drive(hand))
		status = cau_fail(&error, CAU_BAD_STATE, "tool", "energy is for who drives the tool");
	if (status) {
		hand->energy_ready = false;
		cau_dds_refuse(hand->session, hand->tool, hand->client, hand->past.sequence, &error);
		return;
	}
	hand->energy_asked = command(hand, CAU_COMMAND_TOOL_ENERGIZE, CAU_METHOD_TOOL_ENERGIZE, true);
	hand->energy_ready = !hand->energy_asked;
}

void cau_dds_grasp(cau_dds_hand *hand, bool level)
{
	if (level == hand->grasp_asked)
		return;
	bool asked = level ? command(hand, CAU_COMMAND_TOOL_GRASP, CAU_METHOD_TOOL_GRASP, true)
	                   : command(hand, CAU_COMMAND_TOOL_RELEASE, CAU_METHOD_TOOL_RELEASE, false);
	if (asked)
		hand->grasp_asked = level;
}

// ---- CRTK's states
static void stay(const cau_dds_hand *hand, const cau_tool_state *state)
{
	submit_move(hand, &state->pose, state->jaw, hand->past.sequence);
}

void cau_dds_stop_tool(cau_dds *dds, cau_dds_session *session, const char *name,
                       const cau_dds_client *client)
{
	cau_hosted_tool tool;
	cau_dds_hand asking = {.client = (cau_dds_client *)client, .session = session};
	snprintf(asking.tool, sizeof asking.tool, "%s", name);
	if (!cau_hosted_find_tool(session->hosted, name, &tool))
		return;
	if (tool.energized)
		command(&asking, CAU_COMMAND_TOOL_ENERGIZE, CAU_METHOD_TOOL_ENERGIZE, false);
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *hand = &dds->hands[i];
		if (!hand->client || hand->session != session || strcmp(hand->tool, name) != 0)
			continue;
		if (tool.driver.client == hand->client->asker.client)
			stay(hand, &tool.state);
		hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	}
}

void cau_dds_restart_tool(cau_dds *dds, const cau_dds_session *session, const char *name)
{
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *hand = &dds->hands[i];
		if (hand->client && hand->session == session && strcmp(hand->tool, name) == 0)
			hand->past.pose_s = cau_monotonic_s();
	}
}
