// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_text.h"

#define HEAD(kind) "# vtk DataFile Version 3.0\nany title, POINTS 9\nASCII\nDATASET " kind "\n"
#define HEAD_5 "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
#define POINTS "POINTS 5 float\n0 0 0 1.5 0 0\n0 1 0 0 0 1 1 1 1\n"

static const double corners[15] = {0, 0, 0, 1.5, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};

static const char grid[] = HEAD("UNSTRUCTURED_GRID") POINTS
	"CELLS 3 12\n3 0 2 1\n2 0 1\n4 0 1 2 3\nCELL_TYPES 3\n5\n3\n10\n"
	"CELL_DATA 3\nSCALARS MaterialIds int 1\nLOOKUP_TABLE default\n"
	"5 9 6\nPOINT_DATA 5\nVECTORS v float\n1 2 3 1 2 3 1 2 3 1 2 3 "
	"1 2 3\n";

static void check_grid(cau_mesh *mesh)
{
	assert_int_equal(mesh->vertex_count, 5);
	assert_int_equal(mesh->triangle_count, 1);
	assert_int_equal(mesh->tetrahedron_count, 1);
	assert_memory_equal(mesh->position, corners, sizeof corners);
	assert_memory_equal(mesh->triangle, ((int32_t[]){0, 2, 1}), 3 * sizeof(int32_t));
	assert_memory_equal(mesh->tetrahedron, ((int32_t[]){0, 1, 2, 3}), 4 * sizeof(int32_t));
	assert_int_equal(mesh->triangle_region[0], 5);
	assert_int_equal(mesh->tetrahedron_region[0], 6);
	cau_mesh_finish(mesh);
}

static void text_grids_are_read(void **state)
{
	(void)state;
	const char *const files[] = {
		grid,
		HEAD_5 POINTS
		"METADATA\nINFORMATION 1\nNAME L2 x\n\nCELLS 4 9\nOFFSETS vtktypeint64\n0 3 5 9\n"
		"CONNECTIVITY vtktypeint64\n0 2 1 0 1 0 1 2 3\nCELL_TYPES 3\n5 3 10\n"
		"CELL_DATA 3\nFIELD FieldData 2\nother 2 3 double\n1 2 3 4 5 6\n"
		"region 1 3 long\n5 9 6\n",
	};
	for (int i = 0; i < 2; i++) {
		cau_mesh mesh;
		cau_error error;
		if (read_text("a.vtk", files[i], &mesh, &error))
			fail_msg("%d: %s", i, error.reason);
		check_grid(&mesh);
	}
}

static void put_floats(byte_file *file, const double *number, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		float small = (float)number[i];
		put_number(file, &small, sizeof small);
	}
}

static byte_file binary_grid(void)
{
	byte_file file = {.turned = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__};
	put_text(&file, "# vtk DataFile Version 2.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
	                "POINTS 5 float\n");
	put_floats(&file, corners, 15);
	put_text(&file, "\nCELLS 3 12\n");
	PUT_INTS(&file, 3, 0, 2, 1, 2, 0, 1, 4, 0, 1, 2, 3);
	put_text(&file, "\nCELL_TYPES 3\n");
	PUT_INTS(&file, 5, 3, 10);
	put_text(&file, "\nCELL_DATA 3\nSCALARS skipped double\nLOOKUP_TABLE default\n");
	PUT_DOUBLES(&file, 1, 2, 3);
	put_text(&file, "\nSCALARS region unsigned_short\nLOOKUP_TABLE default\n");
	for (int i = 0; i < 3; i++)
		put_number(&file, (uint16_t[]){5, 9, 6} + i, 2);
	put_text(&file, "\n");
	return file;
}

