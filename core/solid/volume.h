// SPDX-License-Identifier: GPL-3.0-or-later
// A segmentation: a label for each voxel. Of a file's header only sizes, axes, frame, unit and the
// names of segments are kept, because the rest may name a patient.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/solid.h"
#include "cautery/status.h"

enum {
	CAU_LABEL_NAME_BYTES = 48,
	CAU_LABEL_VALUE_MAX = 65535, // largest value in a file
	CAU_SEGMENT_MAX = 512,       // most names of a header that are kept
};

typedef struct cau_label {
	int32_t value; // value in the file
	int64_t voxel_count;
	char name[CAU_LABEL_NAME_BYTES]; // name in the file, or ""
} cau_label;

// A segment that a header names.
typedef struct cau_segment {
	int32_t value; // value of the segment's voxels; 0: not stated
	char name[CAU_LABEL_NAME_BYTES];
} cau_segment;

typedef struct cau_volume {
	const char *format; // such as "NRRD"
	int32_t size[3];
	uint8_t *voxel; // index in `label`, 0: outside; the first axis is the fastest
	int32_t label_count;
	cau_label label[CAU_SOLID_LABEL_MAX + 1]; // [0] is unused
	cau_segment *segment;                     // (CAU_SEGMENT_MAX), or NULL: the file has no names
	double axis[3][3];    // one step of each index, in mm to the right, to the front, to the head
	double origin[3];     // mm, centre of the first voxel
	bool framed;          // the file states the directions right, front and head
	double inverse[3][3]; // from mm to indices
} cau_volume;

// The format of a file's numbers.
typedef struct cau_voxels {
	enum { CAU_VOXEL_SIGNED, CAU_VOXEL_UNSIGNED, CAU_VOXEL_FLOATING } kind;
	int bytes; // bytes of one number
	bool swap, packed, text;
	const unsigned char *data; // borrowed
	size_t byte_count;
} cau_voxels;

bool cau_is_nrrd(const unsigned char *bytes, size_t byte_count);
bool cau_is_nifti(const unsigned char *bytes, size_t byte_count); // compressed or not

// Reads a file's bytes. `labels` ("1,3"; NULL or "": all) lists the values that count; other values
// are outside. CAU_BAD_VALUE at "labels". The caller calls cau_volume_finish, also after a failure.
cau_status cau_volume_read(const unsigned char *bytes, size_t byte_count, const char *labels,
                           cau_volume *volume, cau_error *error);
void cau_volume_finish(cau_volume *volume);

// The readers. Each reader fills size, axes, frame and segments, and finds where the numbers begin.
cau_status cau_nrrd_read(const unsigned char *bytes, size_t byte_count, cau_volume *volume,
                         cau_voxels *voxels, cau_error *error);
cau_status cau_nifti_read(const unsigned char *bytes, size_t byte_count, cau_volume *volume,
                          cau_voxels *voxels, cau_error *error);
// Checks sizes, and computes `inverse` from `axis`. Errors: CAU_BAD_MESH, CAU_LIMIT.
cau_status cau_volume_check(cau_volume *volume, cau_error *error);

// Unpacks zlib's or gzip's data up to `most` bytes. The caller frees *out.
cau_status cau_unpack(const unsigned char *bytes, size_t byte_count, size_t most,
                      unsigned char **out, size_t *out_count, cau_error *error);
