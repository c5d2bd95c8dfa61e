// SPDX-License-Identifier: Apache-2.0
// Joins sessions, and joins them again after a lost connection.
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

static const cau_stream_state nothing_yet;

static void free_topology(cau_topology_arrays *arrays)
{
	free(arrays->face);
	free(arrays->face_layer);
	free(arrays->texture);
	free(arrays->rest);
	*arrays = (cau_topology_arrays){0};
}

static void empty_slot(cau_client_slot *slot)
{
	slot->stream.state = &nothing_yet;
	slot->stream.has_topology = false;
	free_topology(&slot->stream.topology);
	free(slot->storage);
	slot->storage = NULL;
	slot->decoder = NULL;
	slot->gap_s = 0;
}

void cau_slot_free(cau_client_slot *slot)
{
	if (!slot)
		return;
	empty_slot(slot);
	free(slot);
}

// ---- answer to session.join --------------------------------------------------------------------
static cau_status make_topology(cau_client_stream *stream, cau_error *error)
{
	size_t vertices = (size_t)stream->def.vertex_count, faces = (size_t)stream->def.face_count;
	cau_topology_arrays *arrays = &stream->topology;
	arrays->face = calloc(3 * faces + 1, sizeof *arrays->face);
	arrays->face_layer = calloc(faces + 1, sizeof *arrays->face_layer);
	arrays->texture = calloc(6 * faces + 1, sizeof *arrays->texture);
	arrays->rest = calloc(3 * vertices + 1, sizeof *arrays->rest);
	if (!arrays->face || !arrays->face_layer || !arrays->texture || !arrays->rest)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu faces", faces);
	return CAU_OK;
}

static cau_status make_decoder(cau_client_slot *slot, cau_error *error)
{
	size_t bytes = cau_frame_decoder_bytes(&slot->stream.def);
	slot->storage = malloc(bytes);
	if (!slot->storage)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a stream of %d vertices",
		                slot->stream.def.vertex_count);
	cau_status status =
		cau_frame_decoder_init(slot->storage, bytes, &slot->stream.def, &slot->decoder, error);
	if (!status)
		slot->stream.state = cau_frame_decoder_state(slot->decoder);
	return status;
}

static cau_status take_description(cau_client_slot *slot, const cau_rpc_message *answer,
                                   cau_error *error)
{
	cau_wire_stream_description d = {0};
	cau_status status = cau_rpc_result(answer, CAU_METHOD_SESSION_JOIN, &d, error);
	if (status)
		return status;
	cau_stream_def *def = &slot->stream.def;
	empty_slot(slot);
	slot->stream.description = d;
	*def = cau_default_stream_def();
	def->session = (uint32_t)d.session_number;
	def->profile = (uint16_t)d.profile;
	def->channels = d.channels;
	def->vertex_count = (int32_t)d.vertex_count;
	def->face_count = (int32_t)d.face_count;
	memcpy(def->origin_m, d.origin_m, sizeof d.origin_m);
	def->step_m = d.step_m;
	def->plain = d.has_plain && d.plain;
	def->stress_step_pa = d.stress_step_pa;
	slot->stream.ended = false;
	slot->gap_s = cau_client_now(); // from now on a key frame is missing
	status = make_decoder(slot, error);
	return status ? status : make_topology(&slot->stream, error);
}

static void joined(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	cau_client_slot *slot = user;
	cau_error trouble = {0};
	cau_client_answer *answer_to = slot->answer;
	if (!answer && cau_follow_join(slot->client, slot->wanted.session, &slot->client->fault))
		return;
	if (answer && take_description(slot, answer, &trouble)) {
		answer = NULL;
		error = &trouble;
	}
	// After a lost connection the client joins again by itself. A refusal ends the stream.
	if (!answer && slot->client->condition != CAU_CLIENT_LOST)
		slot->stream.ended = true;
	if (!answer && slot->client->condition == CAU_CLIENT_LOST)
		return;
	slot->answer = NULL;
	if (answer_to)
		answer_to(slot->user, answer, error);
}

