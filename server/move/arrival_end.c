// SPDX-License-Identifier: GPL-3.0-or-later
// The end of an arrival. The core is built in advance. The session is served once the proof shows
// that no other daemon serves it. Otherwise the arrival is forgotten.
#include <stdlib.h>
#include <string.h>

#include "cautery/name.h"
#include "move/internal.h"

typedef cau_arrival arrival;
typedef cau_arrival_hand hand;

// ---- ready --------------------------------------------------------------------------------------

typedef struct making {
	cau_moves *moves;
	arrival *arrival; // stays in the list while it has a core
	cau_reply reply;
} making;

static void built(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	making *made = user;
	cau_rpc_message answer;
	cau_rpc_fault fault;
	(void)reply;
	pthread_mutex_lock(&made->moves->mutex);
	if (!outcome->error &&
	    !cau_rpc_read(outcome->text, outcome->text_bytes, outcome->text_bytes, &answer, &fault)) {
		made->arrival->ready =
			!cau_rpc_result(&answer, CAU_METHOD_MOVE_READY, &made->arrival->stands, NULL);
		cau_rpc_finish(&answer);
	}
	pthread_mutex_unlock(&made->moves->mutex);
	cau_reply_answer(&made->reply, outcome);
	free(made);
}

// Begins to build the session in advance. Called with the lock of cau_moves.
static cau_status build(cau_move_job *job, arrival *a, cau_creation *creation, cau_error *error)
{
	cau_moves *moves = job->moves;
	making *made = malloc(sizeof *made);
	if (!made)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a session");
	*made = (making){moves, a, job->reply};
	cau_reply reply = {.answer = built, .user = made, .method = CAU_METHOD_MOVE_READY};
	cau_status status =
		cau_hub_make_incoming(moves->def.hub, creation, a->id, &reply, &a->hosted, error);
	if (status)
		free(made);
	return status;
}

// Returns the arrival to build, marked as `writing`. Returns NULL if it cannot be built (*status),
// or if it was built before; in the second case the request is answered.
static arrival *begin_build(cau_move_job *job, cau_status *status, cau_error *error)
{
	pthread_mutex_lock(&job->moves->mutex);
	arrival *a = cau_arrival_find_own(job->moves, &job->asked);
	cau_coming_state state = a ? a->coming.state : CAU_COMING_NOT;
	bool waits = state == CAU_COMING_INCOMING || state == CAU_COMING_WHOLE;
	if (!waits || a->writing)
		*status = cau_fail(error, CAU_BAD_STATE, "params.move",
		                   "no such move waits here, or a piece of this move is being written");
	else if (a->hosted && !a->ready)
		*status = cau_fail(error, CAU_BAD_STATE, "", "the session is being built");
	else if (a->hosted)
		cau_move_answer(&job->reply, &a->stands);
	bool begins = waits && !*status && !a->hosted;
	if (begins)
		a->writing = true;
	pthread_mutex_unlock(&job->moves->mutex);
	return begins ? a : NULL;
}

void cau_arrival_ready(cau_move_job *job)
{
	cau_error error = {0};
	int32_t code = 0;
	cau_status status = CAU_OK;
	cau_creation *creation = NULL;
	arrival *a = begin_build(job, &status, &error);
	if (a)
		status = cau_hub_read_session(job->moves->def.hub, a->id, &creation, &error);
	cau_fault_point("move_building");
	if (a) {
		pthread_mutex_lock(&job->moves->mutex);
		if (!status) // a stopped builder would answer at once, under the lock
			status = cau_arrivals_check_open(job->moves, &code, &error);
		if (!status)
			status = build(job, a, creation, &error);
		a->writing = false;
		pthread_mutex_unlock(&job->moves->mutex);
	}
	if (creation)
		cau_creation_free(creation);
	if (status)
		cau_reply_fail(&job->reply, &error, code);
}

// ---- accept -------------------------------------------------------------------------------------

// most waiting couriers of one move: usually one, and perhaps its successor
enum { AGAIN_MOST = 8 };

struct cau_accepting {
	cau_job job; // must be the first member; runs on the mover once the acceptance is on the disk
	cau_moves *moves;
	arrival *arrival; // this acceptance owns the arrival
	cau_reply reply;
	cau_reply again[AGAIN_MOST]; // replies to repetitions of the request; under the lock
	int32_t again_count;
};

typedef cau_accepting accepting;

