// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

static int compare_keys(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

// Lists all (column, row) pairs of an element's free vertices with column <= row. Returns their
// number.
static int64_t element_keys(const cau_system *system, const cau_element_map *map, uint64_t *keys)
{
	int64_t count = 0;
	for (int i = 0; i < map->vertex_count; i++)
		for (int j = 0; j < map->vertex_count; j++) {
			int32_t column = system->row_of_vertex[map->vertex[i]];
			CAU_ASSERT(column < system->row_count, "vertex %d has row %d of %d", map->vertex[i],
			           column, system->row_count);
			int32_t row = system->row_of_vertex[map->vertex[j]];
			if (column >= 0 && row >= column)
				keys[count++] = (uint64_t)column << 32 | (uint32_t)row;
		}
	return count;
}

static cau_status build_pattern(cau_system *system, const cau_tissue *tissue, cau_arena *arena,
                                cau_arena *scratch, cau_error *error)
{
	int64_t capacity = system->row_count;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		capacity += 10 * (int64_t)cau_tissue_element_count(tissue, kind);
	uint64_t *keys = cau_arena_array(scratch, (size_t)capacity, sizeof *keys);
	if (!keys)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the system's pattern");
	int64_t count = 0;
	for (int32_t r = 0; r < system->row_count; r++)
		keys[count++] = (uint64_t)r << 32 | (uint32_t)r;
	cau_element_map map;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, kind); i++) {
			cau_tissue_element_map(tissue, kind, i, &map);
			count += element_keys(system, &map, keys + count);
		}
	CAU_ASSERT(count <= capacity, "%lld entries in room for %lld", (long long)count,
	           (long long)capacity);
	qsort(keys, (size_t)count, sizeof *keys, compare_keys);
	int64_t unique = 0;
	for (int64_t k = 0; k < count; k++)
		if (!k || keys[k] != keys[k - 1])
			keys[unique++] = keys[k];
	if (unique > INT32_MAX)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the solver's matrix has %lld entries, more than %d: take a coarser mesh",
		                (long long)unique, INT32_MAX);
	cau_matrix *matrix = &system->matrix;
	matrix->n = system->row_count;
	matrix->first = cau_arena_array(arena, (size_t)system->row_count + 1, sizeof(int32_t));
	matrix->row = cau_arena_array(arena, (size_t)unique, sizeof(int32_t));
	matrix->value = cau_arena_array(arena, (size_t)unique, sizeof(double));
	if (!matrix->first || !matrix->row || !matrix->value)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the system");
	for (int64_t k = 0; k < unique; k++) {
		matrix->row[k] = (int32_t)(uint32_t)keys[k];
		matrix->first[(keys[k] >> 32) + 1] = (int32_t)k + 1;
	}
	return CAU_OK;
}

cau_status cau_system_create(cau_system *system, const cau_tissue *tissue, const uint8_t *pinned,
                             cau_arena *arena, cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count;
	*system = (cau_system){0};
	system->row_of_vertex = cau_arena_array(arena, n, sizeof(int32_t));
	system->vertex_of_row = cau_arena_array(arena, n, sizeof(int32_t));
	system->diagonal = cau_arena_array(arena, n, sizeof(double));
	if (!system->row_of_vertex || !system->vertex_of_row || !system->diagonal)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the system");
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		system->row_of_vertex[v] = pinned[v] ? -1 : system->row_count;
		if (!pinned[v])
			system->vertex_of_row[system->row_count++] = v;
	}
	cau_arena scratch = {0};
	cau_status status = build_pattern(system, tissue, arena, &scratch, error);
	cau_arena_finish(&scratch);
	return status;
}

static void add_entry(const cau_matrix *matrix, double *value, int32_t a, int32_t b, double amount)
{
	int32_t column = a < b ? a : b, row = a < b ? b : a;
	CAU_ASSERT_INDEX(row, matrix->n);
	value[cau_pattern_place(matrix->first, matrix->row, column, row)] += amount;
}

static void add_element(const cau_system *system, const cau_element_map *map, double *value)
{
	for (int i = 0; i < map->vertex_count; i++)
		for (int j = i; j < map->vertex_count; j++) {
			int32_t a = system->row_of_vertex[map->vertex[i]];
			int32_t b = system->row_of_vertex[map->vertex[j]];
			if (a < 0 || b < 0)
				continue;
			double sum = 0;
			for (int r = 0; r < map->rank; r++)
				sum += map->coefficient[r][i] * map->coefficient[r][j];
			add_entry(&system->matrix, value, a, b, map->weight * sum);
		}
}

void cau_system_assemble(const cau_system *system, const cau_tissue *tissue, const cau_alive *alive,
                         double step_s, double *value)
{
	CAU_ASSERT(step_s > 0, "a step of %g s", step_s);
	memset(value, 0, (size_t)system->matrix.first[system->row_count] * sizeof *value);
	for (int32_t r = 0; r < system->row_count; r++)
		value[system->matrix.first[r]] = tissue->mass[system->vertex_of_row[r]] / (step_s * step_s);
	cau_element_map map;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, kind); i++) {
			if (!alive->element[kind][i])
				continue;
			cau_tissue_element_map(tissue, kind, i, &map);
			add_element(system, &map, value);
		}
}

void cau_system_assemble_diagonal(const cau_system *system, const cau_tissue *tissue,
                                  const cau_alive *alive, double step_s)
{
	CAU_ASSERT(step_s > 0, "a step of %g s", step_s);
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		system->diagonal[v] = tissue->mass[v] / (step_s * step_s);
	cau_element_map map;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, kind); i++) {
			if (!alive->element[kind][i])
				continue;
			cau_tissue_element_map(tissue, kind, i, &map);
			double omega = map.weight * cau_element_map_scale(&map);
			CAU_ASSERT(omega >= 0, "element %d of kind %d adds %g N/m", i, kind, omega);
			for (int k = 0; k < map.vertex_count; k++)
				system->diagonal[map.vertex[k]] += omega;
		}
}

void cau_system_columns(const cau_system *system, const cau_element_map *map, int32_t *columns,
                        int32_t *first, int32_t *row, double *value)
{
	CAU_ASSERT(map->weight >= 0, "an element of weight %g", map->weight);
	CAU_ASSERT(*columns >= 0 && *columns + map->rank <= CAU_UPDATE_RANK, "%d columns and %d more",
	           *columns, map->rank);
	double root = sqrt(map->weight);
	for (int r = 0; r < map->rank; r++) {
		int32_t at = first[*columns];
		for (int i = 0; i < map->vertex_count; i++) {
			int32_t free_row = system->row_of_vertex[map->vertex[i]];
			if (free_row < 0 || map->coefficient[r][i] == 0)
				continue;
			row[at] = free_row;
			value[at++] = root * map->coefficient[r][i];
		}
		if (at > first[*columns])
			first[++*columns] = at;
	}
}
