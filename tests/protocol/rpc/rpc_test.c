// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/rpc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/defaults.h"

enum { TEXT_BYTES = 1 << 16 };

static cau_status read(const char *text, cau_rpc_message *message, cau_rpc_fault *fault)
{
	return cau_rpc_read(text, strlen(text), TEXT_BYTES, message, fault);
}

// ---- refused before any method sees the message

typedef struct refusal {
	const char *text;
	int32_t code;
	const char *path;
	int kind; // CAU_RPC_REQUEST if an answer is due
} refusal;

#define CALL "{\"jsonrpc\":\"2.0\","

static const refusal refusals[] = {
	{"", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{"{", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"hello\"} x", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":01,\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":1e999,\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":9007199254740993,\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"id\":2,\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":\"a\\u0000b\",\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{CALL "\"id\":\"\xff\",\"method\":\"hello\"}", CAU_RPC_PARSE, "", CAU_RPC_REQUEST},
	{"[]", CAU_RPC_INVALID_REQUEST, "", CAU_RPC_REQUEST},
	{"[" CALL "\"id\":1,\"method\":\"session.list\"}]", CAU_RPC_INVALID_REQUEST, "",
     CAU_RPC_REQUEST},
	{"7", CAU_RPC_INVALID_REQUEST, "", CAU_RPC_REQUEST},
	{"{}", CAU_RPC_INVALID_REQUEST, "jsonrpc", CAU_RPC_REQUEST},
	{"{\"jsonrpc\":2.0,\"id\":1,\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "jsonrpc",
     CAU_RPC_REQUEST},
	{CALL "\"id\":1}", CAU_RPC_INVALID_REQUEST, "method", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":5}", CAU_RPC_INVALID_REQUEST, "method", CAU_RPC_REQUEST},
	{CALL "\"id\":null,\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":1.5,\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":1222222222222222222222.1,\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "id",
     CAU_RPC_REQUEST},
	{CALL "\"id\":-1e300,\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":{},\"method\":\"hello\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":\"0123456789012345678901234567890123456789012345678901234567890123x\","
          "\"method\":\"hello\"}",
     CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"hello\",\"Params\":{}}", CAU_RPC_INVALID_REQUEST, "Params",
     CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"hello\",\"result\":1}", CAU_RPC_INVALID_REQUEST, "method",
     CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"result\":1,\"error\":{}}", CAU_RPC_INVALID_REQUEST, "", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"Hello\"}", CAU_RPC_METHOD_NOT_FOUND, "method", CAU_RPC_REQUEST},
	{CALL "\"method\":\"rm -rf\"}", CAU_RPC_METHOD_NOT_FOUND, "method", CAU_RPC_NOTIFICATION},
	{CALL "\"method\":\"session.list\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_NOTIFICATION},
	{CALL "\"id\":1,\"method\":\"stream.ack\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"event\"}", CAU_RPC_INVALID_REQUEST, "id", CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"hello\",\"params\":[1]}", CAU_RPC_BAD_VALUE, "params",
     CAU_RPC_REQUEST},
	{CALL "\"id\":1,\"method\":\"tool.grasp\",\"params\":{\"tool\":\"a\",\"command\":\"pin\"}}",
     CAU_RPC_BAD_VALUE, "params.command", CAU_RPC_REQUEST},
};

static void test_malformed_messages_are_refused(void **unused)
{
	(void)unused;
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		cau_rpc_message message;
		cau_rpc_fault fault = {0};
		if (read(refusals[i].text, &message, &fault) == CAU_OK)
			fail_msg("accepted: %s", refusals[i].text);
		if (fault.code != refusals[i].code || strcmp(fault.path, refusals[i].path) != 0)
			fail_msg("%s: %d at \"%s\": %s", refusals[i].text, fault.code, fault.path,
			         fault.reason);
		assert_int_equal(message.kind, refusals[i].kind);
		assert_true(fault.reason[0] != 0);
		assert_null(message.document);
	}
}

static void test_depth_and_size_are_bounded(void **unused)
{
	(void)unused;
	cau_rpc_message message;
	cau_rpc_fault fault;
	char *deep = malloc(2001);
	memset(deep, '[', 1000);
	memset(deep + 1000, ']', 1000);
	deep[2000] = 0;
	assert_int_not_equal(read(deep, &message, &fault), CAU_OK);
	assert_int_equal(fault.code, CAU_RPC_PARSE);
	memset(deep, ' ', 2000);
	assert_int_equal(cau_rpc_read(deep, 2000, 1999, &message, &fault), CAU_LIMIT);
	assert_int_equal(fault.code, CAU_RPC_PARSE);
	free(deep);
}

// ---- params

typedef struct bad_params {
	const char *method;
	const char *params;
	const char *path;
} bad_params;

static const bad_params bad[] = {
	{"hello", "{}", "params.version"},
	{"hello", "{\"version\":1}", "params.client"},
	{"hello", "{\"version\":\"1\",\"client\":\"x\"}", "params.version"},
	{"hello", "{\"version\":1.5,\"client\":\"x\"}", "params.version"},
	{"hello", "{\"version\":0,\"client\":\"x\"}", "params.version"},
	{"hello", "{\"version\":1,\"client\":7}", "params.client"},
	{"hello", "{\"version\":1,\"client\":\"x\",\"role\":\"root\"}", "params.role"},
	{"hello", "{\"version\":1,\"client\":\"x\",\"Token\":\"t\"}", "params.Token"},
	{"session.describe", "{\"session\":\"Knee\"}", "params.session"},
	{"session.describe", "{\"session\":\"../etc\"}", "params.session"},
	{"session.join", "{\"rate_hz\":0}", "params.rate_hz"},
	{"session.join", "{\"rate_hz\":true}", "params.rate_hz"},
	{"session.join", "{\"channels\":[\"positions\",\"smell\"]}", "params.channels[1]"},
	{"session.join", "{\"channels\":[\"mask\",\"mask\"]}", "params.channels[1]"},
	{"session.join", "{\"channels\":\"mask\"}", "params.channels"},
	{"session.step", "{\"ticks\":100001}", "params.ticks"},
	{"session.step", "{\"client_sequence\":0}", "params.client_sequence"},
	{"session.rewind", "{}", "params.tick"},
	{"session.rewind", "{\"tick\":-1}", "params.tick"},
	{"session.export", "{\"format\":\"exe\"}", "params.format"},
	{"upload.begin", "{\"name\":\"a\",\"file_name\":\"a.msh\",\"byte_count\":0}",
     "params.byte_count"},
};

static void test_params_are_checked_with_their_path(void **unused)
{
	(void)unused;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char text[512];
		union {
			cau_wire_hello hello;
			cau_wire_session_join join;
			cau_wire_upload_begin upload;
			char room[4096];
		} params = {0};
		snprintf(text, sizeof text, CALL "\"id\":1,\"method\":\"%s\",\"params\":%s}", bad[i].method,
		         bad[i].params);
		cau_rpc_message message;
		cau_rpc_fault fault;
		cau_error error = {0};
		assert_int_equal(read(text, &message, &fault), CAU_OK);
		if (cau_rpc_params(&message, &params, &error) != CAU_BAD_VALUE)
			fail_msg("accepted: %s", text);
		assert_string_equal(error.path, bad[i].path);
		cau_rpc_fault_of_error(&fault, &error);
		assert_int_equal(fault.code, CAU_RPC_BAD_VALUE);
		cau_rpc_finish(&message);
		cau_rpc_finish(&message);
	}
}

