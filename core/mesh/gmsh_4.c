// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh 4.1: $Entities, $Nodes and $Elements, text or binary. "size" below is a size_t of
// size_bytes, "int" has four bytes, reals have eight.
#include <stdlib.h>

#include "cautery/assert.h"
#include "mesh/gmsh.h"
#include "mesh/mesh_memory.h"

static int64_t read_size(cau_gmsh *gmsh, const char *what)
{
	CAU_ASSERT(gmsh->size_bytes == 4 || gmsh->size_bytes == 8, "sizes of %d bytes",
	           gmsh->size_bytes);
	return cau_scan_integer(gmsh->scan, what, gmsh->size_bytes, 0, INT64_MAX);
}

static int32_t read_int(cau_gmsh *gmsh, const char *what, int32_t least, int32_t most)
{
	return (int32_t)cau_scan_integer(gmsh->scan, what, 4, least, most);
}

// A size that counts things of at least this many bytes each, as text or in binary.
static int64_t read_count(cau_gmsh *gmsh, const char *what, int64_t text_bytes,
                          int64_t binary_bytes)
{
	int64_t count = read_size(gmsh, what);
	cau_scan_check_count(gmsh->scan, what, count, gmsh->scan->binary ? binary_bytes : text_bytes);
	return gmsh->scan->status ? 0 : count;
}

static void add_entity(cau_gmsh *gmsh, struct cau_gmsh_entity entity)
{
	CAU_ASSERT(gmsh->entity_count <= gmsh->entity_capacity, "%d entities in room for %d",
	           gmsh->entity_count, gmsh->entity_capacity);
	if (gmsh->entity_count == gmsh->entity_capacity) {
		int32_t capacity = gmsh->entity_capacity ? 2 * gmsh->entity_capacity : 16;
		void *grown = capacity <= CAU_MESH_MAX_ELEMENTS
		                  ? realloc(gmsh->entity, (size_t)capacity * sizeof *gmsh->entity)
		                  : NULL;
		if (!grown) {
			cau_scan_fail(gmsh->scan, CAU_NO_MEMORY, "no memory for %d entities", capacity);
			return;
		}
		gmsh->entity = grown;
		gmsh->entity_capacity = capacity;
	}
	gmsh->entity[gmsh->entity_count++] = entity;
}

// tag(int), x y z or a box of six reals, number of physical groups(size), groups(int), and but for
// points number of bounding entities(size), entities(int). The first group is the region; a
// negative one is the same group with turned orientation.
static void read_entity(cau_gmsh *gmsh, int32_t dimension)
{
	CAU_ASSERT(dimension >= 0 && dimension <= 3, "an entity of dimension %d", dimension);
	cau_scan *scan = gmsh->scan;
	struct cau_gmsh_entity entity = {.dimension = dimension};
	entity.tag = read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
	for (int i = 0; i < (dimension ? 6 : 3); i++)
		cau_scan_real(scan, "an entity's bound", 8);
	int64_t group_count = read_count(gmsh, "number of physical groups", 2, 4);
	for (int64_t i = 0; i < group_count && !scan->status; i++) {
		int32_t group = read_int(gmsh, "a physical group", -INT32_MAX, INT32_MAX);
		if (i == 0)
			entity.region = abs(group);
	}
	int64_t bound_count = dimension ? read_count(gmsh, "number of bounding entities", 2, 4) : 0;
	for (int64_t i = 0; i < bound_count && !scan->status; i++)
		read_int(gmsh, "a bounding entity", INT32_MIN, INT32_MAX);
	if (entity.region && !scan->status)
		add_entity(gmsh, entity);
}

static int compare_entities(const void *left, const void *right)
{
	const struct cau_gmsh_entity *a = left, *b = right;
	int dimensions = (a->dimension > b->dimension) - (a->dimension < b->dimension);
	return dimensions ? dimensions : (a->tag > b->tag) - (a->tag < b->tag);
}

