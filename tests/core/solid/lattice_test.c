// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice queries whole boxes of points if they have one label. The test expects the same
// tetrahedra as without boxes, and few queries of points if tissue is far apart.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "mesh/mesh.h"
#include "solid/mesher.h"

enum { SIDE = 24, BOXES = 4000 };

// ---- surfaces as OBJ
typedef struct shape {
	FILE *out;
	char *text;
	size_t byte_count;
	int vertex_count;
} shape;

static void begin(shape *of)
{
	*of = (shape){0};
	of->out = open_memstream(&of->text, &of->byte_count);
	assert_non_null(of->out);
}

// Adds a ball around the z axis. Rings from `open` on are left out. The surface of a cavity faces
// inward.
static void put_ball(shape *of, double radius, double x, bool cavity, int rings, int open)
{
	int around = 2 * rings, base = of->vertex_count + 1;
	for (int i = 0; i <= rings; i++)
		for (int j = 0; j < around; j++) {
			double t = M_PI * i / rings, p = 2 * M_PI * j / around;
			fprintf(of->out, "v %.17g %.17g %.17g\n", x + radius * sin(t) * cos(p),
			        radius * sin(t) * sin(p), radius * cos(t));
		}
	for (int i = 0; i < open; i++)
		for (int j = 0; j < around; j++) {
			int a = base + i * around + j, b = base + i * around + (j + 1) % around;
			const int at[4] = {a, a + around, b + around, b};
			fprintf(of->out, "f %d %d %d\nf %d %d %d\n", at[0], at[cavity ? 2 : 1],
			        at[cavity ? 1 : 2], at[0], at[cavity ? 3 : 2], at[cavity ? 2 : 3]);
		}
	of->vertex_count += (rings + 1) * around;
}

static void put_tetrahedron(shape *of, double at, const double apex[3])
{
	int base = of->vertex_count;
	fprintf(of->out, "v %g %g %g\nv %g %g %g\nv %g %g %g\nv %g %g %g\n", at, at, at, at + 1, at, at,
	        at, at + 1, at, at + apex[0], at + apex[1], at + apex[2]);
	fprintf(of->out, "f %d %d %d\nf %d %d %d\nf %d %d %d\nf %d %d %d\n", base + 1, base + 3,
	        base + 2, base + 1, base + 2, base + 4, base + 1, base + 4, base + 3, base + 2,
	        base + 3, base + 4);
	of->vertex_count += 4;
}

static void put_two_far(shape *of, double distance)
{
	static const double apex[3] = {0, 0, 1};
	put_tetrahedron(of, 0, apex);
	put_tetrahedron(of, distance, apex);
}

static void end(shape *of, cau_mesh *mesh, cau_domain *domain)
{
	int32_t turned;
	fclose(of->out);
	assert_int_equal(cau_mesh_read("test", of->text, of->byte_count, mesh, NULL, NULL), CAU_OK);
	assert_int_equal(cau_mesh_clean(mesh, NULL, NULL), CAU_OK);
	assert_int_equal(cau_domain_of_surface(mesh, domain, &turned, NULL), CAU_OK);
	free(of->text);
}

// ---- domains that count their calls
static cau_domain inner; // the counted domain, one at a time
static int64_t places, uniform_boxes, tissue_boxes;

static int32_t counted_label(const cau_domain *domain, const double x[3], const bool *passed)
{
	(void)domain;
	places++;
	return inner.label_at(&inner, x, passed);
}

static bool counted_box(const cau_domain *domain, const double least[3], const double most[3],
                        int32_t *label)
{
	(void)domain;
	bool uniform = inner.is_uniform(&inner, least, most, label);
	uniform_boxes += uniform;
	tissue_boxes += uniform && *label;
	return uniform;
}

static bool never(const cau_domain *domain, const double least[3], const double most[3],
                  int32_t *label)
{
	(void)domain;
	(void)least;
	(void)most;
	(void)label;
	return false;
}

