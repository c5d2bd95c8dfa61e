// SPDX-License-Identifier: Apache-2.0
#include "cautery/rpc.h"
#include "rpc/message.h"
#include "json/document.h"

static void begin(cau_json_writer *writer, const cau_rpc_buffer *out)
{
	cau_json_begin(writer, out->buffer, out->capacity, 0);
	cau_json_open(writer, NULL, '{');
	cau_json_string(writer, "jsonrpc", "2.0");
}

// Ends the message. `place`, if given, has the path of a value that was out of its range.
static cau_status end(cau_json_writer *writer, cau_rpc_buffer *out, const cau_reader *place,
                      cau_error *error)
{
	cau_json_close(writer);
	if (place && place->status)
		return place->status;
	return cau_json_end(writer, &out->bytes, error);
}

static void write_id(cau_json_writer *writer, const cau_rpc_id *id)
{
	if (id->kind == CAU_RPC_ID_NUMBER)
		cau_json_integer(writer, "id", id->number);
	else if (id->kind == CAU_RPC_ID_TEXT)
		cau_json_string(writer, "id", id->text);
	else
		cau_json_null(writer, "id");
}

static cau_status write_call(cau_rpc_buffer *out, const int64_t *id, cau_method method,
                             const void *params, cau_error *error)
{
	const cau_method_info *info = cau_method_describe(method);
	cau_json_writer writer;
	cau_reader place;
	begin(&writer, out);
	cau_reader_begin(&place, "params", error);
	if (id)
		cau_json_integer(&writer, "id", *id);
	cau_json_string(&writer, "method", info->name);
	cau_write_message(&writer, "params", info->params, params, &place);
	return end(&writer, out, &place, error);
}

cau_status cau_rpc_write_request(cau_rpc_buffer *out, int64_t id, cau_method method,
                                 const void *params, cau_error *error)
{
	return write_call(out, &id, method, params, error);
}

cau_status cau_rpc_write_notification(cau_rpc_buffer *out, cau_method method, const void *params,
                                      cau_error *error)
{
	return write_call(out, NULL, method, params, error);
}

// Writes the members of a command except "command", because the method gives the kind.
static void write_command_members(cau_json_writer *writer, const cau_command *command)
{
	cau_part parts[CAU_MAX_PARTS];
	// A part's base is not const, but writing does not change it.
	cau_command *shared = (cau_command *)command;
	int count = cau_command_parts_to_write(shared, parts);
	cau_record head = *parts[0].record;
	head.fields++;
	head.field_count--;
	parts[0].record = &head;
	cau_write_parts(writer, parts, count);
	const cau_selection *selection = cau_command_selection(shared);
	if (selection)
		cau_write_selection(writer, "selection", selection);
}

cau_status cau_rpc_write_command(cau_rpc_buffer *out, const int64_t *id,
                                 const cau_rpc_envelope *envelope, const cau_command *command,
                                 cau_error *error)
{
	static const char *const names[] = {
#define X(code, name) name,
		CAU_COMMAND_TABLE(X)
#undef X
	};
	bool material = command->kind == CAU_COMMAND_SET_MATERIAL;
	if (command->kind < 0 || command->kind >= CAU_COMMAND_COUNT ||
	    (material && (unsigned)command->as.material.kind >= CAU_LAYER_COUNT))
		return cau_fail(error, CAU_BAD_VALUE, "params", "the kind of the command does not exist");
	cau_json_writer writer;
	begin(&writer, out);
	if (id)
		cau_json_integer(&writer, "id", *id);
	cau_json_string(&writer, "method", names[command->kind]);
	cau_json_open(&writer, "params", '{');
	if (envelope && envelope->has_session)
		cau_json_string(&writer, "session", envelope->session);
	if (envelope && envelope->has_client_sequence)
		cau_json_integer(&writer, "client_sequence", envelope->client_sequence);
	write_command_members(&writer, command);
	cau_json_close(&writer);
	return end(&writer, out, NULL, error);
}

cau_status cau_rpc_write_result(cau_rpc_buffer *out, const cau_rpc_id *id, cau_method method,
                                const void *result, cau_error *error)
{
	cau_json_writer writer;
	cau_reader place;
	begin(&writer, out);
	cau_reader_begin(&place, "result", error);
	write_id(&writer, id);
	cau_write_message(&writer, "result", cau_method_describe(method)->result, result, &place);
	return end(&writer, out, &place, error);
}

cau_status cau_rpc_write_error(cau_rpc_buffer *out, const cau_rpc_id *id,
                               const cau_rpc_fault *fault, cau_error *error)
{
	cau_json_writer writer;
	begin(&writer, out);
	write_id(&writer, id);
	cau_json_open(&writer, "error", '{');
	cau_json_integer(&writer, "code", fault->code);
	cau_json_string(&writer, "message", cau_rpc_error_sentence(fault->code));
	cau_json_open(&writer, "data", '{');
	cau_json_string(&writer, "status", fault->status);
	if (fault->path[0])
		cau_json_string(&writer, "path", fault->path);
	cau_json_string(&writer, "reason", fault->reason);
	if (fault->moved_to[0])
		cau_json_string(&writer, "moved_to", fault->moved_to);
	if (fault->url[0])
		cau_json_string(&writer, "url", fault->url);
	cau_json_close(&writer);
	cau_json_close(&writer);
	return end(&writer, out, NULL, error);
}
