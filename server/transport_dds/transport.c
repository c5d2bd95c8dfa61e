// SPDX-License-Identifier: GPL-3.0-or-later
// Creates and destroys the transport, and runs its thread.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "transport_dds/internal.h"

enum { TAKEN_MOST = 16, TRIGGERS_MOST = 64 };

// ---- the sink; called by any thread
static void on_notify(void *user, cau_audience audience, cau_buffer *text)
{
	cau_dds *dds = user;
	cau_buffer_release(text);
	if (audience.kind == CAU_AUDIENCE_SESSION)
		cau_dds_mark(&dds->wakeup, (uint32_t)audience.id);
	else if (audience.kind == CAU_AUDIENCE_EVERYBODY)
		cau_dds_wake(&dds->wakeup, &dds->wakeup.sessions_changed);
}

static void on_frames(void *user)
{
	(void)user; // nothing to do: a slice that made frames ends soon and calls on_sliced
}

// Marks the session. Without readers it can wait until the thread's next check.
static void on_sliced(void *user, uint32_t session)
{
	cau_dds *dds = user;
	cau_dds_set_bit(&dds->wakeup.marked, session);
	if (cau_dds_has_bit(&dds->wakeup.read, session))
		cau_dds_wake(&dds->wakeup, &dds->wakeup.sliced);
}

// ---- samples
// Notes a sign of life of the writer. A sample has the time of the writer's clock, unless the
// writer's DDS omits it.
static void hear(cau_dds_writer *writer, dds_time_t source_timestamp)
{
	double now_s = cau_monotonic_s();
	if (source_timestamp > 0)
		cau_sign_of_life_hear(&writer->sign, now_s, 1e-9 * (double)source_timestamp,
		                      writer->asker.deadline_s);
	else if (!writer->sign.clocked)
		writer->sign.alive_s = now_s;
	if (writer->client)
		writer->client->alive_s = writer->sign.alive_s;
}

static void serve(cau_dds *dds, cau_door *door)
{
	static void (*const takers[])(cau_dds *, cau_door *, cau_dds_writer *, const void *) = {
		[DOOR_NATIVE] = cau_dds_take_command,
		[DOOR_SERVO_CP] = cau_dds_take_servo_cp,
		[DOOR_SERVO_JP] = cau_dds_take_servo_jp,
		[DOOR_ENERGIZE] = cau_dds_take_energize,
		[DOOR_STATE_COMMAND] = cau_dds_take_state_command,
		[DOOR_SETTING] = cau_dds_take_setting,
		[DOOR_INSTRUMENT] = cau_dds_take_instrument,
		[DOOR_REQUEST] = cau_dds_take_request,
	};
	void *samples[TAKEN_MOST] = {NULL};
	dds_sample_info_t infos[TAKEN_MOST];
	dds_subscription_matched_status_t matched;
	dds_return_t count = dds_take(door->reader, samples, infos, TAKEN_MOST, TAKEN_MOST);
	for (dds_return_t i = 0; i < count; i++) {
		if (!infos[i].valid_data)
			continue;
		cau_dds_writer *writer = cau_dds_writer_of(dds, door, infos[i].publication_handle);
		if (!writer || (door->best_effort && writer->reliable))
			continue;
		hear(writer, infos[i].source_timestamp);
		takers[door->kind](dds, door, writer, samples[i]);
	}
	if (count > 0)
		dds_return_loan(door->reader, samples, count);
	dds_get_subscription_matched_status(door->reader, &matched);
	if (matched.current_count_change || matched.total_count_change)
		cau_dds_prune(dds, door->reader, false);
}

static dds_duration_t patience(double look_s)
{
	return (dds_duration_t)(1e9 * fmax(0, look_s - cau_monotonic_s()));
}

static void *run(void *argument)
{
	cau_dds *dds = argument;
	pthread_setname_np(pthread_self(), CAU_DDS_THREAD_NAME);
	dds_attach_t triggers[TRIGGERS_MOST];
	double look_s = 0;
	while (!dds->wakeup.ending) {
		dds_return_t count =
			dds_waitset_wait(dds->entities.waitset, triggers, TRIGGERS_MOST, patience(look_s));
		for (dds_return_t i = 0; i < count && i < TRIGGERS_MOST; i++)
			if (triggers[i])
				serve(dds, (cau_door *)triggers[i]);
		dds_set_guardcondition(dds->wakeup.guard, false);
		dds->wakeup.sliced = false;
		if (atomic_exchange(&dds->wakeup.sessions_changed, false))
			cau_dds_list_sessions(dds);
		if (atomic_exchange(&dds->wakeup.roles_changed, false))
			cau_dds_take_roles(dds);
		if (atomic_exchange(&dds->wakeup.fell_silent, false))
			cau_dds_end_silenced(dds);
		dds->wakeup.answered = false;
		look_s = cau_dds_serve(dds);
		cau_dds_look_at_peers(dds);
	}
	cau_dds_close_sessions(dds);
	return NULL;
}

