// SPDX-License-Identifier: GPL-3.0-or-later
// The end of a departure. The session is suspended, its remaining rows are sent, and a row in the
// store names its target. Otherwise the session resumes here.
#include <stdlib.h>
#include <string.h>

#include "move/internal.h"

// Longest suspension of a session, s. After a longer time the session resumes.
#define HELD_MOST_S 30.
// Longest silence of a courier, s. A courier that is silent for longer counts as gone.
#define SENDS_MOST_S 60.

typedef cau_departure departure;

// ---- the session stays --------------------------------------------------------------------------

static void clear(cau_moves *moves, departure *d);

// Called with the lock. Carries out the act that followed a cancel or a timeout. May remove the
// departure from the list.
static void let_go(cau_moves *moves, departure *d, cau_leaving_state from, cau_leaving_act act)
{
	if (act == CAU_LEAVING_DO_CLEAR) {
		clear(moves, d);
		return;
	}
	if (act != CAU_LEAVING_DO_GO_ON)
		return;
	cau_log(CAU_LOG_NOTICE, d->id, "move_ended", "move=%s reason=\"the session stays here\"",
	        d->becomes.move);
	if (from != CAU_LEAVING_SENDS)
		cau_hosted_go_on(d->hosted);
	cau_move_kept(&d->waiting, d->release);
	cau_departure_take_out(moves, d);
}

typedef struct at_disk {
	cau_moves *moves;
	departure *departure;
} at_disk;

// Called on the store's thread with the outcome of the commit that clears a refused tombstone.
static void cleared(void *user, cau_status status, const char *reason)
{
	at_disk *done = user;
	cau_moves *moves = done->moves;
	departure *d = done->departure;
	(void)reason;
	pthread_mutex_lock(&moves->mutex);
	cau_leaving_act act =
		cau_leaving_take(&d->leaving, status ? CAU_LEAVING_REFUSED : CAU_LEAVING_WRITTEN, true);
	if (status) {
		cau_move_fail(&d->waiting, CAU_IO, CAU_RPC_STORE_FULL, "", "the store is full");
		d->waiting = (cau_reply){0};
		// the suspension is timed from now on, so the commit is tried again later
		d->held_s = cau_monotonic_s();
	} else {
		let_go(moves, d, CAU_LEAVING_CLEARING, act);
	}
	pthread_mutex_unlock(&moves->mutex);
	free(done);
}

static cau_status submit(cau_moves *moves, departure *d, cau_store_batch *batch,
                         cau_store_callback callback, cau_error *error)
{
	at_disk *travelling = malloc(sizeof *travelling);
	if (!travelling)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a commit");
	*travelling = (at_disk){moves, d};
	cau_status status = cau_store_submit(moves->def.store, batch, callback, travelling, error);
	if (status)
		free(travelling);
	return status;
}

// Makes any further commit, so that a tombstone that the disk refused cannot appear on it.
static void clear(cau_moves *moves, departure *d)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_event event = {.kind = "move_ended", .text = d->id};
	cau_status status = batch ? cau_store_put_event(batch, &event, &error)
	                          : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a commit");
	if (!status)
		status = submit(moves, d, batch, cleared, &error);
	if (!status)
		return;
	cau_store_batch_destroy(batch);
	cau_leaving_take(&d->leaving, CAU_LEAVING_UNSENT, true);
	cau_reply_fail(&d->waiting, &error, status == CAU_IO ? CAU_RPC_STORE_FULL : 0);
	d->waiting = (cau_reply){0};
	d->held_s = cau_monotonic_s();
}

static bool is_late(const departure *d, double now_s)
{
	cau_leaving_state state = d->leaving.state;
	if (state == CAU_LEAVING_HELD || state == CAU_LEAVING_DOUBTS)
		return now_s - d->held_s > HELD_MOST_S;
	return state == CAU_LEAVING_SENDS && now_s - d->touched_s > SENDS_MOST_S;
}

void cau_departures_let_go(cau_moves *moves, double now_s, bool all)
{
	if (all) { // no further commits are made, and those under way have ended
		pthread_mutex_lock(&moves->mutex);
		moves->ends = true;
		pthread_mutex_unlock(&moves->mutex);
		cau_store_flush(moves->def.store);
	}
	pthread_mutex_lock(&moves->mutex);
	for (departure *d = moves->departures, *next; d; d = next) {
		next = d->next;
		cau_leaving_state from = d->leaving.state;
		if (all || is_late(d, now_s))
			let_go(moves, d, from, cau_leaving_take(&d->leaving, CAU_LEAVING_LATE, true));
	}
	pthread_mutex_unlock(&moves->mutex);
}

