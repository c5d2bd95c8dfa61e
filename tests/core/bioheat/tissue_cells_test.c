// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cells of sheets and solids: their volume, their positions in deformed tissue, and
// whether an element's cells still connect its vertices.
#include "bioheat/tissue_cells.h"

#include <math.h>

#include "core/rig/rig.h"

static const double SIDE_M = 2.5e-4;

static void fill_all(cau_tissue_cells *cells, rig *r, double side_m, int32_t capacity)
{
	assert_int_equal(
		cau_tissue_cells_create(cells, &r->tissue, side_m, capacity, 37, &r->arena, NULL), CAU_OK);
	for (int32_t e = 0; e < cau_tissue_cells_elements(cells); e++)
		assert_true(cau_tissue_cells_fill(cells, e));
}

static double volume_of(const cau_tissue_cells *cells)
{
	double sum = 0;
	for (int32_t i = 0; i < cells->bioheat.cells.count; i++)
		sum += cau_cells_volume(&cells->bioheat.cells, i);
	return sum;
}

static rig small_sheet(void)
{
	static const double points[] = {0, 0, 0, 2e-3, 0, 0, 0, 2e-3, 0, 2e-3, 2e-3, 0};
	static const int32_t triangles[] = {0, 1, 2, 1, 3, 2};
	rig r;
	rig_begin(&r);
	rig_add_triangles(&r, 4, points, 2, triangles);
	rig_build(&r, NULL, 1);
	return r;
}

static rig small_slab(void)
{
	static const double points[] = {0, 0, 0, 2e-3, 0, 0, 0, 2e-3, 0, 0, 0, 2e-3, 2e-3, 2e-3, 2e-3};
	static const int32_t tetrahedra[] = {0, 1, 2, 3, 1, 2, 3, 4};
	rig r;
	rig_begin(&r);
	rig_add_tetrahedra(&r, 5, points, 2, tetrahedra);
	rig_build(&r, NULL, 1);
	return r;
}

// A layer of liver without perfusion, as an organ outside the body. Without a stated tissue the
// layer is fat.
static void a_layer_is_of_its_tissue(void **state)
{
	(void)state;
	rig slab = small_slab();
	cau_tissue_cells fat, liver;
	fill_all(&fat, &slab, SIDE_M, 4000);
	slab.tissue.layer[0].def.tissue = CAU_LIVING_LIVER;
	slab.tissue.layer[0].def.perfusion = 0;
	fill_all(&liver, &slab, SIDE_M, 4000);
	assert_near(cau_bioheat_conductivity(&fat.bioheat, 0), 0.21, 1e-9);
	assert_near(cau_bioheat_conductivity(&liver.bioheat, 0), 0.52, 1e-9);
	assert_near(cau_bioheat_electric(&fat.bioheat, 0), 0.03, 1e-9);
	assert_near(cau_bioheat_electric(&liver.bioheat, 0), 0.15, 1e-9);
	assert_near(liver.bioheat.material[0].perfusion_w_m3k, 0, 0);
	assert_true(fat.bioheat.material[0].perfusion_w_m3k > 0);
	assert_false(liver.bioheat.material[0].sheet);
	rig_finish(&slab);
}

static void cells_have_the_tissue_s_volume(void **state)
{
	(void)state;
	rig sheet = small_sheet(), slab = small_slab();
	cau_tissue_cells flat, solid;
	fill_all(&flat, &sheet, SIDE_M, 4000);
	fill_all(&solid, &slab, SIDE_M, 4000);
	double thickness = sheet.scene->layers[0].sheet[0].thickness_m;
	assert_near(volume_of(&flat), 4e-6 * thickness, 0.02 * 4e-6 * thickness);
	double exact = slab.tissue.tetrahedron_volume[0] + slab.tissue.tetrahedron_volume[1];
	assert_near(volume_of(&solid), exact, 0.02 * exact);
	rig_finish(&sheet);
	rig_finish(&slab);
}

