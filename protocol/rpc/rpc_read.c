// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/rpc.h"
#include "rpc/message.h"
#include "json/document.h"

// The parsed text of a message. The command codec reads the params of a command, so the envelope is
// removed from the params and "command" is added.
typedef struct rpc_document {
	cJSON *root;
	cJSON *params;          // member of `root`, or NULL
	cJSON *result;          // member of `root`, or NULL
	cJSON *session;         // removed from a command's params, or NULL
	cJSON *client_sequence; // removed from a command's params, or NULL
} rpc_document;

void cau_rpc_fault_of_code(cau_rpc_fault *fault, cau_rpc_error_code code, const char *reason)
{
	CAU_ASSERT(reason != NULL, "fault %d without a reason", (int)code);
	*fault = (cau_rpc_fault){.code = code};
	snprintf(fault->status, sizeof fault->status, "%s", cau_rpc_error_word(code));
	snprintf(fault->reason, sizeof fault->reason, "%s", reason);
}

void cau_rpc_fault_of_error(cau_rpc_fault *fault, const cau_error *error)
{
	cau_rpc_fault_of_code(fault, cau_rpc_error_of_status(error->status), error->reason);
	snprintf(fault->path, sizeof fault->path, "%s", error->path);
}

// ---- the envelope -------------------------------------------------------------------------------

// Largest integer that is read, 2^53 - 1: up to here a double represents every integer.
static const double whole_most = 9007199254740991.0;

static bool read_id(const cJSON *value, cau_rpc_id *id)
{
	*id = (cau_rpc_id){.kind = CAU_RPC_ID_NONE};
	if (cJSON_IsString(value) && strlen(value->valuestring) < sizeof id->text) {
		id->kind = CAU_RPC_ID_TEXT;
		snprintf(id->text, sizeof id->text, "%s", value->valuestring);
		return true;
	}
	if (cJSON_IsNumber(value) && value->valuedouble == trunc(value->valuedouble) &&
	    fabs(value->valuedouble) <= whole_most) {
		id->kind = CAU_RPC_ID_NUMBER;
		id->number = (int64_t)value->valuedouble;
		return true;
	}
	return false;
}

static cau_status refuse(cau_rpc_fault *fault, cau_rpc_error_code code, const char *path,
                         const char *reason)
{
	cau_rpc_fault_of_code(fault, code, reason);
	snprintf(fault->path, sizeof fault->path, "%s", path);
	return CAU_BAD_VALUE;
}

static cau_status read_frame(const cJSON *root, cau_rpc_message *message, cau_rpc_fault *fault)
{
	static const char *const names[] = {"jsonrpc", "id", "method", "params", "result", "error"};
	message->kind = CAU_RPC_REQUEST;
	if (cJSON_IsArray(root))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "",
		              "batches of requests are not supported: send one message for each request");
	if (!cJSON_IsObject(root))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "", "the message is not a JSON object");
	const cJSON *id = cau_value_member(root, "id");
	bool is_answer = !cau_value_member(root, "method") &&
	                 (cau_value_member(root, "result") || cau_value_member(root, "error"));
	if (id && !read_id(id, &message->id) && !(is_answer && cJSON_IsNull(id)))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "id",
		              "must be a text of at most 64 bytes or a whole number below 2^53");
	const cJSON *version = cau_value_member(root, "jsonrpc");
	if (!cJSON_IsString(version) || strcmp(version->valuestring, "2.0") != 0)
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "jsonrpc", "must be \"2.0\"");
	cau_error error = {0};
	cau_reader reader;
	cau_reader_begin(&reader, NULL, &error);
	cau_read_no_others(&reader, root, names, sizeof names / sizeof *names);
	if (reader.status)
		return refuse(fault, CAU_RPC_INVALID_REQUEST, error.path, error.reason);
	return CAU_OK;
}

// ---- requests and notifications -----------------------------------------------------------------

static cau_status check_form(const cau_rpc_message *message, cau_rpc_fault *fault)
{
	CAU_ASSERT_INDEX(message->method, CAU_METHOD_COUNT);
	cau_method_form form = cau_method_describe(message->method)->form;
	if (message->kind == CAU_RPC_NOTIFICATION && form == CAU_FORM_REQUEST)
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "id",
		              "missing: this method is a request and needs an id");
	if (message->kind == CAU_RPC_REQUEST && (form == CAU_FORM_NOTICE || form == CAU_FORM_PUSH))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "id",
		              "this method is a notification and must not have an id");
	return CAU_OK;
}

