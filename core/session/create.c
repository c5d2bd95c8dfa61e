// SPDX-License-Identifier: GPL-3.0-or-later
// Creates and destroys sessions, and shares memory between sessions of equal tissue.
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"
#include "session/session_internal.h"

cau_session_def cau_default_session_def(void)
{
	return (cau_session_def){.thread_count = 1, .command_capacity = 1024};
}

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
}

static cau_status allocate_state(cau_session *session, cau_error *error)
{
	CAU_ASSERT(!session->vertices.position && session->queue.capacity > 0,
	           "state made twice, or for %d commands", session->queue.capacity);
	size_t n = (size_t)session->tissue.vertex_count;
	cau_arena *arena = &session->memory.arena;
	cau_vertices *vertices = &session->vertices;
	cau_driven *driven = &session->driven;
	vertices->position = cau_arena_copy(arena, session->tissue.rest, 3 * n, sizeof(double));
	vertices->velocity = cau_arena_array(arena, 3 * n, sizeof(double));
	vertices->start = cau_arena_copy(arena, session->tissue.rest, 3 * n, sizeof(double));
	vertices->external = cau_arena_array(arena, 3 * n, sizeof(double));
	session->solver.predicted = cau_arena_array(arena, 3 * n, sizeof(double));
	vertices->pinned = cau_arena_copy(arena, session->tissue.pinned, n, 1);
	vertices->fixed = cau_arena_copy(arena, session->tissue.pinned, n, 1);
	vertices->chosen = cau_arena_array(arena, n, 1);
	session->touch.drag = cau_arena_array(arena, n, sizeof *session->touch.drag);
	driven->vertex = cau_arena_array(arena, n, sizeof *driven->vertex);
	driven->position = cau_arena_array(arena, 3 * n, sizeof(double));
	session->tool = cau_arena_array(arena, CAU_MAX_TOOLS, sizeof *session->tool);
	session->view.tool = cau_arena_array(arena, CAU_MAX_TOOLS, sizeof *session->view.tool);
	session->queue.command =
		cau_arena_array(arena, (size_t)session->queue.capacity, sizeof *session->queue.command);
	if (!vertices->position || !vertices->velocity || !vertices->start || !vertices->external ||
	    !session->solver.predicted || !vertices->pinned || !vertices->fixed || !vertices->chosen ||
	    !session->touch.drag || !driven->vertex || !driven->position || !session->tool ||
	    !session->view.tool || !session->queue.command)
		return no_memory(error);
	session->solver.position = vertices->position;
	session->solver.position_start = vertices->start;
	session->solver.forces.external = vertices->external;
	session->solver.fixed = vertices->fixed;
	session->solver.forces.drag = session->touch.drag;
	session->solver.pool = session->pool;
	return CAU_OK;
}

// ---- borders between the stages

// Approximate memory of a session per vertex and per element, before the factor's size is known.
// The numbers are those of sheets and slabs of 10,000 to 250,000 vertices.
enum { BYTES_OF_VERTEX = 1000, BYTES_OF_ELEMENT = 400 };
// Approximate memory for each entry of the factor. CHOLMOD keeps a number of 8 bytes and a row
// index of 4. The packed panels and the other arrays of this size take about as much again.
enum { BYTES_OF_FACTOR_ENTRY = 24 };
// Memory that Newton's method needs for each entry of the factor: a block and its row index
// (solve/newton.h).
enum { BYTES_OF_NEWTON_ENTRY = CAU_BLOCK * 8 + 4 };

// Counts the vertices and elements of generated meshes. Meshes from files are counted only when
// they are read. The scene is checked, so the products of cells do not exceed the limits of a mesh.
static cau_build_border foresee(const cau_scene_def *scene)
{
	cau_build_border border = {.next = CAU_BUILD_MESH};
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		const cau_mesh_def *mesh = &scene->meshes[i];
		int64_t x = mesh->cells[0], y = mesh->cells[1], z = mesh->cells[2];
		if (mesh->source == CAU_MESH_SHEET) {
			border.vertex_count += (x + 1) * (y + 1);
			border.element_count += 2 * x * y;
		} else if (mesh->source == CAU_MESH_SLAB) {
			border.vertex_count += (x + 1) * (y + 1) * (z + 1);
			border.element_count += 6 * x * y * z;
		}
	}
	return border;
}

static int64_t count_elements(const cau_tissue *tissue)
{
	int64_t count = 0;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		count += cau_tissue_element_count(tissue, kind);
	return count;
}

