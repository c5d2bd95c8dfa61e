// SPDX-License-Identifier: Apache-2.0
// Transfers files to and from the server in chunks.
#include <stdlib.h>
#include <string.h>

#include "cautery/chunk_codec.h"
#include "cautery/sha256.h"
#include "library/internal.h"

enum { QUEUED_MAX = 1 << 20 }; // largest number of bytes that an upload keeps in the outbox

// ---- upload ------------------------------------------------------------------------------------
// Waits until the outbox has at most `most` bytes.
static cau_status wait_for_room(cau_client *client, size_t most, cau_error *error)
{
	double until_s = cau_client_now() + client->def.timeout_s;
	for (double now_s; client->wsi && client->outbox.byte_count > most;) {
		now_s = cau_client_now();
		if (now_s >= until_s)
			return cau_fail(error, CAU_IO, NULL, "the server accepted no data for %g s",
			                client->def.timeout_s);
		cau_loop_wait(client->loop, until_s - now_s);
	}
	return client->wsi ? CAU_OK : cau_fail(error, CAU_IO, NULL, "the connection was lost");
}

static cau_status send_chunks(cau_client *client, const cau_wire_upload_begin_result *begun,
                              const void *bytes, size_t byte_count, cau_client_progress *progress,
                              void *user, cau_error *error)
{
	size_t most = begun->chunk_bytes_max < CAU_CHUNK_BYTES_MAX ? (size_t)begun->chunk_bytes_max
	                                                           : (size_t)CAU_CHUNK_BYTES_MAX;
	for (size_t sent = 0; sent < byte_count;) {
		uint8_t header[CAU_CHUNK_HEADER_BYTES];
		cau_chunk chunk = {.transfer = (uint32_t)begun->transfer,
		                   .offset = sent,
		                   .data = (const unsigned char *)bytes + sent,
		                   .byte_count = byte_count - sent < most ? byte_count - sent : most};
		cau_status status = wait_for_room(client, QUEUED_MAX, error);
		cau_chunk_header_write(header, &chunk);
		if (!status)
			status = cau_socket_send(client, true, header, sizeof header, chunk.data,
			                         chunk.byte_count, error);
		if (status)
			return status;
		sent += chunk.byte_count;
		size_t queued = client->outbox.byte_count < sent ? client->outbox.byte_count : sent;
		if (progress)
			progress(user, sent - queued, byte_count);
	}
	return wait_for_room(client, 0, error);
}

cau_status cau_client_upload(cau_client *client, const char *name, const char *file_name,
                             const void *bytes, size_t byte_count, cau_client_progress *progress,
                             void *user, cau_wire_upload_result *result, cau_error *error)
{
	cau_wire_upload_begin begin = {.byte_count = (int64_t)byte_count};
	cau_wire_upload_begin_result begun = {0};
	cau_wire_upload_end end = {0};
	snprintf(begin.name, sizeof begin.name, "%s", name);
	snprintf(begin.file_name, sizeof begin.file_name, "%s", file_name);
	if (!cau_sha256(bytes, byte_count, end.sha256))
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "SHA-256 is not available");
	cau_status status = cau_client_call(client, CAU_METHOD_UPLOAD_BEGIN, &begin, &begun, error);
	if (!status)
		status = send_chunks(client, &begun, bytes, byte_count, progress, user, error);
	end.transfer = begun.transfer;
	if (!status)
		status = cau_client_call(client, CAU_METHOD_UPLOAD_END, &end, result, error);
	if (!status && progress)
		progress(user, byte_count, byte_count);
	return status;
}

cau_status cau_client_discard_upload(cau_client *client, const char *name, cau_error *error)
{
	cau_wire_upload_discard params = {0};
	snprintf(params.name, sizeof params.name, "%s", name);
	return cau_client_call(client, CAU_METHOD_UPLOAD_DISCARD, &params, NULL, error);
}

// ---- download ----------------------------------------------------------------------------------
typedef struct downloading {
	cau_client_incoming incoming;
	cau_method method;
	cau_wire_transfer *transfer;
	bool answered;
	cau_error error;
} downloading;

