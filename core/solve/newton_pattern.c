// SPDX-License-Identifier: GPL-3.0-or-later
// Finds a region's rows, its elements, and the pattern of the factor of its H. Vertices are coupled
// where A couples them. Rows are in the order of A's factor. Another thread may be computing that
// factor, but its order may be read at any time.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/newton.h"
#include "solve/solver.h"

// ---- memory

// Replaces *array by one with capacity for twice `count` items of `bytes`. The old contents are
// lost. Returns false if there is no memory.
static bool make_room(void *array, size_t count, size_t bytes)
{
	void **at = array;
	size_t all = (2 * count * bytes + 127) / 64 * 64;
	free(*at);
	return (*at = aligned_alloc(64, all)) != NULL;
}

static bool make_rows(cau_newton *newton, int32_t n)
{
	const size_t block = CAU_BLOCK * sizeof(double), four = 4 * sizeof(double);
	size_t count = (size_t)n;
	if (n <= newton->capacity.rows)
		return true;
	newton->capacity.rows = 2 * n;
	return make_room(&newton->vertex, count, sizeof(int32_t)) &&
	       make_room(&newton->first, count + 1, sizeof(int32_t)) &&
	       make_room(&newton->pivot, count, block) && make_room(&newton->inverse, count, block) &&
	       make_room(&newton->column, count, block) && make_room(&newton->field, count, four) &&
	       make_room(&newton->gradient, count, four) && make_room(&newton->from, count, four) &&
	       make_room(&newton->next, count, sizeof(int32_t)) &&
	       make_room(&newton->head, count, sizeof(int32_t)) &&
	       make_room(&newton->at, count, sizeof(int32_t)) &&
	       make_room(&newton->room, count, sizeof(double));
}

static bool make_blocks(cau_newton *newton, int32_t count)
{
	if (count <= newton->capacity.blocks)
		return true;
	int32_t room = 2 * count, *row = realloc(newton->row, (size_t)room * sizeof *row);
	if (!row)
		return false;
	newton->row = row;
	newton->capacity.blocks = room;
	return make_room(&newton->block, (size_t)count, CAU_BLOCK * sizeof(double));
}

// ---- rows

static void add_vertex(cau_newton *newton, int32_t vertex)
{
	newton->place[vertex] = newton->n;
	newton->vertex[newton->n++] = vertex;
}

static bool place_part(cau_newton *newton, const cau_newton *from)
{
	if (!make_rows(newton, from->n))
		return false;
	for (int32_t i = 0; i < from->n; i++)
		if (newton->chosen[from->vertex[i]])
			add_vertex(newton, from->vertex[i]);
	return true;
}

static bool place_all(cau_newton *newton, const cau_step_solver *solver)
{
	const cau_system *system = &solver->system;
	const int32_t *places = cau_factor_places(solver->factor);
	int32_t count = 0, *vertex_at = malloc((size_t)system->row_count * sizeof *vertex_at);
	if (!vertex_at)
		return false;
	for (int32_t row = 0; row < system->row_count; row++) {
		vertex_at[places[row]] = system->vertex_of_row[row];
		count += newton->chosen[system->vertex_of_row[row]];
	}
	bool room = make_rows(newton, count);
	for (int32_t i = 0; i < system->row_count && room; i++)
		if (newton->chosen[vertex_at[i]])
			add_vertex(newton, vertex_at[i]);
	free(vertex_at);
	return room;
}

static bool place_vertices(cau_newton *newton, const cau_step_solver *solver,
                           const cau_newton *from)
{
	size_t bytes = (size_t)solver->tissue->vertex_count * sizeof *newton->place;
	if (!newton->place && !(newton->place = malloc(bytes)))
		return false;
	memset(newton->place, -1, bytes);
	newton->n = 0;
	return from ? place_part(newton, from) : place_all(newton, solver);
}

// ---- elements

static bool add_element(cau_newton *newton, cau_newton_element element)
{
	if (newton->element_count == newton->capacity.elements) {
		int32_t room = 2 * newton->capacity.elements + 256;
		cau_newton_element *more = realloc(newton->element, (size_t)room * sizeof *more);
		if (!more)
			return false;
		newton->element = more;
		newton->capacity.elements = room;
	}
	newton->element[newton->element_count++] = element;
	return true;
}

static bool has_row(const cau_newton *newton, const cau_step_solver *solver,
                    cau_newton_element element)
{
	const cau_elements *elements = &solver->elements;
	const cau_local_work *work = &solver->slots.work[element.work];
	uint16_t *const *records = work->kind == CAU_ELEMENT_TRIANGLE ? elements->sheet.record_at
	                           : work->kind == CAU_ELEMENT_LINK   ? elements->link.record_at
	                                                              : elements->hinge.record_at;
	int count = work->kind == CAU_ELEMENT_TRIANGLE ? 3 : work->kind == CAU_ELEMENT_LINK ? 2 : 4;
	for (int i = 0; i < count; i++) {
		int32_t record = work->first_record + records[i][element.slot] / 4;
		if (newton->place[elements->record_vertex[record] / 4] >= 0)
			return true;
	}
	return false;
}

