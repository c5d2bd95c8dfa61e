// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch.h"
#include "cautery/assert.h"

#include <stdlib.h>
#include <string.h>

cau_store_batch *cau_store_batch_create(void)
{
	return calloc(1, sizeof(cau_store_batch));
}

void cau_store_batch_destroy(cau_store_batch *batch)
{
	if (!batch)
		return;
	for (struct record *record = batch->first, *next; record; record = next) {
		next = record->next;
		if (record->give_back)
			record->give_back(record->lent);
		free(record);
	}
	free(batch);
}

size_t cau_store_batch_bytes(const cau_store_batch *batch)
{
	return batch->bytes;
}

bool cau_store_record_request(const struct record *record, const char **client, uint64_t *sequence)
{
	CAU_ASSERT(client && sequence, "a request of kind %d without a client", (int)record->kind);
	if (record->kind == RECORD_COMMAND) {
		*client = record->as.command.client;
		*sequence = record->as.command.sequence;
		return *client != NULL;
	}
	if (record->kind == RECORD_ANSWER) {
		*client = record->as.answer.client;
		*sequence = record->as.answer.sequence;
		return true;
	}
	return false;
}

// ---- checks ---------------------------------------------------------------------------
static cau_status check_text(const char *path, const char *text, bool required, cau_error *error)
{
	if (!text)
		return required ? cau_fail(error, CAU_BAD_VALUE, path, "is missing") : CAU_OK;
	if (required && !text[0])
		return cau_fail(error, CAU_BAD_VALUE, path, "is empty");
	if (strnlen(text, CAU_STORE_ID_BYTES) == CAU_STORE_ID_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, path, "is longer than %d bytes",
		                CAU_STORE_ID_BYTES - 1);
	return CAU_OK;
}

static cau_status check_blob(const char *path, cau_store_bytes blob, cau_error *error)
{
	if (blob.bytes && !blob.data)
		return cau_fail(error, CAU_BAD_VALUE, path, "%zu bytes at no address", blob.bytes);
	if (blob.bytes > CAU_STORE_BLOB_BYTES)
		return cau_fail(error, CAU_LIMIT, path, "%zu bytes; at most %d", blob.bytes,
		                CAU_STORE_BLOB_BYTES);
	return CAU_OK;
}

// Refuses counts above 2^63 - 1, because SQLite's integers are signed.
static cau_status check_count(const char *path, uint64_t value, cau_error *error)
{
	if (value > INT64_MAX)
		return cau_fail(error, CAU_BAD_VALUE, path, "%llu is above 2^63 - 1",
		                (unsigned long long)value);
	return CAU_OK;
}

static cau_status check_branch(const char *path, int64_t branch, int64_t lowest, cau_error *error)
{
	if (branch < lowest)
		return cau_fail(error, CAU_BAD_VALUE, path, "branch %lld; at least %lld", (long long)branch,
		                (long long)lowest);
	return CAU_OK;
}

#define TRY(check)                                                                                 \
	do {                                                                                           \
		cau_status status = (check);                                                               \
		if (status)                                                                                \
			return status;                                                                         \
	} while (0)

// ---- copies ---------------------------------------------------------------------------
static size_t text_bytes(const char *text)
{
	return text ? strlen(text) + 1 : 0;
}

static const char *copy_text(unsigned char **at, const char *text)
{
	if (!text)
		return NULL;
	char *copy = memcpy(*at, text, text_bytes(text));
	*at += text_bytes(text);
	CAU_ASSERT((*at)[-1] == 0, "a text of %zu bytes without its end", text_bytes(text));
	return copy;
}

static cau_store_bytes copy_blob(unsigned char **at, cau_store_bytes blob)
{
	CAU_ASSERT(blob.data || !blob.bytes, "%zu bytes at no address", blob.bytes);
	cau_store_bytes copy = {*at, blob.bytes};
	if (blob.bytes)
		memcpy(*at, blob.data, blob.bytes);
	*at += blob.bytes;
	return copy;
}

static const char *empty_as_null(const char *text)
{
	return text && text[0] ? text : NULL;
}