// Allocates memory for the file. The first chunk may arrive directly after the answer.
static void announced(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	downloading *d = user;
	d->answered = true;
	if (!answer) {
		d->error = *error;
		return;
	}
	if (cau_rpc_result(answer, d->method, d->transfer, &d->error))
		return;
	if (d->transfer->byte_count > CAU_CLIENT_BINARY_MAX) {
		cau_fail(&d->error, CAU_LIMIT, NULL, "a file of %lld bytes is above the limit of %lld",
		         (long long)d->transfer->byte_count, (long long)CAU_CLIENT_BINARY_MAX);
		return;
	}
	d->incoming.byte_count = (size_t)d->transfer->byte_count;
	d->incoming.bytes = malloc(d->incoming.byte_count + 1);
	if (d->incoming.bytes)
		d->incoming.transfer = d->transfer->transfer;
	else
		cau_fail(&d->error, CAU_NO_MEMORY, NULL, "no memory for the file");
}

void cau_chunk_received(cau_client *client, const void *bytes, size_t byte_count)
{
	cau_chunk chunk;
	cau_client_incoming *incoming = client->incoming;
	if (!incoming || cau_chunk_read(bytes, byte_count, &chunk, NULL) ||
	    chunk.transfer != incoming->transfer)
		return; // the chunk belongs to no download, or to an abandoned one
	if (chunk.offset != incoming->received ||
	    chunk.byte_count > incoming->byte_count - incoming->received) {
		incoming->broken = true;
		return;
	}
	memcpy(incoming->bytes + incoming->received, chunk.data, chunk.byte_count);
	incoming->received += chunk.byte_count;
}

// Waits for the chunks. The timeout starts again with each chunk.
static cau_status receive(cau_client *client, downloading *d, cau_client_progress *progress,
                          void *user, cau_error *error)
{
	cau_client_incoming *incoming = &d->incoming;
	double until_s = cau_client_now() + client->def.timeout_s;
	for (size_t before = 0; incoming->received < incoming->byte_count && !incoming->broken;) {
		double now_s = cau_client_now();
		if (!client->wsi || now_s >= until_s)
			return cau_fail(error, CAU_IO, NULL, "the file stopped after %zu of %zu bytes",
			                incoming->received, incoming->byte_count);
		cau_loop_wait(client->loop, until_s - now_s);
		if (incoming->received == before)
			continue;
		before = incoming->received;
		until_s = cau_client_now() + client->def.timeout_s;
		if (progress)
			progress(user, before, incoming->byte_count);
	}
	return CAU_OK;
}

static cau_status check(const downloading *d, cau_error *error)
{
	char hash[CAU_SHA256_TEXT_BYTES] = "";
	if (d->incoming.broken)
		return cau_fail(error, CAU_CORRUPT, NULL, "chunks of the file came out of order");
	if (!cau_sha256(d->incoming.bytes, d->incoming.byte_count, hash))
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "SHA-256 is not available");
	if (strcmp(hash, d->transfer->sha256) != 0)
		return cau_fail(error, CAU_CORRUPT, NULL, "the file does not have the announced hash");
	return CAU_OK;
}

cau_status cau_client_download(cau_client *client, cau_method method, const void *params,
                               cau_client_progress *progress, void *user,
                               cau_wire_transfer *transfer, unsigned char **bytes, cau_error *error)
{
	downloading d = {.method = method, .transfer = transfer};
	*bytes = NULL;
	client->fault.code = 0;
	client->incoming = &d.incoming;
	cau_status status = cau_client_send(client, method, params, announced, &d, error);
	if (!status)
		status = cau_client_await(client, method, &d.answered, &d, error);
	if (!status && d.error.status) {
		status = d.error.status;
		if (error)
			*error = d.error;
	}
	if (!status)
		status = receive(client, &d, progress, user, error);
	if (!status)
		status = check(&d, error);
	client->incoming = NULL;
	if (status)
		free(d.incoming.bytes);
	else
		*bytes = d.incoming.bytes;
	return status;
}