static cau_build_border measure(const cau_session *session, cau_build_stage next)
{
	cau_build_border border = {.next = next,
	                           .vertex_count = session->tissue.vertex_count,
	                           .element_count = count_elements(&session->tissue)};
	if (session->solver.factor)
		border.factor_entries = cau_factor_entries(session->solver.factor);
	return border;
}

// Asks the creator of the session, by `border`, whether the creation shall continue.
static cau_status pass_border(const cau_session *session, const cau_session_def *def,
                              cau_build_border border, cau_error *error)
{
	if (border.next <= CAU_BUILD_ORDER)
		border.bytes = (size_t)(BYTES_OF_VERTEX * border.vertex_count +
		                        BYTES_OF_ELEMENT * border.element_count);
	else
		border.bytes =
			session->memory.arena.byte_count +
			(size_t)((BYTES_OF_FACTOR_ENTRY +
		              (session->solver.settings.newton_chosen ? BYTES_OF_NEWTON_ENTRY : 0)) *
		             border.factor_entries);
	return def->border ? def->border(def->user, &border, error) : CAU_OK;
}

static cau_status make_solver(cau_session *session, const cau_session_def *def, cau_error *error)
{
	cau_arena *arena = &session->memory.arena;
	cau_step_solver *solver = &session->solver;
	cau_dissection *dissection = &session->dissection;
	cau_status status = cau_solver_create(solver, session->scene, &session->tissue, arena, error);
	if (!status)
		status = cau_dissection_create(dissection, &session->tissue, session->scene->seed,
		                               session->scene->parting, arena, error);
	if (!status)
		status = cau_shrink_create(&session->shrink, &session->tissue, arena, error);
	if (status)
		return status;
	cau_elements_set_materials(&solver->elements, &solver->slots, &session->tissue,
	                           dissection->alive.element, session->shrink.shrunk);
	status = cau_solver_analyse(solver, &dissection->alive, NULL, error);
	if (!status)
		status = pass_border(session, def, measure(session, CAU_BUILD_FACTOR), error);
	if (!status)
		status = cau_solver_make_factor(solver, arena, error);
	if (!status)
		status =
			cau_matrix_update_create(&session->update, solver, &dissection->alive, arena, error);
	if (!status)
		status = cau_contact_create(&session->contact, &session->tissue, solver->kernels->vectors,
		                            arena, error);
	return status;
}

static cau_status make_remainder(cau_session *session, cau_error *error)
{
	cau_arena *arena = &session->memory.arena;
	cau_status status = cau_near_create(&session->heat.near, &session->tissue, arena, error);
	session->touch.candidate = cau_session_make_reach(arena);
	session->touch.unheld =
		cau_arena_array(arena, 3 * (size_t)session->tissue.vertex_count, sizeof(double));
	if (!status && (!session->touch.candidate || !session->touch.unheld))
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for contacts");
	if (!status)
		status = cau_session_make_cells(session, error);
	if (!status)
		status = cau_session_make_vessels(session, error);
	for (int32_t i = 0; i < session->scene->tool_count && !status; i++)
		status = cau_session_add_tool(session, &session->scene->tools[i], error);
	if (!status && !session->faulted)
		status = cau_session_relax(session, error);
	if (!status)
		status = cau_session_make_collide(session, error);
	if (!status)
		status = cau_session_make_faces(session, error);
	if (!status)
		status = cau_frame_create(&session->view.frame, &session->tissue, &session->dissection,
		                          arena, error);
	if (!status)
		cau_session_look_at_vessels(session);
	return status;
}

static uint64_t hash_array(uint64_t hash, const void *array, int32_t count, size_t bytes)
{
	CAU_ASSERT(count >= 0 && bytes > 0, "%d elements of %zu bytes", count, bytes);
	return cau_hash_bytes(cau_hash_word(hash, (uint64_t)count), array, (size_t)count * bytes);
}

static uint64_t hash_bioheat(uint64_t hash, const cau_scene_def *scene)
{
	hash = cau_hash_bytes(hash, &scene->cell_m, sizeof scene->cell_m);
	for (int32_t i = 0; i < scene->layer_count; i++) {
		hash = cau_hash_word(hash, (uint64_t)scene->layers[i].tissue);
		hash = cau_hash_bytes(hash, &scene->layers[i].perfusion, sizeof(double));
	}
	return hash;
}

static uint64_t hash_vessels(uint64_t hash, const cau_scene_def *scene)
{
	for (int32_t i = 0; i < scene->vessel_count; i++) {
		const cau_vessel_def *vessel = &scene->vessels[i];
		const double sizes[] = {vessel->radius_m, vessel->wall_m, vessel->pressure_pa,
		                        vessel->end_pressure_pa, vessel->supply_m};
		hash = cau_hash_bytes(hash, sizes, sizeof sizes);
		hash = cau_hash_bytes(hash, vessel->layer, strlen(vessel->layer));
		hash = cau_hash_bytes(hash, vessel->points_m,
		                      (size_t)vessel->point_count * sizeof vessel->points_m[0]);
	}
	return hash;
}