static bool find_elements(cau_newton *newton, const cau_step_solver *solver, const cau_newton *from)
{
	newton->element_count = 0;
	for (int32_t k = 0; from && k < from->element_count; k++)
		if (has_row(newton, solver, from->element[k]) && !add_element(newton, from->element[k]))
			return false;
	for (int32_t w = 0; !from && w < solver->slots.work_count; w++) {
		const cau_local_work *work = &solver->slots.work[w];
		if (work->kind == CAU_ELEMENT_TETRAHEDRON)
			continue;
		for (int32_t slot = work->first; slot < work->last; slot++) {
			cau_newton_element element = {w, slot};
			if (has_row(newton, solver, element) && !add_element(newton, element))
				return false;
		}
	}
	return true;
}

// ---- the factor

static int compare_rows(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

// The columns of L while they are computed: the rows of each column, and the column's children in
// the elimination tree.
typedef struct growth {
	cau_newton *newton;
	// A's entries below the diagonal, by column, in the factor's order
	int32_t *below_first, *below;
	int32_t *child, *sibling; // (n): lists of children; -1 ends a list
	int32_t *mark;            // (n): last column to which the row was added
	int32_t count;            // blocks so far
} growth;

static void add_row(growth *of, int32_t column, int32_t row)
{
	CAU_ASSERT(row >= column, "row %d of column %d", row, column);
	if (of->mark[row] == column)
		return;
	of->mark[row] = column;
	of->newton->row[of->count++] = row;
}

// Finds the rows of a column of L: the rows of A's column and of the children's columns, without
// the row of the column itself.
static bool grow(growth *of, int32_t column)
{
	cau_newton *newton = of->newton;
	int32_t first = of->count;
	if (!make_blocks(newton, of->count + newton->n))
		return false;
	newton->first[column] = first;
	of->mark[column] = column;
	for (int32_t k = of->below_first[column]; k < of->below_first[column + 1]; k++)
		add_row(of, column, of->below[k]);
	for (int32_t child = of->child[column]; child >= 0; child = of->sibling[child])
		for (int32_t k = newton->first[child]; k < newton->first[child + 1]; k++)
			add_row(of, column, newton->row[k]);
	newton->first[column + 1] = of->count;
	if (of->count == first)
		return true;
	qsort(newton->row + first, (size_t)(of->count - first), sizeof *newton->row, compare_rows);
	int32_t parent = newton->row[first];
	of->sibling[column] = of->child[parent];
	of->child[parent] = column;
	return true;
}

// Lists A's off-diagonal entries between rows of the region, in the factor's order. Each entry is
// listed once, in the column of its earlier row.
static void permute(growth *of, const cau_system *system)
{
	const cau_matrix *matrix = &system->matrix;
	const cau_newton *newton = of->newton;
	for (int pass = 0; pass < 2; pass++) {
		for (int32_t a = 0; a < newton->n; a++) {
			int32_t column = system->row_of_vertex[newton->vertex[a]];
			for (int32_t k = matrix->first[column]; k < matrix->first[column + 1]; k++) {
				int32_t b = newton->place[system->vertex_of_row[matrix->row[k]]];
				int32_t least = a < b ? a : b;
				if (a == b || b < 0)
					continue;
				if (!pass)
					of->below_first[least + 2]++;
				else
					of->below[of->below_first[least + 1]++] = a < b ? b : a;
			}
		}
		for (int32_t c = 0; !pass && c < newton->n; c++)
			of->below_first[c + 2] += of->below_first[c + 1];
	}
}

static bool find_pattern(cau_newton *newton, const cau_system *system)
{
	size_t n = (size_t)newton->n, entries = 1;
	for (size_t i = 0; i < n; i++) {
		int32_t column = system->row_of_vertex[newton->vertex[i]];
		entries += (size_t)(system->matrix.first[column + 1] - system->matrix.first[column]);
	}
	growth of = {.newton = newton,
	             .below_first = calloc(n + 2, sizeof(int32_t)),
	             .below = calloc(entries, sizeof(int32_t)),
	             .child = malloc((n + 1) * sizeof(int32_t)),
	             .sibling = malloc((n + 1) * sizeof(int32_t)),
	             .mark = malloc((n + 1) * sizeof(int32_t))};
	bool room = of.below_first && of.below && of.child && of.sibling && of.mark;
	if (room) {
		memset(of.child, -1, n * sizeof(int32_t));
		memset(of.sibling, -1, n * sizeof(int32_t));
		memset(of.mark, -1, n * sizeof(int32_t));
		permute(&of, system);
		for (int32_t c = 0; c < newton->n && room; c++)
			room = grow(&of, c);
	}
	free(of.below_first);
	free(of.below);
	free(of.child);
	free(of.sibling);
	free(of.mark);
	return room;
}

bool cau_newton_create(cau_newton *newton, const cau_step_solver *solver, const cau_newton *from)
{
	if (place_vertices(newton, solver, from) && find_elements(newton, solver, from) &&
	    find_pattern(newton, &solver->system))
		return true;
	newton->n = 0;
	return false;
}

void cau_newton_finish(cau_newton *newton)
{
	void *arrays[] = {newton->chosen, newton->place, newton->vertex,   newton->first,
	                  newton->row,    newton->block, newton->pivot,    newton->inverse,
	                  newton->column, newton->field, newton->gradient, newton->from,
	                  newton->next,   newton->head,  newton->at,       newton->element,
	                  newton->pair,   newton->grip,  newton->room,     newton->coupling};
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
		free(arrays[i]);
	*newton = (cau_newton){0};
}
