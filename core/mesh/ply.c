// SPDX-License-Identifier: GPL-3.0-or-later
// Reads PLY files (Stanford polygon format), as text and in both byte orders. Vertices and faces
// are read. All other elements are only counted.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"

enum { ELEMENTS_MAX = 16, PROPERTIES_MAX = 64, CORNERS_MAX = 4096 };

typedef enum role { OTHER, X, Y, Z, CORNERS, REGION } role;

typedef struct property {
	int bytes; // bytes of one number; negative: the number is unsigned
	bool real;
	int list_bytes; // bytes of the list's count; 0: the property is not a list
	role role;
} property;

typedef struct element {
	char name[32];
	enum { VERTEX, FACE, PASSED } kind;
	int64_t count;
	int property_count;
	property property[PROPERTIES_MAX];
} element;

typedef struct ply {
	cau_scan *scan;
	cau_mesh_builder *builder;
	bool binary, swap;
	int element_count;
	element element[ELEMENTS_MAX];
} ply;

// ---- header
static void read_type(cau_scan *scan, property *made, int *list_bytes)
{
	static const struct {
		const char *name;
		int bytes;
		bool real;
	} types[] = {
		{"char", 1, false},  {"int8", 1, false},   {"uchar", -1, false},  {"uint8", -1, false},
		{"short", 2, false}, {"int16", 2, false},  {"ushort", -2, false}, {"uint16", -2, false},
		{"int", 4, false},   {"int32", 4, false},  {"uint", -4, false},   {"uint32", -4, false},
		{"float", 4, true},  {"float32", 4, true}, {"double", 8, true},   {"float64", 8, true}};
	cau_word word = cau_scan_word_of_line(scan);
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (cau_word_is(word, types[i].name)) {
			if (list_bytes)
				*list_bytes = types[i].bytes;
			else
				*made = (property){.bytes = types[i].bytes, .real = types[i].real};
			return;
		}
	cau_scan_fail(scan, CAU_UNSUPPORTED, "a property of unknown type");
}

static role role_of(const element *of, cau_word name, bool list)
{
	if (of->kind == VERTEX && !list && name.length == 1)
		return cau_word_is(name, "x")   ? X
		       : cau_word_is(name, "y") ? Y
		       : cau_word_is(name, "z") ? Z
		                                : OTHER;
	if (of->kind == FACE && list)
		return cau_word_is(name, "vertex_indices") || cau_word_is(name, "vertex_index") ? CORNERS
		                                                                                : OTHER;
	return of->kind == FACE && (cau_word_is(name, "region") || cau_word_is(name, "material_index"))
	           ? REGION
	           : OTHER;
}

static void read_property(ply *p)
{
	cau_scan *scan = p->scan;
	element *of = p->element_count ? &p->element[p->element_count - 1] : NULL;
	if (!of) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the header has a property before the first element");
		return;
	}
	if (of->property_count == PROPERTIES_MAX) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "element %s has more than %d properties", of->name,
		              PROPERTIES_MAX);
		return;
	}
	property made = {0};
	int list_bytes = 0;
	cau_scan ahead = *scan;
	if (cau_word_is(cau_scan_word_of_line(&ahead), "list")) {
		cau_scan_word_of_line(scan);
		read_type(scan, NULL, &list_bytes);
	}
	read_type(scan, &made, NULL);
	made.list_bytes = list_bytes;
	made.role = role_of(of, cau_scan_word_of_line(scan), list_bytes != 0);
	of->property[of->property_count++] = made;
}

static void read_element_line(ply *p)
{
	cau_scan *scan = p->scan;
	if (p->element_count == ELEMENTS_MAX) {
		cau_scan_fail(scan, CAU_LIMIT, "more than %d kinds of elements", ELEMENTS_MAX);
		return;
	}
	element *made = &p->element[p->element_count++];
	cau_word name = cau_scan_word_of_line(scan);
	snprintf(made->name, sizeof made->name, "%.*s elements",
	         name.length < 20 ? (int)name.length : 20, name.length ? name.text : "");
	made->kind = cau_word_is(name, "vertex") ? VERTEX : cau_word_is(name, "face") ? FACE : PASSED;
	made->count = cau_scan_word_integer(scan, cau_scan_word_of_line(scan), "number of elements", 0,
	                                    INT32_MAX);
}

