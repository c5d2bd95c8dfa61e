// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rig/rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/session.h"
#include "core/rig/tier.h"

enum { TEXT_BYTES = 1 << 16 };

static void expect_ok(cau_status status, const cau_error *error)
{
	if (status)
		fail_msg("%s: %s (%s)", cau_status_name(status), error->reason, error->path);
}

void rig_begin(rig *r)
{
	memset(r, 0, sizeof *r);
	r->scene = cau_arena_array(&r->arena, 1, sizeof *r->scene);
	assert_non_null(r->scene);
	cau_default_scene_def(r->scene);
	strcpy(r->scene->name, "rig");
	r->scene->precision = CAU_PRECISION_DOUBLE;
	memset(r->scene->gravity_m_s2, 0, sizeof r->scene->gravity_m_s2);
}

static cau_layer_def *add_layer(rig *r, int kind)
{
	int32_t index = r->scene->layer_count++;
	cau_layer_def *layer = &r->scene->layers[index];
	cau_default_layer_def(layer, kind);
	snprintf(layer->name, sizeof layer->name, "layer%d", index);
	return layer;
}

static cau_mesh_def *add_mesh(rig *r, cau_layer_def *layer, int source)
{
	cau_mesh_def *mesh = &r->scene->meshes[r->scene->mesh_count];
	cau_default_mesh_def(mesh);
	mesh->source = source;
	snprintf(mesh->name, sizeof mesh->name, "mesh%d", r->scene->mesh_count++);
	memcpy(layer->mesh, mesh->name, sizeof layer->mesh);
	return mesh;
}

cau_layer_def *rig_add_sheet(rig *r, int32_t cells_x, int32_t cells_y)
{
	cau_layer_def *layer = add_layer(r, CAU_LAYER_FASCIA);
	cau_mesh_def *mesh = add_mesh(r, layer, CAU_MESH_SHEET);
	mesh->size_m[1] = 0.08;
	mesh->cells[0] = cells_x;
	mesh->cells[1] = cells_y;
	return layer;
}

cau_layer_def *rig_add_slab(rig *r, int32_t x, int32_t y, int32_t z)
{
	cau_layer_def *layer = add_layer(r, CAU_LAYER_FAT);
	cau_mesh_def *mesh = add_mesh(r, layer, CAU_MESH_SLAB);
	memcpy(mesh->size_m, (double[]){0.1, 0.08, 0.03}, sizeof mesh->size_m);
	memcpy(mesh->cells, (int32_t[]){x, y, z}, sizeof mesh->cells);
	return layer;
}

// Allocates a text that the scene borrows until it is built.
static char *borrow_text(rig *r, cau_mesh_def *mesh, const char *name)
{
	char *text = cau_arena_array(&r->arena, TEXT_BYTES, 1);
	assert_non_null(text);
	strcpy(mesh->file, name);
	mesh->bytes = text;
	return text;
}

cau_layer_def *rig_add_triangles(rig *r, int32_t point_count, const double *points, int32_t count,
                                 const int32_t *vertex)
{
	cau_layer_def *layer = add_layer(r, CAU_LAYER_FASCIA);
	cau_mesh_def *mesh = add_mesh(r, layer, CAU_MESH_BYTES);
	char *text = borrow_text(r, mesh, "triangles.obj"), *at = text;
	for (int32_t i = 0; i < point_count; i++)
		at += sprintf(at, "v %.17g %.17g %.17g\n", points[3 * i], points[3 * i + 1],
		              points[3 * i + 2]);
	for (int32_t t = 0; t < count; t++)
		at += sprintf(at, "f %d %d %d\n", vertex[3 * t] + 1, vertex[3 * t + 1] + 1,
		              vertex[3 * t + 2] + 1);
	mesh->byte_count = (size_t)(at - text);
	return layer;
}

cau_layer_def *rig_add_tetrahedra(rig *r, int32_t point_count, const double *points, int32_t count,
                                  const int32_t *vertex)
{
	cau_layer_def *layer = add_layer(r, CAU_LAYER_FAT);
	cau_mesh_def *mesh = add_mesh(r, layer, CAU_MESH_BYTES);
	char *text = borrow_text(r, mesh, "tetrahedra.vtk"), *at = text;
	at += sprintf(at,
	              "# vtk DataFile Version 3.0\nrig\nASCII\nDATASET UNSTRUCTURED_GRID\n"
	              "POINTS %d double\n",
	              point_count);
	for (int32_t i = 0; i < point_count; i++)
		at +=
			sprintf(at, "%.17g %.17g %.17g\n", points[3 * i], points[3 * i + 1], points[3 * i + 2]);
	at += sprintf(at, "CELLS %d %d\n", count, 5 * count);
	for (int32_t t = 0; t < count; t++)
		at += sprintf(at, "4 %d %d %d %d\n", vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2],
		              vertex[4 * t + 3]);
	at += sprintf(at, "CELL_TYPES %d\n", count);
	for (int32_t t = 0; t < count; t++)
		at += sprintf(at, "10\n");
	mesh->byte_count = (size_t)(at - text);
	return layer;
}

