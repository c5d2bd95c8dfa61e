// SPDX-License-Identifier: GPL-3.0-or-later
// The table of edges, the check of primitives before tables are made, and the sort by vertices.
#include "mesh/edge_table.h"

#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

// Checks the primitives of one kind, (count x width).
static cau_status check_rows(const char *kind, const int32_t *row, int32_t count, int width,
                             int32_t vertex_count, cau_error *error)
{
	CAU_ASSERT(row || !count, "%d of kind %s are nowhere", count, kind);
	CAU_ASSERT(width >= 2 && width <= 4, "%s of %d corners", kind, width);
	for (int32_t i = 0; i < count; i++, row += width)
		for (int a = 0; a < width; a++) {
			if (row[a] < 0 || row[a] >= vertex_count)
				return cau_fail(error, CAU_BAD_MESH, NULL,
				                "%s %d names vertex %d, but there are %d vertices", kind, i, row[a],
				                vertex_count);
			for (int b = 0; b < a; b++)
				if (row[a] == row[b])
					return cau_fail(error, CAU_BAD_MESH, NULL, "%s %d has vertex %d twice", kind, i,
					                row[a]);
		}
	return CAU_OK;
}

cau_status cau_primitives_check(const cau_primitives *primitives, cau_error *error)
{
	const cau_primitives *p = primitives;
	if (p->vertex_count < 0 || p->vertex_count == INT32_MAX || p->triangle_count < 0 ||
	    p->tetrahedron_count < 0 || p->link_count < 0 ||
	    3 * (int64_t)p->triangle_count + 6 * (int64_t)p->tetrahedron_count + p->link_count >=
	        INT32_MAX)
		return cau_fail(
			error, CAU_LIMIT, NULL,
			"%d vertices, %d triangles, %d tetrahedra and %d links: counts are at least 0, "
			"and 3 triangles + 6 tetrahedra + links below %d",
			p->vertex_count, p->triangle_count, p->tetrahedron_count, p->link_count, INT32_MAX);

	cau_status status =
		check_rows("triangle", p->triangle, p->triangle_count, 3, p->vertex_count, error);
	if (!status)
		status = check_rows("tetrahedron", p->tetrahedron, p->tetrahedron_count, 4, p->vertex_count,
		                    error);
	if (!status)
		status = check_rows("link", p->link, p->link_count, 2, p->vertex_count, error);
	return status;
}

// ---- sorting
// Makes one stable pass of a counting sort: `to` is `from` ordered by key[row * stride]. bucket
// (bound + 1) is scratch.
static void counting_pass(const int32_t *key, int stride, const int32_t *from, int32_t count,
                          int32_t *bucket, int32_t bound, int32_t *to)
{
	memset(bucket, 0, ((size_t)bound + 1) * sizeof *bucket);
	for (int32_t i = 0; i < count; i++) {
		CAU_ASSERT_INDEX(key[(size_t)i * (size_t)stride], bound);
		bucket[key[(size_t)i * (size_t)stride] + 1]++;
	}
	for (int32_t k = 0; k < bound; k++)
		bucket[k + 1] += bucket[k];
	for (int32_t i = 0; i < count; i++)
		to[bucket[key[(size_t)from[i] * (size_t)stride]]++] = from[i];
}

bool cau_index_sort(const int32_t *tuple, int width, int32_t count, int32_t bound, int32_t *order)
{
	CAU_ASSERT(width >= 1 && count >= 0 && bound >= 0, "%d rows of %d below %d", count, width,
	           bound);
	int32_t *from = cau_mesh_array((size_t)count, sizeof *from);
	int32_t *bucket = cau_mesh_array((size_t)bound + 1, sizeof *bucket);
	bool done = from && bucket;

	for (int32_t i = 0; done && i < count; i++)
		order[i] = i;
	for (int column = width - 1; done && column >= 0; column--) {
		memcpy(from, order, (size_t)count * sizeof *from);
		counting_pass(tuple + column, width, from, count, bucket, bound, order);
	}
	free(from);
	free(bucket);
	return done;
}

// ---- the table of edges
// Every primitive writes its edges into consecutive slots: a triangle three, a tetrahedron six, a
// link one. Triangles come first, then tetrahedra, then links. The slots are then sorted by the two
// ends, so that all uses of an edge are next to each other.
static const int slots_of[CAU_PRIMITIVE_KINDS] = {3, 6, 1};
static const int corners_of[CAU_PRIMITIVE_KINDS] = {3, 4, 2};
static const int8_t ends_of[CAU_PRIMITIVE_KINDS][6][2] = {
	{{0, 1}, {1, 2}, {2, 0}},
	{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}},
	{{0, 1}},
};

typedef struct kind_rows {
	int32_t count;
	const int32_t *corner; // (count x corners_of)
} kind_rows;

