// SPDX-License-Identifier: GPL-3.0-or-later
// States of tissue that go wrong: impossible states, vertices far away, and inverted tetrahedra.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- impossible states

// States that no tissue can have. A step that ends in such a state faults its session, with the
// tick and the layer. Showing the state as tissue would be worse than no step. The bounds are far
// beyond what tissue resists and what any tool or parted strip does here. So only a diverged solver
// or an impossible force exceeds them:
//
// - A vertex moves faster than sound in tissue. Recoil is a wave, and no wave is faster. A strip
//   that heat has parted snaps back at some ten metres a second.
// - A living edge is longer than fifty times its rest length and than twice the size of all tissue.
//   Collagen tears at 1.2 times its length, fat below 3. Tissue here does not tear: a grasper that
//   never slips and pulls a decimetre stretches a mesh of 2 mm by forty. A finer mesh is stretched
//   more, and a mesh of few elements has longer edges. Hence both bounds.
// - Nine tenths of all tetrahedra are inverted. Half of them were inverted under a grasper that was
//   driven a decimetre through the floor to which they are pinned, and they recovered.
//
// Edges are checked only when one may be too long. Each check finds the least length by which an
// edge may still grow. Each tick subtracts twice the farthest motion of a vertex from that length.

static const double fastest_m_s = 1540; // speed of sound in soft tissue
static const double most_stretch = 50, most_sizes = 2;
static const double most_inverted = 0.9;
enum { EDGES_IN_CHUNK = 4096 };

cau_status cau_session_make_watch(cau_session *session, cau_error *error)
{
	cau_watch *watch = &session->watch;
	watch->chunk_count = (session->tissue.edges.edge_count + EDGES_IN_CHUNK - 1) / EDGES_IN_CHUNK;
	size_t edge_chunks = (size_t)watch->chunk_count;
	size_t vertex_chunks = (size_t)session->solver.chunks.count;
	watch->room_m = cau_arena_array(&session->memory.arena, edge_chunks, sizeof(double));
	watch->edge = cau_arena_array(&session->memory.arena, edge_chunks, sizeof(int32_t));
	watch->farthest2_m2 = cau_arena_array(&session->memory.arena, vertex_chunks, sizeof(double));
	watch->astray = cau_arena_array(&session->memory.arena, vertex_chunks, sizeof(int32_t));
	if ((edge_chunks && (!watch->room_m || !watch->edge)) || !watch->farthest2_m2 || !watch->astray)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	return CAU_OK;
}

static const char *layer_of_vertex(const cau_session *session, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, session->tissue.vertex_count);
	const cau_tissue *tissue = &session->tissue;
	for (int32_t i = 0; i < tissue->layer_count; i++) {
		const cau_tissue_layer *layer = &tissue->layer[i];
		if (vertex >= layer->first_vertex && vertex < layer->first_vertex + layer->vertex_count)
			return layer->def.name;
	}
	return "";
}

static cau_status refuse(const cau_session *session, cau_error *error, const char *layer,
                         const char *what)
{
	CAU_ASSERT(layer && what[0], "a refusal without a layer or a reason: %s", what);
	return cau_fail(error, CAU_NUMERICAL, NULL, "at tick %llu, in layer \"%s\": %s",
	                (unsigned long long)session->tick, layer, what);
}

// ---- the solver's own refusal
static const char *layer_of_share(const cau_session *session, const cau_local_work *work)
{
	CAU_ASSERT_INDEX(work->kind, CAU_ELEMENT_KINDS);
	const cau_elements *elements = &session->solver.elements;
	const int32_t *element_at = session->solver.slots.element_at[work->kind];
	const cau_tissue *tissue = &session->tissue;
	if (work->kind == CAU_ELEMENT_TETRAHEDRON)
		return tissue->layer[elements->fat.group[work->group].layer].def.name;
	if (work->kind == CAU_ELEMENT_TRIANGLE)
		return tissue->layer[elements->sheet.group[work->group].layer].def.name;
	if (work->kind == CAU_ELEMENT_LINK)
		return tissue->layer[tissue->link_layer[element_at[work->first]]].def.name;
	return layer_of_vertex(session, tissue->hinge_vertex[4 * (size_t)element_at[work->first]]);
}

