// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "clock/clock.h"

// Bytes of checkpoints for each tick that a paused session is stepped. A session that is stepped
// for long then has checkpoints from time to time, and a restart does not replay all of it. The
// disk takes each byte twice, in the write-ahead log and in the file. So a tick stays below 16 KiB
// with its log entries.
enum { REACHED_BYTES = 2048 };

// Most doublings of the interval between checkpoints. A resting session has a checkpoint at least
// every 2^6 = 64 checkpoint_s.
enum { QUIET_DOUBLINGS = 6 };

void cau_record_init(cau_hosted_record *record, const cau_hosted_identity *identity,
                     const cau_present_core *core, const cau_hosted_history *history,
                     cau_hosted_commits *commits)
{
	record->identity = identity;
	record->core = core;
	record->history = history;
	record->commits = commits;
	record->batch_lost = UINT64_MAX;
	commits->lost_from = UINT64_MAX;
}

cau_store_batch *cau_record_batch(cau_hosted_record *record)
{
	if (!record->batch) {
		record->batch = cau_store_batch_create();
		record->batch_tick = record->core->tick;
	}
	return record->batch;
}

// Notes that the log lacks entries from this tick on. The log is complete again from the next
// checkpoint on. Any thread may call this.
void cau_commits_lose(cau_hosted_commits *commits, uint64_t from_tick)
{
	uint64_t known = commits->lost_from;
	while (from_tick < known &&
	       !atomic_compare_exchange_weak(&commits->lost_from, &known, from_tick))
		;
	commits->checkpoint_wanted = true;
}

void cau_record_gap(cau_hosted_record *record, const cau_error *error)
{
	cau_log(CAU_LOG_ERROR, record->identity->id, "store_refused", "status=%s reason=\"%s\"",
	        cau_status_name(error->status), error->reason);
	cau_commits_lose(record->commits, record->batch && record->batch_tick < record->core->tick
	                                      ? record->batch_tick
	                                      : record->core->tick);
}

// Returns a new log entry for the present tick.
static cau_store_command next_entry(cau_hosted_record *record, int32_t kind)
{
	if (record->logged_tick != record->core->tick) {
		record->logged_order = 0;
		record->logged_acts = false;
	}
	record->logged_tick = record->core->tick;
	record->logged_acts |= kind != CAU_STORE_REACHED;
	record->batch_acts = true;
	return (cau_store_command){.session = record->identity->id,
	                           .branch = record->history->branch,
	                           .tick = record->core->tick,
	                           .order = record->logged_order++,
	                           .kind = kind};
}

// True if commands of this tick are already logged. A checkpoint of a tick comes before the
// commands of that tick, so this tick can have no checkpoint any more. A restart then replays the
// log from the previous checkpoint to this tick. The next tick border gets a checkpoint.
static bool is_past_commands(const cau_hosted_record *record)
{
	return record->logged_tick == record->core->tick && record->logged_acts;
}

void cau_record_command(cau_hosted_record *record, const cau_command *command,
                        const cau_order *order, const char *text, size_t text_bytes)
{
	char json[CAU_COMMAND_JSON_MAX_BYTES];
	size_t json_bytes = 0;
	record->touched = true;
	if (record->commits->lost_from <= record->core->tick && is_past_commands(record))
		return; // the daemon's energy cut-off follows a command that the log lost
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	cau_store_command row = next_entry(record, command->kind);
	if (order && order->client_sequence && text) {
		row.client = order->asker.client_id;
		row.sequence = (uint64_t)order->client_sequence;
		row.result = (cau_store_bytes){text, text_bytes};
	}
	cau_status status = cau_command_to_json(command, json, sizeof json, &json_bytes, &error);
	row.payload = (cau_store_bytes){json, json_bytes};
	if (!status && !batch)
		status = cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a batch");
	if (!status)
		status = cau_store_put_command(batch, &row, &error);
	if (status)
		cau_record_gap(record, &error);
}

void cau_record_answer(cau_hosted_record *record, const cau_order *order, const char *text,
                       size_t text_bytes)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	cau_store_answer row = {order->asker.client_id,
	                        (uint64_t)order->client_sequence,
	                        record->identity->id,
	                        {text, text_bytes}};
	if (order->client_sequence && batch && cau_store_put_answer(batch, &row, &error))
		cau_record_gap(record, &error);
}

void cau_record_state(cau_hosted_record *record, int session_state)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	const char *state = session_state == CAU_SESSION_RUNNING ? "running" : "paused";
	if (batch && cau_store_put_session_state(batch, record->identity->id, state, &error))
		cau_record_gap(record, &error);
}

// Ends the gap of the log with this tick's checkpoint, in the same batch. The store then leads no
// replay through the gap.
static cau_status end_gap(cau_hosted_record *record, cau_store_batch *batch, cau_error *error)
{
	uint64_t from = atomic_exchange(&record->commits->lost_from, UINT64_MAX);
	cau_store_gap row = {.session = record->identity->id,
	                     .branch = record->history->branch,
	                     .from_tick = from,
	                     .before_tick = record->core->tick};
	cau_status status = from < record->core->tick ? cau_store_put_gap(batch, &row, error) : CAU_OK;
	if (status)
		cau_commits_lose(record->commits, from);
	else if (from < record->batch_lost)
		record->batch_lost = from; // if the batch is lost, the log is lost from there on again
	return status;
}