// Called with the lock. The repeated request is answered once the first one has been carried out.
static cau_status wait_too(accepting *what, const cau_reply *reply, cau_error *error)
{
	if (what->again_count == AGAIN_MOST)
		return cau_fail(error, CAU_LIMIT, "", "the session is being accepted: ask again");
	what->again[what->again_count++] = *reply;
	return CAU_OK;
}

// Answers that the session was accepted before, with its present description.
static void describe(cau_moves *moves, const char *id, const cau_reply *reply)
{
	cau_error error = {0};
	cau_hosted *hosted = cau_hub_find(moves->def.hub, id);
	cau_order *order = hosted ? calloc(1, sizeof *order) : NULL;
	cau_status status = CAU_NOT_FOUND;
	if (order) {
		order->kind = CAU_ORDER_DESCRIBE;
		order->reply = *reply;
		status = cau_hosted_submit(hosted, order, &error);
	}
	if (status) {
		free(order);
		cau_move_fail(reply, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "the session was accepted before, and this daemon does not serve it: it was "
		              "destroyed, has moved on, or could not be brought up");
	}
	cau_hosted_release(hosted);
}

// Ends the acceptance, so that the arrival has no owner. Answers with the failure, if there is one.
// Otherwise the session itself answers `reply`.
static void end_accepting(accepting *what, const cau_error *failure, int32_t code)
{
	char id[CAU_NAME_BYTES];
	pthread_mutex_lock(&what->moves->mutex);
	memcpy(id, what->arrival->id, sizeof id);
	what->arrival->accepting = NULL; // from here on no repeated request waits
	pthread_mutex_unlock(&what->moves->mutex);
	if (failure)
		cau_reply_fail(&what->reply, failure, code);
	for (int32_t i = 0; i < what->again_count; i++) {
		if (failure)
			cau_reply_fail(&what->again[i], failure, code);
		else
			describe(what->moves, id, &what->again[i]);
	}
	free(what);
}

static void submit_plain(cau_hosted *hosted, cau_order *order)
{
	cau_error error = {0};
	if (order && cau_hosted_submit(hosted, order, &error)) {
		cau_log(CAU_LOG_WARNING, cau_hosted_id(hosted), "hand_lost", "reason=\"%s\"", error.reason);
		free(order);
	}
}

// Gives each tool its former driver, with energy off. The driver may return for as long as after a
// lost connection.
static void give_hands(cau_moves *moves, const arrival *a, cau_hosted *hosted)
{
	for (int32_t i = 0; i < a->hand_count; i++) {
		cau_order *order = calloc(1, sizeof *order);
		uint32_t number = order ? cau_hub_expect(moves->def.hub, &a->hands[i].client) : 0;
		if (!number) {
			free(order);
			continue;
		}
		order->kind = CAU_ORDER_TAKE_OVER;
		order->reply.method = CAU_METHOD_TOOL_TAKE_OVER;
		order->asker = a->hands[i].client.asker;
		order->asker.client = number;
		memcpy(order->as.tool.tool, a->hands[i].tool, sizeof order->as.tool.tool);
		submit_plain(hosted, order);
	}
	cau_order *pace = a->speed != 1 ? calloc(1, sizeof *pace) : NULL;
	if (pace) {
		pace->kind = CAU_ORDER_SPEED;
		pace->reply.method = CAU_METHOD_SESSION_SPEED;
		pace->as.speed = a->speed;
		submit_plain(hosted, pace);
	}
}

// Adds the core that was built in advance to the hub's sessions, and returns it with a reference.
// Returns NULL if there is no such core, or no free slot. Without a slot the core is ended, and
// freed later.
static cau_hosted *place_built(cau_moves *moves, arrival *a)
{
	pthread_mutex_lock(&moves->mutex);
	bool takes = a->hosted && a->ready && !cau_hosted_ended(a->hosted);
	cau_hosted *hosted = takes ? cau_hosted_share(a->hosted) : NULL;
	if (takes)
		a->hosted = NULL;
	pthread_mutex_unlock(&moves->mutex);
	if (!hosted || cau_hub_place(moves->def.hub, hosted))
		return hosted;
	pthread_mutex_lock(&moves->mutex);
	a->hosted = hosted;
	a->ready = false;
	pthread_mutex_unlock(&moves->mutex);
	cau_hosted_give_up(hosted);
	cau_hosted_release(hosted);
	return NULL;
}

