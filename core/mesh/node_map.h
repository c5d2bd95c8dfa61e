// SPDX-License-Identifier: GPL-3.0-or-later
// Maps the node numbers of a file to vertices. Node numbers may be sparse and in any order.
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

// Appends a node. Its vertex is the number of nodes before this call. Failures go to the scan.
void cau_node_map_add(cau_node_map *map, int64_t number, cau_scan *scan);
// Prepares the map for cau_node_map_find. Fails if a number occurs twice.
void cau_node_map_seal(cau_node_map *map, cau_scan *scan);
// Returns the vertex of a node, or -1.
int32_t cau_node_map_find(const cau_node_map *map, int64_t number);
void cau_node_map_finish(cau_node_map *map);
