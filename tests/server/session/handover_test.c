// SPDX-License-Identifier: GPL-3.0-or-later
// Searches every state of two daemons, their disks and two couriers while a session moves. Daemons
// and couriers may be killed at any time, messages may be lost, disks may refuse, and moves may
// begin again. In each state at most one daemon serves, and at least one store has the session.
// From each state, once both daemons are up, the courier's continuation leads to exactly one daemon
// that serves.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "session/handover.h"

enum { MOVES_MOST = 2, STATES_MOST = 1 << 20 };

typedef struct disk { // the target's disk
	uint8_t move;     // number of the move whose rows are on the disk; 0: none
	bool whole, accepted;
} disk;

typedef struct courier {
	uint8_t carried; // number of the courier's move
	bool saw_whole, has_proof, was_kept;
} courier;

typedef struct world {
	cau_leaving leaving;
	cau_coming coming;
	bool source_up, target_up;
	uint8_t begun;    // number of moves so far
	uint8_t move;     // number of the source's move; 0: none
	bool tombstone;   // the tombstone is on the source's disk
	bool may_surface; // the disk refused the tombstone, which may still appear after a crash
	bool writing, clearing, accepting; // these writes are on their way to a disk
	uint8_t coming_move;               // number of the target's move
	disk target;
	courier at_work, waiting; // two couriers that alternate
} world;

// ---- the search ---------------------------------------------------------------------------------
static world *queue;
static int *slots; // hash table of the states in `queue`
static int known;

static uint64_t hash_of(const world *w)
{
	uint64_t hash = 1469598103934665603u;
	const unsigned char *bytes = (const unsigned char *)w;
	for (size_t i = 0; i < sizeof *w; i++)
		hash = (hash ^ bytes[i]) * 1099511628211u;
	return hash;
}

static void add(const world *w)
{
	size_t slot = hash_of(w) % (2 * STATES_MOST);
	for (; slots[slot]; slot = (slot + 1) % (2 * STATES_MOST))
		if (memcmp(&queue[slots[slot] - 1], w, sizeof *w) == 0)
			return;
	assert_true(known < STATES_MOST);
	memcpy(&queue[known], w, sizeof *w);
	slots[slot] = ++known;
}

// ---- events -------------------------------------------------------------------------------------
static bool source_serves(const world *w)
{
	return w->source_up && cau_leaving_serves(&w->leaving);
}

static bool target_serves(const world *w)
{
	return w->target_up && cau_coming_serves(&w->coming);
}

static void check(const world *w)
{
	assert_false(source_serves(w) && target_serves(w));
	bool there = w->target.move && w->target.whole;
	assert_true(!w->tombstone || (there && w->target.move == w->move)); // the session is not lost
	assert_true(!w->target.accepted || w->tombstone); // the session is not served twice
	assert_true(!w->may_surface || !cau_leaving_serves(&w->leaving) || !w->source_up);
}

// Carries out the source's act. If `heard`, the courier receives the answer.
static void heed(world *w, cau_leaving_act act, bool heard)
{
	switch (act) {
	case CAU_LEAVING_DO_WRITE:
		w->writing = true;
		break;
	case CAU_LEAVING_DO_CLEAR:
		w->clearing = true;
		break;
	case CAU_LEAVING_DO_GO_ON:
		w->move = 0;
		break;
	default:
		break;
	}
	if (!heard)
		return;
	if (act == CAU_LEAVING_SHOW)
		w->at_work.has_proof = true;
	if (act == CAU_LEAVING_SAY_KEPT || act == CAU_LEAVING_DO_GO_ON)
		w->at_work.was_kept = true;
}

static cau_leaving_act tell_source(world *w, cau_leaving_event event, bool heard)
{
	bool own = event == CAU_LEAVING_BEGIN || (w->at_work.carried && w->at_work.carried == w->move);
	cau_leaving_act act = cau_leaving_take(&w->leaving, event, own);
	heed(w, act, heard);
	return act;
}

static void own_event(world *w, cau_leaving_event event)
{
	heed(w, cau_leaving_take(&w->leaving, event, true), false);
}

static void begin(world w)
{
	if (w.begun == MOVES_MOST ||
	    cau_leaving_take(&w.leaving, CAU_LEAVING_BEGIN, true) != CAU_LEAVING_DO_BEGIN)
		return;
	w.move = w.at_work.carried = ++w.begun;
	w.at_work.saw_whole = w.at_work.has_proof = w.at_work.was_kept = false;
	add(&w);
}

