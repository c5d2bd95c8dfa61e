// SPDX-License-Identifier: GPL-3.0-or-later
// From a file's node numbers, which may be sparse and in any order, to vertices.
#pragma once

#include "mesh/scan.h"

typedef struct cau_node_map {
	struct cau_node {
		int64_t number;
		int32_t vertex;
	} * node;
	int32_t count;
	int32_t capacity;
} cau_node_map;

// Appends a node; its vertex is the count of nodes before it. Failures go to the scan.
void cau_node_map_add(cau_node_map *map, int64_t number, cau_scan *scan);
// Makes the map ready for finding. Fails where a number came twice.
void cau_node_map_seal(cau_node_map *map, cau_scan *scan);
// The vertex of a node, or -1.
int32_t cau_node_map_find(const cau_node_map *map, int64_t number);
void cau_node_map_finish(cau_node_map *map);
