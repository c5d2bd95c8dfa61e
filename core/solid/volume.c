// SPDX-License-Identifier: GPL-3.0-or-later
// Converts the numbers of a file to labels.
#include "solid/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

enum { SIDE_MAX = 8192, NEW_LABEL = 255 }; // NEW_LABEL: a value that counts and has no label yet
static const int64_t voxels_most = 1LL << 29;

bool cau_solid_is_volume(const void *bytes, size_t byte_count)
{
	return cau_is_nrrd(bytes, byte_count) || cau_is_nifti(bytes, byte_count);
}

static cau_status invert(cau_volume *volume, cau_error *error)
{
	double(*a)[3] = volume->axis, scale = 1; // a[i]: one step of index i
	for (int i = 0; i < 3; i++)
		scale *= sqrt(a[i][0] * a[i][0] + a[i][1] * a[i][1] + a[i][2] * a[i][2]);
	double normal[3][3];
	for (int i = 0; i < 3; i++) {
		const double *u = a[(i + 1) % 3], *v = a[(i + 2) % 3];
		for (int c = 0; c < 3; c++)
			normal[i][c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
	}
	double det = a[0][0] * normal[0][0] + a[0][1] * normal[0][1] + a[0][2] * normal[0][2];
	if (!isfinite(det) || !(scale > 0) || !(fabs(det) > 1e-6 * scale))
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the axes of this volume do not span a space: check its directions");
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++)
			volume->inverse[i][c] = normal[i][c] / det;
	return CAU_OK;
}

cau_status cau_volume_check(cau_volume *volume, cau_error *error)
{
	int64_t count = 1;
	for (int c = 0; c < 3; c++) {
		if (volume->size[c] < 1 || volume->size[c] > SIDE_MAX)
			return cau_fail(error, CAU_LIMIT, NULL, "a volume has 1 to %d voxels along each axis",
			                SIDE_MAX);
		count *= volume->size[c];
		for (int d = 0; d < 3; d++)
			if (!(fabs(volume->axis[c][d]) < 1e6) || !(fabs(volume->origin[c]) < 1e6))
				return cau_fail(
					error, CAU_BAD_MESH, NULL,
					"the origin or an axis of this volume is not a number below 1e6 mm");
	}
	if (count > voxels_most)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the volume has %lld voxels, at most %lld are allowed: crop the volume",
		                (long long)count, (long long)voxels_most);
	return invert(volume, error);
}

// ---- numbers
static double number_at(const cau_voxels *voxels, const unsigned char *at)
{
	unsigned char own[8];
	for (int i = 0; i < voxels->bytes; i++)
		own[i] = at[voxels->swap ? voxels->bytes - 1 - i : i];
	uint64_t bits = 0;
	memcpy(&bits, own, (size_t)voxels->bytes); // this machine is little-endian (session.c)
	if (voxels->kind == CAU_VOXEL_FLOATING && voxels->bytes == 4) {
		float value;
		memcpy(&value, own, sizeof value);
		return (double)value;
	}
	if (voxels->kind == CAU_VOXEL_FLOATING) {
		double value;
		memcpy(&value, own, sizeof value);
		return value;
	}
	int unused = 64 - 8 * voxels->bytes;
	if (voxels->kind == CAU_VOXEL_SIGNED)
		return (double)((int64_t)(bits << unused) >> unused);
	return (double)bits;
}

static cau_status refuse_value(double value, cau_error *error)
{
	return cau_fail(
		error, CAU_BAD_MESH, NULL,
		"a voxel holds %g, and labels are whole numbers from 0 to %d: this is an image, "
		"not a segmentation; segment it first",
		value, CAU_LABEL_VALUE_MAX);
}

// Returns the label of a value. A new value gets a new label. Returns -1 if all labels are used.
static int32_t place_of(cau_volume *volume, uint8_t *of_value, int32_t value)
{
	if (of_value[value] != NEW_LABEL)
		return of_value[value];
	if (volume->label_count == CAU_SOLID_LABEL_MAX)
		return -1;
	int32_t place = ++volume->label_count;
	volume->label[place] = (cau_label){.value = value};
	return of_value[value] = (uint8_t)place;
}