// Hashes the inputs that a snapshot does not hold: time step, solver settings and the tissue at
// rest. Materials are in the snapshot, so they are not hashed.
static uint64_t hash_definition(const cau_session *session)
{
	const cau_scene_def *scene = session->scene;
	const cau_tissue *t = &session->tissue;
	const double numbers[] = {scene->step_s, scene->damping_per_s, scene->ambient_c,
	                          scene->tolerance};
	const int32_t choices[] = {scene->iterations, scene->solver, scene->precision, t->layer_count};
	uint64_t hash = cau_hash_bytes(CAU_HASH_START, numbers, sizeof numbers);
	hash = cau_hash_bytes(hash, choices, sizeof choices);
	hash = cau_hash_word(hash, scene->seed);
	if (scene->integrator != CAU_INTEGRATOR_EULER) // Euler is left out, as in older snapshots
		hash = cau_hash_word(cau_hash_word(hash, UINT64_MAX), (uint64_t)scene->integrator);
	if (scene->parting != CAU_PARTING_EDGES) // left out, as in older snapshots
		hash = cau_hash_word(hash, (uint64_t)scene->parting);
	if (scene->contact_thickness_m > 0) { // a value of 0 is left out, as in older snapshots
		const double contact[] = {scene->contact_thickness_m, scene->contact_friction};
		hash = cau_hash_bytes(hash, contact, sizeof contact);
	}
	if (scene->energy != CAU_ENERGY_PAPER)
		hash = hash_vessels(hash_bioheat(hash, scene), scene);
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (scene->layers[i].coagulated_tear < 1) // a value of 1 is left out, as in older snapshots
			hash = cau_hash_bytes(cau_hash_word(hash, (uint64_t)i),
			                      &scene->layers[i].coagulated_tear, sizeof(double));
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (scene->layers[i].viscosity_s > 0) // a value of 0 is left out, as in older snapshots
			hash = cau_hash_bytes(cau_hash_word(hash, (uint64_t)i), &scene->layers[i].viscosity_s,
			                      sizeof(double));
	hash = hash_array(hash, t->rest, t->vertex_count, 3 * sizeof(double));
	hash = hash_array(hash, t->mass, t->vertex_count, sizeof(double));
	hash = hash_array(hash, t->triangle, t->triangle_count, 3 * sizeof(int32_t));
	hash = hash_array(hash, t->triangle_layer, t->triangle_count, sizeof(int32_t));
	hash = hash_array(hash, t->triangle_frame, t->triangle_count, 6 * sizeof(double));
	hash = hash_array(hash, t->tetrahedron, t->tetrahedron_count, 4 * sizeof(int32_t));
	hash = hash_array(hash, t->tetrahedron_layer, t->tetrahedron_count, sizeof(int32_t));
	hash = hash_array(hash, t->tetrahedron_dm_inverse, t->tetrahedron_count, 9 * sizeof(double));
	hash = hash_array(hash, t->link, t->link_count, 2 * sizeof(int32_t));
	hash = hash_array(hash, t->hinge_vertex, t->hinge_count, 4 * sizeof(int32_t));
	return hash_array(hash, t->hinge_weight, t->hinge_count, sizeof(double));
}

// Adds the material of each element to the definition's hash. Snapshots carry the definition's hash
// only, and no snapshot version holds which material an element has.
uint64_t cau_session_tissue_hash(const cau_session *session)
{
	const cau_tissue *t = &session->tissue;
	uint64_t hash = hash_array(session->definition_hash, t->triangle_material, t->triangle_count,
	                           sizeof(int32_t));
	return hash_array(hash, t->tetrahedron_material, t->tetrahedron_count, sizeof(int32_t));
}

