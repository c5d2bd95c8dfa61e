// SPDX-License-Identifier: GPL-3.0-or-later
// Creates and ends the moves of a daemon, and serves couriers. Each request is a short job of the
// mover, because most requests read the store.
#include "move/move.h"

#include <stdlib.h>
#include <string.h>

#include "move/internal.h"

// estimated time to read or write a piece, s, by which the builder sorts its jobs
#define EXPECTED_S 0.05

// ---- creation and end
static bool has_moved(void *user, const char *id, cau_moved_to *to)
{
	return cau_tombstones_have(user, id, to);
}

static bool arrives(void *user, const char *id)
{
	return cau_arrivals_have(user, id);
}

cau_status cau_moves_create(cau_moves **made, const cau_moves_def *def, cau_error *error)
{
	cau_moves *moves = *made = calloc(1, sizeof *moves);
	if (!moves)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for moves");
	moves->def = *def;
	pthread_mutex_init(&moves->mutex, NULL);
	cau_hub_set_elsewhere(def->hub, &(cau_elsewhere){moves, has_moved, arrives});
	return CAU_OK;
}

cau_status cau_moves_resume(cau_moves *moves, cau_error *error)
{
	cau_status status = cau_tombstones_read(moves, error);
	return status ? status : cau_arrivals_read(moves, error);
}

void cau_moves_reap(cau_moves *moves)
{
	cau_departures_let_go(moves, cau_monotonic_s(), false);
	cau_arrivals_reap(moves, false);
}

void cau_moves_drain(cau_moves *moves)
{
	if (moves)
		cau_departures_let_go(moves, 0, true);
}

void cau_moves_stop(cau_moves *moves)
{
	if (!moves)
		return;
	cau_departures_let_go(moves, 0, true);
	cau_arrivals_reap(moves, true);
}

void cau_moves_destroy(cau_moves *moves)
{
	if (!moves)
		return;
	pthread_mutex_destroy(&moves->mutex);
	cau_departures_free(moves);
	cau_arrivals_free(moves);
	free(moves->tombstones);
	free(moves);
}

// ---- requests
static void list_moves(cau_move_job *job)
{
	enum { MOST = 1024 };
	cau_moves *moves = job->moves;
	cau_wire_move_list result = {.moves = {calloc(MOST, sizeof(cau_wire_move_entry)), 0, MOST}};
	if (!result.moves.items) {
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for the list");
		return;
	}
	pthread_mutex_lock(&moves->mutex);
	cau_departures_list(moves, &result.moves);
	cau_arrivals_list(moves, &result.moves);
	cau_tombstones_list(moves, &result.moves);
	pthread_mutex_unlock(&moves->mutex);
	cau_move_answer(&job->reply, &result);
	free(result.moves.items);
}

static void (*const serves[])(cau_move_job *job) = {
	[CAU_MOVE_BEGIN] = cau_departure_begin,   [CAU_MOVE_READ] = cau_departure_read,
	[CAU_MOVE_HOLD] = cau_departure_hold,     [CAU_MOVE_COMMIT] = cau_departure_commit,
	[CAU_MOVE_CANCEL] = cau_departure_cancel, [CAU_MOVE_RECEIVE] = cau_arrival_receive,
	[CAU_MOVE_READY] = cau_arrival_ready,     [CAU_MOVE_ACCEPT] = cau_arrival_accept,
	[CAU_MOVE_FORGET] = cau_arrival_forget,   [CAU_MOVE_LIST] = list_moves};

static void finish(cau_move_job *what)
{
	free(what->asked.piece);
	free(what);
}

static void drop(cau_job *job)
{
	cau_move_job *what = (cau_move_job *)job;
	cau_move_fail(&what->reply, CAU_BAD_STATE, CAU_RPC_DRAINING, "", "the server is shutting down");
	finish(what);
}

static void run(cau_job *job)
{
	cau_move_job *what = (cau_move_job *)job;
	pthread_mutex_lock(&what->moves->mutex);
	bool ends = what->moves->ends;
	pthread_mutex_unlock(&what->moves->mutex);
	if (ends) {
		drop(job);
		return;
	}
	cau_fault_point("move_asked");
	serves[what->asked.what](what);
	finish(what);
}

cau_status cau_moves_ask(cau_moves *moves, const cau_move_asked *asked, const cau_reply *reply,
                         cau_error *error)
{
	cau_move_job *what = malloc(sizeof *what);
	if (!what) {
		free(asked->piece);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the request");
	}
	*what = (cau_move_job){.job = {.run = run, .drop = drop, .expected_s = EXPECTED_S},
	                       .moves = moves,
	                       .asked = *asked,
	                       .reply = *reply};
	cau_builder_submit(moves->def.mover, &what->job);
	return CAU_OK;
}
