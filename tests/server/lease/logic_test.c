// SPDX-License-Identifier: GPL-3.0-or-later
// The lease's logic in all orders of events. A model has etcd, stores and their copies, and answers
// that come late or never. The test runs every sequence up to a depth, and long random ones.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lease/logic.h"

// ---- generations as text
static void a_generation_has_one_text(void **state)
{
	(void)state;
	char text[CAU_GENERATION_BYTES];
	cau_generation read, wrote = {17, 0xc0ffee};
	cau_generation_write(wrote, text);
	assert_string_equal(text, "17:0000000000c0ffee");
	assert_true(cau_generation_read(text, strlen(text), &read));
	assert_true(cau_generation_same(read, wrote));
	assert_true(cau_generation_read("", 0, &read) && read.number == 0);
	static const char *const others[] = {"17",
	                                     "17:",
	                                     ":0000000000c0ffee",
	                                     "17:c0ffee",
	                                     " 17:0000000000c0ffee",
	                                     "017:0000000000c0ffee",
	                                     "-1:0000000000c0ffee",
	                                     "0:0000000000c0ffee",
	                                     "17:0000000000C0FFEE",
	                                     "17:0000000000c0ffee ",
	                                     "9999999999999999999:0000000000c0ffee"};
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (cau_generation_read(others[i], strlen(others[i]), &read) || read.number != 0)
			fail_msg("%s was read", others[i]);
}

// ---- renewals
// etcd's side of a lease, in true time. An answer may have a longer time to live than the daemon
// requested, as after a change of etcd's leader.
typedef struct server {
	double ends_s, ttl_s;
} server;

typedef struct outcome {
	// Parts of the time limit that the request (there) and the answer (back) take. If the sum is
	// above 1, the answer is too late.
	double there, back;
	bool arrives;
	bool unreadable;
} outcome;

static const outcome outcomes[] = {
	{0, 0, true, false},      {0.1, 0.8, true, false},
	{0.9, 0.05, true, false}, {0.2, 2.0, true, false}, // etcd renews, but the answer comes too late
	{0, 0, false, false},                              // the request is lost
	{0, 0, true, true},
};
enum { OUTCOMES = sizeof outcomes / sizeof *outcomes, RENEWALS_DEEP = 7 };

// Plays one renewal with this outcome. True time passes.
static void renew(cau_lease_logic *logic, server *etcd, const outcome *o, double limit_s,
                  double *now_s)
{
	double sent_s = *now_s, there_s = sent_s + o->there * limit_s;
	bool in_time = o->arrives && o->there + o->back <= 1;
	cau_renewal renewal = CAU_RENEWAL_UNKNOWN;
	if (o->arrives && there_s < etcd->ends_s)
		etcd->ends_s = there_s + etcd->ttl_s;
	else if (o->arrives)
		renewal = CAU_RENEWAL_GONE;
	if (o->arrives && renewal != CAU_RENEWAL_GONE && !o->unreadable)
		renewal = CAU_RENEWED;
	*now_s += limit_s * (in_time ? o->there + o->back : 1);
	cau_lease_answer(logic, in_time ? renewal : CAU_RENEWAL_UNKNOWN, sent_s, etcd->ttl_s + 5,
	                 *now_s);
}

// Checks that etcd keeps the label for the daemon until the daemon acts next.
static void check_kept(const cau_lease_logic *logic, const server *etcd, double now_s)
{
	if (!logic->lost && now_s < logic->held_until_s)
		assert_true(logic->held_until_s + logic->rules.margin_s <= etcd->ends_s + 1e-9);
}

static int64_t paths;

static void go_on(cau_lease_logic logic, server etcd, double now_s, int depth)
{
	double held_until_s = logic.held_until_s;
	cau_lease_step step = cau_lease_next(&logic, now_s);
	check_kept(&logic, &etcd, now_s);
	if (step.kind == CAU_LEASE_END || depth == 0) {
		assert_true(step.kind != CAU_LEASE_END || logic.lost);
		paths++;
		return;
	}
	assert_true(step.seconds >= 0 && now_s + step.seconds <= held_until_s + 1e-9);
	if (step.kind == CAU_LEASE_WAIT) {
		go_on(logic, etcd, now_s + step.seconds, depth);
		return;
	}
	for (int i = 0; i < OUTCOMES; i++) {
		cau_lease_logic next = logic;
		server then = etcd;
		double later_s = now_s;
		renew(&next, &then, &outcomes[i], step.seconds, &later_s);
		check_kept(&next, &then, later_s);
		go_on(next, then, later_s, depth - 1);
	}
}

static void the_end_comes_here_first_in_every_order(void **state)
{
	(void)state;
	static const double times_to_live_s[] = {2, 12, 72};
	for (int i = 0; i < 3; i++) {
		double ttl_s = times_to_live_s[i];
		cau_lease_logic logic;
		cau_lease_rules rules = cau_lease_rules_of(ttl_s);
		cau_lease_begin(&logic, &rules, 100, ttl_s);
		paths = 0;
		go_on(logic, (server){100 + ttl_s, ttl_s}, 100, RENEWALS_DEEP);
		assert_true(paths > 10000);
	}
}

