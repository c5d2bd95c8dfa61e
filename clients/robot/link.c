// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <string.h>
#include <time.h>

#include "ros2.h"

enum { TAKEN_MOST = 32 };

double robot_monotonic_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int64_t wall_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

// Opens the writer of commands. The writer offers a deadline, and only by writing does it prove
// that it is alive.
static dds_entity_t open_writer(robot_link *link, const dds_qos_t *partition, double deadline_s)
{
	dds_qos_t *qos = dds_create_qos();
	dds_duration_t deadline = (dds_duration_t)(1e9 * deadline_s);
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
	dds_qset_deadline(qos, deadline);
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, deadline);
	dds_entity_t topic = dds_create_topic(link->participant, &cautery_ToolCommand_desc,
	                                      "cautery/tool_command", NULL, NULL);
	dds_entity_t publisher = dds_create_publisher(link->participant, partition, NULL);
	dds_entity_t made = dds_create_writer(publisher, topic, qos, NULL);
	dds_delete_qos(qos);
	return made;
}

static dds_entity_t open_reader(robot_link *link, const dds_qos_t *partition)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
	dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, TAKEN_MOST);
	dds_entity_t topic = dds_create_topic(link->participant, &cautery_ToolState_desc,
	                                      "cautery/tool_state", NULL, NULL);
	dds_entity_t subscriber = dds_create_subscriber(link->participant, partition, NULL);
	dds_entity_t made = dds_create_reader(subscriber, topic, qos, NULL);
	dds_delete_qos(qos);
	return made;
}

// Opens a reader of rt/SESSION/TOOL/measured_cf, with ROS 2's name rules and default QoS.
static dds_entity_t open_force_reader(robot_link *link)
{
	char name[sizeof link->command.session + sizeof link->command.tool + 32];
	snprintf(name, sizeof name, "rt/%s/%s/measured_cf", link->command.session, link->command.tool);
	for (char *letter = name; *letter; letter++)
		if (*letter == '-')
			*letter = '_';
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
	dds_entity_t topic = dds_create_topic(
		link->participant, &geometry_msgs_msg_dds__WrenchStamped__desc, name, NULL, NULL);
	dds_entity_t made = dds_create_reader(link->participant, topic, qos, NULL);
	dds_delete_qos(qos);
	return made;
}

static void write_name(robot_link *link)
{
	dds_guid_t guid;
	int at = snprintf(link->name, sizeof link->name, "dds ");
	if (dds_get_guid(link->writer, &guid))
		return;
	for (size_t i = 0; i < sizeof guid.v; i++)
		at += snprintf(link->name + at, 3, "%02x", guid.v[i]);
}

bool robot_link_open(robot_link *link, const robot_options *options, FILE *errors)
{
	*link = (robot_link){0};
	snprintf(link->command.session, sizeof link->command.session, "%s", options->session);
	snprintf(link->command.tool, sizeof link->command.tool, "%s", options->tool);
	link->participant = dds_create_participant((dds_domainid_t)options->domain, NULL, NULL);
	dds_qos_t *partition = dds_create_qos();
	dds_qset_partition1(partition, options->session);
	link->writer = open_writer(link, partition, options->deadline_s);
	link->reader = open_reader(link, partition);
	link->force_reader = open_force_reader(link);
	dds_delete_qos(partition);
	link->waitset = dds_create_waitset(link->participant);
	const dds_entity_t made[] = {link->participant, link->writer, link->reader, link->force_reader,
	                             link->waitset};
	static const char *const names[] = {"participant", "writer of cautery/tool_command",
	                                    "reader of cautery/tool_state", "reader of measured_cf",
	                                    "waitset"};
	for (size_t i = 0; i < sizeof made / sizeof made[0]; i++)
		if (made[i] < 0) {
			fprintf(errors,
			        "cautery-robot: cannot create the DDS %s in domain %d: %s (check --domain and "
			        "CYCLONEDDS_URI)\n",
			        names[i], options->domain, dds_strretcode(made[i]));
			return false;
		}
	write_name(link);
	dds_set_status_mask(link->writer, DDS_PUBLICATION_MATCHED_STATUS);
	dds_set_status_mask(link->reader, DDS_DATA_AVAILABLE_STATUS);
	dds_waitset_attach(link->waitset, link->writer, 0);
	dds_waitset_attach(link->waitset, link->reader, 0);
	return true;
}