// ---- joining -----------------------------------------------------------------------------------
static bool same_session(const cau_client_slot *slot, const cau_wire_session_join *params)
{
	return slot->wanted.has_session == params->has_session &&
	       strcmp(slot->wanted.session, params->session) == 0;
}

static cau_client_slot *find_slot(cau_client *client, const cau_wire_session_join *params,
                                  cau_error *error)
{
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++)
		if (client->slots[i] && same_session(client->slots[i], params))
			return client->slots[i];
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		if (client->slots[i])
			continue;
		client->slots[i] = calloc(1, sizeof *client->slots[i]);
		if (!client->slots[i]) {
			cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a stream");
			return NULL;
		}
		client->slots[i]->client = client;
		client->slots[i]->stream.state = &nothing_yet;
		return client->slots[i];
	}
	cau_fail(error, CAU_LIMIT, NULL, "a client has at most %d streams", CAU_CLIENT_STREAMS_MAX);
	return NULL;
}

cau_status cau_client_send_join(cau_client *client, const cau_wire_session_join *params,
                                cau_client_stream **stream, cau_client_answer *answer, void *user,
                                cau_error *error)
{
	cau_wire_session_join wanted = *params;
	if (wanted.has_session && strcmp(wanted.session, client->follow.from) == 0)
		memcpy(wanted.session, client->follow.to, sizeof wanted.session);
	cau_client_slot *slot = find_slot(client, &wanted, error);
	if (!slot)
		return CAU_LIMIT;
	slot->wanted = wanted;
	slot->answer = answer;
	slot->user = user;
	slot->stream.ended = false;
	*stream = &slot->stream;
	return cau_client_send(client, CAU_METHOD_SESSION_JOIN, &wanted, joined, slot, error);
}

typedef struct joining {
	bool done;
	cau_error error;
} joining;

static void note_join(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	joining *j = user;
	j->done = true;
	if (!answer)
		j->error = *error;
}

cau_status cau_client_join(cau_client *client, const cau_wire_session_join *params,
                           cau_client_stream **stream, cau_error *error)
{
	joining j = {0};
	client->fault.code = 0;
	cau_status status = cau_client_send_join(client, params, stream, note_join, &j, error);
	if (status)
		return status;
	cau_client_slot *slot = (cau_client_slot *)*stream;
	status = cau_client_await(client, CAU_METHOD_SESSION_JOIN, &j.done, slot, error);
	slot->answer = NULL;
	if (status)
		return status;
	if (j.error.status) {
		if (error)
			*error = j.error;
		return j.error.status;
	}
	double until_s = cau_client_now() + client->def.timeout_s;
	return cau_client_wait_for(client, &slot->stream.state->synced, until_s)
	           ? CAU_OK
	           : cau_fail(error, CAU_IO, NULL, "no key frame within %g s", client->def.timeout_s);
}

cau_status cau_client_leave(cau_client *client, cau_client_stream *stream, cau_error *error)
{
	cau_wire_session_ref params = {.has_session = true};
	cau_client_slot *slot = (cau_client_slot *)stream;
	snprintf(params.session, sizeof params.session, "%s", stream->description.session);
	stream->ended = true;
	slot->gap_s = 0;
	return cau_client_call(client, CAU_METHOD_SESSION_LEAVE, &params, NULL, error);
}

void cau_streams_lost(cau_client *client)
{
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++)
		if (client->slots[i])
			client->slots[i]->gap_s = 0; // the next connection asks for a key frame again
}

void cau_streams_rejoin(cau_client *client)
{
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		cau_client_slot *slot = client->slots[i];
		if (slot && !slot->stream.ended)
			cau_client_send(client, CAU_METHOD_SESSION_JOIN, &slot->wanted, joined, slot, NULL);
	}
}

void cau_streams_changed(cau_client *client, const cau_rpc_message *message)
{
	cau_wire_session_changed params = {0};
	if (cau_rpc_params(message, &params, NULL))
		return;
	if (params.change == CAU_CHANGE_MOVED)
		cau_follow_change(client, &params);
	if (params.change != CAU_CHANGE_DESTROYED)
		return;
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++)
		if (client->slots[i] &&
		    strcmp(client->slots[i]->stream.description.session, params.summary.session) == 0)
			client->slots[i]->stream.ended = true;
}