static void deliver(world w, bool last, bool heard)
{
	cau_leaving_state from = last ? CAU_LEAVING_HELD : CAU_LEAVING_SENDS;
	bool own = !w.coming_move || w.coming_move == w.at_work.carried;
	if (!w.at_work.carried || w.at_work.carried != w.move || w.leaving.state != from ||
	    !w.target_up)
		return;
	if (last && !w.coming_move)
		return;
	cau_coming_event event = last ? CAU_COMING_LAST : CAU_COMING_PIECE;
	if (cau_coming_take(&w.coming, event, own) == CAU_COMING_REFUSE)
		return;
	w.coming_move = w.at_work.carried;
	w.target = (disk){.move = w.at_work.carried, .whole = last};
	w.at_work.saw_whole |= last && heard;
	add(&w);
}

static void disk_writes(world w, bool heard)
{
	if (w.writing) {
		w.writing = w.may_surface = false;
		w.tombstone = true;
		cau_leaving_act act = cau_leaving_take(&w.leaving, CAU_LEAVING_WRITTEN, true);
		assert_int_equal(act, CAU_LEAVING_DO_END);
		w.at_work.has_proof |= heard && w.at_work.carried == w.move;
	} else {
		w.clearing = w.may_surface = false;
		own_event(&w, CAU_LEAVING_WRITTEN);
	}
	add(&w);
}

static void disk_refuses(world w)
{
	w.may_surface |= w.writing;
	w.writing = w.clearing = false;
	own_event(&w, CAU_LEAVING_REFUSED);
	add(&w);
}

static void disk_takes_nothing(world w)
{
	w.writing = w.clearing = false;
	own_event(&w, CAU_LEAVING_UNSENT);
	add(&w);
}

static void accept(world w)
{
	bool own = w.coming_move == w.at_work.carried;
	if (!w.at_work.has_proof || !w.target_up || w.accepting)
		return;
	if (cau_coming_take(&w.coming, CAU_COMING_PROOF, own) == CAU_COMING_DO_WRITE)
		w.accepting = true;
	add(&w);
}

static void accepted(world w, bool written)
{
	w.accepting = false;
	w.target.accepted |= written;
	cau_coming_take(&w.coming, written ? CAU_COMING_WRITTEN : CAU_COMING_REFUSED, true);
	add(&w);
}

static void forget(world w)
{
	if (!w.at_work.was_kept || !w.target_up || w.accepting)
		return;
	if (cau_coming_take(&w.coming, CAU_COMING_FORGET, w.coming_move == w.at_work.carried) ==
	    CAU_COMING_DO_FORGET) {
		w.target = (disk){0};
		w.coming_move = 0;
	}
	add(&w);
}

static void crash_source(world w, bool surfaces)
{
	if (surfaces && !w.writing && !w.may_surface)
		return;
	w.tombstone |= surfaces;
	w.writing = w.clearing = w.may_surface = false;
	w.move = w.tombstone ? w.move : 0;
	w.leaving = cau_leaving_after_restart(w.tombstone);
	w.source_up = false;
	add(&w);
}

static void crash_target(world w, bool written)
{
	if (written && !w.accepting)
		return;
	w.target.accepted |= written;
	w.accepting = false;
	w.coming = cau_coming_after_restart(w.target.move != 0, w.target.whole, w.target.accepted);
	w.target_up = false;
	add(&w);
}

// Replaces the courier by a new courier, or by the same courier after a restart. The courier then
// knows only what the target lists.
static void new_courier(world w)
{
	w.at_work.carried = w.target_up ? w.coming_move : 0;
	w.at_work.saw_whole = w.target_up && w.coming.state == CAU_COMING_WHOLE;
	w.at_work.has_proof = w.at_work.was_kept = false;
	add(&w);
}

static void take_turns(world w)
{
	courier other = w.waiting;
	w.waiting = w.at_work;
	w.at_work = other;
	add(&w);
}

static void ask_source(world w, cau_leaving_event event, bool heard)
{
	if (event == CAU_LEAVING_COMMIT && !w.at_work.saw_whole)
		return;
	if (!w.at_work.carried)
		return;
	tell_source(&w, event, heard);
	add(&w);
}

