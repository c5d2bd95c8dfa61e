// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cautery/command_json.h"
#include "sim/writers.h"

typedef struct run {
	const sim_options *options;
	const cau_scene_def *scene;
	cau_session *session;
	cau_script script;
	cau_command next; // next command of the script, not submitted yet
	bool script_done;
	FILE *csv;
	sim_vtu vtu;
	bool vtu_open;
	FILE *notes;
	bool show_progress;
	uint64_t tick;
	uint64_t last_tick;
	sim_result *result;
	bool *in_input;
	cau_error *error;
} run;

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static cau_status read_next(run *r)
{
	*r->in_input = true;
	cau_status status = cau_script_next(&r->script, &r->next, &r->script_done, r->error);
	if (!status)
		*r->in_input = false;
	return status;
}

// Reads the whole script once, so that a mistake in it is found before the run.
static cau_status check_script(run *r, uint64_t *end_tick)
{
	cau_script whole = r->script;
	cau_command command;
	*r->in_input = true;
	for (bool end = false; !end;) {
		cau_status status = cau_script_next(&whole, &command, &end, r->error);
		if (status)
			return status;
	}
	*r->in_input = false;
	*end_tick = whole.tick;
	return CAU_OK;
}

// Submits the commands that are due before the next step.
static cau_status submit_due(run *r)
{
	while (!r->script_done && r->next.tick <= r->tick) {
		cau_status status = cau_session_submit(r->session, &r->next, r->error);
		if (status) {
			char reason[sizeof r->error->reason];
			snprintf(reason, sizeof reason, "%s", r->error->reason);
			snprintf(r->error->file, sizeof r->error->file, "%s",
			         r->script.name ? r->script.name : "");
			snprintf(r->error->reason, sizeof r->error->reason, "script line %d: %.280s",
			         r->script.line, reason);
			*r->in_input = true;
			return status;
		}
		r->result->commands++;
		status = read_next(r);
		if (status)
			return status;
	}
	return CAU_OK;
}

static void note_refusals(run *r, const cau_frame *frame)
{
	r->result->refusals += frame->refusal_count;
	for (int32_t i = 0; i < frame->refusal_count && r->notes; i++)
		fprintf(r->notes, "tick %" PRIu64 ": refused: %s%s%s\n", frame->tick,
		        frame->refusals[i].path, frame->refusals[i].path[0] ? ": " : "",
		        frame->refusals[i].reason);
}

static void note_events(run *r, const cau_frame *frame)
{
	sim_result *result = r->result;
	bool energized = false;
	for (int32_t i = 0; i < frame->tool_count; i++)
		energized |= frame->tools[i].energized;
	if (energized && result->energized_s < 0.0)
		result->energized_s = frame->time_s;
	if (frame->statistics.edges_parted > 0 && result->first_part_s < 0.0)
		result->first_part_s = frame->time_s;
	result->ticks = frame->tick;
	result->time_s = frame->time_s;
	result->statistics = frame->statistics;
	note_refusals(r, frame);
	if (r->show_progress && frame->tick % 30 == 0)
		fprintf(r->notes, "\r%7.2f s of %.2f s, %d edges parted, %d elements removed ",
		        frame->time_s, (double)r->last_tick * r->scene->step_s,
		        frame->statistics.edges_parted, frame->statistics.elements_removed);
}

static cau_status write_outputs(run *r, const cau_frame *frame)
{
	if (r->csv) {
		sim_csv_row row = {.frame = frame,
		                   .coagulated_m3 = cau_session_coagulated(r->session),
		                   .vaporised_m3 = cau_session_vaporised(r->session),
		                   .vapour_kg_s = cau_session_vapour(r->session)};
		cau_status status = cau_session_balance(r->session, &row.balance);
		if (status)
			return cau_fail(r->error, status, NULL, "no memory for a tick's energies");
		cau_session_read_ledger(r->session, &row.ledger);
		sim_csv_tick(r->csv, r->scene, &row);
	}
	if (r->vtu_open && frame->tick % (uint64_t)r->options->vtu_every == 0)
		return sim_vtu_write(&r->vtu, r->session, r->error);
	return CAU_OK;
}

static cau_status create_session(run *r, cau_session **session)
{
	cau_session_def def = cau_default_session_def();
	def.scene = r->scene;
	def.thread_count = r->options->threads;
	cau_status status = cau_session_create(&def, session, r->error);
	// The scene has caused the error: the script was checked before.
	if (status)
		snprintf(r->error->file, sizeof r->error->file, "%s", r->options->scene);
	else if (r->options->csv)
		cau_session_set_clock(*session, now_s);
	return status;
}

