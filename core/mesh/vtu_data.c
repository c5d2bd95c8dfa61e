// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/vtk.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

enum {
	DEFLATE_RATIO_MAX = 1032,    // largest factor by which a zlib stream grows
	DATA_BYTES_MAX = 1 << 30,    // most bytes of one array
	NUMBER_TEXT_BYTES_LEAST = 2, // least bytes of a number as text: a digit and a blank
};

typedef struct bytes {
	unsigned char *data; // (count)
	size_t count;
} bytes;

static void fail_memory(const cau_vtu_coding *coding, size_t count)
{
	cau_scan_fail(coding->scan, CAU_NO_MEMORY, "no memory for %zu bytes", count);
}

// ---- base64
static int digit_of(unsigned char byte)
{
	if (byte >= 'A' && byte <= 'Z')
		return byte - 'A';
	if (byte >= 'a' && byte <= 'z')
		return byte - 'a' + 26;
	if (byte >= '0' && byte <= '9')
		return byte - '0' + 52;
	return byte == '+' ? 62 : byte == '/' ? 63 : -1;
}

// Decodes base64 until a byte that is not base64. Groups may end with padding anywhere, because
// header and data are often encoded separately.
static bytes decode_base64(const cau_vtu_coding *coding, const unsigned char *text, size_t length)
{
	bytes out = {cau_mesh_array(length / 4 * 3 + 3, 1), 0};
	uint32_t group = 0;
	int digits = 0, padding = 0;
	if (!out.data)
		fail_memory(coding, length);
	for (size_t i = 0; i < length && out.data; i++) {
		int digit = text[i] == '=' ? 0 : digit_of(text[i]);
		if (text[i] == ' ' || (text[i] >= 9 && text[i] <= 13))
			continue;
		if (digit < 0)
			break;
		padding += text[i] == '=';
		group = group << 6 | (uint32_t)digit;
		if (++digits < 4)
			continue;
		for (int b = 0; b < 3 - (padding < 3 ? padding : 2); b++)
			out.data[out.count++] = (unsigned char)(group >> (16 - 8 * b));
		group = 0;
		digits = padding = 0;
	}
	return out;
}

// ---- header and blocks
static uint64_t read_header(const cau_vtu_coding *coding, const bytes *from, size_t index)
{
	uint64_t value = 0;
	size_t width = (size_t)coding->header_bytes, at = index * width;
	if (at + width > from->count) {
		cau_scan_fail(coding->scan, CAU_BAD_SYNTAX, "an array ends within its header");
		return 0;
	}
	bool little = (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) != coding->swap;
	for (size_t b = 0; b < width; b++)
		value = value << 8 | from->data[at + (little ? width - 1 - b : b)];
	return value;
}

static bytes copy_plain(const cau_vtu_coding *coding, const bytes *from)
{
	bytes out = {0};
	uint64_t count = read_header(coding, from, 0);
	size_t width = (size_t)coding->header_bytes;
	if (coding->scan->status)
		return out;
	if (count > from->count - width) {
		cau_scan_fail(coding->scan, CAU_BAD_SYNTAX,
		              "an array has %llu bytes, but only %zu bytes follow",
		              (unsigned long long)count, from->count - width);
		return out;
	}
	out.data = cau_mesh_array((size_t)count, 1);
	if (!out.data)
		fail_memory(coding, (size_t)count);
	else if (count)
		memcpy(out.data, from->data + width, (size_t)count);
	out.count = out.data ? (size_t)count : 0;
	return out;
}

// Decompresses blocks. The data are: number of blocks, bytes of a block, bytes of the last block if
// it is shorter (else 0), compressed bytes of each block; then the blocks.
static bytes inflate_blocks(const cau_vtu_coding *coding, const bytes *from)
{
	bytes out = {0};
	uint64_t blocks = read_header(coding, from, 0), whole = 0, last = 0;
	if (blocks) {
		whole = read_header(coding, from, 1);
		last = read_header(coding, from, 2);
	}
	size_t width = (size_t)coding->header_bytes;
	bool fits = blocks <= from->count / width && whole <= DATA_BYTES_MAX && last <= whole &&
	            blocks * whole <= (uint64_t)DEFLATE_RATIO_MAX * from->count + 64 &&
	            blocks * whole <= DATA_BYTES_MAX;
	if (!coding->scan->status && !fits)
		cau_scan_fail(coding->scan, CAU_BAD_SYNTAX, "%llu compressed blocks of %llu bytes",
		              (unsigned long long)blocks, (unsigned long long)whole);
	if (coding->scan->status)
		return out;
	out.data = cau_mesh_array((size_t)(blocks * whole), 1);
	if (!out.data)
		fail_memory(coding, (size_t)(blocks * whole));
	size_t at = (3 + (size_t)blocks) * width;
	for (uint64_t b = 0; b < blocks && !coding->scan->status; b++) {
		uint64_t packed = read_header(coding, from, 3 + (size_t)b);
		uLongf wanted = (uLongf)(b == blocks - 1 && last ? last : whole);
		uLongf got = wanted;
		if (coding->scan->status)
			break;
		if (at > from->count || packed > from->count - at ||
		    uncompress(out.data + out.count, &got, from->data + at, (uLong)packed) != Z_OK ||
		    got != wanted)
			cau_scan_fail(coding->scan, CAU_BAD_SYNTAX, "a compressed block is damaged");
		out.count += wanted;
		at += (size_t)packed;
	}
	return out;
}