static void who_is_answered_keeps_it(void **state)
{
	(void)state;
	cau_lease_logic logic;
	cau_lease_rules rules = cau_lease_rules_of(15);
	server etcd = {15, 15};
	double now_s = 0;
	cau_lease_begin(&logic, &rules, 0, 15);
	// Each time two of three addresses do not answer.
	for (int i = 0; now_s < 1000; i++) {
		cau_lease_step step = cau_lease_next(&logic, now_s);
		assert_int_not_equal(step.kind, CAU_LEASE_END);
		if (step.kind == CAU_LEASE_WAIT)
			now_s += step.seconds;
		else
			renew(&logic, &etcd, &outcomes[i % 3 ? 4 : 0], step.seconds, &now_s);
	}
}

static void what_is_lost_stays_lost(void **state)
{
	(void)state;
	cau_lease_rules rules = cau_lease_rules_of(10);
	cau_lease_logic logic;
	cau_lease_begin(&logic, &rules, 0, 10);
	assert_int_equal(cau_lease_next(&logic, 8.9).kind, CAU_LEASE_RENEW);
	// the margin is 1 s, so this answer is too late
	cau_lease_answer(&logic, CAU_RENEWED, 8.9, 10, 9.0);
	assert_int_equal(cau_lease_next(&logic, 9.0).kind, CAU_LEASE_END);
	cau_lease_begin(&logic, &rules, 0, 10);
	cau_lease_answer(&logic, CAU_RENEWAL_GONE, 2.5, 0, 2.6);
	assert_int_equal(cau_lease_next(&logic, 2.6).kind, CAU_LEASE_END);
	cau_lease_answer(&logic, CAU_RENEWED, 2.6, 10, 2.7);
	assert_int_equal(cau_lease_next(&logic, 2.7).kind, CAU_LEASE_END);
	// The lease was granted for a shorter time than requested.
	cau_lease_begin(&logic, &rules, 0, 4);
	assert_int_equal(cau_lease_next(&logic, 3.1).kind, CAU_LEASE_END);
}

// ---- claims
// The stores of one label, on one machine or two. Each store is served by a process that takes
// steps and may be killed after any step. Stores are copied at any time.
enum { STORES = 3, STEPS_DEEP = 9, WALKS = 20000, WALK_STEPS = 40 };

typedef struct file {
	bool is_there, is_copy; // is_copy: not opened since it was copied
	cau_generation held, next;
	int writes; // how many of all acknowledged writes the file has
} file;

typedef enum phase { DOWN, NOTED, CLAIMED, SERVES } phase;

typedef struct process {
	phase phase;
	bool has_next;
	uint64_t read_revision; // etcd's revision when the claim was judged
} process;

typedef struct world {
	file file[STORES];
	process process[STORES];
	cau_generation known;
	int holder; // process whose lease has not ended; -1: no such process
	uint64_t revision, mark;
	int writes; // writes acknowledged so far, by all processes
	bool taken; // --take-label was given: missing writes are then the operator's responsibility
} world;

static cau_claim claim_of(const world *w, int i, bool take_label)
{
	return (cau_claim){.held = w->file[i].held,
	                   .next = w->file[i].next,
	                   .known = w->known,
	                   .is_held = w->holder >= 0,
	                   .is_held_here = w->holder == i,
	                   .is_copy = w->file[i].is_copy,
	                   .take_label = take_label};
}

static void judge_and_note(world *w, int i, bool take_label)
{
	cau_error error = {0};
	cau_claim claim = claim_of(w, i, take_label);
	if (cau_lease_judge(&claim, &error) != CAU_VERDICT_CLAIM)
		return;
	cau_lease_choose(&claim, &w->process[i].has_next, ++w->mark);
	w->file[i].held = claim.held;
	w->file[i].next = claim.next;
	// The store notes its own file, so the file is not a copy any more.
	w->file[i].is_copy = false;
	w->process[i].read_revision = w->revision;
	w->process[i].phase = NOTED;
	w->taken = w->taken || take_label;
}

static void claim_it(world *w, int i)
{
	w->process[i].phase = DOWN;
	if (w->process[i].read_revision != w->revision)
		return; // another process was faster, so this one starts again
	w->known = w->file[i].next;
	w->holder = i;
	w->revision++;
	w->process[i].phase = CLAIMED;
}

static void serve(world *w, int i)
{
	w->file[i].held = w->file[i].next;
	w->process[i].phase = SERVES;
	for (int j = 0; j < STORES; j++)
		assert_true(j == i || w->process[j].phase != SERVES);
	if (!w->taken)
		assert_int_equal(w->file[i].writes, w->writes); // no acknowledged write is missing
}

static void advance(world *w, int i)
{
	switch (w->process[i].phase) {
	case DOWN:
		judge_and_note(w, i, false);
		break;
	case NOTED:
		claim_it(w, i);
		break;
	case CLAIMED:
		serve(w, i);
		break;
	case SERVES:
		w->writes = ++w->file[i].writes > w->writes ? w->file[i].writes : w->writes;
		break;
	}
}