// Under an affine motion every cell moves as its rest position does.
static void cells_move_with_the_tissue(void **state)
{
	(void)state;
	rig r = small_slab();
	cau_tissue_cells cells;
	fill_all(&cells, &r, SIDE_M, 4000);
	double *x = calloc(3 * (size_t)r.tissue.vertex_count, sizeof *x);
	for (int32_t v = 0; v < r.tissue.vertex_count; v++) {
		const double *rest = r.tissue.rest + 3 * v;
		x[3 * v] = 1.5 * rest[0] + 0.2 * rest[1] + 0.01;
		x[3 * v + 1] = 0.8 * rest[1] - 0.1 * rest[2];
		x[3 * v + 2] = 0.9 * rest[2];
	}
	for (int32_t i = 0; i < cells.bioheat.cells.count; i++) {
		const int32_t *place = cells.bioheat.cells.place + 3 * i;
		double rest[3];
		for (int axis = 0; axis < 3; axis++)
			rest[axis] = (place[axis] + 0.5) * SIDE_M;
		cau_vec3 at = cau_tissue_cells_at(&cells, i, x);
		assert_near(at.x, 1.5 * rest[0] + 0.2 * rest[1] + 0.01, 1e-8);
		assert_near(at.y, 0.8 * rest[1] - 0.1 * rest[2], 1e-8);
		assert_near(at.z, 0.9 * rest[2], 1e-8);
	}
	free(x);
	rig_finish(&r);
}

// The pull-back is J F^-1 F^-T of a stretch along the axes. A sheet keeps its volume.
static void conductivity_is_pulled_back(void **state)
{
	(void)state;
	rig slab = small_slab(), sheet = small_sheet();
	cau_tissue_cells solid, flat;
	fill_all(&solid, &slab, SIDE_M, 4000);
	fill_all(&flat, &sheet, SIDE_M, 4000);
	const double stretch[] = {1.5, 0.8, 0.9}, j = 1.5 * 0.8 * 0.9;
	double x[15], flat_x[12];
	for (int i = 0; i < 15; i++)
		x[i] = stretch[i % 3] * slab.tissue.rest[i];
	for (int i = 0; i < 12; i++)
		flat_x[i] = stretch[i % 3] * sheet.tissue.rest[i];
	cau_tissue_cells_stretch(&solid, 0, x);
	cau_tissue_cells_stretch(&flat, 0, flat_x);
	for (int axis = 0; axis < 3; axis++) {
		double squared = stretch[axis] * stretch[axis];
		assert_near(solid.bioheat.cells.pull[axis], j / squared, 1e-5);
		double thinner = 1 / (1.5 * 0.8);
		assert_near(flat.bioheat.cells.pull[axis], axis < 2 ? 1 / squared : 1 / (thinner * thinner),
		            1e-5);
	}
	rig_finish(&slab);
	rig_finish(&sheet);
}

// The pull-back has bounds, however flat or long an element is. A snapshot stores it as a float and
// checks these bounds.
static void a_pull_back_has_bounds(void **state)
{
	(void)state;
	rig slab = small_slab();
	cau_tissue_cells cells;
	fill_all(&cells, &slab, SIDE_M, 4000);
	double x[15];
	for (int i = 0; i < 15; i++)
		x[i] = (i % 3 ? 0.01 : 100) * slab.tissue.rest[i];
	cau_tissue_cells_stretch(&cells, 0, x);
	for (int axis = 0; axis < 3; axis++) {
		double pull = cells.bioheat.cells.pull[axis];
		assert_true(pull == (axis ? CAU_PULL_MOST : 1 / CAU_PULL_MOST));
	}
	rig_finish(&slab);
}

