// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh files: the header, and the walk over the sections of any version. Formats: Gmsh's reference
// manual, "File formats" (4.1) and "Legacy formats" (1 and 2.2).
#include "mesh/gmsh.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

typedef struct section {
	const char *name, *end;
	void (*read)(cau_gmsh *gmsh);
} section;

static const section sections_1[] = {
	{"$NOD", "$ENDNOD", cau_gmsh_nodes_2}, {"$ELM", "$ENDELM", cau_gmsh_elements_1}, {0}};
static const section sections_2[] = {{"$Nodes", "$EndNodes", cau_gmsh_nodes_2},
                                     {"$Elements", "$EndElements", cau_gmsh_elements_2},
                                     {0}};
static const section sections_4[] = {{"$Entities", "$EndEntities", cau_gmsh_entities_4},
                                     {"$Nodes", "$EndNodes", cau_gmsh_nodes_4},
                                     {"$Elements", "$EndElements", cau_gmsh_elements_4},
                                     {0}};

// The number one in binary, from which the byte order is known.
static void read_byte_order(cau_scan *scan)
{
	cau_scan_skip_line(scan);
	scan->binary = true;
	int64_t one = cau_scan_integer(scan, "the number one", 4, INT32_MIN, INT32_MAX);
	if (one == 0x01000000)
		scan->swap = true;
	else if (one != 1)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected the number one, found %lld", (long long)one);
}

// $MeshFormat: version, whether binary, size of a number. Returns the version's sections.
static const section *read_header(cau_gmsh *gmsh)
{
	cau_scan *scan = gmsh->scan;
	double version = cau_scan_word_real(scan, cau_scan_word(scan), "a version");
	bool is_2 = version >= 2 && version<3, is_4 = version> 4.05 && version < 4.15;
	if (!is_2 && !is_4)
		cau_scan_fail(scan, CAU_UNSUPPORTED, "Gmsh version %g: 1, 2.2 and 4.1 are read", version);
	bool binary = cau_scan_text_integer(scan, "0 (text) or 1 (binary)", 0, 1);
	gmsh->size_bytes = (int)cau_scan_text_integer(scan, "4 or 8 (bytes of a number)", 4, 8);
	if (gmsh->size_bytes != 8 && (gmsh->size_bytes != 4 || is_2))
		cau_scan_fail(scan, CAU_UNSUPPORTED, "numbers of %d bytes", gmsh->size_bytes);
	if (binary)
		read_byte_order(scan);
	cau_scan_expect(scan, "$EndMeshFormat");
	return is_2 ? sections_2 : sections_4;
}

// Passes over a section by its name to behind its end.
static void skip_section(cau_scan *scan, cau_word name)
{
	CAU_ASSERT(name.length > 0 && name.text[0] == '$', "a section called by %zu letters",
	           name.length);
	char end[80];
	int length = snprintf(end, sizeof end, "$End%.*s",
	                      (int)(name.length < 64 ? name.length : 64) - 1, name.text + 1);
	const unsigned char *from = scan->bytes + scan->at;
	const unsigned char *found = memmem(from, cau_scan_left(scan), end, (size_t)length);
	if (!found) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "this section has no %s", end);
		return;
	}
	scan->at += (size_t)(found - from);
	cau_scan_skip_line(scan);
}

static void read_section(cau_gmsh *gmsh, const section *known, cau_word name)
{
	CAU_ASSERT(name.length > 0, "a section without a name, at byte %zu", gmsh->scan->at);
	cau_scan *scan = gmsh->scan;
	if (name.text[0] != '$') {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected the name of a section ($...)");
		return;
	}
	while (known->name && !cau_word_is(name, known->name))
		known++;
	if (!known->name) {
		skip_section(scan, name);
		return;
	}
	cau_scan_skip_line(scan);
	known->read(gmsh);
	cau_scan_expect(scan, known->end);
}

cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder)
{
	cau_scan *scan = builder->scan;
	cau_gmsh gmsh = {.scan = scan, .builder = builder};
	const section *known = sections_1;
	if (cau_word_is(cau_scan_peek(scan), "$MeshFormat")) {
		cau_scan_word(scan);
		known = read_header(&gmsh);
	}
	for (cau_word name = cau_scan_word(scan); name.length; name = cau_scan_word(scan))
		read_section(&gmsh, known, name);
	cau_mesh_builder_check(builder, cau_gmsh_type_name);
	cau_node_map_finish(&gmsh.nodes);
	free(gmsh.entity);
	return scan->status;
}
