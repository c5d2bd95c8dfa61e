// SPDX-License-Identifier: GPL-3.0-or-later
// Prints CSV for the validation page about tools that touch tissue:
//
//     paper_contact_probe press RADIUS_MM CELL_MM POISSON HALF_MM PLACES SOLVED DEPTH_MM...
//                         A ball is pressed into a slab. There is a line for each depth and place.
//                         PLACES are along one cell, the first off the mesh's lines. A line has the
//                         range of the force in half a second of rest, and the depth inside. With
//                         SOLVED 1 it also has the force of the same mesh's exact solution.
//     paper_contact_probe cost RADIUS_MM DEPTH_MM SPEED_MM_S TICKS
//                         The time of a step of `fat` with a ball that moves through it, and with a
//                         ball above it. The two alternate every 20 ticks.
#include <stdio.h>
#include <time.h>

#include "core/session/indent.h"

// ---- press
static const double thick_m = 16e-3;
// Half width of the area with equal cells, as a multiple of the radius of the largest contact
// patch.
static const double even = 1.6;

static double vertex_depth_m(const indent_stand *stand)
{
	const double *position = stage_frame(stand->session).position;
	cau_vec3 middle = cau_vec3_of(stage_tool(stand->session, "ball")->pose.position_m);
	double nearest = stand->of.radius_m;
	for (int32_t i = 0; i < stand->body.surface_count; i++) {
		cau_vec3 corner = cau_vec3_of(position + 3 * (size_t)stand->face[i]);
		nearest = fmin(nearest, cau_length(cau_sub(corner, middle)));
	}
	return stand->of.radius_m - nearest;
}

// Quantities that are measured while a ball does not move.
typedef struct watched {
	double least_n, most_n, vertex_depth_m, face_depth_m;
} watched;

static watched watch(indent_stand *stand)
{
	enum { TICKS = 30 };
	watched seen = {.least_n = INFINITY, .most_n = -INFINITY};
	for (int tick = 0; tick < TICKS; tick++) {
		stage_step(stand->session, 1);
		double force_n = stage_tool(stand->session, "ball")->raw_force_n[2];
		seen.least_n = fmin(seen.least_n, force_n);
		seen.most_n = fmax(seen.most_n, force_n);
		seen.vertex_depth_m = fmax(seen.vertex_depth_m, vertex_depth_m(stand));
		seen.face_depth_m = fmax(seen.face_depth_m, indent_face_depth_m(stand));
	}
	return seen;
}

static void print_press(indent_stand *stand, double share, bool solved)
{
	const indent *of = &stand->of;
	double x = (0.27 + share) * of->cell_m, y = (0.31 + 0.6 * share) * of->cell_m;
	indent_press(stand, x, y, of->depth_m);
	watched seen = watch(stand);
	const cau_tool_state *ball = stage_tool(stand->session, "ball");
	// the actual depth is a little smaller than the commanded one
	double depth_m = of->radius_m - ball->pose.position_m[2];
	double hertz_n = cau_indented_by_hertz(indent_young_modulus_pa, of->poisson_ratio, of->radius_m,
	                                       depth_m, of->thick_m);
	printf("%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%d\n", depth_m, share,
	       indent_cells(of), ball->raw_force_n[2], seen.least_n, seen.most_n,
	       solved ? indent_solve(stand, false).force_n[2] : NAN, hertz_n, seen.vertex_depth_m,
	       seen.face_depth_m, (int)stage_frame(stand->session).statistics.contacts_left_out);
}

// Runs `press`. `text` is RADIUS_MM and the arguments after it.
static void press(int count, char **text)
{
	double radius_m = 1e-3 * strtod(text[0], NULL), cell_m = 1e-3 * strtod(text[1], NULL);
	double deepest_m = 1e-3 * strtod(text[count - 1], NULL);
	indent of = {.radius_m = radius_m,
	             .depth_m = deepest_m,
	             .cell_m = cell_m,
	             .even_m = even * sqrt(radius_m * deepest_m),
	             .thick_m = thick_m,
	             .half_m = 1e-3 * strtod(text[3], NULL),
	             .poisson_ratio = strtod(text[2], NULL)};
	int places = atoi(text[4]);
	indent_stand *stand = indent_open(&of);
	printf(
		"depth_m,share,cells,force_n,least_n,most_n,solved_n,hertz_n,vertex_depth_m,face_depth_m,"
		"left_out\n");
	for (int k = 6; k < count; k++) {
		stand->of.depth_m = 1e-3 * strtod(text[k], NULL);
		for (int place = 0; place < places; place++)
			print_press(stand, (double)place / places, atoi(text[5]) > 0);
	}
	indent_close(stand);
}