static void expand(world w)
{
	world up = w;
	up.source_up = up.target_up = true;
	add(&up);
	new_courier(w);
	take_turns(w);
	crash_target(w, false);
	crash_target(w, true);
	crash_source(w, false);
	crash_source(w, true);
	accept(w);
	forget(w);
	if (w.accepting) {
		accepted(w, true);
		accepted(w, false);
	}
	if (!w.source_up)
		return;
	begin(w);
	for (int heard = 0; heard < 2; heard++) {
		deliver(w, false, heard);
		deliver(w, true, heard);
		ask_source(w, CAU_LEAVING_COMMIT, heard);
		ask_source(w, CAU_LEAVING_CANCEL, heard);
		if (w.writing || w.clearing)
			disk_writes(w, heard);
	}
	ask_source(w, CAU_LEAVING_HOLD, false);
	if (w.writing || w.clearing) {
		disk_refuses(w);
		disk_takes_nothing(w);
	}
	if (w.leaving.state == CAU_LEAVING_STOPS) {
		world stopped = w;
		own_event(&stopped, CAU_LEAVING_STOPPED);
		add(&stopped);
		own_event(&w, CAU_LEAVING_NOT_STOPPED);
		add(&w);
	} else if (w.move) {
		own_event(&w, CAU_LEAVING_LATE);
		add(&w);
	}
}

// ---- the end of a move --------------------------------------------------------------------------

// Completes all writes and suspensions: the disks accept everything.
static void settle(world *w)
{
	if (w->leaving.state == CAU_LEAVING_STOPS)
		own_event(w, CAU_LEAVING_STOPPED);
	for (int i = 0; i < 4 && (w->writing || w->clearing); i++) {
		bool tombstone = w->writing;
		w->tombstone |= tombstone;
		w->writing = w->clearing = w->may_surface = false;
		own_event(w, CAU_LEAVING_WRITTEN);
	}
	if (w->accepting) {
		w->accepting = false;
		w->target.accepted = true;
		cau_coming_take(&w->coming, CAU_COMING_WRITTEN, true);
	}
}

// Does what `cautery move` does for an unfinished move, with both daemons up. It asks the target
// which session is in doubt, asks the source about the move, and takes the source's answer to the
// target. If no session is in doubt, a timeout ends the move.
static void resume(world w)
{
	w.source_up = w.target_up = true;
	settle(&w);
	w.at_work.carried = w.coming_move;
	w.at_work.has_proof = w.at_work.was_kept = false;
	for (int i = 0; i < 3 && w.at_work.carried && !w.at_work.has_proof && !w.at_work.was_kept;
	     i++) {
		tell_source(&w, CAU_LEAVING_CANCEL, true);
		settle(&w);
	}
	if (w.at_work.has_proof &&
	    cau_coming_take(&w.coming, CAU_COMING_PROOF, true) == CAU_COMING_DO_WRITE)
		w.accepting = true;
	if (w.at_work.was_kept &&
	    cau_coming_take(&w.coming, CAU_COMING_FORGET, true) == CAU_COMING_DO_FORGET)
		w.target = (disk){0};
	settle(&w);
	if (w.leaving.state == CAU_LEAVING_HELD || w.leaving.state == CAU_LEAVING_DOUBTS) {
		own_event(&w, CAU_LEAVING_LATE);
		settle(&w);
	}
	assert_true(source_serves(&w) != target_serves(&w));
}

static void test_at_most_one_serves_and_one_in_the_end(void **state)
{
	(void)state;
	int moved = 0, stayed = 0;
	world first;
	memset(&first, 0, sizeof first);
	first.source_up = first.target_up = true;
	queue = calloc(STATES_MOST, sizeof *queue);
	slots = calloc(2 * STATES_MOST, sizeof *slots);
	assert_true(queue && slots);
	add(&first);
	for (int i = 0; i < known; i++) {
		check(&queue[i]);
		resume(queue[i]);
		moved += target_serves(&queue[i]);
		stayed += source_serves(&queue[i]);
		expand(queue[i]);
	}
	print_message("%d states, in %d of them the target serves, in %d the source\n", known, moved,
	              stayed);
	assert_true(known > 500 && moved > 0 && stayed > 0);
	free(queue);
	free(slots);
}

// Events that no honest courier causes.
static void test_a_proof_without_the_rows_serves_nothing(void **state)
{
	(void)state;
	cau_coming coming = {0};
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_PROOF, true), CAU_COMING_REFUSE);
	cau_coming_take(&coming, CAU_COMING_PIECE, true);
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_PROOF, true), CAU_COMING_REFUSE);
	cau_coming_take(&coming, CAU_COMING_LAST, true);
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_PROOF, false), CAU_COMING_REFUSE);
	assert_false(cau_coming_serves(&coming));
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_PROOF, true), CAU_COMING_DO_WRITE);
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_FORGET, true), CAU_COMING_REFUSE);
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_WRITTEN, true), CAU_COMING_DO_SERVE);
	assert_int_equal(cau_coming_take(&coming, CAU_COMING_PROOF, true), CAU_COMING_SAY_HERE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_proof_without_the_rows_serves_nothing),
		cmocka_unit_test(test_at_most_one_serves_and_one_in_the_end)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
