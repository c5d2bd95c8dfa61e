// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that leave for another daemon. Their existing rows are sent in pieces while they are
// served. departure_end.c ends the departures.
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "cautery/sha256.h"
#include "move/internal.h"

enum {
	// Size of a piece, which is exceeded by at most one table row. The target commits one piece at
	// a time.
	PIECE_BYTES = 4 << 20,
	TOMBSTONES_MOST = 100000,
};

// Longest time, s, from the first piece to the courier's request for more. A courier that takes
// longer counts as gone. A line of 4 Mbit/s takes 8.4 s for PIECE_BYTES.
#define FIRST_PIECE_MOST_S 10.

typedef cau_departure departure;

static void destroy(departure *d)
{
	cau_store_dump_close(d->dump);
	cau_hosted_release(d->hosted);
	free(d);
}

// Returns the departure of this session, or NULL. Called with the lock of cau_moves.
static departure *find(cau_moves *moves, const char *id)
{
	departure *d = moves->departures;
	while (d && strcmp(d->id, id) != 0)
		d = d->next;
	return d;
}

departure *cau_departure_find_own(cau_moves *moves, const cau_move_asked *asked)
{
	departure *d = find(moves, asked->session);
	return d && strcmp(d->becomes.move, asked->move) == 0 ? d : NULL;
}

void cau_departure_take_out(cau_moves *moves, departure *d)
{
	departure **link = &moves->departures;
	while (*link != d)
		link = &(*link)->next;
	*link = d->next;
	d->over = true;
	if (!d->reading)
		destroy(d);
}

void cau_departure_fail_unknown(const cau_reply *reply)
{
	cau_move_fail(reply, CAU_BAD_STATE, 0, "params.move",
	              "no such move is under way here: begin again");
}

// ---- begin --------------------------------------------------------------------------------------

static bool make_hex(char *hex, size_t bytes)
{
	unsigned char random[32];
	if (getrandom(random, bytes, 0) != (ssize_t)bytes)
		return false;
	for (size_t i = 0; i < bytes; i++)
		snprintf(hex + 2 * i, 3, "%02x", random[i]);
	return true;
}

static cau_status fill(const cau_moves *moves, departure *d, const cau_move_asked *asked,
                       cau_error *error)
{
	size_t label_bytes = strlen(asked->label);
	if (strncmp(asked->to.session, asked->label, label_bytes) != 0 ||
	    asked->to.session[label_bytes] != '-')
		return cau_fail(error, CAU_BAD_VALUE, "params.target", "the new id must begin with `%s-`",
		                asked->label);
	if (strcmp(asked->to.session, asked->session) == 0)
		return cau_fail(error, CAU_BAD_VALUE, "params.target",
		                "the session is on that daemon already");
	memcpy(d->id, asked->session, sizeof d->id);
	memcpy(d->label, asked->label, sizeof d->label);
	memcpy(d->becomes.id, asked->session, sizeof d->becomes.id);
	d->becomes.to = asked->to;
	d->becomes.move[0] = 'm'; // a name must begin with a letter
	if (!make_hex(d->becomes.move + 1, 16) || !make_hex(d->becomes.proof, 32))
		return cau_fail(error, CAU_UNSUPPORTED, "", "the system gives no random bytes");
	if (!cau_sha256(d->becomes.proof, strlen(d->becomes.proof), d->lock) ||
	    !cau_move_release(moves->secret, d->becomes.move, d->release) ||
	    !cau_sha256(d->release, strlen(d->release), d->unlock))
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a move");
	return CAU_OK;
}

// Returns a session that may leave, with a reference. Returns NULL after a failure that is
// answered.
static cau_hosted *find_hosted(cau_move_job *job)
{
	cau_moved_to to;
	cau_hosted *hosted = cau_hub_find(job->moves->def.hub, job->asked.session);
	bool ephemeral = hosted && cau_hosted_is_ephemeral(hosted);
	if (hosted && !cau_hosted_starting(hosted) && !ephemeral)
		return hosted;
	if (ephemeral)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "params.session",
		              "an ephemeral session is not stored, so it cannot move");
	else if (hosted)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "params.session",
		              "the session is being built");
	else if (cau_tombstones_have(job->moves, job->asked.session, &to))
		cau_reply_moved(&job->reply, &to);
	else
		cau_move_fail(&job->reply, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "this daemon has no such session");
	cau_hosted_release(hosted);
	return NULL;
}

