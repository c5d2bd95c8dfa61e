// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rig/solve_scenes.h"

#include <string.h>

static const double everywhere_least[3] = {-1, -1, -1};

// Adds fascia similar to the paper's: pinned along one side, with bending.
static void add_fascia(rig *r)
{
	rig_add_sheet(r, 24, 20)->sheet[0].bending_stiffness_nm = 1e-4;
	rig_pin_box(r, everywhere_least, (double[]){-0.0499, 1, 1});
}

static void add_slab(rig *r)
{
	rig_add_slab(r, 12, 10, 5);
	rig_pin_box(r, everywhere_least, (double[]){1, 1, -0.0299});
}

// Adds two slabs and a sheet that are not connected. Nothing is pinned.
static void add_pieces(rig *r)
{
	rig_add_slab(r, 5, 4, 3);
	rig_add_slab(r, 3, 3, 2);
	r->scene->meshes[1].translate_m[2] = 0.2;
	rig_add_sheet(r, 5, 4);
	r->scene->meshes[2].translate_m[2] = 0.1;
}

static void add_one_tetrahedron(rig *r)
{
	static const double points[4][3] = {
		{0, 0, 0}, {0.02, 0, 0}, {0.003, 0.018, 0}, {0, 0.004, 0.02}};
	static const int32_t vertex[4] = {0, 1, 2, 3};
	rig_add_tetrahedra(r, 4, points[0], 1, vertex);
}

// Adds a slab in which only the vertex at the corner (0.05, 0.04, 0) is free.
static void add_one_free_vertex(rig *r)
{
	rig_add_slab(r, 2, 2, 1);
	rig_pin_box(r, everywhere_least, (double[]){0.0499, 1, 1});
	rig_pin_box(r, everywhere_least, (double[]){1, 0.0399, 1});
	rig_pin_box(r, everywhere_least, (double[]){1, 1, -0.001});
}

// Adds fascia linked to fat: stiff and soft tissue together.
static void add_layers(rig *r)
{
	rig_add_slab(r, 8, 6, 3);
	rig_add_sheet(r, 10, 8)->sheet[0].limit_stiffness_pa = 1e7;
	r->scene->meshes[1].translate_m[2] = 0.003;
	rig_add_links(r, 1, 0, 0.03);
	rig_pin_box(r, everywhere_least, (double[]){1, 1, -0.0299});
}

const solve_scene solve_scenes[SOLVE_SCENES] = {
	{"fascia", add_fascia},
	{"slab", add_slab},
	{"disconnected pieces", add_pieces},
	{"one tetrahedron", add_one_tetrahedron},
	{"one free vertex", add_one_free_vertex},
	{"layers", add_layers},
};

void solve_by_factor(rig *r, const double *b, double *x)
{
	const cau_system *system = &r->solver.system;
	size_t rows = (size_t)system->row_count;
	cau_arena scratch = {0};
	double *in = cau_arena_array(&scratch, 3 * rows, sizeof(double));
	double *out = cau_arena_array(&scratch, 3 * rows, sizeof(double));
	for (size_t row = 0; row < rows; row++)
		for (size_t c = 0; c < 3; c++)
			in[c * rows + row] = b[3 * (size_t)system->vertex_of_row[row] + c];
	assert_int_equal(cau_factor_solve(r->solver.factor, in, out, NULL), CAU_OK);
	memset(x, 0, 3 * (size_t)r->tissue.vertex_count * sizeof(double));
	for (size_t row = 0; row < rows; row++)
		for (size_t c = 0; c < 3; c++)
			x[3 * (size_t)system->vertex_of_row[row] + c] = out[c * rows + row];
	cau_arena_finish(&scratch);
}

void solve_by_sweep(rig *r, const double *b, double *x)
{
	int single = r->solver.elements.single;
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		for (int c = 0; c < 3; c++)
			cau_real_set(r->solver.iterate.gradient, single, 4 * v + c, b[3 * v + c]);
	cau_solver_apply_inverse(&r->solver, r->solver.iterate.gradient, r->solver.iterate.increment,
	                         1);
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		for (int c = 0; c < 3; c++)
			x[3 * v + c] = cau_real_get(r->solver.iterate.increment, single, 4 * v + c);
}

void solve_dense_matrix(const rig *r, double *a)
{
	size_t n = (size_t)r->tissue.vertex_count;
	double dt = r->solver.step_s;
	memset(a, 0, n * n * sizeof(double));
	for (size_t v = 0; v < n; v++)
		a[v * n + v] = r->tissue.mass[v] / (dt * dt);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r->tissue, kind); e++) {
			cau_element_map map;
			cau_tissue_element_map(&r->tissue, kind, e, &map);
			for (int k = 0; k < map.rank && r->dissection.alive.element[kind][e]; k++)
				for (int i = 0; i < map.vertex_count; i++)
					for (int j = 0; j < map.vertex_count; j++)
						a[(size_t)map.vertex[i] * n + (size_t)map.vertex[j]] +=
							map.weight * map.coefficient[k][i] * map.coefficient[k][j];
		}
	for (size_t v = 0; v < n; v++)
		for (size_t u = 0; u < n && r->tissue.pinned[v]; u++)
			a[v * n + u] = a[u * n + v] = 0;
}
