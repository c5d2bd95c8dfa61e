// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/node_map.h"

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"

void cau_node_map_add(cau_node_map *map, int64_t number, cau_scan *scan)
{
	if (scan->status)
		return;
	CAU_ASSERT(map->count <= map->capacity, "%d nodes in room for %d", map->count, map->capacity);
	if (map->count == map->capacity) {
		int32_t capacity = map->capacity ? 2 * map->capacity : 64;
		if (capacity > 2 * CAU_MESH_MAX_VERTICES) {
			cau_scan_fail(scan, CAU_LIMIT, "more nodes than a mesh may have");
			return;
		}
		void *grown = realloc(map->node, (size_t)capacity * sizeof *map->node);
		if (!grown) {
			cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %d nodes", capacity);
			return;
		}
		map->node = grown;
		map->capacity = capacity;
	}
	map->node[map->count] = (struct cau_node){number, map->count};
	map->count++;
}

static int compare_numbers(const void *left, const void *right)
{
	const struct cau_node *a = left, *b = right;
	return (a->number > b->number) - (a->number < b->number);
}

static bool is_ascending(const cau_node_map *map)
{
	for (int32_t i = 1; i < map->count; i++)
		if (map->node[i - 1].number >= map->node[i].number)
			return false;
	return true;
}

void cau_node_map_seal(cau_node_map *map, cau_scan *scan)
{
	if (scan->status || is_ascending(map))
		return;
	qsort(map->node, (size_t)map->count, sizeof *map->node, compare_numbers);
	for (int32_t i = 1; i < map->count; i++)
		if (map->node[i - 1].number == map->node[i].number) {
			cau_scan_fail(scan, CAU_BAD_MESH, "the file has node number %lld twice",
			              (long long)map->node[i].number);
			return;
		}
}

int32_t cau_node_map_find(const cau_node_map *map, int64_t number)
{
	int32_t low = 0, high = map->count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (map->node[middle].number < number)
			low = middle + 1;
		else
			high = middle;
	}
	CAU_ASSERT(low >= map->count || low == 0 || map->node[low - 1].number < number,
	           "node %lld is looked for in a map that is not sealed", (long long)number);
	return low < map->count && map->node[low].number == number ? map->node[low].vertex : -1;
}

void cau_node_map_finish(cau_node_map *map)
{
	free(map->node);
	*map = (cau_node_map){0};
}
