// SPDX-License-Identifier: GPL-3.0-or-later
// Returns a session's constant parts, the last tick's frame, and the damage in a region.
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "session/session_internal.h"

static void describe_layers(const cau_session *session, cau_session_info *info)
{
	CAU_ASSERT(session->tissue.layer_count <= CAU_MAX_LAYERS, "%d layers",
	           session->tissue.layer_count);
	const cau_tissue *tissue = &session->tissue;
	for (int32_t i = 0; i < tissue->layer_count; i++) {
		const cau_tissue_layer *layer = &tissue->layer[i];
		cau_session_layer *out = &info->layers[i];
		memcpy(out->name, layer->def.name, sizeof out->name);
		out->kind = layer->def.kind;
		out->element_count = layer->triangle_count + layer->tetrahedron_count + layer->link_count;
		if (layer->def.kind == CAU_LAYER_FAT) {
			out->first_face = session->view.fat_first_face[i];
			out->face_count = session->view.fat_face_count[i];
		} else {
			out->first_face = layer->first_triangle;
			out->face_count = layer->triangle_count;
		}
	}
}

void cau_session_describe(const cau_session *session, cau_session_info *info)
{
	const cau_tissue *tissue = &session->tissue;
	*info = (cau_session_info){
		.step_s = session->solver.step_s,
		.vertex_count = tissue->vertex_count,
		.face_count = tissue->faces.face_count,
		.triangle_count = tissue->triangle_count,
		.tetrahedron_count = tissue->tetrahedron_count,
		.link_count = tissue->link_count,
		.hinge_count = tissue->hinge_count,
		.edge_count = tissue->edges.edge_count,
		.layer_count = tissue->layer_count,
		.face = tissue->faces.vertex,
		.face_layer = session->view.face_layer,
		.rest_position = tissue->rest,
		.texture = session->view.face_texture,
		.tetrahedron = tissue->tetrahedron,
		.link = tissue->link,
		.instruction_set = session->solver.kernels->instruction_set,
		.mesh_report = session->tissue.mesh_report,
	};
	memcpy(info->name, session->scene->name, sizeof info->name);
	memcpy(info->description, session->scene->description, sizeof info->description);
	describe_layers(session, info);
}

// Finds layer and texture coordinates of every face. Fat faces get the layer of their first owner.
cau_status cau_session_make_faces(cau_session *session, cau_error *error)
{
	const cau_tissue *tissue = &session->tissue;
	const cau_face_table *faces = &tissue->faces;
	size_t count = (size_t)faces->face_count;
	session->view.face_layer = cau_arena_array(&session->memory.arena, count, sizeof(int32_t));
	session->view.face_texture = cau_arena_array(&session->memory.arena, 6 * count, sizeof(float));
	if (!session->view.face_layer || !session->view.face_texture)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the faces");
	memcpy(session->view.face_texture, tissue->texture,
	       6 * (size_t)tissue->triangle_count * sizeof(float));
	for (int32_t f = 0; f < faces->face_count; f++) {
		if (f < faces->triangle_count) {
			session->view.face_layer[f] = tissue->triangle_layer[f];
			continue;
		}
		int32_t layer = tissue->tetrahedron_layer[faces->owner[2 * (size_t)f]];
		CAU_ASSERT(layer >= 0 && tissue->layer[layer].def.kind == CAU_LAYER_FAT,
		           "face %d of fat is in layer %d", f, layer);
		session->view.face_layer[f] = layer;
		if (!session->view.fat_face_count[layer]++)
			session->view.fat_first_face[layer] = f;
	}
	return CAU_OK;
}

// ---- scalars of the vertices --------------------------------------------------------------------

static void make_stress(cau_session *session)
{
	cau_frame_stress(&session->view.frame, &session->tissue, &session->dissection,
	                 session->vertices.position);
}

static void heat_vertices(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		cau_frame_heat(&session->view.frame, &session->heat.near, &session->tool[i].grid,
		               session->vertices.position);
}

