// SPDX-License-Identifier: Apache-2.0
// An example of a haptic device without hardware. A simulated hand presses the ball of the scene
// `fat` into the tissue and holds it there. The program has the whole loop of a real device. Only
// device_move replaces reading the position and setting the motors.
//
//   cautery-device [ws://127.0.0.1:8740]
//
// The program creates a session and joins it with the channel tool_contact. It renders a thousand
// times a second for four seconds, reports the force, and removes the session. On a machine that
// makes fewer than 20 ticks a second, each record grows too old before the next one arrives, and
// the force fades.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/client.h"
#include "cautery/defaults.h"
#include "cautery/haptics.h"

static const char tool_name[] = "ball"; // name of the tool in the scene
static const double period_s = 0.001;
// Heights that the hand wants at first and at the end, m.
static const double above_m = 0.004, below_m = -0.001;
static const double press_s = 1, hold_s = 3, report_every_s = 0.5;
enum { POSE_PERIODS = 4, LATE_PERIODS = 50 };

// The hand: a mass with damping. A spring pulls it to the wanted position.
static const double mass_kg = 0.05, damping_ns_m = 0.3, stiffness_n_m = 100;

typedef struct program {
	cau_loop *loop;
	cau_client *client;
	cau_client_stream *stream;
	cau_haptics *haptics;
	char session[CAU_NAME_BYTES];
	uint64_t sequence, tick; // sequence of the last command; tick of the last record
	int record_count;
	cau_haptics_device device;
	double least_n, most_n; // least and largest force along z in the last second
} program;

// Moves the device for one period under the force of its motors.
static void device_move(cau_haptics_device *device, const double wanted_m[3],
                        const double force_n[3])
{
	for (int i = 0; i < 3; i++) {
		double own = stiffness_n_m * (wanted_m[i] - device->pose.position_m[i]) -
		             damping_ns_m * device->velocity_m_s[i];
		device->velocity_m_s[i] += period_s / mass_kg * (own + force_n[i]);
		device->pose.position_m[i] += period_s * device->velocity_m_s[i];
	}
}

// Commands the tool to the device's position. The server sends no answer.
static cau_status send_pose(program *p, cau_error *error)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_TOOL_MOVE);
	snprintf(command.tool, sizeof command.tool, "%s", tool_name);
	command.sequence = ++p->sequence;
	memcpy(command.as.move.pose.position_m, p->device.pose.position_m,
	       sizeof command.as.move.pose.position_m);
	return cau_client_move(p->client, p->session, &command, error);
}

// Passes the tool's contact record of a new tick to the renderer.
static void take_record(program *p)
{
	const cau_stream_state *state = p->stream->state;
	if (!state->synced || state->tick == p->tick)
		return;
	p->tick = state->tick;
	for (int32_t i = 0; i < state->contact_count; i++)
		if (!strcmp(state->contacts[i].name, tool_name))
			cau_haptics_take(p->haptics, &state->contacts[i]);
	p->record_count++;
}

// One period of 1 ms. A real device would read its position and set its motors to the force here.
static cau_status serve(program *p, int period, cau_error *error)
{
	double now_s = period * period_s, share = fmin(now_s / press_s, 1), force_n[3];
	const double wanted_m[3] = {0, 0, above_m + share * (below_m - above_m)};
	cau_haptics_render(p->haptics, &p->device, now_s, force_n);
	if (now_s >= press_s + hold_s - 1) {
		p->least_n = fmin(p->least_n, force_n[2]);
		p->most_n = fmax(p->most_n, force_n[2]);
	}
	if (period % (int)(report_every_s / period_s) == 0)
		printf("%.1f s  ball at %6.2f mm  %.3f N\n", now_s, 1e3 * p->device.pose.position_m[2],
		       force_n[2]);
	device_move(&p->device, wanted_m, force_n);
	return period % POSE_PERIODS ? CAU_OK : send_pose(p, error);
}

