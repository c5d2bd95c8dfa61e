// SPDX-License-Identifier: GPL-3.0-or-later
// Reads legacy VTK: the header and the loop over the sections. Format: "VTK File Formats", simple
// legacy formats.
#include <stdlib.h>
#include <string.h>

#include "mesh/readers.h"
#include "mesh/vtk_part.h"
#include "mesh/vtk_types.h"

// Reads four lines: version, title, ASCII or BINARY, and the kind of DATASET.
static void read_header(cau_vtk *vtk)
{
	static const char *const start[] = {"#", "vtk", "DataFile", "Version"};
	cau_scan *scan = vtk->scan;
	for (size_t i = 0; i < sizeof start / sizeof start[0]; i++)
		cau_scan_expect(scan, start[i]);
	double version = cau_scan_word_real(scan, cau_scan_word(scan), "a version");
	vtk->offsets = version > 5.05;
	cau_scan_skip_line(scan);
	cau_scan_skip_line(scan);
	cau_word form = cau_scan_word(scan);
	bool binary = cau_word_is(form, "BINARY");
	if (!binary && !cau_word_is(form, "ASCII"))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected ASCII or BINARY");
	cau_scan_expect(scan, "DATASET");
	cau_word kind = cau_scan_word(scan);
	if (!cau_word_is(kind, "UNSTRUCTURED_GRID") && !cau_word_is(kind, "POLYDATA"))
		cau_scan_fail(scan, CAU_UNSUPPORTED, "only UNSTRUCTURED_GRID and POLYDATA are read");
	snprintf(vtk->builder->report.format, sizeof vtk->builder->report.format, "VTK %.1f%s", version,
	         binary ? " binary" : "");
	scan->binary = binary;
	scan->swap = binary && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__; // numbers are big-endian
}

// Skips METADATA, which end with an empty line.
static void skip_metadata(cau_scan *scan)
{
	do
		cau_scan_skip_line(scan);
	while (cau_scan_word_of_line(scan).length);
}

// Reads a section of geometry. Returns false if the keyword names no such section.
static bool read_geometry(cau_vtk *vtk, cau_word keyword)
{
	if (cau_word_is(keyword, "POINTS"))
		cau_vtk_read_points(vtk);
	else if (cau_word_is(keyword, "CELLS"))
		cau_vtk_read_cells(vtk);
	else if (cau_word_is(keyword, "CELL_TYPES"))
		cau_vtk_read_cell_types(vtk);
	else if (cau_word_is(keyword, "POLYGONS"))
		cau_vtk_read_polygons(vtk, CAU_VTK_POLYGON);
	else if (cau_word_is(keyword, "VERTICES"))
		cau_vtk_read_other_cells(vtk, "points");
	else if (cau_word_is(keyword, "LINES"))
		cau_vtk_read_other_cells(vtk, "lines");
	else if (cau_word_is(keyword, "TRIANGLE_STRIPS"))
		cau_vtk_read_polygons(vtk, CAU_VTK_STRIP);
	else
		return false;
	return true;
}

static void read_sections(cau_vtk *vtk)
{
	cau_scan *scan = vtk->scan;
	int64_t item_count = 0;
	bool cells = false;
	for (cau_word word = cau_scan_word(scan); word.length; word = cau_scan_word(scan)) {
		if (cau_word_is(word, "CELL_DATA") || cau_word_is(word, "POINT_DATA")) {
			cells = cau_word_is(word, "CELL_DATA");
			item_count = cau_vtk_read_data_count(vtk);
		} else if (cau_word_is(word, "METADATA")) {
			skip_metadata(scan);
		} else if (!read_geometry(vtk, word) &&
		           !cau_vtk_read_attribute(vtk, word, item_count, cells)) {
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "'%.*s' is not the name of a section that is read",
			              (int)(word.length < 24 ? word.length : 24), word.text);
		}
	}
}

cau_status cau_mesh_read_vtk(cau_mesh_builder *builder)
{
	cau_vtk vtk = {.scan = builder->scan, .builder = builder};
	read_header(&vtk);
	read_sections(&vtk);
	if (vtk.first)
		cau_scan_fail(vtk.scan, CAU_BAD_SYNTAX, "CELLS without CELL_TYPES");
	cau_mesh_builder_map_regions(builder, vtk.cell_region, vtk.region_count);
	free(vtk.corner);
	free(vtk.first);
	free(vtk.cell_region);
	return builder->scan->status;
}
