// SPDX-License-Identifier: GPL-3.0-or-later
#include "rpc/uploads.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/sha256.h"

static int64_t charge_of(int64_t byte_count)
{
	return byte_count < CAU_UPLOAD_LEAST_BYTES ? CAU_UPLOAD_LEAST_BYTES : byte_count;
}

cau_upload *cau_uploads_find(cau_uploads *uploads, const char *name)
{
	cau_upload *upload = uploads->first;
	while (upload && strcmp(upload->name, name) != 0)
		upload = upload->next;
	return upload;
}

cau_upload *cau_uploads_find_transfer(cau_uploads *uploads, uint32_t transfer)
{
	cau_upload *upload = uploads->first;
	while (upload && upload->transfer != transfer)
		upload = upload->next;
	return upload;
}

// ---- limits
// Checks that `byte_count` more bytes are within the limits. `freed` is the size that a replaced
// upload gives back.
static cau_status check_room(const cau_uploads *uploads, const cau_upload_total *total,
                             const cau_config *config, int64_t byte_count, int64_t freed,
                             cau_error *error)
{
	static const char path[] = "params.byte_count";
	if (byte_count > config->max_upload_bytes)
		return cau_fail(error, CAU_LIMIT, path,
		                "a file holds at most %lld bytes (setting max_upload_bytes)",
		                (long long)config->max_upload_bytes);
	int64_t charge = charge_of(byte_count) - freed;
	if (charge > config->max_connection_upload_bytes - uploads->bytes)
		return cau_fail(
			error, CAU_LIMIT, path,
			"a connection's uploads hold at most %lld bytes, and %lld are held (setting "
			"max_connection_upload_bytes): discard one, or close the connection",
			(long long)config->max_connection_upload_bytes, (long long)uploads->bytes);
	if (charge > config->max_all_upload_bytes - total->bytes)
		return cau_fail(error, CAU_LIMIT, path,
		                "the uploads of all connections hold at most %lld bytes, and %lld are held "
		                "(setting max_all_upload_bytes): try again when others have ended theirs",
		                (long long)config->max_all_upload_bytes, (long long)total->bytes);
	return CAU_OK;
}

static cau_upload *make(const cau_wire_upload_begin *wanted)
{
	cau_upload *upload = calloc(1, sizeof *upload);
	if (!upload)
		return NULL;
	upload->byte_count = (size_t)wanted->byte_count;
	upload->bytes = malloc(upload->byte_count);
	if (!upload->bytes) {
		free(upload);
		return NULL;
	}
	memcpy(upload->name, wanted->name, sizeof upload->name);
	memcpy(upload->file_name, wanted->file_name, sizeof upload->file_name);
	return upload;
}

cau_status cau_uploads_begin(cau_uploads *uploads, cau_upload_total *total,
                             const cau_config *config, const cau_wire_upload_begin *wanted,
                             cau_upload **made, cau_error *error)
{
	cau_upload *replaced = cau_uploads_find(uploads, wanted->name);
	int64_t freed = replaced ? charge_of((int64_t)replaced->byte_count) : 0;
	cau_status status = check_room(uploads, total, config, wanted->byte_count, freed, error);
	if (status)
		return status;
	cau_upload *upload = make(wanted);
	if (!upload)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the upload");
	if (replaced)
		cau_uploads_drop(uploads, total, replaced);
	upload->transfer = ++uploads->last_transfer;
	upload->next = uploads->first;
	uploads->first = upload;
	uploads->bytes += charge_of(wanted->byte_count);
	total->bytes += charge_of(wanted->byte_count);
	*made = upload;
	return CAU_OK;
}

void cau_uploads_drop(cau_uploads *uploads, cau_upload_total *total, cau_upload *upload)
{
	cau_upload **at = &uploads->first;
	while (*at != upload)
		at = &(*at)->next;
	*at = upload->next;
	uploads->bytes -= charge_of((int64_t)upload->byte_count);
	total->bytes -= charge_of((int64_t)upload->byte_count);
	cau_upload_refill(upload, NULL);
	free(upload->bytes);
	free(upload);
}

void cau_upload_refill(cau_upload *upload, cau_filling *filling)
{
	if (upload->filling)
		cau_filling_cancel(upload->filling);
	cau_filling_release(upload->filling);
	upload->filling = filling;
}

void cau_uploads_drop_all(cau_uploads *uploads, cau_upload_total *total)
{
	while (uploads->first)
		cau_uploads_drop(uploads, total, uploads->first);
}

// ---- bytes
static void spoil(cau_upload *upload, const char *trouble)
{
	snprintf(upload->trouble, sizeof upload->trouble, "%s", trouble);
	free(upload->bytes);
	upload->bytes = NULL;
}

void cau_upload_take(cau_upload *upload, uint64_t offset, const void *data, size_t bytes)
{
	if (!upload->bytes)
		return;
	if (upload->complete)
		return; // upload.end has been answered, so the upload does not change any more
	if (offset != upload->received)
		spoil(upload, "a chunk came out of order");
	else if (bytes > upload->byte_count - upload->received)
		spoil(upload, "more bytes came than upload.begin announced");
	else {
		memcpy(upload->bytes + upload->received, data, bytes);
		upload->received += bytes;
	}
}

cau_status cau_upload_check(const cau_upload *upload, const char *expected, cau_error *error)
{
	char sha256[CAU_SHA256_TEXT_BYTES] = "";
	if (*upload->trouble)
		return cau_fail(error, CAU_BAD_VALUE, "params.transfer", "%s", upload->trouble);
	if (upload->received != upload->byte_count)
		return cau_fail(error, CAU_BAD_VALUE, "params.transfer",
		                "%zu bytes came of the %zu announced", upload->received,
		                upload->byte_count);
	if (!cau_sha256(upload->bytes, upload->byte_count, sha256) || strcmp(sha256, expected) != 0)
		return cau_fail(error, CAU_BAD_VALUE, "params.sha256",
		                "the SHA-256 of the received bytes is not the announced one");
	return CAU_OK;
}