// Shows the cells' temperatures. With energy `tissue` the tools' heat grids stay at ambient.
static void heat_by_cells(cau_session *session)
{
	for (int32_t v = 0; session->heat.cells && v < session->tissue.vertex_count; v++)
		cau_frame_heat_vertex(&session->view.frame, v,
		                      (float)cau_tissue_cells_temperature(session->heat.cells, v));
}

static void make_temperature(cau_session *session)
{
	cau_frame_cool(&session->view.frame, &session->tissue, session->scene->ambient_c);
	cau_near_refit(&session->heat.near, session->vertices.position);
	heat_vertices(session);
	heat_by_cells(session);
}

static void follow_temperature(cau_session *session)
{
	cau_frame_cool_heated(&session->view.frame);
	heat_vertices(session);
	heat_by_cells(session);
}

static void make_blood(cau_session *session)
{
	for (int32_t v = 0; session->vessels && v < session->tissue.vertex_count; v++)
		session->view.frame.blood[v] = (float)cau_blood_depth(&session->vessels->blood, v);
}

// How a watched scalar is computed: `make` from the state alone, `follow` after a step from such a
// state. A scalar without an entry is part of every step (cau_frame_update).
typedef struct scalar_source {
	void (*make)(cau_session *session);
	void (*follow)(cau_session *session);
} scalar_source;

static const scalar_source sources[CAU_SCALAR_COUNT] = {
	[CAU_SCALAR_STRESS] = {make_stress, make_stress},
	[CAU_SCALAR_TEMPERATURE] = {make_temperature, follow_temperature},
	[CAU_SCALAR_BLOOD] = {make_blood, make_blood},
};

static bool is_watched(uint32_t channels, int scalar)
{
	return sources[scalar].make && (channels & cau_scalar_channel((cau_scalar)scalar)) != 0;
}

static bool is_made(const cau_session *session, int scalar)
{
	return !sources[scalar].make || is_watched(session->view.watched, scalar);
}

void cau_session_show_scalars(cau_session *session)
{
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		if (is_watched(session->view.watched, scalar))
			sources[scalar].follow(session);
}

void cau_session_renew_scalars(cau_session *session)
{
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		if (is_watched(session->view.watched, scalar))
			sources[scalar].make(session);
}

void cau_session_watch(cau_session *session, uint32_t channels)
{
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		if (is_watched(channels & ~session->view.watched, scalar))
			sources[scalar].make(session);
	cau_session_watch_contact(session, (channels & CAU_CHANNEL_TOOL_CONTACT) != 0);
	session->view.watched = channels;
}

static void fill_statistics(const cau_session *session, cau_statistics *statistics)
{
	const cau_step_solver *solver = &session->solver;
	*statistics = (cau_statistics){
		.iterations = solver->result.iterations,
		.residual = solver->result.residual,
		.backtracks = solver->result.backtracks,
		.inverted = session->inversion.count,
		.edges_parted = session->dissection.edges_parted,
		.elements_removed = session->dissection.elements_removed,
		.elements_torn = session->dissection.tears.elements_torn,
		.pending_downdates = session->update.waiting_count,
		.deferred_max_s = (double)session->update.longest_wait * solver->step_s,
		.refactorisations = session->update.refactorisations,
		.factor_operations = session->update.operation_count,
		.contacts = session->contact.row_count,
		.contacts_left_out = session->contact.left_out_count,
		.touching_cut_short = session->collide.cut_short_count,
		.frozen_vertices = session->vertices.frozen_count,
		.energy_gain_j = session->energy.gain_j,
		.energy_scale_j = session->energy.scale_j,
		.error = solver->accuracy.error,
		.resting = session->rest.resting,
	};
	memcpy(statistics->seconds, session->timing.stage_s, sizeof session->timing.stage_s);
	memcpy(statistics->long_inverted, session->inversion.long_count,
	       sizeof statistics->long_inverted);
}

