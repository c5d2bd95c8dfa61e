// SPDX-License-Identifier: GPL-3.0-or-later
// Reads NIfTI 1 and 2 (nifti.nimh.nih.gov), as one file. The axes of NIfTI's frame already point to
// the right, the front and the head.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "solid/volume.h"

enum { NIFTI1_BYTES = 348, NIFTI2_BYTES = 540 };

// Byte positions of the members in a header.
typedef struct places {
	int dim, dim_bytes, datatype, pixdim, real_bytes, vox_offset, offset_is_whole;
	int slope, inter, qform, sform, code_bytes, quatern, qoffset, srow, units, units_bytes;
} places;

static const places nifti1 = {40,  2,   70, 76,  4,   108, 0,   112, 116,
                              252, 254, 2,  256, 268, 280, 123, 1};
static const places nifti2 = {16,  8,   12, 104, 8,   168, 1,   176, 184,
                              344, 348, 4,  352, 376, 400, 500, 4};

typedef struct head {
	const unsigned char *bytes;
	const places *at;
	bool swap;
} head;

static uint64_t bits_at(const head *of, int place, int width)
{
	uint64_t bits = 0;
	for (int i = width - 1; i >= 0; i--)
		bits = bits << 8 | of->bytes[place + (of->swap ? width - 1 - i : i)];
	return bits;
}

static int64_t whole_at(const head *of, int place, int width)
{
	int unused = 64 - 8 * width;
	return (int64_t)(bits_at(of, place, width) << unused) >> unused;
}

static double real_at(const head *of, int place, int width)
{
	uint64_t bits = bits_at(of, place, width);
	CAU_ASSERT(width == 4 || width == 8, "a real of %d bytes", width);
	if (width == 8) {
		double value;
		memcpy(&value, &bits, sizeof value);
		return value;
	}
	uint32_t half = (uint32_t)bits;
	float value;
	memcpy(&value, &half, sizeof value);
	return (double)value;
}

// Finds out which header a file has. Returns false if there is no known header.
static bool find_head(const unsigned char *bytes, size_t byte_count, head *of)
{
	*of = (head){.bytes = bytes};
	if (byte_count < NIFTI1_BYTES)
		return false;
	for (int swap = 0; swap < 2; swap++) {
		of->swap = swap;
		int64_t size = whole_at(of, 0, 4);
		of->at = size == NIFTI1_BYTES ? &nifti1 : &nifti2;
		if (size == NIFTI1_BYTES &&
		    (!memcmp(bytes + 344, "n+1", 4) || !memcmp(bytes + 344, "ni1", 4)))
			return true;
		if (size == NIFTI2_BYTES && byte_count >= NIFTI2_BYTES &&
		    (!memcmp(bytes + 4, "n+2", 4) || !memcmp(bytes + 4, "ni2", 4)))
			return true;
	}
	return false;
}

bool cau_is_nifti(const unsigned char *bytes, size_t byte_count)
{
	head of;
	if (byte_count < 3 || bytes[0] != 0x1f || bytes[1] != 0x8b)
		return find_head(bytes, byte_count, &of);
	unsigned char *start = NULL;
	size_t count = 0;
	bool is = !cau_unpack(bytes, byte_count, NIFTI2_BYTES, &start, &count, NULL) &&
	          find_head(start, count, &of);
	free(start);
	return is;
}

static cau_status read_numbers(const head *of, size_t byte_count, cau_voxels *voxels,
                               cau_error *error)
{
	static const struct {
		int64_t code;
		cau_voxels is;
	} types[] = {{2, {.kind = CAU_VOXEL_UNSIGNED, .bytes = 1}},
	             {4, {.kind = CAU_VOXEL_SIGNED, .bytes = 2}},
	             {8, {.kind = CAU_VOXEL_SIGNED, .bytes = 4}},
	             {16, {.kind = CAU_VOXEL_FLOATING, .bytes = 4}},
	             {64, {.kind = CAU_VOXEL_FLOATING, .bytes = 8}},
	             {256, {.kind = CAU_VOXEL_SIGNED, .bytes = 1}},
	             {512, {.kind = CAU_VOXEL_UNSIGNED, .bytes = 2}},
	             {768, {.kind = CAU_VOXEL_UNSIGNED, .bytes = 4}},
	             {1024, {.kind = CAU_VOXEL_SIGNED, .bytes = 8}},
	             {1280, {.kind = CAU_VOXEL_UNSIGNED, .bytes = 8}}};
	int64_t code = whole_at(of, of->at->datatype, 2);
	double offset = of->at->offset_is_whole ? (double)whole_at(of, of->at->vox_offset, 8)
	                                        : real_at(of, of->at->vox_offset, 4);
	double slope = real_at(of, of->at->slope, of->at->real_bytes);
	double inter = real_at(of, of->at->inter, of->at->real_bytes);
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (types[i].code == code)
			*voxels = types[i].is;
	if (!voxels->bytes)
		return cau_fail(error, CAU_BAD_SYNTAX, NULL,
		                "the data type %lld is not read: save the labels as unsigned whole numbers",
		                (long long)code);
	if (isfinite(slope) && slope != 0 && (slope != 1 || inter != 0))
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the voxels are scaled by %g: this is an image, not a segmentation", slope);
	if (!(offset >= NIFTI1_BYTES) || offset > (double)byte_count)
		return cau_fail(error, CAU_BAD_SYNTAX, NULL, "the voxels begin outside the file");
	voxels->swap = of->swap;
	voxels->data = of->bytes + (size_t)offset;
	voxels->byte_count = byte_count - (size_t)offset;
	return CAU_OK;
}

