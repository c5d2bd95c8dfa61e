// SPDX-License-Identifier: GPL-3.0-or-later
// A robot controller for the tests: a plain Cyclone DDS program that knows only the IDL and nothing
// else of the server.
//
//     controller DOMAIN SESSION TOOL native|ros|sensor|loose|mistyped DEADLINE_MS
//
// DEADLINE_MS 0 declares no deadline. All modes except native use ROS 2's topics. sensor writes
// poses with best effort, like ROS 2's sensor data. loose also writes the level of energy with best
// effort. mistyped writes poses to the topic of energy.
//
// It writes 100 times a second. Lines on standard input control it:
//     aim X Y Z      goes to this position (m) at 0.2 m/s
//     energy 0|1     level of energy that it writes
//     grasp 0|1      level of grasp that it writes
//     write on|off   off: silent, but alive
//     once WHAT      one bad sample: nan infinite back huge stale leap session;
//                    or a good one: lift, 1 mm higher
//     flood COUNT    this number of NaN samples at once
//     storm RATE     this number of bad samples a second
//     strangers COUNT  this number of samples, each of another made-up tool or session
//     state          prints the newest tool state, soon
// These need ROS 2's topics:
//     ticks COUNT    limit that it writes with the level of energy
//     command WORD   a state_command
//     jaw RAD        a jaw/servo_jp
//     crtk           prints the operating state, the jaw and the pose from ROS 2's topics
// It writes events as JSON objects, one a line, to standard output: matched, silent, strangers (all
// are written), state, changed, crtk.
#include <dds/dds.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cautery.h"
#include "console.h"
#include "crtk.h"
#include "link.h"
#include "ros2.h"

#define PERIOD_S 0.01
#define STORM_PERIOD_S 0.001
#define SPEED_M_S 0.2
#define LIFT_M 0.001

enum { STRANGERS_SHARE = 500 }; // number of stranger samples in one period of the controller

typedef struct controller {
	char session[NAME_BYTES], tool[NAME_BYTES];
	bool ros, sensor, loose, mistyped, writing, energy, grasp, has_state, matched, state_asked;
	int32_t ticks; // limit that is written with the level of energy; 0: no limit
	uint64_t sequence;
	double position_m[3], aim_m[3];
	double last_write_s;
	dds_entity_t participant, publisher, command, pose, level, state_reader, grasp_reader,
		power_reader, force_reader, setting, instrument;
	cautery_ToolState state;
	cautery_ToolGrasp holding;
	cautery_ToolPower power;
	cautery_ToolForce felt;
	bool sets;                      // true while set_w must still be written
	double set_w;                   // power setting of the tool's generator
	cautery_ToolInstrument becomes; // must still be written if it names an instrument
	crtk crtk;                      // used only with ROS 2's topics
	bool crtk_asked;
	double storm_hz; // bad samples a second; 0: the controller writes good samples
	uint64_t stormed;
	long strangers, made_up; // strangers still to write; strangers written
} controller;

// ---- topics
static dds_entity_t ros_writer(controller *c, const char *name, const dds_topic_descriptor_t *type,
                               bool best_effort)
{
	dds_qos_t *qos = ros_qos(false);
	if (best_effort)
		dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
	dds_entity_t topic = ros_topic(c->participant, c->session, c->tool, name, type);
	dds_entity_t made = checked(dds_create_writer(c->participant, topic, qos, NULL));
	dds_delete_qos(qos);
	return made;
}

static void open_native(controller *c, dds_entity_t publisher, int deadline_ms)
{
	dds_qos_t *qos = reliable_qos(1);
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(500));
	if (deadline_ms)
		dds_qset_deadline(qos, DDS_MSECS(deadline_ms));
	c->command = native_writer(publisher, &cautery_ToolCommand_desc, "cautery/tool_command", qos);
	dds_delete_qos(qos);
}

static void open_wire(controller *c, uint32_t domain, int deadline_ms)
{
	c->participant = checked(dds_create_participant(domain, NULL, NULL));
	if (c->ros) {
		c->pose = ros_writer(c, c->mistyped ? "energize" : "servo_cp",
		                     &geometry_msgs_msg_dds__PoseStamped__desc, c->sensor);
		if (!c->mistyped)
			c->level = ros_writer(c, "energize", &sensor_msgs_msg_dds__Joy__desc, c->loose);
		crtk_open(&c->crtk, c->participant, c->session, c->tool);
	} else {
		open_native(c, publisher_of(c->participant, c->session), deadline_ms);
	}
	dds_entity_t subscriber = subscriber_of(c->participant, c->session);
	c->state_reader = native_reader(subscriber, &cautery_ToolState_desc, "cautery/tool_state",
	                                DDS_DURABILITY_TRANSIENT_LOCAL, 1);
	c->grasp_reader = native_reader(subscriber, &cautery_ToolGrasp_desc, "cautery/tool_grasp",
	                                DDS_DURABILITY_TRANSIENT_LOCAL, 1);
	c->power_reader = native_reader(subscriber, &cautery_ToolPower_desc, "cautery/tool_power",
	                                DDS_DURABILITY_TRANSIENT_LOCAL, 1);
	c->force_reader = native_reader(subscriber, &cautery_ToolForce_desc, "cautery/tool_force",
	                                DDS_DURABILITY_TRANSIENT_LOCAL, 1);
}