void cau_session_frame(const cau_session *session, cau_frame *frame)
{
	*frame = (cau_frame){
		.tick = session->tick,
		.time_s = (double)session->tick * session->solver.step_s,
		.position = session->vertices.position,
		.velocity = session->vertices.velocity,
		.moved_count = session->view.frame.moved_count,
		.moved = session->view.frame.moved,
		.face_mask = session->dissection.face_mask,
		.mask_changed_count = session->view.frame.mask_changed_count,
		.mask_changed = session->view.frame.mask_changed,
		.vertex_visible = session->view.frame.vertex_visible,
		.tool_count = session->tool_count,
		.tools = session->view.tool,
		.refusal_count = session->queue.refusal_count,
		.refusals = session->queue.refusal,
	};
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		frame->scalar[scalar] =
			is_made(session, scalar) ? session->view.frame.scalar[scalar] : NULL;
	CAU_ASSERT(session->tool_count <= CAU_MAX_TOOLS, "%d tools", session->tool_count);
	for (int32_t i = 0; i < session->tool_count; i++)
		session->view.tool[i] = session->tool[i].state;
	for (int32_t i = 0; session->vessels && i < session->vessels->vessel_count; i++)
		frame->vessels[frame->vessel_count++] = &session->vessels->vessel[i].state;
	frame->contacts = cau_session_show_contact(session);
	fill_statistics(session, &frame->statistics);
}

void cau_session_set_clock(cau_session *session, double (*now_s)(void))
{
	session->timing.now_s = session->solver.now_s = now_s;
}

void cau_session_alive(const cau_session *session, const uint8_t **tetrahedron,
                       const uint8_t **triangle, const uint8_t **link)
{
	*tetrahedron = session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON];
	*triangle = session->dissection.alive.element[CAU_ELEMENT_TRIANGLE];
	*link = session->dissection.alive.element[CAU_ELEMENT_LINK];
}

// ---- damage

// Heat damage inside and outside a region, as volumes of the tissue at rest.

static bool is_inside(const cau_selection *region, cau_vec3 place)
{
	double at[3];
	cau_vec3_to(place, at);
	if (region->kind == CAU_SELECT_SPHERE)
		return cau_length(cau_sub(place, cau_vec3_of(region->center_m))) <= region->radius_m;
	for (int c = 0; c < 3; c++)
		if (at[c] < region->least_m[c] || at[c] > region->most_m[c])
			return false;
	return true;
}

// Adds an element to the damage on its side of the region, by its corners and rest volume. `alive`:
// the element is not removed.
static void add(const cau_session *session, const cau_selection *region, const int32_t *vertex,
                int corners, double volume_m3, bool alive, cau_damage damage[2])
{
	CAU_ASSERT(volume_m3 > 0, "an element of %g m^3", volume_m3);
	cau_vec3 middle = {0, 0, 0};
	double exposure = 0;
	for (int i = 0; i < corners; i++) {
		cau_vec3 corner = cau_vec3_of(session->tissue.rest + 3 * (size_t)vertex[i]);
		middle = cau_add(middle, cau_scale(1.0 / corners, corner));
		exposure += (double)session->view.frame.exposure[vertex[i]] / corners;
	}
	cau_damage *to = &damage[!is_inside(region, middle)];
	to->removed_count += !alive;
	to->removed_m3 += alive ? 0 : volume_m3;
	to->damaged_m3 += alive ? volume_m3 * exposure : 0;
}

void cau_session_damage(const cau_session *session, const cau_selection *region, cau_damage *inside,
                        cau_damage *outside)
{
	CAU_ASSERT(region->kind == CAU_SELECT_BOX || region->kind == CAU_SELECT_SPHERE,
	           "a region of kind %d", region->kind);
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *tetrahedron, *triangle, *link;
	cau_damage damage[2] = {{0}, {0}};
	cau_session_alive(session, &tetrahedron, &triangle, &link);
	for (int32_t t = 0; t < tissue->tetrahedron_count; t++)
		add(session, region, tissue->tetrahedron + 4 * (size_t)t, 4, tissue->tetrahedron_volume[t],
		    tetrahedron[t], damage);
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		add(session, region, tissue->triangle + 3 * (size_t)t, 3,
		    tissue->triangle_area[t] * cau_triangle_material(tissue, t)->thickness_m, triangle[t],
		    damage);
	*inside = damage[0];
	*outside = damage[1];
}
