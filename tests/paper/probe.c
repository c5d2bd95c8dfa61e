// SPDX-License-Identifier: GPL-3.0-or-later
// Prints CSV for drawings of the validation page that no other program provides. There is one line
// for each tick or vertex:
//
//     paper_probe heat STEP_MM NODES  temperature around a hot ball of 3 mm, by time and distance
//     paper_probe flight ACCURACY     conserved quantities of a free block that flies and spins
//     paper_probe swing STEPS_PER_S   energies of a block that swings from its end
//
// The scenes are made in this program, so that changes to the shipped scenes do not affect them.
#include <stdio.h>

#include "core/session/stage.h"
#include "session/session_internal.h"

// ---- heat: a strip of vertices through the ball's middle, all held
static const double ball_m = 3e-3, strip_m = 0.02, lattice_m = 2.5e-4;

static void print_temperatures(const cau_session *session, const cau_session_info *info)
{
	cau_frame frame = stage_frame(session);
	for (int32_t v = 0; v < info->vertex_count; v++)
		if (fabs(info->rest_position[3 * v + 1]) < lattice_m / 2)
			printf("%g,%.9g,%.9g\n", frame.time_s, fabs(info->rest_position[3 * v]),
			       (double)frame.temperature[v]);
}

static void heat(double grid_step_m, int32_t grid_cells)
{
	static const int seconds[] = {1, 3, 10};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	int32_t along = (int32_t)(2 * strip_m / lattice_m + 0.5);
	cau_sheet_material *strip =
		stage_add_sheet(scene, "strip", 2 * strip_m, 4 * lattice_m, along, 4)->sheet;
	strip->heat.absorption_per_s = 0; // the strip absorbs no energy, so it stays whole
	// Pins all vertices except those of one end, which cannot move either.
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){strip_m - lattice_m / 2, 1, 1});
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0);
	ball->hot_radius_m = ball_m;
	ball->grid_step_m = grid_step_m;
	ball->grid_cells = grid_cells;
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	cau_session_watch(session, CAU_CHANNEL_TEMPERATURE);
	stage_energize(session, "ball", 1);
	printf("time_s,distance_m,temperature_c\n");
	for (size_t k = 0; k < sizeof seconds / sizeof *seconds; k++) {
		stage_step(session,
		           (int32_t)(seconds[k] / info.step_s + 0.5) - (int32_t)stage_frame(session).tick);
		print_temperatures(session, &info);
	}
	cau_session_destroy(session);
	free(scene);
}

// ---- flight: a free block without weight; prints momentum, angular momentum and energy
static const cau_vec3 thrown_m_s = {0.1, 0.05, -0.02}, spin_rad_s = {8, 4.8, 3.6};

typedef struct motion {
	cau_vec3 momentum, angular;
} motion;

static cau_vec3 middle_of(const cau_session *session)
{
	cau_vec3 sum = {0, 0, 0};
	double mass = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double m = session->tissue.mass[v];
		sum = cau_add_scaled(sum, m, cau_vec3_of(session->vertices.position + 3 * v));
		mass += m;
	}
	return cau_scale(1 / mass, sum);
}

static motion motion_of(const cau_session *session)
{
	motion of = {{0, 0, 0}, {0, 0, 0}};
	cau_vec3 middle = middle_of(session);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double m = session->tissue.mass[v];
		cau_vec3 velocity = cau_vec3_of(session->vertices.velocity + 3 * v);
		cau_vec3 arm = cau_sub(cau_vec3_of(session->vertices.position + 3 * v), middle);
		of.momentum = cau_add_scaled(of.momentum, m, velocity);
		of.angular = cau_add_scaled(of.angular, m, cau_cross(arm, velocity));
	}
	return of;
}

static void throw_it(cau_session *session)
{
	cau_vec3 middle = middle_of(session);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		cau_vec3 arm = cau_sub(cau_vec3_of(session->vertices.position + 3 * v), middle);
		cau_vec3_to(cau_add_scaled(thrown_m_s, 1, cau_cross(spin_rad_s, arm)),
		            session->vertices.velocity + 3 * v);
	}
}

