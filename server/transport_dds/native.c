// SPDX-License-Identifier: GPL-3.0-or-later
// Takes samples of cautery/tool_command.
#include <string.h>

#include "cautery.h"
#include "transport_dds/internal.h"

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
