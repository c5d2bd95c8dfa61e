// SPDX-License-Identifier: GPL-3.0-or-later
#include "worker/pool.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>

#include <cmocka.h>

#include "clock/clock.h"

// A task that counts its slices, counts overlapping slices, and signals when it has run often
// enough.
typedef struct counting {
	cau_task task; // must be the first member
	atomic_int inside, slices, overlaps;
	int wanted;
	double period_s;
	pthread_mutex_t mutex;
	pthread_cond_t done;
} counting;

static cau_due count(cau_task *task)
{
	counting *c = (counting *)task;
	if (atomic_fetch_add(&c->inside, 1))
		c->overlaps++;
	for (volatile int i = 0; i < 20000; i++)
		;
	c->inside--;
	pthread_mutex_lock(&c->mutex);
	if (++c->slices >= c->wanted)
		pthread_cond_signal(&c->done);
	pthread_mutex_unlock(&c->mutex);
	double next_s = cau_monotonic_s() + c->period_s;
	return (cau_due){next_s, next_s, 0};
}

static void prepare(counting *c, int wanted, double period_s)
{
	*c = (counting){.task.run = count, .wanted = wanted, .period_s = period_s};
	pthread_mutex_init(&c->mutex, NULL);
	pthread_cond_init(&c->done, NULL);
}

static void await(counting *c)
{
	pthread_mutex_lock(&c->mutex);
	while (c->slices < c->wanted)
		pthread_cond_wait(&c->done, &c->mutex);
	pthread_mutex_unlock(&c->mutex);
}

static void a_task_is_on_one_worker_at_a_time(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	counting tasks[3];
	assert_int_equal(cau_worker_pool_create(&pool, 4, 3, 0, NULL), CAU_OK);
	for (int i = 0; i < 3; i++) {
		prepare(&tasks[i], 300, 0);
		assert_true(cau_worker_pool_add(pool, &tasks[i].task));
	}
	for (int i = 0; i < 3; i++)
		for (int wakes = 0; wakes < 300; wakes++)
			cau_worker_pool_wake(pool, &tasks[i].task);
	for (int i = 0; i < 3; i++) {
		await(&tasks[i]);
		cau_worker_pool_remove(pool, &tasks[i].task);
		assert_int_equal(tasks[i].overlaps, 0);
		assert_int_equal(tasks[i].inside, 0);
	}
	cau_worker_pool_destroy(pool);
}

static void a_sleeping_task_runs_when_woken_only(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	counting sleeper, clock;
	assert_int_equal(cau_worker_pool_create(&pool, 1, 2, 0, NULL), CAU_OK);
	prepare(&sleeper, 1, INFINITY);
	prepare(&clock, 20, 0.001);
	assert_true(cau_worker_pool_add(pool, &sleeper.task));
	await(&sleeper);
	assert_true(cau_worker_pool_add(pool, &clock.task));
	await(&clock);
	assert_int_equal(sleeper.slices, 1);
	sleeper.wanted = 2;
	cau_worker_pool_wake(pool, &sleeper.task);
	await(&sleeper);
	assert_int_equal(sleeper.slices, 2);
	cau_worker_pool_remove(pool, &sleeper.task);
	cau_worker_pool_remove(pool, &clock.task);
	cau_worker_pool_destroy(pool);
}

// A task that sleeps for moments until the worker has been held, then notes its turn.
#define MOMENT_S 0.001
static atomic_int turns;
static atomic_bool was_held;
typedef struct ordered {
	cau_task task; // must be the first member
	double due_s, deadline_s;
	int turn;
} ordered;

static cau_due take_turn(cau_task *task)
{
	ordered *o = (ordered *)task;
	if (was_held) {
		o->turn = turns + 1;
		turns++;
		return (cau_due){INFINITY, INFINITY, 0};
	}
	o->due_s = cau_monotonic_s() + MOMENT_S;
	return (cau_due){o->due_s, o->deadline_s, 0};
}

enum { TASKS = 4 };
typedef struct holder {
	cau_task task; // must be the first member
	const ordered *tasks;
} holder;

// Occupies the only worker until all other tasks are due.
static cau_due hold(cau_task *task)
{
	const holder *h = (const holder *)task;
	for (int i = 0; i < TASKS; i++)
		while (cau_monotonic_s() <= h->tasks[i].due_s)
			;
	was_held = true;
	return (cau_due){INFINITY, INFINITY, 0};
}

static void the_earliest_deadline_goes_first(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	double now_s = cau_monotonic_s();
	ordered tasks[TASKS];
	holder holding = {.task.run = hold, .tasks = tasks};
	assert_int_equal(cau_worker_pool_create(&pool, 1, TASKS + 1, 0, NULL), CAU_OK);
	for (int i = 0; i < TASKS; i++) {
		tasks[i] = (ordered){.task.run = take_turn, .deadline_s = now_s + TASKS - i};
		assert_true(cau_worker_pool_add(pool, &tasks[i].task));
	}
	assert_true(cau_worker_pool_add(pool, &holding.task));
	while (turns < TASKS || cau_worker_pool_busy(pool))
		sched_yield();
	for (int i = 0; i < TASKS; i++) {
		assert_int_equal(tasks[i].turn, TASKS - i);
		cau_worker_pool_remove(pool, &tasks[i].task);
	}
	cau_worker_pool_remove(pool, &holding.task);
	cau_worker_pool_destroy(pool);
}

