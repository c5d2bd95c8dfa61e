// SPDX-License-Identifier: Apache-2.0
#include <stdlib.h>
#include <string.h>

#include "cautery/json_writer.h"
#include "cautery/rpc.h"
#include "generate/model.h"

enum { TEXT_BYTES = 4 << 20 };

static void reference(cau_json_writer *writer, const char *key, const char *folder,
                      const char *name)
{
	char path[160];
	snprintf(path, sizeof path, "#/components/%s/%s", folder, name);
	cau_json_open(writer, key, '{');
	cau_json_string(writer, "$ref", path);
	cau_json_close(writer);
}

// ---- schemas ------------------------------------------------------------------------------------

static void write_range(cau_json_writer *writer, const char *json_type, double least, double most)
{
	cau_json_string(writer, "type", json_type);
	cau_json_number(writer, "minimum", least);
	cau_json_number(writer, "maximum", most);
}

static void write_array(cau_json_writer *writer, int32_t least, int32_t most)
{
	cau_json_string(writer, "type", "array");
	cau_json_integer(writer, "minItems", least);
	cau_json_integer(writer, "maxItems", most);
	cau_json_open(writer, "items", '{');
}

static void write_words(cau_json_writer *writer, const property *of)
{
	cau_json_open(writer, "enum", '(');
	for (int i = 0; i < of->choices->count; i++)
		if (of->fixed < 0 || of->fixed == i)
			cau_json_string(writer, NULL, of->choices->names[i]);
	cau_json_close(writer);
}

static void write_text(cau_json_writer *writer, const char *pattern, int32_t most)
{
	cau_json_string(writer, "type", "string");
	cau_json_integer(writer, "maxLength", most);
	if (pattern)
		cau_json_string(writer, "pattern", pattern);
}

static void write_scalar(cau_json_writer *writer, const property *of)
{
	switch (of->kind) {
	case PROPERTY_FLAG:
		cau_json_string(writer, "type", "boolean");
		break;
	case PROPERTY_INTEGER:
		write_range(writer, "integer", of->least, of->most);
		break;
	case PROPERTY_NUMBER:
		write_range(writer, "number", of->least, of->most);
		if (of->default_value)
			cau_json_number(writer, "default", *of->default_value);
		break;
	case PROPERTY_NAME:
		write_text(writer, "^([a-z][a-z0-9]*([_-][a-z0-9]+)*)$", CAU_NAME_BYTES - 1);
		break;
	case PROPERTY_HEX64:
		write_text(writer, "^[0-9a-f]{16}$", 16);
		break;
	case PROPERTY_CHOICE:
		write_words(writer, of);
		break;
	default:
		write_text(writer, NULL, of->count);
		break;
	}
}

static void write_list(cau_json_writer *writer, const property *of)
{
	switch (of->kind) {
	case PROPERTY_NUMBERS:
	case PROPERTY_INTEGERS:
		write_array(writer, of->least_count, of->count);
		write_range(writer, of->kind == PROPERTY_NUMBERS ? "number" : "integer", of->least,
		            of->most);
		break;
	case PROPERTY_ROTATION:
		write_array(writer, 4, 4);
		write_range(writer, "number", -1.001, 1.001);
		break;
	case PROPERTY_CHOICES:
		cau_json_bool(writer, "uniqueItems", true);
		write_array(writer, 0, of->choices->count);
		write_words(writer, of);
		break;
	default:
		abort();
	}
	cau_json_close(writer);
}

static void write_property(cau_json_writer *writer, const property *of)
{
	if (of->kind == PROPERTY_OBJECT) {
		reference(writer, of->name, "schemas", of->type);
		return;
	}
	cau_json_open(writer, of->name, '{');
	cau_json_string(writer, "description", of->meaning);
	if (of->unit[0] && strcmp(of->unit, "1") != 0)
		cau_json_string(writer, "x-unit", of->unit);
	if (of->kind == PROPERTY_OBJECTS) {
		cau_json_string(writer, "type", "array");
		cau_json_integer(writer, "maxItems", of->count);
		reference(writer, "items", "schemas", of->type);
	} else if (of->kind == PROPERTY_NUMBERS || of->kind == PROPERTY_INTEGERS ||
	           of->kind == PROPERTY_ROTATION || of->kind == PROPERTY_CHOICES) {
		write_list(writer, of);
	} else {
		write_scalar(writer, of);
	}
	cau_json_close(writer);
}

