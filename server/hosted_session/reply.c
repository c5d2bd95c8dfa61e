// SPDX-License-Identifier: GPL-3.0-or-later
// Answers to orders: with the commit that holds what they changed, or again to who asks again; and
// what a session says of itself.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/answer.h"
#include "hosted_session/internal.h"
#include "hosted_session/resend.h"
#include "hosted_session/slice.h"

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

static cau_status send_again(void *user, const cau_store_answer *answer)
{
	const cau_order *order = user;
	cau_resend_answer(&order->reply, answer->result.data, answer->result.bytes);
	return CAU_OK;
}

// The stored answer of a resent request: CAU_OK (answered), CAU_NOT_FOUND (act), CAU_BAD_STATE
// (wait), CAU_ALREADY_EXISTS (acted upon, and the answer is not kept any more).
static cau_status look_up(const cau_hosted_identity *identity, const cau_order *order,
                          cau_error *error)
{
	if (!order->client_sequence)
		return CAU_NOT_FOUND;
	return cau_store_read_answer(identity->around->store, order->asker.client_id,
	                             (uint64_t)order->client_sequence, send_again, (void *)order,
	                             error);
}

cau_outcome_kind cau_answer_resend(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	if (h->record.pending) // its first may be in this very slice's batch
		cau_record_commit(h);
	cau_status status = look_up(&h->identity, order, &error);
	if (status == CAU_BAD_STATE)
		return CAU_POSTPONED;
	if (status == CAU_OK) {
		free(order);
		return CAU_NOT_DONE;
	}
	if (status != CAU_ALREADY_EXISTS)
		return CAU_DONE;
	snprintf(error.path, sizeof error.path, "params.client_sequence");
	cau_answer_fail(order, &error, CAU_RPC_SEQUENCE_PAST);
	return CAU_NOT_DONE;
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
		cau_driver_describe(&drives[i], &drivers[i]);
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