static kind_rows rows_of(const cau_primitives *p, int kind)
{
	CAU_ASSERT_INDEX(kind, CAU_PRIMITIVE_KINDS);
	switch (kind) {
	case CAU_PRIMITIVE_TRIANGLE:
		return (kind_rows){p->triangle_count, p->triangle};
	case CAU_PRIMITIVE_TETRAHEDRON:
		return (kind_rows){p->tetrahedron_count, p->tetrahedron};
	default:
		return (kind_rows){p->link_count, p->link};
	}
}

// Writes the two ends of every slot, (slot_count x 2). The lower vertex comes first.
static void fill_slots(const cau_primitives *primitives, int32_t *end)
{
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		kind_rows rows = rows_of(primitives, kind);
		const int32_t *corner = rows.corner;
		for (int32_t i = 0; i < rows.count; i++, corner += corners_of[kind])
			for (int s = 0; s < slots_of[kind]; s++, end += 2) {
				end[0] = corner[ends_of[kind][s][0]];
				end[1] = corner[ends_of[kind][s][1]];
				cau_index_order_row(end, 2);
			}
	}
}

static bool same_edge(const int32_t *end, int32_t s, int32_t t)
{
	const int32_t *p = end + 2 * (size_t)s, *q = end + 2 * (size_t)t;
	return p[0] == q[0] && p[1] == q[1];
}

// Numbers the unique edges. Sets the ends of each edge in the table, and the edge of each slot
// (slot_count).
static bool number_edges(const int32_t *end, const int32_t *order, int32_t slot_count,
                         int32_t *edge_of_slot, cau_edge_table *table)
{
	int32_t edge = -1;
	for (int32_t i = 0; i < slot_count; i++) {
		if (i == 0 || !same_edge(end, order[i - 1], order[i]))
			edge++;
		edge_of_slot[order[i]] = edge;
	}
	table->edge_count = edge + 1;
	CAU_ASSERT(table->edge_count <= slot_count, "%d edges of %d slots", table->edge_count,
	           slot_count);
	table->vertex = cau_mesh_array(2 * (size_t)table->edge_count, sizeof *table->vertex);
	if (!table->vertex)
		return false;
	for (int32_t s = 0; s < slot_count; s++)
		memcpy(table->vertex + 2 * (size_t)edge_of_slot[s], end + 2 * (size_t)s, 2 * sizeof *end);
	return true;
}

// Lists the primitives of one kind that share each edge, in ascending order.
static bool fill_sharers(cau_edge_table *table, int kind, const int32_t *edge_of_slot,
                         int32_t slot_count)
{
	int32_t edge_count = table->edge_count;
	CAU_ASSERT_INDEX(kind, CAU_PRIMITIVE_KINDS);
	CAU_ASSERT(!table->first[kind], "the sharers of kind %d are made twice", kind);
	int32_t *first = cau_mesh_array((size_t)edge_count + 1, sizeof *first);
	int32_t *sharer = cau_mesh_array((size_t)slot_count, sizeof *sharer);
	table->first[kind] = first;
	table->sharer[kind] = sharer;
	if (!first || !sharer)
		return false;

	for (int32_t s = 0; s < slot_count; s++) {
		CAU_ASSERT_INDEX(edge_of_slot[s], edge_count);
		first[edge_of_slot[s]]++;
	}
	for (int32_t e = 0, sum = 0; e <= edge_count; e++) {
		sum += first[e];
		first[e] = sum;
	}
	// Fills from the back, so that first[e] ends at the start of the list of edge e.
	for (int32_t s = slot_count - 1; s >= 0; s--)
		sharer[--first[edge_of_slot[s]]] = s / slots_of[kind];
	CAU_ASSERT(first[0] == 0 && first[edge_count] == slot_count, "rows from %d to %d of %d slots",
	           first[0], first[edge_count], slot_count);
	return true;
}

// Fills the sharers of all kinds. Each kind uses its own part of edge_of_slot. The part of the
// triangles is also kept as triangle_edge.
static bool fill_kinds(const cau_primitives *primitives, const int32_t *edge_of_slot,
                       cau_edge_table *table)
{
	size_t triangle_slots = 3 * (size_t)primitives->triangle_count;
	table->triangle_edge = cau_mesh_array(triangle_slots, sizeof *table->triangle_edge);
	if (!table->triangle_edge)
		return false;
	memcpy(table->triangle_edge, edge_of_slot, triangle_slots * sizeof *edge_of_slot);
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		int32_t slot_count = rows_of(primitives, kind).count * slots_of[kind];
		if (!fill_sharers(table, kind, edge_of_slot, slot_count))
			return false;
		edge_of_slot += slot_count;
	}
	return true;
}

typedef struct layer_triangle {
	int32_t layer;
	int32_t triangle;
} layer_triangle;

