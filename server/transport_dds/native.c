// SPDX-License-Identifier: GPL-3.0-or-later
// Takes samples of the native topics of a tool: cautery/tool_command, cautery/tool_setting (power,
// voltage, crest factor and current of its generator) and cautery/tool_instrument (its instrument).
#include <string.h>

#include "cautery.h"
#include "cautery/defaults.h"
#include "cautery/instrument.h"
#include "transport_dds/internal.h"

// ---- commands
static cau_status check(const cau_door *door, const cau_dds_writer *writer, cau_dds_tool *tool,
                        const cautery_ToolCommand *sample, cau_error *error)
{
	static const cau_motion_past none;
	if (strcmp(sample->session, cau_hosted_id(door->session->hosted)) != 0)
		return cau_fail(error, CAU_BAD_VALUE, "session", "is not the session of the partition");
	if (!tool)
		return cau_fail(error, CAU_NOT_FOUND, "tool", "there is no such tool");
	const cau_dds_hand *hand = cau_dds_find_hand(writer->client, tool);
	return cau_motion_check_order(hand ? &hand->past : &none, sample->sequence_number,
	                              sample->source_time_ns, 1000 * cau_wall_us(), cau_monotonic_s(),
	                              writer->asker.deadline_s, error);
}

void cau_dds_take_command(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	const cautery_ToolCommand *sample = taken;
	cau_error error = {0};
	cau_dds_tool *tool = cau_dds_find_tool(door->session, sample->tool);
	if (check(door, writer, tool, sample, &error)) {
		cau_dds_refuse(door->session, sample->tool, writer, sample->sequence_number, &error);
		return;
	}
	cau_dds_motion motion = {.jaw = sample->jaw,
	                         .sequence = sample->sequence_number,
	                         .source_time_ns = sample->source_time_ns};
	memcpy(motion.pose.position_m, sample->position_m, sizeof motion.pose.position_m);
	memcpy(motion.pose.rotation, sample->rotation, sizeof motion.pose.rotation);
	cau_dds_hand *hand = cau_dds_move(dds, door, tool, writer, motion);
	if (hand) {
		cau_dds_energy(hand, writer, sample->energy, 0);
		cau_dds_grasp(hand, sample->grasp);
	} else if (!sample->energy && (hand = cau_dds_find_hand(writer->client, tool))) {
		// Energy off is obeyed in every valid sample, even if its motion was refused.
		cau_dds_energy(hand, writer, false, 0);
	}
}

// ---- settings and instruments
// Each sample has all values, so it does not depend on an earlier sample, which may still wait in
// the session's queue.

// Sets the tool's member `name`, after a check of its range.
static cau_status set(cau_tool_def *tool, const char *name, double value, cau_error *error)
{
	const struct {
		const char *name;
		double *size, least, most;
	} sizes[] = {
#define X(name, standard, least, most, ...) {#name, &tool->name, least, most},
		CAU_TOOL_TABLE(X)
#undef X
	};
	size_t i = 0;
	while (strcmp(sizes[i].name, name) != 0)
		i++;
	if (!(value >= sizes[i].least && value <= sizes[i].most))
		return cau_fail(error, CAU_BAD_VALUE, name, "%g is not between %g and %g", value,
		                sizes[i].least, sizes[i].most);
	*sizes[i].size = value;
	return CAU_OK;
}

static cau_status set_all(cau_tool_def *tool, const cautery_ToolSetting *sample, cau_error *error)
{
	cau_status status = set(tool, "power_w", sample->power_w, error);
	if (!status)
		status = set(tool, "peak_v", sample->peak_v, error);
	if (!status)
		status = set(tool, "crest_factor", sample->crest_factor, error);
	return status ? status : set(tool, "current_max_a", sample->current_max_a, error);
}

// Returns the hand that drives the tool and belongs to the writer's participant. The hand may drive
// by any topic.
static cau_dds_hand *find_driving(const cau_dds_tool *tool, const cau_dds_writer *writer,
                                  uint32_t driver)
{
	cau_dds_hand *hand = tool->hands;
	while (hand && (hand->client->asker.client != driver ||
	                hand->client->participant != writer->participant))
		hand = hand->next;
	return hand;
}

static cau_status order_setting(const cau_dds_hand *hand, const cau_tool_def *tool,
                                cau_error *error)
{
	cau_order *order = cau_dds_make_order(hand, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_CONFIGURE);
	if (!order)
		return cau_fail(error, CAU_NO_MEMORY, "tool", "no memory for the setting of the tool");
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_CONFIGURE);
	memcpy(order->as.command.tool, hand->tool->name, sizeof hand->tool->name);
	order->as.command.sequence = hand->past.sequence;
	order->as.command.as.definition = *tool;
	return cau_dds_submit(hand, order)
	           ? CAU_OK
	           : cau_fail(error, CAU_LIMIT, "tool", "the session takes no orders at the moment");
}

// Finds the tool that a sample names, its present definition, and the hand of the writer's
// participant that drives it.
static cau_status find_tool(const cau_dds *dds, const cau_door *door, cau_dds_writer *writer,
                            const char *session, const char *name, const cau_dds_hand **hand,
                            cau_tool_def *definition, cau_error *error)
{
	cau_hosted_tool state;
	const cau_dds_tool *tool = cau_dds_find_tool(door->session, name);
	if (strcmp(session, cau_hosted_id(door->session->hosted)) != 0)
		return cau_fail(error, CAU_BAD_VALUE, "session", "is not that of the partition");
	if (!tool || !cau_hosted_find_tool(door->session->hosted, tool->name, &state))
		return cau_fail(error, CAU_NOT_FOUND, "tool", "there is no such tool");
	*hand = find_driving(tool, writer, state.driver.client);
	if (!*hand)
		return cau_fail(error, CAU_BAD_STATE, "tool",
		                "only the participant that drives the tool can set its generator");
	if (cau_dds_is_too_fast(dds->config, writer))
		return cau_fail(error, CAU_LIMIT, "tool",
		                "this writer sends more than %lld settings a second (setting "
		                "max_requests_per_s)",
		                (long long)dds->config->max_requests_per_s);
	*definition = state.state.definition;
	return CAU_OK;
}

void cau_dds_take_setting(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	cau_error error = {0};
	cau_tool_def wanted;
	const cau_dds_hand *hand = NULL;
	const cautery_ToolSetting *sample = taken;
	cau_status status =
		find_tool(dds, door, writer, sample->session, sample->tool, &hand, &wanted, &error);
	if (!status)
		status = set_all(&wanted, sample, &error);
	if (!status)
		status = order_setting(hand, &wanted, &error);
	if (status)
		cau_dds_refuse(door->session, sample->tool, writer, 0, &error);
}

void cau_dds_take_instrument(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                             const void *taken)
{
	cau_error error = {0};
	cau_tool_def wanted;
	const cau_dds_hand *hand = NULL;
	const cautery_ToolInstrument *sample = taken;
	cau_status status =
		find_tool(dds, door, writer, sample->session, sample->tool, &hand, &wanted, &error);
	if (!status)
		status =
			cau_instrument_take(sample->instrument, sample->mode, sample->power_w, &wanted, &error);
	if (!status)
		status = order_setting(hand, &wanted, &error);
	if (status)
		cau_dds_refuse(door->session, sample->tool, writer, 0, &error);
}
