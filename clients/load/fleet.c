// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double slow_reads_s = 0.05, slow_pauses_s = 0.95;
static const double settle_s = 5.0; // longest wait until slow readers have caught up

// ---- setting up --------------------------------------------------------------------------------
static cau_status connect_viewer(load_fleet *fleet, load_session *session, load_viewer *viewer)
{
	cau_client_def def = cau_default_client_def();
	bool drives = viewer == &session->viewers[0];
	viewer->session = session;
	viewer->reading = true;
	def.url = fleet->options->url;
	def.token = fleet->options->token;
	def.name = drives ? "cautery-load driver" : "cautery-load viewer";
	def.role = drives ? -1 : CAU_ROLE_VIEW;
	def.reconnect = !drives; // the loss of a driver ends the measurement
	def.on_frame = load_take_frame;
	def.user = viewer;
	cau_status status = cau_client_create(fleet->loop, &def, &viewer->client, &fleet->error);
	return status ? status : cau_client_connect(viewer->client, &fleet->error);
}

static cau_status join(load_fleet *fleet, load_viewer *viewer)
{
	cau_wire_session_join params = {
		.has_session = true, .has_rate_hz = true, .rate_hz = fleet->options->rate_hz};
	memcpy(params.session, viewer->session->id, sizeof params.session);
	return cau_client_join(viewer->client, &params, &viewer->stream, &fleet->error);
}

// Takes the driver's motion from the scene's cut. A scene without a cut is an error.
static cau_status take_motion(load_session *session, const cau_scene_def *scene, cau_error *error)
{
	if (!scene->cut.present)
		return cau_fail(error, CAU_BAD_VALUE, "scene", "scene `%s` has no member cut", scene->name);
	session->cut = scene->cut;
	memcpy(session->tool, scene->cut.tool, sizeof session->tool);
	return CAU_OK;
}

static cau_status create_session(load_fleet *fleet, load_session *session, int32_t index)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_create params = {
		.has_client_sequence = true, .has_name = true, .has_scene = true};
	cau_wire_session_description d = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                  .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	cau_client *client = session->viewers[0].client;
	params.client_sequence = cau_client_next_sequence(client);
	snprintf(params.name, sizeof params.name, "load-%d-%d", (int)getpid(), index);
	snprintf(params.scene, sizeof params.scene, "%s", fleet->options->scene);
	d.definition = calloc(1, sizeof *d.definition);
	if (!d.definition)
		return cau_fail(&fleet->error, CAU_NO_MEMORY, NULL, "no memory for a scene");
	cau_status status =
		cau_client_call(client, CAU_METHOD_SESSION_CREATE, &params, &d, &fleet->error);
	if (!status) {
		memcpy(session->id, d.summary.session, sizeof session->id);
		status = take_motion(session, d.definition, &fleet->error);
	}
	free(d.definition);
	return status;
}

static cau_status start_driving(load_fleet *fleet, load_session *session)
{
	cau_client *client = session->viewers[0].client;
	cau_wire_tool_ref tool = {.has_session = true, .has_client_sequence = true};
	cau_command on = {.kind = CAU_COMMAND_TOOL_ENERGIZE, .as.energized = 1};
	memcpy(tool.session, session->id, sizeof tool.session);
	memcpy(tool.tool, session->tool, sizeof tool.tool);
	memcpy(on.tool, session->tool, sizeof on.tool);
	tool.client_sequence = cau_client_next_sequence(client);
	cau_status status =
		cau_client_call(client, CAU_METHOD_TOOL_TAKE_OVER, &tool, NULL, &fleet->error);
	cau_client_keep_alive(client, true);
	if (!status)
		status = cau_client_command(client, session->id, &on, NULL, &fleet->error);
	session->driver.start_s = session->driver.due_s = cau_client_now();
	return status;
}

static cau_status start_session(load_fleet *fleet, load_session *session, int32_t index)
{
	session->fleet = fleet;
	session->viewers = calloc((size_t)fleet->options->viewers, sizeof *session->viewers);
	session->driver.acknowledged =
		calloc(LOAD_ACKNOWLEDGED_MAX, sizeof *session->driver.acknowledged);
	if (!session->viewers || !session->driver.acknowledged)
		return cau_fail(&fleet->error, CAU_NO_MEMORY, NULL, "no memory for the viewers");
	cau_status status = connect_viewer(fleet, session, &session->viewers[0]);
	if (!status)
		status = create_session(fleet, session, index);
	if (!status)
		status = join(fleet, &session->viewers[0]);
	return status ? status : start_driving(fleet, session);
}

cau_status load_fleet_start(load_fleet *fleet, const load_options *options)
{
	*fleet = (load_fleet){.options = options};
	fleet->sessions = calloc((size_t)options->sessions, sizeof *fleet->sessions);
	if (!fleet->sessions)
		return cau_fail(&fleet->error, CAU_NO_MEMORY, NULL, "no memory for the sessions");
	cau_status status = cau_loop_create(&fleet->loop, &fleet->error);
	for (int32_t i = 0; !status && i < options->sessions; i++)
		status = start_session(fleet, &fleet->sessions[i], i);
	if (!status)
		status = cau_client_measure_clock(fleet->sessions[0].viewers[0].client, 32, &fleet->clock,
		                                  &fleet->error);
	return status;
}