cau_layer_def *rig_add_links(rig *r, int32_t of, int32_t to, double reach_m)
{
	cau_layer_def *layer = add_layer(r, CAU_LAYER_LINKS);
	memcpy(layer->of, r->scene->layers[of].name, sizeof layer->of);
	memcpy(layer->to, r->scene->layers[to].name, sizeof layer->to);
	layer->link.reach_m = reach_m;
	return layer;
}

void rig_pin_box(rig *r, const double least_m[3], const double most_m[3])
{
	cau_selection *pin = &r->scene->pins[r->scene->pin_count++];
	cau_default_selection(pin, CAU_SELECT_BOX);
	memcpy(pin->least_m, least_m, sizeof pin->least_m);
	memcpy(pin->most_m, most_m, sizeof pin->most_m);
}

void rig_build(rig *r, const char *tier, int32_t threads)
{
	cau_error error = {0};
	expect_ok(cau_scene_check(r->scene, &error), &error);
	expect_ok(cau_tissue_make(r->scene, &r->arena, &r->tissue, &error), &error);
	size_t n = 3 * (size_t)r->tissue.vertex_count;
	cau_step_solver *solver = &r->solver;
	bool single = r->scene->precision == CAU_PRECISION_SINGLE;
	solver->kernels = cau_kernels_choose(single, tier ? tier : test_tier());
	solver->pool = cau_pool_create(threads);
	r->fixed = cau_arena_copy(&r->arena, r->tissue.pinned, (size_t)r->tissue.vertex_count, 1);
	solver->fixed = r->fixed;
	solver->position = cau_arena_copy(&r->arena, r->tissue.rest, n, sizeof(double));
	solver->predicted = cau_arena_copy(&r->arena, r->tissue.rest, n, sizeof(double));
	solver->forces.external = cau_arena_array(&r->arena, n, sizeof(double));
	assert_non_null(solver->pool);
	assert_true(solver->position && solver->predicted && solver->forces.external && r->fixed);
	expect_ok(cau_solver_create(solver, r->scene, &r->tissue, &r->arena, &error), &error);
	expect_ok(
		cau_dissection_create(&r->dissection, &r->tissue, 1, r->scene->parting, &r->arena, &error),
		&error);
	expect_ok(cau_shrink_create(&r->shrink, &r->tissue, &r->arena, &error), &error);
	cau_elements_set_materials(&solver->elements, &solver->slots, &r->tissue,
	                           r->dissection.alive.element, r->shrink.shrunk);
}

void rig_factor(rig *r)
{
	cau_error error = {0};
	expect_ok(cau_solver_factor(&r->solver, &r->dissection.alive, NULL, &r->arena, &error), &error);
	expect_ok(
		cau_matrix_update_create(&r->update, &r->solver, &r->dissection.alive, &r->arena, &error),
		&error);
}

void rig_finish(rig *r)
{
	cau_matrix_update_finish(&r->update);
	cau_solver_finish(&r->solver);
	cau_tissue_finish(&r->tissue);
	cau_pool_destroy(r->solver.pool);
	cau_arena_finish(&r->arena);
}

double rig_local(rig *r, const double *x, double *gradient)
{
	cau_step_solver *solver = &r->solver;
	int single = solver->elements.single;
	int32_t n = r->tissue.vertex_count;
	for (int32_t v = 0; v < n; v++)
		for (int c = 0; c < 3; c++)
			cau_real_set(solver->iterate.displacement, single, 4 * v + c,
			             x[3 * v + c] - r->tissue.rest[3 * v + c]);
	for (int32_t w = 0; w < solver->slots.work_count; w++)
		solver->kernels->local(&solver->elements, &solver->slots.work[w],
		                       solver->iterate.displacement, solver->settings.diagonal);
	solver->kernels->sum(&solver->elements, &solver->slots.incidence, 0, n,
	                     solver->iterate.gradient);
	for (int32_t v = 0; v < n && gradient; v++)
		for (int c = 0; c < 3; c++)
			gradient[3 * v + c] = cau_real_get(solver->iterate.gradient, single, 4 * v + c);
	return cau_solver_elastic_energy(solver);
}