static cau_status take_value(cau_volume *volume, uint8_t *of_value, double value, uint8_t *voxel,
                             cau_error *error)
{
	if (!(value >= 0 && value <= CAU_LABEL_VALUE_MAX) || value != floor(value))
		return refuse_value(value, error);
	int32_t place = place_of(volume, of_value, (int32_t)value);
	if (place < 0)
		return cau_fail(
			error, CAU_BAD_MESH, NULL,
			"more than %d different labels: choose some of them (labels); an image must "
			"be segmented first",
			CAU_SOLID_LABEL_MAX);
	CAU_ASSERT_INDEX(place, CAU_SOLID_LABEL_MAX + 1);
	volume->label[place].voxel_count++;
	*voxel = (uint8_t)place;
	return CAU_OK;
}

static cau_status missing(size_t there, size_t wanted, cau_error *error)
{
	return cau_fail(error, CAU_BAD_SYNTAX, NULL,
	                "the file ends early: %zu bytes of voxels, of %zu that its header promises",
	                there, wanted);
}

// Reads numbers that are written as text, one after the other.
static cau_status decode_text(const cau_voxels *voxels, cau_volume *volume, size_t count,
                              uint8_t *of_value, cau_error *error)
{
	const char *at = (const char *)voxels->data, *end = at + voxels->byte_count;
	cau_status status = CAU_OK;
	for (size_t i = 0; i < count && !status; i++) {
		char word[32];
		size_t length = 0;
		while (at < end && (*at == ' ' || (*at >= 9 && *at <= 13)))
			at++;
		while (at < end && length < sizeof word - 1 && *at > ' ')
			word[length++] = *at++;
		word[length] = 0;
		char *rest;
		double value = strtod(word, &rest);
		if (!length)
			return missing(i, count, error);
		if (*rest)
			return cau_fail(error, CAU_BAD_SYNTAX, NULL, "voxel %zu is not a number", i);
		status = take_value(volume, of_value, value, &volume->voxel[i], error);
	}
	return status;
}

static cau_status decode_binary(const cau_voxels *voxels, cau_volume *volume, size_t count,
                                uint8_t *of_value, cau_error *error)
{
	size_t width = (size_t)voxels->bytes;
	if (voxels->byte_count / width < count)
		return missing(voxels->byte_count, count * width, error);
	const unsigned char *before = NULL; // equal voxels often follow each other
	for (size_t i = 0; i < count; i++) {
		const unsigned char *at = voxels->data + width * i;
		if (before && !memcmp(before, at, width)) {
			volume->voxel[i] = volume->voxel[i - 1];
			volume->label[volume->voxel[i]].voxel_count++;
			continue;
		}
		cau_status status =
			take_value(volume, of_value, number_at(voxels, at), &volume->voxel[i], error);
		if (status)
			return status;
		before = at;
	}
	return CAU_OK;
}

// Sorts the labels by their values, and takes their names from the header.
static void order_labels(cau_volume *volume)
{
	uint8_t place[CAU_SOLID_LABEL_MAX + 1] = {0};
	cau_label before[CAU_SOLID_LABEL_MAX + 1];
	memcpy(before, volume->label, sizeof before);
	for (int32_t k = 1; k <= volume->label_count; k++) {
		int32_t at = 1;
		for (int32_t other = 1; other <= volume->label_count; other++)
			at += before[other].value < before[k].value;
		place[k] = (uint8_t)at;
		volume->label[at] = before[k];
	}
	size_t voxels = (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2];
	for (size_t i = 0; i < voxels; i++)
		volume->voxel[i] = place[volume->voxel[i]];
	for (int32_t s = 0; volume->segment && s < CAU_SEGMENT_MAX; s++)
		for (int32_t k = 1; k <= volume->label_count && volume->segment[s].value; k++)
			if (volume->label[k].value == volume->segment[s].value)
				memcpy(volume->label[k].name, volume->segment[s].name, CAU_LABEL_NAME_BYTES);
}