static cau_status take_command_apart(rpc_document *document, const char *name, cau_rpc_fault *fault)
{
	CAU_ASSERT(!document->session && !document->client_sequence, "\"%s\" is taken apart twice",
	           name);
	if (cau_value_member(document->params, "command"))
		return refuse(fault, CAU_RPC_BAD_VALUE, "params.command",
		              "must not be given: the method names the command");
	document->session = cJSON_DetachItemFromObjectCaseSensitive(document->params, "session");
	document->client_sequence =
		cJSON_DetachItemFromObjectCaseSensitive(document->params, "client_sequence");
	if (cJSON_AddStringToObject(document->params, "command", name))
		return CAU_OK;
	refuse(fault, CAU_RPC_NO_MEMORY, "", "no memory to read the command");
	return CAU_NO_MEMORY;
}

static cau_status read_call(rpc_document *document, cau_rpc_message *message, cau_rpc_fault *fault)
{
	const cJSON *method = cau_value_member(document->root, "method");
	if (!cJSON_IsString(method))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "method", "missing, or not a text");
	if (cau_value_member(document->root, "result") || cau_value_member(document->root, "error"))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "method",
		              "the message has a method and a result or error: send only one of them");
	message->kind = message->id.kind == CAU_RPC_ID_NONE ? CAU_RPC_NOTIFICATION : CAU_RPC_REQUEST;
	int32_t found = cau_method_find(method->valuestring);
	if (found < 0)
		return refuse(fault, CAU_RPC_METHOD_NOT_FOUND, "method", "no method has this name");
	message->method = (cau_method)found;
	cau_status status = check_form(message, fault);
	if (status)
		return status;
	document->params = cJSON_GetObjectItemCaseSensitive(document->root, "params");
	if (!document->params)
		document->params = cJSON_AddObjectToObject(document->root, "params");
	if (!document->params) {
		refuse(fault, CAU_RPC_NO_MEMORY, "", "no memory to read the request");
		return CAU_NO_MEMORY;
	}
	if (cJSON_IsArray(document->params))
		return refuse(fault, CAU_RPC_BAD_VALUE, "params",
		              "params must be an object, with members by name");
	if (!cJSON_IsObject(document->params))
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "params", "params must be an object");
	if (cau_method_describe(message->method)->command < 0)
		return CAU_OK;
	return take_command_apart(document, method->valuestring, fault);
}

// ---- answers ------------------------------------------------------------------------------------

static void copy_text(const cJSON *object, const char *key, char *to, size_t bytes)
{
	const cJSON *value = cau_value_member(object, key);
	snprintf(to, bytes, "%s", cJSON_IsString(value) ? value->valuestring : "");
}

static cau_status read_fault(const cJSON *value, cau_rpc_message *message, cau_rpc_fault *fault)
{
	const cJSON *code = cau_value_member(value, "code"), *data = cau_value_member(value, "data");
	if (!cJSON_IsNumber(code) || fabs(code->valuedouble) > INT32_MAX)
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "error.code", "missing, or not a number");
	message->kind = CAU_RPC_ERROR;
	message->fault = (cau_rpc_fault){.code = (int32_t)code->valuedouble};
	copy_text(data, "status", message->fault.status, sizeof message->fault.status);
	copy_text(data, "path", message->fault.path, sizeof message->fault.path);
	copy_text(data, "reason", message->fault.reason, sizeof message->fault.reason);
	copy_text(data, "moved_to", message->fault.moved_to, sizeof message->fault.moved_to);
	copy_text(data, "url", message->fault.url, sizeof message->fault.url);
	if (!message->fault.reason[0])
		copy_text(value, "message", message->fault.reason, sizeof message->fault.reason);
	return CAU_OK;
}

static cau_status read_answer(rpc_document *document, cau_rpc_message *message,
                              cau_rpc_fault *fault)
{
	const cJSON *error = cau_value_member(document->root, "error");
	document->result = cJSON_GetObjectItemCaseSensitive(document->root, "result");
	if (!error == !document->result)
		return refuse(fault, CAU_RPC_INVALID_REQUEST, "",
		              "the message has no method, and not exactly one of result and error");
	message->kind = CAU_RPC_RESULT;
	return error ? read_fault(error, message, fault) : CAU_OK;
}

