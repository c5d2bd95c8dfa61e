// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/primitives.h"

#include "cautery/assert.h"

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
		return cau_fail(error, CAU_LIMIT, NULL, "too many primitives for one tissue");

	cau_status status =
		check_rows("triangle", p->triangle, p->triangle_count, 3, p->vertex_count, error);
	if (!status)
		status = check_rows("tetrahedron", p->tetrahedron, p->tetrahedron_count, 4, p->vertex_count,
		                    error);
	if (!status)
		status = check_rows("link", p->link, p->link_count, 2, p->vertex_count, error);
	return status;
}