// Adds to *error the layer of an element whose energy is not finite. If there is none, adds the
// layer of a vertex whose position is not finite.
cau_status cau_session_locate(const cau_session *session, cau_error *error)
{
	char reason[sizeof error->reason];
	memcpy(reason, error->reason, sizeof reason);
	for (int32_t w = 0; w < session->solver.slots.work_count; w++)
		if (!isfinite(session->solver.elements.energy[w]))
			return refuse(session, error, layer_of_share(session, &session->solver.slots.work[w]),
			              reason);
	int32_t v = 0;
	for (; v < session->tissue.vertex_count - 1; v++)
		if (!isfinite(session->vertices.position[3 * v] + session->vertices.position[3 * v + 1] +
		              session->vertices.position[3 * v + 2]))
			break;
	return refuse(session, error, layer_of_vertex(session, v), reason);
}

// ---- vertices
static void motion_part(void *context, int32_t chunk)
{
	cau_session *session = context;
	CAU_ASSERT_INDEX(chunk, session->solver.chunks.count);
	const double *x = session->vertices.position, *start = session->vertices.start;
	double most = fastest_m_s * session->solver.step_s, farthest2 = 0;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK, astray = -1;
	if (last > session->tissue.vertex_count)
		last = session->tissue.vertex_count;
	for (int32_t v = first; v < last; v++) {
		double move2 = 0;
		for (int c = 0; c < 3; c++)
			move2 += (x[3 * v + c] - start[3 * v + c]) * (x[3 * v + c] - start[3 * v + c]);
		farthest2 = move2 > farthest2 ? move2 : farthest2;
		// true if move2 is not a number; supports may move at any finite speed
		if (!(move2 <= most * most) && astray < 0 &&
		    !(session->vertices.fixed[v] && isfinite(move2)))
			astray = v;
	}
	session->watch.farthest2_m2[chunk] = farthest2;
	session->watch.astray[chunk] = astray;
}

static cau_status refuse_vertex(const cau_session *session, int32_t vertex, cau_error *error)
{
	char what[128];
	const double *x = session->vertices.position + 3 * (size_t)vertex;
	const double *start = session->vertices.start + 3 * (size_t)vertex;
	double move = cau_length(cau_sub(cau_vec3_of(x), cau_vec3_of(start)));
	if (isfinite(move))
		snprintf(what, sizeof what, "vertex %d moves at %.4g m/s, faster than sound in tissue",
		         vertex, move / session->solver.step_s);
	else
		snprintf(what, sizeof what, "the position of vertex %d is not a number", vertex);
	return refuse(session, error, layer_of_vertex(session, vertex), what);
}

// ---- edges
static double length_m(const double *position, const int32_t *edge)
{
	CAU_ASSERT(edge[0] != edge[1], "an edge from vertex %d to itself", edge[0]);
	return cau_length(cau_sub(cau_vec3_of(position + 3 * (size_t)edge[1]),
	                          cau_vec3_of(position + 3 * (size_t)edge[0])));
}

// Returns the layer of a living element at the edge, or NULL if no living element has the edge.
static const char *living_layer(const cau_session *session, int32_t edge)
{
	CAU_ASSERT_INDEX(edge, session->tissue.edges.edge_count);
	static const int kinds[] = {CAU_ELEMENT_TRIANGLE, CAU_ELEMENT_TETRAHEDRON, CAU_ELEMENT_LINK};
	const cau_tissue *tissue = &session->tissue;
	const int32_t *layer[] = {tissue->triangle_layer, tissue->tetrahedron_layer,
	                          tissue->link_layer};
	for (int k = 0; k < CAU_PRIMITIVE_KINDS; k++)
		for (int32_t i = tissue->edges.first[k][edge]; i < tissue->edges.first[k][edge + 1]; i++) {
			int32_t element = tissue->edges.sharer[k][i];
			if (session->dissection.alive.element[kinds[k]][element])
				return tissue->layer[layer[k][element]].def.name;
		}
	return NULL;
}

static void edge_part(void *context, int32_t chunk)
{
	cau_session *session = context;
	CAU_ASSERT_INDEX(chunk, session->watch.chunk_count);
	const cau_edge_table *edges = &session->tissue.edges;
	int32_t first = chunk * EDGES_IN_CHUNK, last = first + EDGES_IN_CHUNK, shortest = -1;
	double least = INFINITY, whole = most_sizes * session->watch.size_m;
	if (last > edges->edge_count)
		last = edges->edge_count;
	for (int32_t e = first; e < last; e++) {
		const int32_t *vertex = edges->vertex + 2 * (size_t)e;
		double most = fmax(most_stretch * length_m(session->tissue.rest, vertex), whole);
		double room = most - length_m(session->vertices.position, vertex);
		if (room < least && living_layer(session, e)) {
			least = room;
			shortest = e;
		}
	}
	session->watch.room_m[chunk] = least;
	session->watch.edge[chunk] = shortest;
}