// ---- hold ---------------------------------------------------------------------------------------

// The request that is answered once the session is suspended, or cannot be.
typedef struct holding {
	cau_moves *moves;
	cau_move_asked asked;
	cau_reply reply;
} holding;

static void held(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	holding *asked = user;
	cau_moves *moves = asked->moves;
	(void)reply;
	cau_fault_point("move_stopped");
	pthread_mutex_lock(&moves->mutex);
	departure *d = cau_departure_find_own(moves, &asked->asked);
	cau_leaving_act act = cau_leaving_take(
		&d->leaving, outcome->error ? CAU_LEAVING_NOT_STOPPED : CAU_LEAVING_STOPPED, true);
	d->held_s = cau_monotonic_s();
	if (outcome->error) // the session has resumed by itself
		cau_departure_take_out(moves, d);
	else
		let_go(moves, d, CAU_LEAVING_STOPS, act);
	pthread_mutex_unlock(&moves->mutex);
	if (outcome->error || act == CAU_LEAVING_SAY_HELD)
		cau_reply_answer(&asked->reply, outcome);
	else
		cau_move_fail(&asked->reply, CAU_BAD_STATE, 0, "", "the move was cancelled meanwhile");
	free(asked);
}

static void ask_to_hold(cau_move_job *job, cau_hosted *hosted)
{
	cau_error error = {0};
	holding *asked = malloc(sizeof *asked);
	cau_order *order = calloc(1, sizeof *order);
	cau_reply reply = {.answer = held, .user = asked, .method = job->reply.method};
	if (!asked || !order) {
		free(asked);
		free(order);
		cau_departures_let_go(job->moves, cau_monotonic_s(), false);
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for the request");
		return;
	}
	*asked = (holding){.moves = job->moves, .asked = job->asked, .reply = job->reply};
	order->kind = CAU_ORDER_HOLD;
	order->asker = (cau_asker){.name = "a move", .role = CAU_ROLE_ADMIN};
	order->reply = reply;
	if (cau_hosted_submit(hosted, order, &error)) {
		free(order);
		cau_reply_fail(&reply, &error, 0);
	}
}

void cau_departure_hold(cau_move_job *job)
{
	pthread_mutex_lock(&job->moves->mutex);
	departure *d = cau_departure_find_own(job->moves, &job->asked);
	bool known = d != NULL;
	bool stops = known && !d->reading && d->part_sent &&
	             cau_leaving_take(&d->leaving, CAU_LEAVING_HOLD, true) == CAU_LEAVING_DO_STOP;
	cau_hosted *hosted = stops ? cau_hosted_share(d->hosted) : NULL;
	pthread_mutex_unlock(&job->moves->mutex);
	if (!known)
		cau_departure_fail_unknown(&job->reply);
	else if (!stops)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "",
		              "the session is suspended already, or the first part of this move has not "
		              "been read yet");
	else
		ask_to_hold(job, hosted);
	cau_hosted_release(hosted);
}

// ---- commit -------------------------------------------------------------------------------------

static bool is_own_fault(cau_status status)
{
	return status == CAU_NOT_FOUND || status == CAU_BAD_VALUE || status == CAU_ALREADY_EXISTS ||
	       status == CAU_LIMIT;
}

// Ends the session here, because its tombstone is on the disk. Called with the lock of cau_moves.
static void go_away(cau_moves *moves, departure *d)
{
	cau_tombstone_put(moves, &d->becomes);
	cau_hosted_go_away(d->hosted, &d->becomes.to);
	cau_move_decided(&d->waiting, &d->becomes);
	cau_departure_take_out(moves, d);
}

static void decided(void *user, cau_status status, const char *reason)
{
	at_disk *done = user;
	cau_moves *moves = done->moves;
	departure *d = done->departure;
	cau_leaving_event event = !status                ? CAU_LEAVING_WRITTEN
	                          : is_own_fault(status) ? CAU_LEAVING_UNSENT
	                                                 : CAU_LEAVING_REFUSED;
	cau_fault_point("move_decided");
	pthread_mutex_lock(&moves->mutex);
	cau_leaving_act act = cau_leaving_take(&d->leaving, event, true);
	if (act == CAU_LEAVING_DO_END) {
		go_away(moves, d);
	} else {
		cau_move_fail(&d->waiting, status, cau_hosted_commit_code(status), "", reason);
		d->waiting = (cau_reply){0};
		let_go(moves, d, CAU_LEAVING_HELD, act);
	}
	pthread_mutex_unlock(&moves->mutex);
	free(done);
}

