// SPDX-License-Identifier: GPL-3.0-or-later
// Files in chunks: uploads from clients and exports to clients.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/mesh_reading.h"
#include "rpc/internal.h"

enum { READINGS_OF_PEER = 2 };

void cau_call_upload_begin(cau_call *call)
{
	cau_error error = {0};
	cau_wire_upload_begin params = {0};
	cau_upload *upload = NULL;
	const cau_service *service = call->peer->service;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status)
		status = cau_uploads_begin(&call->peer->uploads, &call->peer->service->uploads,
		                           service->config, &params, &upload, &error);
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_wire_upload_begin_result result = {.transfer = upload->transfer,
	                                       .chunk_bytes_max = CAU_CHUNK_BYTES_MAX};
	cau_call_result(call, &result);
}

// Refuses a chunk before hello. The answer's id is null, because a chunk has no request id. Like
// other malformed messages, too many of them close the connection.
static void refuse_before_hello(cau_peer *peer)
{
	cau_rpc_fault fault;
	cau_rpc_fault_of_code(&fault, CAU_RPC_HELLO_REQUIRED, "the first message must be hello");
	cau_peer_fault(peer, &(cau_rpc_id){.kind = CAU_RPC_ID_NONE}, &fault);
	cau_peer_malformed(peer);
}

void cau_peer_chunk(cau_peer *peer, const void *bytes, size_t byte_count)
{
	cau_chunk chunk;
	if (!peer->greeted) {
		refuse_before_hello(peer);
		return;
	}
	cau_status status = cau_chunk_read(bytes, byte_count, &chunk, NULL);
	if (status) {
		cau_connection_close(peer->connection,
		                     status == CAU_LIMIT ? CAU_CLOSE_TOO_BIG : CAU_CLOSE_UNSUPPORTED, NULL);
		return;
	}
	cau_upload *upload = cau_uploads_find_transfer(&peer->uploads, chunk.transfer);
	if (upload) // an upload that is not found was discarded or replaced meanwhile
		cau_upload_take(upload, chunk.offset, chunk.data, chunk.byte_count);
}

// Makes the name for `file` of a mesh of source bytes: the upload's name with the file's extension.
static void name_upload(const cau_upload *upload, char *name, size_t bytes)
{
	const char *ending = strrchr(upload->file_name, '.');
	snprintf(name, bytes, "%s%.16s", upload->name, ending ? ending : "");
}

// Ends an upload. If the upload fails the check, it is dropped, and the client must begin the
// upload again.
static cau_status end(cau_peer *peer, const cau_wire_upload_end *params, cau_upload **ended,
                      cau_error *error)
{
	cau_upload *upload = cau_uploads_find_transfer(&peer->uploads, (uint32_t)params->transfer);
	if (!upload)
		return cau_fail(error, CAU_NOT_FOUND, "params.transfer",
		                "this connection has no complete upload of this name");
	cau_status status = cau_upload_check(upload, params->sha256, error);
	upload->complete = !status;
	*ended = upload;
	if (status)
		cau_uploads_drop(&peer->uploads, &peer->service->uploads, upload);
	return status;
}

void cau_call_upload_end(cau_call *call)
{
	cau_error error = {0};
	cau_wire_upload_end params = {0};
	cau_upload *upload = NULL;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status)
		status = end(call->peer, &params, &upload, &error);
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_wire_upload_result result = {.byte_count = (int64_t)upload->byte_count};
	memcpy(result.name, upload->name, sizeof result.name);
	name_upload(upload, result.file, sizeof result.file);
	cau_call_result(call, &result);
}

// Counts the connection's readings that run or wait, because each may take a builder thread for a
// long time.
static int readings_of(const cau_uploads *uploads, const cau_upload *but)
{
	int count = 0;
	for (const cau_upload *upload = uploads->first; upload; upload = upload->next)
		count += upload != but && upload->filling && !cau_filling_has_ended(upload->filling);
	return count;
}

static cau_status check_wish(const cau_wire_mesh_read *params, const cau_uploads *uploads,
                             const cau_upload *upload, cau_error *error)
{
	if (!upload || !upload->complete)
		return cau_fail(error, CAU_NOT_FOUND, "params.upload",
		                "no upload of this connection is named `%.48s`", params->upload);
	if (params->has_as && params->as != CAU_LAYER_FAT && params->as != CAU_LAYER_FASCIA)
		return cau_fail(error, CAU_BAD_VALUE, "params.as", "must be fat or fascia");
	if (readings_of(uploads, upload) >= READINGS_OF_PEER)
		return cau_fail(
			error, CAU_LIMIT, "",
			"%d meshes of this connection are being read: wait for an answer, or discard "
			"an upload",
			READINGS_OF_PEER);
	return CAU_OK;
}

