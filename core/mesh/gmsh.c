// SPDX-License-Identifier: GPL-3.0-or-later
// Reads Gmsh files (.msh) of versions 1, 2.2 (2.0, 2.1), 4.0 and 4.1. This file has first the types
// of elements, then the contents of each version's sections, then the loop over the sections.
// Formats: Gmsh's reference manual, "File formats" (4.1) and "Legacy formats" (1 and 2.2). All
// failures go to the scan.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"

enum { KNOWN_TYPES = 32, NODES_MAX = 64 };

typedef struct gmsh_file {
	cau_scan *scan;
	cau_mesh_builder *builder;
	cau_node_map nodes;
	bool has_nodes;
	int size_bytes; // bytes of a size_t in a binary file of version 4
	// Version 4.0: another order of fields, and four-byte numbers of nodes and elements.
	bool is_4_0;
	struct entity {
		int32_t dimension;
		int32_t tag;
		int32_t region;
	} * entity; // version 4: entities with a physical group, sorted by dimension and tag
	int32_t entity_count;
	int32_t entity_capacity;
} gmsh_file;

// ---- elements and positions of all versions
// Known types of elements. The corners of an element are its first nodes.
static const struct {
	int nodes;
	cau_shape shape; // CAU_SHAPE_COUNT: the element is skipped
	const char *name;
} types[KNOWN_TYPES] = {
	[1] = {2, CAU_SHAPE_COUNT, "lines"},
	[2] = {3, CAU_SHAPE_TRIANGLE, "triangles"},
	[3] = {4, CAU_SHAPE_QUADRANGLE, "quadrangles"},
	[4] = {4, CAU_SHAPE_TETRAHEDRON, "tetrahedra"},
	[5] = {8, CAU_SHAPE_HEXAHEDRON, "hexahedra"},
	[6] = {6, CAU_SHAPE_WEDGE, "wedges"},
	[7] = {5, CAU_SHAPE_PYRAMID, "pyramids"},
	[8] = {3, CAU_SHAPE_COUNT, "3-node lines"},
	[9] = {6, CAU_SHAPE_TRIANGLE, "6-node triangles"},
	[10] = {9, CAU_SHAPE_QUADRANGLE, "9-node quadrangles"},
	[11] = {10, CAU_SHAPE_TETRAHEDRON, "10-node tetrahedra"},
	[12] = {27, CAU_SHAPE_HEXAHEDRON, "27-node hexahedra"},
	[13] = {18, CAU_SHAPE_WEDGE, "18-node wedges"},
	[14] = {14, CAU_SHAPE_PYRAMID, "14-node pyramids"},
	[15] = {1, CAU_SHAPE_COUNT, "points"},
	[16] = {8, CAU_SHAPE_QUADRANGLE, "8-node quadrangles"},
	[17] = {20, CAU_SHAPE_HEXAHEDRON, "20-node hexahedra"},
	[18] = {15, CAU_SHAPE_WEDGE, "15-node wedges"},
	[19] = {13, CAU_SHAPE_PYRAMID, "13-node pyramids"},
	[20] = {9, CAU_SHAPE_TRIANGLE, "9-node triangles"},
	[21] = {10, CAU_SHAPE_TRIANGLE, "10-node triangles"},
	[22] = {12, CAU_SHAPE_TRIANGLE, "12-node triangles"},
	[23] = {15, CAU_SHAPE_TRIANGLE, "15-node triangles"},
	[24] = {15, CAU_SHAPE_TRIANGLE, "incomplete 15-node triangles"},
	[25] = {21, CAU_SHAPE_TRIANGLE, "21-node triangles"},
	[26] = {4, CAU_SHAPE_COUNT, "4-node lines"},
	[27] = {5, CAU_SHAPE_COUNT, "5-node lines"},
	[28] = {6, CAU_SHAPE_COUNT, "6-node lines"},
	[29] = {20, CAU_SHAPE_TETRAHEDRON, "20-node tetrahedra"},
	[30] = {35, CAU_SHAPE_TETRAHEDRON, "35-node tetrahedra"},
	[31] = {56, CAU_SHAPE_TETRAHEDRON, "56-node tetrahedra"},
};

