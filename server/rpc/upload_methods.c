// SPDX-License-Identifier: GPL-3.0-or-later
// Files in chunks: uploads in, exports out.
#include <stdlib.h>
#include <string.h>

#include "buffer/sha256.h"
#include "rpc/internal.h"

void cau_upload_finish(cau_upload *upload)
{
	free(upload->bytes);
	*upload = (cau_upload){0};
}

static cau_upload *find_transfer(cau_peer *peer, uint32_t transfer)
{
	for (int i = 0; i < UPLOADS_OF_PEER; i++)
		if (peer->uploads[i].transfer == transfer)
			return &peer->uploads[i];
	return NULL;
}

static cau_upload *find_name(cau_peer *peer, const char *name)
{
	for (int i = 0; i < UPLOADS_OF_PEER; i++)
		if (peer->uploads[i].transfer && strcmp(peer->uploads[i].name, name) == 0)
			return &peer->uploads[i];
	return NULL;
}

static cau_status begin(cau_peer *peer, const cau_wire_upload_begin *params, cau_upload **made,
                        cau_error *error)
{
	int64_t most = peer->service->config->max_upload_bytes, held = 0;
	for (int i = 0; i < UPLOADS_OF_PEER; i++)
		held += (int64_t)peer->uploads[i].byte_count;
	if (params->byte_count > most - held)
		return cau_fail(error, CAU_LIMIT, "params.byte_count",
		                "a connection's uploads hold at most %lld bytes (setting max_upload_bytes)",
		                (long long)most);
	if (find_name(peer, params->name))
		return cau_fail(error, CAU_ALREADY_EXISTS, "params.name", "an upload has this name");
	cau_upload *upload = find_transfer(peer, 0);
	if (!upload)
		return cau_fail(error, CAU_LIMIT, "", "a connection has at most %d uploads",
		                UPLOADS_OF_PEER);
	upload->bytes = malloc((size_t)params->byte_count);
	if (!upload->bytes)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the upload");
	upload->transfer = ++peer->last_transfer;
	upload->byte_count = (size_t)params->byte_count;
	memcpy(upload->name, params->name, sizeof upload->name);
	memcpy(upload->file_name, params->file_name, sizeof upload->file_name);
	*made = upload;
	return CAU_OK;
}

void cau_call_upload_begin(cau_call *call)
{
	cau_error error = {0};
	cau_wire_upload_begin params = {0};
	cau_upload *upload = NULL;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status)
		status = begin(call->peer, &params, &upload, &error);
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_wire_upload_begin_result result = {.transfer = upload->transfer,
	                                       .chunk_bytes_max = CAU_CHUNK_BYTES_MAX};
	cau_call_result(call, &result);
}

static void spoil(cau_upload *upload, const char *trouble)
{
	snprintf(upload->trouble, sizeof upload->trouble, "%s", trouble);
	free(upload->bytes);
	upload->bytes = NULL;
	upload->byte_count = 0;
}

void cau_peer_chunk(cau_peer *peer, const void *bytes, size_t byte_count)
{
	cau_chunk chunk;
	cau_status status = cau_chunk_read(bytes, byte_count, &chunk, NULL);
	if (status || !peer->greeted) {
		cau_connection_close(peer->connection,
		                     status == CAU_LIMIT ? CAU_CLOSE_TOO_BIG : CAU_CLOSE_UNSUPPORTED, NULL);
		return;
	}
	cau_upload *upload = chunk.transfer ? find_transfer(peer, chunk.transfer) : NULL;
	if (!upload || !upload->bytes)
		return; // an upload that ended; upload.end says why
	if (chunk.offset != upload->received)
		spoil(upload, "a chunk came out of order");
	else if (chunk.byte_count > upload->byte_count - upload->received)
		spoil(upload, "more bytes came than upload.begin announced");
	else {
		memcpy(upload->bytes + upload->received, chunk.data, chunk.byte_count);
		upload->received += chunk.byte_count;
	}
}

static cau_status end(cau_peer *peer, const cau_wire_upload_end *params, cau_upload **ended,
                      cau_error *error)
{
	char sha256[CAU_SHA256_TEXT_BYTES] = "";
	cau_upload *upload = find_transfer(peer, (uint32_t)params->transfer);
	*ended = upload;
	if (!upload || !params->transfer)
		return cau_fail(error, CAU_NOT_FOUND, "params.transfer", "no such upload");
	if (*upload->trouble)
		return cau_fail(error, CAU_BAD_VALUE, "params.transfer", "%s", upload->trouble);
	if (upload->received != upload->byte_count)
		return cau_fail(error, CAU_BAD_VALUE, "params.transfer",
		                "%zu bytes came of the %zu announced", upload->received,
		                upload->byte_count);
	if (!cau_sha256(upload->bytes, upload->byte_count, sha256) ||
	    strcmp(sha256, params->sha256) != 0)
		return cau_fail(error, CAU_BAD_VALUE, "params.sha256", "what came has another hash");
	upload->complete = true;
	return CAU_OK;
}

void cau_call_upload_end(cau_call *call)
{
	cau_error error = {0};
	cau_wire_upload_end params = {0};
	cau_upload *upload = NULL;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	if (!status) {
		status = end(call->peer, &params, &upload, &error);
		if (status && upload)
			cau_upload_finish(upload);
	}
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_wire_upload_result result = {.byte_count = (int64_t)upload->byte_count};
	const char *ending = strrchr(upload->file_name, '.');
	memcpy(result.name, upload->name, sizeof result.name);
	snprintf(result.file, sizeof result.file, "%s%.16s", upload->name, ending ? ending : "");
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
		const cau_upload *upload = find_name(peer, name);
		if (!upload || !upload->complete)
			return cau_fail(error, CAU_NOT_FOUND, "params.definition.meshes",
			                "no upload of this connection is named `%.48s`", name);
		mesh->bytes = upload->bytes;
		mesh->byte_count = upload->byte_count;
	}
	return CAU_OK;
}

// ---- out
bool cau_method_makes_file(cau_method method)
{
	return method == CAU_METHOD_SESSION_EXPORT || method == CAU_METHOD_SESSION_LOG;
}

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