// True if the courier of this move is gone before the target had a piece. The target's list then
// does not name the move, so no later courier would find the move there.
static bool is_left(const departure *d, double now_s)
{
	if (d->reading || d->leaving.state != CAU_LEAVING_SENDS || d->pieces > 1)
		return false;
	return !d->part_sent || now_s - d->touched_s > FIRST_PIECE_MOST_S;
}

// Called with the lock. Ends the session's present move if its courier is gone.
static void give_way(cau_moves *moves, const char *id)
{
	departure *d = find(moves, id);
	if (!d || !is_left(d, cau_monotonic_s()))
		return;
	cau_leaving_take(&d->leaving, CAU_LEAVING_LATE, true);
	cau_log(CAU_LOG_NOTICE, d->id, "move_ended",
	        "move=%s reason=\"the courier of the move is gone\"", d->becomes.move);
	cau_departure_take_out(moves, d);
}

static cau_status enlist(cau_moves *moves, departure *d, cau_error *error)
{
	cau_status status = CAU_OK;
	pthread_mutex_lock(&moves->mutex);
	give_way(moves, d->id);
	if (find(moves, d->id))
		status = cau_fail(
			error, CAU_BAD_STATE, "params.session",
			"the session is being moved already: cancel that with `cautery move --cancel`");
	else if (moves->tombstone_count >= TOMBSTONES_MOST)
		status = cau_fail(error, CAU_LIMIT, "",
		                  "%d sessions have moved away from this daemon, which is the limit",
		                  TOMBSTONES_MOST);
	else {
		cau_leaving_take(&d->leaving, CAU_LEAVING_BEGIN, true);
		d->touched_s = cau_monotonic_s();
		d->next = moves->departures;
		moves->departures = d;
	}
	pthread_mutex_unlock(&moves->mutex);
	return status;
}

void cau_departure_begin(cau_move_job *job)
{
	cau_error error = {0};
	cau_wire_move_begun result = {0};
	cau_hosted *hosted = find_hosted(job);
	if (!hosted)
		return;
	departure *d = calloc(1, sizeof *d);
	if (!d) {
		cau_hosted_release(hosted);
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for a move");
		return;
	}
	d->hosted = hosted;
	cau_status status = fill(job->moves, d, &job->asked, &error);
	cau_store_flush(job->moves->def.store); // waits for the rows of a session that was just created
	if (!status)
		status = cau_store_dump_open(job->moves->def.store, d->id, &d->dump, &error);
	memcpy(result.move, d->becomes.move, sizeof result.move);
	if (!status)
		status = enlist(job->moves, d, &error);
	if (status) {
		destroy(d);
		cau_reply_fail(&job->reply, &error, 0);
		return;
	}
	cau_log(CAU_LOG_NOTICE, job->asked.session, "move_began", "move=%s to=%s", result.move,
	        job->asked.to.session);
	cau_move_answer(&job->reply, &result);
}

// ---- read ---------------------------------------------------------------------------------------

// Writes the speed and the drivers of the tools. Drivers are only in memory, so they are written
// with the remaining rows. A driver's row has the token with which the client gets the tool back.
static void write_hands(cau_moves *moves, departure *d, cau_rows_writer *writer)
{
	cau_drive drives[CAU_MAX_TOOLS];
	double speed;
	int32_t count = cau_hosted_hands(d->hosted, drives, &speed);
	cau_rows_put_values(writer, CAU_ROWS_PACE, (int64_t)(speed * 1e6 + 0.5));
	for (int32_t i = 0; i < count; i++) {
		char token[CAU_RESUME_BYTES];
		const cau_asker *driver = &drives[i].driver;
		if (driver->client && cau_hub_resume_token(moves->def.hub, driver->client, token))
			cau_rows_put_values(writer, CAU_ROWS_DRIVERS, drives[i].tool, token, driver->client_id,
			                    driver->name, (int64_t)driver->role,
			                    (int64_t)(driver->deadline_s * 1e6));
	}
}