// Numbers of points, curves, surfaces and volumes (size each), then these.
void cau_gmsh_entities_4(cau_gmsh *gmsh)
{
	int64_t count[4];
	for (int dimension = 0; dimension < 4; dimension++)
		count[dimension] = read_count(gmsh, "number of entities", 8, 28);
	for (int32_t dimension = 0; dimension < 4; dimension++)
		for (int64_t i = 0; i < count[dimension] && !gmsh->scan->status; i++)
			read_entity(gmsh, dimension);
	if (gmsh->entity_count)
		qsort(gmsh->entity, (size_t)gmsh->entity_count, sizeof *gmsh->entity, compare_entities);
}

static int32_t region_of(const cau_gmsh *gmsh, int32_t dimension, int32_t tag)
{
	if (!gmsh->entity_count)
		return 0;
	struct cau_gmsh_entity key = {.dimension = dimension, .tag = tag};
	const struct cau_gmsh_entity *found =
		bsearch(&key, gmsh->entity, (size_t)gmsh->entity_count, sizeof key, compare_entities);
	return found ? found->region : 0;
}

// dimension(int) tag(int) parametric(int) number of nodes(size), all node numbers(size), then all
// positions: x y z and, where parametric, one more real per dimension.
static void read_node_block(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int32_t dimension = read_int(gmsh, "an entity's dimension", 0, 3);
	read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
	int32_t parametric = read_int(gmsh, "0 or 1 (parametric)", 0, 1);
	int64_t count = read_count(gmsh, "number of nodes", 8, 24 + gmsh->size_bytes);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = read_size(gmsh, "a node number");
		cau_node_map_add(&gmsh->nodes, number, scan);
	}
	for (int64_t i = 0; i < count && !scan->status; i++) {
		cau_gmsh_read_position(gmsh);
		for (int32_t p = 0; p < parametric * dimension; p++)
			cau_scan_real(scan, "a parametric coordinate", 8);
	}
}

// number of blocks, number of nodes, least and greatest node number (size each), then the blocks.
void cau_gmsh_nodes_4(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	if (gmsh->has_nodes)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the nodes stand twice");
	gmsh->has_nodes = true;
	int64_t block_count = read_count(gmsh, "number of blocks", 8, 12 + gmsh->size_bytes);
	int64_t node_count = read_count(gmsh, "number of nodes", 8, 24 + gmsh->size_bytes);
	read_size(gmsh, "the least node number");
	read_size(gmsh, "the greatest node number");
	for (int64_t i = 0; i < block_count && !scan->status; i++)
		read_node_block(gmsh);
	if (gmsh->nodes.count != node_count)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "%lld nodes were announced, but %d stand here",
		              (long long)node_count, gmsh->nodes.count);
	cau_node_map_seal(&gmsh->nodes, scan);
}

// dimension(int) tag(int) type(int) number of elements(size), then element and node numbers(size).
static void read_element_block(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int32_t dimension = read_int(gmsh, "an entity's dimension", 0, 3);
	int32_t tag = read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
	int32_t type = read_int(gmsh, "a type of element", 1, INT32_MAX);
	int32_t region = region_of(gmsh, dimension, tag);
	int64_t count = read_count(gmsh, "number of elements", 4, 2 * gmsh->size_bytes);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = read_size(gmsh, "an element number");
		cau_gmsh_read_element(gmsh, number, type, region, gmsh->size_bytes);
	}
}

// number of blocks, number of elements, least and greatest number (size each), then the blocks.
void cau_gmsh_elements_4(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t block_count = read_count(gmsh, "number of blocks", 8, 12 + gmsh->size_bytes);
	read_count(gmsh, "number of elements", 4, 2 * gmsh->size_bytes);
	read_size(gmsh, "the least element number");
	read_size(gmsh, "the greatest element number");
	for (int64_t i = 0; i < block_count && !scan->status; i++)
		read_element_block(gmsh);
}
