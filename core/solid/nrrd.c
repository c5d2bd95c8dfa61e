// SPDX-License-Identifier: GPL-3.0-or-later
// Reads NRRD (teem.sourceforge.net/nrrd/format.html), and the names of segments that 3D Slicer
// adds.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cautery/assert.h"
#include "solid/volume.h"

enum { LINE_BYTES = 1024 };

// A header that is being read.
typedef struct header {
	cau_volume *volume;
	cau_voxels *voxels;
	int dimension;
	double spacing[3];
	bool has_directions, has_spacing, has_sizes, has_type, has_encoding;
	// Sign for each axis of the file's frame that makes it point right, front, head: 1 or -1.
	double turn[3];
	double unit_mm; // mm in one unit of the frame
	cau_error *error;
} header;

bool cau_is_nrrd(const unsigned char *bytes, size_t byte_count)
{
	return byte_count > 8 && !memcmp(bytes, "NRRD000", 7);
}

static cau_status fail(header *of, const char *format, const char *word)
{
	return cau_fail(of->error, CAU_BAD_SYNTAX, NULL, format, word);
}

static cau_status read_type(header *of, const char *text)
{
	static const struct {
		const char *words; // all names of a type, each name between two bars
		cau_voxels is;
	} types[] = {
		{"|signed char|int8|int8_t|", {.kind = CAU_VOXEL_SIGNED, .bytes = 1}},
		{"|uchar|unsigned char|uint8|uint8_t|", {.kind = CAU_VOXEL_UNSIGNED, .bytes = 1}},
		{"|short|short int|signed short|signed short int|int16|int16_t|",
	     {.kind = CAU_VOXEL_SIGNED, .bytes = 2}},
		{"|ushort|unsigned short|unsigned short int|uint16|uint16_t|",
	     {.kind = CAU_VOXEL_UNSIGNED, .bytes = 2}},
		{"|int|signed int|int32|int32_t|", {.kind = CAU_VOXEL_SIGNED, .bytes = 4}},
		{"|uint|unsigned int|uint32|uint32_t|", {.kind = CAU_VOXEL_UNSIGNED, .bytes = 4}},
		{"|longlong|long long|long long int|int64|int64_t|",
	     {.kind = CAU_VOXEL_SIGNED, .bytes = 8}},
		{"|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|",
	     {.kind = CAU_VOXEL_UNSIGNED, .bytes = 8}},
		{"|float|", {.kind = CAU_VOXEL_FLOATING, .bytes = 4}},
		{"|double|", {.kind = CAU_VOXEL_FLOATING, .bytes = 8}},
	};
	char wanted[64];
	snprintf(wanted, sizeof wanted, "|%.60s|", text);
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (strstr(types[i].words, wanted)) {
			of->voxels->kind = types[i].is.kind;
			of->voxels->bytes = types[i].is.bytes;
			of->has_type = true;
			return CAU_OK;
		}
	return fail(of, "the type '%.40s' is not read: save the labels as unsigned char or short",
	            text);
}

static cau_status read_encoding(header *of, const char *text)
{
	of->voxels->packed = !strcasecmp(text, "gzip") || !strcasecmp(text, "gz");
	of->voxels->text =
		!strcasecmp(text, "ascii") || !strcasecmp(text, "text") || !strcasecmp(text, "txt");
	of->has_encoding = of->voxels->packed || of->voxels->text || !strcasecmp(text, "raw");
	return of->has_encoding
	           ? CAU_OK
	           : fail(of, "the encoding '%.40s' is not read: save the file as raw or gzip", text);
}

static cau_status read_dimension(header *of, const char *text)
{
	of->dimension = (int)strtol(text, NULL, 10);
	if (of->dimension == 3)
		return CAU_OK;
	return fail(
		of,
		"this volume has %.8s axes, but only 3 are supported: save overlapping segments as one "
		"labelmap (in 3D Slicer: export to a labelmap node)",
		text);
}

static cau_status read_sizes(header *of, const char *text)
{
	char *end;
	for (int c = 0; c < 3; c++, text = end) {
		long size = strtol(text, &end, 10);
		if (end == text || size < 1 || size > INT32_MAX)
			return fail(of, "the sizes '%.60s' are not three whole numbers", text);
		of->volume->size[c] = (int32_t)size;
	}
	of->has_sizes = true;
	return CAU_OK;
}

