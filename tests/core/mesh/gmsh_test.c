// SPDX-License-Identifier: GPL-3.0-or-later
// Reads one tetrahedron and one triangle in every Gmsh format, with sparse node numbers.
#include "mesh_text.h"

static const double corners[12] = {0, 0, 0, 1.5, 0, 0, 0, 1, 0, 0, 0, 1};

static const char version_1[] = "$NOD\n4\n7 0 0 0\n3 1.5 0 0\n100 0 1 0\n12 0 0 1\n$ENDNOD\n"
								"$ELM\n3\n1 15 0 0 1 7\n2 2 5 1 3 7 100 3\n"
								"9 4 6 1 4 7 3 100 12\n$ENDELM\n";

static const char version_2[] =
	"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 6 \"fat $Nodes\"\n"
	"$EndPhysicalNames\n$Nodes\n4\n7 0 0 0\n3 1.5 0 0\n100 0 1 0\n12 0 0 1\n$EndNodes\n"
	"$Elements\n3\n1 1 2 0 1 7 3\n2 2 2 5 1 7 100 3\n9 4 3 6 1 0 7 3 100 12\n$EndElements\n";

static const char version_4[] =
	"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 1 1\n1 0 0 0 0\n"
	"8 0 0 0 1 1 1 1 -5 0\n9 -1.797693134862316e+308 0 0 1 1 1 2 6 11 1 8\n$EndEntities\n"
	"$Nodes\n2 4 3 100\n0 1 0 1\n7\n0 0 0\n2 8 1 3\n3\n100\n12\n"
	"1.5 0 0 0.1 0.2\n0 1 0 0.3 0.4\n0 0 1 0.5 0.6\n$EndNodes\n"
	"$Elements\n3 3 1 9\n0 1 15 1\n1 7\n2 8 2 1\n2 7 100 3\n3 9 4 1\n9 7 3 100 12\n$EndElements\n";

static void check_mesh(cau_mesh *mesh)
{
	assert_int_equal(mesh->vertex_count, 4);
	assert_int_equal(mesh->triangle_count, 1);
	assert_int_equal(mesh->tetrahedron_count, 1);
	assert_memory_equal(mesh->position, corners, sizeof corners);
	assert_memory_equal(mesh->triangle, ((int32_t[]){0, 2, 1}), 3 * sizeof(int32_t));
	assert_memory_equal(mesh->tetrahedron, ((int32_t[]){0, 1, 2, 3}), 4 * sizeof(int32_t));
	assert_int_equal(mesh->triangle_region[0], 5);
	assert_int_equal(mesh->tetrahedron_region[0], 6);
	assert_null(mesh->texture);
	cau_mesh_finish(mesh);
}

static void text_versions_are_read(void **state)
{
	(void)state;
	const char *const files[] = {version_1, version_2, version_4};
	for (int i = 0; i < 3; i++) {
		cau_mesh mesh;
		cau_error error;
		cau_status status = read_text("liver.MSH", files[i], &mesh, &error);
		if (status)
			fail_msg("%d: %s", i, error.reason);
		check_mesh(&mesh);
	}
}

static void put_binary_header(byte_file *file, const char *line)
{
	put_text(file, "$MeshFormat\n");
	put_text(file, line);
	PUT_INTS(file, 1);
	put_text(file, "\n$EndMeshFormat\n");
}

static byte_file binary_2(int turned)
{
	byte_file file = {.turned = turned};
	put_binary_header(&file, "2.2 1 8\n");
	put_text(&file, "$Nodes\n4\n");
	const int32_t number[] = {7, 3, 100, 12};
	for (int i = 0; i < 4; i++) {
		PUT_INTS(&file, number[i]);
		put_doubles(&file, corners + 3 * i, 3);
	}
	put_text(&file, "\n$EndNodes\n$Elements\n4\n");
	PUT_INTS(&file, 1, 2, 0, 1, 7, 3, 2, 3, 7);    // two lines without tags
	PUT_INTS(&file, 2, 1, 2, 2, 5, 1, 7, 100, 3);  // a triangle
	PUT_INTS(&file, 4, 1, 1, 9, 6, 7, 3, 100, 12); // a tetrahedron
	put_text(&file, "\n$EndElements\n");
	return file;
}