// Takes a snapshot and continues in a new session that is restored from it.
static cau_status change_sessions(run *r)
{
	cau_session *fresh = NULL;
	size_t capacity = cau_session_snapshot_bytes(r->session);
	void *bytes = malloc(capacity ? capacity : 1);
	cau_status status = bytes ? cau_session_snapshot(r->session, bytes, capacity,
	                                                 &r->result->snapshot_bytes, r->error)
	                          : cau_fail(r->error, CAU_NO_MEMORY, NULL, "no memory for a snapshot");
	if (!status)
		status = create_session(r, &fresh);
	if (!status)
		status = cau_session_restore(fresh, bytes, r->result->snapshot_bytes,
		                             &r->result->snapshot_exact, r->error);
	free(bytes);
	if (status) {
		cau_session_destroy(fresh);
		return status;
	}
	cau_session_destroy(r->session);
	r->session = fresh;
	return CAU_OK;
}

static cau_status step(run *r)
{
	cau_frame frame;
	cau_status status = CAU_OK;
	if (r->options->snapshot_at >= 0 && (uint64_t)r->options->snapshot_at == r->tick)
		status = change_sessions(r);
	if (!status)
		status = submit_due(r);
	if (status)
		return status;
	double start = now_s();
	status = cau_session_step(r->session, r->error);
	r->result->wall_s += now_s() - start;
	cau_session_frame(r->session, &frame);
	r->tick = frame.tick;
	note_events(r, &frame);
	return status ? status : write_outputs(r, &frame);
}

static cau_status open_outputs(run *r)
{
	if (r->options->csv) {
		r->csv = fopen(r->options->csv, "wb");
		if (!r->csv)
			return cau_fail(r->error, CAU_IO, NULL, "cannot write %s", r->options->csv);
		sim_csv_begin(r->csv, r->scene);
	}
	if (!r->options->vtu)
		return CAU_OK;
	cau_status status = sim_vtu_begin(r->options->vtu, &r->vtu, r->error);
	r->vtu_open = !status;
	return status ? status : sim_vtu_write(&r->vtu, r->session, r->error);
}

// Closes the open outputs. An earlier failure is kept as the status.
static cau_status close_outputs(run *r, cau_status status)
{
	cau_error late = {0};
	cau_status closing = CAU_OK;
	if (r->csv) {
		bool failed = ferror(r->csv) != 0;
		if (fclose(r->csv) != 0 || failed)
			closing = cau_fail(&late, CAU_IO, NULL, "cannot write %s", r->options->csv);
	}
	if (r->vtu_open)
		closing = sim_vtu_finish(&r->vtu, &late);
	if (status || !closing)
		return status;
	*r->error = late;
	return closing;
}

static cau_status start(run *r)
{
	uint64_t end_tick;
	cau_frame frame;
	cau_session_info info;
	cau_status status = check_script(r, &end_tick);
	if (status)
		return status;
	double seconds = r->options->seconds;
	r->last_tick = seconds < 0.0 ? end_tick + (uint64_t)ceil(1.0 / r->scene->step_s)
	                             : (uint64_t)llround(seconds / r->scene->step_s);
	*r->in_input = true;
	status = create_session(r, &r->session);
	if (status)
		return status;
	*r->in_input = false;
	cau_session_describe(r->session, &info);
	snprintf(r->result->instruction_set, sizeof r->result->instruction_set, "%s",
	         info.instruction_set);
	cau_session_frame(r->session, &frame);
	r->tick = frame.tick;
	r->result->statistics = frame.statistics;
	status = read_next(r);
	return status ? status : open_outputs(r);
}

cau_status sim_run(const sim_options *options, const cau_scene_def *scene, const char *script_name,
                   const char *text, size_t bytes, FILE *notes, sim_result *result, bool *in_input,
                   cau_error *error)
{
	run r = {.options = options,
	         .scene = scene,
	         .notes = notes,
	         .result = result,
	         .in_input = in_input,
	         .error = error};
	r.show_progress = notes && isatty(fileno(notes));
	*result = (sim_result){.energized_s = -1.0, .first_part_s = -1.0};
	cau_script_begin(&r.script, script_name, text, bytes);
	cau_status status = start(&r);
	while (!status && r.tick < r.last_tick)
		status = step(&r);
	if (r.show_progress)
		fputc('\n', notes);
	if (r.session) {
		cau_balance balance;
		cau_session_balance(r.session, &balance);
		result->kinetic_j = balance.kinetic_j;
		result->hash = cau_session_hash(r.session);
	}
	status = close_outputs(&r, status);
	cau_session_destroy(r.session);
	return status;
}