double rig_energy_of(const rig *r, int work_kind)
{
	double energy = 0;
	for (int32_t w = 0; w < r->solver.slots.work_count; w++)
		if (r->solver.slots.work[w].kind == work_kind)
			energy += r->solver.elements.energy[w];
	return energy;
}

// The kernels' weights of a kind of element, and the records to which its gradient is added.
typedef struct weights_of {
	void *weight[2]; // real
	int count;
	uint16_t *const *record_at;
} weights_of;

static weights_of weights(const cau_elements *e, int kind)
{
	switch (kind) {
	case CAU_ELEMENT_TRIANGLE:
		return (weights_of){{e->sheet.weight}, 1, e->sheet.record_at};
	case CAU_ELEMENT_TETRAHEDRON:
		return (weights_of){{e->fat.volume, e->fat.limit_weight}, 2, e->fat.record_at};
	case CAU_ELEMENT_LINK:
		return (weights_of){{e->link.weight}, 1, e->link.record_at};
	default:
		return (weights_of){{e->hinge.weight}, 1, e->hinge.record_at};
	}
}

static const cau_local_work *share_of(const rig *r, int kind, int32_t slot)
{
	const cau_local_work *work = r->solver.slots.work;
	while (work->kind != kind || slot < work->first || slot >= work->last)
		work++;
	return work;
}

int32_t rig_record(const rig *r, int kind, int32_t slot, int i)
{
	return share_of(r, kind, slot)->first_record +
	       weights(&r->solver.elements, kind).record_at[i][slot] / 4;
}

int32_t rig_vertex(const rig *r, int kind, int32_t slot, int i)
{
	return r->solver.elements.record_vertex[rig_record(r, kind, slot, i)] / 4;
}

int rig_vertex_count(int kind)
{
	static const int count[] = {3, 4, 2, 4};
	return count[kind];
}

void rig_element_gradient(rig *r, int kind, int32_t slot, double *gradient)
{
	cau_step_solver *solver = &r->solver;
	const cau_elements *e = &solver->elements;
	weights_of w = weights(e, kind);
	const cau_local_work *work = share_of(r, kind, slot);
	double kept[2][4096] = {{0}};
	assert_true(work->last - work->first <= 4096);
	for (int k = 0; k < w.count; k++)
		for (int32_t s = work->first; s < work->last; s++) {
			kept[k][s - work->first] = cau_real_get(w.weight[k], e->single, s);
			if (s != slot)
				cau_real_set(w.weight[k], e->single, s, 0);
		}
	solver->kernels->local(e, work, solver->iterate.displacement, solver->settings.diagonal);
	for (int i = 0; i < rig_vertex_count(kind); i++)
		for (int c = 0; c < 3; c++)
			gradient[3 * i + c] =
				cau_real_get(e->gradient, e->single, 4 * rig_record(r, kind, slot, i) + c);
	for (int k = 0; k < w.count; k++)
		for (int32_t s = work->first; s < work->last; s++)
			cau_real_set(w.weight[k], e->single, s, kept[k][s - work->first]);
}

void rig_remove(rig *r, int kind, int32_t element, uint64_t tick)
{
	r->dissection.alive.element[kind][element] = 0;
	cau_elements_remove(&r->solver.elements, &r->solver.slots, kind, element);
	if (r->update.solver)
		cau_matrix_update_remove(&r->update, kind, element, tick);
}

void rig_update_factor(rig *r, uint64_t tick)
{
	cau_error error = {0};
	const cau_alive *alive = &r->dissection.alive;
	expect_ok(cau_matrix_update_begin(&r->update, alive, tick, &error), &error);
	cau_matrix_update_take_out(&r->update);
	expect_ok(cau_matrix_update_end(&r->update, alive, tick, &error), &error);
}

void rig_deform(const rig *r, double a[3][3], double noise_m, uint64_t *random, double *x)
{
	for (int32_t v = 0; v < r->tissue.vertex_count; v++) {
		mat_apply(a, r->tissue.rest + 3 * v, x + 3 * v);
		for (int c = 0; c < 3; c++)
			x[3 * v + c] += random_between(random, -noise_m, noise_m);
	}
}

void rig_random_gradient(uint64_t *random, double size, double a[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			a[i][j] = (i == j) + random_between(random, -size, size);
}

double rig_difference(const double *a, const double *b, size_t n)
{
	double difference = 0, size = 0;
	for (size_t i = 0; i < n; i++) {
		difference = fmax(difference, fabs(a[i] - b[i]));
		if (!isfinite(a[i]) || !isfinite(b[i]))
			return INFINITY;
		size = fmax(size, fabs(b[i]));
	}
	return size > 0 ? difference / size : difference;
}
