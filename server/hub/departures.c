// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that leave for another daemon: what is there goes out in pieces while they are served,
// then they stand still, the rest goes out, and a row in the store says that they are elsewhere.
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "cautery/sha256.h"
#include "hub/fault_point.h"
#include "hub/internal.h"
#include "session/handover.h"
#include "store/dump.h"

#define HELD_MOST_S 30.  // a session that stands still for longer goes on
#define SENDS_MOST_S 60. // a courier that asks for nothing for so long has gone

enum {
	PIECE_BYTES = 4 << 20, // and at most a row more: one commit of the other daemon's store
	TOMBSTONES_MOST = 100000,
};

struct cau_departure {
	struct cau_departure *next;
	cau_leaving leaving;
	cau_hosted *hosted; // shared
	char id[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_tombstone becomes;
	char lock[CAU_SHA256_TEXT_BYTES];
	cau_store_dump *dump;
	uint32_t pieces;
	bool part_sent, rest_begun, all_sent;
	bool reading; // a job of the mover has the dump
	bool over;    // not in the list any more: whoever has the dump frees it
	double touched_s, held_s;
	cau_reply waiting; // for the disk
};
typedef struct cau_departure departure;

static void destroy(departure *d)
{
	cau_store_dump_close(d->dump);
	cau_hosted_release(d->hosted);
	free(d);
}

// With the lock.
static departure *find(cau_hub *hub, const char *id)
{
	departure *d = hub->departures;
	while (d && strcmp(d->id, id) != 0)
		d = d->next;
	return d;
}

static departure *find_own(cau_hub *hub, const cau_move_asked *asked)
{
	departure *d = find(hub, asked->session);
	return d && strcmp(d->becomes.move, asked->move) == 0 ? d : NULL;
}

static void take_out(cau_hub *hub, departure *d)
{
	departure **link = &hub->departures;
	while (*link != d)
		link = &(*link)->next;
	*link = d->next;
	d->over = true;
	if (!d->reading)
		destroy(d);
}

static void fail_unknown(const cau_reply *reply)
{
	cau_move_fail(reply, CAU_BAD_STATE, 0, "params.move",
	              "no such move is under way here: begin anew");
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

static cau_status fill(departure *d, const cau_move_asked *asked, cau_error *error)
{
	size_t label_bytes = strlen(asked->label);
	if (strncmp(asked->to.session, asked->label, label_bytes) != 0 ||
	    asked->to.session[label_bytes] != '-')
		return cau_fail(error, CAU_BAD_VALUE, "params.target", "it does not begin with `%s-`",
		                asked->label);
	if (strcmp(asked->to.session, asked->session) == 0)
		return cau_fail(error, CAU_BAD_VALUE, "params.target", "it is there already");
	memcpy(d->id, asked->session, sizeof d->id);
	memcpy(d->label, asked->label, sizeof d->label);
	memcpy(d->becomes.id, asked->session, sizeof d->becomes.id);
	d->becomes.to = asked->to;
	d->becomes.move[0] = 'm'; // a name begins with a letter
	if (!make_hex(d->becomes.move + 1, 16) || !make_hex(d->becomes.proof, 32) ||
	    !cau_sha256(d->becomes.proof, strlen(d->becomes.proof), d->lock))
		return cau_fail(error, CAU_UNSUPPORTED, "", "the system has no random bytes");
	return CAU_OK;
}

// A session that may leave, shared; NULL after a failure that is answered.
static cau_hosted *find_hosted(cau_move_job *job)
{
	cau_moved_to to;
	cau_hosted *hosted = cau_hub_find(job->hub, job->asked.session);
	if (hosted && !cau_hosted_starting(hosted))
		return hosted;
	if (hosted)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "params.session", "it is being built");
	else if (cau_hub_moved(job->hub, job->asked.session, &to))
		cau_reply_moved(&job->reply, &to);
	else
		cau_move_fail(&job->reply, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "this daemon does not have it");
	cau_hosted_release(hosted);
	return NULL;
}

static cau_status enlist(cau_hub *hub, departure *d, cau_error *error)
{
	cau_status status = CAU_OK;
	pthread_mutex_lock(&hub->moves_mutex);
	if (find(hub, d->id))
		status = cau_fail(error, CAU_BAD_STATE, "params.session",
		                  "it is being moved already: `cautery move --cancel` ends that");
	else if (hub->tombstone_count >= TOMBSTONES_MOST)
		status = cau_fail(error, CAU_LIMIT, "", "%d sessions have moved away from this daemon",
		                  TOMBSTONES_MOST);
	else {
		cau_leaving_take(&d->leaving, CAU_LEAVING_BEGIN, true);
		d->touched_s = cau_monotonic_s();
		d->next = hub->departures;
		hub->departures = d;
	}
	pthread_mutex_unlock(&hub->moves_mutex);
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
	cau_status status = fill(d, &job->asked, &error);
	if (!status)
		status = cau_store_dump_open(job->hub->def.store, d->id, &d->dump, &error);
	memcpy(result.move, d->becomes.move, sizeof result.move);
	if (!status)
		status = enlist(job->hub, d, &error);
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

// Who holds which tool comes with the rest: it is known to memory alone, as after a lost
// connection.
static void write_hands(cau_hub *hub, departure *d, cau_rows_writer *writer)
{
	cau_drive drives[CAU_MAX_TOOLS];
	double speed;
	int32_t count = cau_hosted_hands(d->hosted, drives, &speed);
	cau_rows_put_values(writer, CAU_ROWS_PACE, (int64_t)(speed * 1e6 + 0.5));
	for (int32_t i = 0; i < count; i++) {
		char token[CAU_RESUME_BYTES];
		const cau_asker *driver = &drives[i].driver;
		if (driver->client && cau_hub_resume_token(hub, driver->client, token))
			cau_rows_put_values(writer, CAU_ROWS_DRIVERS, drives[i].tool, token, driver->client_id,
			                    driver->name, (int64_t)driver->role,
			                    (int64_t)(driver->deadline_s * 1e6));
	}
}

static cau_status write_part(cau_hub *hub, departure *d, bool held, cau_rows_writer *writer,
                             cau_error *error)
{
	bool over = false;
	cau_status status = CAU_OK;
	if (d->part_sent && !d->rest_begun) {
		d->rest_begun = true;
		write_hands(hub, d, writer);
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

static cau_status write_piece(cau_hub *hub, departure *d, bool held, cau_rows_writer *writer,
                              cau_error *error)
{
	cau_rows_begin(writer, d->pieces);
	if (d->pieces == 0)
		cau_rows_put_values(writer, CAU_ROWS_HEADER, d->becomes.move, d->lock, d->id,
		                    hub->def.config->label, cau_hosted_scene(d->hosted)->name);
	d->pieces++;
	cau_status status = write_part(hub, d, held, writer, error);
	if (!status && writer->failed)
		status = cau_fail(error, CAU_NO_MEMORY, "", "no memory for a piece of the session");
	return status;
}

// The departure, which is then this job's to read; NULL after a failure that is answered.
static departure *begin_reading(cau_move_job *job, bool *held)
{
	const char *why = NULL;
	pthread_mutex_lock(&job->hub->moves_mutex);
	departure *d = find_own(job->hub, &job->asked);
	*held = d && d->leaving.state == CAU_LEAVING_HELD;
	if (d && d->reading)
		why = "another piece is being read";
	else if (d && d->all_sent)
		why = "all of it has been read";
	else if (d && d->part_sent && !*held)
		why = "the rest is read when it stands still";
	if (d && !why) {
		d->reading = true;
		d->touched_s = cau_monotonic_s();
	}
	pthread_mutex_unlock(&job->hub->moves_mutex);
	if (!d)
		fail_unknown(&job->reply);
	else if (why)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", why);
	return why ? NULL : d;
}

static void end_reading(cau_hub *hub, departure *d)
{
	pthread_mutex_lock(&hub->moves_mutex);
	d->reading = false;
	if (d->over)
		destroy(d);
	pthread_mutex_unlock(&hub->moves_mutex);
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
	cau_status status = write_piece(job->hub, d, held, &writer, &error);
	end_reading(job->hub, d);
	if (status)
		cau_reply_fail(&job->reply, &error, 0);
	else
		cau_hosted_answer_file(&job->reply, name, "application/octet-stream", writer.bytes,
		                       writer.byte_count);
	free(writer.bytes);
}

// ---- going on -----------------------------------------------------------------------------------

static void clear(cau_hub *hub, departure *d);

// Does what a machine answered to a cancel or to time. With the lock; may take the departure out.
static void let_go(cau_hub *hub, departure *d, cau_leaving_state from, cau_leaving_act act)
{
	if (act == CAU_LEAVING_DO_CLEAR) {
		clear(hub, d);
		return;
	}
	if (act != CAU_LEAVING_DO_GO_ON)
		return;
	cau_log(CAU_LOG_NOTICE, d->id, "move_ended", "move=%s reason=\"it stays here\"",
	        d->becomes.move);
	if (from != CAU_LEAVING_SENDS)
		cau_hosted_go_on(d->hosted);
	cau_move_decided(&d->waiting, NULL);
	take_out(hub, d);
}

typedef struct at_disk {
	cau_hub *hub;
	departure *departure;
} at_disk;

// The disk has said what became of the tombstone, or of what clears it. On the store's thread.
static void cleared(void *user, cau_status status, const char *reason)
{
	at_disk *done = user;
	cau_hub *hub = done->hub;
	departure *d = done->departure;
	(void)reason;
	pthread_mutex_lock(&hub->moves_mutex);
	cau_leaving_act act =
		cau_leaving_take(&d->leaving, status ? CAU_LEAVING_REFUSED : CAU_LEAVING_WRITTEN, true);
	if (status) {
		cau_move_fail(&d->waiting, CAU_IO, CAU_RPC_STORE_FULL, "", "the store has no room");
		d->waiting = (cau_reply){0};
		d->held_s = cau_monotonic_s(); // asked again later
	} else {
		let_go(hub, d, CAU_LEAVING_CLEARING, act);
	}
	pthread_mutex_unlock(&hub->moves_mutex);
	free(done);
}

static cau_status submit(cau_hub *hub, departure *d, cau_store_batch *batch,
                         cau_store_callback callback, cau_error *error)
{
	at_disk *travelling = malloc(sizeof *travelling);
	if (!travelling)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a commit");
	*travelling = (at_disk){hub, d};
	cau_status status = cau_store_submit(hub->def.store, batch, callback, travelling, error);
	if (status)
		free(travelling);
	return status;
}

// Any commit that follows makes sure that one which the disk refused does not come to light.
static void clear(cau_hub *hub, departure *d)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_event event = {.kind = "move_ended", .text = d->id};
	cau_status status = batch ? cau_store_put_event(batch, &event, &error)
	                          : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a commit");
	if (!status)
		status = submit(hub, d, batch, cleared, &error);
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

void cau_departures_let_go(cau_hub *hub, double now_s, bool all)
{
	if (all) { // nothing is given to the disk any more, and what was is decided
		pthread_mutex_lock(&hub->moves_mutex);
		hub->moves_end = true;
		pthread_mutex_unlock(&hub->moves_mutex);
		cau_store_flush(hub->def.store);
	}
	pthread_mutex_lock(&hub->moves_mutex);
	for (departure *d = hub->departures, *next; d; d = next) {
		next = d->next;
		cau_leaving_state from = d->leaving.state;
		if (all || is_late(d, now_s))
			let_go(hub, d, from, cau_leaving_take(&d->leaving, CAU_LEAVING_LATE, true));
	}
	pthread_mutex_unlock(&hub->moves_mutex);
}

// ---- hold ---------------------------------------------------------------------------------------

// Whom to answer once the session stands still, or cannot.
typedef struct holding {
	cau_hub *hub;
	cau_move_asked asked;
	cau_reply reply;
} holding;

static void held(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	holding *asked = user;
	cau_hub *hub = asked->hub;
	(void)reply;
	cau_fault_point("move_stopped");
	pthread_mutex_lock(&hub->moves_mutex);
	departure *d = find_own(hub, &asked->asked);
	cau_leaving_act act = cau_leaving_take(
		&d->leaving, outcome->error ? CAU_LEAVING_NOT_STOPPED : CAU_LEAVING_STOPPED, true);
	d->held_s = cau_monotonic_s();
	if (outcome->error) // the session has gone on by itself
		take_out(hub, d);
	else
		let_go(hub, d, CAU_LEAVING_STOPS, act);
	pthread_mutex_unlock(&hub->moves_mutex);
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
		cau_departures_let_go(job->hub, cau_monotonic_s(), false);
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for the request");
		return;
	}
	*asked = (holding){.hub = job->hub, .asked = job->asked, .reply = job->reply};
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
	pthread_mutex_lock(&job->hub->moves_mutex);
	departure *d = find_own(job->hub, &job->asked);
	bool known = d != NULL;
	bool stops = known && d->part_sent && !d->reading &&
	             cau_leaving_take(&d->leaving, CAU_LEAVING_HOLD, true) == CAU_LEAVING_DO_STOP;
	cau_hosted *hosted = stops ? cau_hosted_share(d->hosted) : NULL;
	pthread_mutex_unlock(&job->hub->moves_mutex);
	if (!known)
		fail_unknown(&job->reply);
	else if (!stops)
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "",
		              "it stands still already, or what was there has not been read yet");
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

// With the lock.
static void go_away(cau_hub *hub, departure *d)
{
	if (!cau_tombstone_put(hub, &d->becomes))
		cau_log(CAU_LOG_ERROR, d->id, "moved_forgotten",
		        "to=%s reason=\"no memory; it is in the store, and known after a restart\"",
		        d->becomes.to.session);
	cau_hosted_go_away(d->hosted, &d->becomes.to);
	cau_move_decided(&d->waiting, &d->becomes);
	take_out(hub, d);
}

static void decided(void *user, cau_status status, const char *reason)
{
	at_disk *done = user;
	cau_hub *hub = done->hub;
	departure *d = done->departure;
	cau_leaving_event event = !status                ? CAU_LEAVING_WRITTEN
	                          : is_own_fault(status) ? CAU_LEAVING_UNSENT
	                                                 : CAU_LEAVING_REFUSED;
	cau_fault_point("move_decided");
	pthread_mutex_lock(&hub->moves_mutex);
	cau_leaving_act act = cau_leaving_take(&d->leaving, event, true);
	if (act == CAU_LEAVING_DO_END) {
		go_away(hub, d);
	} else {
		cau_move_fail(&d->waiting, status, cau_hosted_commit_code(status), "", reason);
		d->waiting = (cau_reply){0};
		let_go(hub, d, CAU_LEAVING_HELD, act);
	}
	pthread_mutex_unlock(&hub->moves_mutex);
	free(done);
}

// With the lock.
static void write_tombstone(cau_hub *hub, departure *d, const cau_reply *reply)
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
	cau_status status = batch ? cau_store_put_moved(batch, &moved, &error)
	                          : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a commit");
	d->waiting = *reply;
	if (!status)
		status = submit(hub, d, batch, decided, &error);
	if (!status)
		return;
	cau_store_batch_destroy(batch);
	cau_leaving_state from = d->leaving.state;
	cau_leaving_act act = cau_leaving_take(&d->leaving, CAU_LEAVING_UNSENT, true);
	cau_reply_fail(reply, &error, cau_hosted_commit_code(status));
	d->waiting = (cau_reply){0};
	let_go(hub, d, from, act);
}

// What the tombstone says, if it is of this move. With the lock.
static bool show(cau_move_job *job)
{
	const cau_tombstone *found = cau_tombstone_find(job->hub, job->asked.session);
	bool own = found && strcmp(found->move, job->asked.move) == 0;
	if (own)
		cau_move_decided(&job->reply, found);
	return own;
}

void cau_departure_commit(cau_move_job *job)
{
	pthread_mutex_lock(&job->hub->moves_mutex);
	departure *d = find_own(job->hub, &job->asked);
	if (!d) {
		if (!show(job))
			fail_unknown(&job->reply);
	} else if (job->hub->moves_end) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, CAU_RPC_DRAINING, "",
		              "the server is shutting down");
	} else if (!d->all_sent) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "not all of it has been read");
	} else if (cau_leaving_take(&d->leaving, CAU_LEAVING_COMMIT, true) == CAU_LEAVING_DO_WRITE) {
		write_tombstone(job->hub, d, &job->reply);
	} else {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "it is being decided: ask again");
	}
	pthread_mutex_unlock(&job->hub->moves_mutex);
}

