// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/indent.h"

#include <stdio.h>

#include "core/session/pressing.h"
#include "session/session_internal.h"

const double indent_young_modulus_pa = 5000;

enum { MOST_LINES = 400, ITERATIONS = 100 };
// Ratio of a cell outside the even part to its inner neighbour.
static const double growth = 1.35;
static const double accuracy = 1e-4;    // accuracy of each step
static const double damping_per_s = 26; // 1/s; tissue comes to rest within a second
static const double above_m = 2e-4;     // m, height at which the ball waits
static const double speed_m_s = 0.05;
enum { SETTLING_TICKS = 60 };

double indent_dip_m(double radius_m)
{
	return fmin(8e-5, 0.03 * radius_m); // the limits of core: see core/DECISIONS.md
}

double indent_cells(const indent *of)
{
	return 2 * sqrt(of->radius_m * of->depth_m) / of->cell_m;
}

// ---- the mesh

// Sets the grid lines from 0 to `end_m`. Returns their number.
static int32_t lines_of(const indent *of, double even_m, double end_m, double *line)
{
	int32_t even = (int32_t)ceil(fmin(even_m, end_m) / of->cell_m - 1e-9), count = 1;
	double cell = of->cell_m;
	line[0] = 0;
	while (count <= even || line[count - 1] < end_m - 1e-9) {
		assert_true(count < MOST_LINES);
		cell *= count > even ? growth : 1;
		line[count] = line[count - 1] + cell;
		count++;
	}
	double from = line[even],
		   share = line[count - 1] > from ? (end_m - from) / (line[count - 1] - from) : 1;
	for (int32_t i = even + 1; i < count; i++)
		line[i] = from + share * (line[i] - from);
	return count;
}

typedef struct grid {
	double across[2 * MOST_LINES], down[MOST_LINES];
	int32_t wide, deep; // numbers of lines
} grid;

static void make_grid(const indent *of, grid *g)
{
	double line[MOST_LINES];
	int32_t half = lines_of(of, of->even_m, of->half_m, line);
	g->wide = 2 * half - 1;
	for (int32_t i = 0; i < g->wide; i++)
		g->across[i] = i < half ? 0 - line[half - 1 - i] : line[i - half + 1];
	g->deep = lines_of(of, of->even_m, of->thick_m, g->down);
}

static int32_t vertex_of(const grid *g, int32_t i, int32_t j, int32_t k)
{
	return (i * g->wide + j) * g->deep + k;
}

