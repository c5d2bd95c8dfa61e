// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays of numbers in VTK's XML files: text, base64 or appended bytes, as they are or compressed
// by zlib. Format: "VTK File Formats", XML formats.
#pragma once

#include "mesh/scan.h"

// What the file says of all its arrays.
typedef struct cau_vtu_coding {
	cau_scan *scan;   // for failures
	int header_bytes; // of the numbers before the data: 4 or 8
	bool swap;
	bool zlib;
	const unsigned char *appended; // behind the underscore, (appended_bytes); NULL: none
	size_t appended_bytes;
	bool appended_base64;
} cau_vtu_coding;

typedef struct cau_vtu_array {
	cau_word type;   // "Float32"
	cau_word format; // "ascii", "binary", "appended"
	int64_t offset;  // of appended data
	const unsigned char *text;
	size_t text_bytes; // between the tags
} cau_vtu_array;

// All numbers of an array; the caller frees them. NULL: the scan has failed, or there are none.
double *cau_vtu_numbers(const cau_vtu_coding *coding, const cau_vtu_array *array, int64_t *count);
