// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solver.h"

#include <string.h>

#include "cautery/assert.h"
#include "constraint/elements.h"
#include "solve/contact.h"

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the solver");
}

static bool is_linearised(int limit, int projection)
{
	return limit == CAU_LIMIT_TARGET && projection == CAU_PROJECTION_LINEARISED;
}

static bool has_energy(const cau_layer_def *layer, int32_t material)
{
	CAU_ASSERT_INDEX(material, layer->material_count);
	if (layer->kind == CAU_LAYER_FAT) {
		const cau_fat_material *fat = &layer->fat[material];
		return cau_law_of(fat->model)->has_energy && !is_linearised(fat->limit, fat->projection);
	}
	const cau_sheet_material *sheet = &layer->sheet[material];
	return layer->kind == CAU_LAYER_LINKS || !is_linearised(sheet->limit, sheet->projection);
}

// True if every law has an energy. Linearised limits, the printed energy constraint and the printed
// position projection are no gradients of an energy.
bool cau_solver_is_conservative(const cau_tissue *tissue, bool diagonal)
{
	for (int32_t i = 0; i < tissue->layer_count; i++)
		for (int32_t m = 0; m < tissue->layer[i].def.material_count; m++)
			if (!has_energy(&tissue->layer[i].def, m))
				return false;
	return !diagonal;
}

static cau_status allocate_vectors(cau_step_solver *solver, cau_arena *arena, cau_error *error)
{
	size_t n = (size_t)solver->tissue->vertex_count, size = solver->kernels->vectors->real_bytes;
	cau_history *history = &solver->anderson.history;
	cau_reals **vectors[] = {&solver->iterate.displacement, &solver->iterate.gradient,
	                         &solver->iterate.increment,    &solver->iterate.trial,
	                         &history->last_increment,      &history->last_gradient};
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		if (!(*vectors[i] = cau_arena_array(arena, 4 * n, size)))
			return no_memory(error);
	for (int j = 0; j < CAU_ANDERSON_WINDOW; j++) {
		history->df[j] = cau_arena_array(arena, 4 * n, size);
		history->h[j] = cau_arena_array(arena, 4 * n, size);
		if (!history->df[j] || !history->h[j])
			return no_memory(error);
	}
	history->step = solver->iterate.trial;
	solver->chunks.count = (solver->tissue->vertex_count + CAU_VERTEX_CHUNK - 1) / CAU_VERTEX_CHUNK;
	solver->chunks.energy = cau_arena_array(arena, (size_t)solver->chunks.count, sizeof(double));
	solver->chunks.dot = cau_arena_array(
		arena, (size_t)solver->chunks.count * 2 * CAU_ANDERSON_WINDOW, sizeof(double));
	solver->iterate.before = cau_arena_array(arena, 3 * n, sizeof(double));
	if (!solver->chunks.energy || !solver->chunks.dot || !solver->iterate.before)
		return no_memory(error);
	return CAU_OK;
}

// A loop has at most CAU_POOL_PARTS parts. A scene of several of the largest meshes would need
// more.
static cau_status check_loops(const cau_step_solver *solver, cau_error *error)
{
	if (solver->chunks.count <= CAU_POOL_PARTS && solver->slots.work_count < CAU_POOL_PARTS)
		return CAU_OK;
	return cau_fail(
		error, CAU_LIMIT, NULL,
		"a tissue has at most %d vertices and %d elements: this one has %d vertices and "
		"%d elements and more",
		CAU_POOL_PARTS * CAU_VERTEX_CHUNK, CAU_POOL_PARTS * CAU_SHARE, solver->tissue->vertex_count,
		solver->tissue->tetrahedron_count + solver->tissue->triangle_count);
}

static double mean_stiffness(const cau_tissue *tissue)
{
	double sum = 0;
	int64_t count = 0;
	for (int kind = CAU_ELEMENT_TRIANGLE; kind <= CAU_ELEMENT_TETRAHEDRON; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, kind); i++, count++) {
			cau_element_map map;
			cau_tissue_element_map(tissue, kind, i, &map);
			sum += map.weight;
		}
	return count ? sum / (double)count : 0;
}