// A slit in the cells separates an element only after the slit passes all the way through.
static void a_slit_separates_an_element(void **state)
{
	(void)state;
	rig r = small_sheet();
	cau_tissue_cells cells;
	fill_all(&cells, &r, SIDE_M, 4000);
	int32_t rows = 0;
	while (!cau_tissue_cells_separated(&cells, 0) && rows < 8) {
		for (int32_t z = -2; z < 2; z++) {
			int32_t cell = cau_cells_find(&cells.bioheat.cells, (int32_t[]){3, rows, z});
			if (cell >= 0)
				cau_bioheat_take_out(&cells.bioheat, cell);
		}
		rows++;
	}
	// the number of rows until the slit's middle crosses the longest side
	assert_in_range(rows, 4, 5);
	assert_true(cau_tissue_cells_separated(&cells, 0));
	assert_false(cau_tissue_cells_separated(&cells, 1));
	rig_finish(&r);
}

// One of two triangles is removed, with a slit beside it. Cells that are connected to the other
// triangle move with that triangle. Cells without a connection are severed, and their heat is
// removed.
static void what_an_element_leaves_moves_with_its_neighbour(void **state)
{
	(void)state;
	rig r = small_sheet();
	cau_tissue_cells cells;
	fill_all(&cells, &r, SIDE_M, 4000);
	cau_cells *grid = &cells.bioheat.cells;
	int32_t far = cau_cells_find(grid, (int32_t[]){0, 0, 0});
	// makes a slit between the triangle's corner and the rest
	for (int32_t i = 0; i < grid->count; i++)
		if (grid->place[3 * i] + grid->place[3 * i + 1] == 3)
			cau_bioheat_take_out(&cells.bioheat, i);
	cells.bioheat.temperature[far] = 80;
	int32_t left = 0, kept = 0;
	for (int32_t i = 0; i < grid->count; i++)
		left += !grid->severed[i] && cells.owner[i] == 0;
	uint8_t triangles[] = {0, 1}, none[1] = {0};
	cau_tissue_cells_reassign(&cells, (uint8_t *[]){triangles, none, none});
	assert_true(grid->severed[far]);
	assert_true(cells.bioheat.ledger.shed_j > 0);
	for (int32_t i = 0; i < grid->count; i++) {
		if (grid->severed[i])
			continue;
		kept++;
		assert_int_equal(cells.owner[i], 1);
		assert_int_equal(grid->place[3 * i] + grid->place[3 * i + 1] > 3, 1);
		cau_vec3 at = cau_tissue_cells_at(&cells, i, r.tissue.rest), middle;
		double radius;
		for (int axis = 0; axis < 3; axis++)
			assert_near((&at.x)[axis], (grid->place[3 * i + axis] + 0.5) * SIDE_M, 1e-9);
		cau_tissue_cells_bound(&cells, 1, r.tissue.rest, &middle, &radius);
		assert_true(cau_length(cau_sub(at, middle)) <= radius);
	}
	assert_true(left > 0 && kept > 0);
	rig_finish(&r);
}

// Makes two sheets, 2 mm apart, and links between their corners.
static rig tied_sheets(void)
{
	static const double below[] = {0, 0, 0, 4e-3, 0, 0, 0, 4e-3, 0};
	static const double above[] = {0, 0, 2e-3, 4e-3, 0, 2e-3, 0, 4e-3, 2e-3};
	static const int32_t triangle[] = {0, 1, 2};
	rig r;
	rig_begin(&r);
	rig_add_triangles(&r, 3, below, 1, triangle);
	rig_add_triangles(&r, 3, above, 1, triangle);
	rig_add_links(&r, 1, 0, 2.5e-3);
	rig_build(&r, NULL, 1);
	return r;
}

// Severs the cells in the plane half way between the sheets. Returns how many there are.
static int32_t take_out_half_way(cau_tissue_cells *cells)
{
	int32_t found = 0;
	for (int32_t i = 0; i < cells->bioheat.cells.count; i++)
		if (cells->bioheat.cells.place[3 * i + 2] == 4 && ++found)
			cau_bioheat_take_out(&cells->bioheat, i);
	return found;
}