// Appends a record with `bytes` bytes for copies. Returns NULL if memory ran out.
static struct record *append(cau_store_batch *batch, enum record_kind kind, size_t bytes,
                             cau_error *error)
{
	CAU_ASSERT(!batch->first == !batch->last, "a list of %lld records without an end",
	           (long long)batch->record_count);
	struct record *record = calloc(1, sizeof *record + bytes);
	if (!record) {
		cau_fail(error, CAU_NO_MEMORY, NULL, "a record of %zu bytes", bytes);
		return NULL;
	}
	record->kind = kind;
	if (batch->last)
		batch->last->next = record;
	else
		batch->first = record;
	batch->last = record;
	batch->bytes += sizeof *record + bytes;
	batch->record_count++;
	return record;
}

// ---- puts -----------------------------------------------------------------------------
static cau_status append_session(cau_store_batch *batch, enum record_kind kind,
                                 const cau_store_session *session, cau_error *error)
{
	size_t bytes = text_bytes(session->id) + text_bytes(session->name) +
	               text_bytes(session->state) + session->definition.bytes + session->mesh.bytes;
	struct record *record = append(batch, kind, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_session *copy = &record->as.session;
	copy->id = copy_text(&at, session->id);
	copy->name = copy_text(&at, session->name);
	copy->state = copy_text(&at, session->state);
	copy->definition = copy_blob(&at, session->definition);
	copy->mesh = copy_blob(&at, session->mesh);
	copy->created_ms = session->created_ms;
	return CAU_OK;
}

cau_status cau_store_put_session(cau_store_batch *batch, const cau_store_session *session,
                                 cau_error *error)
{
	TRY(check_text("id", session->id, true, error));
	TRY(check_text("name", session->name, true, error));
	TRY(check_text("state", session->state, true, error));
	TRY(check_blob("definition", session->definition, error));
	TRY(check_blob("mesh", session->mesh, error));
	if (session->branch)
		return cau_fail(error, CAU_BAD_VALUE, "branch", "a session starts on branch 0");
	return append_session(batch, RECORD_SESSION, session, error);
}

cau_status cau_store_put_session_state(cau_store_batch *batch, const char *session,
                                       const char *state, cau_error *error)
{
	TRY(check_text("session", session, true, error));
	TRY(check_text("state", state, true, error));
	cau_store_session change = {.id = session, .state = state};
	return append_session(batch, RECORD_SESSION_STATE, &change, error);
}

cau_status cau_store_delete_session(cau_store_batch *batch, const char *session, cau_error *error)
{
	TRY(check_text("session", session, true, error));
	cau_store_session gone = {.id = session};
	return append_session(batch, RECORD_SESSION_DELETE, &gone, error);
}

cau_status cau_store_put_command(cau_store_batch *batch, const cau_store_command *command,
                                 cau_error *error)
{
	const char *client = empty_as_null(command->client);
	TRY(check_text("session", command->session, true, error));
	TRY(check_text("client", client, false, error));
	TRY(check_branch("branch", command->branch, 0, error));
	TRY(check_count("tick", command->tick, error));
	TRY(check_count("sequence", command->sequence, error));
	TRY(check_blob("payload", command->payload, error));
	TRY(check_blob("result", command->result, error));
	if (!client && command->result.bytes)
		return cau_fail(error, CAU_BAD_VALUE, "result", "an answer to no client");

	size_t bytes = text_bytes(command->session) + text_bytes(client) + command->payload.bytes +
	               command->result.bytes;
	struct record *record = append(batch, RECORD_COMMAND, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_command *copy = &record->as.command;
	*copy = *command;
	copy->session = copy_text(&at, command->session);
	copy->client = copy_text(&at, client);
	copy->payload = copy_blob(&at, command->payload);
	copy->result = copy_blob(&at, command->result);
	return CAU_OK;
}

cau_status cau_store_put_answer(cau_store_batch *batch, const cau_store_answer *answer,
                                cau_error *error)
{
	const char *session = empty_as_null(answer->session);
	TRY(check_text("client", answer->client, true, error));
	TRY(check_text("session", session, false, error));
	TRY(check_count("sequence", answer->sequence, error));
	TRY(check_blob("result", answer->result, error));

	size_t bytes = text_bytes(answer->client) + text_bytes(session) + answer->result.bytes;
	struct record *record = append(batch, RECORD_ANSWER, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_answer *copy = &record->as.answer;
	copy->sequence = answer->sequence;
	copy->client = copy_text(&at, answer->client);
	copy->session = copy_text(&at, session);
	copy->result = copy_blob(&at, answer->result);
	return CAU_OK;
}

// Appends a checkpoint. If `give_back` is NULL, the snapshot is copied.
static cau_status append_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                    void (*give_back)(void *snapshot), cau_error *error)
{
	TRY(check_text("session", checkpoint->session, true, error));
	TRY(check_branch("branch", checkpoint->branch, 0, error));
	TRY(check_count("tick", checkpoint->tick, error));
	TRY(check_blob("snapshot", checkpoint->snapshot, error));

	size_t copied = give_back ? 0 : checkpoint->snapshot.bytes;
	struct record *record =
		append(batch, RECORD_CHECKPOINT, text_bytes(checkpoint->session) + copied, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_checkpoint *copy = &record->as.checkpoint;
	*copy = *checkpoint;
	copy->session = copy_text(&at, checkpoint->session);
	if (!give_back) {
		copy->snapshot = copy_blob(&at, checkpoint->snapshot);
		return CAU_OK;
	}
	record->lent = (void *)(uintptr_t)checkpoint->snapshot.data;
	record->give_back = give_back;
	batch->bytes += checkpoint->snapshot.bytes;
	return CAU_OK;
}

cau_status cau_store_put_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                    cau_error *error)
{
	return append_checkpoint(batch, checkpoint, NULL, error);
}

cau_status cau_store_lend_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                     void (*give_back)(void *snapshot), cau_error *error)
{
	CAU_ASSERT(give_back, "a snapshot of %zu bytes is lent for good", checkpoint->snapshot.bytes);
	return append_checkpoint(batch, checkpoint, give_back, error);
}

cau_status cau_store_put_event(cau_store_batch *batch, const cau_store_event *event,
                               cau_error *error)
{
	const char *session = empty_as_null(event->session);
	TRY(check_text("session", session, false, error));
	TRY(check_text("kind", event->kind, true, error));
	TRY(check_branch("branch", event->branch, 0, error));
	TRY(check_count("tick", event->tick, error));
	if (!event->text)
		return cau_fail(error, CAU_BAD_VALUE, "text", "is missing");
	TRY(check_blob("text", (cau_store_bytes){event->text, strlen(event->text)}, error));

	size_t bytes = text_bytes(session) + text_bytes(event->kind) + text_bytes(event->text);
	struct record *record = append(batch, RECORD_EVENT, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_event *copy = &record->as.event;
	*copy = *event;
	copy->session = copy_text(&at, session);
	copy->kind = copy_text(&at, event->kind);
	copy->text = copy_text(&at, event->text);
	return CAU_OK;
}

cau_status cau_store_forget_events(cau_store_batch *batch, const char *session, int64_t branch,
                                   uint64_t tick, cau_error *error)
{
	TRY(check_text("session", session, true, error));
	TRY(check_branch("branch", branch, 0, error));
	TRY(check_count("tick", tick, error));
	struct record *record = append(batch, RECORD_EVENTS_FORGET, text_bytes(session), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.event =
		(cau_store_event){.session = copy_text(&at, session), .branch = branch, .tick = tick};
	return CAU_OK;
}

cau_status cau_store_put_generation(cau_store_batch *batch, const char *text, cau_error *error)
{
	TRY(check_text("generation", text, true, error));
	struct record *record = append(batch, RECORD_GENERATION, text_bytes(text), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.generation = copy_text(&at, text);
	return CAU_OK;
}

cau_status cau_store_put_branch(cau_store_batch *batch, const cau_store_branch *branch,
                                cau_error *error)
{
	TRY(check_text("session", branch->session, true, error));
	TRY(check_branch("branch", branch->branch, 1, error));
	TRY(check_branch("parent", branch->parent, 0, error));
	TRY(check_count("fork_tick", branch->fork_tick, error));

	struct record *record = append(batch, RECORD_BRANCH, text_bytes(branch->session), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_branch *copy = &record->as.branch;
	*copy = *branch;
	copy->session = copy_text(&at, branch->session);
	return CAU_OK;
}

static cau_status append_gap(cau_store_batch *batch, enum record_kind kind,
                             const cau_store_gap *gap, cau_error *error)
{
	TRY(check_text("session", gap->session, true, error));
	TRY(check_branch("branch", gap->branch, 0, error));
	TRY(check_count("tick", gap->from_tick, error));
	TRY(check_count("tick", gap->before_tick, error));
	struct record *record = append(batch, kind, text_bytes(gap->session), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.gap = *gap;
	record->as.gap.session = copy_text(&at, gap->session);
	return CAU_OK;
}

cau_status cau_store_put_mark(cau_store_batch *batch, const char *session, int64_t branch,
                              uint64_t tick, cau_error *error)
{
	cau_store_gap mark = {.session = session, .branch = branch, .from_tick = tick};
	return append_gap(batch, RECORD_MARK, &mark, error);
}

cau_status cau_store_put_gap(cau_store_batch *batch, const cau_store_gap *gap, cau_error *error)
{
	if (gap->from_tick >= gap->before_tick)
		return cau_fail(error, CAU_BAD_VALUE, "before_tick", "a gap from tick %llu before %llu",
		                (unsigned long long)gap->from_tick, (unsigned long long)gap->before_tick);
	return append_gap(batch, RECORD_GAP, gap, error);
}

// ---- sessions that move ---------------------------------------------------------------
cau_status cau_store_put_moved(cau_store_batch *batch, const cau_store_moved *moved,
                               cau_error *error)
{
	const char *const texts[] = {moved->id,    moved->move, moved->target,
	                             moved->label, moved->url,  moved->proof};
	size_t bytes = 0;
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		bytes += text_bytes(texts[i]);
	TRY(check_text("id", moved->id, true, error));
	TRY(check_text("target", moved->target, true, error));
	TRY(check_text("label", moved->label, true, error));
	TRY(check_text("move", moved->move, true, error));
	TRY(check_text("proof", moved->proof, true, error));
	struct record *record = append(batch, RECORD_MOVED, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.moved = (cau_store_moved){.id = copy_text(&at, moved->id),
	                                     .move = copy_text(&at, moved->move),
	                                     .target = copy_text(&at, moved->target),
	                                     .label = copy_text(&at, moved->label),
	                                     .url = copy_text(&at, moved->url),
	                                     .proof = copy_text(&at, moved->proof)};
	return CAU_OK;
}

cau_status cau_store_put_arrival(cau_store_batch *batch, const cau_store_arrival *arrival,
                                 cau_error *error)
{
	TRY(check_text("id", arrival->id, true, error));
	TRY(check_text("move", arrival->move, true, error));
	TRY(check_text("lock", arrival->lock, true, error));
	TRY(check_text("source", arrival->source, true, error));
	TRY(check_text("label", arrival->label, true, error));
	size_t bytes = text_bytes(arrival->id) + text_bytes(arrival->move) + text_bytes(arrival->lock) +
	               text_bytes(arrival->source) + text_bytes(arrival->label) +
	               text_bytes(arrival->unlock) + text_bytes(arrival->seal);
	struct record *record = append(batch, RECORD_ARRIVAL, bytes, error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	cau_store_arrival *copy = &record->as.arrival;
	*copy = *arrival;
	copy->id = copy_text(&at, arrival->id);
	copy->move = copy_text(&at, arrival->move);
	copy->lock = copy_text(&at, arrival->lock);
	copy->source = copy_text(&at, arrival->source);
	copy->label = copy_text(&at, arrival->label);
	copy->unlock = copy_text(&at, arrival->unlock);
	copy->seal = copy_text(&at, arrival->seal);
	return CAU_OK;
}

cau_status cau_store_forget_arrival(cau_store_batch *batch, const char *id, cau_error *error)
{
	TRY(check_text("id", id, true, error));
	struct record *record = append(batch, RECORD_ARRIVAL_FORGET, text_bytes(id), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.arrival = (cau_store_arrival){.id = copy_text(&at, id)};
	return CAU_OK;
}

cau_status cau_store_lend_rows(cau_store_batch *batch, const char *id, const void *piece,
                               size_t bytes, void (*give_back)(void *piece), cau_error *error)
{
	CAU_ASSERT(give_back, "a piece of %zu bytes is lent for good", bytes);
	TRY(check_text("id", id, true, error));
	struct record *record = append(batch, RECORD_ROWS, text_bytes(id), error);
	if (!record)
		return CAU_NO_MEMORY;
	unsigned char *at = record->storage;
	record->as.rows.id = copy_text(&at, id);
	record->as.rows.piece = (cau_store_bytes){piece, bytes};
	record->lent = (void *)(uintptr_t)piece;
	record->give_back = give_back;
	batch->bytes += bytes;
	return CAU_OK;
}