static cau_status build(cau_session *session, const cau_session_def *def, cau_error *error)
{
	cau_status status = cau_scene_check(def->scene, error);
	if (!status)
		status = pass_border(session, def, foresee(def->scene), error);
	if (status)
		return status;
	session->scene = cau_arena_copy(&session->memory.arena, def->scene, 1, sizeof *def->scene);
	session->pool = cau_pool_create(def->thread_count);
	session->queue.capacity = def->command_capacity;
	session->faulted = def->unsettled;
	if (!session->scene || !session->pool)
		return no_memory(error);
	session->solver.kernels =
		cau_kernels_choose(session->scene->precision == CAU_PRECISION_SINGLE, def->instruction_set);
	status = cau_tissue_make(session->scene, &session->memory.arena, &session->tissue, error);
	if (status)
		return status;
	session->watch.size_m = cau_session_size(session);
	status = pass_border(session, def, measure(session, CAU_BUILD_ORDER), error);
	if (!status)
		status = allocate_state(session, error);
	if (!status)
		status = make_solver(session, def, error);
	if (!status)
		status = pass_border(session, def, measure(session, CAU_BUILD_REST), error);
	if (!status)
		status = cau_session_make_watch(session, error);
	if (!status)
		status = cau_session_make_energy(session, error);
	if (!status)
		status = cau_session_make_inversion(session, error);
	if (!status)
		status = cau_session_make_rest(session, error);
	if (!status)
		status = cau_session_make_spin(session, error);
	if (!status)
		status = cau_session_make_substeps(session, error);
	if (!status)
		status = make_remainder(session, error);
	if (status)
		return status;
	session->definition_hash = hash_definition(session);
	return status;
}

cau_status cau_session_create(const cau_session_def *def, cau_session **out, cau_error *error)
{
	if (def->thread_count < 1 || def->thread_count > 16)
		return cau_fail(error, CAU_BAD_VALUE, "thread_count", "%d is not between 1 and 16",
		                def->thread_count);
	if (def->command_capacity < 1 || def->command_capacity > 1 << 20)
		return cau_fail(error, CAU_BAD_VALUE, "command_capacity", "%d is not between 1 and 1048576",
		                def->command_capacity);
	cau_session *session = calloc(1, sizeof *session);
	if (!session)
		return no_memory(error);
	cau_status status = build(session, def, error);
	if (status) {
		cau_session_destroy(session);
		return status;
	}
	*out = session;
	return CAU_OK;
}

void cau_session_destroy(cau_session *session)
{
	if (!session)
		return;
	for (int32_t i = 0; i < session->tool_count; i++)
		cau_heat_grid_finish(&session->tool[i].grid);
	cau_session_unwatch_contact(session);
	cau_matrix_update_finish(&session->update);
	cau_solver_finish(&session->solver);
	cau_tissue_finish(&session->tissue);
	cau_pool_destroy(session->pool);
	cau_arena_finish(&session->memory.rebuilt);
	cau_arena_finish(&session->memory.arena);
	cau_image_release(session->memory.image);
	free(session);
}

cau_status cau_session_adopt(cau_session *session, cau_error *error)
{
	int32_t thread_count = cau_pool_thread_count(session->pool);
	cau_pool *pool = thread_count > 1 ? cau_pool_create(thread_count) : session->pool;
	if (!pool)
		return no_memory(error);
	if (pool != session->pool)
		cau_pool_destroy(session->pool);
	session->pool = session->solver.pool = pool;
	return cau_matrix_update_adopt(&session->update, error);
}

void cau_session_set_threads(cau_session *session, int32_t thread_count)
{
	thread_count = thread_count < 1 ? 1 : thread_count > 16 ? 16 : thread_count;
	if (thread_count == cau_pool_thread_count(session->pool))
		return;
	cau_pool *pool = cau_pool_create(thread_count);
	if (!pool)
		return; // the session keeps its present pool
	cau_pool_destroy(session->pool);
	session->pool = session->solver.pool = pool;
}

// ---- shared memory

// Memory shared by sessions of equal tissue. Most of a session's memory never changes, and much of
// the rest does not change before the first cut (base/image.c).

int32_t cau_session_pages(const cau_session *session, cau_pages pages[CAU_IMAGE_PARTS])
{
	_Static_assert(CAU_FACTOR_PARTS + 1 + CAU_MAX_TOOLS < CAU_IMAGE_PARTS, "room for all");
	int32_t count = 0;
	if (session->solver.factor)
		count += cau_factor_pages(session->solver.factor, pages);
	pages[count++] = session->solver.sweep.pages;
	for (int32_t i = 0; i < session->tool_count; i++)
		pages[count++] = session->tool[i].grid.pages;
	return count + cau_arena_pages(&session->memory.arena, pages + count, CAU_IMAGE_PARTS - count);
}

size_t cau_session_share(cau_session *session)
{
	CAU_ASSERT(!session->memory.image, "session '%s' shares already", session->scene->name);
	cau_pages pages[CAU_IMAGE_PARTS];
	bool made = false;
	cau_matrix_update_await(&session->update);
	int32_t count = cau_session_pages(session, pages);
	session->memory.image = cau_image_of(cau_session_tissue_hash(session), pages, count, &made);
	return session->memory.image ? cau_image_show(session->memory.image, pages, count, made) : 0;
}