// ---- tasks with long pieces
#define LONG_S (2 * CAU_SLICE_MOST_S)
enum { LONG_TASKS = 3, MARKS = 64 };

// Shared notes of a test's tasks: the number of running long slices, their maximum, and the order
// of all slices.
static atomic_int long_inside, long_most, marks;
static char mark[MARKS];

typedef struct marked {
	cau_task task; // must be the first member
	char name;
	bool is_long;
	int yields; // how often a slice yields the processor to the other workers
} marked;

static cau_due note(cau_task *task)
{
	marked *m = (marked *)task;
	if (m->is_long) {
		int inside = atomic_fetch_add(&long_inside, 1) + 1;
		if (inside > long_most)
			long_most = inside;
	}
	for (int i = 0; i < m->yields; i++)
		sched_yield();
	int at = atomic_fetch_add(&marks, 1);
	if (at < MARKS)
		mark[at] = m->name;
	long_inside -= m->is_long;
	return (cau_due){0, cau_monotonic_s(), m->is_long ? LONG_S : 0};
}

static void begin_marking(void)
{
	long_inside = long_most = marks = 0;
}

static void add_marked(cau_worker_pool *pool, marked *m, char name, bool is_long)
{
	*m = (marked){.task = {.run = note, .next.piece_s = is_long ? LONG_S : 0},
	              .name = name,
	              .is_long = is_long,
	              .yields = is_long ? 200 : 1};
	assert_true(cau_worker_pool_add(pool, &m->task));
}

// Lets the pool run until `wanted` slices have ended. Then removes the tasks, the first one last,
// and destroys the pool.
static void run_marked(cau_worker_pool *pool, marked *tasks, int count, int wanted)
{
	while (marks < wanted)
		sched_yield();
	for (int i = count; i-- > 0;)
		cau_worker_pool_remove(pool, &tasks[i].task);
	cau_worker_pool_destroy(pool);
}

static void long_tasks_never_hold_the_last_worker(void **state)
{
	(void)state;
	for (int threads = 2; threads <= 4; threads++) {
		cau_worker_pool *pool;
		marked tasks[LONG_TASKS + 2];
		begin_marking();
		assert_int_equal(cau_worker_pool_create(&pool, threads, LONG_TASKS + 2, 0, NULL), CAU_OK);
		add_marked(pool, &tasks[0], 's', false);
		for (int i = 1; i <= LONG_TASKS; i++)
			add_marked(pool, &tasks[i], 'L', true);
		run_marked(pool, tasks, LONG_TASKS + 1, 2000);
		assert_in_range(long_most, 1, threads - 1);
	}
}

static void without_others_all_workers_are_theirs(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	marked tasks[2];
	begin_marking();
	assert_int_equal(cau_worker_pool_create(&pool, 2, 2, 0, NULL), CAU_OK);
	add_marked(pool, &tasks[0], 'L', true);
	add_marked(pool, &tasks[1], 'M', true);
	while (long_most < 2) // if two long slices never run at once, the test reaches its time limit
		sched_yield();
	run_marked(pool, tasks, 2, 10);
}

// Tests that with one worker, a slice of another task that is due follows each slice of a long
// task.
static void on_one_worker_they_take_turns(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	marked tasks[3];
	begin_marking();
	assert_int_equal(cau_worker_pool_create(&pool, 1, 3, 0, NULL), CAU_OK);
	add_marked(pool, &tasks[0], 's', false);
	add_marked(pool, &tasks[1], 'L', true);
	add_marked(pool, &tasks[2], 'M', true);
	run_marked(pool, tasks, 3, MARKS);
	int of[128] = {0};
	for (int i = 1; i < MARKS; i++) {
		assert_false(mark[i] != 's' && mark[i - 1] != 's');
		of[(int)mark[i]]++;
	}
	assert_true(of['L'] > 0 && of['M'] > 0);
}

static void a_full_pool_says_so(void **state)
{
	(void)state;
	cau_worker_pool *pool;
	counting tasks[2];
	assert_int_equal(cau_worker_pool_create(&pool, 1, 1, 0, NULL), CAU_OK);
	prepare(&tasks[0], 1, INFINITY);
	prepare(&tasks[1], 1, INFINITY);
	assert_true(cau_worker_pool_add(pool, &tasks[0].task));
	assert_false(cau_worker_pool_add(pool, &tasks[1].task));
	cau_worker_pool_remove(pool, &tasks[0].task);
	assert_true(cau_worker_pool_add(pool, &tasks[1].task));
	await(&tasks[1]);
	cau_worker_pool_remove(pool, &tasks[1].task);
	cau_worker_pool_destroy(pool);
	cau_worker_pool_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_task_is_on_one_worker_at_a_time),
		cmocka_unit_test(a_sleeping_task_runs_when_woken_only),
		cmocka_unit_test(the_earliest_deadline_goes_first),
		cmocka_unit_test(long_tasks_never_hold_the_last_worker),
		cmocka_unit_test(without_others_all_workers_are_theirs),
		cmocka_unit_test(on_one_worker_they_take_turns),
		cmocka_unit_test(a_full_pool_says_so),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
