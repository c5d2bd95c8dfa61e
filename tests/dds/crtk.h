// SPDX-License-Identifier: GPL-3.0-or-later
// The controller's side of CRTK's states and of the jaw topics.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>

typedef struct crtk {
	dds_entity_t command_writer, jaw_writer, state_reader, jaw_reader, pose_reader, asked_reader,
		asked_jaw_reader, force_reader, raw_force_reader;
	char state[16];
	bool homed, busy;
	int states, poses;   // numbers of received samples
	double z_n, raw_z_n; // forces from measured_cf and raw/measured_cf
	double jaw_rad, asked_jaw_rad, jaw_nm, position_m[3],
		asked_m[3]; // position_m from measured_cp, asked_m from setpoint_cp
} crtk;

// Creates a ROS 2 topic: rt/SESSION/TOOL/NAME, with each `-` replaced by `_`.
dds_entity_t ros_topic(dds_entity_t participant, const char *session, const char *tool,
                       const char *name, const dds_topic_descriptor_t *type);
// Returns ROS 2's default QoS; `latched` is the QoS of CRTK's clients for operating_state.
dds_qos_t *ros_qos(bool latched);

void crtk_open(crtk *c, dds_entity_t participant, const char *session, const char *tool);
bool crtk_matched(const crtk *c);
void crtk_read(crtk *c);
void crtk_command(const crtk *c, const char *word);
void crtk_jaw(const crtk *c, double angle_rad);
void crtk_tell(const crtk *c);