static void write_required(cau_json_writer *writer, const type *of)
{
	cau_json_open(writer, "required", '(');
	for (int i = 0; i < of->property_count; i++)
		if (of->properties[i].required)
			cau_json_string(writer, NULL, of->properties[i].name);
	cau_json_close(writer);
}

static void write_needed(cau_json_writer *writer, const char *name)
{
	cau_json_open(writer, NULL, '{');
	cau_json_open(writer, "required", '(');
	cau_json_string(writer, NULL, name);
	cau_json_close(writer);
	cau_json_close(writer);
}

// Writes that a member is required unless another member is present.
static void write_alternatives(cau_json_writer *writer, const type *of)
{
	for (int i = 0; i < of->property_count; i++) {
		const property *member = &of->properties[i];
		if (!member->unless)
			continue;
		cau_json_open(writer, "anyOf", '[');
		write_needed(writer, member->name);
		write_needed(writer, member->unless);
		cau_json_close(writer);
	}
}

static void write_type(cau_json_writer *writer, const type *of)
{
	cau_json_open(writer, of->name, '{');
	cau_json_string(writer, "description", of->meaning);
	if (of->variant_count > 0) {
		cau_json_open(writer, "oneOf", '[');
		for (int i = 0; i < of->variant_count; i++)
			reference(writer, NULL, "schemas", of->variants[i]);
		cau_json_close(writer);
		cau_json_close(writer);
		return;
	}
	cau_json_string(writer, "type", "object");
	write_required(writer, of);
	write_alternatives(writer, of);
	if (of->strict)
		cau_json_bool(writer, "additionalProperties", false);
	cau_json_open(writer, "properties", '{');
	for (int i = 0; i < of->property_count; i++)
		write_property(writer, &of->properties[i]);
	cau_json_close(writer);
	cau_json_close(writer);
}

static void write_fault_schemas(cau_json_writer *writer)
{
	static const char *const text[] = {"status", "path", "reason", "moved_to", "url"};
	cau_json_open(writer, "Id", '{');
	cau_json_string(writer, "description",
	                "text or whole number; null only in the answer to a message without id");
	cau_json_open(writer, "type", '(');
	cau_json_string(writer, NULL, "string");
	cau_json_string(writer, NULL, "integer");
	cau_json_string(writer, NULL, "null");
	cau_json_close(writer);
	cau_json_integer(writer, "maxLength", 64);
	cau_json_close(writer);
	cau_json_open(writer, "Fault", '{');
	cau_json_string(writer, "type", "object");
	cau_json_open(writer, "required", '(');
	cau_json_string(writer, NULL, "code");
	cau_json_string(writer, NULL, "message");
	cau_json_close(writer);
	cau_json_open(writer, "properties", '{');
	cau_json_open(writer, "code", '{');
	cau_json_string(writer, "type", "integer");
	cau_json_close(writer);
	cau_json_open(writer, "message", '{');
	cau_json_string(writer, "type", "string");
	cau_json_close(writer);
	cau_json_open(writer, "data", '{');
	cau_json_string(writer, "type", "object");
	cau_json_open(writer, "properties", '{');
	for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
		cau_json_open(writer, text[i], '{');
		cau_json_string(writer, "type", "string");
		cau_json_close(writer);
	}
	cau_json_close(writer);
	cau_json_close(writer);
	cau_json_close(writer);
	cau_json_close(writer);
}

// ---- messages -----------------------------------------------------------------------------------

static void write_constant(cau_json_writer *writer, const char *key, const char *value)
{
	cau_json_open(writer, key, '{');
	cau_json_string(writer, "const", value);
	cau_json_close(writer);
}