// Adds Kuhn's six tetrahedra of a cell. Each tetrahedron follows the three axes in one of their six
// orders.
static void add_cell(const grid *g, int32_t i, int32_t j, int32_t k, int32_t *tetrahedron)
{
	static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
	                                {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
	for (int o = 0; o < 6; o++) {
		int32_t at[3] = {i, j, k}, *v = tetrahedron + 4 * o;
		v[0] = vertex_of(g, at[0], at[1], at[2]);
		for (int step = 0; step < 3; step++) {
			at[order[o][step]]++;
			v[step + 1] = vertex_of(g, at[0], at[1], at[2]);
		}
		bool turned = o == 0 || o == 3 || o == 4; // because z decreases as k increases
		int32_t last = v[3];
		v[3] = turned ? v[2] : last;
		v[2] = turned ? last : v[2];
	}
}

// Adds the faces of a cell's top, split as its tetrahedra are.
static void add_faces(const grid *g, int32_t i, int32_t j, int32_t *face)
{
	int32_t a = vertex_of(g, i, j, 0), b = vertex_of(g, i + 1, j, 0);
	int32_t c = vertex_of(g, i + 1, j + 1, 0), d = vertex_of(g, i, j + 1, 0);
	memcpy(face, (int32_t[]){a, b, c, a, c, d}, 6 * sizeof *face);
}

static void *room(size_t count, size_t bytes)
{
	void *made = calloc(count, bytes);
	assert_non_null(made);
	return made;
}

static void make_body(indent_stand *stand, const grid *g)
{
	cau_indented_body *body = &stand->body;
	int32_t cells = (g->wide - 1) * (g->wide - 1);
	*body = (cau_indented_body){.vertex_count = g->wide * g->wide * g->deep,
	                            .tetrahedron_count = 6 * cells * (g->deep - 1),
	                            .surface_count = 6 * cells,
	                            .model = CAU_MODEL_NEOHOOKEAN,
	                            .young_modulus_pa = indent_young_modulus_pa,
	                            .poisson_ratio = stand->of.poisson_ratio};
	body->rest = stand->rest = room(3 * (size_t)body->vertex_count, sizeof(double));
	body->fixed = stand->fixed = room((size_t)body->vertex_count, sizeof(bool));
	body->tetrahedron = stand->tetrahedron =
		room(4 * (size_t)body->tetrahedron_count, sizeof(int32_t));
	body->face_count = 2 * cells;
	body->surface = body->face = stand->face = room((size_t)body->surface_count, sizeof(int32_t));
	int32_t *tetrahedron = stand->tetrahedron, *face = stand->face;
	for (int32_t i = 0; i < g->wide; i++)
		for (int32_t j = 0; j < g->wide; j++)
			for (int32_t k = 0; k < g->deep; k++) {
				size_t v = (size_t)vertex_of(g, i, j, k);
				memcpy(stand->rest + 3 * v, (double[]){g->across[i], g->across[j], 0 - g->down[k]},
				       3 * sizeof(double));
				stand->fixed[v] = k == g->deep - 1;
				if (i == g->wide - 1 || j == g->wide - 1)
					continue;
				if (k == 0) {
					add_faces(g, i, j, face);
					face += 6;
				}
				if (k < g->deep - 1) {
					add_cell(g, i, j, k, tetrahedron);
					tetrahedron += 24;
				}
			}
}

static size_t write_mesh(indent_stand *stand)
{
	const cau_indented_body *body = &stand->body;
	stand->text = room(200 + 100 * (size_t)(body->vertex_count + body->tetrahedron_count), 1);
	char *at = stand->text;
	at += sprintf(at, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", body->vertex_count);
	for (int32_t v = 0; v < body->vertex_count; v++) {
		const double *x = body->rest + 3 * (size_t)v;
		at += sprintf(at, "%d %.17g %.17g %.17g\n", v + 1, x[0], x[1], x[2]);
	}
	at += sprintf(at, "$EndNodes\n$Elements\n%d\n", body->tetrahedron_count);
	for (int32_t t = 0; t < body->tetrahedron_count; t++) {
		const int32_t *v = body->tetrahedron + 4 * (size_t)t;
		at += sprintf(at, "%d 4 0 %d %d %d %d\n", t + 1, v[0] + 1, v[1] + 1, v[2] + 1, v[3] + 1);
	}
	at += sprintf(at, "$EndElements\n");
	return (size_t)(at - stand->text);
}

// ---- the session

static void make_scene(indent_stand *stand, size_t bytes)
{
	const indent *of = &stand->of;
	stand->scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_scene_def *scene = stand->scene;
	cau_layer_def *fat = stage_add_slab(scene, "body", (double[]){1, 1, 1}, (int32_t[]){1, 1, 1});
	cau_mesh_def *mesh = stage_mesh_of(scene, fat);
	mesh->source = CAU_MESH_BYTES;
	strcpy(mesh->file, "slab.msh");
	mesh->bytes = stand->text;
	mesh->byte_count = bytes;
	fat->fat[0].model = CAU_MODEL_NEOHOOKEAN;
	fat->fat[0].young_modulus_pa = indent_young_modulus_pa;
	fat->fat[0].poisson_ratio = of->poisson_ratio;
	scene->damping_per_s = damping_per_s;
	scene->iterations = ITERATIONS;
	scene->accuracy = accuracy;
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){1, 1, 1e-9 - of->thick_m});
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0);
	ball->hot_radius_m = of->radius_m;
	ball->tip_length_m = fmax(8e-3, 2 * of->radius_m);
	ball->shaft_radius_m = fmin(of->radius_m, 2.5e-3);
	ball->max_speed_m_s = speed_m_s;
	ball->friction = 0;
	ball->force_max_n = 1000; // the coupling yields by 4 um/N
	ball->pose.position_m[2] = of->radius_m + above_m;
}