static cau_status read_document(rpc_document *document, cau_rpc_message *message,
                                cau_rpc_fault *fault)
{
	cau_status status = read_frame(document->root, message, fault);
	if (status)
		return status;
	bool is_call =
		cau_value_member(document->root, "method") ||
		(!cau_value_member(document->root, "result") && !cau_value_member(document->root, "error"));
	return is_call ? read_call(document, message, fault) : read_answer(document, message, fault);
}

cau_status cau_rpc_read(const char *text, size_t bytes, size_t bytes_max, cau_rpc_message *message,
                        cau_rpc_fault *fault)
{
	cau_error error = {0};
	*message = (cau_rpc_message){.kind = CAU_RPC_REQUEST};
	rpc_document *document = calloc(1, sizeof *document);
	if (!document) {
		refuse(fault, CAU_RPC_NO_MEMORY, "", "no memory to read the message");
		return CAU_NO_MEMORY;
	}
	message->document = document;
	cau_status status = cau_value_parse(text, bytes, bytes_max, &document->root, &error);
	if (status) {
		cau_rpc_fault_of_code(fault, status == CAU_NO_MEMORY ? CAU_RPC_NO_MEMORY : CAU_RPC_PARSE,
		                      error.reason);
	} else {
		status = read_document(document, message, fault);
	}
	if (status)
		cau_rpc_finish(message);
	return status;
}

void cau_rpc_finish(cau_rpc_message *message)
{
	rpc_document *document = message->document;
	if (!document)
		return;
	cJSON_Delete(document->session);
	cJSON_Delete(document->client_sequence);
	cJSON_Delete(document->root);
	free(document);
	message->document = NULL;
}

// ---- typed values -------------------------------------------------------------------------------

cau_status cau_rpc_params(const cau_rpc_message *message, void *params, cau_error *error)
{
	CAU_ASSERT(message->document &&
	               (message->kind == CAU_RPC_REQUEST || message->kind == CAU_RPC_NOTIFICATION),
	           "the params of a message of kind %d", (int)message->kind);
	CAU_ASSERT_INDEX(message->method, CAU_METHOD_COUNT);
	const rpc_document *document = message->document;
	const cau_method_info *info = cau_method_describe(message->method);
	cau_reader reader;
	cau_reader_begin(&reader, "params", error);
	cau_read_message(&reader, document->params, info->params, params, info->form != CAU_FORM_PUSH);
	return reader.status;
}

cau_status cau_rpc_params_known(const cau_rpc_message *message, cau_error *error)
{
	CAU_ASSERT_INDEX(message->method, CAU_METHOD_COUNT);
	const rpc_document *document = message->document;
	const cau_method_info *info = cau_method_describe(message->method);
	cau_reader reader;
	cau_reader_begin(&reader, "params", error);
	if (info->command < 0)
		cau_refuse_unknown(&reader, document->params, info->params);
	return reader.status;
}

cau_status cau_rpc_envelope_read(const cau_rpc_message *message, cau_rpc_envelope *envelope,
                                 cau_error *error)
{
	CAU_ASSERT_INDEX(message->method, CAU_METHOD_COUNT);
	const rpc_document *document = message->document;
	bool command = cau_method_describe(message->method)->command >= 0;
	const cJSON *session =
		command ? document->session : cau_value_member(document->params, "session");
	const cJSON *sequence =
		command ? document->client_sequence : cau_value_member(document->params, "client_sequence");
	*envelope = (cau_rpc_envelope){.has_session = session, .has_client_sequence = sequence};
	cau_reader reader;
	cau_reader_begin(&reader, "params", error);
	size_t mark = cau_reader_enter(&reader, "session", 0);
	if (session)
		cau_read_name(&reader, session, envelope->session);
	cau_reader_leave(&reader, mark);
	mark = cau_reader_enter(&reader, "client_sequence", 0);
	if (sequence)
		envelope->client_sequence = cau_read_integer(&reader, sequence, 1, (int64_t)whole_most);
	cau_reader_leave(&reader, mark);
	return reader.status;
}

cau_status cau_rpc_command(const cau_rpc_message *message, cau_command *command, cau_error *error)
{
	const rpc_document *document = message->document;
	cau_reader reader;
	cau_reader_begin(&reader, "params", error);
	cau_read_command(&reader, document->params, command);
	return reader.status;
}

cau_status cau_rpc_result(const cau_rpc_message *message, cau_method method, void *result,
                          cau_error *error)
{
	const rpc_document *document = message->document;
	cau_reader reader;
	cau_reader_begin(&reader, "result", error);
	cau_read_message(&reader, document->result, cau_method_describe(method)->result, result, false);
	return reader.status;
}