static int compare_layers(const void *left, const void *right)
{
	const layer_triangle *a = left, *b = right;
	int layers = (a->layer > b->layer) - (a->layer < b->layer);
	return layers ? layers : (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

// Appends the hinges of edge e and returns the new number of hinges. While the table has no arrays
// of hinges, the hinges are only counted. `row` is scratch.
static int32_t add_hinges(cau_edge_table *table, const int32_t *triangle_layer, int32_t e,
                          layer_triangle *row, int32_t hinge_count)
{
	int32_t start = table->first[CAU_PRIMITIVE_TRIANGLE][e];
	int32_t length = table->first[CAU_PRIMITIVE_TRIANGLE][e + 1] - start;
	CAU_ASSERT(length >= 0, "%d triangles on edge %d", length, e);
	for (int32_t i = 0; i < length; i++) {
		int32_t triangle = table->sharer[CAU_PRIMITIVE_TRIANGLE][start + i];
		row[i] = (layer_triangle){triangle_layer[triangle], triangle};
	}
	if (length > 2)
		qsort(row, (size_t)length, sizeof *row, compare_layers);
	for (int32_t i = 0, next; i < length; i = next) {
		for (next = i + 1; next < length && row[next].layer == row[i].layer;)
			next++;
		if (next - i != 2)
			continue;
		if (table->hinge_edge) {
			CAU_ASSERT_INDEX(hinge_count, table->hinge_count);
			table->hinge_edge[hinge_count] = e;
			table->hinge_triangle[2 * (size_t)hinge_count] = row[i].triangle;
			table->hinge_triangle[2 * (size_t)hinge_count + 1] = row[i + 1].triangle;
		}
		hinge_count++;
	}
	return hinge_count;
}

static int32_t add_all_hinges(cau_edge_table *table, const int32_t *triangle_layer,
                              layer_triangle *row)
{
	int32_t hinge_count = 0;
	for (int32_t e = 0; e < table->edge_count; e++)
		hinge_count = add_hinges(table, triangle_layer, e, row, hinge_count);
	return hinge_count;
}

static bool fill_hinges(cau_edge_table *table, int32_t triangle_count,
                        const int32_t *triangle_layer)
{
	CAU_ASSERT(!table->hinge_edge, "%d hinges are there already", table->hinge_count);
	layer_triangle *row = cau_mesh_array((size_t)triangle_count, sizeof *row);
	if (!row)
		return false;
	table->hinge_count = add_all_hinges(table, triangle_layer, row);
	table->hinge_edge = cau_mesh_array((size_t)table->hinge_count, sizeof *table->hinge_edge);
	table->hinge_triangle =
		cau_mesh_array(2 * (size_t)table->hinge_count, sizeof *table->hinge_triangle);
	bool done = table->hinge_edge && table->hinge_triangle;
	if (done)
		add_all_hinges(table, triangle_layer, row);
	free(row);
	return done;
}

cau_status cau_edge_table_make(const cau_primitives *primitives, const int32_t *triangle_layer,
                               cau_edge_table *table, cau_error *error)
{
	*table = (cau_edge_table){0};
	cau_status status = cau_primitives_check(primitives, error);
	if (status)
		return status;

	int32_t slot_count =
		3 * primitives->triangle_count + 6 * primitives->tetrahedron_count + primitives->link_count;
	int32_t *end = cau_mesh_array(2 * (size_t)slot_count, sizeof *end);
	int32_t *order = cau_mesh_array((size_t)slot_count, sizeof *order);
	int32_t *edge_of_slot = cau_mesh_array((size_t)slot_count, sizeof *edge_of_slot);
	bool done = end && order && edge_of_slot;
	if (done) {
		fill_slots(primitives, end);
		done = cau_index_sort(end, 2, slot_count, primitives->vertex_count, order) &&
		       number_edges(end, order, slot_count, edge_of_slot, table) &&
		       fill_kinds(primitives, edge_of_slot, table) &&
		       fill_hinges(table, primitives->triangle_count, triangle_layer);
	}
	free(end);
	free(order);
	free(edge_of_slot);
	if (done)
		return CAU_OK;
	cau_edge_table_finish(table);
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the edges of a tissue");
}

void cau_edge_table_finish(cau_edge_table *table)
{
	free(table->vertex);
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		free(table->first[kind]);
		free(table->sharer[kind]);
	}
	free(table->triangle_edge);
	free(table->hinge_edge);
	free(table->hinge_triangle);
	*table = (cau_edge_table){0};
}

int32_t cau_edge_table_find(const cau_edge_table *table, int32_t a, int32_t b)
{
	CAU_ASSERT(a >= 0 && b >= 0, "the edge of vertices %d and %d", a, b);
	int32_t wanted[2] = {a, b};
	cau_index_order_row(wanted, 2);
	int32_t low = 0, high = table->edge_count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		const int32_t *vertex = table->vertex + 2 * (size_t)middle;
		if (vertex[0] < wanted[0] || (vertex[0] == wanted[0] && vertex[1] < wanted[1]))
			low = middle + 1;
		else
			high = middle;
	}
	if (low == table->edge_count)
		return -1;
	const int32_t *found = table->vertex + 2 * (size_t)low;
	return found[0] == wanted[0] && found[1] == wanted[1] ? low : -1;
}
