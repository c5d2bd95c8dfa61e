// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a trace reads back as it was written. Its replay must give the same answers, or name
// the line where they differ.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "trace/trace.h"

#define STEP_S 0.01
#define DEADLINE_S 0.25

enum { QUEUE = 8 };

// ---- calls --------------------------------------------------------------------------------------

static cau_asker asker_of(uint32_t client)
{
	cau_asker asker = {.client = client, .role = CAU_ROLE_OPERATE, .deadline_s = DEADLINE_S};
	snprintf(asker.name, sizeof asker.name, "name of %u", client);
	snprintf(asker.client_id, sizeof asker.client_id, "id-%u", client);
	return asker;
}

// Returns a call in which no member is zero, so that a member that the trace omits would be
// noticed.
static cau_trace_call full_call(cau_trace_what what)
{
	cau_trace_call call = {.what = what,
	                       .time_s = 1.0 / 3,
	                       .capacity = 12,
	                       .step_s = 0.1,
	                       .event = CAU_LOGIC_ARRIVED,
	                       .client = 0xfffffff1,
	                       .number = 77,
	                       .subject = "hook",
	                       .cause = "a \"quoted\" \\ and\ttabbed\nreason, für alle",
	                       .store_takes = true,
	                       .state = CAU_SESSION_PAUSED,
	                       .tick = UINT64_MAX,
	                       .tool_count = CAU_MAX_TOOLS,
	                       .outcome = CAU_POSTPONED,
	                       .faulted = true};
	call.asked = (cau_asked){.ticket = 0x7ffffffffff0,
	                         .ask = CAU_ASK_DESTROY,
	                         .asker = asker_of(3),
	                         .to = asker_of(4),
	                         .tool = "jaws",
	                         .tick = 99,
	                         .limit = 180,
	                         .numbered = true,
	                         .ticks = INT64_MIN,
	                         .speed = INFINITY};
	for (int i = 0; i < CAU_MAX_TOOLS; i++) {
		snprintf(call.tools[i].name, sizeof call.tools[i].name, "tool-%d", i);
		call.tools[i].energized = true;
	}
	return call;
}

// Returns the line of a call, without its line feed. The caller frees it.
static char *line_of(const cau_trace_call *call)
{
	char *line = NULL;
	size_t bytes;
	FILE *to = open_memstream(&line, &bytes);
	assert_non_null(to);
	cau_trace_write(to, call);
	assert_int_equal(fclose(to), 0);
	assert_int_equal(line[bytes - 1], '\n');
	line[bytes - 1] = 0;
	return line;
}

static void assert_same_asker(const cau_asker *a, const cau_asker *b)
{
	assert_int_equal(a->client, b->client);
	assert_string_equal(a->name, b->name);
	assert_string_equal(a->client_id, b->client_id);
	assert_int_equal(a->role, b->role);
	assert_true(a->deadline_s == b->deadline_s);
}

static void test_a_call_reads_back_as_it_was_written(void **state)
{
	(void)state;
	for (int what = 0; what < CAU_TRACE_WHAT_COUNT; what++) {
		cau_trace_call written = full_call((cau_trace_what)what), read;
		cau_error error = {0};
		char *line = line_of(&written);
		assert_null(strchr(line, '\n'));
		assert_int_equal(cau_trace_read(line, &read, &error), CAU_OK);
		free(line);
		assert_int_equal(read.what, what);
		assert_true(read.time_s == written.time_s && read.step_s == written.step_s);
		assert_int_equal(read.capacity, written.capacity);
		assert_int_equal(read.event, written.event);
		assert_int_equal(read.client, written.client);
		assert_string_equal(read.subject, written.subject);
		assert_string_equal(read.cause, written.cause);
		assert_true(read.store_takes && read.faulted);
		assert_int_equal(read.state, written.state);
		assert_true(read.tick == written.tick);
		assert_int_equal(read.outcome, written.outcome);
		assert_int_equal(read.asked.ticket, written.asked.ticket);
		assert_int_equal(read.asked.ask, written.asked.ask);
		assert_same_asker(&read.asked.asker, &written.asked.asker);
		assert_same_asker(&read.asked.to, &written.asked.to);
		assert_string_equal(read.asked.tool, written.asked.tool);
		assert_int_equal(read.asked.tick, written.asked.tick);
		assert_true(read.asked.numbered && isinf(read.asked.speed));
		assert_true(read.asked.ticks == written.asked.ticks);
		assert_int_equal(read.tool_count, CAU_MAX_TOOLS);
		for (int i = 0; i < CAU_MAX_TOOLS; i++) {
			assert_string_equal(read.tools[i].name, written.tools[i].name);
			assert_true(read.tools[i].energized);
		}
	}
}