static void test_optional_members_say_whether_they_are_there(void **unused)
{
	(void)unused;
	cau_rpc_message message;
	cau_rpc_fault fault;
	cau_wire_session_join join = {0};
	assert_int_equal(read(CALL
	                      "\"id\":\"x\",\"method\":\"session.join\",\"params\":{\"rate_hz\":30,"
	                      "\"channels\":[\"mask\",\"tools\"]}}",
	                      &message, &fault),
	                 CAU_OK);
	assert_int_equal(cau_rpc_params(&message, &join, NULL), CAU_OK);
	assert_true(join.has_rate_hz && join.rate_hz == 30.0);
	assert_true(join.has_channels);
	assert_int_equal(join.channels, CAU_CHANNEL_MASK | CAU_CHANNEL_TOOLS);
	assert_false(join.has_session || join.has_step_m);
	cau_rpc_finish(&message);
	assert_int_equal(read(CALL "\"id\":2,\"method\":\"session.list\"}", &message, &fault), CAU_OK);
	cau_wire_nothing nothing;
	assert_int_equal(cau_rpc_params(&message, &nothing, NULL), CAU_OK);
	assert_int_equal(message.id.number, 2);
	cau_rpc_finish(&message);
}

static void test_unknown_params_are_refused_without_reading_the_others(void **unused)
{
	(void)unused;
	for (int m = 0; m < CAU_METHOD_COUNT; m++) {
		const cau_method_info *info = cau_method_describe((cau_method)m);
		bool without_id = info->form == CAU_FORM_NOTICE || info->form == CAU_FORM_PUSH;
		char text[256];
		cau_rpc_message message;
		cau_rpc_fault fault;
		cau_error error = {0};
		if (info->command >= 0)
			continue;
		snprintf(text, sizeof text, CALL "%s\"method\":\"%s\",\"params\":{\"stranger\":1}}",
		         without_id ? "" : "\"id\":1,", info->name);
		assert_int_equal(read(text, &message, &fault), CAU_OK);
		assert_int_equal(cau_rpc_params_known(&message, &error), CAU_BAD_VALUE);
		assert_string_equal(error.path, "params.stranger");
		cau_rpc_finish(&message);
	}
}

