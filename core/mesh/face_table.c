// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "cautery/assert.h"
#include "mesh/edge_table.h"
#include "mesh/mesh.h"

// Slots hold the sheets' triangles first, then four faces of each tetrahedron. Slots are sorted by
// their vertices. Then the slots of one face are next to each other, and triangles that cover the
// face come first.

// The face opposite each corner, counter-clockwise seen from outside a tetrahedron of positive
// volume.
static const int8_t face_corner[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// Writes the vertices of every slot in ascending order, (slot_count x 3).
static void fill_slots(const cau_primitives *p, int32_t *key)
{
	if (p->triangle_count)
		memcpy(key, p->triangle, 3 * (size_t)p->triangle_count * sizeof *key);
	int32_t *fat = key + 3 * (size_t)p->triangle_count;
	for (size_t i = 0; i < 4 * (size_t)p->tetrahedron_count; i++)
		for (int c = 0; c < 3; c++)
			fat[3 * i + (size_t)c] = p->tetrahedron[4 * (i / 4) + (size_t)face_corner[i % 4][c]];
	size_t slot_count = (size_t)p->triangle_count + 4 * (size_t)p->tetrahedron_count;
	for (size_t s = 0; s < slot_count; s++)
		cau_index_order_row(key + 3 * s, 3);
}

// Returns the position after the run of equal keys that starts at `from`.
static int32_t run_end(const int32_t *key, const int32_t *order, int32_t from, int32_t slot_count)
{
	CAU_ASSERT_INDEX(from, slot_count);
	const int32_t *first = key + 3 * (size_t)order[from];
	int32_t next = from + 1;
	while (next < slot_count && !memcmp(first, key + 3 * (size_t)order[next], 3 * sizeof *key))
		next++;
	return next;
}

// Counts the faces of the table: all triangles, and each run of slots that contains a tetrahedron.
// The last slot of such a run belongs to a tetrahedron.
static int32_t count_faces(const int32_t *key, const int32_t *order, int32_t slot_count,
                           int32_t triangle_count)
{
	int32_t face_count = triangle_count;
	for (int32_t i = 0; i < slot_count;) {
		i = run_end(key, order, i, slot_count);
		face_count += order[i - 1] >= triangle_count;
	}
	CAU_ASSERT(face_count <= slot_count, "%d faces of %d slots", face_count, slot_count);
	return face_count;
}

static bool reserve(cau_face_table *table, int32_t tetrahedron_count)
{
	size_t faces = (size_t)table->face_count;
	table->vertex = cau_mesh_array(3 * faces, sizeof *table->vertex);
	table->owner = cau_mesh_array(2 * faces, sizeof *table->owner);
	table->cover = cau_mesh_array(faces, sizeof *table->cover);
	table->tetrahedron_face =
		cau_mesh_array(4 * (size_t)tetrahedron_count, sizeof *table->tetrahedron_face);
	table->triangle_covers =
		cau_mesh_array((size_t)table->triangle_count, sizeof *table->triangle_covers);
	return table->vertex && table->owner && table->cover && table->tetrahedron_face &&
	       table->triangle_covers;
}

// Fills the sheets' own faces. They have no owner and no cover. fill_fat_face finds which face of a
// tetrahedron a triangle covers.
static void fill_sheet_faces(const cau_primitives *p, cau_face_table *table)
{
	if (p->triangle_count)
		memcpy(table->vertex, p->triangle, 3 * (size_t)p->triangle_count * sizeof *table->vertex);
	for (size_t t = 0; t < (size_t)p->triangle_count; t++) {
		table->owner[2 * t] = table->owner[2 * t + 1] = -1;
		table->cover[t] = table->triangle_covers[t] = -1;
	}
}

// Fills one face of a tetrahedron from its run of slots: first `covers` triangles, then one or two
// tetrahedra.
static void fill_fat_face(const cau_primitives *p, const int32_t *run, int32_t covers,
                          int32_t owners, int32_t face, cau_face_table *table)
{
	CAU_ASSERT(owners == 1 || owners == 2, "face %d has %d tetrahedra", face, owners);
	CAU_ASSERT_INDEX(face, table->face_count);
	int32_t *owner = table->owner + 2 * (size_t)face;
	owner[1] = -1;
	for (int32_t i = 0; i < owners; i++) {
		int32_t slot = run[covers + i] - p->triangle_count;
		CAU_ASSERT_INDEX(slot, 4 * p->tetrahedron_count);
		table->tetrahedron_face[slot] = face;
		owner[i] = slot / 4;
	}
	table->cover[face] = covers ? run[0] : -1;
	for (int32_t i = 0; i < covers; i++)
		table->triangle_covers[run[i]] = face;

	const int8_t *corner = face_corner[(run[covers] - p->triangle_count) % 4];
	for (int c = 0; c < 3; c++)
		table->vertex[3 * (size_t)face + (size_t)c] =
			p->tetrahedron[4 * (size_t)owner[0] + (size_t)corner[c]];
}

static cau_status fill_fat_faces(const cau_primitives *p, const int32_t *key, const int32_t *order,
                                 int32_t slot_count, cau_face_table *table, cau_error *error)
{
	int32_t face = p->triangle_count;
	for (int32_t i = 0, next; i < slot_count; i = next) {
		next = run_end(key, order, i, slot_count);
		int32_t covers = 0;
		while (i + covers < next && order[i + covers] < p->triangle_count)
			covers++;
		int32_t owners = next - i - covers;
		if (owners > 2) {
			const int32_t *slot = order + i + covers, *vertex = key + 3 * (size_t)slot[0];
			return cau_fail(error, CAU_BAD_MESH, NULL,
			                "tetrahedra %d, %d and %d share one face (vertices %d, %d, %d): at "
			                "most two can",
			                (slot[0] - p->triangle_count) / 4, (slot[1] - p->triangle_count) / 4,
			                (slot[2] - p->triangle_count) / 4, vertex[0], vertex[1], vertex[2]);
		}
		if (owners)
			fill_fat_face(p, order + i, covers, owners, face++, table);
	}
	CAU_ASSERT(face == table->face_count, "%d faces filled of %d", face, table->face_count);
	return CAU_OK;
}

cau_status cau_face_table_make(const cau_primitives *primitives, cau_face_table *table,
                               cau_error *error)
{
	const cau_primitives *p = primitives;
	*table = (cau_face_table){0};
	cau_status status = cau_primitives_check(p, error);
	if (status)
		return status;

	int32_t slot_count = p->triangle_count + 4 * p->tetrahedron_count;
	int32_t *key = cau_mesh_array(3 * (size_t)slot_count, sizeof *key);
	int32_t *order = cau_mesh_array((size_t)slot_count, sizeof *order);
	bool memory = key && order;
	if (memory) {
		fill_slots(p, key);
		memory = cau_index_sort(key, 3, slot_count, p->vertex_count, order);
	}
	if (memory) {
		table->triangle_count = p->triangle_count;
		table->face_count = count_faces(key, order, slot_count, p->triangle_count);
		memory = reserve(table, p->tetrahedron_count);
	}
	if (memory) {
		fill_sheet_faces(p, table);
		status = fill_fat_faces(p, key, order, slot_count, table, error);
	} else {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the faces of a tissue");
	}
	free(key);
	free(order);
	if (status)
		cau_face_table_finish(table);
	return status;
}

void cau_face_table_finish(cau_face_table *table)
{
	free(table->vertex);
	free(table->owner);
	free(table->cover);
	free(table->tetrahedron_face);
	free(table->triangle_covers);
	*table = (cau_face_table){0};
}