static byte_file binary_grid_5(void)
{
	byte_file file = {.turned = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__};
	put_text(&file, "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
	                "POINTS 5 double\n");
	put_doubles(&file, corners, 15);
	put_text(&file, "\nCELLS 4 9\nOFFSETS vtktypeint64\n");
	PUT_SIZES(&file, 8, 0, 3, 5, 9);
	put_text(&file, "\nCONNECTIVITY vtktypeint64\n");
	PUT_SIZES(&file, 8, 0, 2, 1, 0, 1, 0, 1, 2, 3);
	put_text(&file, "\nCELL_TYPES 3\n");
	PUT_INTS(&file, 5, 3, 10);
	put_text(&file, "\nCELL_DATA 3\nFIELD FieldData 1\nregion 1 3 vtktypeint64\n");
	PUT_SIZES(&file, 8, 5, 9, 6);
	put_text(&file, "\n");
	return file;
}

static void binary_grids_are_read(void **state)
{
	(void)state;
	const byte_file files[] = {binary_grid(), binary_grid_5()};
	for (int i = 0; i < 2; i++) {
		cau_mesh mesh;
		cau_error error;
		if (read_bytes("a.vtk", &files[i], &mesh, &error))
			fail_msg("%d: %s", i, error.reason);
		check_grid(&mesh);
	}
}

static void polygons_become_fans(void **state)
{
	(void)state;
	cau_mesh mesh;
	cau_error error;
	const char text[] = HEAD("POLYDATA") POINTS
		"VERTICES 1 2\n1 0\nPOLYGONS 2 9\n4 0 1 2 3\n3 1 2 4\nCELL_DATA 3\n"
		"COLOR_SCALARS c 2\n.1 .2 .3 .4 .5 .6\nSCALARS region unsigned_char\n7 8 200\n";
	if (read_text("a.vtk", text, &mesh, &error))
		fail_msg("%s", error.reason);
	assert_int_equal(mesh.triangle_count, 3);
	assert_memory_equal(mesh.triangle, ((int32_t[]){0, 1, 2, 0, 2, 3, 1, 2, 4}),
	                    9 * sizeof(int32_t));
	assert_memory_equal(mesh.triangle_region, ((int32_t[]){8, 8, 200}), 3 * sizeof(int32_t));
	cau_mesh_finish(&mesh);
}

static void bytes_without_sign_stay_so(void **state)
{
	(void)state;
	byte_file file = {.turned = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__};
	put_text(&file,
	         "# vtk DataFile Version 2.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 3 float\n");
	put_floats(&file, corners, 9);
	put_text(&file, "\nPOLYGONS 1 4\n");
	PUT_INTS(&file, 3, 0, 1, 2);
	put_text(&file, "\nCELL_DATA 1\nSCALARS region unsigned_char\nLOOKUP_TABLE default\n\xc8\n");
	cau_mesh mesh;
	cau_error error;
	assert_int_equal(read_bytes("a.vtk", &file, &mesh, &error), CAU_OK);
	assert_int_equal(mesh.triangle_region[0], 200);
	cau_mesh_finish(&mesh);
}