// Submits the tombstone to the store. `reply` is answered after the commit. Called with the lock of
// cau_moves.
static void write_tombstone(cau_moves *moves, departure *d, const cau_reply *reply)
{
	cau_error error = {0};
	const cau_tombstone *row = &d->becomes;
	cau_store_moved moved = {.id = row->id,
	                         .move = row->move,
	                         .target = row->to.session,
	                         .label = d->label,
	                         .url = row->to.url,
	                         .proof = row->proof};
	cau_store_batch *batch = cau_store_batch_create();
	cau_status status = batch && cau_tombstones_reserve(moves)
	                        ? cau_store_put_moved(batch, &moved, &error)
	                        : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a commit");
	d->waiting = *reply;
	if (!status)
		status = submit(moves, d, batch, decided, &error);
	if (!status)
		return;
	cau_store_batch_destroy(batch);
	cau_leaving_state from = d->leaving.state;
	cau_leaving_act act = cau_leaving_take(&d->leaving, CAU_LEAVING_UNSENT, true);
	cau_reply_fail(reply, &error, cau_hosted_commit_code(status));
	d->waiting = (cau_reply){0};
	let_go(moves, d, from, act);
}

// Called with the lock. Answers with the tombstone if it belongs to this move. Returns whether it
// did.
static bool show(cau_move_job *job)
{
	const cau_tombstone *found = cau_tombstone_find(job->moves, job->asked.session);
	bool own = found && strcmp(found->move, job->asked.move) == 0;
	if (own)
		cau_move_decided(&job->reply, found);
	return own;
}

// True if the receipt is the target's for all pieces.
static bool is_received(const departure *d, const char *receipt)
{
	cau_move_hash wanted;
	return cau_move_receipt(d->becomes.move, d->seal, wanted) && strcmp(receipt, wanted) == 0;
}

void cau_departure_commit(cau_move_job *job)
{
	pthread_mutex_lock(&job->moves->mutex);
	departure *d = cau_departure_find_own(job->moves, &job->asked);
	if (!d) {
		if (!show(job))
			cau_departure_fail_unknown(&job->reply);
	} else if (job->moves->ends) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, CAU_RPC_DRAINING, "",
		              "the server is shutting down");
	} else if (d->reading || !d->all_sent) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "not all pieces have been read");
	} else if (!is_received(d, job->asked.key)) {
		cau_move_fail(
			&job->reply, CAU_BAD_VALUE, 0, "params.receipt",
			"not the receipt that the other daemon returned for the last piece of this move");
	} else if (cau_leaving_take(&d->leaving, CAU_LEAVING_COMMIT, true) == CAU_LEAVING_DO_WRITE) {
		write_tombstone(job->moves, d, &job->reply);
	} else {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "the move is being decided: ask again");
	}
	pthread_mutex_unlock(&job->moves->mutex);
}

// ---- cancel -------------------------------------------------------------------------------------

// True if the id belongs to this daemon. A courier that asks another daemon than the source must
// not be answered that the session stays there.
static bool is_of_this_daemon(const cau_moves *moves, const char *id)
{
	size_t bytes = strlen(moves->def.config->label);
	return strncmp(id, moves->def.config->label, bytes) == 0 && id[bytes] == '-';
}

static void cancel(cau_move_job *job, departure *d)
{
	cau_leaving_state from = d->leaving.state;
	cau_leaving_act act = cau_leaving_take(&d->leaving, CAU_LEAVING_CANCEL, true);
	if (act == CAU_LEAVING_NOTHING) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "the move is being decided: ask again");
		return;
	}
	d->waiting = job->reply;
	let_go(job->moves, d, from, act);
}

// Answers that the session stays. No such move is under way or decided, so it never will be: its
// proof was only in memory.
static void keep(cau_move_job *job)
{
	cau_move_hash release;
	if (cau_move_release(job->moves->secret, job->asked.move, release))
		cau_move_kept(&job->reply, release);
	else
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for the answer");
}

void cau_departure_cancel(cau_move_job *job)
{
	pthread_mutex_lock(&job->moves->mutex);
	departure *d = cau_departure_find_own(job->moves, &job->asked);
	if (d)
		cancel(job, d);
	else if (!is_of_this_daemon(job->moves, job->asked.session))
		cau_move_fail(&job->reply, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "the session id does not begin with this daemon's label");
	else if (!show(job))
		keep(job);
	pthread_mutex_unlock(&job->moves->mutex);
}