// Returns the number of nodes of this type of element, or 0 if the type is unknown.
static int nodes_of_type(int64_t type)
{
	return type > 0 && type < KNOWN_TYPES ? types[type].nodes : 0;
}

// Reads x, y, z and appends the vertex.
static void read_position(gmsh_file *gmsh)
{
	double position[3];
	for (int c = 0; c < 3; c++)
		position[c] = cau_scan_real(gmsh->scan, "a coordinate", 8);
	cau_mesh_builder_vertex(gmsh->builder, position);
}

// Skips the nodes of an element that is not used. In a text file this is the rest of the line.
static void skip_element(gmsh_file *gmsh, int64_t type, int number_bytes)
{
	int nodes = nodes_of_type(type);
	cau_mesh_builder_skip(gmsh->builder, nodes ? types[type].name : "elements of unknown type", 1);
	if (!gmsh->scan->binary)
		cau_scan_skip_line(gmsh->scan);
	else if (nodes)
		cau_scan_skip(gmsh->scan, (int64_t)nodes * number_bytes);
	else
		cau_scan_fail(gmsh->scan, CAU_UNSUPPORTED, "elements of unknown type %lld",
		              (long long)type);
}

// Reads the nodes of one element and appends its corners. Elements of other types are skipped. In a
// binary file a node number has number_bytes bytes.
static void read_element(gmsh_file *gmsh, int64_t number, int64_t type, int32_t region,
                         int number_bytes)
{
	cau_scan *scan = gmsh->scan;
	CAU_ASSERT(number_bytes == 4 || number_bytes == 8, "node numbers of %d bytes", number_bytes);
	if (scan->status)
		return;
	if (!nodes_of_type(type) || types[type].shape == CAU_SHAPE_COUNT) {
		skip_element(gmsh, type, number_bytes);
		return;
	}
	int32_t vertex[NODES_MAX] = {0};
	int corners = cau_shape_corners(types[type].shape);
	for (int i = 0; i < types[type].nodes && !scan->status; i++) {
		int64_t node = cau_scan_integer(scan, "a node number", number_bytes, 0, INT64_MAX);
		vertex[i] = i < corners ? cau_node_map_find(&gmsh->nodes, node) : 0;
		if (vertex[i] < 0)
			cau_scan_fail(scan, CAU_BAD_MESH,
			              "element %lld names node %lld, which the file does not have",
			              (long long)number, (long long)node);
	}
	cau_mesh_builder_cell(gmsh->builder, types[type].shape, vertex, region, types[type].name,
	                      types[type].nodes > corners);
}

// ---- version 1: text only; $NOD has the format of $Nodes of version 2.2

// Reads number-of-elements, then: elm-number elm-type reg-phys reg-elem number-of-nodes
// node-numbers
static void read_elements_1(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t count = cau_scan_count(scan, "number of elements", 12);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_text_integer(scan, "an element number", 0, INT64_MAX);
		int64_t type = cau_scan_text_integer(scan, "a type of element", 1, INT32_MAX);
		int64_t region = cau_scan_text_integer(scan, "a physical group", INT32_MIN, INT32_MAX);
		cau_scan_text_integer(scan, "an elementary region", INT32_MIN, INT32_MAX);
		int64_t nodes = cau_scan_text_integer(scan, "number of nodes", 1, INT32_MAX);
		int expected = nodes_of_type(type);
		if (!scan->status && expected && nodes != expected)
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "element %lld has %lld nodes, its type has %d",
			              (long long)number, (long long)nodes, expected);
		read_element(gmsh, number, type, (int32_t)region, 4);
	}
}

// ---- version 2.2: text or binary

// Reads number-of-nodes (text), then: node-number x y z
static void read_nodes_2(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	if (gmsh->has_nodes)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has two sections of nodes");
	gmsh->has_nodes = true;
	int64_t count = cau_scan_count(scan, "number of nodes", scan->binary ? 28 : 8);
	cau_scan_skip_line(scan);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_integer(scan, "a node number", 4, 0, INT64_MAX);
		cau_node_map_add(&gmsh->nodes, number, scan);
		read_position(gmsh);
	}
	cau_node_map_seal(&gmsh->nodes, scan);
}

