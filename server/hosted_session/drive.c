// SPDX-License-Identifier: GPL-3.0-or-later
// Who drives which tool, and how energy goes off. The table changes on the worker, under the mutex;
// transports and the watchdog feed it and ask for cuts.
#include <math.h>
#include <string.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"

enum { REFUSALS_TOLD_EVERY_S = 1 };

cau_drive *cau_drive_find(cau_hosted *h, const char *tool)
{
	for (int32_t i = 0; i < h->drive_count; i++)
		if (strcmp(h->drives[i].tool, tool) == 0)
			return &h->drives[i];
	return NULL;
}

void cau_drive_add(cau_hosted *h, const char *tool, const cau_asker *driver)
{
	pthread_mutex_lock(&h->mutex);
	if (h->drive_count < CAU_MAX_TOOLS) {
		cau_drive *made = &h->drives[h->drive_count++];
		*made =
			(cau_drive){.last_s = cau_monotonic_s(), .energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
		memcpy(made->tool, tool, sizeof made->tool);
		if (driver)
			made->driver = *driver;
	}
	pthread_mutex_unlock(&h->mutex);
}

void cau_drive_remove(cau_hosted *h, const char *tool)
{
	pthread_mutex_lock(&h->mutex);
	cau_drive *gone = cau_drive_find(h, tool);
	if (gone) {
		size_t after = (size_t)(&h->drives[h->drive_count] - (gone + 1));
		memmove(gone, gone + 1, after * sizeof *gone);
		h->drive_count--;
	}
	pthread_mutex_unlock(&h->mutex);
}

void cau_drive_describe(const cau_drive *drive, cau_wire_driver *driver)
{
	*driver = (cau_wire_driver){.client = drive->driver.client,
	                            .energized = drive->energized,
	                            .energy_off = drive->energy_off};
	memcpy(driver->tool, drive->tool, sizeof driver->tool);
	if (drive->driver.client)
		snprintf(driver->name, sizeof driver->name, "%s", drive->driver.name);
}

void cau_drive_tell(cau_hosted *h, const cau_drive *drive)
{
	cau_wire_driver_changed params = {0};
	cau_audience audience = {CAU_AUDIENCE_SESSION, h->number};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	cau_drive_describe(drive, &params.driver);
	cau_answer_notify(h, audience, CAU_METHOD_TOOL_DRIVER_CHANGED, &params);
	h->dirty = true;
}

static const cau_tool_state *tool_state(const cau_frame *frame, const char *name)
{
	for (int32_t i = 0; i < frame->tool_count; i++)
		if (strcmp(frame->tools[i].name, name) == 0)
			return &frame->tools[i];
	return NULL;
}

static void energy_off_command(cau_hosted *h, const char *tool)
{
	cau_command off;
	cau_default_command(&off, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(off.tool, sizeof off.tool, "%s", tool);
	off.as.energized = 0;
	cau_hosted_command(h, &off);
}

// The tool's aim becomes where it is.
static void freeze_command(cau_hosted *h, const cau_tool_state *state)
{
	cau_command stay;
	cau_default_command(&stay, CAU_COMMAND_TOOL_MOVE);
	memcpy(stay.tool, state->name, sizeof stay.tool);
	stay.sequence = state->sequence;
	stay.as.move.pose = state->pose;
	stay.as.move.jaw = state->jaw;
	cau_hosted_command(h, &stay);
}

void cau_drive_cut(cau_hosted *h, cau_drive *drive, int energy_off, const char *cause)
{
	cau_frame frame;
	cau_session_frame(h->core, &frame);
	const cau_tool_state *state = tool_state(&frame, drive->tool);
	bool was_on = drive->energized || (state && state->energized);
	if (was_on)
		energy_off_command(h, drive->tool);
	if (state && energy_off != CAU_ENERGY_OFF_COMMANDED)
		freeze_command(h, state);
	pthread_mutex_lock(&h->mutex);
	drive->cut_wanted = drive->energized = false;
	drive->frozen = energy_off == CAU_ENERGY_OFF_WATCHDOG;
	if (was_on)
		drive->energy_off = energy_off;
	h->counts.watchdog_cuts += was_on && energy_off == CAU_ENERGY_OFF_WATCHDOG;
	pthread_mutex_unlock(&h->mutex);
	if (was_on)
		cau_event_add(
			h, energy_off == CAU_ENERGY_OFF_WATCHDOG ? CAU_EVENT_WATCHDOG : CAU_EVENT_ENERGY_OFF,
			drive->tool, drive->driver.name, 0, cause);
	cau_drive_tell(h, drive);
}

void cau_drive_cut_all(cau_hosted *h, int energy_off, const char *cause)
{
	for (int32_t i = 0; i < h->drive_count; i++)
		if (h->drives[i].energized || h->drives[i].cut_wanted)
			cau_drive_cut(h, &h->drives[i], energy_off, cause);
}

void cau_drive_apply_cuts(cau_hosted *h)
{
	for (int32_t i = 0; i < h->drive_count; i++) {
		cau_drive *drive = &h->drives[i];
		pthread_mutex_lock(&h->mutex);
		bool wanted = drive->cut_wanted;
		char cause[sizeof drive->cut_cause];
		memcpy(cause, drive->cut_cause, sizeof cause);
		pthread_mutex_unlock(&h->mutex);
		if (wanted)
			cau_drive_cut(h, drive, CAU_ENERGY_OFF_WATCHDOG, cause);
	}
}

// After a restore: one entry for each tool of the core; drivers stay with tools of the same name.
void cau_drive_match_tools(cau_hosted *h, const char *cause)
{
	cau_frame frame;
	cau_drive old[CAU_MAX_TOOLS];
	cau_session_frame(h->core, &frame);
	pthread_mutex_lock(&h->mutex);
	int32_t old_count = h->drive_count;
	memcpy(old, h->drives, sizeof old);
	h->drive_count = frame.tool_count;
	for (int32_t i = 0; i < frame.tool_count; i++) {
		cau_drive *made = &h->drives[i];
		*made =
			(cau_drive){.last_s = cau_monotonic_s(), .energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
		memcpy(made->tool, frame.tools[i].name, sizeof made->tool);
		made->energized = frame.tools[i].energized;
		for (int32_t j = 0; j < old_count; j++)
			if (strcmp(old[j].tool, made->tool) == 0) {
				made->driver = old[j].driver;
				made->energy_off = old[j].energized ? CAU_ENERGY_OFF_RESTORED : old[j].energy_off;
			}
	}
	pthread_mutex_unlock(&h->mutex);
	for (int32_t i = 0; i < h->drive_count; i++)
		if (frame.tools[i].energized)
			cau_drive_cut(h, &h->drives[i], CAU_ENERGY_OFF_RESTORED, cause);
}

// ---- from any thread
void cau_hosted_feed(cau_hosted *h, uint32_t client)
{
	double now_s = cau_monotonic_s();
	pthread_mutex_lock(&h->mutex);
	for (int32_t i = 0; i < h->drive_count; i++)
		if (h->drives[i].driver.client == client)
			h->drives[i].last_s = now_s;
	pthread_mutex_unlock(&h->mutex);
}

static void want_cut(cau_drive *drive, const char *cause)
{
	if (drive->cut_wanted)
		return;
	drive->cut_wanted = true;
	snprintf(drive->cut_cause, sizeof drive->cut_cause, "%s", cause);
}

void cau_hosted_cut(cau_hosted *h, uint32_t client, const char *tell)
{
	bool any = false;
	pthread_mutex_lock(&h->mutex);
	for (int32_t i = 0; i < h->drive_count; i++)
		if (h->drives[i].driver.client == client) {
			want_cut(&h->drives[i], tell);
			any = true;
		}
	pthread_mutex_unlock(&h->mutex);
	if (any)
		cau_worker_pool_wake(h->around->pool, &h->task);
}

void cau_hosted_forget_client(cau_hosted *h, uint32_t client)
{
	bool any = false;
	pthread_mutex_lock(&h->mutex);
	for (int32_t i = 0; i < h->drive_count; i++)
		if (h->drives[i].driver.client == client) {
			h->drives[i].driver = (cau_asker){0};
			want_cut(&h->drives[i], "its driver is gone");
			any = true;
		}
	pthread_mutex_unlock(&h->mutex);
	if (any)
		cau_worker_pool_wake(h->around->pool, &h->task);
}

double cau_hosted_watch(cau_hosted *h, double now_s)
{
	double look_s = INFINITY;
	bool any = false;
	pthread_mutex_lock(&h->mutex);
	for (int32_t i = 0; i < h->drive_count; i++) {
		cau_drive *drive = &h->drives[i];
		if (!drive->energized || drive->cut_wanted)
			continue;
		double expires_s = drive->last_s + drive->driver.deadline_s;
		if (expires_s <= now_s) {
			want_cut(drive, "its driver is silent");
			any = true;
		} else {
			look_s = fmin(look_s, expires_s);
		}
	}
	pthread_mutex_unlock(&h->mutex);
	if (any)
		cau_worker_pool_wake(h->around->pool, &h->task);
	return look_s;
}

// ---- orders
static cau_drive *drive_of_order(cau_hosted *h, cau_order *order)
{
	cau_drive *drive = cau_drive_find(h, order->as.tool.tool);
	if (!drive) {
		cau_error error = {0};
		cau_fail(&error, CAU_NOT_FOUND, "params.tool", "no tool `%s` in this session",
		         order->as.tool.tool);
		cau_answer_fail(order, &error, 0);
	}
	return drive;
}

static void change_driver(cau_hosted *h, cau_drive *drive, const cau_asker *to)
{
	if (drive->energized)
		cau_drive_cut(h, drive, CAU_ENERGY_OFF_TAKEN_OVER, "another driver");
	pthread_mutex_lock(&h->mutex);
	drive->driver = to ? *to : (cau_asker){0};
	drive->last_s = cau_monotonic_s();
	drive->cut_wanted = false;
	pthread_mutex_unlock(&h->mutex);
	cau_event_add(h, CAU_EVENT_DRIVER, drive->tool, to ? to->name : "", 0,
	              to ? "drives" : "has no driver");
	cau_drive_tell(h, drive);
}

void cau_apply_take_over(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_drive *drive = drive_of_order(h, order);
	if (!drive)
		return;
	uint32_t driver = drive->driver.client;
	if (driver && driver != order->asker.client && order->asker.role != CAU_ROLE_ADMIN) {
		cau_fail(&error, CAU_BAD_STATE, "params.tool", "%s drives it; only an admin takes it over",
		         drive->driver.name);
		cau_answer_fail(order, &error, CAU_RPC_FORBIDDEN);
		return;
	}
	cau_wire_driver result;
	if (driver != order->asker.client)
		change_driver(h, drive, &order->asker);
	cau_drive_describe(drive, &result);
	cau_answer_order(h, order, &result);
}

void cau_apply_hand_over(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_drive *drive = drive_of_order(h, order);
	if (!drive)
		return;
	if (drive->driver.client != order->asker.client) {
		cau_fail(&error, CAU_BAD_STATE, "params.tool", "only its driver gives it up");
		cau_answer_fail(order, &error, CAU_RPC_NOT_DRIVER);
		return;
	}
	cau_wire_driver result;
	cau_asker to = {.client = order->as.tool.to,
	                .role = order->as.tool.to_role,
	                .deadline_s = order->as.tool.to_deadline_s};
	memcpy(to.name, order->as.tool.to_name, sizeof to.name);
	change_driver(h, drive, to.client ? &to : NULL);
	cau_drive_describe(drive, &result);
	cau_answer_order(h, order, &result);
}

void cau_apply_request_takeover(cau_hosted *h, cau_order *order)
{
	cau_drive *drive = drive_of_order(h, order);
	cau_wire_nothing result = {0};
	if (!drive)
		return;
	cau_wire_takeover_requested params = {.client = order->asker.client};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	memcpy(params.tool, drive->tool, sizeof params.tool);
	memcpy(params.name, order->asker.name, sizeof params.name);
	if (drive->driver.client)
		cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_CLIENT, drive->driver.client},
		                  CAU_METHOD_TAKEOVER_REQUESTED, &params);
	cau_answer_order(h, order, &result);
}

// ---- refused motion
void cau_drive_refuse(cau_hosted *h, const cau_order *order, const cau_error *error)
{
	pthread_mutex_lock(&h->mutex);
	h->counts.refused++;
	cau_drive *drive = cau_drive_find(h, order->as.command.tool);
	if (drive) {
		drive->refused++;
		drive->refused_client = order->asker.client;
		drive->refused_sequence = order->as.command.sequence;
		drive->refused_error = *error;
	}
	pthread_mutex_unlock(&h->mutex);
}

void cau_drive_tell_refusals(cau_hosted *h, double now_s)
{
	for (int32_t i = 0; i < h->drive_count; i++) {
		cau_drive *drive = &h->drives[i];
		pthread_mutex_lock(&h->mutex);
		cau_drive told = *drive;
		bool due = told.refused && now_s - told.refused_told_s >= REFUSALS_TOLD_EVERY_S;
		if (due) {
			drive->refused = 0;
			drive->refused_told_s = now_s;
		}
		pthread_mutex_unlock(&h->mutex);
		if (!due)
			continue;
		cau_wire_tool_refused params = {.count = told.refused,
		                                .sequence = (int64_t)told.refused_sequence,
		                                .has_path = *told.refused_error.path != 0};
		snprintf(params.session, sizeof params.session, "%s", h->id);
		memcpy(params.tool, told.tool, sizeof params.tool);
		snprintf(params.status, sizeof params.status, "%s",
		         cau_status_name(told.refused_error.status));
		snprintf(params.path, sizeof params.path, "%s", told.refused_error.path);
		snprintf(params.reason, sizeof params.reason, "%.319s", told.refused_error.reason);
		cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_CLIENT, told.refused_client},
		                  CAU_METHOD_TOOL_REFUSED, &params);
	}
}
