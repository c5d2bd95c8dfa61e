// SPDX-License-Identifier: GPL-3.0-or-later
// The body-centred cubic lattice: the corners and the centres of cubic cells. Two neighbouring
// centres and an edge of the face between them make a tetrahedron. All tetrahedra have the same
// shape.
#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "solid/mesher.h"

static const double cells_most = 16e6;
// Cells of a block along an axis. Measured for 2, 3, 4 and 8: blocks of 2 query most boxes, blocks
// of 8 most points. Blocks of 3 and 4 take the same time for balls, shells and slivers.
enum { BLOCK = 4 };
// Most boxes on the stack; 16 million cells are halved 24 times, and once more along each axis.
enum { STACK = 64 };

typedef struct grid {
	const cau_domain *domain;
	double spacing, origin[3];
	int64_t cells[3], blocks[3];
	bool *empty;        // (blocks): no cell of the block has a tetrahedron
	uint8_t *label[2];  // labels of the corners and of the centres
	int32_t *vertex[2]; // vertices of the corners and of the centres, from 1; 0: not used yet
} grid;

// A box of cells or blocks.
typedef struct span {
	int64_t begin[3], end[3];
} span;

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

// ---- labels
// Labels the corners and centres of some cells. A cell has the corners at its low sides. The last
// cells of the lattice also have the corners at their high sides. If `label` < 0, the domain gives
// the label of each point.
static void label_cells(grid *of, const span *cells, int32_t label)
{
	for (int kind = 0; kind < 2; kind++) {
		int64_t end[3], index[3], *i = index;
		for (int c = 0; c < 3; c++)
			end[c] = cells->end[c] + (!kind && cells->end[c] == of->cells[c]);
		for (i[2] = cells->begin[2]; i[2] < end[2]; i[2]++)
			for (i[1] = cells->begin[1]; i[1] < end[1]; i[1]++)
				for (i[0] = cells->begin[0]; i[0] < end[0]; i[0]++) {
					double x[3];
					position_of(of, kind, index, x);
					of->label[kind][place_of(of, kind, index)] =
						(uint8_t)(label < 0 ? of->domain->label_at(of->domain, x, NULL) : label);
				}
	}
}

static size_t block_of(const grid *of, const int64_t block[3])
{
	size_t place = 0;
	for (int c = 2; c >= 0; c--) {
		CAU_ASSERT_INDEX(block[c], of->blocks[c]);
		place = place * (size_t)of->blocks[c] + (size_t)block[c];
	}
	return place;
}

static void mark_empty(grid *of, const span *blocks)
{
	int64_t block[3], *b = block;
	for (b[2] = blocks->begin[2]; b[2] < blocks->end[2]; b[2]++)
		for (b[1] = blocks->begin[1]; b[1] < blocks->end[1]; b[1]++)
			for (b[0] = blocks->begin[0]; b[0] < blocks->end[0]; b[0]++)
				of->empty[block_of(of, block)] = true;
}

// Whether all points that the tetrahedra of some blocks can use have one label. These tetrahedra
// reach to the centres of the next cells.
static bool blocks_are_uniform(const grid *of, const span *cells, int32_t *label)
{
	double least[3], most[3], next[3];
	position_of(of, 0, cells->begin, least);
	position_of(of, 0, cells->end, most);
	position_of(of, 1, cells->end, next);
	for (int c = 0; c < 3; c++)
		most[c] = cells->end[c] < of->cells[c] ? next[c] : most[c];
	return of->domain->is_uniform(of->domain, least, most, label);
}

