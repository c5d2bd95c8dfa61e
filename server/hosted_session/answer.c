// SPDX-License-Identifier: GPL-3.0-or-later
// Results and notifications as text.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

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

void cau_answer_order(cau_hosted *h, cau_order *order, const void *result)
{
	cau_error error = {0};
	size_t bytes = 0;
	char *text = cau_answer_text(order->reply.method, result, &bytes, &error);
	const cau_method_info *method = cau_method_describe(order->reply.method);
	if (!text) {
		cau_reply_fail(&order->reply, &error, CAU_RPC_INTERNAL);
	} else if (method->changes) {
		cau_record_answer(h, order, text, bytes);
		cau_record_reply(h, &order->reply, text, bytes);
	} else {
		cau_outcome outcome = {.text = text, .text_bytes = bytes};
		cau_reply_answer(&order->reply, &outcome);
		free(text);
	}
	free(order);
}

void cau_answer_fail(cau_order *order, const cau_error *error, int32_t code)
{
	cau_reply_fail(&order->reply, error, code);
	free(order);
}

void cau_answer_notify(cau_hosted *h, cau_audience audience, cau_method method, const void *params)
{
	cau_rpc_buffer out = {.capacity = FIRST_BYTES};
	cau_buffer *buffer = cau_buffer_create(FIRST_BYTES, false);
	cau_error error = {0};
	if (!buffer)
		return;
	out.buffer = (char *)cau_buffer_bytes(buffer);
	if (cau_rpc_write_notification(&out, method, params, &error)) {
		cau_log(CAU_LOG_ERROR, h->id, "notification_lost", "path=%s reason=\"%s\"", error.path,
		        error.reason);
		cau_buffer_release(buffer);
		return;
	}
	buffer->byte_count = out.bytes;
	h->around->sink.notify(h->around->sink.user, audience, buffer);
}

void cau_answer_changed(cau_hosted *h, int change, const char *client)
{
	cau_wire_session_changed changed = {.change = change, .has_client = client && *client};
	cau_hosted_publish_summary(h);
	cau_hosted_summary(h, &changed.summary);
	if (changed.has_client)
		snprintf(changed.client, sizeof changed.client, "%s", client);
	bool all = change == CAU_CHANGE_CREATED || change == CAU_CHANGE_DESTROYED;
	cau_audience audience = {all ? CAU_AUDIENCE_EVERYBODY : CAU_AUDIENCE_SESSION, h->number};
	cau_answer_notify(h, audience, CAU_METHOD_SESSION_CHANGED, &changed);
}

static void describe_layers(const cau_hosted *h, cau_wire_layer_description *layers)
{
	for (int32_t i = 0; i < h->info.layer_count; i++) {
		const cau_session_layer *from = &h->info.layers[i];
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
		.triangle_count = h->info.triangle_count,
		.tetrahedron_count = h->info.tetrahedron_count,
		.link_count = h->info.link_count,
		.layers = {layers, h->info.layer_count, CAU_MAX_LAYERS},
		.drivers = {drivers, 0, CAU_MAX_TOOLS},
		.definition = h->present,
	};
	cau_hosted_publish_summary(h);
	cau_hosted_summary(h, &result.summary);
	snprintf(result.description, sizeof result.description, "%s", h->info.description);
	snprintf(result.instruction_set, sizeof result.instruction_set, "%s", h->info.instruction_set);
	describe_layers(h, layers);
	result.drivers.count = cau_decide_drives(h, drives);
	for (int32_t i = 0; i < result.drivers.count; i++)
		cau_drive_describe(&drives[i], &drivers[i]);
	*h->present = *h->scene;
	cau_session_present(h->core, h->present);
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
