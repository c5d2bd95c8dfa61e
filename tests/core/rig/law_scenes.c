// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rig/law_scenes.h"

#include <string.h>

// ---- sheets: textures turned against the mesh, so that no axis is special
static cau_sheet_material *add_turned_sheet(rig *r)
{
	cau_layer_def *layer = rig_add_sheet(r, 4, 3);
	r->scene->meshes[r->scene->mesh_count - 1].texture_turn_rad = 0.4;
	return &layer->sheet[0];
}

static void add_sheet_none(rig *r)
{
	add_turned_sheet(r)->limit = CAU_LIMIT_NONE;
}

static void add_sheet_target(rig *r)
{
	memcpy(add_turned_sheet(r)->target, (double[]){0.5, 0.9, 0.2}, 3 * sizeof(double));
}

static void add_sheet_linearised(rig *r)
{
	cau_sheet_material *material = add_turned_sheet(r);
	memcpy(material->target, (double[]){0.5, 0.9, 0.2}, 3 * sizeof(double));
	material->projection = CAU_PROJECTION_LINEARISED;
}

static void add_sheet_range(rig *r)
{
	cau_sheet_material *material = add_turned_sheet(r);
	material->limit = CAU_LIMIT_RANGE;
	memcpy(material->strain_min, (double[]){-0.05, -0.02}, sizeof material->strain_min);
	memcpy(material->strain_max, (double[]){0.03, 0.06}, sizeof material->strain_max);
	material->shear_max = 0.04;
}

// ---- fat
static cau_fat_material *add_fat(rig *r, int model)
{
	cau_layer_def *layer = rig_add_slab(r, 3, 2, 2);
	memcpy(layer->fibre, (double[]){0.6, 0.7, 0.3}, sizeof layer->fibre);
	layer->fat[0].model = model;
	return &layer->fat[0];
}

static void add_neohookean(rig *r)
{
	add_fat(r, CAU_MODEL_NEOHOOKEAN);
}

static void add_corotated(rig *r)
{
	add_fat(r, CAU_MODEL_COROTATED);
}

static void add_stvk(rig *r)
{
	add_fat(r, CAU_MODEL_STVK);
}

static void add_energy(rig *r)
{
	add_fat(r, CAU_MODEL_ENERGY)->poisson_ratio = 0.3;
}

static cau_fat_material *add_limited(rig *r)
{
	cau_fat_material *material = add_fat(r, CAU_MODEL_STVK);
	material->limit = CAU_LIMIT_TARGET;
	material->limit_stiffness_pa = 9000;
	memcpy(material->target, (double[]){0.5, 0.9, 1.1, 0.1, -0.05, 0.08}, sizeof material->target);
	return material;
}

static void add_fat_target(rig *r)
{
	add_limited(r);
}

static void add_fat_linearised(rig *r)
{
	add_limited(r)->projection = CAU_PROJECTION_LINEARISED;
}

static void add_fat_range(rig *r)
{
	cau_fat_material *material = add_limited(r);
	material->limit = CAU_LIMIT_RANGE;
	material->shear_max = 0.04;
	for (int i = 0; i < 3; i++) {
		material->strain_min[i] = -0.02 - 0.01 * i;
		material->strain_max[i] = 0.03 + 0.01 * i;
	}
}

static void add_plastic(rig *r)
{
	cau_fat_material *material = add_fat(r, CAU_MODEL_NEOHOOKEAN);
	material->yield_strain = 0.02;
	material->plastic_strain_max = 0.16;
}

// ---- links and hinges
static void add_links(rig *r)
{
	rig_add_slab(r, 3, 2, 1);
	rig_add_sheet(r, 3, 2);
	r->scene->meshes[1].translate_m[2] = 0.004;
	rig_add_links(r, 1, 0, 0.04)->link.young_modulus_pa = 2e5;
}

cau_layer_def *law_add_roof(rig *r)
{
	static const double points[6][3] = {{0, 0, 0},
	                                    {0.03, 0.004, 0.011},
	                                    {0.002, 0.028, 0.012},
	                                    {0.031, 0.033, -0.003},
	                                    {-0.02, 0.015, -0.009},
	                                    {0.055, 0.01, -0.006}};
	static const int32_t triangles[4][3] = {{0, 1, 2}, {1, 3, 2}, {0, 2, 4}, {1, 5, 3}};
	cau_layer_def *layer = rig_add_triangles(r, 6, points[0], 4, triangles[0]);
	layer->sheet[0].bending_stiffness_nm = 0.02;
	return layer;
}

static void add_hinges(rig *r)
{
	law_add_roof(r);
}

const law_scene law_scenes[LAW_SCENES] = {
	{"sheet without limit", add_sheet_none, 1},
	{"sheet target", add_sheet_target, 1},
	{"sheet linearised", add_sheet_linearised, 0},
	{"sheet range", add_sheet_range, 1},
	{"neohookean", add_neohookean, 1},
	{"corotated", add_corotated, 1},
	{"stvk", add_stvk, 1},
	{"energy", add_energy, 0},
	{"fat target", add_fat_target, 1},
	{"fat linearised", add_fat_linearised, 0},
	{"fat range", add_fat_range, 1},
	{"plastic", add_plastic, 1},
	{"links", add_links, 1},
	{"hinges", add_hinges, 1},
};