static void test_a_line_without_meaning_is_named(void **state)
{
	(void)state;
	static const char *const lines[] = {
		"",
		"takes",
		"take event",
		"take event=",
		"take event=birth",
		"take nothing=1",
		"take subject=hook",
		"take subject=\"hook",
		"take subject=\"\\y\"",
		"take subject=\"\\x0\"",
		"take time_s=soon",
		"take event=time ",
		"take event=time\tclient=1",
		"take tool_count=9",
		"init capacity=-1",
		"take client=x",
		"take faulted=2",
	};
	for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
		cau_trace_call call;
		cau_error error = {0};
		if (cau_trace_read(lines[i], &call, &error) != CAU_BAD_SYNTAX)
			fail_msg("'%s' was read", lines[i]);
		assert_non_null(strstr(error.reason, "is not valid here"));
	}
}

// ---- a session ----------------------------------------------------------------------------------

typedef struct traced {
	char *text;
	size_t bytes;
	FILE *to;
	cau_logic *logic;
	cau_action action;
	double now_s;
	int energized_steps;
} traced;

static void take(traced *t, cau_logic_event event)
{
	cau_effects effects;
	event.time_s = t->now_s;
	cau_trace_take(t->to, &event);
	cau_logic_take(t->logic, &event, &effects);
	cau_trace_effects(t->to, &effects);
}

static void order(traced *t, uint64_t ticket, cau_ask ask, uint32_t client)
{
	cau_asked asked = {
		.ticket = ticket, .ask = ask, .asker = asker_of(client), .tool = "hook", .speed = 1};
	take(t, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &asked});
}

// Runs the worker until it has nothing to do.
static void work(traced *t)
{
	cau_effects effects;
	for (;;) {
		cau_trace_next(t->to, t->now_s);
		cau_logic_next(t->logic, t->now_s, &t->action, &effects);
		cau_trace_action(t->to, &t->action);
		cau_trace_effects(t->to, &effects);
		if (t->action.act == CAU_ACT_NOTHING)
			return;
		if (t->action.act == CAU_ACT_STEP) {
			t->energized_steps += t->logic->drives[0].energized;
			cau_trace_stepped(t->to, t->now_s, NULL);
			cau_logic_stepped(t->logic, t->now_s, NULL, &effects);
		} else {
			cau_trace_done(t->to, t->now_s, CAU_DONE);
			cau_logic_done(t->logic, t->now_s, CAU_DONE, &effects);
		}
		cau_trace_effects(t->to, &effects);
	}
}

// Makes a trace of two clients. One takes over, turns energy on and falls silent. The other is
// refused and pauses.
static void make_trace(traced *t)
{
	*t = (traced){.now_s = 1};
	t->to = open_memstream(&t->text, &t->bytes);
	t->logic = malloc(cau_logic_bytes(QUEUE));
	assert_true(t->to && t->logic);
	cau_logic_init(t->logic, QUEUE);
	t->logic->step_s = STEP_S;
	cau_trace_init(t->to, QUEUE, STEP_S);
	cau_arrived_tool hook = {.name = "hook"};
	take(t, (cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                          .state = CAU_SESSION_RUNNING,
	                          .step_s = STEP_S,
	                          .tools = &hook,
	                          .tool_count = 1});
	order(t, 1, CAU_ASK_TAKE_OVER, 1);
	order(t, 2, CAU_ASK_ENERGY_ON, 1);
	work(t);
	order(t, 3, CAU_ASK_ENERGY_ON, 2);
	for (int i = 0; i < 40; i++) {
		t->now_s += STEP_S;
		take(t, (cau_logic_event){.kind = CAU_LOGIC_TIME});
		work(t);
	}
	order(t, 4, CAU_ASK_PAUSE, 2);
	work(t);
	assert_int_equal(fflush(t->to), 0);
	assert_in_range(t->energized_steps, 10,
	                30); // energy was turned on, and off again at the deadline
}