static cau_status write_part(cau_moves *moves, departure *d, bool held, cau_rows_writer *writer,
                             cau_error *error)
{
	bool over = false;
	cau_status status = CAU_OK;
	if (d->part_sent && !d->rest_begun) {
		d->rest_begun = true;
		write_hands(moves, d, writer);
		status = cau_store_dump_rest(d->dump, error);
	}
	if (!status)
		status = cau_store_dump_write(d->dump, writer, PIECE_BYTES, &over, error);
	if (status || !over)
		return status;
	d->all_sent = d->part_sent && held;
	d->part_sent = true;
	cau_rows_flag(writer, d->all_sent ? CAU_ROWS_ENDS : CAU_ROWS_PART_ENDS);
	return CAU_OK;
}

static bool seal_piece(departure *d, cau_rows_writer *writer)
{
	bool sealed = cau_move_seal(d->seal, writer->bytes, writer->byte_count, d->seal);
	cau_rows_append(writer, d->seal, CAU_SEAL_BYTES);
	return sealed && !writer->failed;
}

static cau_status write_piece(cau_moves *moves, departure *d, bool held, cau_rows_writer *writer,
                              cau_error *error)
{
	cau_rows_begin(writer, d->pieces);
	if (d->pieces == 0)
		cau_rows_put_values(writer, CAU_ROWS_HEADER, d->becomes.move, d->lock, d->id,
		                    moves->def.config->label, cau_hosted_scene(d->hosted)->name, d->unlock);
	d->pieces++;
	cau_status status = write_part(moves, d, held, writer, error);
	if (!status && (writer->failed || !seal_piece(d, writer)))
		status = cau_fail(error, CAU_NO_MEMORY, "", "no memory for a piece of the session");
	return status;
}

// Returns the departure for this job to read, or NULL after a failure that is answered.
static departure *begin_reading(cau_move_job *job, bool *held)
{
	const char *why = NULL;
	pthread_mutex_lock(&job->moves->mutex);
	departure *d = cau_departure_find_own(job->moves, &job->asked);
	*held = d && d->leaving.state == CAU_LEAVING_HELD;
	if (d && d->reading)
		why = "another piece is being read";
	else if (d && d->all_sent)
		why = "all pieces have been read";
	else if (d && d->part_sent && !*held)
		why = "the rest can be read when the session is suspended: call move.hold";
	if (d && !why) {
		d->reading = true;
		d->touched_s = cau_monotonic_s();
	}
	pthread_mutex_unlock(&job->moves->mutex);
	if (!d)
		cau_departure_fail_unknown(&job->reply);
	else if (why)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", why);
	return why ? NULL : d;
}

static void end_reading(cau_moves *moves, departure *d)
{
	pthread_mutex_lock(&moves->mutex);
	d->reading = false;
	if (d->over)
		destroy(d);
	pthread_mutex_unlock(&moves->mutex);
}

void cau_departure_read(cau_move_job *job)
{
	bool held;
	cau_error error = {0};
	cau_rows_writer writer = {0};
	departure *d = begin_reading(job, &held);
	if (!d)
		return;
	char name[2 * CAU_NAME_BYTES];
	snprintf(name, sizeof name, "%s-%u.caum", d->id, (unsigned)d->pieces);
	cau_status status = write_piece(job->moves, d, held, &writer, &error);
	cau_fault_point("move_reading");
	end_reading(job->moves, d);
	if (status)
		cau_reply_fail(&job->reply, &error, 0);
	else
		cau_hosted_answer_file(&job->reply, name, "application/octet-stream", writer.bytes,
		                       writer.byte_count);
	free(writer.bytes);
}

// ---- all departures -----------------------------------------------------------------------------

void cau_departures_list(const cau_moves *moves, cau_wire_list *list)
{
	cau_wire_move_entry *entries = list->items;
	for (const departure *d = moves->departures; d && list->count < list->capacity; d = d->next) {
		cau_wire_move_entry *entry = &entries[list->count++];
		*entry = (cau_wire_move_entry){0};
		memcpy(entry->session, d->id, sizeof entry->session);
		memcpy(entry->move, d->becomes.move, sizeof entry->move);
		memcpy(entry->other, d->becomes.to.session, sizeof entry->other);
		cau_leaving_state state = d->leaving.state;
		snprintf(entry->state, sizeof entry->state, "%s",
		         cau_leaving_serves(&d->leaving) ? "leaving"
		         : state == CAU_LEAVING_HELD     ? "held"
		                                         : "deciding");
	}
}

void cau_departures_free(cau_moves *moves)
{
	for (departure *d = moves->departures, *next; d; d = next) {
		next = d->next;
		destroy(d);
	}
	moves->departures = NULL;
}