static double lost(cau_vec3 now, cau_vec3 before)
{
	return cau_length(cau_sub(now, before)) / cau_length(before);
}

// Runs `flight`. If `accuracy` is 0, each step has a hundred iterations.
static void flight(double accuracy)
{
	enum { TICKS = 600 };
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_slab(scene, "block", (double[]){0.04, 0.04, 0.02}, (int32_t[]){6, 6, 3});
	scene->accuracy = accuracy;
	scene->iterations = accuracy > 0 ? scene->iterations : 100;
	cau_session *session = stage_open(scene, 1);
	throw_it(session);
	motion before = motion_of(session);
	double start_j = stage_balance(session).kinetic_j;
	printf("time_s,momentum_changed,angular_kept,angular_changed,energy_kept\n");
	for (int tick = 1; tick <= TICKS; tick++) {
		stage_step(session, 1);
		motion now = motion_of(session);
		cau_balance balance = stage_balance(session);
		double kept =
			cau_dot(now.angular, before.angular) / cau_dot(before.angular, before.angular);
		printf("%.9g,%.3e,%.9g,%.3e,%.9g\n", stage_frame(session).time_s,
		       lost(now.momentum, before.momentum), kept, lost(now.angular, before.angular),
		       (balance.kinetic_j + balance.elastic_j) / start_j);
	}
	cau_session_destroy(session);
	free(scene);
}

// ---- swing: released in a level position, held at one end; kinetic, elastic and potential energy

static double raised_j(const cau_session *session, double gravity_m_s2)
{
	double sum = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		sum += session->tissue.mass[v] * gravity_m_s2 *
		       (session->vertices.position[3 * v + 2] - session->tissue.rest[3 * v + 2]);
	return sum;
}

static void swing(int steps_per_s)
{
	enum { SECONDS = 3 };
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_layer_def *block =
		stage_add_slab(scene, "block", (double[]){0.08, 0.02, 0.02}, (int32_t[]){16, 4, 4});
	// with this modulus the block sinks by a third of its length
	block->fat->young_modulus_pa = 2e4;
	block->fat->poisson_ratio = 0.3;
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){-0.0399, 1, 1});
	cau_default_gravity(scene->gravity_m_s2);
	scene->step_s = 1.0 / steps_per_s;
	scene->accuracy = 0;
	scene->iterations = 300;
	scene->tolerance = 1e-8;
	cau_session *session = stage_open(scene, 1);
	double gained_j = 0;
	printf("time_s,kinetic_j,elastic_j,raised_j,gained_j\n");
	for (int tick = 0; tick < SECONDS * steps_per_s; tick++) {
		stage_step(session, 1);
		gained_j += fmax(stage_frame(session).statistics.energy_gain_j, 0);
		cau_balance balance = stage_balance(session);
		printf("%.9g,%.9g,%.9g,%.9g,%.3e\n", stage_frame(session).time_s, balance.kinetic_j,
		       balance.elastic_j, raised_j(session, -scene->gravity_m_s2[2]), gained_j);
	}
	cau_session_destroy(session);
	free(scene);
}

int main(int argc, char **argv)
{
	double number = argc > 2 ? strtod(argv[2], NULL) : -1;
	if (argc == 4 && !strcmp(argv[1], "heat") && number > 0)
		heat(1e-3 * number, atoi(argv[3]));
	else if (argc == 3 && !strcmp(argv[1], "flight") && number >= 0)
		flight(number);
	else if (argc == 3 && !strcmp(argv[1], "swing") && number >= 1)
		swing((int)number);
	else {
		fprintf(stderr,
		        "usage: paper_probe heat STEP_MM NODES | flight ACCURACY | swing STEPS_PER_S\n");
		return 2;
	}
	return 0;
}