static void copy(world *w, int from, int to)
{
	w->file[to] = w->file[from];
	w->file[to].is_copy = w->file[from].held.number > 0 || w->file[from].next.number > 0;
}

// Makes something happen in the world. Returns false if that is not possible now.
static bool happen(world *w, int what)
{
	int i = what % STORES;
	process *p = &w->process[i];
	switch (what / STORES) {
	case 0: // the process takes its next step
		if (w->file[i].is_there)
			advance(w, i);
		return w->file[i].is_there;
	case 1: // the process is killed
		if (p->phase == DOWN)
			return false;
		*p = (process){0};
		return true;
	case 2: // a lease ends; its holder has ended before, as the tests of renewals show
		if (w->holder != i)
			return false;
		w->holder = -1;
		w->revision++;
		*p = (process){0};
		return true;
	case 3: // the first store is copied, whatever its process is doing
		if (i == 0 || p->phase != DOWN || w->holder == i)
			return false;
		copy(w, 0, i);
		return true;
	default:
		if (!w->file[i].is_there || p->phase != DOWN)
			return false;
		judge_and_note(w, i, true);
		return true;
	}
}

enum { HAPPENINGS = 4 * STORES, HAPPENINGS_BY_HAND = 5 * STORES };

static world begin(void)
{
	world w = {.holder = -1};
	w.file[0].is_there = true;
	return w;
}

static int64_t worlds;

static void go_through(const world *before, int depth)
{
	for (int what = 0; depth > 0 && what < HAPPENINGS; what++) {
		world w = *before;
		if (!happen(&w, what))
			continue;
		worlds++;
		go_through(&w, depth - 1);
	}
}

static void nothing_is_served_twice_and_nothing_older_in_every_order(void **state)
{
	(void)state;
	world w = begin();
	go_through(&w, STEPS_DEEP);
	// Start again from a store that has been served and has a copy without its last writes.
	for (int i = 0; i < 4; i++)
		advance(&w, 0);
	copy(&w, 0, 1);
	advance(&w, 0);
	assert_int_equal(w.process[0].phase, SERVES);
	go_through(&w, STEPS_DEEP);
	assert_true(worlds > 100000);
}

// Long random histories, some with the operator's --take-label.
static void nor_in_long_histories(void **state)
{
	(void)state;
	uint64_t random = 88172645463325252u; // state of the generator xorshift
	int served = 0;
	for (int walk = 0; walk < WALKS; walk++) {
		world w = begin();
		for (int step = 0; step < WALK_STEPS; step++) {
			random ^= random << 13;
			random ^= random >> 7;
			random ^= random << 17;
			int most = walk % 2 ? HAPPENINGS_BY_HAND : HAPPENINGS;
			// Every second time a process takes a step; otherwise few would ever serve.
			happen(&w, (int)((random >> 8) % (uint64_t)(random % 2 ? STORES : most)));
		}
		served += w.writes > 1;
	}
	assert_true(served > WALKS / 10);
}

// Tests that a daemon that is killed after any step can start again by itself.
static void who_was_killed_comes_back(void **state)
{
	(void)state;
	for (int steps = 0; steps < 8; steps++) {
		world w = begin();
		for (int i = 0; i < steps; i++)
			advance(&w, 0);
		w.process[0] = (process){0};
		for (int i = 0; i < 3; i++)
			advance(&w, 0);
		assert_int_equal(w.process[0].phase, SERVES);
	}
}

static void a_lease_is_taken_from_nobody(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_generation held = {5, 55}, other = {7, 77};
	cau_claim claim = {.held = held, .known = held, .is_held = true};
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_WAIT);
	claim.take_label = true;
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_WAIT);
	// An earlier process with this store, which has ended, holds the label.
	claim.is_held_here = true;
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_CLAIM);
	claim = (cau_claim){.held = held, .known = other};
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_REFUSE);
	assert_non_null(strstr(error.reason, "generation 5, etcd has 7"));
	claim.take_label = true;
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_CLAIM);
	bool has_next = false;
	cau_lease_choose(&claim, &has_next, 99);
	assert_int_equal(claim.next.number, 8);
	cau_lease_choose(&claim, &has_next, 100); // another attempt of the same start
	assert_int_equal(claim.next.mark, 99);
	claim = (cau_claim){.held = held}; // etcd has lost its data
	assert_int_equal(cau_lease_judge(&claim, &error), CAU_VERDICT_REFUSE);
	assert_non_null(strstr(error.reason, "lost its data"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_generation_has_one_text),
		cmocka_unit_test(the_end_comes_here_first_in_every_order),
		cmocka_unit_test(who_is_answered_keeps_it),
		cmocka_unit_test(what_is_lost_stays_lost),
		cmocka_unit_test(nothing_is_served_twice_and_nothing_older_in_every_order),
		cmocka_unit_test(nor_in_long_histories),
		cmocka_unit_test(who_was_killed_comes_back),
		cmocka_unit_test(a_lease_is_taken_from_nobody),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