// Reads the tags and nodes of one element. The first tag is its physical group.
static void read_tagged_element(gmsh_file *gmsh, int64_t number, int64_t type, int64_t tag_count)
{
	cau_scan *scan = gmsh->scan;
	int64_t region = 0;
	for (int64_t t = 0; t < tag_count && !scan->status; t++) {
		int64_t tag = cau_scan_integer(scan, "a tag", 4, INT32_MIN, INT32_MAX);
		if (t == 0)
			region = tag;
	}
	read_element(gmsh, number, type, (int32_t)region, 4);
}

// Reads elm-number elm-type number-of-tags tags node-numbers for each element.
static void read_text_elements(gmsh_file *gmsh, int64_t count)
{
	cau_scan *scan = gmsh->scan;
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_text_integer(scan, "an element number", 0, INT64_MAX);
		int64_t type = cau_scan_text_integer(scan, "a type of element", 1, INT32_MAX);
		int64_t tag_count = cau_scan_text_integer(scan, "number of tags", 0, INT32_MAX);
		read_tagged_element(gmsh, number, type, tag_count);
	}
}

// Reads binary blocks of elm-type num-elm-follow num-tags, then elm-number tags node-numbers of
// each element.
static void read_binary_elements(gmsh_file *gmsh, int64_t count)
{
	cau_scan *scan = gmsh->scan;
	for (int64_t done = 0; done < count && !scan->status;) {
		int64_t type = cau_scan_integer(scan, "a type of element", 4, 1, INT32_MAX);
		int64_t follow = cau_scan_integer(scan, "number of elements", 4, 1, count - done);
		int64_t tag_count = cau_scan_integer(scan, "number of tags", 4, 0, INT32_MAX);
		for (int64_t i = 0; i < follow && !scan->status; i++) {
			int64_t number = cau_scan_integer(scan, "an element number", 4, 0, INT32_MAX);
			read_tagged_element(gmsh, number, type, tag_count);
		}
		done += follow;
	}
}

static void read_elements_2(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t count = cau_scan_count(scan, "number of elements", 8);
	cau_scan_skip_line(scan);
	if (scan->binary)
		read_binary_elements(gmsh, count);
	else
		read_text_elements(gmsh, count);
}

// ---- version 4.1: text or binary. "size" below is a size_t of size_bytes, "int" has four bytes,
// reals have eight.
static int64_t read_size(gmsh_file *gmsh, const char *what)
{
	CAU_ASSERT(gmsh->size_bytes == 4 || gmsh->size_bytes == 8, "sizes of %d bytes",
	           gmsh->size_bytes);
	return cau_scan_integer(gmsh->scan, what, gmsh->size_bytes, 0, INT64_MAX);
}

static int32_t read_int(gmsh_file *gmsh, const char *what, int32_t least, int32_t most)
{
	return (int32_t)cau_scan_integer(gmsh->scan, what, 4, least, most);
}

// Reads the number of items that follow. Each item has at least text_bytes or binary_bytes bytes.
static int64_t read_count(gmsh_file *gmsh, const char *what, int64_t text_bytes,
                          int64_t binary_bytes)
{
	int64_t count = read_size(gmsh, what);
	cau_scan_check_count(gmsh->scan, what, count, gmsh->scan->binary ? binary_bytes : text_bytes);
	return gmsh->scan->status ? 0 : count;
}

static void add_entity(gmsh_file *gmsh, struct entity entity)
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

static int compare_entities(const void *left, const void *right)
{
	const struct entity *a = left, *b = right;
	int dimensions = (a->dimension > b->dimension) - (a->dimension < b->dimension);
	return dimensions ? dimensions : (a->tag > b->tag) - (a->tag < b->tag);
}

// Returns the region of an entity, or 0 if the entity is not listed.
static int32_t region_of(const gmsh_file *gmsh, int32_t dimension, int32_t tag)
{
	if (!gmsh->entity_count)
		return 0;
	struct entity key = {.dimension = dimension, .tag = tag};
	const struct entity *found =
		bsearch(&key, gmsh->entity, (size_t)gmsh->entity_count, sizeof key, compare_entities);
	return found ? found->region : 0;
}

