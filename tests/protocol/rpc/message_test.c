// SPDX-License-Identifier: GPL-3.0-or-later
// Writes and reads the params and results of every method.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "cautery/rpc.h"
#include "protocol/rpc/messages.h"

enum { TEXT_BYTES = 1 << 18 };

typedef struct bench {
	char *text;
	cau_rpc_buffer out;
	cau_scene_def *scene, *scene_read;
	cau_error error;
	cau_rpc_fault fault;
} bench;

static bench new_bench(void)
{
	bench made = {.text = malloc(TEXT_BYTES),
	              .scene = malloc(sizeof(cau_scene_def)),
	              .scene_read = malloc(sizeof(cau_scene_def))};
	made.out = (cau_rpc_buffer){.buffer = made.text, .capacity = TEXT_BYTES};
	cau_default_scene_def(made.scene);
	strcpy(made.scene->name, "empty");
	return made;
}

static void free_bench(bench *of)
{
	free(of->text);
	free(of->scene);
	free(of->scene_read);
}

static void read_back(bench *of, cau_rpc_message *message)
{
	if (cau_rpc_read(of->text, of->out.bytes, TEXT_BYTES, message, &of->fault))
		fail_msg("%s: %s: %s", of->text, of->fault.path, of->fault.reason);
}

static void check_params(bench *of, cau_method method, fill how)
{
	const cau_method_info *info = cau_method_describe(method);
	void *sent = calloc(1, cau_wire_shapes[info->params].bytes);
	void *got = calloc(1, cau_wire_shapes[info->params].bytes);
	bool request = info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY;
	fill_message(info->params, sent, how, of->scene);
	prepare_message(info->params, got, of->scene_read);
	cau_status status = request ? cau_rpc_write_request(&of->out, 7, method, sent, &of->error)
	                            : cau_rpc_write_notification(&of->out, method, sent, &of->error);
	assert_int_equal(status, CAU_OK);
	assert_int_equal(strlen(of->text), of->out.bytes);
	cau_rpc_message message;
	read_back(of, &message);
	assert_int_equal(message.method, method);
	assert_int_equal(message.kind, request ? CAU_RPC_REQUEST : CAU_RPC_NOTIFICATION);
	if (cau_rpc_params(&message, got, &of->error))
		fail_msg("%s: %s: %s", info->name, of->error.path, of->error.reason);
	assert_true(same_message(info->params, sent, got));
	cau_rpc_finish(&message);
	release_message(info->params, sent);
	release_message(info->params, got);
	free(sent);
	free(got);
}

static void check_result(bench *of, cau_method method, fill how)
{
	const cau_method_info *info = cau_method_describe(method);
	void *sent = calloc(1, cau_wire_shapes[info->result].bytes);
	void *got = calloc(1, cau_wire_shapes[info->result].bytes);
	cau_rpc_id id = {.kind = CAU_RPC_ID_TEXT, .text = "seven"};
	fill_message(info->result, sent, how, of->scene);
	prepare_message(info->result, got, of->scene_read);
	assert_int_equal(cau_rpc_write_result(&of->out, &id, method, sent, &of->error), CAU_OK);
	cau_rpc_message message;
	read_back(of, &message);
	assert_int_equal(message.kind, CAU_RPC_RESULT);
	assert_string_equal(message.id.text, "seven");
	if (cau_rpc_result(&message, method, got, &of->error))
		fail_msg("%s: %s: %s", info->name, of->error.path, of->error.reason);
	assert_true(same_message(info->result, sent, got));
	cau_rpc_finish(&message);
	release_message(info->result, sent);
	release_message(info->result, got);
	free(sent);
	free(got);
}

static void test_every_message_round_trips(void **unused)
{
	(void)unused;
	bench of = new_bench();
	for (int method = 0; method < CAU_METHOD_COUNT; method++) {
		for (int how = FILL_LEAST; how <= FILL_MOST; how++) {
			if (cau_method_describe((cau_method)method)->command < 0)
				check_params(&of, (cau_method)method, (fill)how);
			check_result(&of, (cau_method)method, (fill)how);
		}
	}
	free_bench(&of);
}

// A number just beyond its range is refused by the writer and by the reader.
static void test_ranges_are_checked_both_ways(void **unused)
{
	(void)unused;
	bench of = new_bench();
	cau_wire_session_speed speed = {.speed = 10.0};
	assert_int_equal(cau_rpc_write_request(&of.out, 1, CAU_METHOD_SESSION_SPEED, &speed, &of.error),
	                 CAU_OK);
	speed.speed = 10.5;
	assert_int_equal(cau_rpc_write_request(&of.out, 1, CAU_METHOD_SESSION_SPEED, &speed, &of.error),
	                 CAU_BAD_VALUE);
	assert_string_equal(of.error.path, "params.speed");
	const char *text =
		"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"session.speed\",\"params\":{\"speed\":10.5}}";
	cau_rpc_message message;
	assert_int_equal(cau_rpc_read(text, strlen(text), TEXT_BYTES, &message, &of.fault), CAU_OK);
	assert_int_equal(cau_rpc_params(&message, &speed, &of.error), CAU_BAD_VALUE);
	assert_string_equal(of.error.path, "params.speed");
	cau_rpc_finish(&message);
	free_bench(&of);
}

static void test_lists_are_bounded(void **unused)
{
	(void)unused;
	bench of = new_bench();
	const char *text =
		"{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{\"scenes\":["
		"{\"name\":\"a\",\"description\":\"\"},{\"name\":\"b\",\"description\":\"\"}]}}";
	cau_wire_scene_summary one;
	cau_wire_scene_list list = {.scenes = {&one, 0, 1}};
	cau_rpc_message message;
	assert_int_equal(cau_rpc_read(text, strlen(text), TEXT_BYTES, &message, &of.fault), CAU_OK);
	assert_int_equal(cau_rpc_result(&message, CAU_METHOD_SCENE_LIST, &list, &of.error), CAU_LIMIT);
	assert_string_equal(of.error.path, "result.scenes");
	cau_rpc_finish(&message);
	free_bench(&of);
}

static void test_a_small_buffer_is_reported(void **unused)
{
	(void)unused;
	char text[20];
	cau_rpc_buffer out = {.buffer = text, .capacity = sizeof text};
	cau_wire_nothing nothing = {0};
	assert_int_equal(cau_rpc_write_request(&out, 1, CAU_METHOD_SESSION_LIST, &nothing, NULL),
	                 CAU_LIMIT);
	assert_true(out.bytes > sizeof text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_message_round_trips),
		cmocka_unit_test(test_ranges_are_checked_both_ways),
		cmocka_unit_test(test_lists_are_bounded),
		cmocka_unit_test(test_a_small_buffer_is_reported),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
