// SPDX-License-Identifier: GPL-3.0-or-later
// Publishes the states of tools: cautery/tool_state, cautery/tool_grasp, cautery/tool_power,
// cautery/tool_force, measured_cp, setpoint_cp, measured_cf, raw/measured_cf, jaw/measured_js,
// jaw/setpoint_js.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "ros2.h"
#include "transport_dds/internal.h"

#define UNREAD_PERIOD_S 1.0 // time between writes while there are no readers

static char world_frame[] = "world", jaw_text[] = "jaw";
static char *jaw_name = jaw_text;

static void publish_state(const cau_dds_session *session, const cau_hosted_tool *tool,
                          uint64_t tick, double time_s)
{
	const cau_tool_state *state = &tool->state;
	cautery_ToolState sample = {
		.tick = tick,
		.time_s = time_s,
		.sequence_number = state->sequence,
		.jaw = state->jaw,
		.tip_temperature_c = state->tip_temperature_c,
		.energy_j = state->energy_j,
		.touched_layers = (uint32_t)state->touched_layers,
		.contact_vertices = (uint32_t)state->contact_vertices,
		.grasped_vertices = (uint32_t)state->grasped_vertices,
		.driver = tool->driver.client,
		.energized = state->energized,
		.grasping = state->grasping,
		.energy_off = (cautery_EnergyOff)tool->energy_off,
	};
	snprintf(sample.session, sizeof sample.session, "%s", cau_hosted_id(session->hosted));
	snprintf(sample.tool, sizeof sample.tool, "%s", state->name);
	snprintf(sample.driver_name, sizeof sample.driver_name, "%s", tool->driver.name);
	memcpy(sample.position_m, state->pose.position_m, sizeof sample.position_m);
	memcpy(sample.rotation, state->pose.rotation, sizeof sample.rotation);
	memcpy(sample.force_n, state->force_n, sizeof sample.force_n);
	memcpy(sample.torque_nm, state->torque_nm, sizeof sample.torque_nm);
	dds_write(session->state.writer, &sample);
}

static void publish_grasp(const cau_dds_session *session, const cau_tool_state *state,
                          uint64_t tick)
{
	cautery_ToolGrasp sample = {
		.tick = tick,
		.jaw = state->jaw,
		.asked_jaw = state->asked_jaw,
		.jaw_force_n = state->jaw_force_n,
		.grasped_vertices = (uint32_t)state->grasped_vertices,
		.grasping = state->grasping,
		.slipping = state->slipping,
	};
	snprintf(sample.session, sizeof sample.session, "%s", cau_hosted_id(session->hosted));
	snprintf(sample.tool, sizeof sample.tool, "%s", state->name);
	dds_write(session->grasp.writer, &sample);
}

static void publish_power(const cau_dds_session *session, const cau_tool_state *state,
                          uint64_t tick)
{
	cautery_ToolPower sample = {
		.tick = tick,
		.set_w = state->definition.power_w,
		.peak_v = state->definition.peak_v,
		.crest_factor = state->definition.crest_factor,
		.current_max_a = state->definition.current_max_a,
		.power_w = state->delivered_w,
		.load_ohm = state->load_ohm,
		.energy_j = state->energy_j,
		.energized = state->energized,
	};
	snprintf(sample.session, sizeof sample.session, "%s", cau_hosted_id(session->hosted));
	snprintf(sample.tool, sizeof sample.tool, "%s", state->name);
	dds_write(session->power.writer, &sample);
}

static void publish_force(const cau_dds_session *session, const cau_tool_state *state,
                          uint64_t tick)
{
	cautery_ToolForce sample = {.tick = tick, .filter_s = state->definition.force_filter_s};
	snprintf(sample.session, sizeof sample.session, "%s", cau_hosted_id(session->hosted));
	snprintf(sample.tool, sizeof sample.tool, "%s", state->name);
	memcpy(sample.raw_force_n, state->raw_force_n, sizeof sample.raw_force_n);
	memcpy(sample.raw_torque_nm, state->raw_torque_nm, sizeof sample.raw_torque_nm);
	memcpy(sample.force_n, state->force_n, sizeof sample.force_n);
	memcpy(sample.torque_nm, state->torque_nm, sizeof sample.torque_nm);
	dds_write(session->force.writer, &sample);
}