indent_stand *indent_open(const indent *of)
{
	indent_stand *stand = room(1, sizeof *stand);
	grid *g = room(1, sizeof *g);
	stand->of = *of;
	make_grid(of, g);
	make_body(stand, g);
	free(g);
	make_scene(stand, write_mesh(stand));
	stand->session = stage_open(stand->scene, 1);
	cau_session_info info = stage_info(stand->session);
	assert_int_equal(info.vertex_count, stand->body.vertex_count);
	assert_memory_equal(info.rest_position, stand->rest,
	                    3 * (size_t)stand->body.vertex_count * sizeof(double));
	return stand;
}

void indent_close(indent_stand *stand)
{
	cau_session_destroy(stand->session);
	free(stand->scene);
	free(stand->text);
	free(stand->rest);
	free(stand->tetrahedron);
	free(stand->face);
	free(stand->fixed);
	free(stand);
}

double indent_press(indent_stand *stand, double x_m, double y_m, double depth_m)
{
	const cau_pose *from = &stage_tool(stand->session, "ball")->pose;
	double to[3] = {x_m, y_m, stand->of.radius_m - depth_m};
	double way = cau_length(cau_sub(cau_vec3_of(to), cau_vec3_of(from->position_m)));
	int32_t ticks = (int32_t)ceil(60 * way / speed_m_s) + SETTLING_TICKS;
	for (int32_t tick = 0; tick < ticks; tick++) {
		stage_move(stand->session, "ball", to[0], to[1], to[2]);
		stage_step(stand->session, 1);
	}
	return stage_tool(stand->session, "ball")->raw_force_n[2];
}

// ---- the reference

cau_indented indent_solve(const indent_stand *stand, bool from_rest)
{
	enum { STAGES = 4 };
	size_t n = 3 * (size_t)stand->body.vertex_count;
	double *position = room(n, sizeof *position);
	const double *end_m = stage_tool(stand->session, "ball")->pose.position_m;
	double way = stand->of.radius_m - end_m[2];
	cau_indenting_ball ball = {.radius_m = stand->of.radius_m,
	                           .dip_m = indent_dip_m(stand->of.radius_m)};
	cau_indented answer = {0};
	memcpy(position, from_rest ? stand->rest : stage_frame(stand->session).position,
	       n * sizeof *position);
	for (int stage = from_rest ? 1 : STAGES; stage <= STAGES; stage++) {
		memcpy(ball.centre_m, end_m, sizeof ball.centre_m);
		ball.centre_m[2] += way * (STAGES - stage) / STAGES;
		if (!cau_indented_solve(&stand->body, &ball, position, &answer))
			fail_msg("no equilibrium: residual %g, %g m inside after %d iterations",
			         answer.residual, answer.deepest_m, answer.iterations);
	}
	free(position);
	return answer;
}

double indent_face_depth_m(const indent_stand *stand)
{
	pressing p = {.radius_m = stand->of.radius_m, .cell_m = stand->of.cell_m};
	cau_vec3 middle = cau_vec3_of(stage_tool(stand->session, "ball")->pose.position_m);
	const double *position = stage_frame(stand->session).position;
	double deepest = 0;
	for (int32_t f = 0; f < stand->body.surface_count / 3; f++) {
		cau_vec3 corner[3];
		for (int k = 0; k < 3; k++)
			corner[k] = cau_vec3_of(position + 3 * (size_t)stand->face[3 * f + k]);
		if (cau_length(cau_sub(corner[0], middle)) < p.radius_m + 3 * p.cell_m)
			deepest = fmax(deepest, pressing_depth_of(middle, p.radius_m, corner));
	}
	return deepest;
}
