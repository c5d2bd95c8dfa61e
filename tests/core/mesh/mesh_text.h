// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files that a test makes: text, or bytes that are appended number by number.
#pragma once

#include "mesh_fixture.h"

static inline cau_status read_text(const char *name, const char *text, cau_mesh *mesh,
                                   cau_error *error)
{
	*error = (cau_error){0};
	return cau_mesh_read(name, text, strlen(text), mesh, NULL, error);
}

// Expects that the text is refused with this status, and that the reason contains `part`.
static inline void refuse_text(const char *name, const char *text, cau_status status,
                               const char *part)
{
	cau_mesh mesh;
	cau_error error;
	cau_status got = read_text(name, text, &mesh, &error);
	if (got != status || !strstr(error.reason, part))
		fail_msg("'%s' gave %s: %s", text, cau_status_name(got), error.reason);
	assert_null(mesh.position);
	cau_mesh_finish(&mesh);
}

// Reads every beginning of the file. Expects that each beginning shorter than `least` bytes is
// refused, and that no beginning crashes the reader. The bytes are copied so that a sanitizer finds
// a read past their end.
static inline void refuse_beginnings(const char *name, const void *bytes, size_t byte_count,
                                     size_t least)
{
	for (size_t count = 0; count < byte_count; count++) {
		void *part = malloc(count ? count : 1);
		assert_non_null(part);
		memcpy(part, bytes, count);
		cau_mesh mesh;
		cau_error error = {0};
		cau_status status = cau_mesh_read(name, part, count, &mesh, NULL, &error);
		if (count < least && (status == CAU_OK || !error.reason[0]))
			fail_msg("%zu of %zu bytes gave %s", count, byte_count, cau_status_name(status));
		cau_mesh_finish(&mesh);
		free(part);
	}
}

typedef struct byte_file {
	unsigned char bytes[4096];
	size_t count;
	int turned; // numbers have the other byte order than this machine
} byte_file;

static inline void put_text(byte_file *file, const char *text)
{
	assert_true(file->count + strlen(text) <= sizeof file->bytes);
	memcpy(file->bytes + file->count, text, strlen(text));
	file->count += strlen(text);
}

static inline void put_number(byte_file *file, const void *number, size_t bytes)
{
	assert_true(file->count + bytes <= sizeof file->bytes);
	unsigned char given[8];
	assert_true(bytes <= sizeof given);
	memcpy(given, number, bytes);
	for (size_t i = 0; i < bytes; i++)
		file->bytes[file->count++] = given[file->turned ? bytes - 1 - i : i];
}

static inline void put_ints(byte_file *file, const int32_t *number, size_t count)
{
	for (size_t i = 0; i < count; i++)
		put_number(file, number + i, sizeof *number);
}

// Appends numbers of 4 or 8 bytes.
static inline void put_sizes(byte_file *file, size_t bytes, const int64_t *number, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		int32_t small = (int32_t)number[i];
		put_number(file, bytes == 8 ? (const void *)(number + i) : &small, bytes);
	}
}

static inline void put_doubles(byte_file *file, const double *number, size_t count)
{
	for (size_t i = 0; i < count; i++)
		put_number(file, number + i, sizeof *number);
}

static inline cau_status read_bytes(const char *name, const byte_file *file, cau_mesh *mesh,
                                    cau_error *error)
{
	*error = (cau_error){0};
	return cau_mesh_read(name, file->bytes, file->count, mesh, NULL, error);
}

#define PUT_INTS(file, ...)                                                                        \
	put_ints(file, (const int32_t[]){__VA_ARGS__},                                                 \
	         sizeof((const int32_t[]){__VA_ARGS__}) / sizeof(int32_t))
#define PUT_SIZES(file, bytes, ...)                                                                \
	put_sizes(file, bytes, (const int64_t[]){__VA_ARGS__},                                         \
	          sizeof((const int64_t[]){__VA_ARGS__}) / sizeof(int64_t))
#define PUT_DOUBLES(file, ...)                                                                     \
	put_doubles(file, (const double[]){__VA_ARGS__},                                               \
	            sizeof((const double[]){__VA_ARGS__}) / sizeof(double))
