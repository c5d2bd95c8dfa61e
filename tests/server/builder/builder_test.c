// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/builder.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

enum { NICE = 12 };

// The state that the jobs of a test share.
typedef struct board {
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	char order[16]; // names of the jobs, in the order in which they ran
	int dropped, nice;
	int open; // number of open gates; jobs wait at gates
} board;

typedef struct named {
	cau_job job; // must be the first member
	char name;
	int held; // the job runs until this number of gates is open
	board *board;
} named;

static void run(cau_job *job)
{
	named *n = (named *)job;
	board *b = n->board;
	pthread_mutex_lock(&b->mutex);
	b->order[strlen(b->order)] = n->name;
	b->nice = getpriority(PRIO_PROCESS, (id_t)gettid());
	pthread_cond_broadcast(&b->changed);
	while (n->held > b->open)
		pthread_cond_wait(&b->changed, &b->mutex);
	pthread_mutex_unlock(&b->mutex);
}

static void drop(cau_job *job)
{
	((named *)job)->board->dropped++;
}

static void set_up(board *b)
{
	*b = (board){0};
	pthread_mutex_init(&b->mutex, NULL);
	pthread_cond_init(&b->changed, NULL);
}

static named make(board *b, char name, double expected_s, int held)
{
	return (named){.job = {.run = run, .drop = drop, .expected_s = expected_s},
	               .name = name,
	               .held = held,
	               .board = b};
}

static void await(board *b, size_t count)
{
	pthread_mutex_lock(&b->mutex);
	while (strlen(b->order) < count)
		pthread_cond_wait(&b->changed, &b->mutex);
	pthread_mutex_unlock(&b->mutex);
}

static void open_gate(board *b)
{
	pthread_mutex_lock(&b->mutex);
	b->open++;
	pthread_cond_broadcast(&b->changed);
	pthread_mutex_unlock(&b->mutex);
}

static void waiting_jobs_go_by_length(void **state)
{
	(void)state;
	board b;
	cau_builder *builder;
	set_up(&b);
	assert_int_equal(cau_builder_create(&builder, "cautery-build", 1, NICE, NULL), CAU_OK);
	named giant = make(&b, 'g', 60, 2), first = make(&b, 'f', 0.1, 1);
	named slow = make(&b, 's', 0.4, 0), quick = make(&b, 'q', 0.01, 0);
	cau_builder_submit(builder, &giant.job);
	await(&b, 1);
	cau_builder_submit(builder, &first.job);
	// Now a job runs on both threads.
	await(&b, 2);
	cau_builder_submit(builder, &slow.job);
	cau_builder_submit(builder, &quick.job);
	assert_int_equal(cau_builder_busy(builder), 4);
	open_gate(&b);
	// The short jobs ran one after the other while the long job continued.
	await(&b, 4);
	assert_string_equal(b.order, "gfqs");
	open_gate(&b);
	assert_int_equal(b.nice, NICE);
	cau_builder_stop(builder);
	cau_builder_destroy(builder);
}

static void a_short_job_does_not_stand_behind_a_long_one(void **state)
{
	(void)state;
	board b;
	cau_builder *builder;
	set_up(&b);
	assert_int_equal(cau_builder_create(&builder, "cautery-build", 1, NICE, NULL), CAU_OK);
	named giant = make(&b, 'g', 60, 1), small = make(&b, 's', 0.05, 0);
	cau_builder_submit(builder, &giant.job);
	await(&b, 1);
	cau_builder_submit(builder, &small.job);
	// The short job runs although the long job is still running.
	await(&b, 2);
	assert_string_equal(b.order, "gs");
	open_gate(&b);
	cau_builder_stop(builder);
	cau_builder_destroy(builder);
}

static void long_jobs_run_beside_each_other(void **state)
{
	(void)state;
	board b;
	cau_builder *builder;
	set_up(&b);
	assert_int_equal(cau_builder_create(&builder, "cautery-build", 3, NICE, NULL), CAU_OK);
	named giant[4];
	for (int i = 0; i < 4; i++) {
		giant[i] = make(&b, (char)('a' + i), 60 + i, 1);
		cau_builder_submit(builder, &giant[i].job);
	}
	await(&b, 3);
	named small = make(&b, 's', 0.05, 0);
	cau_builder_submit(builder, &small.job);
	// The short job runs on the thread of short jobs, although a long job waits.
	await(&b, 4);
	assert_int_equal(b.order[3], 's');
	assert_in_range(cau_builder_busy(builder), 4, 5); // the short job may still be ending
	open_gate(&b);
	await(&b, 5);
	cau_builder_stop(builder);
	cau_builder_destroy(builder);
}

static void idle_threads_of_long_jobs_take_short_ones(void **state)
{
	(void)state;
	board b;
	cau_builder *builder;
	set_up(&b);
	assert_int_equal(cau_builder_create(&builder, "cautery-build", 2, NICE, NULL), CAU_OK);
	named job[3];
	for (int i = 0; i < 3; i++) {
		job[i] = make(&b, (char)('a' + i), 0.1, 1);
		cau_builder_submit(builder, &job[i].job);
	}
	// All three jobs run at the same time.
	await(&b, 3);
	open_gate(&b);
	cau_builder_stop(builder);
	cau_builder_destroy(builder);
}

static void what_waits_at_the_end_is_dropped(void **state)
{
	(void)state;
	board b;
	cau_builder *builder;
	set_up(&b);
	assert_int_equal(cau_builder_create(&builder, "cautery-build", 1, NICE, NULL), CAU_OK);
	cau_builder_stop(builder);
	named late = make(&b, 'l', 0.1, 0);
	cau_builder_submit(builder, &late.job);
	assert_int_equal(b.dropped, 1);
	assert_string_equal(b.order, "");
	cau_builder_destroy(builder);
	cau_builder_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(waiting_jobs_go_by_length),
		cmocka_unit_test(a_short_job_does_not_stand_behind_a_long_one),
		cmocka_unit_test(long_jobs_run_beside_each_other),
		cmocka_unit_test(idle_threads_of_long_jobs_take_short_ones),
		cmocka_unit_test(what_waits_at_the_end_is_dropped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