// ---- commands

static void test_methods_of_commands_bear_their_names(void **unused)
{
	(void)unused;
	static const char *const names[] = {
#define X(code, name) name,
		CAU_COMMAND_TABLE(X)
#undef X
	};
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		int32_t method = cau_method_find(names[kind]);
		assert_true(method >= 0);
		assert_int_equal(cau_method_describe((cau_method)method)->command, kind);
	}
}

static void make_command(cau_command *command, int kind)
{
	cau_default_command(command, kind);
	command->sequence = 42;
	command->tick = 9;
	if (kind == CAU_COMMAND_TOOL_ADD)
		strcpy(command->as.definition.name, "hook");
	else if (kind <= CAU_COMMAND_TOOL_RELEASE || kind == CAU_COMMAND_TOOL_HOLD)
		strcpy(command->tool, "hook");
	if (kind == CAU_COMMAND_SET_MATERIAL)
		strcpy(command->as.material.layer, "skin");
	if (kind == CAU_COMMAND_TOOL_MOVE)
		command->as.move.pose.position_m[1] = 0.1;
}

static void test_commands_round_trip_with_their_envelope(void **unused)
{
	(void)unused;
	char text[8192], again[8192];
	cau_rpc_envelope sent = {true, "d1-knee", true, 17}, got;
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		cau_command command, read_command;
		int64_t id = 3;
		make_command(&command, kind);
		cau_rpc_buffer out = {text, sizeof text, 0}, out_again = {again, sizeof again, 0};
		cau_rpc_message message;
		cau_rpc_fault fault;
		cau_error error = {0};
		assert_int_equal(cau_rpc_write_command(&out, &id, &sent, &command, &error), CAU_OK);
		assert_int_equal(read(text, &message, &fault), CAU_OK);
		assert_int_equal(cau_rpc_envelope_read(&message, &got, &error), CAU_OK);
		assert_true(got.has_session && got.has_client_sequence);
		assert_string_equal(got.session, sent.session);
		assert_int_equal(got.client_sequence, sent.client_sequence);
		if (cau_rpc_command(&message, &read_command, &error))
			fail_msg("%s: %s: %s", text, error.path, error.reason);
		assert_int_equal(read_command.kind, kind);
		assert_true(read_command.sequence == 42 && read_command.tick == 9);
		assert_int_equal(cau_rpc_write_command(&out_again, &id, &got, &read_command, &error),
		                 CAU_OK);
		assert_string_equal(text, again);
		cau_rpc_finish(&message);
	}
}

