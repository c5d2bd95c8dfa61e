// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Medit's binary form (.meshb), versions 1 to 4: libMeshb's documentation. Version 1 has
// floats, later versions doubles. From version 3 on, positions in the file have 8 bytes. In version
// 4 whole numbers have 8 bytes too.
#include "mesh/medit_kinds.h"
#include "mesh/readers.h"

enum { DIMENSION = 3, VERTICES = 4, END = 54, NODES_MAX = 27 };

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

static void read_vertices(meshb *m)
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

static void read_cells(meshb *m, const cau_medit_kind *kind)
{
	int64_t count = read_whole(m, "number of elements", 0, INT32_MAX);
	cau_scan_check_count(m->scan, "number of elements", count, 4 * kind->nodes);
	for (int64_t i = 0; i < count && !m->scan->status; i++) {
		int64_t node[NODES_MAX] = {0};
		for (int n = 0; n < kind->nodes; n++)
			node[n] = read_whole(m, "a vertex number", 0, INT32_MAX);
		cau_medit_add(m->builder, kind, node, read_whole(m, "a reference", INT32_MIN, INT32_MAX));
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
	const cau_medit_kind *kind = cau_medit_kind_by_code(code);
	if (code == DIMENSION)
		m->dimension = cau_scan_integer(scan, "a dimension", 4, 2, 3);
	else if (code == VERTICES)
		read_vertices(m);
	else if (kind)
		read_cells(m, kind);
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