static cau_status refuse_edge(const cau_session *session, int32_t edge, cau_error *error)
{
	char what[128];
	const int32_t *vertex = session->tissue.edges.vertex + 2 * (size_t)edge;
	snprintf(what, sizeof what,
	         "the edge between vertices %d and %d is %.4g times as long as at rest", vertex[0],
	         vertex[1],
	         length_m(session->vertices.position, vertex) / length_m(session->tissue.rest, vertex));
	return refuse(session, error, living_layer(session, edge), what);
}

static cau_status check_edges(cau_session *session, cau_error *error)
{
	cau_watch *watch = &session->watch;
	int32_t worst = -1;
	cau_pool_run(session->pool, watch->chunk_count, edge_part, session);
	watch->left_m = INFINITY;
	for (int32_t k = 0; k < watch->chunk_count; k++)
		if (watch->room_m[k] < watch->left_m) {
			watch->left_m = watch->room_m[k];
			worst = watch->edge[k];
		}
	CAU_ASSERT(watch->left_m >= 0 || worst >= 0, "no edge is %g m too long", -watch->left_m);
	return watch->left_m < 0 ? refuse_edge(session, worst, error) : CAU_OK;
}

cau_status cau_session_check_motion(cau_session *session, cau_error *error)
{
	cau_watch *watch = &session->watch;
	double farthest2 = 0;
	int32_t chunks = session->solver.chunks.count;
	cau_pool_run(session->pool, chunks, motion_part, session);
	for (int32_t k = 0; k < chunks; k++) {
		if (watch->astray[k] >= 0)
			return refuse_vertex(session, watch->astray[k], error);
		farthest2 = fmax(farthest2, watch->farthest2_m2[k]);
	}
	watch->left_m -= 2 * sqrt(farthest2);
	return watch->left_m > 0 ? CAU_OK : check_edges(session, error);
}

// ---- tetrahedra
static const char *layer_of_most_fat(const cau_tissue *tissue)
{
	CAU_ASSERT(tissue->layer_count > 0, "%d layers", tissue->layer_count);
	int32_t most = 0;
	for (int32_t i = 1; i < tissue->layer_count; i++)
		if (tissue->layer[i].tetrahedron_count > tissue->layer[most].tetrahedron_count)
			most = i;
	return tissue->layer[most].def.name;
}

cau_status cau_session_check_inverted(const cau_session *session, cau_error *error)
{
	CAU_ASSERT(session->inversion.count >= 0 &&
	               session->inversion.count <= session->tissue.tetrahedron_count,
	           "%d of %d tetrahedra", session->inversion.count, session->tissue.tetrahedron_count);
	char what[128];
	const cau_tissue *tissue = &session->tissue;
	if (session->inversion.count <= most_inverted * tissue->tetrahedron_count)
		return CAU_OK;
	snprintf(what, sizeof what, "%d of %d tetrahedra are inverted", session->inversion.count,
	         tissue->tetrahedron_count);
	return refuse(session, error, layer_of_most_fat(tissue), what);
}

// ---- strays

// Tissue that was cut free falls for ever. Far away, single precision cannot distinguish an
// element's corners. The noise of such energies would dominate the objective of all the other
// tissue. So a vertex that is many tissue sizes away is stopped there, like a vertex without
// elements.

// Greatest distance of a vertex, in tissue sizes. There, the rounding of single precision is 1e-5
// of a size, far below an edge.
static const double farthest_sizes = 200;

double cau_session_size(const cau_session *session)
{
	const double *rest = session->tissue.rest;
	double squared = 0;
	for (size_t c = 0; c < 3; c++) {
		double least = INFINITY, most = -INFINITY;
		for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++) {
			least = fmin(least, rest[3 * v + c]);
			most = fmax(most, rest[3 * v + c]);
		}
		squared += (most - least) * (most - least);
	}
	return sqrt(squared);
}

double cau_session_farthest_from_rest(const cau_session *session)
{
	CAU_ASSERT(session->watch.size_m > 0, "tissue of %g m", session->watch.size_m);
	return farthest_sizes * session->watch.size_m;
}

