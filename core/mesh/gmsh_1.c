// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh 1: $ELM, text only. Its $NOD is as version 2.2's $Nodes.
#include "mesh/gmsh.h"

// number-of-elements, then: elm-number elm-type reg-phys reg-elem number-of-nodes node-numbers
void cau_gmsh_elements_1(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	int64_t count = cau_scan_count(scan, "number of elements", 12);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		int64_t number = cau_scan_text_integer(scan, "an element number", 0, INT64_MAX);
		int64_t type = cau_scan_text_integer(scan, "a type of element", 1, INT32_MAX);
		int64_t region = cau_scan_text_integer(scan, "a physical group", INT32_MIN, INT32_MAX);
		cau_scan_text_integer(scan, "an elementary region", INT32_MIN, INT32_MAX);
		int64_t nodes = cau_scan_text_integer(scan, "number of nodes", 1, INT32_MAX);
		int expected = cau_gmsh_type_nodes(type);
		if (!scan->status && expected && nodes != expected)
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "element %lld has %lld nodes, its type has %d",
			              (long long)number, (long long)nodes, expected);
		cau_gmsh_read_element(gmsh, number, type, (int32_t)region, 4);
	}
}