// ---- cancel -------------------------------------------------------------------------------------

// Who asks another daemon than the one that the session came from must not hear that it stays
// there.
static bool is_of_this_daemon(const cau_hub *hub, const char *id)
{
	size_t bytes = strlen(hub->def.config->label);
	return strncmp(id, hub->def.config->label, bytes) == 0 && id[bytes] == '-';
}

static void cancel(cau_move_job *job, departure *d)
{
	cau_leaving_state from = d->leaving.state;
	cau_leaving_act act = cau_leaving_take(&d->leaving, CAU_LEAVING_CANCEL, true);
	if (act == CAU_LEAVING_NOTHING) {
		cau_move_fail(&job->reply, CAU_BAD_STATE, 0, "", "it is being decided: ask again");
		return;
	}
	d->waiting = job->reply;
	let_go(job->hub, d, from, act);
}

void cau_departure_cancel(cau_move_job *job)
{
	pthread_mutex_lock(&job->hub->moves_mutex);
	departure *d = find_own(job->hub, &job->asked);
	if (d)
		cancel(job, d);
	else if (!is_of_this_daemon(job->hub, job->asked.session))
		cau_move_fail(&job->reply, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "it is not of this daemon");
	else if (!show(job))
		cau_move_decided(&job->reply, NULL);
	pthread_mutex_unlock(&job->hub->moves_mutex);
}

// ---- all of them --------------------------------------------------------------------------------

void cau_departures_list(cau_hub *hub, cau_wire_list *list)
{
	cau_wire_move_entry *entries = list->items;
	for (const departure *d = hub->departures; d && list->count < list->capacity; d = d->next) {
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

void cau_departures_free(cau_hub *hub)
{
	for (departure *d = hub->departures, *next; d; d = next) {
		next = d->next;
		destroy(d);
	}
	hub->departures = NULL;
}
