// SPDX-License-Identifier: GPL-3.0-or-later
// Receives the pieces of a session from another daemon. Each piece is searched for rows that
// concern more than the store. Then it is written together with the row that counts the pieces.
#include <stdlib.h>
#include <string.h>

#include "cautery/name.h"
#include "move/internal.h"
#include "store/rows.h"

enum { ARRIVALS_MOST = 64 }; // most arrivals that are not served yet

typedef cau_arrival arrival;
typedef cau_arrival_hand hand;

// The parts of a piece that concern more than the store.
typedef struct contents {
	uint32_t index, flags;
	bool has_header;
	char move[CAU_NAME_BYTES], source[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_move_hash lock, unlock;
	cau_move_hash seal; // the seal at the end of the piece
	hand hands[CAU_MAX_TOOLS];
	int32_t hand_count;
	double speed; // 0: the piece has no speed
} contents;

static void take_header(const cau_row *row, contents *found)
{
	found->has_header = true;
	cau_rows_text(row, 0, found->move, sizeof found->move);
	cau_rows_text(row, 1, found->lock, sizeof found->lock);
	cau_rows_text(row, 2, found->source, sizeof found->source);
	cau_rows_text(row, 3, found->label, sizeof found->label);
	cau_rows_text(row, 5, found->unlock, sizeof found->unlock);
}

static void take_hand(const cau_row *row, contents *found)
{
	if (found->hand_count == CAU_MAX_TOOLS)
		return;
	hand *made = &found->hands[found->hand_count++];
	cau_asker *asker = &made->client.asker;
	cau_rows_text(row, 0, made->tool, sizeof made->tool);
	cau_rows_text(row, 1, made->client.resume, sizeof made->client.resume);
	cau_rows_text(row, 2, asker->client_id, sizeof asker->client_id);
	cau_rows_text(row, 3, asker->name, sizeof asker->name);
	// The tool waits, with energy off, for a client that says hello with its own role.
	asker->role = CAU_ROLE_OPERATE;
	asker->deadline_s = (double)row->column[5].integer * 1e-6;
}

// Removes the seal from the end of the piece.
static cau_status take_seal(cau_move_asked *asked, contents *found, cau_error *error)
{
	if (asked->piece_bytes < CAU_SEAL_BYTES)
		return cau_fail(error, CAU_CORRUPT, "params.upload",
		                "the upload is not a piece of a session");
	asked->piece_bytes -= CAU_SEAL_BYTES;
	memcpy(found->seal, asked->piece + asked->piece_bytes, CAU_SEAL_BYTES);
	return CAU_OK;
}

static cau_status read_contents(const cau_move_asked *asked, contents *found, cau_error *error)
{
	cau_rows_reader reader;
	cau_row row;
	cau_status status = cau_rows_open(&reader, asked->piece, asked->piece_bytes, error);
	if (status)
		return status;
	found->index = reader.index;
	found->flags = reader.flags;
	while (!(status = cau_rows_next(&reader, &row, error))) {
		if (row.table == CAU_ROWS_HEADER)
			take_header(&row, found);
		else if (row.table == CAU_ROWS_DRIVERS)
			take_hand(&row, found);
		else if (row.table == CAU_ROWS_PACE)
			found->speed = (double)row.column[0].integer * 1e-6;
	}
	if (status != CAU_NOT_FOUND)
		return status;
	bool begins = found->has_header && strcmp(found->move, asked->move) == 0 &&
	              strlen(found->lock) == CAU_SEAL_BYTES &&
	              strlen(found->unlock) == CAU_SEAL_BYTES && cau_name_is_valid(found->source);
	if (found->has_header != (found->index == 0) || (found->has_header && !begins))
		return cau_fail(error, CAU_BAD_VALUE, "params.upload", "the piece belongs to another move");
	return CAU_OK;
}

static cau_status check_id(const cau_moves *moves, const char *id, cau_error *error)
{
	size_t bytes = strlen(moves->def.config->label);
	if (strncmp(id, moves->def.config->label, bytes) == 0 && id[bytes] == '-')
		return CAU_OK;
	return cau_fail(error, CAU_BAD_VALUE, "params.session",
	                "the ids of this daemon's sessions begin with `%s-`", moves->def.config->label);
}

// Called with the lock. Checks whether a new move may bring a session with this id.
static cau_status check_place(cau_moves *moves, const char *id, cau_error *error)
{
	const arrival *old = cau_arrival_find(moves, id);
	cau_hosted *other = cau_hub_find(moves->def.hub, id);
	cau_hosted_release(other);
	if (other)
		return cau_fail(error, CAU_ALREADY_EXISTS, "params.session", "`%s` exists", id);
	if (old && (old->accepting || old->hosted))
		return cau_fail(error, CAU_BAD_STATE, "params.session",
		                "an earlier move of `%s` is still being finished: try again in a second",
		                id);
	if (cau_hub_count(moves->def.hub) >= moves->def.config->max_sessions)
		return cau_fail(error, CAU_LIMIT, "",
		                "the daemon has %lld sessions, which is the limit (setting max_sessions)",
		                (long long)moves->def.config->max_sessions);
	return check_id(moves, id, error);
}

// Called with the lock. Adds a new arrival before any older arrival of the same id. The older
// arrival's session is gone. The older arrival stays in the list until the first piece of the new
// arrival is on the disk.
static arrival *enlist(cau_moves *moves, const cau_move_asked *asked, const contents *found,
                       cau_error *error)
{
	int32_t waiting = 0;
	for (const arrival *a = moves->arrivals; a; a = a->next)
		waiting += cau_arrival_waits(a);
	if (waiting >= ARRIVALS_MOST) {
		cau_fail(error, CAU_LIMIT, "", "%d sessions are already moving here: try again later",
		         waiting);
		return NULL;
	}
	arrival *a = calloc(1, sizeof *a);
	if (!a) {
		cau_fail(error, CAU_NO_MEMORY, "", "no memory for a move");
		return NULL;
	}
	memcpy(a->id, asked->session, sizeof a->id);
	memcpy(a->move, asked->move, sizeof a->move);
	memcpy(a->lock, found->lock, sizeof a->lock);
	memcpy(a->unlock, found->unlock, sizeof a->unlock);
	memcpy(a->source, found->source, sizeof a->source);
	memcpy(a->label, found->label, sizeof a->label);
	a->speed = 1;
	a->next = moves->arrivals;
	moves->arrivals = a;
	return a;
}

// Checks that the piece is as the source sent it, and follows the pieces that are here.
static cau_status check_seal(const cau_move_asked *asked, const char *before, const contents *found,
                             cau_error *error)
{
	cau_move_hash seal;
	if (!cau_move_seal(before, asked->piece, asked->piece_bytes, seal))
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a piece");
	if (strcmp(seal, found->seal) != 0)
		return cau_fail(
			error, CAU_CORRUPT, "params.upload",
			"the piece was damaged in transfer, or belongs to another daemon: cancel the move "
			"and begin again");
	return CAU_OK;
}

static cau_status check_turn(const arrival *a, const cau_move_asked *asked, const contents *found,
                             cau_error *error)
{
	if (a && strcmp(a->move, asked->move) != 0)
		return cau_fail(error, CAU_BAD_STATE, "params.upload",
		                "another move of this session is under way: finish it with `cautery move`");
	bool all_here = a && a->coming.state >= CAU_COMING_WHOLE;
	if (a ? a->writing || all_here || a->pieces != found->index : found->index > 0)
		return cau_fail(error, CAU_BAD_STATE, "params.upload",
		                "pieces must come in order, and this one is not the next");
	return CAU_OK;
}

// True if the courier sends its newest piece again because it missed the answer.
static bool is_repeated(const arrival *a, const cau_move_asked *asked, const contents *found)
{
	return a && strcmp(a->move, asked->move) == 0 && !a->writing &&
	       a->pieces == (int64_t)found->index + 1 && strcmp(a->seal, found->seal) == 0;
}

// Answers how many pieces are on the disk, with the receipt once all are. Called with the lock of
// cau_moves.
static void answer_received(const arrival *a, const cau_reply *reply)
{
	cau_wire_move_received result = {.pieces = a->pieces,
	                                 .has_receipt = a->coming.state >= CAU_COMING_WHOLE};
	if (result.has_receipt && !cau_move_receipt(a->move, a->seal, result.receipt))
		cau_move_fail(reply, CAU_NO_MEMORY, 0, "", "no memory for the answer");
	else
		cau_move_answer(reply, &result);
}

// Returns the arrival that takes this piece next, marked as `writing`. Returns NULL if the piece is
// refused (*error), or if it was already here; in the second case the request is answered.
static arrival *begin_piece(cau_move_job *job, const contents *found, int32_t *code,
                            cau_error *error)
{
	cau_moves *moves = job->moves;
	pthread_mutex_lock(&moves->mutex);
	arrival *a = cau_arrival_find(moves, job->asked.session);
	if (a && cau_coming_serves(&a->coming))
		a = NULL; // this arrival belongs to an earlier move that was accepted
	bool is_new = !a;
	if (is_repeated(a, &job->asked, found)) {
		answer_received(a, &job->reply);
		a = NULL;
	} else if (cau_arrivals_check_open(moves, code, error) ||
	           check_turn(a, &job->asked, found, error) ||
	           check_seal(&job->asked, a ? a->seal : "", found, error) ||
	           (is_new && check_place(moves, job->asked.session, error))) {
		a = NULL;
	} else {
		a = a ? a : enlist(moves, &job->asked, found, error);
	}
	if (a)
		a->writing = true;
	pthread_mutex_unlock(&moves->mutex);
	return a;
}

typedef struct at_disk {
	cau_moves *moves;
	arrival *arrival;
	cau_reply reply;
	contents found;
} at_disk;

static void note_contents(arrival *a, const contents *found)
{
	if (found->speed > 0)
		a->speed = found->speed;
	for (int32_t i = 0; i < found->hand_count && a->hand_count < CAU_MAX_TOOLS; i++)
		a->hands[a->hand_count++] = found->hands[i];
}

// Called with the lock once the first piece of `a` is on the disk and has replaced the row of an
// earlier move.
static void end_older(cau_moves *moves, const arrival *a)
{
	arrival *old = a->next;
	while (old && (old->forgotten || strcmp(old->id, a->id) != 0))
		old = old->next;
	if (old)
		cau_arrival_take_out(moves, old);
}

// Called on the store's thread with the outcome of the commit of a piece.
static void piece_written(void *user, cau_status status, const char *reason)
{
	at_disk *done = user;
	arrival *a = done->arrival;
	bool last = done->found.flags & CAU_ROWS_ENDS;
	cau_fault_point(last ? "move_last_piece" : "move_piece");
	pthread_mutex_lock(&done->moves->mutex);
	a->writing = false;
	if (!status) {
		cau_coming_take(&a->coming, last ? CAU_COMING_LAST : CAU_COMING_PIECE, true);
		note_contents(a, &done->found);
		memcpy(a->seal, done->found.seal, sizeof a->seal);
		if (a->pieces++ == 0)
			end_older(done->moves, a);
		answer_received(a, &done->reply);
	} else {
		if (a->pieces == 0)
			cau_arrival_take_out(done->moves, a);
		cau_move_fail(&done->reply, status, cau_hosted_commit_code(status), "", reason);
	}
	pthread_mutex_unlock(&done->moves->mutex);
	free(done);
}

static cau_status write_piece(cau_move_job *job, at_disk *travelling, cau_error *error)
{
	bool last = travelling->found.flags & CAU_ROWS_ENDS;
	cau_store_arrival row = cau_arrival_row(travelling->arrival, travelling->found.index + 1,
	                                        last ? CAU_STORE_WHOLE : CAU_STORE_ARRIVING);
	row.seal = travelling->found.seal;
	cau_store_batch *batch = cau_store_batch_create();
	if (!batch)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a piece");
	cau_status status = cau_store_put_arrival(batch, &row, error);
	if (!status)
		status = cau_store_lend_rows(batch, row.id, job->asked.piece, job->asked.piece_bytes, free,
		                             error);
	if (!status)
		job->asked.piece = NULL; // the batch owns the piece now
	if (!status)
		status = cau_store_submit(job->moves->def.store, batch, piece_written, travelling, error);
	if (status)
		cau_store_batch_destroy(batch);
	return status;
}

void cau_arrival_receive(cau_move_job *job)
{
	cau_error error = {0};
	int32_t code = 0;
	at_disk *travelling = calloc(1, sizeof *travelling);
	cau_status status = travelling ? take_seal(&job->asked, &travelling->found, &error)
	                               : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a piece");
	if (!status)
		status = read_contents(&job->asked, &travelling->found, &error);
	arrival *a = status ? NULL : begin_piece(job, &travelling->found, &code, &error);
	if (a) {
		travelling->moves = job->moves;
		travelling->arrival = a;
		travelling->reply = job->reply;
		status = write_piece(job, travelling, &error);
		if (!status)
			return;
		piece_written(travelling, status, error.reason);
		return;
	}
	if (error.status)
		cau_reply_fail(&job->reply, &error, code);
	free(travelling);
}