static void stop(cau_session *session, size_t vertex, cau_vec3 way)
{
	CAU_ASSERT(!session->vertices.fixed[vertex], "vertex %zu is stopped twice", vertex);
	double *position = session->vertices.position + 3 * vertex;
	cau_vec3 rest = cau_vec3_of(session->tissue.rest + 3 * vertex);
	double reach_m = cau_session_farthest_from_rest(session);
	cau_vec3_to(cau_add_scaled(rest, reach_m / cau_length(way), way), position);
	memset(session->vertices.velocity + 3 * vertex, 0, 3 * sizeof(double));
	session->vertices.fixed[vertex] = 1;
	session->vertices.frozen_count++;
}

void cau_session_stop_strays(cau_session *session)
{
	CAU_ASSERT(session->vertices.frozen_count <= session->tissue.vertex_count,
	           "%d vertices frozen of %d", session->vertices.frozen_count,
	           session->tissue.vertex_count);
	bool stopped = false;
	double reach_m = cau_session_farthest_from_rest(session);
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++) {
		cau_vec3 way = cau_sub(cau_vec3_of(session->vertices.position + 3 * v),
		                       cau_vec3_of(session->tissue.rest + 3 * v));
		if (session->vertices.fixed[v] || cau_dot(way, way) <= reach_m * reach_m)
			continue;
		stop(session, v, way);
		stopped = true;
	}
	if (!stopped)
		return;
	session->watch.left_m = 0; // vertices were moved, so the edges are checked again
	session->energy.stale = true;
	cau_session_drop_frozen_grasps(session);
}

// ---- inverted tetrahedra

// Inverted tetrahedra. A step may leave some, and the next steps usually restore them. The energy
// of StVK has a minimum at an inverted shape, so this law can keep them inverted with every number
// finite. Tetrahedra that stay inverted are counted by layer, and the session reports the counts.

// Time, s, from which on an inversion is counted as long. Inversions of a fast motion last only
// some ticks. An inversion of half a second has another cause.
static const double long_s = 0.5;

cau_status cau_session_make_inversion(cau_session *session, cau_error *error)
{
	cau_inversion *inversion = &session->inversion;
	inversion->ticks =
		cau_arena_array(&session->memory.arena, (size_t)session->tissue.tetrahedron_count + 1,
	                    sizeof *inversion->ticks);
	CAU_ASSERT(session->solver.step_s >= long_s / UINT16_MAX, "steps of %g s",
	           session->solver.step_s);
	inversion->long_ticks = (uint16_t)ceil(long_s / session->solver.step_s);
	return inversion->ticks ? CAU_OK
	                        : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
}

bool cau_session_is_inverted(const double *position, const int32_t vertex[4])
{
	cau_vec3 from = cau_vec3_of(position + 3 * (size_t)vertex[0]), side[3];
	for (int k = 0; k < 3; k++)
		side[k] = cau_sub(cau_vec3_of(position + 3 * (size_t)vertex[k + 1]), from);
	// at rest the volume is positive (mesh/mesh.h)
	return !(cau_dot(side[0], cau_cross(side[1], side[2])) > 0);
}

void cau_session_forget_inversion(cau_session *session)
{
	cau_inversion *inversion = &session->inversion;
	memset(inversion->ticks, 0,
	       (size_t)session->tissue.tetrahedron_count * sizeof *inversion->ticks);
	memset(inversion->long_count, 0, sizeof inversion->long_count);
	inversion->followed = false;
}

void cau_session_follow_inversion(cau_session *session)
{
	cau_inversion *inversion = &session->inversion;
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *alive = session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON];
	CAU_ASSERT(inversion->long_ticks > 0, "nothing stays for %d ticks", inversion->long_ticks);
	if (!inversion->count) {
		if (inversion->followed)
			cau_session_forget_inversion(session);
		return;
	}
	memset(inversion->long_count, 0, sizeof inversion->long_count);
	inversion->followed = true;
	for (int32_t i = 0; i < tissue->tetrahedron_count; i++) {
		uint16_t *ticks = &inversion->ticks[i];
		const int32_t *vertex = tissue->primitives.tetrahedron + 4 * (size_t)i;
		if (!alive[i] || !cau_session_is_inverted(session->vertices.position, vertex))
			*ticks = 0;
		else if (*ticks < inversion->long_ticks)
			++*ticks;
		inversion->long_count[tissue->tetrahedron_layer[i]] += *ticks == inversion->long_ticks;
	}
}
