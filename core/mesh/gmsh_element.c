// SPDX-License-Identifier: GPL-3.0-or-later
// What all versions of Gmsh's files share: the types of elements, positions, node lists.
#include "cautery/assert.h"
#include "mesh/gmsh.h"

enum { KNOWN_TYPES = 32 };

static const struct {
	int nodes;
	const char *name;
} types[KNOWN_TYPES] = {
	[1] = {2, "lines"},
	[2] = {3, "triangles"},
	[3] = {4, "quadrangles"},
	[4] = {4, "tetrahedra"},
	[5] = {8, "hexahedra"},
	[6] = {6, "prisms"},
	[7] = {5, "pyramids"},
	[8] = {3, "3-node lines"},
	[9] = {6, "6-node triangles"},
	[10] = {9, "9-node quadrangles"},
	[11] = {10, "10-node tetrahedra"},
	[12] = {27, "27-node hexahedra"},
	[13] = {18, "18-node prisms"},
	[14] = {14, "14-node pyramids"},
	[15] = {1, "points"},
	[16] = {8, "8-node quadrangles"},
	[17] = {20, "20-node hexahedra"},
	[18] = {15, "15-node prisms"},
	[19] = {13, "13-node pyramids"},
	[20] = {9, "9-node triangles"},
	[21] = {10, "10-node triangles"},
	[22] = {12, "12-node triangles"},
	[23] = {15, "15-node triangles"},
	[24] = {15, "incomplete 15-node triangles"},
	[25] = {21, "21-node triangles"},
	[26] = {4, "4-node lines"},
	[27] = {5, "5-node lines"},
	[28] = {6, "6-node lines"},
	[29] = {20, "20-node tetrahedra"},
	[30] = {35, "35-node tetrahedra"},
	[31] = {56, "56-node tetrahedra"},
};

int cau_gmsh_type_nodes(int64_t type)
{
	return type > 0 && type < KNOWN_TYPES ? types[type].nodes : 0;
}

const char *cau_gmsh_type_name(int type)
{
	return cau_gmsh_type_nodes(type) ? types[type].name : "elements of unknown type";
}

void cau_gmsh_read_position(cau_gmsh *gmsh)
{
	double position[3];
	for (int c = 0; c < 3; c++)
		position[c] = cau_scan_real(gmsh->scan, "a coordinate", 8);
	cau_mesh_builder_vertex(gmsh->builder, position);
}

// Passes over the nodes of an element that is not used: in text the rest of its line.
static void skip_element(cau_gmsh *gmsh, int64_t type, int number_bytes)
{
	int nodes = cau_gmsh_type_nodes(type);
	cau_mesh_builder_skip(gmsh->builder, nodes ? type : 0, 1);
	if (!gmsh->scan->binary)
		cau_scan_skip_line(gmsh->scan);
	else if (nodes)
		cau_scan_skip(gmsh->scan, (int64_t)nodes * number_bytes);
	else
		cau_scan_fail(gmsh->scan, CAU_UNSUPPORTED, "elements of unknown type %lld",
		              (long long)type);
}

void cau_gmsh_read_element(cau_gmsh *gmsh, int64_t number, int64_t type, int32_t region,
                           int number_bytes)
{
	cau_scan *scan = gmsh->scan;
	CAU_ASSERT(number_bytes == 4 || number_bytes == 8, "node numbers of %d bytes", number_bytes);
	if (scan->status)
		return;
	if (type != CAU_GMSH_TRIANGLE && type != CAU_GMSH_TETRAHEDRON) {
		skip_element(gmsh, type, number_bytes);
		return;
	}
	int32_t vertex[4] = {0};
	CAU_ASSERT(types[type].nodes <= 4, "%d nodes of an element", types[type].nodes);
	for (int i = 0; i < types[type].nodes; i++) {
		int64_t node = cau_scan_integer(scan, "a node number", number_bytes, 0, INT64_MAX);
		vertex[i] = cau_node_map_find(&gmsh->nodes, node);
		if (vertex[i] < 0)
			cau_scan_fail(scan, CAU_BAD_MESH, "element %lld names node %lld, which is not there",
			              (long long)number, (long long)node);
	}
	if (type == CAU_GMSH_TRIANGLE)
		cau_mesh_builder_triangle(gmsh->builder, vertex, region, NULL);
	else
		cau_mesh_builder_tetrahedron(gmsh->builder, vertex, region);
}