cau_status cau_solver_create(cau_step_solver *solver, const cau_scene_def *scene,
                             const cau_tissue *tissue, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT_INDEX(scene->precision, CAU_PRECISION_COUNT);
	CAU_ASSERT_INDEX(scene->solver, CAU_SOLVER_COUNT);
	bool single = scene->precision == CAU_PRECISION_SINGLE;
	CAU_ASSERT(solver->kernels && solver->kernels->single == single,
	           "kernels of the wrong precision, not %d", single);
	solver->tissue = tissue;
	solver->settings.iterations = scene->iterations;
	solver->settings.tolerance = scene->tolerance;
	solver->settings.stiffness_j = mean_stiffness(tissue);
	solver->step_s = scene->step_s;
	solver->inertia_s = tissue->inertia_s;
	// After two substeps, an error of x2 is 1 / gamma times as large in the velocity.
	double share = solver->inertia_s / solver->step_s;
	solver->accuracy.wanted = scene->tolerance > 0 ? 0 : share * scene->accuracy;
	solver->settings.diagonal = scene->solver == CAU_SOLVER_DIAGONAL;
	solver->whole_panels = CAU_WHOLE_PANELS;
	solver->settings.conservative = cau_solver_is_conservative(tissue, solver->settings.diagonal);
	solver->settings.newton_chosen =
		scene->solver == CAU_SOLVER_NEWTON && solver->settings.conservative;
	cau_status status =
		cau_elements_make(tissue, single, arena, &solver->elements, &solver->slots, error);
	if (!status)
		status = allocate_vectors(solver, arena, error);
	if (!status)
		status = cau_accuracy_create(&solver->accuracy, solver->chunks.count, arena, error);
	if (!status)
		status = check_loops(solver, error);
	if (!status)
		status = cau_system_create(&solver->system, tissue, tissue->pinned, arena, error);
	return status;
}

cau_status cau_solver_analyse(cau_step_solver *solver, const cau_alive *alive,
                              const int32_t *permutation, cau_error *error)
{
	CAU_ASSERT(!solver->factor, "%d rows are factored twice", solver->system.row_count);
	cau_system_assemble_diagonal(&solver->system, solver->tissue, alive, solver->inertia_s);
	if (solver->settings.diagonal || !solver->system.row_count) {
		solver->settings.diagonal = true;
		return CAU_OK;
	}
	cau_system_assemble(&solver->system, solver->tissue, alive, solver->inertia_s,
	                    solver->system.matrix.value);
	return cau_factor_analyse(&solver->factor, &solver->system.matrix, permutation, error);
}

cau_status cau_solver_make_factor(cau_step_solver *solver, cau_arena *arena, cau_error *error)
{
	if (solver->settings.diagonal)
		return CAU_OK;
	cau_status status = cau_factor_refactor(solver->factor, &solver->system.matrix, error);
	if (status) {
		cau_factor_destroy(solver->factor);
		solver->factor = NULL;
		return status;
	}
	return cau_sweep_create(&solver->sweep, arena, solver->factor, solver->kernels,
	                        solver->whole_panels, error);
}

cau_status cau_solver_factor(cau_step_solver *solver, const cau_alive *alive,
                             const int32_t *permutation, cau_arena *arena, cau_error *error)
{
	cau_status status = cau_solver_analyse(solver, alive, permutation, error);
	return status ? status : cau_solver_make_factor(solver, arena, error);
}

int32_t cau_solver_chunk_end(const cau_step_solver *solver, int32_t chunk, int32_t *first)
{
	CAU_ASSERT_INDEX(chunk, solver->chunks.count);
	int32_t last = (chunk + 1) * CAU_VERTEX_CHUNK;
	*first = chunk * CAU_VERTEX_CHUNK;
	return last < solver->tissue->vertex_count ? last : solver->tissue->vertex_count;
}

void cau_solver_finish(cau_step_solver *solver)
{
	cau_loose_finish(&solver->loose);
	cau_sweep_finish(&solver->sweep);
	cau_factor_destroy(solver->factor);
	solver->factor = NULL;
}
