// SPDX-License-Identifier: GPL-3.0-or-later
// The pattern of the factor of H in blocks: that of A's, as both couple the same vertices. Found
// here from the pattern of A, since A's own factor may be in the making on another thread; its
// order may be read at any time.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/newton.h"
#include "solve/solver.h"

static int compare_rows(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

// Columns of L as they are found: the rows of each, and its children in the elimination tree.
typedef struct growth {
	cau_newton *newton;
	int32_t *below_first, *below; // A by column, rows below the diagonal, in the factor's order
	int32_t *child, *sibling;     // (n): -1 ends
	int32_t *mark;                // (n): the last column that had this row
	int32_t count;                // blocks so far
} growth;

static void add_row(growth *of, int32_t column, int32_t row)
{
	CAU_ASSERT(row >= column, "row %d of column %d", row, column);
	if (of->mark[row] == column)
		return;
	of->mark[row] = column;
	of->newton->row[of->count++] = row;
}

// Rows of a column of L: A's, and those of its children but itself.
static void grow(growth *of, int32_t column)
{
	cau_newton *newton = of->newton;
	int32_t first = of->count;
	newton->first[column] = first;
	of->mark[column] = column;
	for (int32_t k = of->below_first[column]; k < of->below_first[column + 1]; k++)
		add_row(of, column, of->below[k]);
	for (int32_t child = of->child[column]; child >= 0; child = of->sibling[child])
		for (int32_t k = newton->first[child]; k < newton->first[child + 1]; k++)
			add_row(of, column, newton->row[k]);
	newton->first[column + 1] = of->count;
	if (of->count == first)
		return;
	qsort(newton->row + first, (size_t)(of->count - first), sizeof *newton->row, compare_rows);
	int32_t parent = newton->row[first];
	of->sibling[column] = of->child[parent];
	of->child[parent] = column;
}

// A's entries below the diagonal, each in the column that comes first in the factor's order.
static void permute(growth *of, const cau_matrix *matrix, const int32_t *places)
{
	for (int pass = 0; pass < 2; pass++) {
		for (int32_t c = 0; c < matrix->n; c++)
			for (int32_t k = matrix->first[c]; k < matrix->first[c + 1]; k++) {
				int32_t a = places[c], b = places[matrix->row[k]];
				int32_t column = a < b ? a : b;
				if (a == b)
					continue;
				if (!pass)
					of->below_first[column + 2]++;
				else
					of->below[of->below_first[column + 1]++] = a < b ? b : a;
			}
		for (int32_t c = 0; !pass && c < matrix->n; c++)
			of->below_first[c + 2] += of->below_first[c + 1];
	}
}

static bool find_pattern(cau_newton *newton, const cau_matrix *matrix, const int32_t *places)
{
	size_t n = (size_t)matrix->n;
	growth of = {.newton = newton,
	             .below_first = calloc(n + 2, sizeof(int32_t)),
	             .below = calloc((size_t)matrix->first[matrix->n], sizeof(int32_t)),
	             .child = malloc(n * sizeof(int32_t)),
	             .sibling = malloc(n * sizeof(int32_t)),
	             .mark = malloc(n * sizeof(int32_t))};
	bool room = of.below_first && of.below && of.child && of.sibling && of.mark;
	if (room) {
		memset(of.child, -1, n * sizeof(int32_t));
		memset(of.sibling, -1, n * sizeof(int32_t));
		memset(of.mark, -1, n * sizeof(int32_t));
		permute(&of, matrix, places);
		for (int32_t c = 0; c < matrix->n; c++)
			grow(&of, c);
	}
	free(of.below_first);
	free(of.below);
	free(of.child);
	free(of.sibling);
	free(of.mark);
	return room;
}

static bool make_room(cau_newton *newton, size_t vertices, size_t n, size_t blocks)
{
	size_t block = CAU_BLOCK * sizeof(double);
	newton->place = malloc(vertices * sizeof(int32_t));
	newton->first = malloc((n + 1) * sizeof(int32_t));
	newton->row = malloc((blocks + 1) * sizeof(int32_t));
	newton->block = aligned_alloc(64, (blocks * block + 64) / 64 * 64);
	newton->pivot = aligned_alloc(64, (n * block + 64) / 64 * 64);
	newton->inverse = aligned_alloc(64, (n * block + 64) / 64 * 64);
	newton->column = aligned_alloc(64, (n * block + 64) / 64 * 64);
	newton->field = aligned_alloc(64, (4 * n * sizeof(double) + 64) / 64 * 64);
	newton->next = malloc(n * sizeof(int32_t));
	newton->head = malloc(n * sizeof(int32_t));
	newton->at = malloc(n * sizeof(int32_t));
	return newton->place && newton->first && newton->row && newton->block && newton->pivot &&
	       newton->inverse && newton->column && newton->field && newton->next && newton->head &&
	       newton->at;
}

cau_status cau_newton_create(cau_newton *newton, const cau_step_solver *solver, cau_error *error)
{
	const cau_system *system = &solver->system;
	size_t n = (size_t)system->row_count, vertices = (size_t)solver->tissue->vertex_count;
	size_t entries = (size_t)cau_factor_entries(solver->factor);
	const int32_t *places = cau_factor_places(solver->factor);
	CAU_ASSERT(!newton->n && entries >= n, "%zu entries of %zu rows", entries, n);
	if (!make_room(newton, vertices, n, entries - n) ||
	    !find_pattern(newton, &system->matrix, places)) {
		cau_newton_finish(newton);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for Newton's steps");
	}
	CAU_ASSERT((size_t)newton->first[n] + n == entries, "%d blocks and %zu rows, not %zu",
	           newton->first[n], n, entries);
	for (size_t v = 0; v < vertices; v++)
		newton->place[v] = system->row_of_vertex[v] < 0 ? -1 : places[system->row_of_vertex[v]];
	newton->n = system->row_count;
	return CAU_OK;
}

void cau_newton_finish(cau_newton *newton)
{
	free(newton->place);
	free(newton->first);
	free(newton->row);
	free(newton->block);
	free(newton->pivot);
	free(newton->inverse);
	free(newton->column);
	free(newton->field);
	free(newton->next);
	free(newton->head);
	free(newton->at);
	*newton = (cau_newton){0};
}