// Reads three numbers in brackets. Returns the position after them, or NULL for `none`.
static const char *read_vector(const char *text, double vector[3])
{
	const char *at = strchr(text, '(');
	for (int c = 0; c < 3 && at; c++) {
		char *end;
		at++;
		vector[c] = strtod(at, &end);
		at = end != at && *end == (c < 2 ? ',' : ')') && isfinite(vector[c]) ? end : NULL;
	}
	return at;
}

static cau_status read_directions(header *of, const char *text)
{
	const char *at = text;
	for (int c = 0; c < 3 && at; c++)
		at = read_vector(at, of->volume->axis[c]);
	of->has_directions = at != NULL;
	return at ? CAU_OK : fail(of, "the space directions '%.80s' are not three vectors", text);
}

static cau_status read_origin(header *of, const char *text)
{
	return read_vector(text, of->volume->origin)
	           ? CAU_OK
	           : fail(of, "the space origin '%.80s' is not a vector", text);
}

static cau_status read_space(header *of, const char *text)
{
	static const char *const to_mesh[3][2] = {
		{"right", "left"}, {"anterior", "posterior"}, {"superior", "inferior"}};
	char words[64], *rest = words;
	double turn[3];
	snprintf(words, sizeof words, "%.60s", text);
	if (strlen(words) == 3) // such as RAS or LPS
		snprintf(words, sizeof words, "%s-%s-%s", strpbrk(text, "Ll") ? "left" : "right",
		         strpbrk(text, "Pp") ? "posterior" : "anterior",
		         strpbrk(text, "Ii") ? "inferior" : "superior");
	for (int c = 0; c < 3; c++) {
		const char *word = strtok_r(c ? NULL : words, "-", &rest);
		if (!word || (strcasecmp(word, to_mesh[c][0]) != 0 && strcasecmp(word, to_mesh[c][1]) != 0))
			return CAU_OK; // scanner-xyz and similar: the direction of right and left is unknown
		turn[c] = strcasecmp(word, to_mesh[c][0]) == 0 ? 1 : -1;
	}
	memcpy(of->turn, turn, sizeof turn);
	of->volume->framed = true;
	return CAU_OK;
}

static cau_status read_spacings(header *of, const char *text)
{
	char *end;
	for (int c = 0; c < 3; c++, text = end) {
		of->spacing[c] = strtod(text, &end);
		if (end == text || !(of->spacing[c] > 0))
			return fail(of, "the spacings '%.60s' are not three lengths", text);
	}
	of->has_spacing = true;
	return CAU_OK;
}

static cau_status read_units(header *of, const char *text)
{
	if (strstr(text, "\"um\"") || strstr(text, "\"micron"))
		of->unit_mm = 1e-3;
	else if (strstr(text, "\"cm\""))
		of->unit_mm = 10;
	else if (strstr(text, "\"m\""))
		of->unit_mm = 1000;
	return CAU_OK;
}

static cau_status read_endian(header *of, const char *text)
{
	of->voxels->swap = !strcasecmp(text, "big");
	return CAU_OK;
}

static cau_status refuse_detached(header *of, const char *text)
{
	(void)text;
	return fail(of, "the voxels are in a separate file: save header and voxels as one %s",
	            "file (.nrrd)");
}

static cau_status refuse_skip(header *of, const char *text)
{
	return strtol(text, NULL, 10) == 0
	           ? CAU_OK
	           : fail(of, "the field '%.20s', which skips data, is not supported", text);
}

static const struct {
	const char *name;
	cau_status (*read)(header *of, const char *text);
} fields[] = {
	{"type", read_type},           {"encoding", read_encoding},
	{"dimension", read_dimension}, {"sizes", read_sizes},
	{"endian", read_endian},       {"space", read_space},
	{"spacings", read_spacings},   {"space directions", read_directions},
	{"space origin", read_origin}, {"space units", read_units},
	{"units", read_units},         {"data file", refuse_detached},
	{"datafile", refuse_detached}, {"line skip", refuse_skip},
	{"byte skip", refuse_skip},    {"lineskip", refuse_skip},
	{"byteskip", refuse_skip},
};