static void unfinished_files_are_refused(void **state)
{
	(void)state;
	// The file is complete after the last type of cell, because data may be absent.
	size_t least = (size_t)(strstr(grid, "CELL_DATA") - grid) - 1;
	refuse_beginnings("a.vtk", grid, least, least - 1);
	refuse_beginnings("a.vtk", grid, strlen(grid), 0);
	byte_file old = binary_grid(), new = binary_grid_5();
	refuse_beginnings("a.vtk", old.bytes, old.count, 200);
	refuse_beginnings("a.vtk", new.bytes, new.count, 360);
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
		{"# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\n", CAU_UNSUPPORTED,
	     "line 4: only UNSTRUCTURED_GRID and POLYDATA"},
		{"# vtk DataFile Version 3.0\nt\nXML\n", CAU_BAD_SYNTAX,
	     "line 3: expected ASCII or BINARY"},
		{HEAD("POLYDATA") "POINTS 1000000 float\n0 0 0\n", CAU_BAD_SYNTAX,
	     "line 5: 1000000 as number of points"},
		{HEAD("POLYDATA") "POINTS 1 bit\n0 0 0\n", CAU_UNSUPPORTED, "numbers of type 'bit'"},
		{HEAD("POLYDATA") "POINTS 1 float\n0 nan 0\n", CAU_BAD_MESH, "line 6: vertex 0: its y"},
		{HEAD("POLYDATA") POINTS POINTS, CAU_BAD_SYNTAX, "two sections POINTS"},
		{HEAD("POLYDATA") POINTS "POLYGONS 1 1000000\n3 0 1 2\n", CAU_BAD_SYNTAX,
	     "1000000 as length of the list"},
		{HEAD("POLYDATA") POINTS "POLYGONS 3 2\n3 0 1 2\n", CAU_BAD_SYNTAX, "shorter than"},
		{HEAD("POLYDATA") POINTS "POLYGONS 1 4\n4 0 1 2 3\n", CAU_BAD_SYNTAX,
	     "line 9: expected number of corners, but found 4"},
		{HEAD("POLYDATA") POINTS "POLYGONS 1 4\n3 0 1 5\n", CAU_BAD_MESH, "cell 0 names point 5"},
		{HEAD("POLYDATA") POINTS "POLYGONS 1 3\n2 0 1\n", CAU_BAD_MESH,
	     "but 5 vertices, 1 polygons of fewer than 3 corners"},
		{HEAD("POLYDATA") POINTS "LINES 1 3\n2 0 1\n", CAU_BAD_MESH, "vertices, 1 lines"},
		{HEAD("POLYDATA") "SURPRISE\n", CAU_BAD_SYNTAX, "line 5: 'SURPRISE' is not"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELLS 1 4\n3 0 1 2\n", CAU_BAD_SYNTAX,
	     "CELLS without CELL_TYPES"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELLS 1 4\n3 0 1 2\nCELL_TYPES 2\n5 5\n", CAU_BAD_SYNTAX,
	     "2 CELL_TYPES for 1 CELLS"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELL_TYPES 1\n5\n", CAU_BAD_SYNTAX, "for 0 CELLS"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n", CAU_BAD_MESH,
	     "cell 0 has 3 corners, its type has 4"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELLS 1 2\n1 0\nCELL_TYPES 1\n1\n", CAU_BAD_MESH,
	     "vertices, 1 points"},
		{HEAD("UNSTRUCTURED_GRID") POINTS "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n15\n", CAU_BAD_MESH,
	     "vertices, 1 pentagonal prisms"},
		{HEAD_5 POINTS "CELLS 2 3\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2\n",
	     CAU_BAD_SYNTAX, "OFFSETS must ascend"},
		{HEAD_5 POINTS "CELLS 3 3\nOFFSETS vtktypeint64\n0 3 1\nCONNECTIVITY vtktypeint64\n0 1 2\n",
	     CAU_BAD_SYNTAX, "OFFSETS must ascend"},
		{HEAD_5 POINTS "CELLS 2 3\nOFFSETS float\n0 3\n", CAU_BAD_SYNTAX, "OFFSETS must not"},
		{HEAD("POLYDATA") POINTS "POLYGONS 1 4\n3 0 1 2\nCELL_DATA 1\nSCALARS region float\n0.5\n",
	     CAU_BAD_MESH, "cell 0: a region must be a whole number"},
		{HEAD("POLYDATA") POINTS
	     "POLYGONS 1 4\n3 0 1 2\nCELL_DATA 1000000\nSCALARS region int\n1\n",
	     CAU_BAD_SYNTAX, "1000000 as number of values"},
		{HEAD("POLYDATA") "FIELD f 1\nx 2000000000 2000000000 double\n1\n", CAU_BAD_SYNTAX,
	     "as number of values"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		refuse_text("a.vtk", cases[i].text, cases[i].status, cases[i].part);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(text_grids_are_read),
		cmocka_unit_test(binary_grids_are_read),
		cmocka_unit_test(polygons_become_fans),
		cmocka_unit_test(bytes_without_sign_stay_so),
		cmocka_unit_test(unfinished_files_are_refused),
		cmocka_unit_test(failures_name_line_and_reason),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
