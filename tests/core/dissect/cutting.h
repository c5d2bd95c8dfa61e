// SPDX-License-Identifier: GPL-3.0-or-later
// Parts edges without a tool: sets their exposure as a tool would.
#pragma once

#include "core/rig/rig.h"

// Gives an edge this much exposure (degC s) in the present tick.
static inline void expose_by_hand(cau_dissection *dissection, int32_t edge, double exposure)
{
	dissection->exposure[edge] = exposure;
	if (!dissection->touched_mark[edge]) {
		dissection->touched_mark[edge] = 1;
		dissection->touched[dissection->touched_count++] = edge;
	}
}

// One tick: raises the exposure of `count` random edges above every ignition temperature, then
// parts them. Returns the layers that lost an edge, as bits.
static inline uint32_t cut_random_edges(rig *r, uint64_t *random, int count)
{
	uint32_t layers = 0;
	cau_dissection_begin(&r->dissection);
	for (int i = 0; i < count; i++)
		expose_by_hand(&r->dissection,
		               (int32_t)random_between(random, 0, r->tissue.edges.edge_count), 1e6);
	cau_dissection_part(&r->dissection, &layers);
	return layers;
}

// Adds a membrane on fat, fascia above it with bending, and links between the fascia and the fat.
static inline void add_all_layers(rig *r)
{
	rig_add_slab(r, 6, 5, 3);
	cau_layer_def *membrane = &r->scene->layers[r->scene->layer_count];
	rig_add_sheet(r, 1, 1);
	membrane->kind = CAU_LAYER_MEMBRANE;
	memset(membrane->mesh, 0, sizeof membrane->mesh);
	memcpy(membrane->of, r->scene->layers[0].name, sizeof membrane->of);
	memset(&r->scene->meshes[--r->scene->mesh_count], 0, sizeof *r->scene->meshes);
	rig_add_sheet(r, 7, 6)->sheet[0].bending_stiffness_nm = 1e-4;
	r->scene->meshes[1].translate_m[2] = 0.004;
	rig_add_links(r, 2, 1, 0.02);
}
