// SPDX-License-Identifier: GPL-3.0-or-later
// Reads STL: triangles without shared vertices. Equal vertices are merged later, when the mesh is
// cleaned. The solids of a text file are regions 1, 2, ... with their names.
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh_builder.h"

// Adds three new vertices and their triangle.
static void add_facet(cau_mesh_builder *builder, double position[3][3], int32_t region)
{
	int32_t first = builder->mesh.vertex_count;
	for (int i = 0; i < 3; i++)
		cau_mesh_builder_vertex(builder, position[i]);
	const int32_t vertex[3] = {first, first + 1, first + 2};
	if (!builder->scan->status)
		cau_mesh_builder_cell(builder, CAU_SHAPE_TRIANGLE, vertex, region, "triangles", false);
}

// Reads facet normal x y z, outer loop, three vertices, endloop, endfacet. The normal is ignored,
// because the order of the vertices shows the outer side.
static void read_facet(cau_mesh_builder *builder, int32_t region)
{
	cau_scan *scan = builder->scan;
	double position[3][3];
	cau_scan_skip_line(scan);
	cau_scan_expect(scan, "outer");
	cau_scan_expect(scan, "loop");
	for (int i = 0; i < 3; i++) {
		cau_scan_expect(scan, "vertex");
		for (int c = 0; c < 3; c++)
			position[i][c] = cau_scan_word_real(scan, cau_scan_word(scan), "a coordinate");
	}
	cau_scan_expect(scan, "endloop");
	cau_scan_expect(scan, "endfacet");
	add_facet(builder, position, region);
}

// Reads the rest of the line, which may be empty.
static cau_word read_name(cau_scan *scan)
{
	cau_word name = cau_scan_word_of_line(scan), word = name;
	while (word.length) {
		name.length = (size_t)(word.text - name.text) + word.length;
		word = cau_scan_word_of_line(scan);
	}
	return name;
}

cau_status cau_mesh_read_stl(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	int32_t solids = 0;
	bool open = false;
	for (cau_word word = cau_scan_word(scan); word.length; word = cau_scan_word(scan)) {
		if (cau_word_is(word, "solid")) {
			cau_mesh_builder_name(builder, 2, ++solids, read_name(scan));
			open = true;
		} else if (cau_word_is(word, "facet") && open) {
			read_facet(builder, solids);
		} else if (cau_word_is(word, "endsolid")) {
			read_name(scan);
			open = false;
		} else {
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected facet or endsolid");
		}
	}
	if (open)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file ends before endsolid");
	return scan->status;
}

// Reads 80 bytes, then the number of facets (4 bytes), then for each facet its normal and three
// vertices (floats) and two bytes. All numbers are little-endian.
cau_status cau_mesh_read_stl_binary(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	scan->binary = true;
	scan->swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
	cau_scan_skip(scan, 80);
	int64_t count = cau_scan_integer(scan, "number of facets", 4, 0, INT32_MAX);
	cau_scan_check_count(scan, "number of facets", count, 50);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double position[3][3];
		cau_scan_skip(scan, 12);
		for (int v = 0; v < 9; v++)
			position[v / 3][v % 3] = cau_scan_real(scan, "a coordinate", 4);
		cau_scan_skip(scan, 2);
		add_facet(builder, position, 0);
	}
	if (!scan->status && cau_scan_left(scan))
		cau_mesh_builder_skip(builder, "bytes after the last facet", (int64_t)cau_scan_left(scan));
	return scan->status;
}