cau_status load_fleet_add_viewers(load_fleet *fleet)
{
	cau_status status = CAU_OK;
	int32_t others = fleet->options->sessions * (fleet->options->viewers - 1), index = 0;
	int32_t slow = (int32_t)ceil(fleet->options->slow_pct / 100.0 * others);
	for (int32_t v = 1; v < fleet->options->viewers; v++)
		for (int32_t s = 0; !status && s < fleet->options->sessions; s++, index++) {
			load_viewer *viewer = &fleet->sessions[s].viewers[v];
			status = connect_viewer(fleet, &fleet->sessions[s], viewer);
			if (!status)
				status = join(fleet, viewer);
			viewer->slow = index < slow;
			viewer->turn_s = cau_client_now();
		}
	return status;
}

// ---- running -----------------------------------------------------------------------------------
static void take_turn(load_viewer *viewer, double now_s)
{
	if (!viewer->slow || now_s < viewer->turn_s)
		return;
	viewer->reading = !viewer->reading;
	viewer->turn_s = now_s + (viewer->reading ? slow_reads_s : slow_pauses_s);
	cau_client_read(viewer->client, viewer->reading);
}

static cau_status drive_all(load_fleet *fleet, double now_s, double *next_s)
{
	cau_status status = CAU_OK;
	for (int32_t s = 0; !status && s < fleet->options->sessions; s++) {
		load_session *session = &fleet->sessions[s];
		const cau_client *driver = session->viewers[0].client;
		if (cau_client_follows(driver)) // the driver's session has moved
			continue;
		if (cau_client_get_condition(driver) != CAU_CLIENT_READY) {
			fleet->error = *cau_client_trouble(driver);
			return CAU_IO;
		}
		status = load_drive(session, now_s);
		*next_s = fmin(*next_s, session->driver.due_s);
		for (int32_t v = 1; v < fleet->options->viewers; v++)
			if (session->viewers[v].client)
				take_turn(&session->viewers[v], now_s);
	}
	return status;
}

cau_status load_fleet_run(load_fleet *fleet, double seconds)
{
	cau_status status = CAU_OK;
	double until_s = cau_client_now() + seconds;
	while (!status && !*fleet->options->interrupted) {
		double now_s = cau_client_now(), next_s = until_s;
		if (now_s >= until_s)
			break;
		status = drive_all(fleet, now_s, &next_s);
		cau_loop_wait(fleet->loop, fmax(0, next_s - cau_client_now()));
	}
	return status;
}

// ---- ending ------------------------------------------------------------------------------------
static bool in_step(const load_viewer *viewer, uint64_t tick)
{
	return viewer->stream && viewer->stream->state->synced && viewer->stream->state->tick >= tick;
}

static int64_t count_behind(const load_fleet *fleet)
{
	int64_t behind = 0;
	for (int32_t s = 0; s < fleet->options->sessions; s++) {
		const load_session *session = &fleet->sessions[s];
		uint64_t tick = session->viewers[0].stream->state->tick;
		// Largest accepted lag, in ticks: half a second, because frames are still on their way.
		uint64_t slack = 30;
		for (int32_t v = 1; v < fleet->options->viewers; v++)
			behind += !in_step(&session->viewers[v], tick > slack ? tick - slack : 0);
	}
	return behind;
}

void load_fleet_settle(load_fleet *fleet)
{
	for (int32_t s = 0; s < fleet->options->sessions; s++)
		for (int32_t v = 1; v < fleet->options->viewers; v++) {
			load_viewer *viewer = &fleet->sessions[s].viewers[v];
			if (viewer->slow)
				cau_client_read(viewer->client, true);
			viewer->slow = false;
		}
	double until_s = cau_client_now() + settle_s;
	for (double now_s; count_behind(fleet) && (now_s = cau_client_now()) < until_s;) {
		double next_s = until_s;
		if (drive_all(fleet, now_s, &next_s))
			break;
		cau_loop_wait(fleet->loop, fmax(0, next_s - cau_client_now()));
	}
	fleet->gaps_unrecovered += (uint64_t)count_behind(fleet);
}

static void finish_session(load_fleet *fleet, load_session *session)
{
	cau_wire_session_change params = {.has_session = true, .has_client_sequence = true};
	memcpy(params.session, session->id, sizeof params.session);
	for (int32_t v = fleet->options->viewers - 1; session->viewers && v >= 0; v--) {
		cau_client *client = session->viewers[v].client;
		if (!client)
			continue;
		if (v == 0 && *session->id) {
			params.client_sequence = cau_client_next_sequence(client);
			cau_client_call(client, CAU_METHOD_SESSION_DESTROY, &params, NULL, NULL);
		}
		cau_client_close(client);
		cau_client_destroy(client);
	}
	free(session->viewers);
	free(session->driver.acknowledged);
}

void load_fleet_finish(load_fleet *fleet)
{
	for (int32_t s = 0; fleet->sessions && s < fleet->options->sessions; s++)
		finish_session(fleet, &fleet->sessions[s]);
	free(fleet->sessions);
	cau_loop_destroy(fleet->loop);
	load_samples_finish(&fleet->frame_ms);
	load_samples_finish(&fleet->command_ms);
}