static cau_tets lattice_of(double spacing, bool by_boxes)
{
	cau_tets tets = {0};
	cau_error error = {0};
	cau_domain domain = inner;
	domain.label_at = counted_label;
	domain.is_uniform = by_boxes ? counted_box : never;
	places = uniform_boxes = tissue_boxes = 0;
	if (cau_lattice(&domain, spacing, &tets, &error))
		fail_msg("%s", error.reason);
	return tets;
}

static void lattices_are_the_same(const char *name, double spacing)
{
	cau_tets all = lattice_of(spacing, false);
	int64_t asked = places;
	cau_tets tets = lattice_of(spacing, true);
	print_message("%s: %lld places of %lld, %lld boxes, %lld of tissue, %d tetrahedra\n", name,
	              (long long)places, (long long)asked, (long long)uniform_boxes,
	              (long long)tissue_boxes, tets.count);
	assert_true(places < asked && uniform_boxes > 0);
	assert_true(tets.count > 0);
	assert_int_equal(tets.count, all.count);
	assert_int_equal(tets.vertex_count, all.vertex_count);
	assert_memory_equal(tets.vertex, all.vertex, 4 * (size_t)all.count * sizeof *all.vertex);
	assert_memory_equal(tets.label, all.label, (size_t)all.count * sizeof *all.label);
	assert_memory_equal(tets.position, all.position,
	                    3 * (size_t)all.vertex_count * sizeof *all.position);
	cau_tets_finish(&tets);
	cau_tets_finish(&all);
}

// ---- random boxes
static double random_share(void)
{
	static uint64_t state = 1;
	state = state * 6364136223846793005u + 1442695040888963407u;
	return (double)(state >> 11) * 0x1p-53;
}

// Checks boxes for which is_uniform() returns true: label_at() must return the same label at the
// box's corners and at random points in it. Some boxes are outside the domain.
static void boxes_keep_their_word(const char *name)
{
	int seen[CAU_SOLID_LABEL_MAX + 1] = {0};
	for (int n = 0; n < BOXES; n++) {
		double least[3], most[3], x[3], size = pow(10, -3 * random_share());
		int32_t label = -1;
		for (int c = 0; c < 3; c++) {
			double width = inner.most[c] - inner.least[c];
			least[c] = inner.least[c] + width * (1.4 * random_share() - 0.2 - size / 2);
			most[c] = least[c] + width * size * random_share();
		}
		if (!inner.is_uniform(&inner, least, most, &label))
			continue;
		assert_in_range(label, 0, inner.label_count);
		seen[label]++;
		for (int k = 0; k < 40; k++) {
			for (int c = 0; c < 3; c++) {
				double share = k < 8 ? k >> c & 1 : random_share();
				x[c] = share < 1 ? least[c] + share * (most[c] - least[c]) : most[c];
			}
			if (inner.label_at(&inner, x, NULL) != label)
				fail_msg("%s: box %d is said to be %d at %g %g %g", name, n, label, x[0], x[1],
				         x[2]);
		}
	}
	print_message("%s: %d boxes outside, %d of label 1\n", name, seen[0], seen[1]);
	assert_true(seen[0] > BOXES / 4);
}

// ---- tests
static void surfaces(void **state)
{
	(void)state;
	enum { BALL, BOWL, TWO_BALLS, SHELL, LEAF, WEDGE, TWO_FAR, KINDS };
	static const char *const name[KINDS] = {"ball", "bowl",  "two balls", "shell",
	                                        "leaf", "wedge", "two far"};
	static const double spacing[KINDS] = {0.034, 0.05, 0.07, 0.05, 0.02, 0.02, 0.08};
	static const double apex[3] = {0.3, 0.3, 0.03};
	for (int kind = 0; kind < KINDS; kind++) {
		cau_mesh mesh;
		shape of;
		begin(&of);
		if (kind == LEAF)
			put_tetrahedron(&of, 0, apex);
		else if (kind == WEDGE)
			fputs("v 0 0 0\nv 1 1 0\nv 0.5 0.1 1\nv 0.3 0.7 0.9\nf 1 2 3\nf 1 4 2\n", of.out);
		else if (kind == TWO_FAR)
			put_two_far(&of, 4);
		// The winding number is a half everywhere in the bowl's opening.
		else if (kind == BOWL)
			put_ball(&of, 1, 0, false, 40, 20);
		else
			put_ball(&of, 1, 0, false, 12, 12);
		if (kind == TWO_BALLS)
			put_ball(&of, 0.5, 3, false, 12, 12);
		if (kind == SHELL)
			put_ball(&of, 0.9, 0, true, 12, 12);
		end(&of, &mesh, &inner);
		lattices_are_the_same(name[kind], spacing[kind]);
		assert_true(kind != BALL || tissue_boxes > 0);
		boxes_keep_their_word(name[kind]);
		cau_domain_finish(&inner);
		cau_mesh_finish(&mesh);
	}
}