// Labels all points. Boxes are halved until they are uniform or single blocks. So the cost depends
// on the surface of the tissue, not on the volume of the box around it.
static void label_all(grid *of)
{
	span stack[STACK] = {{.end = {of->blocks[0], of->blocks[1], of->blocks[2]}}};
	for (int depth = 1; depth;) {
		span blocks = stack[--depth], cells;
		int32_t label = 0;
		int axis = 0;
		for (int c = 0; c < 3; c++) {
			cells.begin[c] = blocks.begin[c] * BLOCK;
			cells.end[c] =
				blocks.end[c] * BLOCK < of->cells[c] ? blocks.end[c] * BLOCK : of->cells[c];
			if (blocks.end[c] - blocks.begin[c] > blocks.end[axis] - blocks.begin[axis])
				axis = c;
		}
		int64_t half = (blocks.end[axis] - blocks.begin[axis]) / 2;
		if (blocks_are_uniform(of, &cells, &label)) {
			if (label)
				label_cells(of, &cells, label);
			else
				mark_empty(of, &blocks);
		} else if (!half) {
			label_cells(of, &cells, -1);
		} else {
			CAU_ASSERT(depth + 2 <= STACK, "a stack of more than %d", STACK);
			stack[depth++] = blocks;
			stack[depth - 1].end[axis] = blocks.begin[axis] + half;
			stack[depth++] = blocks;
			stack[depth - 1].begin[axis] = blocks.begin[axis] + half;
		}
	}
}

// ---- tetrahedra
static int32_t vertex_at(grid *of, int kind, const int64_t index[3], cau_tets *tets)
{
	int32_t *number = &of->vertex[kind][place_of(of, kind, index)];
	if (!*number) {
		double x[3];
		position_of(of, kind, index, x);
		*number = cau_tets_vertex(tets, x, false) + 1;
	}
	return *number - 1;
}

// Adds the four tetrahedra around the line from the centre of a cell to the centre of the next cell
// along an axis.
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

static bool is_empty(const grid *of, const int64_t cell[3])
{
	return of->empty[block_of(of, (int64_t[3]){cell[0] / BLOCK, cell[1] / BLOCK, cell[2] / BLOCK})];
}

static void add_all(grid *of, cau_tets *tets)
{
	int64_t cell[3], *i = cell;
	for (i[2] = 0; i[2] < of->cells[2]; i[2]++)
		for (i[1] = 0; i[1] < of->cells[1]; i[1]++)
			for (i[0] = 0; i[0] < of->cells[0]; i[0]++) {
				if (i[0] % BLOCK == 0 && is_empty(of, cell)) {
					i[0] += BLOCK - 1;
					continue;
				}
				for (int axis = 0; axis < 3; axis++)
					if (cell[axis] + 1 < of->cells[axis])
						add_around(of, cell, axis, tets);
			}
}

// Sets the number of cells and the origin. The lattice has one more cell on each side than the
// domain needs, so that no tetrahedron is missing at its border.
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
		                "this edge is too short: it gives %.3g cells, and at most %.3g are "
		                "allowed: choose a longer one",
		                cells, cells_most);
	return CAU_OK;
}

// Allocates zeroed arrays, so that the memory pages of empty blocks are never used.
static bool make_arrays(grid *of)
{
	size_t blocks = 1;
	bool made = true;
	for (int c = 0; c < 3; c++) {
		of->blocks[c] = (of->cells[c] + BLOCK - 1) / BLOCK;
		blocks *= (size_t)of->blocks[c];
	}
	of->empty = calloc(blocks, sizeof *of->empty);
	for (int kind = 0; kind < 2; kind++) {
		size_t count = 1;
		for (int c = 0; c < 3; c++)
			count *= (size_t)(of->cells[c] + !kind);
		of->label[kind] = calloc(count, 1);
		of->vertex[kind] = calloc(count, sizeof *of->vertex[kind]);
		made &= of->label[kind] && of->vertex[kind];
	}
	return made && of->empty;
}

cau_status cau_lattice(const cau_domain *domain, double spacing, cau_tets *tets, cau_error *error)
{
	grid of = {.domain = domain, .spacing = spacing};
	tets->spacing = spacing;
	cau_status status = lay_out(&of, error);
	if (status)
		return status;
	if (make_arrays(&of)) {
		label_all(&of);
		add_all(&of, tets);
	} else {
		tets->failed = true;
	}
	free(of.empty);
	for (int kind = 0; kind < 2; kind++) {
		free(of.label[kind]);
		free(of.vertex[kind]);
	}
	return tets->failed ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the lattice")
	                    : CAU_OK;
}