static void fill_asked(const cau_wire_mesh_read *params, const cau_upload *upload,
                       const cau_config *config, cau_mesh_asked *asked)
{
	asked->unit_m = params->has_unit_m ? params->unit_m : 0;
	asked->layer_kind = params->has_as ? (int)params->as : -1;
	asked->strict = params->strict;
	asked->as_it_is = params->as_it_is;
	asked->edge_m = params->has_edge_m ? params->edge_m : 0;
	snprintf(asked->labels, sizeof asked->labels, "%s", params->has_labels ? params->labels : "");
	snprintf(asked->pin, sizeof asked->pin, "%s", params->has_pin ? params->pin : "");
	memcpy(asked->file_name, upload->file_name, sizeof asked->file_name);
	name_upload(upload, asked->upload, sizeof asked->upload);
	asked->memory_mb = config->mesh_memory_mb;
	asked->time_s = config->mesh_time_s;
	asked->most_bytes = config->max_upload_bytes;
}

static cau_status ask_for_mesh(cau_call *call, const cau_wire_mesh_read *params, cau_error *error)
{
	cau_peer *peer = call->peer;
	cau_upload *upload = cau_uploads_find(&peer->uploads, params->upload);
	cau_reply reply = cau_call_reply(call);
	cau_mesh_asked asked = {0};
	cau_status status = check_wish(params, &peer->uploads, upload, error);
	if (status)
		return status;
	fill_asked(params, upload, peer->service->config, &asked);
	asked.bytes = malloc(upload->byte_count);
	asked.filling = cau_filling_create();
	if (!asked.bytes || !asked.filling) {
		free(asked.bytes);
		cau_filling_release(asked.filling);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a mesh");
	}
	// a copy, because the upload may be discarded meanwhile
	memcpy(asked.bytes, upload->bytes, upload->byte_count);
	asked.byte_count = upload->byte_count;
	cau_upload_refill(upload, cau_filling_share(asked.filling));
	return cau_mesh_ask(peer->service->builder, &asked, &reply, error);
}

void cau_call_mesh_read(cau_call *call)
{
	cau_error error = {0};
	cau_wire_mesh_read params = {0};
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status)
		status = ask_for_mesh(call, &params, &error);
	if (status)
		cau_call_fail(call, &error, 0);
}

void cau_call_upload_discard(cau_call *call)
{
	cau_error error = {0};
	cau_wire_upload_discard params = {0};
	cau_wire_nothing result = {0};
	cau_peer *peer = call->peer;
	cau_upload *upload = NULL;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status) {
		upload = cau_uploads_find(&peer->uploads, params.name);
		if (!upload)
			status = cau_fail(&error, CAU_NOT_FOUND, "params.name",
			                  "no upload of this connection is named `%.48s`", params.name);
	}
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_uploads_drop(&peer->uploads, &peer->service->uploads, upload);
	cau_call_result(call, &result);
}

cau_status cau_peer_fill_meshes(cau_peer *peer, cau_scene_def *scene, cau_error *error)
{
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		char name[CAU_NAME_BYTES];
		if (mesh->source != CAU_MESH_BYTES)
			continue;
		snprintf(name, sizeof name, "%.*s", (int)strcspn(mesh->file, "."), mesh->file);
		const cau_upload *upload = cau_uploads_find(&peer->uploads, name);
		if (!upload || !upload->complete)
			return cau_fail(error, CAU_NOT_FOUND, "params.definition.meshes",
			                "no upload of this connection is named `%.48s`", name);
		mesh->bytes = upload->bytes;
		mesh->byte_count = upload->byte_count;
		if (upload->filling) // the filling gives the solid inside the surface, once it is ready
			cau_filling_solid(upload->filling, &mesh->bytes, &mesh->byte_count);
	}
	return CAU_OK;
}

// ---- exports to clients
bool cau_peer_has_room_for_file(const cau_peer *peer)
{
	int under_way = peer->files_asked;
	for (int i = 0; i < FILES_OF_PEER; i++)
		under_way += peer->files[i].file != NULL;
	return under_way < FILES_OF_PEER;
}

cau_buffer *cau_peer_next_chunk(cau_peer *peer)
{
	for (int i = 0; i < FILES_OF_PEER; i++) {
		cau_outgoing *out = &peer->files[i];
		if (!out->file)
			continue;
		size_t left = out->file->byte_count - out->sent;
		cau_chunk chunk = {.transfer = out->transfer,
		                   .offset = out->sent,
		                   .data = cau_buffer_bytes(out->file) + out->sent,
		                   .byte_count = left < CAU_CHUNK_BYTES_MAX ? left : CAU_CHUNK_BYTES_MAX};
		cau_buffer *buffer =
			left ? cau_buffer_create(CAU_CHUNK_HEADER_BYTES + chunk.byte_count, true) : NULL;
		if (buffer) {
			cau_chunk_header_write(cau_buffer_bytes(buffer), &chunk);
			memcpy(cau_buffer_bytes(buffer) + CAU_CHUNK_HEADER_BYTES, chunk.data, chunk.byte_count);
			out->sent += chunk.byte_count;
		}
		if (!buffer || out->sent == out->file->byte_count) {
			cau_buffer_release(out->file);
			*out = (cau_outgoing){0};
		}
		if (buffer)
			return buffer;
	}
	return NULL;
}
