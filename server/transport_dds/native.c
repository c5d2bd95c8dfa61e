// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of cautery/tool_command.
#include <string.h>

#include "cautery.h"
#include "transport_dds/internal.h"

static cau_status check(const cau_door *door, const cau_dds_hand *hand,
                        const cautery_ToolCommand *sample, cau_error *error)
{
	if (strcmp(sample->session, cau_hosted_id(door->session->hosted)) != 0)
		return cau_fail(error, CAU_BAD_VALUE, "session", "is not that of the partition");
	if (!cau_dds_find_tool(door->session, sample->tool))
		return cau_fail(error, CAU_NOT_FOUND, "tool", "there is no such tool");
	if (!hand)
		return cau_fail(error, CAU_LIMIT, "tool", "too many drivers");
	return cau_motion_check_order(&hand->past, sample->sequence_number, sample->source_time_ns,
	                              1000 * cau_wall_us(), cau_monotonic_s(),
	                              hand->client->asker.deadline_s, error);
}

void cau_dds_take_command(cau_dds *dds, cau_door *door, cau_dds_client *client, const void *taken)
{
	const cautery_ToolCommand *sample = taken;
	cau_error error = {0};
	cau_pose pose;
	cau_dds_hand *hand = NULL;
	if (strcmp(sample->session, cau_hosted_id(door->session->hosted)) == 0 &&
	    cau_dds_find_tool(door->session, sample->tool)) // made-up names get no hand
		hand = cau_dds_hand_of(dds, client, door->session, sample->tool);
	if (check(door, hand, sample, &error)) {
		cau_dds_refuse(door->session, sample->tool, client, sample->sequence_number, &error);
		return;
	}
	memcpy(pose.position_m, sample->position_m, sizeof pose.position_m);
	memcpy(pose.rotation, sample->rotation, sizeof pose.rotation);
	if (cau_dds_move(dds, hand, pose, sample->jaw, sample->sequence_number)) {
		hand->past.source_time_ns = sample->source_time_ns;
		cau_dds_energy(dds, hand, sample->energy);
		cau_dds_grasp(hand, sample->grasp);
	} else if (!sample->energy) {
		cau_dds_energy(dds, hand, false); // off is heard in any sample that is in order
	}
}