static void begin_payload(cau_json_writer *writer, const char *name, const char *summary,
                          const char *const *required, int required_count)
{
	cau_json_open(writer, name, '{');
	cau_json_string(writer, "name", name);
	cau_json_string(writer, "summary", summary);
	cau_json_open(writer, "payload", '{');
	cau_json_string(writer, "type", "object");
	cau_json_bool(writer, "additionalProperties", false);
	cau_json_open(writer, "required", '(');
	for (int i = 0; i < required_count; i++)
		cau_json_string(writer, NULL, required[i]);
	cau_json_close(writer);
	cau_json_open(writer, "properties", '{');
	write_constant(writer, "jsonrpc", "2.0");
}

static void end_payload(cau_json_writer *writer)
{
	cau_json_close(writer);
	cau_json_close(writer);
	cau_json_close(writer);
}

static bool is_answered(const cau_method_info *info)
{
	return info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY;
}

static bool needs_params(const model *from, int method)
{
	const type *params = model_find(from, from->params[method]);
	bool needs = params->variant_count > 0;
	for (int i = 0; i < params->property_count; i++)
		needs = needs || params->properties[i].required;
	return needs;
}

static void write_call(cau_json_writer *writer, const model *from, int method)
{
	const cau_method_info *info = cau_method_describe((cau_method)method);
	const char *required[4] = {"jsonrpc", "method"};
	int count = 2;
	if (needs_params(from, method))
		required[count++] = "params";
	if (info->form == CAU_FORM_REQUEST)
		required[count++] = "id";
	begin_payload(writer, info->name, info->meaning, required, count);
	if (is_answered(info))
		reference(writer, "id", "schemas", "Id");
	write_constant(writer, "method", info->name);
	reference(writer, "params", "schemas", from->params[method]);
	end_payload(writer);
}

static void write_result(cau_json_writer *writer, const model *from, int method)
{
	static const char *const required[] = {"jsonrpc", "id", "result"};
	const cau_method_info *info = cau_method_describe((cau_method)method);
	char name[64];
	snprintf(name, sizeof name, "%s.result", info->name);
	begin_payload(writer, name, "the answer", required, 3);
	reference(writer, "id", "schemas", "Id");
	reference(writer, "result", "schemas", from->results[method]);
	end_payload(writer);
}

static void write_messages(cau_json_writer *writer, const model *from)
{
	static const char *const required[] = {"jsonrpc", "id", "error"};
	cau_json_open(writer, "messages", '{');
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		write_call(writer, from, i);
		if (is_answered(cau_method_describe((cau_method)i)))
			write_result(writer, from, i);
	}
	begin_payload(writer, "error", "the answer to a refused request", required, 3);
	reference(writer, "id", "schemas", "Id");
	reference(writer, "error", "schemas", "Fault");
	end_payload(writer);
	cau_json_close(writer);
}

// ---- the document -------------------------------------------------------------------------------

static void write_channel(cau_json_writer *writer)
{
	cau_json_open(writer, "channels", '{');
	cau_json_open(writer, "wire", '{');
	cau_json_string(writer, "address", "/v1");
	cau_json_string(writer, "description",
	                "WebSocket with subprotocol " CAU_SUBPROTOCOL
	                ". README.md describes binary messages.");
	cau_json_open(writer, "messages", '{');
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		char name[64];
		snprintf(name, sizeof name, "%s.result", info->name);
		reference(writer, info->name, "messages", info->name);
		if (is_answered(info))
			reference(writer, name, "messages", name);
	}
	reference(writer, "error", "messages", "error");
	for (int level = 0; level < 3; level++)
		cau_json_close(writer);
}

static void write_channel_message(cau_json_writer *writer, const char *name)
{
	char path[160];
	snprintf(path, sizeof path, "#/channels/wire/messages/%s", name);
	cau_json_open(writer, NULL, '{');
	cau_json_string(writer, "$ref", path);
	cau_json_close(writer);
}