// A link has tissue of its section times its length. A link is separated when its cells are
// interrupted. The sheets at its ends keep their own cells.
static void a_link_is_of_cells(void **state)
{
	(void)state;
	rig r = tied_sheets();
	assert_int_equal(r.tissue.link_count, 3);
	cau_tissue_cells cells, alone;
	assert_int_equal(cau_tissue_cells_create(&alone, &r.tissue, SIDE_M, 4000, 37, &r.arena, NULL),
	                 CAU_OK);
	int32_t link = cau_tissue_cells_element(&r.tissue, CAU_PRIMITIVE_LINK, 0), index;
	assert_int_equal(cau_tissue_cells_primitive(&r.tissue, link, &index), CAU_PRIMITIVE_LINK);
	assert_int_equal(index, 0);
	assert_true(cau_tissue_cells_fill(&alone, link));
	double exact = r.tissue.layer[2].def.link.area_m2 * r.tissue.link_length[0];
	assert_near(volume_of(&alone), exact, 0.05 * exact);

	fill_all(&cells, &r, SIDE_M, 4000);
	for (int32_t l = 0; l < 3; l++)
		assert_false(cau_tissue_cells_separated(&cells, link + l));
	assert_true(take_out_half_way(&cells) > 3);
	for (int32_t l = 0; l < 3; l++)
		assert_true(cau_tissue_cells_separated(&cells, link + l));
	uint8_t triangles[] = {1, 1}, none[1] = {0}, links[] = {0, 1, 1};
	cau_tissue_cells_reassign(&cells, (uint8_t *[]){triangles, none, links});
	for (int32_t t = 0; t < 2; t++)
		assert_false(cau_tissue_cells_separated(&cells, t));
	rig_finish(&r);
}

// A link's cells stay around the link wherever its ends are. They conduct along its present length.
static void a_link_s_cells_move_with_its_ends(void **state)
{
	(void)state;
	rig r = tied_sheets();
	cau_tissue_cells cells;
	assert_int_equal(cau_tissue_cells_create(&cells, &r.tissue, SIDE_M, 4000, 37, &r.arena, NULL),
	                 CAU_OK);
	int32_t link = cau_tissue_cells_element(&r.tissue, CAU_PRIMITIVE_LINK, 0);
	assert_true(cau_tissue_cells_fill(&cells, link));
	double x[18];
	for (int i = 0; i < 18; i += 3) { // the link is pulled to twice its length, and turned
		const double *rest = r.tissue.rest + i;
		memcpy(x + i, (double[]){2 * rest[2] + 0.1, rest[1], rest[0]}, 3 * sizeof *x);
	}
	double radius = sqrt(r.tissue.layer[2].def.link.area_m2 / 3.14159265358979);
	cau_vec3 a = cau_vec3_of(x + 3 * (size_t)r.tissue.link[0]);
	for (int32_t i = 0; i < cells.bioheat.cells.count; i++) {
		cau_vec3 off = cau_sub(cau_tissue_cells_at(&cells, i, x), a);
		assert_true(hypot(off.y, off.z) < radius + SIDE_M);
		cau_tissue_cells_stretch(&cells, i, x);
		assert_near(cells.bioheat.cells.pull[3 * i + 2], 0.5, 1e-5); // the link is along z at rest
	}
	rig_finish(&r);
}

static void there_may_be_no_room(void **state)
{
	(void)state;
	rig r = small_sheet();
	cau_tissue_cells cells;
	assert_int_equal(cau_tissue_cells_create(&cells, &r.tissue, SIDE_M, 20, 37, &r.arena, NULL),
	                 CAU_OK);
	assert_false(cau_tissue_cells_fill(&cells, 0));
	assert_int_equal(cells.bioheat.cells.count, 0);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_layer_is_of_its_tissue),
		cmocka_unit_test(cells_have_the_tissue_s_volume),
		cmocka_unit_test(cells_move_with_the_tissue),
		cmocka_unit_test(conductivity_is_pulled_back),
		cmocka_unit_test(a_pull_back_has_bounds),
		cmocka_unit_test(a_slit_separates_an_element),
		cmocka_unit_test(what_an_element_leaves_moves_with_its_neighbour),
		cmocka_unit_test(a_link_is_of_cells),
		cmocka_unit_test(a_link_s_cells_move_with_its_ends),
		cmocka_unit_test(there_may_be_no_room),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