// Marks the values of the file that become labels.
static cau_status mark_values(const char *labels, uint8_t *of_value, cau_error *error)
{
	if (!labels || !labels[0]) {
		memset(of_value + 1, NEW_LABEL, CAU_LABEL_VALUE_MAX);
		return CAU_OK;
	}
	for (const char *at = labels; *at;) {
		char *end;
		long value = strtol(at, &end, 10);
		if (end == at || (*end && *end != ',') || value < 1 || value > CAU_LABEL_VALUE_MAX)
			return cau_fail(error, CAU_BAD_VALUE, "labels",
			                "labels must be numbers from 1 to %d with commas, as in 1,3",
			                CAU_LABEL_VALUE_MAX);
		of_value[value] = NEW_LABEL;
		at = *end ? end + 1 : end;
	}
	return CAU_OK;
}

// Fails if no voxel has one of the wanted values.
static cau_status check_found(const char *labels, const uint8_t *of_value, cau_error *error)
{
	for (const char *at = labels ? labels : ""; *at; at += strcspn(at, ","), at += *at == ',') {
		long value = strtol(at, NULL, 10);
		CAU_ASSERT(value >= 1 && value <= CAU_LABEL_VALUE_MAX, "label %ld", value);
		if (of_value[value] == NEW_LABEL)
			return cau_fail(error, CAU_BAD_VALUE, "labels", "no voxel has label %ld", value);
	}
	return CAU_OK;
}

static cau_status unpack_voxels(const cau_voxels *voxels, size_t count, cau_voxels *plain,
                                unsigned char **unpacked, cau_error *error)
{
	enum { TEXT_BYTES = 24 }; // most bytes of a number that is written as text
	*plain = *voxels;
	if (!voxels->packed)
		return CAU_OK;
	size_t most = (voxels->text ? TEXT_BYTES : (size_t)voxels->bytes) * count;
	cau_status status =
		cau_unpack(voxels->data, voxels->byte_count, most, unpacked, &plain->byte_count, error);
	plain->data = *unpacked;
	return status;
}

static cau_status decode(const cau_voxels *voxels, const char *labels, cau_volume *volume,
                         cau_error *error)
{
	size_t count = (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2];
	cau_voxels plain = {0};
	unsigned char *unpacked = NULL;
	uint8_t *of_value = calloc(CAU_LABEL_VALUE_MAX + 1, 1);
	CAU_ASSERT(count > 0, "a volume of %zu voxels", count);
	volume->voxel = calloc(count, 1);
	cau_status status = CAU_OK;
	if (!of_value || !volume->voxel)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu voxels", count);
	if (!status)
		status = mark_values(labels, of_value, error);
	if (!status)
		status = unpack_voxels(voxels, count, &plain, &unpacked, error);
	if (!status)
		status =
			(voxels->text ? decode_text : decode_binary)(&plain, volume, count, of_value, error);
	if (!status)
		status = check_found(labels, of_value, error);
	if (!status)
		order_labels(volume);
	free(unpacked);
	free(of_value);
	return status;
}

cau_status cau_volume_read(const unsigned char *bytes, size_t byte_count, const char *labels,
                           cau_volume *volume, cau_error *error)
{
	cau_voxels voxels = {0};
	unsigned char *unpacked = NULL;
	*volume = (cau_volume){0};
	cau_status status = CAU_OK;
	if (cau_is_nrrd(bytes, byte_count)) {
		status = cau_nrrd_read(bytes, byte_count, volume, &voxels, error);
	} else {
		size_t count = byte_count;
		if (byte_count > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b) {
			status =
				cau_unpack(bytes, byte_count, 8 * (size_t)voxels_most, &unpacked, &count, error);
			bytes = unpacked;
		}
		if (!status)
			status = cau_nifti_read(bytes, count, volume, &voxels, error);
	}
	if (!status)
		status = cau_volume_check(volume, error);
	if (!status)
		status = decode(&voxels, labels, volume, error);
	free(unpacked);
	if (!status && !volume->label_count)
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "all voxels of this volume are 0: nothing is labelled");
	return status;
}

void cau_volume_finish(cau_volume *volume)
{
	free(volume->voxel);
	free(volume->segment);
	*volume = (cau_volume){0};
}