static void read_form(ply *p)
{
	cau_word form = cau_scan_word_of_line(p->scan);
	bool little = cau_word_is(form, "binary_little_endian");
	bool big = cau_word_is(form, "binary_big_endian");
	p->binary = little || big;
	p->swap = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? big : little;
	if (!p->binary && !cau_word_is(form, "ascii"))
		cau_scan_fail(p->scan, CAU_UNSUPPORTED, "a PLY file that is neither text nor binary");
	if (p->binary)
		snprintf(p->builder->report.format, sizeof p->builder->report.format, "PLY binary");
}

static void read_header(ply *p)
{
	cau_scan *scan = p->scan;
	cau_scan_expect(scan, "ply");
	cau_scan_skip_line(scan);
	while (!scan->status) {
		cau_word word = cau_scan_word(scan);
		if (!word.length)
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file ends before end_header");
		else if (cau_word_is(word, "format"))
			read_form(p);
		else if (cau_word_is(word, "element"))
			read_element_line(p);
		else if (cau_word_is(word, "property"))
			read_property(p);
		else if (cau_word_is(word, "end_header"))
			break;
		cau_scan_skip_line(scan);
	}
	cau_scan_skip_line(scan);
	scan->binary = p->binary;
	scan->swap = p->swap;
}

// ---- numbers
static double read_number(cau_scan *scan, int bytes, bool real)
{
	if (real || !scan->binary)
		return cau_scan_real(scan, "a number", real ? bytes : 8);
	double number = (double)cau_scan_integer(scan, "a number", abs(bytes), INT64_MIN, INT64_MAX);
	return bytes < 0 && number < 0 ? number + (double)(1LL << (8 * -bytes)) : number;
}

// Reads the length of a list. The numbers of the list follow.
static int32_t read_length(cau_scan *scan, const property *of)
{
	double length = read_number(scan, of->list_bytes, false);
	if (!(length >= 0 && length <= CORNERS_MAX) || length != (int32_t)length)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "a list of %g numbers", length);
	return scan->status ? 0 : (int32_t)length;
}

static void read_corners(ply *p, const property *of, int32_t *corner, int32_t *corner_count)
{
	cau_scan *scan = p->scan;
	int32_t length = read_length(scan, of), vertices = p->builder->mesh.vertex_count;
	bool kept = of->role == CORNERS;
	for (int32_t i = 0; i < length && !scan->status; i++) {
		double number = read_number(scan, of->bytes, of->real);
		if (!kept)
			continue;
		if (!(number >= 0 && number < vertices))
			cau_scan_fail(scan, CAU_BAD_MESH, "a face names vertex %g, but there are %d vertices",
			              number, vertices);
		else
			corner[i] = (int32_t)number;
	}
	if (kept)
		*corner_count = length;
}

// Reads one element: a vertex, a face, or an element to skip.
static void read_one(ply *p, const element *of)
{
	double position[3] = {0};
	int32_t corner[CORNERS_MAX], corner_count = 0, region = 0;
	for (int k = 0; k < of->property_count && !p->scan->status; k++) {
		const property *at = &of->property[k];
		if (at->list_bytes) {
			read_corners(p, at, corner, &corner_count);
			continue;
		}
		double number = read_number(p->scan, at->bytes, at->real);
		if (at->role >= X && at->role <= Z)
			position[at->role - X] = number;
		else if (at->role == REGION && fabs(number) <= INT32_MAX)
			region = (int32_t)number;
	}
	if (p->scan->status)
		return;
	if (of->kind == VERTEX)
		cau_mesh_builder_vertex(p->builder, position);
	else if (of->kind == FACE && corner_count >= 3)
		cau_mesh_builder_polygon(p->builder, corner, corner_count, region, NULL);
	else
		cau_mesh_builder_skip(p->builder,
		                      of->kind == FACE ? "faces of fewer than 3 corners" : of->name, 1);
}

static void read_elements(ply *p)
{
	for (int e = 0; e < p->element_count && !p->scan->status; e++) {
		const element *of = &p->element[e];
		if (of->property_count) // elements without properties take no bytes
			cau_scan_check_count(p->scan, of->name, of->count, 1);
		for (int64_t i = 0; i < of->count && of->property_count && !p->scan->status; i++)
			read_one(p, of);
	}
}

cau_status cau_mesh_read_ply(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	ply *p = cau_mesh_array(1, sizeof *p);
	if (!p) {
		cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for a header");
		return scan->status;
	}
	p->scan = scan;
	p->builder = builder;
	read_header(p);
	read_elements(p);
	free(p);
	return scan->status;
}