static bool is_matched(dds_entity_t writer)
{
	dds_publication_matched_status_t status;
	return !dds_get_publication_matched_status(writer, &status) && status.current_count > 0;
}

// ---- the generator
static void open_setting(controller *c)
{
	dds_qos_t *qos = reliable_qos(1);
	if (!c->setting)
		c->setting = native_writer(publisher_of(c->participant, c->session),
		                           &cautery_ToolSetting_desc, "cautery/tool_setting", qos);
	dds_delete_qos(qos);
}

// Writes the setting when the daemon's reader has matched. Only the power changes; other members
// keep the last reported values.
static void write_setting(controller *c)
{
	if (!c->sets || !*c->power.tool || !is_matched(c->setting))
		return;
	cautery_ToolSetting sample = {.power_w = c->set_w,
	                              .peak_v = c->power.peak_v,
	                              .crest_factor = c->power.crest_factor,
	                              .current_max_a = c->power.current_max_a};
	memcpy(sample.session, c->session, sizeof c->session);
	memcpy(sample.tool, c->tool, sizeof c->tool);
	checked(dds_write(c->setting, &sample));
	c->sets = false;
}

// Writes the instrument when the daemon's reader has matched.
static void write_instrument(controller *c)
{
	dds_qos_t *qos = reliable_qos(1);
	if (*c->becomes.instrument && !c->instrument)
		c->instrument = native_writer(publisher_of(c->participant, c->session),
		                              &cautery_ToolInstrument_desc, "cautery/tool_instrument", qos);
	dds_delete_qos(qos);
	if (!*c->becomes.instrument || !is_matched(c->instrument))
		return;
	memcpy(c->becomes.session, c->session, sizeof c->session);
	memcpy(c->becomes.tool, c->tool, sizeof c->tool);
	checked(dds_write(c->instrument, &c->becomes));
	*c->becomes.instrument = 0;
}

// ---- writing
static void write_native(controller *c, cautery_ToolCommand *sample)
{
	memcpy(sample->tool, c->tool, sizeof c->tool);
	sample->rotation[0] = 1;
	sample->jaw = 1;
	sample->energy = c->energy;
	sample->grasp = c->grasp;
	checked(dds_write(c->command, sample));
}

static cautery_ToolCommand command_now(controller *c)
{
	cautery_ToolCommand sample = {.sequence_number = ++c->sequence,
	                              .source_time_ns = (int64_t)(1e9 * clock_s(CLOCK_REALTIME))};
	memcpy(sample.session, c->session, sizeof c->session);
	memcpy(sample.position_m, c->position_m, sizeof sample.position_m);
	return sample;
}

static void write_ros_pose(controller *c, const double p[3])
{
	char frame[] = "";
	geometry_msgs_msg_dds__PoseStamped_ sample = {{{0, 0}, frame}, {{p[0], p[1], p[2]}, {.w_ = 1}}};
	checked(dds_write(c->pose, &sample));
}

static void write_ros_level(controller *c)
{
	char frame[] = "";
	int32_t buttons[2] = {c->energy, c->ticks};
	uint32_t count = c->ticks ? 2 : 1;
	sensor_msgs_msg_dds__Joy_ sample = {.header_ = {{0, 0}, frame},
	                                    .buttons_ = {count, count, buttons, false}};
	checked(dds_write(c->level, &sample));
}

static void go_on(controller *c)
{
	double away[3], distance = 0;
	for (int i = 0; i < 3; i++) {
		away[i] = c->aim_m[i] - c->position_m[i];
		distance += away[i] * away[i];
	}
	distance = sqrt(distance);
	double share = distance > SPEED_M_S * PERIOD_S ? SPEED_M_S * PERIOD_S / distance : 1;
	for (int i = 0; i < 3; i++)
		c->position_m[i] += share * away[i];
}

static void write_good(controller *c)
{
	go_on(c);
	if (c->ros) {
		write_ros_pose(c, c->position_m);
		write_ros_level(c);
	} else {
		cautery_ToolCommand sample = command_now(c);
		write_native(c, &sample);
	}
	c->last_write_s = clock_s(CLOCK_MONOTONIC);
}

