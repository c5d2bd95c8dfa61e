// SPDX-License-Identifier: GPL-3.0-or-later
#include "crtk.h"

#include <stdio.h>
#include <string.h>

#include "link.h"
#include "ros2.h"

dds_entity_t ros_topic(dds_entity_t participant, const char *session, const char *tool,
                       const char *name, const dds_topic_descriptor_t *type)
{
	char topic[3 * NAME_BYTES];
	snprintf(topic, sizeof topic, "rt/%.48s/%.48s/%s", session, tool, name);
	for (char *at = topic; *at; at++)
		if (*at == '-')
			*at = '_';
	return checked(dds_create_topic(participant, type, topic, NULL, NULL));
}

dds_qos_t *ros_qos(bool latched)
{
	dds_qos_t *qos = reliable_qos(10);
	if (latched)
		dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	return qos;
}

void crtk_open(crtk *c, dds_entity_t participant, const char *session, const char *tool)
{
	dds_qos_t *qos = ros_qos(false), *latched = ros_qos(true);
	const struct {
		dds_entity_t *made;
		const char *name;
		const dds_topic_descriptor_t *type;
		bool writes, latched;
	} ends[] = {
		{&c->command_writer, "state_command", &crtk_msgs_msg_dds__StringStamped__desc, true, false},
		{&c->jaw_writer, "jaw/servo_jp", &sensor_msgs_msg_dds__JointState__desc, true, false},
		{&c->state_reader, "operating_state", &crtk_msgs_msg_dds__OperatingState__desc, false,
	     true},
		{&c->jaw_reader, "jaw/measured_js", &sensor_msgs_msg_dds__JointState__desc, false, false},
		{&c->asked_jaw_reader, "jaw/setpoint_js", &sensor_msgs_msg_dds__JointState__desc, false,
	     false},
		{&c->pose_reader, "measured_cp", &geometry_msgs_msg_dds__PoseStamped__desc, false, false},
		{&c->asked_reader, "setpoint_cp", &geometry_msgs_msg_dds__PoseStamped__desc, false, false},
		{&c->force_reader, "measured_cf", &geometry_msgs_msg_dds__WrenchStamped__desc, false,
	     false},
		{&c->raw_force_reader, "raw/measured_cf", &geometry_msgs_msg_dds__WrenchStamped__desc,
	     false, false},
	};
	for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
		dds_entity_t topic = ros_topic(participant, session, tool, ends[i].name, ends[i].type);
		const dds_qos_t *with = ends[i].latched ? latched : qos;
		*ends[i].made = checked(ends[i].writes ? dds_create_writer(participant, topic, with, NULL)
		                                       : dds_create_reader(participant, topic, with, NULL));
	}
	dds_delete_qos(qos);
	dds_delete_qos(latched);
}

bool crtk_matched(const crtk *c)
{
	dds_publication_matched_status_t command;
	return !dds_get_publication_matched_status(c->command_writer, &command) &&
	       command.current_count > 0 && c->states > 0 && c->poses > 0;
}

// Counts the jaw topics that the daemon has at its end.
static int count_jaw_topics(const crtk *c)
{
	dds_publication_matched_status_t asks;
	dds_subscription_matched_status_t measured, asked;
	checked(dds_get_publication_matched_status(c->jaw_writer, &asks));
	checked(dds_get_subscription_matched_status(c->jaw_reader, &measured));
	checked(dds_get_subscription_matched_status(c->asked_jaw_reader, &asked));
	return (asks.current_count > 0) + (measured.current_count > 0) + (asked.current_count > 0);
}

static void take_state(void *user, const void *sample)
{
	crtk *c = user;
	const crtk_msgs_msg_dds__OperatingState_ *state = sample;
	snprintf(c->state, sizeof c->state, "%s", state->state_);
	c->homed = state->is_homed_;
	c->busy = state->is_busy_;
	c->states++;
}

static void take_jaw(void *user, const void *sample)
{
	crtk *c = user;
	const sensor_msgs_msg_dds__JointState_ *jaw = sample;
	if (jaw->position_._length == 1 && jaw->name_._length == 1)
		c->jaw_rad = jaw->position_._buffer[0];
	if (jaw->effort_._length == 1)
		c->jaw_nm = jaw->effort_._buffer[0];
}

static void take_asked_jaw(void *user, const void *sample)
{
	crtk *c = user;
	const sensor_msgs_msg_dds__JointState_ *jaw = sample;
	if (jaw->position_._length == 1 && jaw->effort_._length == 0)
		c->asked_jaw_rad = jaw->position_._buffer[0];
}

static void take_pose(void *user, const void *sample)
{
	crtk *c = user;
	const geometry_msgs_msg_dds__Point_ *p =
		&((const geometry_msgs_msg_dds__PoseStamped_ *)sample)->pose_.position_;
	c->position_m[0] = p->x_;
	c->position_m[1] = p->y_;
	c->position_m[2] = p->z_;
	c->poses++;
}

static void take_asked(void *user, const void *sample)
{
	crtk *c = user;
	const geometry_msgs_msg_dds__Point_ *p =
		&((const geometry_msgs_msg_dds__PoseStamped_ *)sample)->pose_.position_;
	c->asked_m[0] = p->x_;
	c->asked_m[1] = p->y_;
	c->asked_m[2] = p->z_;
}

static void take_force(void *user, const void *sample)
{
	*(double *)user = ((const geometry_msgs_msg_dds__WrenchStamped_ *)sample)->wrench_.force_.z_;
}

void crtk_read(crtk *c)
{
	take_each(c->state_reader, take_state, c);
	take_each(c->jaw_reader, take_jaw, c);
	take_each(c->asked_jaw_reader, take_asked_jaw, c);
	take_each(c->pose_reader, take_pose, c);
	take_each(c->asked_reader, take_asked, c);
	take_each(c->force_reader, take_force, &c->z_n);
	take_each(c->raw_force_reader, take_force, &c->raw_z_n);
}

void crtk_command(const crtk *c, const char *word)
{
	char frame[] = "", text[32];
	snprintf(text, sizeof text, "%s", word);
	crtk_msgs_msg_dds__StringStamped_ sample = {{{0, 0}, frame}, text};
	checked(dds_write(c->command_writer, &sample));
}

void crtk_jaw(const crtk *c, double angle_rad)
{
	char frame[] = "";
	sensor_msgs_msg_dds__JointState_ sample = {.header_ = {{0, 0}, frame},
	                                           .position_ = {1, 1, &angle_rad, false}};
	checked(dds_write(c->jaw_writer, &sample));
}

void crtk_tell(const crtk *c)
{
	printf("{\"event\":\"crtk\",\"state\":\"%s\",\"homed\":%s,\"busy\":%s,\"states\":%d,"
	       "\"jaw_rad\":%.6f,\"asked_jaw_rad\":%.6f,\"jaw_nm\":%.6f,\"position_m\":[%.6f,%.6f,%.6f]"
	       ",\"asked_m\":[%.6f,%.6f,%.6f],\"jaw_topics\":%d,\"z_n\":%.17g,\"raw_z_n\":%.17g}\n",
	       c->state, c->homed ? "true" : "false", c->busy ? "true" : "false", c->states, c->jaw_rad,
	       c->asked_jaw_rad, c->jaw_nm, c->position_m[0], c->position_m[1], c->position_m[2],
	       c->asked_m[0], c->asked_m[1], c->asked_m[2], count_jaw_topics(c), c->z_n, c->raw_z_n);
}
