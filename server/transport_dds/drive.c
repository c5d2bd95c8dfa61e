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

void cau_dds_refuse(cau_dds_session *session, const char *tool, const cau_dds_writer *writer,
                    uint64_t sequence, const cau_error *error)
{
	const cau_asker *asker = cau_dds_asker_of(writer);
	cau_hosted_refuse(session->hosted, tool, asker, sequence, error);
	session->refused++;
	tell_refused(session, tool, asker->name, error);
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
	        "tool=%s reason=\"%s\"", hand->tool->name, error.reason);
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
	memcpy(order->as.command.tool, hand->tool->name, sizeof hand->tool->name);
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
	memcpy(order->as.tool.tool, hand->tool->name, sizeof hand->tool->name);
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
static cau_dds_hand *silent_driver(const cau_dds_tool *tool, uint32_t driver, double now_s)
{
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		if (hand->client->asker.client == driver &&
		    now_s - hand->past.pose_s > hand->client->asker.deadline_s)
			return hand;
	return NULL;
}

// Another's claim to the tool waits in the session's queue.
static bool is_claimed(const cau_dds_tool *tool, const cau_dds_client *client, double now_s)
{
	for (const cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		if (hand->client != client && now_s < hand->claim_until_s)
			return true;
	return false;
}

// Whether a motion of this client (NULL: who has no place yet) makes it the driver, or finds it so.
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
	cau_order *order = make_order(hand, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
	if (order)
		memcpy(order->as.tool.tool, hand->tool->name, sizeof hand->tool->name);
	return order && submit(hand, order);
}

// CAU_OK if the hand's client drives the tool, or will before what is submitted next.
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
		return cau_fail(error, CAU_BAD_STATE, "tool", "%s drives it",
		                driver ? tool->driver.name : "another client");
	if (!ask_for_tool(hand, driver ? silent_driver(hand->tool, driver, now_s) : NULL))
		return cau_fail(error, CAU_LIMIT, "tool", "the session takes no orders now");
	hand->claim_until_s = now_s + CLAIM_S;
	hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	hand->grasp_asked = tool->state.grasping;
	return CAU_OK;
}

static bool submit_move(const cau_dds_hand *hand, const cau_pose *pose, double jaw,
                        uint64_t sequence)
{
	cau_order *order = make_order(hand, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_MOVE);
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
	free(order); // the session has counted it
	return false;
}

// What a motion must be and who may ask for it, before it takes a place.
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

cau_status cau_dds_check_role(const cau_dds_writer *writer, cau_error *error)
{
	return writer->asker.role >= CAU_ROLE_OPERATE
	           ? CAU_OK
	           : cau_fail(error, CAU_BAD_STATE, "", "the role does not allow this");
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
		status = hand ? claim(hand, &state, now_s, &error) : error.status;
	}
	if (!status)
		status = cau_motion_check_leap(&hand->past, &motion.pose, now_s, &state.state.definition,
		                               &error);
	if (status) {
		cau_dds_refuse(door->session, tool->name, writer, motion.sequence, &error);
		return NULL;
	}
	if (!submit_move(hand, &motion.pose, motion.jaw, motion.sequence))
		return NULL;
	note_motion(hand, &motion, now_s);
	cau_hosted_feed_tool(door->session->hosted, hand->client->asker.client, tool->name);
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

void cau_dds_energy(cau_dds_hand *hand, const cau_dds_writer *writer, bool level)
{
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
	cau_status status = cau_dds_check_ready(hand->session, hand->tool->name, &error);
	if (!status && !may_drive(hand))
		status = cau_fail(&error, CAU_BAD_STATE, "tool", "energy is for who drives the tool");
	if (status) {
		hand->energy_ready = false;
		cau_dds_refuse(hand->session, hand->tool->name, writer, hand->past.sequence, &error);
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

void cau_dds_stop_tool(cau_dds_session *session, cau_dds_tool *tool, const cau_asker *by)
{
	cau_hosted_tool state;
	cau_dds_client asking = {.asker = *by};
	const cau_dds_hand hand_of_asker = {.client = &asking, .session = session, .tool = tool};
	if (!cau_hosted_find_tool(session->hosted, tool->name, &state))
		return;
	if (state.energized)
		command(&hand_of_asker, CAU_COMMAND_TOOL_ENERGIZE, CAU_METHOD_TOOL_ENERGIZE, false);
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next) {
		if (state.driver.client == hand->client->asker.client)
			stay(hand, &state.state);
		hand->past.has_pose = hand->energy_ready = hand->energy_asked = false;
	}
}

void cau_dds_restart_tool(cau_dds_tool *tool)
{
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		hand->past.pose_s = cau_monotonic_s();
}