// Makes a volume whose axes are not at right angles.
static void volume_of(unsigned char (*label_of)(const int x[3]), cau_volume *volume)
{
	char text[SIDE * SIDE * SIDE + 512];
	int length = snprintf(text, sizeof text,
	                      "NRRD0004\ntype: uint8\ndimension: 3\nspace: RAS\nsizes: %d %d %d\n"
	                      "space directions: (1,0.2,0) (0,0.7,0) (0,0.1,2)\n"
	                      "space origin: (5,0,0)\nencoding: raw\n\n",
	                      SIDE, SIDE, SIDE);
	for (int i = 0; i < SIDE * SIDE * SIDE; i++)
		text[length + i] =
			(char)label_of((const int[3]){i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)});
	assert_int_equal(cau_volume_read((unsigned char *)text, (size_t)length + SIDE * SIDE * SIDE,
	                                 NULL, volume, NULL),
	                 CAU_OK);
	cau_domain_of_volume(volume, &inner);
}

// Returns two labels side by side, and one voxel in a corner of the volume.
static unsigned char blocks_of(const int x[3])
{
	bool in = x[0] > 3 && x[0] < 12 && x[1] > 3 && x[1] < 20 && x[2] < 15;
	bool corner = x[0] == SIDE - 1 && x[1] == SIDE - 1 && x[2] == SIDE - 1;
	return (unsigned char)(in ? 1 + (x[1] > 9) : corner ? 3 : 0);
}

// Returns one voxel in 32 of four labels, and a plate. Most voxels lose the vote.
static unsigned char sparse(const int x[3])
{
	bool in = random_share() < 1.0 / 32;
	return (unsigned char)(x[2] == 5 || x[2] == 6 ? 5 : in ? 1 + (x[0] + x[1]) % 4 : 0);
}

static void volumes(void **state)
{
	(void)state;
	cau_volume volume = {0};
	volume_of(blocks_of, &volume);
	lattices_are_the_same("blocks", 0.5);
	assert_true(tissue_boxes > 0);
	boxes_keep_their_word("blocks");
	cau_volume_finish(&volume);
	volume = (cau_volume){0};
	volume_of(sparse, &volume);
	lattices_are_the_same("sparse", 0.3);
	boxes_keep_their_word("sparse");
	cau_volume_finish(&volume);
}

// The surface has eight triangles, the lattice about sixteen million cells. Less than a twentieth
// of the points is queried.
static void cost_follows_the_tissue(void **state)
{
	(void)state;
	cau_mesh mesh;
	shape of;
	begin(&of);
	put_two_far(&of, 17);
	end(&of, &mesh, &inner);
	const double spacing = 0.0735, cells = pow(floor(18 / spacing) + 4, 3);
	cau_tets tets = lattice_of(spacing, true);
	print_message("%lld places for %.3g cells, %d tetrahedra\n", (long long)places, cells,
	              tets.count);
	assert_true(cells > 15e6);
	assert_true((double)places < 2 * cells / 20);
	assert_true(tets.count > 1000);
	cau_tets_finish(&tets);
	cau_domain_finish(&inner);
	cau_mesh_finish(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(surfaces),
		cmocka_unit_test(volumes),
		cmocka_unit_test(cost_follows_the_tissue),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
