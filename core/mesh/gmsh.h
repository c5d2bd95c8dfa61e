// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a Gmsh file (.msh), each format's in its own source file. All failures go to the
// scan.
#pragma once

#include "mesh/mesh_builder.h"
#include "mesh/node_map.h"

enum { CAU_GMSH_TRIANGLE = 2, CAU_GMSH_TETRAHEDRON = 4 }; // the format's own numbers

typedef struct cau_gmsh {
	cau_scan *scan;
	cau_mesh_builder *builder;
	cau_node_map nodes;
	bool has_nodes;
	int size_bytes; // of a size_t in a binary file of version 4.1
	struct cau_gmsh_entity {
		int32_t dimension;
		int32_t tag;
		int32_t region;
	} * entity; // version 4.1: entities with a physical group, in ascending order
	int32_t entity_count;
	int32_t entity_capacity;
} cau_gmsh;

cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder);

// Between a section's name and its end.
void cau_gmsh_elements_1(cau_gmsh *gmsh);
void cau_gmsh_nodes_2(cau_gmsh *gmsh);
void cau_gmsh_elements_2(cau_gmsh *gmsh);
void cau_gmsh_entities_4(cau_gmsh *gmsh);
void cau_gmsh_nodes_4(cau_gmsh *gmsh);
void cau_gmsh_elements_4(cau_gmsh *gmsh);

// Nodes of an element of this type, or 0 for a type that is not known.
int cau_gmsh_type_nodes(int64_t type);
const char *cau_gmsh_type_name(int type);

// Reads x, y, z and appends the vertex.
void cau_gmsh_read_position(cau_gmsh *gmsh);
// Reads the nodes of one element (numbers of number_bytes each in a binary file) and appends it, or
// passes over it when it is of another type.
void cau_gmsh_read_element(cau_gmsh *gmsh, int64_t number, int64_t type, int32_t region,
                           int number_bytes);