void cau_record_mark(cau_hosted_record *record)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	if (!batch || cau_store_put_mark(batch, record->identity->id, record->history->branch,
	                                 record->core->tick, &error))
		cau_log(CAU_LOG_ERROR, record->identity->id, "mark_lost", "reason=\"%s\"", error.reason);
}

void cau_record_checkpoint(cau_hosted_record *record, uint64_t *hash, size_t *bytes)
{
	if (is_past_commands(record)) {
		record->commits->checkpoint_wanted = true;
		if (hash)
			*hash = cau_session_hash(record->core->session);
		return;
	}
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	size_t capacity = cau_session_snapshot_bytes(record->core->session), count = 0;
	void *snapshot = cau_shelf_take(record->shelf, capacity);
	cau_store_checkpoint row = {.session = record->identity->id,
	                            .branch = record->history->branch,
	                            .tick = record->core->tick,
	                            .hash = cau_session_hash(record->core->session)};
	cau_status status =
		snapshot && batch
			? cau_session_snapshot(record->core->session, snapshot, capacity, &count, &error)
			: cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a checkpoint");
	row.snapshot = (cau_store_bytes){snapshot, count};
	if (!status)
		status = cau_store_lend_checkpoint(batch, &row, cau_shelf_give_back, &error);
	if (status)
		cau_shelf_give_back(snapshot);
	record->commits->checkpoint_wanted = record->batch_acts = false;
	if (!status)
		status = end_gap(record, batch, &error);
	if (status)
		cau_record_gap(record, &error);
	record->touched = false;
	record->checkpoint_s = cau_monotonic_s();
	record->checkpoint_tick = record->core->tick;
	if (hash)
		*hash = row.hash;
	if (bytes)
		*bytes = count;
}

static bool store_is_ready(const cau_hosted_record *record)
{
	cau_store_health health;
	cau_store_get_health(record->identity->around->store, &health);
	return health.state == CAU_STORE_READY;
}

bool cau_record_is_due(cau_hosted_record *record, bool running, bool energy_on, double now_s)
{
	bool quiet = !energy_on && !record->touched;
	int32_t doublings = quiet ? record->quiet_checkpoints : 0;
	double pause_s = ldexp(record->identity->around->config->checkpoint_s, doublings);
	bool due = running && record->core->tick != record->checkpoint_tick &&
	           now_s - record->checkpoint_s >= pause_s;
	if (!quiet)
		record->quiet_checkpoints = 0;
	else if (due && record->quiet_checkpoints < QUIET_DOUBLINGS)
		record->quiet_checkpoints++;
	// No checkpoint is tried while the store is full. Once the store has capacity again, it asks
	// for a checkpoint.
	return (due || record->commits->checkpoint_wanted) && store_is_ready(record);
}

bool cau_record_far(cau_hosted_record *record)
{
	size_t checkpoint = cau_session_snapshot_bytes(record->core->session);
	bool whole = record->commits->lost_from == UINT64_MAX && !record->commits->checkpoint_wanted;
	if (whole && checkpoint > REACHED_BYTES * (record->core->tick - record->checkpoint_tick))
		return false;
	cau_record_checkpoint(record, NULL, NULL);
	return true;
}

void cau_record_reached(cau_hosted_record *record)
{
	if (cau_record_far(record))
		return;
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	cau_store_command row = next_entry(record, CAU_STORE_REACHED);
	cau_status status = batch ? cau_store_put_command(batch, &row, &error)
	                          : cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a batch");
	if (status)
		cau_record_gap(record, &error);
}

void cau_record_event(cau_hosted_record *record, const cau_wire_timeline_event *event,
                      cau_log_level level)
{
	static const char *const kinds[] = {
#define X(code, name) name,
		CAU_EVENT_TABLE(X)
#undef X
	};
	char text[4096]; // holds the longest detail with every byte escaped
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(record);
	cau_wire_event_notice notice = {.event = *event};
	cau_rpc_buffer out = {text, sizeof text - 1, 0};
	memcpy(notice.session, record->identity->id, sizeof notice.session);
	cau_status status = cau_rpc_write_notification(&out, CAU_METHOD_EVENT, &notice, &error);
	text[status ? 0 : out.bytes] = 0;
	cau_store_event row = {.session = record->identity->id,
	                       .branch = record->history->branch,
	                       .tick = (uint64_t)event->tick,
	                       .level = (int32_t)level,
	                       .kind = kinds[event->kind],
	                       .text = text};
	cau_log(level, record->identity->id, kinds[event->kind],
	        "tick=%llu tool=%s client=\"%s\" detail=\"%s\"", (unsigned long long)event->tick,
	        event->tool, event->client, event->detail);
	if (!status && batch)
		status = cau_store_put_event(batch, &row, &error);
	if (status)
		cau_record_gap(record, &error);
}

void cau_record_reply(cau_hosted_record *record, const cau_reply *reply, char *text,
                      size_t text_bytes)
{
	cau_pending *pending = reply->answer ? malloc(sizeof *pending) : NULL;
	if (!pending) {
		free(text);
		return;
	}
	*pending = (cau_pending){record->pending, *reply, text, text_bytes};
	record->pending = pending;
}

cau_status cau_record_check(cau_hosted_record *record, cau_error *error)
{
	if (record->commits->lost_from <= record->core->tick && !is_past_commands(record))
		cau_record_checkpoint(record, NULL, NULL);
	if (record->commits->lost_from > record->core->tick)
		return CAU_OK;
	return cau_fail(error, CAU_IO, "",
	                "an earlier command of this tick was not stored: step or resume the session");
}