// Reads the extra fields of a partitioned entity: parent's dimension(int) and tag(int), number of
// partitions(size), partitions(int). Some files of 4.0 have that number as int, which is the same
// in text. An entity without a physical group gets the region of its parent.
static void read_partition(gmsh_file *gmsh, struct entity *entity)
{
	cau_scan *scan = gmsh->scan;
	int32_t dimension = read_int(gmsh, "a parent's dimension", -1, 3);
	int32_t tag = read_int(gmsh, "a parent's tag", INT32_MIN, INT32_MAX);
	int64_t count = read_count(gmsh, "number of partitions", 2, 4);
	for (int64_t i = 0; i < count && !scan->status; i++)
		read_int(gmsh, "a partition", INT32_MIN, INT32_MAX);
	entity->region = dimension == entity->dimension ? region_of(gmsh, dimension, tag) : 0;
}

// Reads tag(int), x y z or a box of six reals, number of physical groups(size), groups(int). Except
// for points, number of bounding entities(size) and entities(int) follow. The first group is the
// region. A negative group is the same group with reversed orientation.
static void read_entity(gmsh_file *gmsh, int32_t dimension, bool partitioned)
{
	CAU_ASSERT(dimension >= 0 && dimension <= 3, "an entity of dimension %d", dimension);
	cau_scan *scan = gmsh->scan;
	struct entity entity = {.dimension = dimension};
	entity.tag = read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
	if (partitioned)
		read_partition(gmsh, &entity);
	for (int i = 0; i < (dimension || gmsh->is_4_0 ? 6 : 3); i++)
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

// Reads the numbers of points, curves, surfaces and volumes (size each), then the entities.
static void read_entity_list(gmsh_file *gmsh, bool partitioned)
{
	int64_t count[4];
	for (int dimension = 0; dimension < 4; dimension++)
		count[dimension] = read_count(gmsh, "number of entities", 8, 28);
	for (int32_t dimension = 0; dimension < 4; dimension++)
		for (int64_t i = 0; i < count[dimension] && !gmsh->scan->status; i++)
			read_entity(gmsh, dimension, partitioned);
	if (gmsh->entity_count)
		qsort(gmsh->entity, (size_t)gmsh->entity_count, sizeof *gmsh->entity, compare_entities);
}

static void read_entities_4(gmsh_file *gmsh)
{
	read_entity_list(gmsh, false);
}

// Reads number of partitions(size) and number of ghost entities(size), then tag(int) and
// partition(int) of each ghost, then the entities.
static void read_partitioned_entities(gmsh_file *gmsh)
{
	read_size(gmsh, "number of partitions");
	int64_t ghosts = read_count(gmsh, "number of ghost entities", 3, 8);
	for (int64_t i = 0; i < 2 * ghosts && !gmsh->scan->status; i++)
		read_int(gmsh, "a ghost entity", INT32_MIN, INT32_MAX);
	read_entity_list(gmsh, true);
}

// Reads the dimension and tag of an entity. Version 4.0 has the tag first.
static void read_entity_of_block(gmsh_file *gmsh, int32_t *dimension, int32_t *tag)
{
	if (gmsh->is_4_0)
		*tag = read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
	*dimension = read_int(gmsh, "an entity's dimension", 0, 3);
	if (!gmsh->is_4_0)
		*tag = read_int(gmsh, "an entity's tag", INT32_MIN, INT32_MAX);
}

static int number_bytes(const gmsh_file *gmsh)
{
	return gmsh->is_4_0 ? 4 : gmsh->size_bytes;
}

static void read_node_number(gmsh_file *gmsh)
{
	int64_t number =
		cau_scan_integer(gmsh->scan, "a node number", number_bytes(gmsh), 0, INT64_MAX);
	cau_node_map_add(&gmsh->nodes, number, gmsh->scan);
}

// Reads dimension(int) tag(int) parametric(int) number of nodes(size), all node numbers(size), then
// all positions. A position is x y z and, if parametric, one more real for each dimension.
// In 4.0: tag(int) dimension(int), and the number and position of each node together.
static void read_node_block(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int32_t dimension = 0, tag = 0;
	read_entity_of_block(gmsh, &dimension, &tag);
	int32_t parametric = read_int(gmsh, "0 or 1 (parametric)", 0, 1);
	int64_t count = read_count(gmsh, "number of nodes", 8, 24 + number_bytes(gmsh));
	for (int64_t i = 0; i < count && !scan->status && !gmsh->is_4_0; i++)
		read_node_number(gmsh);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		if (gmsh->is_4_0)
			read_node_number(gmsh);
		read_position(gmsh);
		for (int32_t p = 0; p < parametric * dimension; p++)
			cau_scan_real(scan, "a parametric coordinate", 8);
	}
}