bool cau_dds_has_jaws(const cau_tool_state *state)
{
#define X(code, word, hot, jaws, ...) jaws,
	static const bool any[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X
	CAU_ASSERT_INDEX(state->definition.shape, CAU_TOOL_SHAPE_COUNT);
	return any[state->definition.shape];
}

static bool has_energy(const cau_tool_state *state)
{
#define X(code, word, hot, jaws, ...) hot,
	static const bool any[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X
	CAU_ASSERT_INDEX(state->definition.shape, CAU_TOOL_SHAPE_COUNT);
	return any[state->definition.shape];
}

static std_msgs_msg_dds__Header_ header_now(void)
{
	int64_t now_us = cau_wall_us();
	return (std_msgs_msg_dds__Header_){
		{(int32_t)(now_us / 1000000), (uint32_t)(now_us % 1000000) * 1000}, world_frame};
}

// True if the outlet's sample must be written now.
static bool is_due(cau_dds_outlet *outlet, bool changed)
{
	if (outlet->writer <= 0 || !cau_dds_is_read(outlet))
		return false;
	return cau_dds_take_newcomers(outlet) || changed;
}

static void publish_pose(cau_dds_outlet *outlet, const cau_pose *pose, bool changed)
{
	const double *p = pose->position_m, *q = pose->rotation;
	if (!is_due(outlet, changed))
		return;
	geometry_msgs_msg_dds__PoseStamped_ sample = {
		header_now(), {{p[0], p[1], p[2]}, {.x_ = q[1], .y_ = q[2], .z_ = q[3], .w_ = q[0]}}};
	dds_write(outlet->writer, &sample);
}

static void publish_joint(cau_dds_outlet *outlet, double angle_rad, double *moment_nm, bool changed)
{
	if (!is_due(outlet, changed))
		return;
	sensor_msgs_msg_dds__JointState_ jaw = {.header_ = header_now(),
	                                        .name_ = {1, 1, &jaw_name, false},
	                                        .position_ = {1, 1, &angle_rad, false}};
	if (moment_nm)
		jaw.effort_ = (dds_sequence_double){1, 1, moment_nm, false};
	dds_write(outlet->writer, &jaw);
}

static void publish_wrench(cau_dds_outlet *outlet, const double f[3], const double t[3],
                           bool changed)
{
	if (!is_due(outlet, changed))
		return;
	geometry_msgs_msg_dds__WrenchStamped_ sample = {header_now(),
	                                                {{f[0], f[1], f[2]}, {t[0], t[1], t[2]}}};
	dds_write(outlet->writer, &sample);
}

static void publish_measured(cau_dds_tool *wire, const cau_tool_state *state, bool changed)
{
	publish_pose(&wire->pose, &state->pose, changed);
	publish_pose(&wire->asked, &state->asked_pose, changed);
	publish_wrench(&wire->force, state->force_n, state->torque_nm, changed);
	publish_wrench(&wire->raw_force, state->raw_force_n, state->raw_torque_nm, changed);
	const double open_rad = state->definition.jaw_open_rad;
	double moment_nm = state->jaw_force_n * state->definition.tip_length_m;
	publish_joint(&wire->jaw, state->jaw * open_rad, &moment_nm, changed);
	publish_joint(&wire->asked_jaw, state->asked_jaw * open_rad, NULL, changed);
}

void cau_dds_unpublish(const cau_dds_session *session, const char *tool)
{
	cautery_ToolState gone = {0};
	snprintf(gone.session, sizeof gone.session, "%s", cau_hosted_id(session->hosted));
	snprintf(gone.tool, sizeof gone.tool, "%s", tool);
	dds_dispose(session->state.writer, &gone);
	cautery_ToolGrasp nothing = {0};
	memcpy(nothing.session, gone.session, sizeof nothing.session);
	memcpy(nothing.tool, gone.tool, sizeof nothing.tool);
	dds_dispose(session->grasp.writer, &nothing);
	cautery_ToolPower none = {0};
	memcpy(none.session, gone.session, sizeof none.session);
	memcpy(none.tool, gone.tool, sizeof none.tool);
	dds_dispose(session->power.writer, &none);
	cautery_ToolForce unloaded = {0};
	memcpy(unloaded.session, gone.session, sizeof unloaded.session);
	memcpy(unloaded.tool, gone.tool, sizeof unloaded.tool);
	dds_dispose(session->force.writer, &unloaded);
}

// True if the state must be written at once, so that a late joiner never reads an old value.
static bool is_news(const cau_hosted_tool *was, const cau_hosted_tool *now)
{
	return was->driver.client != now->driver.client || was->energized != now->energized ||
	       was->energy_off != now->energy_off || strcmp(was->state.name, now->state.name) != 0;
}

double cau_dds_states_due(const cau_dds_session *session)
{
	for (int32_t i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->states_owed[i])
			return session->states_s + UNREAD_PERIOD_S;
	return INFINITY;
}

// A topic of tools other than cautery/tool_state.
typedef struct own_topic {
	bool (*has)(const cau_tool_state *state); // selects the tools that have the topic; NULL: all
	void (*publish)(const cau_dds_session *session, const cau_tool_state *state, uint64_t tick);
	bool is_read, newcomers;
} own_topic;

static own_topic own_topic_of(cau_dds_outlet *outlet, bool (*has)(const cau_tool_state *state),
                              void (*publish)(const cau_dds_session *session,
                                              const cau_tool_state *state, uint64_t tick))
{
	return (own_topic){has, publish, cau_dds_is_read(outlet), cau_dds_take_newcomers(outlet)};
}

void cau_dds_publish(cau_dds_session *session, const cau_hosted_tool *tools, int32_t count,
                     uint64_t tick, double time_s, double now_s)
{
	bool is_read = cau_dds_is_read(&session->state);
	const own_topic own[] = {own_topic_of(&session->grasp, cau_dds_has_jaws, publish_grasp),
	                         own_topic_of(&session->power, has_energy, publish_power),
	                         own_topic_of(&session->force, NULL, publish_force)};
	bool newcomers = cau_dds_take_newcomers(&session->state);
	bool due = now_s >= cau_dds_states_due(session);
	if (newcomers || due)
		session->states_s = now_s;
	// Nothing is owed for removed tools.
	memset(session->states_owed + count, 0, (size_t)(CAU_MAX_TOOLS - count));
	for (int32_t i = 0; i < count; i++) {
		cau_hosted_tool *last = &session->states[i];
		cau_dds_tool *wire = cau_dds_find_tool(session, tools[i].state.name);
		// Padding bytes may differ; then the state is written once more.
		// NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
		bool moved = memcmp(last, &tools[i], sizeof *last) != 0;
		bool changed = moved || session->states_tick != tick;
		bool all = newcomers || (due && session->states_owed[i]);
		session->states_owed[i] &= !all;
		if (all || (changed && (is_read || is_news(last, &tools[i]))))
			publish_state(session, &tools[i], tick, time_s);
		else
			session->states_owed[i] |= moved;
		for (size_t k = 0; k < sizeof own / sizeof *own; k++) {
			if (own[k].has && !own[k].has(&tools[i].state))
				continue;
			if (all || own[k].newcomers || (changed && own[k].is_read))
				own[k].publish(session, &tools[i].state, tick);
			else
				session->states_owed[i] |= moved;
		}
		*last = tools[i];
		if (wire)
			publish_measured(wire, &tools[i].state, changed);
	}
	session->states_tick = tick;
}