// Reads Segment3_Name:=liver and Segment3_LabelValue:=4. All other keys are skipped.
static void read_segment(header *of, const char *key, const char *text)
{
	char *end;
	long number = strncmp(key, "Segment", 7) != 0 ? -1 : strtol(key + 7, &end, 10);
	if (number < 0 || number >= CAU_SEGMENT_MAX || end == key + 7)
		return;
	if (!of->volume->segment)
		of->volume->segment = calloc(CAU_SEGMENT_MAX, sizeof *of->volume->segment);
	if (!of->volume->segment)
		return; // memory ran out: segments have no names
	cau_segment *segment = &of->volume->segment[number];
	long value = strtol(text, NULL, 10);
	if (strcmp(end, "_LabelValue") == 0 && value > 0 && value <= CAU_LABEL_VALUE_MAX)
		segment->value = (int32_t)value;
	if (strcmp(end, "_Name") != 0)
		return;
	size_t length = strlen(text) < CAU_LABEL_NAME_BYTES ? strlen(text) : CAU_LABEL_NAME_BYTES - 1;
	for (size_t i = 0; i < length; i++)
		segment->name[i] = text[i] >= ' ' && text[i] <= '~' && text[i] != '"' ? text[i] : '?';
	segment->name[length] = 0;
}

static cau_status read_line(header *of, char *line)
{
	char *mark = strchr(line, ':');
	if (line[0] == '#' || !strncmp(line, "NRRD", 4))
		return CAU_OK;
	if (!mark)
		return fail(of, "the line '%.40s' of the header is not a field", line);
	*mark = 0;
	char *text = mark + 1 + strspn(mark + 1, "= ");
	if (mark[1] == '=') {
		read_segment(of, line, text);
		return CAU_OK;
	}
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
		if (!strcasecmp(line, fields[i].name))
			return fields[i].read(of, text);
	return CAU_OK;
}

// Reads all lines up to the empty line. *data is the position of the voxels.
static cau_status read_lines(header *of, const unsigned char *bytes, size_t byte_count,
                             size_t *data)
{
	size_t at = 0;
	while (at < byte_count) {
		char line[LINE_BYTES];
		const unsigned char *end = memchr(bytes + at, '\n', byte_count - at);
		if (!end)
			break;
		size_t length = (size_t)(end - bytes) - at;
		const unsigned char *from = bytes + at;
		at += length + 1;
		if (length && from[length - 1] == '\r')
			length--;
		if (!length) {
			*data = at;
			return CAU_OK;
		}
		// A line that is longer than the buffer is cut, because only descriptions of pictures are
		// so long.
		length = length < LINE_BYTES - 1 ? length : LINE_BYTES - 1;
		memcpy(line, from, length);
		line[length] = 0;
		cau_status status = read_line(of, line);
		if (status)
			return status;
	}
	return fail(of, "the header has no %s", "end (an empty line)");
}

// Converts axes and origin from the file's frame to millimetres to the right, the front and the
// head.
static void turn_axes(header *of)
{
	cau_volume *volume = of->volume;
	for (int i = 0; i < 3 && !of->has_directions; i++)
		for (int c = 0; c < 3; c++)
			volume->axis[i][c] = i == c ? (of->has_spacing ? of->spacing[c] : 1) : 0;
	for (int i = 0; i < 3; i++) {
		volume->origin[i] *= of->turn[i] * of->unit_mm;
		for (int c = 0; c < 3; c++)
			volume->axis[i][c] *= of->turn[c] * of->unit_mm;
	}
}

cau_status cau_nrrd_read(const unsigned char *bytes, size_t byte_count, cau_volume *volume,
                         cau_voxels *voxels, cau_error *error)
{
	header of = {
		.volume = volume, .voxels = voxels, .turn = {1, 1, 1}, .unit_mm = 1, .error = error};
	size_t data = 0;
	volume->format = "NRRD";
	cau_status status = read_lines(&of, bytes, byte_count, &data);
	if (!status && !(of.dimension && of.has_sizes && of.has_type && of.has_encoding))
		status = fail(&of, "the header does not state %s", "type, dimension, sizes and encoding");
	if (status)
		return status;
	turn_axes(&of);
	voxels->data = bytes + data;
	voxels->byte_count = byte_count - data;
	return CAU_OK;
}