// Reads number of blocks, number of nodes, least and greatest node number (size each), then the
// blocks.
static void read_nodes_4(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	if (gmsh->has_nodes)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has two sections of nodes");
	gmsh->has_nodes = true;
	int64_t block_count = read_count(gmsh, "number of blocks", 8, 12 + gmsh->size_bytes);
	int64_t node_count = read_count(gmsh, "number of nodes", 8, 24 + number_bytes(gmsh));
	if (!gmsh->is_4_0) {
		read_size(gmsh, "the least node number");
		read_size(gmsh, "the greatest node number");
	}
	for (int64_t i = 0; i < block_count && !scan->status; i++)
		read_node_block(gmsh);
	if (gmsh->nodes.count != node_count)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the section announces %lld nodes, but has %d",
		              (long long)node_count, gmsh->nodes.count);
	cau_node_map_seal(&gmsh->nodes, scan);
}

// Reads dimension(int) tag(int) type(int) number of elements(size), then element and node
// numbers(size).
static void read_element_block(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int32_t dimension = 0, tag = 0;
	read_entity_of_block(gmsh, &dimension, &tag);
	int32_t type = read_int(gmsh, "a type of element", 1, INT32_MAX);
	int32_t region = region_of(gmsh, dimension, tag);
	int64_t count = read_count(gmsh, "number of elements", 4, 2 * number_bytes(gmsh));
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number =
			cau_scan_integer(scan, "an element number", number_bytes(gmsh), 0, INT64_MAX);
		read_element(gmsh, number, type, region, number_bytes(gmsh));
	}
}

// Reads number of blocks, number of elements, least and greatest number (size each), then the
// blocks.
static void read_elements_4(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t block_count = read_count(gmsh, "number of blocks", 8, 12 + gmsh->size_bytes);
	read_count(gmsh, "number of elements", 4, 2 * number_bytes(gmsh));
	if (!gmsh->is_4_0) {
		read_size(gmsh, "the least element number");
		read_size(gmsh, "the greatest element number");
	}
	for (int64_t i = 0; i < block_count && !scan->status; i++)
		read_element_block(gmsh);
}

// ---- the sections of each version

// Reads the names, which are text in binary files too: number of names, then dimension, number and
// "name" of each.
static void read_names(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t count = cau_scan_count(scan, "number of names", 4);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t dimension = cau_scan_text_integer(scan, "a dimension", 0, 3);
		int64_t number = cau_scan_text_integer(scan, "a physical group", INT32_MIN, INT32_MAX);
		cau_word name = cau_scan_word_of_line(scan), word = name;
		while (word.length) { // a name may have blanks
			name.length = (size_t)(word.text - name.text) + word.length;
			word = cau_scan_word_of_line(scan);
		}
		if (dimension >= 2)
			cau_mesh_builder_name(gmsh->builder, (int32_t)dimension, (int32_t)number, name);
	}
}

typedef struct section {
	const char *name, *end;
	void (*read)(gmsh_file *gmsh);
} section;

static const section sections_1[] = {
	{"$NOD", "$ENDNOD", read_nodes_2}, {"$ELM", "$ENDELM", read_elements_1}, {0}};
static const section sections_2[] = {{"$PhysicalNames", "$EndPhysicalNames", read_names},
                                     {"$Nodes", "$EndNodes", read_nodes_2},
                                     {"$Elements", "$EndElements", read_elements_2},
                                     {0}};