// ---- cost
static const double run_m = 0.03;     // half the length of the motion to and fro, m
static const double aside_m = 0.6e-3; // distance of the ball's path from the mesh's lines, m
static const double away_m = 0.05;    // height of the ball that does not touch the tissue, m
static const double tick_s = 1.0 / 60;
enum { WARM_UP_TICKS = 60, STRETCH_TICKS = 20, STEP_ITERATIONS = 10 };

static double processor_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static cau_session *open_fat(double radius_m)
{
	cau_scene_def *scene = stage_scene_named("fat");
	scene->iterations = STEP_ITERATIONS;
	scene->accuracy = 0; // each step has exactly STEP_ITERATIONS iterations
	cau_tool_def *ball = &scene->tools[0];
	ball->hot_radius_m = radius_m;
	ball->tip_length_m = fmax(ball->tip_length_m, 2 * radius_m);
	ball->shaft_radius_m = fmin(radius_m, ball->shaft_radius_m);
	ball->max_speed_m_s = 2;
	ball->pose.position_m[0] = 0;
	cau_session *session = stage_open(scene, 1);
	free(scene);
	return session;
}

// Returns the position of a motion to and fro that starts in the middle.
static double along_m(int tick, double speed_m_s)
{
	double way = fmod(tick * tick_s * speed_m_s + run_m, 4 * run_m);
	return way < 2 * run_m ? way - run_m : 3 * run_m - way;
}

// Returns the processor time (s) of STRETCH_TICKS steps.
static double stretch_s(cau_session *session, int tick, double speed_m_s, double z_m, int *points)
{
	double sum_s = 0;
	for (int k = tick; k < tick + STRETCH_TICKS; k++) {
		stage_move(session, "ball", along_m(k, speed_m_s), aside_m, z_m);
		double start = processor_s();
		stage_step(session, 1);
		sum_s += processor_s() - start;
		*points += stage_tool(session, "ball")->contact_vertices;
	}
	return sum_s;
}

// Alternates stretches of both sessions. Within a stretch a session finds its data in the caches,
// like a session that is alone on its thread. Other load on the machine affects both sessions
// alike.
static void cost(double radius_m, double depth_m, double speed_m_s, int ticks)
{
	cau_session *in = open_fat(radius_m), *away = open_fat(radius_m);
	double in_s = 0, away_s = 0;
	int points = 0, none = 0, end = WARM_UP_TICKS + ticks / STRETCH_TICKS * STRETCH_TICKS;
	for (int tick = 0; tick < end; tick += STRETCH_TICKS) {
		if (tick == WARM_UP_TICKS)
			in_s = away_s = points = 0;
		in_s += stretch_s(in, tick, speed_m_s, radius_m - depth_m, &points);
		away_s += stretch_s(away, tick, speed_m_s, away_m, &none);
	}
	assert_int_equal(none, 0); // the ball above must not touch the tissue
	int measured = end - WARM_UP_TICKS;
	printf("in_ms,away_ms,points\n%.9g,%.9g,%.9g\n", 1e3 * in_s / measured, 1e3 * away_s / measured,
	       (double)points / measured);
	cau_session_destroy(in);
	cau_session_destroy(away);
}

int main(int argc, char **argv)
{
	if (argc >= 9 && !strcmp(argv[1], "press"))
		press(argc - 2, argv + 2);
	else if (argc == 6 && !strcmp(argv[1], "cost"))
		cost(1e-3 * strtod(argv[2], NULL), 1e-3 * strtod(argv[3], NULL),
		     1e-3 * strtod(argv[4], NULL), atoi(argv[5]));
	else {
		fprintf(stderr,
		        "usage: paper_contact_probe press RADIUS_MM CELL_MM POISSON HALF_MM PLACES SOLVED "
		        "DEPTH_MM... | cost RADIUS_MM DEPTH_MM SPEED_MM_S TICKS\n");
		return 2;
	}
	return 0;
}
