// SPDX-License-Identifier: GPL-3.0-or-later
// The body-centred cubic lattice: corners of cubic cells and their centres. Two centres over a face
// and an edge of that face make a tetrahedron; all are alike.
#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "solid/tets.h"

static const double cells_most = 16e6;

typedef struct grid {
	const cau_domain *domain;
	double spacing, origin[3];
	int64_t cells[3];
	uint8_t *label[2];  // of corners, of centres
	int32_t *vertex[2]; // their numbers, -1: not used yet
} grid;

static size_t place_of(const grid *of, int kind, const int64_t index[3])
{
	size_t place = 0;
	for (int c = 2; c >= 0; c--) {
		CAU_ASSERT_INDEX(index[c], of->cells[c] + !kind);
		place = place * (size_t)(of->cells[c] + !kind) + (size_t)index[c];
	}
	return place;
}

static void position_of(const grid *of, int kind, const int64_t index[3], double x[3])
{
	for (int c = 0; c < 3; c++)
		x[c] = of->origin[c] + of->spacing * ((double)index[c] + (kind ? 0.5 : 0));
}

static void label_all(grid *of, int kind)
{
	int64_t index[3], *i = index;
	for (i[2] = 0; i[2] < of->cells[2] + !kind; i[2]++)
		for (i[1] = 0; i[1] < of->cells[1] + !kind; i[1]++)
			for (i[0] = 0; i[0] < of->cells[0] + !kind; i[0]++) {
				double x[3];
				size_t place = place_of(of, kind, index);
				position_of(of, kind, index, x);
				of->label[kind][place] = (uint8_t)of->domain->label_at(of->domain, x, NULL);
				of->vertex[kind][place] = -1;
			}
}

static int32_t vertex_at(grid *of, int kind, const int64_t index[3], cau_tets *tets)
{
	int32_t *number = &of->vertex[kind][place_of(of, kind, index)];
	if (*number < 0) {
		double x[3];
		position_of(of, kind, index, x);
		*number = cau_tets_vertex(tets, x, false);
	}
	return *number;
}

// The four tetrahedra around the edge from the centre of a cell to that of the next one along an
// axis.
static void add_around(grid *of, const int64_t cell[3], int axis, cau_tets *tets)
{
	int64_t next[3] = {cell[0], cell[1], cell[2]}, corner[4][3];
	int u = (axis + 1) % 3, v = (axis + 2) % 3;
	next[axis]++;
	int inside = of->label[1][place_of(of, 1, cell)] | of->label[1][place_of(of, 1, next)];
	for (int k = 0; k < 4; k++) {
		corner[k][axis] = next[axis];
		corner[k][u] = cell[u] + (k == 1 || k == 2);
		corner[k][v] = cell[v] + (k >= 2);
	}
	for (int k = 0; k < 4; k++) {
		const int64_t *a = corner[k], *b = corner[(k + 1) % 4];
		if (!(inside | of->label[0][place_of(of, 0, a)] | of->label[0][place_of(of, 0, b)]))
			continue;
		const int32_t vertex[4] = {vertex_at(of, 1, cell, tets), vertex_at(of, 1, next, tets),
		                           vertex_at(of, 0, a, tets), vertex_at(of, 0, b, tets)};
		cau_tets_add(tets, vertex, CAU_UNDECIDED);
	}
}

static void add_all(grid *of, cau_tets *tets)
{
	int64_t cell[3], *i = cell;
	for (i[2] = 0; i[2] < of->cells[2]; i[2]++)
		for (i[1] = 0; i[1] < of->cells[1]; i[1]++)
			for (i[0] = 0; i[0] < of->cells[0]; i[0]++)
				for (int axis = 0; axis < 3; axis++)
					if (cell[axis] + 1 < of->cells[axis])
						add_around(of, cell, axis, tets);
}

// A cell more on each side than the domain needs, so that no tetrahedron is missing at its border.
static cau_status lay_out(grid *of, cau_error *error)
{
	double cells = 1;
	for (int c = 0; c < 3; c++) {
		double width = of->domain->most[c] - of->domain->least[c];
		CAU_ASSERT(width >= 0 && of->spacing > 0, "%g wide, spacing %g", width, of->spacing);
		of->cells[c] = (int64_t)fmin(ceil(width / of->spacing), 1e7) + 4;
		of->origin[c] = of->domain->least[c] - (of->spacing * (double)of->cells[c] - width) / 2;
		cells *= (double)of->cells[c];
	}
	if (cells > cells_most)
		return cau_fail(error, CAU_LIMIT, "edge",
		                "an edge so short makes %.3g cells, of %.3g at most: choose a longer one",
		                cells, cells_most);
	return CAU_OK;
}

cau_status cau_lattice(const cau_domain *domain, double spacing, cau_tets *tets, cau_error *error)
{
	grid of = {.domain = domain, .spacing = spacing};
	tets->spacing = spacing;
	cau_status status = lay_out(&of, error);
	if (status)
		return status;
	for (int kind = 0; kind < 2; kind++) {
		size_t count = 1;
		for (int c = 0; c < 3; c++)
			count *= (size_t)(of.cells[c] + !kind);
		of.label[kind] = malloc(count);
		of.vertex[kind] = malloc(count * sizeof *of.vertex[kind]);
		tets->failed |= !of.label[kind] || !of.vertex[kind];
	}
	for (int kind = 0; kind < 2 && !tets->failed; kind++)
		label_all(&of, kind);
	if (!tets->failed)
		add_all(&of, tets);
	for (int kind = 0; kind < 2; kind++) {
		free(of.label[kind]);
		free(of.vertex[kind]);
	}
	return tets->failed ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the lattice")
	                    : CAU_OK;
}
