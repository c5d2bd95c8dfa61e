// SPDX-License-Identifier: GPL-3.0-or-later
// Reads numbers and attributes of a legacy VTK file. Of the attributes only the region of the cells
// is kept.
#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"
#include "mesh/vtk_part.h"

// clang-format off
static const cau_vtk_type types[] = {
	{"double", 8, CAU_VTK_REAL},
	{"float", 4, CAU_VTK_REAL},
	{"int", 4, CAU_VTK_SIGNED},
	{"unsigned_int", 4, CAU_VTK_UNSIGNED},
	{"long", 8, CAU_VTK_SIGNED},
	{"unsigned_long", 8, CAU_VTK_UNSIGNED},
	{"vtktypeint64", 8, CAU_VTK_SIGNED},
	{"vtktypeuint64", 8, CAU_VTK_UNSIGNED},
	{"vtktypeint32", 4, CAU_VTK_SIGNED},
	{"vtkIdType", 4, CAU_VTK_SIGNED},
	{"short", 2, CAU_VTK_SIGNED},
	{"unsigned_short", 2, CAU_VTK_UNSIGNED},
	{"char", 1, CAU_VTK_SIGNED},
	{"signed_char", 1, CAU_VTK_SIGNED},
	{"unsigned_char", 1, CAU_VTK_UNSIGNED},
};
// clang-format on

const cau_vtk_type *cau_vtk_read_type(cau_scan *scan)
{
	cau_word word = cau_scan_word(scan);
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		if (cau_word_is(word, types[i].name))
			return &types[i];
	cau_scan_fail(scan, CAU_UNSUPPORTED, "numbers of type '%.*s'",
	              (int)(word.length < 24 ? word.length : 24), word.length ? word.text : "");
	return NULL;
}

double cau_vtk_read_number(cau_scan *scan, const cau_vtk_type *type, const char *what)
{
	if (scan->status)
		return 0;
	if (type->kind == CAU_VTK_REAL)
		return cau_scan_real(scan, what, type->bytes);
	double number = (double)cau_scan_integer(scan, what, type->bytes, INT64_MIN, INT64_MAX);
	return type->kind == CAU_VTK_UNSIGNED && number < 0 ? number + ldexp(1, 8 * type->bytes)
	                                                    : number;
}

void cau_vtk_start_numbers(cau_scan *scan)
{
	if (scan->binary)
		cau_scan_skip_line(scan);
}

int64_t cau_vtk_read_data_count(cau_vtk *vtk)
{
	return cau_scan_text_integer(vtk->scan, "number of items", 0, INT32_MAX);
}

bool cau_vtk_is_region_name(cau_word name)
{
	static const char *const names[] = {"region",        "material",      "MaterialIds",
	                                    "CellEntityIds", "gmsh:physical", "medit:ref"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (cau_word_is(name, names[i]))
			return true;
	return false;
}

// Skips `count` numbers.
static void skip_numbers(cau_scan *scan, const cau_vtk_type *type, int64_t count)
{
	cau_vtk_start_numbers(scan);
	CAU_ASSERT(scan->status || type, "%lld numbers of no type", (long long)count);
	if (scan->status)
		return;
	cau_scan_check_count(scan, "number of values", count, scan->binary ? type->bytes : 1);
	if (scan->binary) {
		if (!scan->status)
			cau_scan_skip(scan, count * type->bytes);
		return;
	}
	for (int64_t i = 0; i < count && !scan->status; i++)
		cau_scan_word_real(scan, cau_scan_word(scan), "a value");
}

// Reads the region of each cell.
static void read_regions(cau_vtk *vtk, const cau_vtk_type *type, int64_t count)
{
	CAU_ASSERT(count >= 0, "%lld regions", (long long)count);
	cau_scan *scan = vtk->scan;
	cau_vtk_start_numbers(scan);
	if (scan->status)
		return;
	cau_scan_check_count(scan, "number of values", count, scan->binary ? type->bytes : 1);
	if (vtk->cell_region)
		cau_scan_fail(scan, CAU_BAD_MESH, "the cells have two arrays of regions");
	if (scan->status)
		return;
	vtk->cell_region = cau_mesh_array((size_t)count, sizeof *vtk->cell_region);
	if (!vtk->cell_region) {
		cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %lld regions", (long long)count);
		return;
	}
	vtk->region_count = count;
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double region = cau_vtk_read_number(scan, type, "a region");
		if (!(fabs(region) <= INT32_MAX) || region != floor(region)) {
			cau_scan_fail(scan, CAU_BAD_MESH, "cell %lld: a region must be a whole number",
			              (long long)i);
			return;
		}
		vtk->cell_region[i] = (int32_t)region;
	}
}