static const section sections_4[] = {
	{"$PhysicalNames", "$EndPhysicalNames", read_names},
	{"$PartitionedEntities", "$EndPartitionedEntities", read_partitioned_entities},
	{"$Entities", "$EndEntities", read_entities_4},
	{"$Nodes", "$EndNodes", read_nodes_4},
	{"$Elements", "$EndElements", read_elements_4},
	{0}};

// Reads the number one in binary, which shows the byte order.
static void read_byte_order(cau_scan *scan)
{
	cau_scan_skip_line(scan);
	scan->binary = true;
	int64_t one = cau_scan_integer(scan, "the number one", 4, INT32_MIN, INT32_MAX);
	if (one == 0x01000000)
		scan->swap = true;
	else if (one != 1)
		cau_scan_fail(scan, CAU_BAD_SYNTAX,
		              "expected the number one, which shows the byte order; found %lld",
		              (long long)one);
}

// Reads $MeshFormat: version, whether binary, size of a number. Returns the version's sections.
static const section *read_header(gmsh_file *gmsh)
{
	cau_scan *scan = gmsh->scan;
	double version = cau_scan_word_real(scan, cau_scan_word(scan), "a version");
	bool is_2 = version >= 2 && version < 3, is_4 = version >= 4 && version < 4.15;
	gmsh->is_4_0 = version < 4.05;
	if (!is_2 && !is_4)
		cau_scan_fail(scan, CAU_UNSUPPORTED,
		              "Gmsh version %g: 1, 2.2, 4.0 and 4.1 are read (gmsh -save -format msh41)",
		              version);
	bool binary = cau_scan_text_integer(scan, "0 (text) or 1 (binary)", 0, 1);
	gmsh->size_bytes = (int)cau_scan_text_integer(scan, "4 or 8 (bytes of a number)", 4, 8);
	if (gmsh->size_bytes != 8 && (gmsh->size_bytes != 4 || is_2))
		cau_scan_fail(scan, CAU_UNSUPPORTED, "numbers of %d bytes", gmsh->size_bytes);
	if (binary)
		read_byte_order(scan);
	cau_scan_expect(scan, "$EndMeshFormat");
	snprintf(gmsh->builder->report.format, sizeof gmsh->builder->report.format, "Gmsh %.1f%s",
	         version, binary ? " binary" : "");
	return is_2 ? sections_2 : sections_4;
}

// Skips a section of this name, including its end.
static void skip_section(cau_scan *scan, cau_word name)
{
	CAU_ASSERT(name.length > 0 && name.text[0] == '$', "a section called by %zu letters",
	           name.length);
	char end[80];
	int length = snprintf(end, sizeof end, "$End%.*s",
	                      (int)(name.length < 64 ? name.length : 64) - 1, name.text + 1);
	const unsigned char *from = scan->bytes + scan->at;
	const unsigned char *found = memmem(from, cau_scan_left(scan), end, (size_t)length);
	if (!found) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "this section has no %s", end);
		return;
	}
	scan->at += (size_t)(found - from);
	cau_scan_skip_line(scan);
}

static void read_section(gmsh_file *gmsh, const section *known, cau_word name)
{
	CAU_ASSERT(name.length > 0, "a section without a name, at byte %zu", gmsh->scan->at);
	cau_scan *scan = gmsh->scan;
	if (name.text[0] != '$') {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected the name of a section ($...)");
		return;
	}
	while (known->name && !cau_word_is(name, known->name))
		known++;
	if (!known->name) {
		skip_section(scan, name);
		return;
	}
	cau_scan_skip_line(scan);
	known->read(gmsh);
	cau_scan_expect(scan, known->end);
}

cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	gmsh_file gmsh = {.scan = scan, .builder = builder};
	const section *known = sections_1;
	snprintf(builder->report.format, sizeof builder->report.format, "Gmsh 1");
	if (cau_word_is(cau_scan_peek(scan), "$MeshFormat")) {
		cau_scan_word(scan);
		known = read_header(&gmsh);
	}
	for (cau_word name = cau_scan_word(scan); name.length; name = cau_scan_word(scan))
		read_section(&gmsh, known, name);
	cau_node_map_finish(&gmsh.nodes);
	free(gmsh.entity);
	return scan->status;
}
