// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/slice.h"

#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/sink.h"

enum { FIRST_BYTES = 4096 };

char *cau_answer_text(cau_method method, const void *result, size_t *bytes, cau_error *error)
{
	cau_rpc_buffer out = {.capacity = FIRST_BYTES};
	cau_rpc_id id = {.kind = CAU_RPC_ID_TEXT};
	cau_status status = CAU_LIMIT;
	snprintf(id.text, sizeof id.text, "%s", cau_method_describe(method)->name);
	for (int attempt = 0; attempt < 2 && status == CAU_LIMIT; attempt++) {
		char *grown = realloc(out.buffer, out.capacity);
		if (!grown) {
			status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an answer");
			break;
		}
		out.buffer = grown;
		status = cau_rpc_write_result(&out, &id, method, result, error);
		if (status == CAU_LIMIT)
			out.capacity = out.bytes + 1;
	}
	if (!status) {
		*bytes = out.bytes;
		return out.buffer;
	}
	free(out.buffer);
	return NULL;
}

const cau_error cau_daemon_ends = {.status = CAU_BAD_STATE, .reason = "the daemon is ending"};

void cau_answer_now(const cau_reply *reply, const void *result)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	char *text = cau_answer_text(reply->method, result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	free(text);
}

void cau_answer_fail(cau_order *order, const cau_error *error, int32_t code)
{
	cau_reply_fail(&order->reply, error, code);
	free(order);
}

cau_outcome_kind cau_answer_refuse(cau_order *order, cau_status status, const char *path,
                                   const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, path, "%s", reason);
	cau_answer_fail(order, &error, 0);
	return CAU_NOT_DONE;
}

void cau_answer_notify(const cau_hosted_identity *identity, cau_audience audience,
                       cau_method method, const void *params)
{
	cau_rpc_buffer out = {.capacity = FIRST_BYTES};
	cau_buffer *buffer = cau_buffer_create(FIRST_BYTES, false);
	cau_error error = {0};
	if (!buffer)
		return;
	out.buffer = (char *)cau_buffer_bytes(buffer);
	if (cau_rpc_write_notification(&out, method, params, &error)) {
		cau_log(CAU_LOG_ERROR, identity->id, "notification_lost", "path=%s reason=\"%s\"",
		        error.path, error.reason);
		cau_buffer_release(buffer);
		return;
	}
	buffer->byte_count = out.bytes;
	identity->around->sink.notify(identity->around->sink.user, audience, buffer);
}

// ---- answers about the whole session ------------------------------------------------------------

void cau_answer_order(cau_hosted_record *record, cau_order *order, const void *result)
{
	cau_error error = {0};
	size_t bytes = 0;
	char *text = cau_answer_text(order->reply.method, result, &bytes, &error);
	const cau_method_info *method = cau_method_describe(order->reply.method);
	if (!text) {
		cau_reply_fail(&order->reply, &error, CAU_RPC_INTERNAL);
	} else if (method->changes) {
		cau_record_answer(record, order, text, bytes);
		cau_record_reply(record, &order->reply, text, bytes);
	} else {
		cau_outcome outcome = {.text = text, .text_bytes = bytes};
		cau_reply_answer(&order->reply, &outcome);
		free(text);
	}
	free(order);
}

void cau_answer_driver(const cau_drive *drive, cau_wire_driver *driver)
{
	*driver = (cau_wire_driver){.client = drive->driver.client,
	                            .energized = drive->enabled,
	                            .energy_off = drive->energy_off};
	memcpy(driver->tool, drive->tool, sizeof driver->tool);
	if (drive->driver.client)
		snprintf(driver->name, sizeof driver->name, "%s", drive->driver.name);
}

void cau_answer_changed(cau_hosted *h, int change, const char *client)
{
	cau_wire_session_changed changed = {.change = change, .has_client = client && *client};
	cau_hosted_publish_summary(h);
	cau_hosted_summary(h, &changed.summary);
	if (changed.has_client)
		snprintf(changed.client, sizeof changed.client, "%s", client);
	bool all = change == CAU_CHANGE_CREATED || change == CAU_CHANGE_DESTROYED;
	cau_audience audience = {all ? CAU_AUDIENCE_EVERYBODY : CAU_AUDIENCE_SESSION,
	                         h->identity.number};
	cau_answer_notify(&h->identity, audience, CAU_METHOD_SESSION_CHANGED, &changed);
}

static void describe_layers(const cau_session_info *info, cau_wire_layer_description *layers)
{
	for (int32_t i = 0; i < info->layer_count; i++) {
		const cau_session_layer *from = &info->layers[i];
		layers[i] = (cau_wire_layer_description){.kind = from->kind,
		                                         .first_face = from->first_face,
		                                         .face_count = from->face_count,
		                                         .element_count = from->element_count};
		memcpy(layers[i].name, from->name, sizeof layers[i].name);
	}
}

char *cau_answer_description(cau_hosted *h, cau_method method, size_t *bytes, cau_error *error)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_drive drives[CAU_MAX_TOOLS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_description result = {
		.triangle_count = h->core.info.triangle_count,
		.tetrahedron_count = h->core.info.tetrahedron_count,
		.link_count = h->core.info.link_count,
		.layers = {layers, h->core.info.layer_count, CAU_MAX_LAYERS},
		.drivers = {drivers, 0, CAU_MAX_TOOLS},
		.definition = h->core.described,
	};
	cau_hosted_publish_summary(h);
	cau_hosted_summary(h, &result.summary);
	snprintf(result.description, sizeof result.description, "%s", h->core.info.description);
	snprintf(result.instruction_set, sizeof result.instruction_set, "%s",
	         h->core.info.instruction_set);
	describe_layers(&h->core.info, layers);
	result.drivers.count = cau_decisions_drives(&h->decisions, drives);
	for (int32_t i = 0; i < result.drivers.count; i++)
		cau_answer_driver(&drives[i], &drivers[i]);
	*h->core.described = *h->identity.scene;
	cau_session_present(h->core.session, h->core.described);
	return cau_answer_text(method, &result, bytes, error);
}

void cau_answer_describe(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	char *text = cau_answer_description(h, order->reply.method, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(&order->reply, &outcome);
	free(text);
	free(order);
}

// ---- answers to repeated requests ---------------------------------------------------------------

// Reads the method's name from the answer's id. The name is empty if an older version stored the
// answer without it.
static void read_method(const char *text, size_t bytes, char name[CAU_RPC_ID_BYTES])
{
	static const char before[] = "{\"jsonrpc\":\"2.0\",\"id\":\"";
	size_t length = 0, skipped = sizeof before - 1;
	if (bytes > skipped && memcmp(text, before, skipped) == 0) {
		const char *end = memchr(text + skipped, '"', bytes - skipped);
		length = end ? (size_t)(end - text) - skipped : 0;
		if (length >= CAU_RPC_ID_BYTES)
			length = 0;
		memcpy(name, text + skipped, length);
	}
	name[length] = 0;
}

void cau_resend_answer(const cau_reply *reply, const char *text, size_t text_bytes)
{
	char method[CAU_RPC_ID_BYTES];
	cau_outcome outcome = {.text = text, .text_bytes = text_bytes};
	read_method(text, text_bytes, method);
	if (!*method || strcmp(method, cau_method_describe(reply->method)->name) == 0) {
		cau_reply_answer(reply, &outcome);
		return;
	}
	cau_error error = {0};
	cau_fail(&error, CAU_ALREADY_EXISTS, "params.client_sequence",
	         "this number belongs to a request `%s`", method);
	cau_reply_fail(reply, &error, CAU_RPC_SEQUENCE_CONFLICT);
}