static void write_once(controller *c, const char *what)
{
	cautery_ToolCommand sample = command_now(c);
	if (strcmp(what, "lift") == 0)
		sample.position_m[2] = c->position_m[2] += LIFT_M;
	else if (strcmp(what, "nan") == 0)
		sample.position_m[1] = NAN;
	else if (strcmp(what, "leap") == 0)
		sample.position_m[0] += 0.4;
	else if (strcmp(what, "stale") == 0)
		sample.source_time_ns -= 2000000000;
	else if (strcmp(what, "back") == 0)
		sample.sequence_number = 1;
	else if (strcmp(what, "huge") == 0)
		sample.sequence_number = UINT64_MAX;
	else if (strcmp(what, "infinite") == 0)
		sample.position_m[2] = INFINITY;
	else if (strcmp(what, "session") == 0)
		snprintf(sample.session, sizeof sample.session, "d1-other");
	if (c->ros)
		write_ros_pose(c, sample.position_m);
	else
		write_native(c, &sample);
}

// Writes the storm's bad samples of one millisecond.
static void write_storm(controller *c)
{
	static const char *const kinds[] = {"nan", "huge", "session"};
	for (int left = (int)(c->storm_hz * STORM_PERIOD_S); left > 0; left--)
		write_once(c, kinds[c->stormed++ % 3]);
}

// Writes some of the strangers. If the writer's queue is full, the rest waits.
static void write_strangers(controller *c)
{
	for (int left = STRANGERS_SHARE; left > 0 && c->strangers > 0; left--) {
		cautery_ToolCommand sample = command_now(c);
		char *name = c->made_up % 2 ? sample.tool : sample.session;
		memcpy(sample.tool, c->tool, sizeof c->tool);
		snprintf(name, NAME_BYTES, "made-up-%ld", c->made_up);
		dds_return_t code = dds_write(c->command, &sample);
		if (code == DDS_RETCODE_TIMEOUT)
			return;
		checked(code);
		c->made_up++;
		if (--c->strangers == 0)
			printf("{\"event\":\"strangers\"}\n");
	}
}

// ---- events and commands
static void tell_state(const controller *c, const char *event)
{
	const cautery_ToolState *s = &c->state;
	const cautery_ToolGrasp *h = &c->holding;
	const cautery_ToolPower *p = &c->power;
	const cautery_ToolForce *f = &c->felt;
	printf("{\"event\":\"%s\",\"has\":%s,\"stormed\":%llu,\"tick\":%llu,\"sequence\":%llu,"
	       "\"position_m\":[%.6f,%.6f,%.6f],\"energized\":%s,\"energy_off\":%d,\"driver\":%u,"
	       "\"driver_name\":\"%s\",\"grasping\":%s,\"jaw\":%.6f,\"asked_jaw\":%.6f,"
	       "\"jaw_force_n\":%.6f,\"held\":%u,\"slipping\":%s,\"holding\":%s,"
	       "\"has_power\":%s,\"set_w\":%.6f,\"power_w\":%.6f,\"load_ohm\":%.6f,\"energy_j\":%.6f,"
	       "\"power_on\":%s,\"has_force\":%s,\"force_tick\":%llu,\"filter_s\":%.17g,"
	       "\"raw_z_n\":%.17g,\"z_n\":%.17g,\"state_z_n\":%.17g}\n",
	       event, c->has_state ? "true" : "false", (unsigned long long)c->stormed,
	       (unsigned long long)s->tick, (unsigned long long)s->sequence_number, s->position_m[0],
	       s->position_m[1], s->position_m[2], s->energized ? "true" : "false", (int)s->energy_off,
	       s->driver, s->driver_name, s->grasping ? "true" : "false", h->jaw, h->asked_jaw,
	       h->jaw_force_n, h->grasped_vertices, h->slipping ? "true" : "false",
	       h->grasping ? "true" : "false", *p->tool ? "true" : "false", p->set_w, p->power_w,
	       p->load_ohm, p->energy_j, p->energized ? "true" : "false", *f->tool ? "true" : "false",
	       (unsigned long long)f->tick, f->filter_s, f->raw_force_n[2], f->force_n[2],
	       s->force_n[2]);
}

static void take_state(void *user, const void *sample)
{
	controller *c = user;
	const cautery_ToolState *s = sample;
	if (strcmp(s->tool, c->tool) != 0)
		return;
	bool changed = !c->has_state || s->energized != c->state.energized ||
	               s->driver != c->state.driver || s->grasping != c->state.grasping;
	c->state = *s;
	c->has_state = true;
	if (changed)
		tell_state(c, "changed");
}

static void take_grasp(void *user, const void *sample)
{
	controller *c = user;
	const cautery_ToolGrasp *s = sample;
	if (strcmp(s->tool, c->tool) == 0)
		c->holding = *s;
}

