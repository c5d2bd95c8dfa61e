// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of the ROS 2 topics of a tool. Their writers count nothing, so we count for them.
#include "ros2.h"

#include <math.h>

#include "transport_dds/internal.h"

static cau_dds_hand *hand_of(cau_dds *dds, cau_door *door, cau_dds_client *client)
{
	cau_error error = {0};
	cau_dds_hand *hand = cau_dds_hand_of(dds, client, door->session, door->tool);
	if (!hand) {
		cau_fail(&error, CAU_LIMIT, "tool", "too many drivers");
		cau_dds_refuse(door->session, door->tool, client, 0, &error);
	}
	return hand;
}

void cau_dds_take_servo_cp(cau_dds *dds, cau_door *door, cau_dds_client *client, const void *taken)
{
	const geometry_msgs_msg_dds__PoseStamped_ *sample = taken;
	const geometry_msgs_msg_dds__Point_ *p = &sample->pose_.position_;
	const geometry_msgs_msg_dds__Quaternion_ *q = &sample->pose_.orientation_;
	cau_pose pose = {{p->x_, p->y_, p->z_}, {q->w_, q->x_, q->y_, q->z_}};
	cau_dds_hand *hand = hand_of(dds, door, client);
	if (hand)
		cau_dds_move(dds, hand, pose, hand->jaw, hand->past.sequence + 1);
}

// The jaw moves with the pose: with the last one at once, else with the first that comes.
void cau_dds_take_servo_jp(cau_dds *dds, cau_door *door, cau_dds_client *client, const void *taken)
{
	const sensor_msgs_msg_dds__JointState_ *sample = taken;
	cau_hosted_tool tool;
	cau_error error = {0};
	cau_dds_hand *hand = hand_of(dds, door, client);
	if (!hand || !cau_hosted_find_tool(door->session->hosted, door->tool, &tool))
		return;
	double angle_rad = sample->position_._length ? sample->position_._buffer[0] : NAN;
	double open_rad = tool.state.definition.jaw_open_rad;
	if (!(angle_rad >= 0 && angle_rad <= open_rad)) {
		cau_fail(&error, CAU_BAD_VALUE, "position", "%g rad is not within 0 to %g", angle_rad,
		         open_rad);
		cau_dds_refuse(door->session, door->tool, client, hand->past.sequence, &error);
		return;
	}
	hand->jaw = angle_rad / open_rad;
	if (hand->past.has_pose)
		cau_dds_move(dds, hand, hand->past.pose, hand->jaw, hand->past.sequence + 1);
}

void cau_dds_take_energize(cau_dds *dds, cau_door *door, cau_dds_client *client, const void *taken)
{
	const sensor_msgs_msg_dds__Joy_ *sample = taken;
	cau_dds_hand *hand = hand_of(dds, door, client);
	if (hand) // no button is a button let go
		cau_dds_energy(dds, hand, sample->buttons_._length > 0 && sample->buttons_._buffer[0] > 0);
}
