// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame_state.h"

#include <stdbool.h>
#include <string.h>

#include "cautery/assert.h"

static int32_t word_count(const cau_tissue *tissue)
{
	return (tissue->faces.face_count + 31) / 32;
}

cau_status cau_frame_create(cau_frame_state *frame, const cau_tissue *tissue,
                            const cau_dissection *dissection, cau_arena *arena, cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count, words = (size_t)word_count(tissue);
	frame->moved = cau_arena_array(arena, n, sizeof(int32_t));
	frame->mask_changed = cau_arena_array(arena, words, sizeof(int32_t));
	frame->mask_before = cau_arena_array(arena, words, sizeof(uint32_t));
	frame->vertex_visible = cau_arena_array(arena, n, 1);
	frame->vertex_faces = cau_arena_array(arena, n, sizeof(int32_t));
	frame->edge_burnt = cau_arena_array(arena, (size_t)tissue->edges.edge_count, 1);
	frame->burnt_edges = cau_arena_array(arena, n, sizeof(int32_t));
	frame->vertex_edges = cau_arena_array(arena, n, sizeof(int32_t));
	frame->stress_weight = cau_arena_array(arena, n, sizeof(float));
	frame->heated = cau_arena_array(arena, n, sizeof(int32_t));
	bool has_scalars = true;
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++) {
		frame->scalar[scalar] = cau_arena_array(arena, n, sizeof(float));
		has_scalars &= frame->scalar[scalar] != NULL;
	}
	if (!frame->moved || !frame->mask_changed || !frame->mask_before || !frame->vertex_visible ||
	    !frame->vertex_faces || !frame->edge_burnt || !frame->burnt_edges || !frame->vertex_edges ||
	    !frame->stress_weight || !frame->heated || !has_scalars)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for frames");
	for (int32_t k = 0; k < 2 * tissue->edges.edge_count; k++)
		frame->vertex_edges[tissue->edges.vertex[k]]++;
	cau_frame_rebuild(frame, dissection);
	return CAU_OK;
}

static void change_face(cau_frame_state *frame, const cau_tissue *tissue, int32_t face, bool drawn)
{
	CAU_ASSERT_INDEX(face, tissue->faces.face_count);
	for (int i = 0; i < 3; i++) {
		int32_t v = tissue->faces.vertex[3 * (size_t)face + (size_t)i];
		frame->vertex_faces[v] += drawn ? 1 : -1;
		CAU_ASSERT(frame->vertex_faces[v] >= 0, "vertex %d has %d faces", v,
		           frame->vertex_faces[v]);
		frame->vertex_visible[v] = frame->vertex_faces[v] > 0;
	}
}

static void update_mask(cau_frame_state *frame, const cau_dissection *dissection)
{
	const cau_tissue *tissue = dissection->tissue;
	frame->mask_changed_count = 0;
	for (int32_t w = 0; w < word_count(tissue); w++) {
		uint32_t changed = frame->mask_before[w] ^ dissection->face_mask[w];
		if (!changed)
			continue;
		for (int32_t bit = 0; bit < 32; bit++)
			if (changed >> bit & 1)
				change_face(frame, tissue, 32 * w + bit, !(dissection->face_mask[w] >> bit & 1));
		frame->mask_before[w] = dissection->face_mask[w];
		frame->mask_changed[frame->mask_changed_count++] = w;
	}
}

static void expose_edge(cau_frame_state *frame, const cau_dissection *dissection, int32_t edge)
{
	float value = (float)cau_dissection_heated(dissection, edge);
	CAU_ASSERT(value >= 0 && value <= 1, "edge %d is heated by %g", edge, (double)value);
	for (int i = 0; i < 2; i++) {
		int32_t v = dissection->tissue->edges.vertex[2 * (size_t)edge + (size_t)i];
		frame->exposure[v] = value > frame->exposure[v] ? value : frame->exposure[v];
	}
}

// Counts a parted edge at both ends. An edge counts once, even if it has parted in several layers.
static void char_edge(cau_frame_state *frame, const cau_dissection *dissection, int32_t edge)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	if (!dissection->parted[edge] || frame->edge_burnt[edge])
		return;
	frame->edge_burnt[edge] = 1;
	for (int i = 0; i < 2; i++) {
		int32_t v = dissection->tissue->edges.vertex[2 * (size_t)edge + (size_t)i];
		frame->charring[v] = (float)++frame->burnt_edges[v] / (float)frame->vertex_edges[v];
		CAU_ASSERT(frame->burnt_edges[v] <= frame->vertex_edges[v],
		           "vertex %d: %d edges burnt of %d", v, frame->burnt_edges[v],
		           frame->vertex_edges[v]);
	}
}

void cau_frame_update(cau_frame_state *frame, const cau_dissection *dissection, const double *from,
                      const double *to)
{
	frame->moved_count = 0;
	for (int32_t v = 0; v < dissection->tissue->vertex_count; v++)
		if (from[3 * v] != to[3 * v] || from[3 * v + 1] != to[3 * v + 1] ||
		    from[3 * v + 2] != to[3 * v + 2])
			frame->moved[frame->moved_count++] = v;
	for (int32_t k = 0; k < dissection->touched_count; k++) { // no other edge parts in this tick
		expose_edge(frame, dissection, dissection->touched[k]);
		char_edge(frame, dissection, dissection->touched[k]);
	}
	update_mask(frame, dissection);
}

void cau_frame_stand_still(cau_frame_state *frame)
{
	CAU_ASSERT(frame->moved_count >= 0 && frame->mask_changed_count >= 0,
	           "%d vertices and %d words changed", frame->moved_count, frame->mask_changed_count);
	frame->moved_count = frame->mask_changed_count = 0;
}

void cau_frame_rebuild(cau_frame_state *frame, const cau_dissection *dissection)
{
	const cau_tissue *tissue = dissection->tissue;
	size_t n = (size_t)tissue->vertex_count;
	memset(frame->vertex_faces, 0, n * sizeof *frame->vertex_faces);
	memset(frame->exposure, 0, n * sizeof *frame->exposure);
	memset(frame->edge_burnt, 0, (size_t)tissue->edges.edge_count);
	memset(frame->burnt_edges, 0, n * sizeof *frame->burnt_edges);
	memset(frame->charring, 0, n * sizeof *frame->charring);
	for (int32_t f = 0; f < tissue->faces.face_count; f++)
		if (!(dissection->face_mask[f >> 5] >> (f & 31) & 1))
			for (int i = 0; i < 3; i++)
				frame->vertex_faces[tissue->faces.vertex[3 * (size_t)f + (size_t)i]]++;
	frame->moved_count = tissue->vertex_count;
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		frame->moved[v] = v;
		frame->vertex_visible[v] = frame->vertex_faces[v] > 0;
	}
	for (int32_t e = 0; e < tissue->edges.edge_count; e++) {
		if (dissection->exposure[e] > 0)
			expose_edge(frame, dissection, e);
		char_edge(frame, dissection, e);
	}
	frame->mask_changed_count = word_count(tissue);
	for (int32_t w = 0; w < word_count(tissue); w++) {
		frame->mask_changed[w] = w;
		frame->mask_before[w] = dissection->face_mask[w];
	}
}