static void take_power(void *user, const void *sample)
{
	controller *c = user;
	const cautery_ToolPower *s = sample;
	if (strcmp(s->tool, c->tool) == 0)
		c->power = *s;
}

static void take_force(void *user, const void *sample)
{
	controller *c = user;
	const cautery_ToolForce *s = sample;
	if (strcmp(s->tool, c->tool) == 0)
		c->felt = *s;
}

static void obey(void *user, const char *line)
{
	controller *c = user;
	char word[16] = "", value[16] = "";
	if (sscanf(line, "aim %lf %lf %lf", &c->aim_m[0], &c->aim_m[1], &c->aim_m[2]) == 3)
		return;
	cautery_ToolInstrument wanted = {0};
	if (sscanf(line, "instrument %48s %48s %lf", wanted.instrument, wanted.mode, &wanted.power_w) ==
	    3) {
		c->becomes = wanted;
		return;
	}
	if (sscanf(line, "%15s %15s", word, value) < 1)
		return;
	bool on = strcmp(value, "1") == 0 || strcmp(value, "on") == 0;
	if (strcmp(word, "energy") == 0)
		c->energy = on;
	else if (strcmp(word, "ticks") == 0)
		c->ticks = atoi(value);
	else if (strcmp(word, "grasp") == 0)
		c->grasp = on;
	else if (strcmp(word, "once") == 0)
		write_once(c, value);
	else if (strcmp(word, "state") == 0)
		c->state_asked = true;
	else if (strcmp(word, "crtk") == 0)
		c->crtk_asked = true;
	else if (strcmp(word, "storm") == 0)
		c->storm_hz = atof(value);
	else if (strcmp(word, "strangers") == 0)
		c->strangers = atol(value);
	else if (strcmp(word, "power_w") == 0) {
		open_setting(c);
		c->sets = true;
		c->set_w = atof(value);
		write_setting(c);
	} else if (strcmp(word, "command") == 0)
		crtk_command(&c->crtk, value);
	else if (strcmp(word, "jaw") == 0)
		crtk_jaw(&c->crtk, atof(value));
	for (int i = 0; strcmp(word, "flood") == 0 && i < atoi(value); i++)
		write_once(c, "nan");
	if (strcmp(word, "write") != 0)
		return;
	c->writing = on;
	if (!on)
		printf("{\"event\":\"silent\",\"last_us\":%.0f}\n", 1e6 * c->last_write_s);
}

static void run(controller *c)
{
	console input = {.kept_bytes = 0};
	double next_s = clock_s(CLOCK_MONOTONIC);
	while (console_listen(&input, next_s - clock_s(CLOCK_MONOTONIC), obey, c)) {
		take_each(c->state_reader, take_state, c);
		take_each(c->grasp_reader, take_grasp, c);
		take_each(c->power_reader, take_power, c);
		take_each(c->force_reader, take_force, c);
		if (c->ros)
			crtk_read(&c->crtk);
		if (clock_s(CLOCK_MONOTONIC) < next_s)
			continue;
		write_strangers(c);
		next_s += c->storm_hz > 0 ? STORM_PERIOD_S : PERIOD_S;
		if (c->state_asked)
			tell_state(c, "state");
		if (c->crtk_asked)
			crtk_tell(&c->crtk);
		c->state_asked = c->crtk_asked = false;
		if (!c->matched && is_matched(c->ros ? c->pose : c->command) &&
		    (!c->ros || (is_matched(c->level) && crtk_matched(&c->crtk))) && c->has_state) {
			c->matched = true;
			printf("{\"event\":\"matched\"}\n");
		}
		write_setting(c);
		write_instrument(c);
		if (c->storm_hz > 0)
			write_storm(c);
		else if (c->writing && c->matched)
			write_good(c);
	}
}

int main(int argument_count, char **arguments)
{
	controller c = {.position_m = {0, 0, 0.02}, .aim_m = {0, 0, 0.02}};
	if (argument_count != 6) {
		fprintf(stderr, "usage: controller DOMAIN SESSION TOOL native|ros|sensor|loose|mistyped "
		                "DEADLINE_MS\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0);
	snprintf(c.session, sizeof c.session, "%s", arguments[2]);
	snprintf(c.tool, sizeof c.tool, "%s", arguments[3]);
	c.sensor = strcmp(arguments[4], "sensor") == 0;
	c.loose = strcmp(arguments[4], "loose") == 0;
	c.mistyped = strcmp(arguments[4], "mistyped") == 0;
	c.ros = strcmp(arguments[4], "native") != 0;
	open_wire(&c, (uint32_t)atoi(arguments[1]), atoi(arguments[5]));
	run(&c);
	dds_delete(c.participant);
	return 0;
}