static byte_file binary_4(size_t bytes, int turned)
{
	byte_file file = {.turned = turned};
	put_binary_header(&file, bytes == 8 ? "4.1 1 8\n" : "4.1 1 4\n");
	put_text(&file, "$Entities\n");
	PUT_SIZES(&file, bytes, 0, 0, 1, 1);
	PUT_INTS(&file, 8);
	PUT_DOUBLES(&file, 0, 0, 0, 1, 1, 1);
	PUT_SIZES(&file, bytes, 1);
	PUT_INTS(&file, -5);
	PUT_SIZES(&file, bytes, 0);
	PUT_INTS(&file, 9);
	PUT_DOUBLES(&file, 0, 0, 0, 1, 1, 1);
	PUT_SIZES(&file, bytes, 2);
	PUT_INTS(&file, 6, 11);
	PUT_SIZES(&file, bytes, 1);
	PUT_INTS(&file, 8);
	put_text(&file, "\n$EndEntities\n$Nodes\n");
	PUT_SIZES(&file, bytes, 1, 4, 3, 100);
	PUT_INTS(&file, 3, 9, 0);
	PUT_SIZES(&file, bytes, 4, 7, 3, 100, 12);
	put_doubles(&file, corners, 12);
	put_text(&file, "\n$EndNodes\n$Elements\n");
	PUT_SIZES(&file, bytes, 3, 3, 1, 9);
	PUT_INTS(&file, 1, 1, 8); // a line of three nodes
	PUT_SIZES(&file, bytes, 1, 1, 7, 3, 100);
	PUT_INTS(&file, 2, 8, 2);
	PUT_SIZES(&file, bytes, 1, 2, 7, 100, 3);
	PUT_INTS(&file, 3, 9, 4);
	PUT_SIZES(&file, bytes, 1, 9, 7, 3, 100, 12);
	put_text(&file, "\n$EndElements\n");
	return file;
}

static void binary_versions_are_read_in_both_byte_orders(void **state)
{
	(void)state;
	const byte_file files[] = {binary_2(0),    binary_2(1),    binary_4(8, 0),
	                           binary_4(8, 1), binary_4(4, 0), binary_4(4, 1)};
	for (int i = 0; i < 6; i++) {
		cau_mesh mesh;
		cau_error error;
		cau_status status = read_bytes("a.msh", &files[i], &mesh, &error);
		if (status)
			fail_msg("%d: %s", i, error.reason);
		check_mesh(&mesh);
	}
}

static void unfinished_files_are_refused(void **state)
{
	(void)state;
	// Only the end of line after the last word can be missing.
	refuse_beginnings("a.msh", version_1, strlen(version_1), strlen(version_1) - 1);
	refuse_beginnings("a.msh", version_2, strlen(version_2), strlen(version_2) - 1);
	refuse_beginnings("a.msh", version_4, strlen(version_4), strlen(version_4) - 1);
	const byte_file files[] = {binary_2(0), binary_4(8, 0), binary_4(4, 1)};
	for (int i = 0; i < 3; i++)
		refuse_beginnings("a.msh", files[i].bytes, files[i].count, files[i].count - 1);
}

