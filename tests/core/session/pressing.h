// SPDX-License-Identifier: GPL-3.0-or-later
// Tools pressed straight down into a taut sheet, a slab that is pinned at its bottom, or `layers`.
// The measurements use rays, independently of the code under test.
#pragma once

#include "core/session/stage.h"
#include "session/session_internal.h"

typedef enum pressing_tissue { PRESSING_SHEET, PRESSING_SLAB, PRESSING_LAYERS } pressing_tissue;

typedef struct pressing {
	pressing_tissue tissue;
	int shape;
	double radius_m, cell_m, speed_m_s, depth_m;
	double force_max_n; // 0: the default
} pressing;

static const double pressing_wide_m = 0.04, pressing_deep_m = 0.016;

static inline void pressing_add_sheet(cau_scene_def *scene, int32_t cells)
{
	const double half = pressing_wide_m / 2 - 1e-6;
	const double sides[4][2][3] = {{{-1, -1, -1}, {-half, 1, 1}},
	                               {{half, -1, -1}, {1, 1, 1}},
	                               {{-1, -1, -1}, {1, -half, 1}},
	                               {{-1, half, -1}, {1, 1, 1}}};
	stage_add_sheet(scene, "fascia", pressing_wide_m, pressing_wide_m, cells, cells);
	for (int i = 0; i < 4; i++)
		stage_pin_box(scene, sides[i][0], sides[i][1]);
}

static inline void pressing_add_slab(cau_scene_def *scene, const pressing *p, int32_t cells)
{
	const double size[3] = {pressing_wide_m, pressing_wide_m, pressing_deep_m};
	const int32_t counts[3] = {cells, cells, (int32_t)(pressing_deep_m / p->cell_m)};
	const double least[3] = {-1, -1, -1.001 * pressing_deep_m};
	const double most[3] = {1, 1, -0.999 * pressing_deep_m};
	stage_add_slab(scene, "fat", size, counts);
	stage_pin_box(scene, least, most);
}

static inline double pressing_top_m(const pressing *p)
{
	const double fascia_m = 0.002; // height of the fascia of `layers` above the fat
	return (p->tissue == PRESSING_LAYERS ? fascia_m : 0) + p->radius_m + 1e-3;
}

// Moves the tool to a depth. It is beside the lines of the mesh, so that no vertex is below it.
static inline void pressing_move(cau_session *session, const pressing *p, double depth_m)
{
	cau_command move = stage_command(CAU_COMMAND_TOOL_MOVE);
	strcpy(move.tool, "tool");
	move.as.move.pose.position_m[0] = 0.27 * p->cell_m;
	move.as.move.pose.position_m[1] = 0.31 * p->cell_m;
	move.as.move.pose.position_m[2] = pressing_top_m(p) - 1e-3 - depth_m;
	move.as.move.jaw = 0;
	stage_submit(session, &move);
}

static inline cau_scene_def *pressing_scene(const pressing *p)
{
	int32_t cells = (int32_t)(pressing_wide_m / p->cell_m + 0.5);
	bool layers = p->tissue == PRESSING_LAYERS;
	cau_scene_def *scene = layers ? stage_scene_light("layers") : stage_scene(CAU_PRECISION_SINGLE);
	scene->tool_count = 0;
	if (p->tissue == PRESSING_SHEET)
		pressing_add_sheet(scene, cells);
	else if (!layers)
		pressing_add_slab(scene, p, cells);
	cau_tool_def *tool = stage_add_tool(scene, "tool", p->shape, 0.27 * p->cell_m, 0.31 * p->cell_m,
	                                    pressing_top_m(p));
	tool->hot_radius_m = p->radius_m;
	tool->tip_length_m = fmax(8e-3, 2 * p->radius_m);
	tool->shaft_radius_m = fmin(p->radius_m, 2.5e-3);
	tool->grid_step_m = fmin(p->radius_m, 2e-3);
	tool->max_speed_m_s = 2;
	if (p->force_max_n > 0)
		tool->force_max_n = p->force_max_n;
	return scene;
}

// Returns the commanded depth, m, after this number of ticks of the press.
static inline double pressing_depth_m(const pressing *p, int tick)
{
	return fmin((tick + 1) * p->speed_m_s / 60, p->depth_m + 1e-3) - 1e-3;
}

static inline cau_vec3 pressing_corner(const cau_session *session, int32_t face, int k)
{
	int32_t v = session->tissue.faces.vertex[3 * (size_t)face + (size_t)k];
	return cau_vec3_of(session->vertices.position + 3 * (size_t)v);
}

// Whether the vertical line up from the tool's tip, which is the path of the tool, meets the face.
static inline bool pressing_is_above(cau_vec3 from, cau_vec3 a, cau_vec3 b, cau_vec3 c)
{
	double ab = (b.x - a.x) * (from.y - a.y) - (b.y - a.y) * (from.x - a.x);
	double bc = (c.x - b.x) * (from.y - b.y) - (c.y - b.y) * (from.x - b.x);
	double ca = (a.x - c.x) * (from.y - c.y) - (a.y - c.y) * (from.x - c.x);
	double area = ab + bc + ca;
	bool within = (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
	return within && (bc * a.z + ca * b.z + ab * c.z) / area > from.z;
}

static inline bool pressing_is_crossed(const cau_session *session)
{
	cau_vec3 tip = cau_vec3_of(stage_tool(session, "tool")->pose.position_m);
	for (int32_t f = 0; f < session->tissue.faces.face_count; f++)
		if (!(session->dissection.face_mask[f >> 5] >> (f & 31) & 1) &&
		    pressing_is_above(tip, pressing_corner(session, f, 0), pressing_corner(session, f, 1),
		                      pressing_corner(session, f, 2)))
			return true;
	return false;
}

// Returns how deep, m, the nearest point of a triangle is inside a ball, by sampling.
static inline double pressing_depth_of(cau_vec3 middle, double radius, const cau_vec3 corner[3])
{
	enum { SAMPLES = 12 };
	double least = 1e300;
	for (int i = 0; i <= SAMPLES; i++)
		for (int j = 0; i + j <= SAMPLES; j++) {
			double u = (double)i / SAMPLES, v = (double)j / SAMPLES;
			cau_vec3 x = cau_add_scaled(cau_scale(1 - u - v, corner[0]), u, corner[1]);
			x = cau_add_scaled(x, v, corner[2]);
			least = fmin(least, cau_length(cau_sub(x, middle)));
		}
	return radius - least;
}

// Returns how deep a ball is inside the drawn surface, m.
static inline double pressing_penetration_m(const cau_session *session, const pressing *p)
{
	cau_vec3 middle = cau_vec3_of(stage_tool(session, "tool")->pose.position_m);
	double deepest = 0;
	for (int32_t f = 0; f < session->tissue.faces.face_count; f++) {
		const cau_vec3 corner[3] = {pressing_corner(session, f, 0), pressing_corner(session, f, 1),
		                            pressing_corner(session, f, 2)};
		if (!(session->dissection.face_mask[f >> 5] >> (f & 31) & 1) &&
		    cau_length(cau_sub(corner[0], middle)) < p->radius_m + 3 * p->cell_m)
			deepest = fmax(deepest, pressing_depth_of(middle, p->radius_m, corner));
	}
	return deepest;
}