static void discard_trace(traced *t)
{
	fclose(t->to);
	free(t->text);
	free(t->logic);
}

static cau_status replay(const char *text, size_t bytes, cau_trace_counts *counts, cau_error *error)
{
	FILE *from = fmemopen((void *)(uintptr_t)text, bytes, "r");
	assert_non_null(from);
	cau_status status = cau_trace_replay(from, counts, error);
	fclose(from);
	return status;
}

static void test_a_trace_plays_again_to_the_same_answers(void **state)
{
	(void)state;
	traced t;
	cau_trace_counts counts;
	cau_error error = {0};
	make_trace(&t);
	if (replay(t.text, t.bytes, &counts, &error))
		fail_msg("%s: %s", error.path, error.reason);
	assert_int_equal(counts.of_event[CAU_LOGIC_ORDER], 4);
	assert_int_equal(counts.of_event[CAU_LOGIC_TIME], 40);
	assert_int_equal(counts.of_event[CAU_LOGIC_ARRIVED], 1);
	assert_true(counts.acts > 40 && counts.effects > 5);
	discard_trace(&t);
}

// A daemon may be killed at any byte of its trace.
static void test_a_trace_may_end_anywhere(void **state)
{
	(void)state;
	traced t;
	cau_trace_counts counts;
	cau_error error = {0};
	make_trace(&t);
	size_t first = (size_t)(strchr(t.text, '\n') + 1 - t.text);
	for (size_t bytes = first; bytes < t.bytes; bytes += CAU_TEST_SANITIZED ? 17 : 1)
		if (replay(t.text, bytes, &counts, &error))
			fail_msg("after %zu of %zu bytes: %s: %s", bytes, t.bytes, error.path, error.reason);
	assert_int_equal(replay(t.text, first - 1, &counts, &error), CAU_BAD_SYNTAX);
	discard_trace(&t);
}

static uint64_t line_at(const char *text, const char *at)
{
	uint64_t line = 1;
	for (; text < at; text++)
		line += *text == '\n';
	return line;
}

// Replaces the last `found` in the trace by `made`, which must be as long. The replay must fail
// `lines_on` lines later.
static void expect_difference(const char *found, const char *made, cau_status wanted, int lines_on)
{
	traced t;
	cau_trace_counts counts;
	cau_error error = {0};
	char path[32], *at = NULL;
	make_trace(&t);
	for (char *next = t.text; (next = strstr(next, found)); next++)
		at = next;
	if (!at) {
		fail_msg("\"%s\" is not in the trace", found);
		return;
	}
	assert_int_equal(strlen(found), strlen(made));
	memcpy(at, made, strlen(made));
	assert_int_equal(replay(t.text, t.bytes, &counts, &error), wanted);
	snprintf(path, sizeof path, "line %llu",
	         (unsigned long long)line_at(t.text, at) + (unsigned long long)lines_on);
	assert_string_equal(error.path, path);
	discard_trace(&t);
}

static void test_other_answers_are_told_with_their_line(void **state)
{
	(void)state;
	expect_difference("  effect=tell", "  effect=wake", CAU_CORRUPT, 0);
	expect_difference("drive.energy_off=", "drive.energy_on=0", CAU_CORRUPT, 0);
	expect_difference("act=step", "act=look", CAU_CORRUPT, 0);
	// A changed order changes the worker's next action, which comes after an effect and the call.
	expect_difference("ask=pause", "ask=speed", CAU_CORRUPT, 3);
	expect_difference("take", "tale", CAU_BAD_SYNTAX, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_call_reads_back_as_it_was_written),
		cmocka_unit_test(test_a_line_without_meaning_is_named),
		cmocka_unit_test(test_a_trace_plays_again_to_the_same_answers),
		cmocka_unit_test(test_a_trace_may_end_anywhere),
		cmocka_unit_test(test_other_answers_are_told_with_their_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