void robot_link_close(robot_link *link)
{
	if (link->participant > 0)
		dds_delete(link->participant);
}

bool robot_link_wait(robot_link *link, double seconds)
{
	double until_s = robot_monotonic_s() + seconds, left_s;
	dds_publication_matched_status_t matched = {0};
	while ((left_s = until_s - robot_monotonic_s()) > 0) {
		dds_waitset_wait(link->waitset, NULL, 0, (dds_duration_t)(1e9 * left_s));
		dds_get_publication_matched_status(link->writer, &matched);
		robot_link_read(link);
		if (matched.current_count > 0 && link->has_state)
			return true;
	}
	return false;
}

bool robot_link_drives(const robot_link *link)
{
	return link->has_state && strcmp(link->state.driver_name, link->name) == 0;
}

static void take_state(robot_link *link, const cautery_ToolState *state)
{
	uint64_t shown = state->sequence_number;
	bool newer = shown > link->state.sequence_number || !link->has_state;
	link->state = *state;
	link->has_state = true;
	if (newer && robot_link_drives(link) && shown <= link->command.sequence_number &&
	    link->command.sequence_number - shown < ROBOT_SENT && link->sent_s[shown % ROBOT_SENT] > 0)
		robot_histogram_add(&link->latency, robot_monotonic_s() - link->sent_s[shown % ROBOT_SENT]);
}

static void take_force(robot_link *link)
{
	void *samples[TAKEN_MOST] = {NULL};
	dds_sample_info_t infos[TAKEN_MOST];
	dds_return_t count = dds_take(link->force_reader, samples, infos, TAKEN_MOST, TAKEN_MOST);
	for (dds_return_t i = 0; i < count; i++) {
		const geometry_msgs_msg_dds__WrenchStamped_ *sample = samples[i];
		if (!infos[i].valid_data)
			continue;
		const geometry_msgs_msg_dds__Vector3_ *force = &sample->wrench_.force_;
		memcpy(link->force_n, (double[3]){force->x_, force->y_, force->z_}, sizeof link->force_n);
		link->has_force = true;
	}
	if (count > 0)
		dds_return_loan(link->force_reader, samples, count);
}

void robot_link_read(robot_link *link)
{
	void *samples[TAKEN_MOST] = {NULL};
	dds_sample_info_t infos[TAKEN_MOST];
	dds_return_t count = dds_take(link->reader, samples, infos, TAKEN_MOST, TAKEN_MOST);
	for (dds_return_t i = 0; i < count; i++) {
		const cautery_ToolState *state = samples[i];
		if (infos[i].valid_data && strcmp(state->tool, link->command.tool) == 0)
			take_state(link, state);
	}
	if (count > 0)
		dds_return_loan(link->reader, samples, count);
	take_force(link);
	if (!link->has_force)
		memcpy(link->force_n, link->state.force_n, sizeof link->force_n);
}

bool robot_link_write(robot_link *link, const robot_pose *pose, bool energy)
{
	cautery_ToolCommand *command = &link->command;
	command->sequence_number++;
	command->source_time_ns = wall_ns();
	memcpy(command->position_m, pose->position_m, sizeof command->position_m);
	memcpy(command->rotation, pose->rotation, sizeof command->rotation);
	command->jaw = 1;
	command->energy = energy;
	link->sent_s[command->sequence_number % ROBOT_SENT] = robot_monotonic_s();
	return dds_write(link->writer, command) == DDS_RETCODE_OK;
}
