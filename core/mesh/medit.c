// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Medit meshes: text (.mesh) and binary (.meshb). Format: P. Frey, "MEDIT: an interactive
// mesh visualization software" (2001); binary: libMeshb's documentation. The reference of an
// element is its region.
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh_builder.h"

enum { NODES_MAX = 27 };

// Keywords that text files and binary files share.
typedef struct element_kind {
	const char *keyword;
	int code; // code in a binary file (libMeshb); 0: the keyword exists in text only
	int nodes;
	cau_shape shape; // CAU_SHAPE_COUNT: the element is skipped
	const char *name;
} element_kind;

static const element_kind kinds[] = {
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

// Returns the kind of elements of a keyword, or NULL if it names no elements.
static const element_kind *kind_by_keyword(cau_word keyword)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (cau_word_is(keyword, kinds[i].keyword))
			return &kinds[i];
	return NULL;
}

// Returns the kind of elements of a binary code, or NULL if it names no elements.
static const element_kind *kind_by_code(int64_t code)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (kinds[i].code == code)
			return &kinds[i];
	return NULL;
}

// Appends an element. Nodes in `node` count from 1. Fails if a node does not exist.
static void add_element(cau_mesh_builder *builder, const element_kind *kind, const int64_t *node,
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

// ---- text
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

static void read_cells(cau_mesh_builder *builder, const element_kind *kind)
{
	cau_scan *scan = builder->scan;
	int64_t count = next_integer(scan, "number of elements", 0, INT32_MAX);
	cau_scan_check_count(scan, "number of elements", count, 2 * kind->nodes);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t node[NODES_MAX] = {0};
		for (int n = 0; n < kind->nodes; n++)
			node[n] = next_integer(scan, "a vertex number", 0, INT32_MAX);
		add_element(builder, kind, node, next_integer(scan, "a reference", INT32_MIN, INT32_MAX));
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
		const element_kind *kind = kind_by_keyword(word);
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

// ---- binary
// Versions 1 to 4. Version 1 has floats, later versions doubles. From version 3 on, positions in
// the file have 8 bytes. In version 4 whole numbers have 8 bytes too.

enum { DIMENSION = 3, VERTICES = 4, END = 54 };

typedef struct meshb {
	cau_scan *scan;
	cau_mesh_builder *builder;
	int64_t version;
	int64_t dimension;
} meshb;

static int64_t read_whole(meshb *m, const char *what, int64_t least, int64_t most)
{
	return cau_scan_integer(m->scan, what, m->version == 4 ? 8 : 4, least, most);
}

static void read_binary_vertices(meshb *m)
{
	int real_bytes = m->version == 1 ? 4 : 8;
	int64_t count = read_whole(m, "number of vertices", 0, INT32_MAX);
	cau_scan_check_count(m->scan, "number of vertices", count, m->dimension * real_bytes);
	for (int64_t i = 0; i < count && !m->scan->status; i++) {
		double position[3] = {0};
		for (int64_t c = 0; c < m->dimension; c++)
			position[c] = cau_scan_real(m->scan, "a coordinate", real_bytes);
		read_whole(m, "a reference", INT64_MIN, INT64_MAX);
		cau_mesh_builder_vertex(m->builder, position);
	}
}

static void read_binary_cells(meshb *m, const element_kind *kind)
{
	int64_t count = read_whole(m, "number of elements", 0, INT32_MAX);
	cau_scan_check_count(m->scan, "number of elements", count, 4 * kind->nodes);
	for (int64_t i = 0; i < count && !m->scan->status; i++) {
		int64_t node[NODES_MAX] = {0};
		for (int n = 0; n < kind->nodes; n++)
			node[n] = read_whole(m, "a vertex number", 0, INT32_MAX);
		add_element(m->builder, kind, node, read_whole(m, "a reference", INT32_MIN, INT32_MAX));
	}
}

// Reads one block: code(int), the position of the next block, then the block's data.
static bool read_block(meshb *m)
{
	cau_scan *scan = m->scan;
	int64_t code = cau_scan_integer(scan, "a keyword", 4, 0, INT32_MAX);
	if (code == END || scan->status)
		return false;
	int64_t next = cau_scan_integer(scan, "a position", m->version >= 3 ? 8 : 4, 0, INT64_MAX);
	const element_kind *kind = kind_by_code(code);
	if (code == DIMENSION)
		m->dimension = cau_scan_integer(scan, "a dimension", 4, 2, 3);
	else if (code == VERTICES)
		read_binary_vertices(m);
	else if (kind)
		read_binary_cells(m, kind);
	else
		cau_mesh_builder_skip(m->builder, "other blocks", 1);
	if (scan->status || next == 0)
		return false;
	if (next < (int64_t)scan->at || next > (int64_t)scan->count)
		cau_scan_fail(scan, CAU_BAD_SYNTAX,
		              "the position of the next block, byte %lld, is not valid", (long long)next);
	else
		scan->at = (size_t)next;
	return !scan->status;
}

cau_status cau_mesh_read_meshb(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	meshb m = {.scan = scan, .builder = builder, .dimension = 3};
	scan->binary = true;
	int64_t one = cau_scan_integer(scan, "the number one", 4, INT32_MIN, INT32_MAX);
	scan->swap = one == 0x01000000;
	m.version = cau_scan_integer(scan, "a version from 1 to 4", 4, 1, 4);
	while (!scan->status && cau_scan_left(scan) && read_block(&m)) {
	}
	return scan->status;
}