static void test_motion_is_a_notification_or_a_request(void **unused)
{
	(void)unused;
	cau_command command;
	char text[1024];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_rpc_message message;
	cau_rpc_fault fault;
	cau_rpc_envelope envelope;
	make_command(&command, CAU_COMMAND_TOOL_MOVE);
	assert_int_equal(cau_rpc_write_command(&out, NULL, NULL, &command, NULL), CAU_OK);
	assert_int_equal(read(text, &message, &fault), CAU_OK);
	assert_int_equal(message.kind, CAU_RPC_NOTIFICATION);
	assert_int_equal(cau_rpc_envelope_read(&message, &envelope, NULL), CAU_OK);
	assert_false(envelope.has_session || envelope.has_client_sequence);
	cau_rpc_finish(&message);
}

static void test_bad_commands_name_their_member(void **unused)
{
	(void)unused;
	const bad_params cases[] = {
		{"tool.move", "{\"tool\":\"a\",\"position_m\":[0,0],\"rotation\":[1,0,0,0]}",
	     "params.position_m"},
		{"tool.move", "{\"tool\":\"a\",\"position_m\":[0,0,\"x\"],\"rotation\":[1,0,0,0]}",
	     "params.position_m[2]"},
		{"tool.move", "{\"tool\":\"a\",\"position_m\":[0,0,0],\"rotation\":[0.5,0,0,0]}",
	     "params.rotation"},
		{"tool.move", "{\"position_m\":[0,0,0],\"rotation\":[1,0,0,0]}", "params.tool"},
		{"tool.grasp", "{\"tool\":\"a\",\"speed\":1}", "params.speed"},
		{"tool.energize", "{\"tool\":\"a\",\"energized\":1}", "params.energized"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[512];
		cau_rpc_message message;
		cau_rpc_fault fault;
		cau_command command;
		cau_error error = {0};
		snprintf(text, sizeof text, CALL "\"id\":1,\"method\":\"%s\",\"params\":%s}",
		         cases[i].method, cases[i].params);
		assert_int_equal(read(text, &message, &fault), CAU_OK);
		assert_int_equal(cau_rpc_command(&message, &command, &error), CAU_BAD_VALUE);
		assert_string_equal(error.path, cases[i].path);
		cau_rpc_finish(&message);
	}
}

static void test_bad_envelopes_are_refused(void **unused)
{
	(void)unused;
	const bad_params cases[] = {
		{"tool.grasp", "{\"tool\":\"a\",\"session\":5}", "params.session"},
		{"tool.grasp", "{\"tool\":\"a\",\"session\":\"A\"}", "params.session"},
		{"tool.grasp", "{\"tool\":\"a\",\"client_sequence\":1.5}", "params.client_sequence"},
		{"session.pause", "{\"client_sequence\":0}", "params.client_sequence"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[512];
		cau_rpc_message message;
		cau_rpc_fault fault;
		cau_rpc_envelope envelope;
		cau_error error = {0};
		snprintf(text, sizeof text, CALL "\"id\":1,\"method\":\"%s\",\"params\":%s}",
		         cases[i].method, cases[i].params);
		assert_int_equal(read(text, &message, &fault), CAU_OK);
		assert_int_equal(cau_rpc_envelope_read(&message, &envelope, &error), CAU_BAD_VALUE);
		assert_string_equal(error.path, cases[i].path);
		cau_rpc_finish(&message);
	}
}

// ---- errors and newer servers

static void test_errors_round_trip(void **unused)
{
	(void)unused;
	char text[1024];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_rpc_id none = {.kind = CAU_RPC_ID_NONE};
	cau_error error;
	cau_rpc_fault fault;
	cau_rpc_message message;
	cau_fail(&error, CAU_NOT_FOUND, "params.tool", "no tool \"%s\"", "hook");
	cau_rpc_fault_of_error(&fault, &error);
	assert_int_equal(cau_rpc_write_error(&out, &none, &fault, NULL), CAU_OK);
	assert_int_equal(read(text, &message, &fault), CAU_OK);
	assert_int_equal(message.kind, CAU_RPC_ERROR);
	assert_int_equal(message.id.kind, CAU_RPC_ID_NONE);
	assert_int_equal(message.fault.code, CAU_RPC_NOT_FOUND);
	assert_string_equal(message.fault.status, "not_found");
	assert_string_equal(message.fault.path, "params.tool");
	assert_string_equal(message.fault.reason, "no tool \"hook\"");
	cau_rpc_finish(&message);
}

static void test_every_status_has_its_code(void **unused)
{
	(void)unused;
	for (int status = CAU_OK + 1; status < CAU_STATUS_COUNT; status++) {
		cau_rpc_error_code code = cau_rpc_error_of_status((cau_status)status);
		assert_int_not_equal(code, CAU_RPC_INTERNAL);
		assert_string_equal(cau_rpc_error_word(code), cau_status_name((cau_status)status));
		assert_string_equal(cau_rpc_error_sentence(code), cau_status_sentence((cau_status)status));
	}
	assert_int_equal(cau_rpc_error_of_status(CAU_STATUS_COUNT), CAU_RPC_INTERNAL);
	assert_string_equal(cau_close_reason(CAU_CLOSE_NO_HELLO),
	                    "the client sent no hello within 5 s");
}

static void test_members_of_newer_servers_are_skipped(void **unused)
{
	(void)unused;
	cau_rpc_message message;
	cau_rpc_fault fault;
	cau_wire_tick_result result = {0};
	cau_wire_session_faulted faulted = {0};
	assert_int_equal(
		read(CALL "\"id\":1,\"result\":{\"tick\":5,\"mood\":\"good\"}}", &message, &fault), CAU_OK);
	assert_int_equal(cau_rpc_result(&message, CAU_METHOD_SESSION_STEP, &result, NULL), CAU_OK);
	assert_int_equal(result.tick, 5);
	cau_rpc_finish(&message);
	assert_int_equal(read(CALL "\"method\":\"session.faulted\",\"params\":{\"session\":\"a\","
	                           "\"tick\":1,\"reason\":\"r\",\"mood\":\"bad\"}}",
	                      &message, &fault),
	                 CAU_OK);
	assert_int_equal(cau_rpc_params(&message, &faulted, NULL), CAU_OK);
	cau_rpc_finish(&message);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_malformed_messages_are_refused),
		cmocka_unit_test(test_depth_and_size_are_bounded),
		cmocka_unit_test(test_params_are_checked_with_their_path),
		cmocka_unit_test(test_optional_members_say_whether_they_are_there),
		cmocka_unit_test(test_unknown_params_are_refused_without_reading_the_others),
		cmocka_unit_test(test_methods_of_commands_bear_their_names),
		cmocka_unit_test(test_commands_round_trip_with_their_envelope),
		cmocka_unit_test(test_motion_is_a_notification_or_a_request),
		cmocka_unit_test(test_bad_commands_name_their_member),
		cmocka_unit_test(test_bad_envelopes_are_refused),
		cmocka_unit_test(test_errors_round_trip),
		cmocka_unit_test(test_every_status_has_its_code),
		cmocka_unit_test(test_members_of_newer_servers_are_skipped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