// Reads an array of `count` items with `components` numbers each.
static void read_array(cau_vtk *vtk, cau_word name, const cau_vtk_type *type, int64_t count,
                       int64_t components, bool cells)
{
	if (vtk->scan->status)
		return;
	if (components > INT32_MAX || count > INT32_MAX)
		cau_scan_fail(vtk->scan, CAU_BAD_SYNTAX,
		              "an array is too large: %lld items with %lld numbers each", (long long)count,
		              (long long)components);
	else if (cells && components == 1 && cau_vtk_is_region_name(name))
		read_regions(vtk, type, count);
	else
		skip_numbers(vtk->scan, type, count * components);
}

// Reads SCALARS: name type [components], LOOKUP_TABLE name, values.
static void read_scalars(cau_vtk *vtk, int64_t count, bool cells)
{
	cau_scan *scan = vtk->scan;
	cau_word name = cau_scan_word(scan);
	const cau_vtk_type *type = cau_vtk_read_type(scan);
	cau_word word = cau_scan_word_of_line(scan);
	int64_t components =
		word.length ? cau_scan_word_integer(scan, word, "number of components", 1, 4) : 1;
	if (cau_word_is(cau_scan_peek(scan), "LOOKUP_TABLE")) {
		cau_scan_word(scan);
		cau_scan_word(scan);
	}
	read_array(vtk, name, type, count, components, cells);
}

// Reads FIELD: name number-of-arrays, then for each array: name, components, items, type, values.
static void read_field(cau_vtk *vtk, int64_t item_count, bool cells)
{
	cau_scan *scan = vtk->scan;
	cau_scan_word(scan);
	int64_t array_count = cau_scan_count(scan, "number of arrays", 1);
	for (int64_t i = 0; i < array_count && !scan->status; i++) {
		cau_word name = cau_scan_word(scan);
		int64_t components = cau_scan_text_integer(scan, "number of components", 0, INT32_MAX);
		int64_t count = cau_scan_text_integer(scan, "number of items", 0, INT32_MAX);
		const cau_vtk_type *type = cau_vtk_read_type(scan);
		read_array(vtk, name, type, count, components, cells && count == item_count);
		if (cau_word_is(cau_scan_peek(scan), "METADATA")) {
			do
				cau_scan_skip_line(scan);
			while (cau_scan_word_of_line(scan).length);
		}
	}
}

// Skips colours. They are bytes in a binary file, and fractions in a text.
static void skip_colours(cau_scan *scan, int64_t count, int64_t components)
{
	static const cau_vtk_type byte = {"unsigned_char", 1, CAU_VTK_UNSIGNED};
	if (!scan->status)
		skip_numbers(scan, &byte, count * components);
}

// Skips vectors: name; number of components (only TEXTURE_COORDINATES); type; values.
static void skip_vectors(cau_vtk *vtk, int64_t count, int64_t components)
{
	cau_scan *scan = vtk->scan;
	cau_word name = cau_scan_word(scan);
	if (!components)
		components = cau_scan_text_integer(scan, "number of components", 1, 3);
	const cau_vtk_type *type = cau_vtk_read_type(scan);
	read_array(vtk, name, type, count, components, false);
}

bool cau_vtk_read_attribute(cau_vtk *vtk, cau_word keyword, int64_t item_count, bool cells)
{
	cau_scan *scan = vtk->scan;
	if (cau_word_is(keyword, "SCALARS")) {
		read_scalars(vtk, item_count, cells);
	} else if (cau_word_is(keyword, "FIELD")) {
		read_field(vtk, item_count, cells);
	} else if (cau_word_is(keyword, "VECTORS") || cau_word_is(keyword, "NORMALS")) {
		skip_vectors(vtk, item_count, 3);
	} else if (cau_word_is(keyword, "TENSORS")) {
		skip_vectors(vtk, item_count, 9);
	} else if (cau_word_is(keyword, "TEXTURE_COORDINATES")) {
		skip_vectors(vtk, item_count, 0);
	} else if (cau_word_is(keyword, "GLOBAL_IDS") || cau_word_is(keyword, "PEDIGREE_IDS")) {
		skip_vectors(vtk, item_count, 1);
	} else if (cau_word_is(keyword, "COLOR_SCALARS")) {
		cau_scan_word(scan);
		skip_colours(scan, item_count, cau_scan_text_integer(scan, "number of values", 1, 4));
	} else if (cau_word_is(keyword, "LOOKUP_TABLE")) {
		cau_scan_word(scan);
		skip_colours(scan, cau_scan_text_integer(scan, "number of colours", 0, INT32_MAX), 4);
	} else {
		return false;
	}
	return true;
}
