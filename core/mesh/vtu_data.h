// SPDX-License-Identifier: GPL-3.0-or-later
// Reads arrays of numbers in VTK's XML files: text, base64 or appended bytes, uncompressed or
// compressed by zlib. Format: "VTK File Formats", XML formats.
#pragma once

#include "mesh/scan.h"

// Properties that all arrays of a file share.
typedef struct cau_vtu_coding {
	cau_scan *scan;   // for failures
	int header_bytes; // bytes of each number before the data: 4 or 8
	bool swap;
	bool zlib;
	const unsigned char *appended; // data after the underscore, (appended_bytes), or NULL
	size_t appended_bytes;
	bool appended_base64;
} cau_vtu_coding;

typedef struct cau_vtu_array {
	cau_word type;   // such as "Float32"
	cau_word format; // "ascii", "binary" or "appended"
	int64_t offset;  // position in the appended data
	const unsigned char *text;
	size_t text_bytes; // bytes between the tags
} cau_vtu_array;

// Returns all numbers of an array, which the caller frees. Returns NULL if the scan has failed or
// if there are no numbers.
double *cau_vtu_numbers(const cau_vtu_coding *coding, const cau_vtu_array *array, int64_t *count);