static void write_operation(cau_json_writer *writer, const cau_method_info *info)
{
	char name[64];
	cau_json_open(writer, info->name, '{');
	cau_json_string(writer, "action", info->form == CAU_FORM_PUSH ? "send" : "receive");
	cau_json_open(writer, "channel", '{');
	cau_json_string(writer, "$ref", "#/channels/wire");
	cau_json_close(writer);
	cau_json_open(writer, "messages", '[');
	write_channel_message(writer, info->name);
	cau_json_close(writer);
	if (is_answered(info)) {
		snprintf(name, sizeof name, "%s.result", info->name);
		cau_json_open(writer, "reply", '{');
		cau_json_open(writer, "channel", '{');
		cau_json_string(writer, "$ref", "#/channels/wire");
		cau_json_close(writer);
		cau_json_open(writer, "messages", '[');
		write_channel_message(writer, name);
		write_channel_message(writer, "error");
		cau_json_close(writer);
		cau_json_close(writer);
	}
	cau_json_close(writer);
}

// Writes the table of channels in binary frames as an extension, for decoders that are driven by
// tables.
static void write_stream_channels(cau_json_writer *writer)
{
	cau_json_open(writer, "x-stream-channels", '[');
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		cau_json_open(writer, NULL, '{');
		cau_json_string(writer, "name", info->name);
		cau_json_integer(writer, "bit", (int64_t)1 << i);
		cau_json_integer(writer, "section", info->section);
		cau_json_bool(writer, "byDefault", info->by_default);
		cau_json_string(writer, "description", info->meaning);
		if (info->scalar >= 0) {
			cau_json_number(writer, "least", info->least);
			if (info->step > 0)
				cau_json_number(writer, "step", info->step);
			cau_json_integer(writer, "most", info->most);
			cau_json_string(writer, "unit", info->unit);
		}
		cau_json_close(writer);
	}
	cau_json_close(writer);
}

static void write_servers(cau_json_writer *writer)
{
	cau_json_open(writer, "servers", '{');
	cau_json_open(writer, "local", '{');
	cau_json_string(writer, "host", "127.0.0.1:8740");
	cau_json_string(writer, "protocol", "ws");
	cau_json_string(writer, "description", "a daemon on this machine, with default settings");
	cau_json_close(writer);
	cau_json_open(writer, "secured", '{');
	cau_json_string(writer, "host", "{host}");
	cau_json_string(writer, "protocol", "wss");
	cau_json_string(writer, "description", "a daemon or a proxy with TLS; hello has a token");
	cau_json_open(writer, "variables", '{');
	cau_json_open(writer, "host", '{');
	cau_json_string(writer, "default", "localhost:8740");
	for (int level = 0; level < 4; level++)
		cau_json_close(writer);
}

static void write_document(cau_json_writer *writer, const model *from)
{
	cau_json_open(writer, NULL, '{');
	cau_json_string(writer, "asyncapi", "3.0.0");
	cau_json_open(writer, "info", '{');
	cau_json_string(writer, "title", "Cautery");
	cau_json_string(writer, "version", "1");
	cau_json_string(writer, "description",
	                "Generated from protocol/include/cautery/*.def and the codec's tables. "
	                "protocol/README.md is the normative text.");
	cau_json_open(writer, "license", '{');
	cau_json_string(writer, "name", "Apache-2.0");
	cau_json_close(writer);
	cau_json_close(writer);
	cau_json_string(writer, "defaultContentType", "application/json");
	write_servers(writer);
	write_channel(writer);
	write_stream_channels(writer);
	cau_json_open(writer, "operations", '{');
	for (int i = 0; i < CAU_METHOD_COUNT; i++)
		write_operation(writer, cau_method_describe((cau_method)i));
	cau_json_close(writer);
	cau_json_open(writer, "components", '{');
	write_messages(writer, from);
	cau_json_open(writer, "schemas", '{');
	write_fault_schemas(writer);
	for (int i = 0; i < from->type_count; i++)
		write_type(writer, &from->types[i]);
	cau_json_close(writer);
	cau_json_close(writer);
	cau_json_close(writer);
}

void write_asyncapi(FILE *out, const model *from)
{
	char *text = malloc(TEXT_BYTES);
	cau_json_writer writer;
	size_t bytes;
	if (!text)
		abort();
	cau_json_begin(&writer, text, TEXT_BYTES, 1);
	write_document(&writer, from);
	if (cau_json_end(&writer, &bytes, NULL) != CAU_OK)
		abort();
	fprintf(out, "%s\n", text);
	free(text);
}
