// SPDX-License-Identifier: GPL-3.0-or-later
// Reads TetGen meshes: the lines of a .node file, followed by those of its .ele or .face file.
// TetGen writes two files, which cau_mesh_file_load joins. Format: TetGen's manual, "File formats".
#include "cautery/assert.h"
#include "mesh/mesh_builder.h"

// Reads the next word. Skips comments, which extend from '#' to the end of the line.
static cau_word next_word(cau_scan *scan)
{
	cau_word word = cau_scan_word(scan);
	while (word.length && word.text[0] == '#') {
		cau_scan_skip_line(scan);
		word = cau_scan_word(scan);
	}
	return word;
}

static int64_t next_integer(cau_scan *scan, const char *what, int64_t least, int64_t most)
{
	return cau_scan_word_integer(scan, next_word(scan), what, least, most);
}

static double next_real(cau_scan *scan, const char *what)
{
	return cau_scan_word_real(scan, next_word(scan), what);
}

// Reads the rest of a line as numbers, at most two. Returns how many there are.
static int rest_of_header(cau_scan *scan, int64_t number[2])
{
	for (int i = 0; i < 2; i++) {
		cau_word word = cau_scan_word_of_line(scan);
		if (!word.length || word.text[0] == '#')
			return i;
		number[i] = cau_scan_word_integer(scan, word, "a number of the first line", 0, INT32_MAX);
	}
	return 2;
}

// Reads the header: number of points, 3, number of attributes, 0 or 1 marker. Then reads for each
// point: number x y z attributes marker. Returns the number of the first point, 0 or 1.
static int64_t read_nodes(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	int64_t rest[2] = {0}, first = 1;
	int64_t count = next_integer(scan, "number of points", 0, INT32_MAX);
	int64_t dimension = next_integer(scan, "a dimension (the .node file comes first)", 2, 4);
	if (!scan->status && dimension != 3)
		cau_scan_fail(scan, CAU_BAD_MESH,
		              dimension == 4 ? "elements without their points: keep the .node file beside "
		                               "this one, or put its lines before these"
		                             : "points in two dimensions are not supported");
	rest_of_header(scan, rest);
	cau_scan_check_count(scan, "number of points", count, 8);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double position[3];
		int64_t number = next_integer(scan, "a point's number", 0, INT32_MAX);
		first = i == 0 ? number : first;
		if (first > 1 || number != first + i)
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "points must be numbered in order, from 0 or 1");
		for (int c = 0; c < 3; c++)
			position[c] = next_real(scan, "a coordinate");
		for (int64_t a = 0; a < rest[0] + rest[1] && !scan->status; a++)
			next_real(scan, "an attribute");
		cau_mesh_builder_vertex(builder, position);
	}
	return first;
}

static void read_element(cau_mesh_builder *builder, cau_shape shape, int64_t nodes,
                         int64_t attributes, int64_t first)
{
	cau_scan *scan = builder->scan;
	int32_t vertex[4] = {0};
	int corners = cau_shape_corners(shape);
	double region = 0;
	next_integer(scan, "an element's number", 0, INT32_MAX);
	for (int64_t n = 0; n < nodes; n++) {
		int64_t number = next_integer(scan, "a point's number", first, INT32_MAX);
		if (!scan->status && number - first >= builder->mesh.vertex_count)
			cau_scan_fail(scan, CAU_BAD_MESH,
			              "an element names point %lld, but there are %d points", (long long)number,
			              builder->mesh.vertex_count);
		if (n < corners)
			vertex[n] = (int32_t)(number - first);
	}
	for (int64_t a = 0; a < attributes && !scan->status; a++) {
		double attribute = next_real(scan, "an attribute");
		region = a == 0 ? attribute : region;
	}
	if (!(region >= INT32_MIN && region <= INT32_MAX))
		region = 0;
	if (scan->status)
		return;
	bool reduced = nodes > corners;
	cau_mesh_builder_cell(builder, shape, vertex, (int32_t)region,
	                      reduced                       ? "10-node tetrahedra"
	                      : shape == CAU_SHAPE_TRIANGLE ? "triangles"
	                                                    : "tetrahedra",
	                      reduced);
}

// Reads elements. The header of a .ele file is: number of elements, 4 or 10 corners, number of
// attributes. The header of a .face file is: number of faces, 0 or 1 marker. The first attribute,
// or the marker, is the region.
static void read_elements(cau_mesh_builder *builder, int64_t first)
{
	cau_scan *scan = builder->scan;
	int64_t rest[2] = {0};
	int64_t count = next_integer(scan, "number of elements", 0, INT32_MAX);
	int known = rest_of_header(scan, rest);
	bool faces = known < 2 && rest[0] <= 1;
	int64_t nodes = faces ? 3 : rest[0];
	if (!scan->status && !faces && nodes != 4 && nodes != 10)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "elements of %lld nodes", (long long)nodes);
	cau_scan_check_count(scan, "number of elements", count, 8);
	for (int64_t i = 0; i < count && !scan->status; i++)
		read_element(builder, faces ? CAU_SHAPE_TRIANGLE : CAU_SHAPE_TETRAHEDRON, nodes,
		             faces ? rest[0] : rest[1], first);
}

cau_status cau_mesh_read_tetgen(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	int64_t first = read_nodes(builder);
	cau_scan ahead = *scan;
	if (!scan->status && !next_word(&ahead).length)
		cau_scan_fail(scan, CAU_BAD_MESH,
		              "points without elements: keep the .ele file beside this one, or put its "
		              "lines behind these");
	while (!scan->status) {
		ahead = *scan;
		if (!next_word(&ahead).length)
			break;
		read_elements(builder, first);
	}
	return scan->status;
}
