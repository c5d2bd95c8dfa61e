// SPDX-License-Identifier: GPL-3.0-or-later
// Takes samples of the ROS 2 topics of a tool. These samples have no sequence number, so the daemon
// counts for their writers.
#include "ros2.h"

#include <math.h>

#include "transport_dds/internal.h"

// Moves the tool to a pose, with the jaw opening that was requested last.
static void move(cau_dds *dds, const cau_door *door, cau_dds_tool *tool, cau_dds_writer *writer,
                 const cau_pose *pose)
{
	const cau_dds_hand *hand = cau_dds_find_hand(writer->client, tool);
	cau_dds_move(dds, door, tool, writer,
	             (cau_dds_motion){.pose = *pose,
	                              .jaw = hand ? hand->jaw : 1,
	                              .sequence = hand ? hand->past.sequence + 1 : 1});
}

void cau_dds_take_servo_cp(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	const geometry_msgs_msg_dds__PoseStamped_ *sample = taken;
	const geometry_msgs_msg_dds__Point_ *p = &sample->pose_.position_;
	const geometry_msgs_msg_dds__Quaternion_ *q = &sample->pose_.orientation_;
	cau_pose pose = {{p->x_, p->y_, p->z_}, {q->w_, q->x_, q->y_, q->z_}};
	cau_dds_tool *tool = cau_dds_find_tool(door->session, door->tool);
	if (tool)
		move(dds, door, tool, writer, &pose);
}

static cau_status check_jaw(const cau_hosted_tool *tool,
                            const sensor_msgs_msg_dds__JointState_ *sample, double *jaw,
                            cau_error *error)
{
	double open_rad = tool->state.definition.jaw_open_rad;
	if (!sample->position_._length)
		return cau_fail(
			error, CAU_BAD_VALUE, "position",
			"the sample has no position: position[0] is the angle of the jaws, 0 to %g rad",
			open_rad);
	double angle_rad = sample->position_._buffer[0];
	if (!(angle_rad >= 0 && angle_rad <= open_rad))
		return cau_fail(error, CAU_BAD_VALUE, "position", "%g rad is not within 0 to %g", angle_rad,
		                open_rad);
	*jaw = angle_rad / open_rad;
	return CAU_OK;
}

// Takes a jaw opening. The jaw moves together with a pose. If the tool has a last pose, the jaw
// moves at once; otherwise it moves with the first pose.
void cau_dds_take_servo_jp(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	cau_hosted_tool state;
	cau_error error = {0};
	double jaw = 1;
	cau_dds_hand *hand = NULL;
	cau_dds_tool *tool = cau_dds_find_tool(door->session, door->tool);
	if (!tool || !cau_hosted_find_tool(door->session->hosted, door->tool, &state))
		return;
	cau_status status = check_jaw(&state, taken, &jaw, &error);
	if (!status)
		status = cau_dds_check_role(writer, &error);
	if (!status && !(hand = cau_dds_take_hand(dds, writer, door->session, tool, false, &error)))
		status = error.status;
	if (status) {
		hand = cau_dds_find_hand(writer->client, tool);
		cau_dds_refuse(door->session, door->tool, writer, hand ? hand->past.sequence : 0, &error);
		return;
	}
	hand->jaw = jaw;
	if (hand->past.has_pose)
		move(dds, door, tool, writer, &hand->past.pose);
}

// Takes an energy level. The level of a client that has not moved the tool is ignored: energy needs
// a level that rises while the client drives.
void cau_dds_take_energize(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *taken)
{
	const sensor_msgs_msg_dds__Joy_ *sample = taken;
	const cau_dds_tool *tool = cau_dds_find_tool(door->session, door->tool);
	cau_dds_hand *hand = tool ? cau_dds_find_hand(writer->client, tool) : NULL;
	(void)dds;
	const dds_sequence_long *buttons = &sample->buttons_;
	// A button that the message lacks counts as released.
	if (hand)
		cau_dds_energy(hand, writer, buttons->_length > 0 && buttons->_buffer[0] > 0,
		               buttons->_length > 1 ? buttons->_buffer[1] : 0);
}
