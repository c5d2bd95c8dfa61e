// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for JSON-RPC messages. A message is read, then its params or result are read by its
// method. An accepted command must be the same after it is written and read again.
#include "fuzz/fuzz_target.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/rpc.h"

enum { TEXT_BYTES_MAX = 1 << 16, ITEMS = 4 };

// Memory for the params or the result of any method. Lists in it have no capacity.
static union {
	cau_wire_session_description description;
	cau_wire_session_create create;
	cau_wire_hello_result hello;
	char room[1 << 16];
} typed;

static void check_command(const cau_rpc_message *message)
{
	static char text[1 << 16];
	cau_command command;
	cau_error error;
	if (cau_rpc_command(message, &command, &error) != CAU_OK)
		return;
	cau_rpc_buffer out = {text, sizeof text, 0};
	int64_t id = 1;
	cau_rpc_message again;
	cau_rpc_fault fault;
	cau_command command_again;
	if (cau_rpc_write_command(&out, &id, NULL, &command, &error) != CAU_OK ||
	    cau_rpc_read(text, out.bytes, sizeof text, &again, &fault) != CAU_OK)
		abort();
	if (cau_rpc_command(&again, &command_again, &error) != CAU_OK ||
	    command_again.kind != command.kind || command_again.sequence != command.sequence)
		abort();
	cau_rpc_finish(&again);
}

static void check_call(const cau_rpc_message *message)
{
	cau_rpc_envelope envelope;
	cau_error error;
	cau_rpc_envelope_read(message, &envelope, &error);
	memset(&typed, 0, sizeof typed);
	if (cau_method_describe(message->method)->command >= 0)
		check_command(message);
	else
		cau_rpc_params(message, &typed, &error);
}

static void check_result(const cau_rpc_message *message)
{
	static cau_wire_timeline_event events[ITEMS];
	static cau_wire_session_summary sessions[ITEMS];
	cau_error error;
	for (int method = 0; method < CAU_METHOD_COUNT; method++) {
		memset(&typed, 0, sizeof typed);
		cau_rpc_result(message, (cau_method)method, &typed, &error);
	}
	cau_wire_timeline timeline = {.events = {events, 0, ITEMS}};
	cau_rpc_result(message, CAU_METHOD_SESSION_TIMELINE, &timeline, &error);
	cau_wire_session_list list = {.sessions = {sessions, 0, ITEMS}};
	cau_rpc_result(message, CAU_METHOD_SESSION_LIST, &list, &error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	if (cau_rpc_read((const char *)data, bytes, TEXT_BYTES_MAX, &message, &fault) != CAU_OK)
		return 0;
	if (message.kind == CAU_RPC_REQUEST || message.kind == CAU_RPC_NOTIFICATION)
		check_call(&message);
	else if (message.kind == CAU_RPC_RESULT)
		check_result(&message);
	cau_rpc_finish(&message);
	return 0;
}