static void failures_name_line_and_reason(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		cau_status status;
		const char *part;
	} cases[] = {
		{"", CAU_BAD_SYNTAX, "is empty"},
		{"$NOD\n0\n$ENDNOD\nsolid", CAU_BAD_SYNTAX, "line 4: expected the name of a section"},
		{"$NOD\n2\n1 0 0 0\n1 1 0 0\n$ENDNOD\n", CAU_BAD_MESH, "node number 1 twice"},
		{"$NOD\n2\n1 0 0 0\n2 1 nan 0\n$ENDNOD\n", CAU_BAD_MESH, "line 4: vertex 1: its y"},
		{"$NOD\n2\n1 0 0 0\n2 1 inf 0\n$ENDNOD\n", CAU_BAD_MESH, "line 4: vertex 1: its y"},
		{"$NOD\n1\n1 0 1e 0\n$ENDNOD\n", CAU_BAD_SYNTAX,
	     "line 3: expected a coordinate, found '1e'"},
		{"$NOD\n1\n1 0 \x01\x80 0\n", CAU_BAD_SYNTAX,
	     "found '?"
	     "?'"},
		{"$NOD\n1000000\n1 0 0 0\n$ENDNOD\n", CAU_BAD_SYNTAX, "line 2: 1000000 as number of nodes"},
		{"$NOD\n99999999999999999999\n", CAU_BAD_SYNTAX, "line 2: expected number of nodes"},
		{"$NOD\n-1\n", CAU_BAD_SYNTAX, "but found -1"},
		{"$NOD\n1\n1 0 0 0\n$ENDNOD\n$NOD\n1\n1 0 0 0\n$ENDNOD\n", CAU_BAD_SYNTAX,
	     "two sections of nodes"},
		{"$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1000000\n1 4 0 0 4 1 1 1 1\n$ENDELM\n", CAU_BAD_SYNTAX,
	     "line 6: 1000000 as number of elements"},
		{"$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n8 4 0 0 4 1 1 1 2\n$ENDELM\n", CAU_BAD_MESH,
	     "line 7: element 8 names node 2"},
		{"$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n8 4 0 0 3 1 1 1\n$ENDELM\n", CAU_BAD_SYNTAX,
	     "element 8 has 3 nodes, its type has 4"},
		{"$ELM\n1\n8 4 0 0 4 1 1 1 2\n$ENDELM\n", CAU_BAD_MESH, "element 8 names node 1"},
		{"$MeshFormat\n5 0 8\n$EndMeshFormat\n", CAU_UNSUPPORTED, "Gmsh version 5:"},
		{"$MeshFormat\n2.2 0 4\n$EndMeshFormat\n", CAU_UNSUPPORTED, "numbers of 4 bytes"},
		{"$MeshFormat\n4.1 1 8\n12345678", CAU_BAD_SYNTAX, "expected the number one"},
		{"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nnever ends", CAU_BAD_SYNTAX,
	     "line 4: this section has no $EndComments"},
		{"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2 1 2\n0 1 0 1\n1\n0 0 0\n$EndNodes\n",
	     CAU_BAD_SYNTAX, "announces 2 nodes, but has 1"},
		{"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1 1 1\n0 1 0 1000000\n1\n0 0 0\n",
	     CAU_BAD_SYNTAX, "line 6: 1000000 as number of nodes"},
		{"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 9000000000000 0\n", CAU_BAD_SYNTAX,
	     "line 5: 9000000000000 as number of entities"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		refuse_text("a.msh", cases[i].text, cases[i].status, cases[i].part);
}

static void other_elements_are_named(void **state)
{
	(void)state;
	refuse_text(
		"a.msh",
		"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n4\n"
		"1 1 0 1 1\n2 1 0 1 1\n3 15 0 1\n4 77 0 1\n$EndElements\n",
		CAU_BAD_MESH, "but 1 vertices, 2 lines, 1 points, 1 elements of unknown type");
}

static void binary_failures_name_the_byte(void **state)
{
	(void)state;
	byte_file file = {0};
	put_binary_header(&file, "2.2 1 8\n");
	put_text(&file, "$Nodes\n1\n");
	PUT_INTS(&file, 1);
	PUT_DOUBLES(&file, 0, 0, 0);
	put_text(&file, "\n$EndNodes\n$Elements\n1\n");
	PUT_INTS(&file, 99, 1, 0, 1, 1, 1, 1);
	put_text(&file, "\n$EndElements\n");
	cau_mesh mesh;
	cau_error error;
	assert_int_equal(read_bytes("a.msh", &file, &mesh, &error), CAU_UNSUPPORTED);
	assert_non_null(strstr(error.reason, "byte "));
	assert_non_null(strstr(error.reason, "unknown type 99"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(text_versions_are_read),
		cmocka_unit_test(binary_versions_are_read_in_both_byte_orders),
		cmocka_unit_test(unfinished_files_are_refused),
		cmocka_unit_test(failures_name_line_and_reason),
		cmocka_unit_test(other_elements_are_named),
		cmocka_unit_test(binary_failures_name_the_byte),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