static cau_status serve(accepting *what, cau_error *error)
{
	cau_moves *moves = what->moves;
	arrival *a = what->arrival;
	cau_creation *row = NULL;
	cau_status status = cau_hub_read_session(moves->def.hub, a->id, &row, error);
	if (status)
		return status;
	cau_hosted *hosted = place_built(moves, a);
	if (hosted) {
		give_hands(moves, a, hosted);
		cau_hosted_come(hosted, row->origin.branch, row->paused, &what->reply);
	} else {
		status = cau_hub_resume_one(moves->def.hub, a->id, &what->reply, error);
		hosted = status ? NULL : cau_hub_find(moves->def.hub, a->id);
		if (hosted)
			give_hands(moves, a, hosted);
	}
	cau_hosted_release(hosted);
	cau_creation_free(row);
	return status;
}

static void run(cau_job *job)
{
	accepting *what = (accepting *)job;
	cau_error error = {0};
	cau_fault_point("move_placing");
	cau_status status = serve(what, &error);
	if (status)
		cau_hosted_tell_not_resumed(what->arrival->id, status, &error);
	end_accepting(what, status ? &error : NULL, 0);
}

// Drops the job. The session is in the store, and starts with the next start of the daemon.
static void drop(cau_job *job)
{
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_STATE, "", "the server is shutting down");
	end_accepting((accepting *)job, &error, CAU_RPC_DRAINING);
}

// Called on the store's thread with the outcome of the commit of an acceptance.
static void accepted(void *user, cau_status status, const char *reason)
{
	accepting *what = user;
	cau_moves *moves = what->moves;
	cau_error error = {0};
	cau_fault_point("move_accepted");
	pthread_mutex_lock(&moves->mutex);
	cau_coming_take(&what->arrival->coming, status ? CAU_COMING_REFUSED : CAU_COMING_WRITTEN, true);
	if (!status)
		cau_tombstone_drop(moves, what->arrival->id);
	pthread_mutex_unlock(&moves->mutex);
	if (!status) {
		cau_log(CAU_LOG_NOTICE, what->arrival->id, "came", "move=%s from=%s", what->arrival->move,
		        what->arrival->source);
		cau_builder_submit(moves->def.mover, &what->job);
		return;
	}
	cau_fail(&error, status, "", "%s", reason);
	end_accepting(what, &error, cau_hosted_commit_code(status));
}

// Submits the acceptance to the store. Called with the lock of cau_moves.
static cau_status write_accepted(cau_move_job *job, arrival *a, cau_error *error)
{
	cau_store_arrival row = cau_arrival_row(a, a->pieces, CAU_STORE_ACCEPTED);
	cau_store_batch *batch = cau_store_batch_create();
	accepting *what = calloc(1, sizeof *what);
	cau_status status = batch && what
	                        ? cau_store_put_arrival(batch, &row, error)
	                        : cau_fail(error, CAU_NO_MEMORY, "", "no memory to accept the session");
	if (!status) {
		*what = (accepting){.job = {.run = run, .drop = drop},
		                    .moves = job->moves,
		                    .arrival = a,
		                    .reply = job->reply};
		status = cau_store_submit(job->moves->def.store, batch, accepted, what, error);
	}
	if (!status) {
		a->accepting = what;
		return CAU_OK;
	}
	cau_store_batch_destroy(batch);
	free(what);
	cau_coming_take(&a->coming, CAU_COMING_REFUSED, true);
	return status;
}

void cau_arrival_accept(cau_move_job *job)
{
	cau_error error = {0};
	cau_status status = CAU_OK;
	cau_coming_act act = CAU_COMING_NOTHING;
	pthread_mutex_lock(&job->moves->mutex);
	arrival *a = cau_arrival_find_own(job->moves, &job->asked);
	if (!a)
		status = cau_fail(&error, CAU_BAD_STATE, "params.move", "this daemon has no such move");
	else if (job->moves->ends)
		status = cau_fail(&error, CAU_BAD_STATE, "",
		                  "the daemon is shutting down: ask again when it is back");
	else if (!cau_move_opens(job->asked.key, a->lock))
		status =
			cau_fail(&error, CAU_BAD_VALUE, "params.proof", "the proof belongs to another move");
	else if (a->accepting)
		status = wait_too(a->accepting, &job->reply, &error);
	else if (a->writing || (a->hosted && !a->ready && !cau_hosted_ended(a->hosted)))
		status = cau_fail(&error, CAU_BAD_STATE, "", "the session is being built: ask again");
	else
		act = cau_coming_take(&a->coming, CAU_COMING_PROOF, true);
	if (act == CAU_COMING_REFUSE)
		status = cau_fail(&error, CAU_BAD_STATE, "", "not all pieces of the session have arrived");
	if (!status && act == CAU_COMING_DO_WRITE)
		status = write_accepted(job, a, &error);
	pthread_mutex_unlock(&job->moves->mutex);
	if (status)
		cau_reply_fail(&job->reply, &error, cau_hosted_commit_code(status));
	else if (act == CAU_COMING_SAY_HERE)
		describe(job->moves, job->asked.session, &job->reply);
}

