// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh 2.2 (and 2.0, 2.1): $Nodes and $Elements, text or binary.
#include "mesh/gmsh.h"

// number-of-nodes (text), then: node-number x y z
void cau_gmsh_nodes_2(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	if (gmsh->has_nodes)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the nodes stand twice");
	gmsh->has_nodes = true;
	int64_t count = cau_scan_count(scan, "number of nodes", scan->binary ? 28 : 8);
	cau_scan_skip_line(scan);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_integer(scan, "a node number", 4, 0, INT64_MAX);
		cau_node_map_add(&gmsh->nodes, number, scan);
		cau_gmsh_read_position(gmsh);
	}
	cau_node_map_seal(&gmsh->nodes, scan);
}

// The tags and nodes of one element; the first tag is its physical group.
static void read_element(cau_gmsh *gmsh, int64_t number, int64_t type, int64_t tag_count)
{
	cau_scan *scan = gmsh->scan;
	int64_t region = 0;
	for (int64_t t = 0; t < tag_count && !scan->status; t++) {
		int64_t tag = cau_scan_integer(scan, "a tag", 4, INT32_MIN, INT32_MAX);
		if (t == 0)
			region = tag;
	}
	cau_gmsh_read_element(gmsh, number, type, (int32_t)region, 4);
}

// number-of-elements; text: elm-number elm-type number-of-tags tags node-numbers
static void read_text_elements(cau_gmsh *gmsh, int64_t count)
{
	cau_scan *scan = gmsh->scan;
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_text_integer(scan, "an element number", 0, INT64_MAX);
		int64_t type = cau_scan_text_integer(scan, "a type of element", 1, INT32_MAX);
		int64_t tag_count = cau_scan_text_integer(scan, "number of tags", 0, INT32_MAX);
		read_element(gmsh, number, type, tag_count);
	}
}

// Binary: blocks of elm-type num-elm-follow num-tags, then elm-number tags node-numbers of each
static void read_binary_elements(cau_gmsh *gmsh, int64_t count)
{
	cau_scan *scan = gmsh->scan;
	for (int64_t done = 0; done < count && !scan->status;) {
		int64_t type = cau_scan_integer(scan, "a type of element", 4, 1, INT32_MAX);
		int64_t follow = cau_scan_integer(scan, "number of elements", 4, 1, count - done);
		int64_t tag_count = cau_scan_integer(scan, "number of tags", 4, 0, INT32_MAX);
		for (int64_t i = 0; i < follow && !scan->status; i++) {
			int64_t number = cau_scan_integer(scan, "an element number", 4, 0, INT32_MAX);
			read_element(gmsh, number, type, tag_count);
		}
		done += follow;
	}
}

void cau_gmsh_elements_2(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t count = cau_scan_count(scan, "number of elements", 8);
	cau_scan_skip_line(scan);
	if (scan->binary)
		read_binary_elements(gmsh, count);
	else
		read_text_elements(gmsh, count);
}