// Returns the decoded bytes of an array's numbers.
static bytes take_bytes(const cau_vtu_coding *coding, const cau_vtu_array *array)
{
	bool appended = cau_word_is(array->format, "appended");
	bytes coded = {0}, out = {0};
	const unsigned char *from = appended ? coding->appended : array->text;
	size_t left = appended ? coding->appended_bytes : array->text_bytes;
	if (appended && (!from || array->offset < 0 || (uint64_t)array->offset > left)) {
		cau_scan_fail(coding->scan, CAU_BAD_SYNTAX, "no appended data at offset %lld",
		              (long long)array->offset);
		return out;
	}
	if (appended) {
		from += array->offset;
		left -= (size_t)array->offset;
	}
	bool base64 = !appended || coding->appended_base64;
	if (base64)
		coded = decode_base64(coding, from, left);
	else
		coded = (bytes){(unsigned char *)from, left}; // the bytes are only read
	if (!coding->scan->status)
		out = coding->zlib ? inflate_blocks(coding, &coded) : copy_plain(coding, &coded);
	if (base64)
		free(coded.data);
	return out;
}

// ---- numbers
static const struct {
	const char *name;
	int bytes;
	bool real, is_signed;
} types[] = {{"Float64", 8, true, true},  {"Float32", 4, true, true}, {"Int64", 8, false, true},
             {"Int32", 4, false, true},   {"UInt8", 1, false, false}, {"Int8", 1, false, true},
             {"UInt16", 2, false, false}, {"Int16", 2, false, true},  {"UInt32", 4, false, false},
             {"UInt64", 8, false, false}};

static double *read_text(const cau_vtu_coding *coding, const cau_vtu_array *array, int64_t *count)
{
	size_t capacity = array->text_bytes / NUMBER_TEXT_BYTES_LEAST + 1;
	double *number = cau_mesh_array(capacity, sizeof *number);
	cau_scan scan = *coding->scan; // a copy of the file's scan, so that messages count lines from
	                               // the start of the file
	scan.at = (size_t)(array->text - scan.bytes);
	scan.count = scan.at + array->text_bytes;
	if (!number)
		fail_memory(coding, capacity * sizeof *number);
	*count = 0;
	while (number && !scan.status) {
		cau_word word = cau_scan_word(&scan);
		if (!word.length)
			break;
		number[(*count)++] = cau_scan_word_real(&scan, word, "a number");
	}
	coding->scan->status = scan.status;
	return number;
}

static double *convert(const cau_vtu_coding *coding, const bytes *from, int type, int64_t *count)
{
	cau_scan scan = cau_scan_make(from->data, from->count, NULL);
	scan.binary = true;
	scan.swap = coding->swap;
	size_t width = (size_t)types[type].bytes;
	*count = (int64_t)(from->count / width);
	double *number = cau_mesh_array((size_t)*count, sizeof *number);
	if (!number)
		fail_memory(coding, (size_t)*count * sizeof *number);
	for (int64_t i = 0; i < *count && number; i++) {
		if (types[type].real) {
			number[i] = cau_scan_real(&scan, "a number", types[type].bytes);
			continue;
		}
		number[i] =
			(double)cau_scan_integer(&scan, "a number", types[type].bytes, INT64_MIN, INT64_MAX);
		if (!types[type].is_signed && number[i] < 0)
			number[i] += (double)((uint64_t)1 << (8 * width - 1)) * 2;
	}
	return number;
}

double *cau_vtu_numbers(const cau_vtu_coding *coding, const cau_vtu_array *array, int64_t *count)
{
	CAU_ASSERT(coding->header_bytes == 4 || coding->header_bytes == 8, "headers of %d bytes",
	           coding->header_bytes);
	*count = 0;
	if (coding->scan->status)
		return NULL;
	if (cau_word_is(array->format, "ascii"))
		return read_text(coding, array, count);
	for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
		if (!cau_word_is(array->type, types[i].name))
			continue;
		bytes data = take_bytes(coding, array);
		double *number = coding->scan->status ? NULL : convert(coding, &data, (int)i, count);
		free(data.data);
		return number;
	}
	cau_scan_fail(coding->scan, CAU_UNSUPPORTED, "an array of numbers of unknown type");
	return NULL;
}