// Runs the periods that are due by the clock. After a delay on a busy machine some periods follow
// each other at once, which a real device must not do.
static cau_status run(program *p, cau_error *error)
{
	double start_s = cau_client_now();
	int periods = (int)((press_s + hold_s) / period_s), done = 0;
	cau_client_keep_alive(p->client, true);
	while (done < periods) {
		int due = (int)((cau_client_now() - start_s) / period_s);
		// After a long delay the due periods are postponed, so that they do not all follow at once.
		if (due > done + LATE_PERIODS) {
			start_s += (due - done) * period_s;
			continue;
		}
		for (; done < due && done < periods; done++) {
			cau_status status = serve(p, done, error);
			if (status)
				return status;
		}
		cau_loop_wait(p->loop, period_s / 2);
		if (cau_client_get_condition(p->client) != CAU_CLIENT_READY) {
			*error = *cau_client_trouble(p->client);
			return CAU_IO;
		}
		take_record(p);
	}
	printf("held with %.3f N, %.4f N peak to peak in the last second; %.0f records a second\n",
	       p->most_n, p->most_n - p->least_n, p->record_count / (press_s + hold_s));
	return CAU_OK;
}

static cau_status begin(program *p, const char *url, cau_error *error)
{
	cau_client_def def = cau_default_client_def();
	cau_haptics_def haptics = cau_default_haptics_def();
	haptics.mass_kg = mass_kg;
	def.url = url;
	def.name = "cautery-device";
	cau_status status = cau_haptics_create(&haptics, &p->haptics, error);
	if (!status)
		status = cau_loop_create(&p->loop, error);
	if (!status)
		status = cau_client_create(p->loop, &def, &p->client, error);
	return status ? status : cau_client_connect(p->client, error);
}

static cau_status create_session(program *p, cau_error *error)
{
	cau_wire_session_create params = {.has_client_sequence = true, .has_scene = true};
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_description made = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                     .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	params.client_sequence = cau_client_next_sequence(p->client);
	snprintf(params.scene, sizeof params.scene, "%s", "fat");
	cau_status status =
		cau_client_call(p->client, CAU_METHOD_SESSION_CREATE, &params, &made, error);
	snprintf(p->session, sizeof p->session, "%s", made.summary.session);
	return status;
}

static cau_status join_and_take(program *p, cau_error *error)
{
	cau_wire_session_join join = {.has_session = true,
	                              .has_rate_hz = true,
	                              .rate_hz = 1000, // a frame for each tick
	                              .has_channels = true,
	                              .channels = CAU_CHANNEL_TOOL_CONTACT};
	cau_wire_tool_ref take = {.has_session = true, .has_client_sequence = true};
	snprintf(join.session, sizeof join.session, "%s", p->session);
	snprintf(take.session, sizeof take.session, "%s", p->session);
	snprintf(take.tool, sizeof take.tool, "%s", tool_name);
	take.client_sequence = cau_client_next_sequence(p->client);
	cau_status status = cau_client_join(p->client, &join, &p->stream, error);
	return status ? status
	              : cau_client_call(p->client, CAU_METHOD_TOOL_TAKE_OVER, &take, NULL, error);
}

static cau_status remove_session(program *p, cau_error *error)
{
	cau_wire_session_change params = {.has_session = true, .has_client_sequence = true};
	snprintf(params.session, sizeof params.session, "%s", p->session);
	params.client_sequence = cau_client_next_sequence(p->client);
	return cau_client_call(p->client, CAU_METHOD_SESSION_DESTROY, &params, NULL, error);
}

int main(int argument_count, char **arguments)
{
	program p = {.device.pose = {.position_m = {0, 0, above_m}, .rotation = {1, 0, 0, 0}},
	             .least_n = INFINITY,
	             .most_n = -INFINITY};
	cau_error error = {0};
	cau_status status =
		begin(&p, argument_count > 1 ? arguments[1] : CAU_CLIENT_DEFAULT_URL, &error);
	if (!status)
		status = create_session(&p, &error);
	if (!status)
		status = join_and_take(&p, &error);
	if (!status)
		status = run(&p, &error);
	if (!status)
		status = remove_session(&p, &error);
	if (status)
		fprintf(stderr, "cautery-device: %s %s\n", error.path, error.reason);
	if (p.client)
		cau_client_close(p.client);
	cau_client_destroy(p.client);
	cau_loop_destroy(p.loop);
	cau_haptics_destroy(p.haptics);
	return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