static cau_status read_sizes(const head *of, cau_volume *volume, cau_error *error)
{
	int width = of->at->dim_bytes;
	int64_t axes = whole_at(of, of->at->dim, width);
	for (int c = 0; c < 7; c++) {
		int64_t size = c < axes ? whole_at(of, of->at->dim + width * (c + 1), width) : 1;
		if (c < 3 && size >= 1 && size <= INT32_MAX)
			volume->size[c] = (int32_t)size;
		else if (size != 1)
			return cau_fail(error, CAU_BAD_MESH, NULL,
			                "this volume has more than 3 axes or an empty one: save one labelmap");
	}
	return CAU_OK;
}

// Reads the rows of the affine matrix.
static void read_rows(const head *of, cau_volume *volume)
{
	int width = of->at->real_bytes;
	for (int c = 0; c < 3; c++) {
		for (int i = 0; i < 3; i++)
			volume->axis[i][c] = real_at(of, of->at->srow + width * (4 * c + i), width);
		volume->origin[c] = real_at(of, of->at->srow + width * (4 * c + 3), width);
	}
}

// Reads the rotation of a unit quaternion, and the spacings. The first item of pixdim has the sign
// of the third axis.
static void read_quaternion(const head *of, cau_volume *volume)
{
	int width = of->at->real_bytes;
	double b = real_at(of, of->at->quatern, width), c = real_at(of, of->at->quatern + width, width);
	double d = real_at(of, of->at->quatern + 2 * width, width);
	double a = sqrt(fmax(0, 1 - (b * b + c * c + d * d)));
	const double turn[3][3] = {
		{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
		{2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
		{2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
	double sign = real_at(of, of->at->pixdim, width) < 0 ? -1 : 1;
	for (int i = 0; i < 3; i++) {
		double step = real_at(of, of->at->pixdim + width * (i + 1), width) * (i == 2 ? sign : 1);
		for (int r = 0; r < 3; r++)
			volume->axis[i][r] = turn[r][i] * step;
		volume->origin[i] = real_at(of, of->at->qoffset + width * i, width);
	}
}

static void read_frame(const head *of, cau_volume *volume)
{
	int width = of->at->real_bytes;
	volume->framed = true;
	if (whole_at(of, of->at->sform, of->at->code_bytes) > 0)
		read_rows(of, volume);
	else if (whole_at(of, of->at->qform, of->at->code_bytes) > 0)
		read_quaternion(of, volume);
	else {
		volume->framed = false;
		for (int i = 0; i < 3; i++)
			volume->axis[i][i] = real_at(of, of->at->pixdim + width * (i + 1), width);
	}
	int64_t unit = whole_at(of, of->at->units, of->at->units_bytes) & 7;
	double unit_mm = unit == 1 ? 1000 : unit == 3 ? 1e-3 : 1; // unit 1: metres, 3: micrometres
	for (int i = 0; i < 3; i++) {
		volume->origin[i] *= unit_mm;
		for (int c = 0; c < 3; c++)
			volume->axis[i][c] *= unit_mm;
	}
}

cau_status cau_nifti_read(const unsigned char *bytes, size_t byte_count, cau_volume *volume,
                          cau_voxels *voxels, cau_error *error)
{
	head of;
	if (!find_head(bytes, byte_count, &of))
		return cau_fail(error, CAU_BAD_SYNTAX, NULL, "the header of this NIfTI file is damaged");
	volume->format = of.at == &nifti1 ? "NIfTI 1" : "NIfTI 2";
	if (bytes[of.at == &nifti1 ? 345 : 5] == 'i')
		return cau_fail(error, CAU_UNSUPPORTED, NULL,
		                "the voxels are in a separate file: save header and voxels as one file "
		                "(.nii)");
	cau_status status = read_sizes(&of, volume, error);
	if (!status)
		status = read_numbers(&of, byte_count, voxels, error);
	if (!status)
		read_frame(&of, volume);
	return status;
}
