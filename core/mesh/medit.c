// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Medit meshes: text (.mesh) and binary (.meshb). Format: P. Frey, "MEDIT: an interactive
// mesh visualization software" (2001); binary: libMeshb's documentation. The reference of an
// element is its region.
#include <string.h>

#include "cautery/assert.h"
#include "mesh/medit_kinds.h"
#include "mesh/readers.h"

enum { NODES_MAX = 27 };

static const cau_medit_kind kinds[] = {
	{"Edges", 5, 2, CAU_SHAPE_COUNT, "lines"},
	{"Triangles", 6, 3, CAU_SHAPE_TRIANGLE, "triangles"},
	{"Quadrilaterals", 7, 4, CAU_SHAPE_QUADRANGLE, "quadrangles"},
	{"Tetrahedra", 8, 4, CAU_SHAPE_TETRAHEDRON, "tetrahedra"},
	{"Prisms", 9, 6, CAU_SHAPE_WEDGE, "wedges"},
	{"Hexahedra", 10, 8, CAU_SHAPE_HEXAHEDRON, "hexahedra"},
	{"Pyramids", 49, 5, CAU_SHAPE_PYRAMID, "pyramids"},
	{"TrianglesP2", 24, 6, CAU_SHAPE_TRIANGLE, "6-node triangles"},
	{"EdgesP2", 25, 3, CAU_SHAPE_COUNT, "3-node lines"},
	{"QuadrilateralsQ2", 27, 9, CAU_SHAPE_QUADRANGLE, "9-node quadrangles"},
	{"TetrahedraP2", 30, 10, CAU_SHAPE_TETRAHEDRON, "10-node tetrahedra"},
	{"HexahedraQ2", 33, 27, CAU_SHAPE_HEXAHEDRON, "27-node hexahedra"},
};

const cau_medit_kind *cau_medit_kind_by_keyword(cau_word keyword)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (cau_word_is(keyword, kinds[i].keyword))
			return &kinds[i];
	return NULL;
}

const cau_medit_kind *cau_medit_kind_by_code(int64_t code)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (kinds[i].code == code)
			return &kinds[i];
	return NULL;
}

void cau_medit_add(cau_mesh_builder *builder, const cau_medit_kind *kind, const int64_t *node,
                   int64_t region)
{
	CAU_ASSERT(kind->nodes <= NODES_MAX, "%d nodes", kind->nodes);
	if (builder->scan->status)
		return;
	if (kind->shape == CAU_SHAPE_COUNT) {
		cau_mesh_builder_skip(builder, kind->name, 1);
		return;
	}
	int32_t vertex[CAU_CORNERS_MAX];
	int corners = cau_shape_corners(kind->shape);
	for (int c = 0; c < corners; c++) {
		if (node[c] < 1 || node[c] > builder->mesh.vertex_count) {
			cau_scan_fail(builder->scan, CAU_BAD_MESH,
			              "an element of %s names vertex %lld, but there are %d vertices",
			              kind->keyword, (long long)node[c], builder->mesh.vertex_count);
			return;
		}
		vertex[c] = (int32_t)(node[c] - 1);
	}
	cau_mesh_builder_cell(builder, kind->shape, vertex, (int32_t)region, kind->name,
	                      kind->nodes > corners);
}

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

// Reads the number of vertices, then the coordinates and the reference of each.
static void read_vertices(cau_mesh_builder *builder, int64_t dimension)
{
	cau_scan *scan = builder->scan;
	int64_t count = next_integer(scan, "number of vertices", 0, INT32_MAX);
	cau_scan_check_count(scan, "number of vertices", count, 2 * dimension);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double position[3] = {0};
		for (int64_t c = 0; c < dimension; c++)
			position[c] = cau_scan_word_real(scan, next_word(scan), "a coordinate");
		cau_scan_word_real(scan, next_word(scan), "a reference");
		cau_mesh_builder_vertex(builder, position);
	}
}

static void read_cells(cau_mesh_builder *builder, const cau_medit_kind *kind)
{
	cau_scan *scan = builder->scan;
	int64_t count = next_integer(scan, "number of elements", 0, INT32_MAX);
	cau_scan_check_count(scan, "number of elements", count, 2 * kind->nodes);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t node[NODES_MAX] = {0};
		for (int n = 0; n < kind->nodes; n++)
			node[n] = next_integer(scan, "a vertex number", 0, INT32_MAX);
		cau_medit_add(builder, kind, node, next_integer(scan, "a reference", INT32_MIN, INT32_MAX));
	}
}

static bool is_keyword(cau_word word)
{
	char first = word.length ? (char)(word.text[0] | 0x20) : 0;
	return first >= 'a' && first <= 'z';
}

// Skips the data of a keyword that is not used.
static void skip_block(cau_mesh_builder *builder, cau_word keyword)
{
	cau_scan *scan = builder->scan;
	char name[32];
	snprintf(name, sizeof name, "%.*s lines", keyword.length < 24 ? (int)keyword.length : 24,
	         keyword.text);
	cau_word count = cau_scan_peek(scan);
	if (count.length && !is_keyword(count) && count.text[0] != '#')
		cau_mesh_builder_skip(builder, name, cau_scan_text_integer(scan, "a count", 0, INT32_MAX));
	while (!scan->status) {
		cau_scan ahead = *scan;
		cau_word word = next_word(&ahead);
		if (!word.length || is_keyword(word))
			return;
		*scan = ahead;
	}
}

cau_status cau_mesh_read_medit(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	int64_t dimension = 3;
	for (cau_word word = next_word(scan); word.length; word = next_word(scan)) {
		const cau_medit_kind *kind = cau_medit_kind_by_keyword(word);
		if (cau_word_is(word, "End"))
			break;
		if (!is_keyword(word))
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected a keyword");
		else if (cau_word_is(word, "MeshVersionFormatted"))
			next_integer(scan, "a version", 0, 4);
		else if (cau_word_is(word, "Dimension"))
			dimension = next_integer(scan, "a dimension", 2, 3);
		else if (cau_word_is(word, "Vertices"))
			read_vertices(builder, dimension);
		else if (kind)
			read_cells(builder, kind);
		else
			skip_block(builder, word);
	}
	return scan->status;
}