// ---- metrics
void cau_dds_write_metrics(void *user, FILE *out, cau_metrics_format format)
{
	cau_dds *dds = user;
	const struct {
		cau_metric_family family;
		double value;
	} rows[] = {
		{{"dds_clients", CAU_METRIC_GAUGE, "", "DDS clients"}, (double)dds->counts.clients},
		{{"dds_clients_most", CAU_METRIC_GAUGE, "", "Largest number of DDS clients"},
	     (double)cau_dds_places_most(dds->config)},
		{{"dds_places_denied", CAU_METRIC_COUNTER, "",
	      "Number of times that a DDS writer was refused as a client"},
	     (double)dds->counts.denied},
		{{"dds_places_evicted", CAU_METRIC_COUNTER, "",
	      "Idle DDS clients that were removed to accept a driver"},
	     (double)dds->counts.evicted},
		{{"dds_peers_incompatible", CAU_METRIC_COUNTER, "",
	      "Readers and writers of other programs on Cautery's topics that DDS cannot match"},
	     (double)dds->counts.incompatible},
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		cau_metrics_begin(out, format, &rows[i].family);
		cau_metrics_sample(out, format, &rows[i].family, NULL, NULL, rows[i].value);
	}
}

// ---- creating and destroying
static cau_status fail(cau_error *error, const char *what, dds_return_t code)
{
	return cau_fail(error, CAU_IO, "dds", "%s: %s", what, dds_strretcode(code));
}

static cau_status open_entities(cau_dds *dds, cau_error *error)
{
	dds_entity_t p = dds->entities.participant;
	dds->entities.subscriber = dds_create_subscriber(p, NULL, NULL);
	dds->entities.publisher = dds_create_publisher(p, NULL, NULL);
	dds->entities.waitset = dds_create_waitset(p);
	dds->wakeup.guard = dds_create_guardcondition(p);
	const dds_entity_t made[] = {dds->entities.subscriber, dds->entities.publisher,
	                             dds->entities.waitset, dds->wakeup.guard};
	static const char *const failures[] = {
		"cannot create the DDS subscriber", "cannot create the DDS publisher",
		"cannot create the DDS waitset", "cannot create the DDS guard condition"};
	for (size_t i = 0; i < sizeof made / sizeof made[0]; i++)
		if (made[i] < 0)
			return fail(error, failures[i], made[i]);
	dds_return_t code = dds_waitset_attach(dds->entities.waitset, dds->wakeup.guard, 0);
	return code ? fail(error, "cannot attach to the DDS waitset", code) : CAU_OK;
}

cau_status cau_dds_create(cau_dds **made, const cau_config *config, cau_hub *hub, cau_error *error)
{
	*made = NULL;
	cau_dds *dds = calloc(1, sizeof *dds);
	if (!dds)
		return cau_fail(error, CAU_NO_MEMORY, "dds", "no memory for the DDS transport");
	dds->config = config;
	dds->hub = hub;
	pthread_mutex_init(&dds->mailbox.mutex, NULL);
	cau_status status = cau_dds_roles_read(&dds->roles, config, error);
	if (!status)
		status = cau_dds_open_domain(&dds->entities, config, error);
	if (!status)
		status = open_entities(dds, error);
	if (!status)
		status = cau_dds_open_topics(dds, error);
	if (!status)
		status = cau_dds_open_control(dds, error);
	if (!status)
		status = cau_dds_watch_peers(dds, error);
	if (status) {
		cau_dds_destroy(dds);
		return status;
	}
	cau_hub_add_sink(hub, &(cau_sink){dds, on_notify, on_frames, on_sliced});
	*made = dds;
	return CAU_OK;
}

cau_status cau_dds_start(cau_dds *dds, cau_error *error)
{
	cau_dds_wake(&dds->wakeup, &dds->wakeup.sessions_changed);
	int code = pthread_create(&dds->thread, NULL, run, dds);
	dds->started = code == 0;
	if (code)
		return cau_fail(error, CAU_NO_MEMORY, "dds",
		                "cannot start the DDS thread: %s (its limit: ulimit -u)",
		                strerrordesc_np(code));
	cau_log(CAU_LOG_NOTICE, NULL, "dds_open", "domain=%lld config=\"%s\" security=\"%s\"",
	        (long long)dds->config->dds_domain,
	        *dds->config->dds_config ? dds->config->dds_config : "loopback",
	        *dds->config->dds_security ? dds->config->dds_security : "off");
	return CAU_OK;
}

void cau_dds_stop(cau_dds *dds)
{
	if (!dds || !dds->started)
		return;
	dds->wakeup.ending = true;
	dds_set_guardcondition(dds->wakeup.guard, true);
	pthread_join(dds->thread, NULL);
	dds->started = false;
}

void cau_dds_destroy(cau_dds *dds)
{
	if (!dds)
		return;
	cau_dds_stop(dds);
	if (dds->entities.domain > 0)
		cau_dds_leave(dds->entities.domain);
	for (cau_dds_post *post; (post = cau_dds_next_post(&dds->mailbox));)
		cau_dds_post_free(post);
	cau_dds_end_silenced(dds);
	cau_dds_forget_peers(&dds->peers);
	pthread_mutex_destroy(&dds->mailbox.mutex);
	free(dds->mailbox.roles);
	free(dds);
}
