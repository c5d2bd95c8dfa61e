// SPDX-License-Identifier: GPL-3.0-or-later
// Tests uploads and downloads of files.
#include "cautery/chunk_codec.h"
#include "cautery/sha256.h"
#include "clients/library/fixture.h"

// The file has several chunks, because the script uses chunks of 100,000 bytes.
enum { FILE_BYTES = 700000, TRANSFER = 12 };

typedef struct filing {
	unsigned char *file;
	unsigned char *received;
	uint64_t received_bytes;
	bool in_order;
	char sha256[65];   // hash from upload.end
	bool lie, shuffle; // test cases: a wrong hash, chunks out of order
} filing;

static void filing_begin(filing *f)
{
	*f = (filing){.file = malloc(FILE_BYTES), .received = malloc(FILE_BYTES), .in_order = true};
	for (int i = 0; i < FILE_BYTES; i++)
		f->file[i] = (unsigned char)(i * 31 + i / 251);
}

static void filing_end(filing *f)
{
	free(f->file);
	free(f->received);
}

// ---- upload ------------------------------------------------------------------------------------
static bool take_upload(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	filing *f = scripted_user(peer);
	cau_wire_upload_end end = {0};
	(void)text;
	switch (message->method) {
	case CAU_METHOD_UPLOAD_BEGIN:
		scripted_result(
			peer, message, CAU_METHOD_UPLOAD_BEGIN,
			&(cau_wire_upload_begin_result){.transfer = TRANSFER, .chunk_bytes_max = 100000});
		return true;
	case CAU_METHOD_UPLOAD_END:
		cau_rpc_params(message, &end, NULL);
		memcpy(f->sha256, end.sha256, sizeof f->sha256);
		scripted_result(peer, message, CAU_METHOD_UPLOAD_END,
		                &(cau_wire_upload_result){.name = "knee",
		                                          .file = "knee.msh",
		                                          .byte_count = (int64_t)f->received_bytes});
		return true;
	default:
		return false;
	}
}

static void take_chunk(scripted_peer *peer, const void *bytes, size_t byte_count)
{
	filing *f = scripted_user(peer);
	cau_chunk chunk;
	assert_int_equal(cau_chunk_read(bytes, byte_count, &chunk, NULL), CAU_OK);
	assert_int_equal(chunk.transfer, TRANSFER);
	assert_true(chunk.byte_count <= 100000);
	f->in_order = f->in_order && chunk.offset == f->received_bytes;
	if (!f->in_order || f->received_bytes + chunk.byte_count > FILE_BYTES)
		return;
	memcpy(f->received + f->received_bytes, chunk.data, chunk.byte_count);
	f->received_bytes += chunk.byte_count;
}

static void note_progress(void *user, uint64_t done, uint64_t total)
{
	uint64_t *last = user;
	assert_true(done >= *last && done <= total);
	*last = done;
}

static void an_upload_arrives_whole(void **state)
{
	(void)state;
	fixture f;
	filing files;
	uint64_t progress = 0;
	char hash[65];
	cau_wire_upload_result result = {0};
	filing_begin(&files);
	fixture_begin(&f, &(scripted_script){take_upload, take_chunk, &files});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_int_equal(cau_client_upload(f.client, "knee", "knee.msh", files.file, FILE_BYTES,
	                                   note_progress, &progress, &result, &f.error),
	                 CAU_OK);
	assert_string_equal(result.file, "knee.msh");
	assert_int_equal(progress, FILE_BYTES);
	fixture_end(&f);
	assert_true(files.in_order);
	assert_int_equal(files.received_bytes, FILE_BYTES);
	assert_memory_equal(files.received, files.file, FILE_BYTES);
	assert_true(cau_sha256(files.file, FILE_BYTES, hash));
	assert_string_equal(files.sha256, hash);
	filing_end(&files);
}

static void the_hash_is_sha_256(void **state)
{
	(void)state;
	char hash[65];
	assert_true(cau_sha256("abc", 3, hash)); // FIPS 180-4, first example
	assert_string_equal(hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

// ---- download ----------------------------------------------------------------------------------
static void send_chunk(scripted_peer *peer, const filing *f, uint64_t offset, size_t bytes)
{
	unsigned char *message = malloc(CAU_CHUNK_HEADER_BYTES + bytes);
	cau_chunk chunk = {.transfer = TRANSFER, .offset = offset};
	cau_chunk_header_write(message, &chunk);
	memcpy(message + CAU_CHUNK_HEADER_BYTES, f->file + offset, bytes);
	scripted_send(peer, true, message, CAU_CHUNK_HEADER_BYTES + bytes);
	free(message);
}

static bool send_export(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	filing *f = scripted_user(peer);
	(void)text;
	if (message->method != CAU_METHOD_SESSION_EXPORT)
		return false;
	cau_wire_transfer transfer = {.transfer = TRANSFER,
	                              .file_name = "t1.obj",
	                              .media_type = "model/obj",
	                              .byte_count = FILE_BYTES};
	cau_sha256(f->file, FILE_BYTES - f->lie, transfer.sha256);
	scripted_result(peer, message, CAU_METHOD_SESSION_EXPORT, &transfer);
	if (f->shuffle)
		send_chunk(peer, f, 200000, 100000);
	for (uint64_t at = 0; at < FILE_BYTES; at += 100000)
		send_chunk(peer, f, at, 100000);
	return true;
}

static cau_status download(filing *files, uint64_t *progress, unsigned char **bytes)
{
	fixture f;
	cau_wire_transfer transfer = {0};
	cau_wire_session_export params = {.format = CAU_EXPORT_OBJ};
	fixture_begin(&f, &(scripted_script){.text = send_export, .user = files});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_status status = cau_client_download(f.client, CAU_METHOD_SESSION_EXPORT, &params,
	                                        note_progress, progress, &transfer, bytes, &f.error);
	fixture_end(&f);
	return status;
}

static void a_download_is_checked(void **state)
{
	(void)state;
	filing files;
	uint64_t progress = 0;
	unsigned char *bytes = NULL;
	filing_begin(&files);
	assert_int_equal(download(&files, &progress, &bytes), CAU_OK);
	assert_memory_equal(bytes, files.file, FILE_BYTES);
	assert_int_equal(progress, FILE_BYTES);
	free(bytes);
	files.lie = true;
	progress = 0;
	assert_int_equal(download(&files, &progress, &bytes), CAU_CORRUPT);
	assert_null(bytes);
	files.lie = false;
	files.shuffle = true;
	progress = 0;
	assert_int_equal(download(&files, &progress, &bytes), CAU_CORRUPT);
	assert_null(bytes);
	filing_end(&files);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_upload_arrives_whole),
		cmocka_unit_test(the_hash_is_sha_256),
		cmocka_unit_test(a_download_is_checked),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