// ---- forget -------------------------------------------------------------------------------------

// A removal of the arrival on its way to the disk.
typedef struct forgetting {
	cau_moves *moves;
	arrival *arrival;
	cau_reply reply;
	bool whole; // all pieces had arrived
} forgetting;

static void forgotten(void *user, cau_status status, const char *reason)
{
	forgetting *done = user;
	arrival *a = done->arrival;
	pthread_mutex_lock(&done->moves->mutex);
	a->writing = false;
	if (status)
		a->coming = cau_coming_after_restart(true, done->whole, false);
	else
		a->forgotten = true;
	if (!status && a->hosted && a->ready)
		cau_hosted_give_up(a->hosted);
	pthread_mutex_unlock(&done->moves->mutex);
	if (status)
		cau_move_fail(&done->reply, status, cau_hosted_commit_code(status), "", reason);
	else
		cau_move_answer(&done->reply, &(cau_wire_nothing){0});
	free(done);
}

// Submits the removal of the arrival to the store. Called with the lock of cau_moves.
static cau_status write_forgotten(cau_move_job *job, arrival *a, bool whole, cau_error *error)
{
	forgetting *travelling = malloc(sizeof *travelling);
	cau_store_batch *batch = cau_store_batch_create();
	cau_status status = batch && travelling
	                        ? cau_store_forget_arrival(batch, a->id, error)
	                        : cau_fail(error, CAU_NO_MEMORY, "", "no memory to forget the move");
	if (!status) {
		*travelling =
			(forgetting){.moves = job->moves, .arrival = a, .reply = job->reply, .whole = whole};
		status = cau_store_submit(job->moves->def.store, batch, forgotten, travelling, error);
	}
	if (!status) {
		a->writing = true;
		return CAU_OK;
	}
	cau_store_batch_destroy(batch);
	free(travelling);
	a->coming = cau_coming_after_restart(true, whole, false);
	return status;
}

// True if the arrival may be forgotten. A release proves that the source keeps the session.
// `source_lost` is an administrator's statement that the source is lost for good, which may be
// wrong.
static bool may_forget(const cau_move_job *job, const arrival *a)
{
	if (!job->asked.source_lost)
		return cau_move_opens(job->asked.key, a->unlock);
	cau_log(CAU_LOG_WARNING, a->id, "forgotten_unproved",
	        "move=%s from=%s whole=%d risk=\"if %s has decided this move, the session is lost\"",
	        a->move, a->source, a->coming.state == CAU_COMING_WHOLE, a->label);
	return true;
}

// Checks whether the arrival can and may be forgotten now. Called with the lock of cau_moves.
static cau_status check_forget(const cau_move_job *job, const arrival *a, int32_t *code,
                               cau_error *error)
{
	cau_status status = cau_arrivals_check_open(job->moves, code, error);
	if (status)
		return status;
	if (a && (a->writing || (a->hosted && !a->ready && !cau_hosted_ended(a->hosted))))
		return cau_fail(error, CAU_BAD_STATE, "", "the session is being built: ask again");
	if (a && !may_forget(job, a))
		return cau_fail(error, CAU_BAD_VALUE, "params.release",
		                "not the release that move.cancel of the other daemon returned for this "
		                "move");
	return CAU_OK;
}

void cau_arrival_forget(cau_move_job *job)
{
	cau_error error = {0};
	int32_t code = 0;
	pthread_mutex_lock(&job->moves->mutex);
	arrival *a = cau_arrival_find_own(job->moves, &job->asked);
	bool whole = a && a->coming.state == CAU_COMING_WHOLE;
	cau_status status = check_forget(job, a, &code, &error);
	if (!status &&
	    (!a || cau_coming_take(&a->coming, CAU_COMING_FORGET, true) != CAU_COMING_DO_FORGET))
		status = cau_fail(&error, CAU_BAD_STATE, "params.move",
		                  "this daemon has no such move, or has accepted the session already");
	else if (!status)
		status = write_forgotten(job, a, whole, &error);
	pthread_mutex_unlock(&job->moves->mutex);
	if (status)
		cau_reply_fail(&job->reply, &error, code ? code : cau_hosted_commit_code(status));
}
