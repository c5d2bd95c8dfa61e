// SPDX-License-Identifier: GPL-3.0-or-later
// Motion in time. First: the share of its amplitude that an oscillation keeps in a period, by
// integrator and viscosity. Second: ticks with two substeps conserve momentum and bits as other
// ticks do, and tissue does not rebound from tools.
#include <stdio.h>

#include "core/session/stage.h"
#include "session/session_internal.h"

enum { TURNS = 9 }; // turning points of four periods

// ---- a cantilever that oscillates at 5 Hz

static const double beam_m[3] = {0.06, 0.02, 0.01};
static const int32_t beam_cells[3] = {12, 4, 2};
static const double beam_hz = 5.01;
static const double swing_m = 5e-4; // m; 1/120 of the beam's length, so the motion is linear

static cau_scene_def *beam(int integrator, double rate_hz)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_layer_def *layer = stage_add_slab(scene, "beam", beam_m, beam_cells);
	layer->fat[0].young_modulus_pa = 60e3;
	layer->fat[0].poisson_ratio = 0.3;
	scene->integrator = integrator;
	scene->step_s = 1 / rate_hz;
	scene->tolerance = 1e-7; // steps are converged
	scene->iterations = 400;
	stage_pin_box(scene, (double[3]){-1, -1, -1}, (double[3]){-0.0299, 1, 1});
	return scene;
}

// Returns the displacements (m, n x 3) of the slowest mode. After half a second implicit Euler has
// damped the other modes almost completely.
static double *slowest_mode(void)
{
	cau_scene_def *scene = beam(CAU_INTEGRATOR_EULER, 60);
	cau_session *session = stage_open(scene, 1);
	int32_t n = 3 * session->tissue.vertex_count;
	double *shape = malloc((size_t)n * sizeof *shape), most = 0;
	assert_non_null(shape);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double along = session->tissue.rest[3 * v] / beam_m[0] + 0.5;
		if (!session->vertices.fixed[v])
			session->vertices.velocity[3 * v + 2] = 0.5 * along * along;
	}
	stage_step(session, 30);
	for (int32_t i = 0; i < n; i++) {
		shape[i] = session->vertices.position[i] - session->tissue.rest[i];
		most = fmax(most, fabs(shape[i]));
	}
	for (int32_t i = 0; i < n; i++)
		shape[i] *= swing_m / most;
	cau_session_destroy(session);
	free(scene);
	return shape;
}

// Returns the amplitude of `shape` in the displacements: their projection on it, weighted by mass.
static double amount_of(const cau_session *session, const double *shape)
{
	double sum = 0, of = 0;
	for (int32_t i = 0; i < 3 * session->tissue.vertex_count; i++) {
		double m = session->tissue.mass[i / 3] * shape[i];
		sum += m * (session->vertices.position[i] - session->tissue.rest[i]);
		of += m * shape[i];
	}
	return sum / of;
}

typedef struct swing {
	double hz, kept; // share of the amplitude that is kept in a period
} swing;

// Releases the beam in the shape, and finds the turning points with parabolas through three ticks.
static swing watch(const cau_scene_def *scene, const double *shape)
{
	cau_session *session = stage_open(scene, 1);
	double before2 = 1, before = 1, first = 0, last = 0, first_s = 0, last_s = 0;
	int found = 0;
	for (int32_t i = 0; i < 3 * session->tissue.vertex_count; i++)
		session->vertices.position[i] += shape[i];
	for (int tick = 1; tick * scene->step_s < 2 && found < TURNS; tick++) {
		stage_step(session, 1);
		double now = amount_of(session, shape);
		if (tick > 2 && (before - before2) * (now - before) <= 0) {
			double a = (now + before2) / 2 - before, b = (now - before2) / 2;
			double at = -b / (2 * a);
			last = fabs(before + b * at + a * at * at);
			last_s = (tick - 1 + at) * scene->step_s;
			if (!found++) {
				first = last;
				first_s = last_s;
			}
		}
		before2 = before;
		before = now;
	}
	assert_int_equal(found, TURNS);
	double periods = (TURNS - 1) / 2.0;
	swing out = {periods / (last_s - first_s), pow(last / first, 1 / periods)};
	print_message("integrator %d, %.0f steps/s, accuracy %g: %.3f Hz, keeps %.4f a period\n",
	              scene->integrator, 1 / scene->step_s, scene->tolerance > 0 ? 0 : scene->accuracy,
	              out.hz, out.kept);
	cau_session_destroy(session);
	return out;
}

// Returns |R(i w dt)| of Alexander's method to the power of the ticks in a period.
static double kept_by_theory(double hz, double step_s)
{
	double gamma = CAU_SDIRK2_GAMMA, y = 2 * acos(-1.0) * hz * step_s;
	double above = 1 + (1 - 2 * gamma) * (1 - 2 * gamma) * y * y, below = 1 + gamma * gamma * y * y;
	return pow(sqrt(above) / below, 1 / (hz * step_s));
}

// The integrator must keep at least 0.95 in a period. Theory gives 0.9968 at 60 steps/s. The
// quadratic law and the parabola at the turning points cause a difference of up to 0.002.
static void an_undamped_swing_is_kept(void **state)
{
	double *shape = *state;
	for (int rate_hz = 60; rate_hz <= 240; rate_hz *= 4) {
		cau_scene_def *scene = beam(CAU_INTEGRATOR_SDIRK2, rate_hz);
		swing is = watch(scene, shape);
		assert_true(is.kept >= 0.95);
		assert_true(fabs(is.kept - kept_by_theory(beam_hz, scene->step_s)) <= 0.002);
		assert_true(fabs(is.hz / beam_hz - 1) <= 0.02);
		free(scene);
	}
}

// Steps that end at the default accuracy of 1 %, in single precision. With only ten iterations in a
// substep the steps do not reach 1 % here, and the beam keeps 0.954.
static void it_is_kept_at_the_default_accuracy(void **state)
{
	cau_scene_def *scene = beam(CAU_INTEGRATOR_SDIRK2, 60);
	scene->precision = CAU_PRECISION_SINGLE;
	scene->tolerance = 0;
	scene->accuracy = 0.01;
	scene->iterations = 20;
	assert_true(watch(scene, *state).kept >= 0.95);
	free(scene);
}

static void implicit_euler_is_as_it_was(void **state)
{
	cau_scene_def *scene = beam(CAU_INTEGRATOR_EULER, 60);
	double y = 2 * acos(-1.0) * beam_hz / 60;
	assert_true(fabs(watch(scene, *state).kept - pow(1 + y * y, -0.5 * 60 / beam_hz)) <= 0.05);
	free(scene);
}

// ---- viscosity

// Share of critical damping at 5 Hz; 0.73 of the amplitude is left after a period.
static const double damping_ratio = 0.05;

static double kept_by_kelvin_and_voigt(double hz, double viscosity_s)
{
	// The damping ratio is half of viscosity times angular frequency.
	double pi = acos(-1.0), ratio = pi * hz * viscosity_s;
	return exp(-2 * pi * ratio / sqrt(1 - ratio * ratio));
}

// The amplitude that a viscous oscillation keeps at 60 and at 240 steps/s differs by less than 5 %,
// and agrees with the closed form. The bounds were set before the first run: 2 % of the closed form
// at 60 steps/s, where the integrator itself takes 0.4 %, and 1 % at 240.
static void check_viscous_swing(cau_scene_def *scene, const double *shape, double hz)
{
	double kept[2], viscosity_s = scene->layers[0].viscosity_s = damping_ratio / (acos(-1.0) * hz);
	for (int i = 0; i < 2; i++) {
		scene->step_s = i ? 1.0 / 240 : 1.0 / 60;
		kept[i] = watch(scene, shape).kept;
		double wanted = kept_by_kelvin_and_voigt(hz, viscosity_s);
		print_message("closed form: %.4f\n", wanted);
		assert_true(fabs(kept[i] / wanted - 1) <= (i ? 0.01 : 0.02));
	}
	assert_true(fabs(kept[0] / kept[1] - 1) < 0.05);
}

static void damping_is_the_tissues(void **state)
{
	const int models[] = {CAU_MODEL_NEOHOOKEAN, CAU_MODEL_COROTATED, CAU_MODEL_STVK};
	for (size_t k = 0; k < sizeof models / sizeof *models; k++) {
		cau_scene_def *scene = beam(CAU_INTEGRATOR_SDIRK2, 60);
		scene->layers[0].fat[0].model = models[k];
		check_viscous_swing(scene, *state, beam_hz);
		free(scene);
	}
}

// A strip of a sheet that oscillates along its length: w = pi/2 sqrt(k/density) / length.
static void a_sheets_damping_is_its_own_too(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_layer_def *strip = stage_add_sheet(scene, "strip", 0.06, 0.005, 24, 2);
	strip->sheet[0].limit_stiffness_pa = 1600;
	strip->sheet[0].density_kg_m3 = 1100;
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	scene->tolerance = 1e-7;
	scene->iterations = 400;
	stage_pin_box(scene, (double[3]){-1, -1, -1}, (double[3]){-0.0299, 1, 1});
	cau_session *session = stage_open(scene, 1);
	int32_t n = session->tissue.vertex_count;
	double *shape = calloc(3 * (size_t)n, sizeof *shape);
	assert_non_null(shape);
	for (int32_t v = 0; v < n; v++)
		shape[3 * v] = swing_m * sin(acos(-1.0) / 2 * (session->tissue.rest[3 * v] / 0.06 + 0.5));
	cau_session_destroy(session);
	check_viscous_swing(scene, shape, sqrt(1600.0 / 1100) / (4 * 0.06));
	free(shape);
	free(scene);
}

// With implicit Euler, viscosity acts in addition to the integrator's own damping.
static void viscosity_damps_with_implicit_euler(void **state)
{
	cau_scene_def *scene = beam(CAU_INTEGRATOR_EULER, 240);
	double alone = watch(scene, *state).kept;
	scene->layers[0].viscosity_s = damping_ratio / (acos(-1.0) * beam_hz);
	double wanted = alone * kept_by_kelvin_and_voigt(beam_hz, scene->layers[0].viscosity_s);
	assert_true(fabs(watch(scene, *state).kept / wanted - 1) <= 0.05);
	free(scene);
}

static void viscosity_has_its_range(void **state)
{
	(void)state;
	cau_error error;
	cau_scene_def *scene = stage_layered();
	int32_t links = 0;
	while (scene->layers[links].kind != CAU_LAYER_LINKS)
		links++;
	scene->layers[links].viscosity_s = 0.01;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	scene->layers[links].viscosity_s = 0;
	scene->layers[0].viscosity_s = -0.01;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	scene->layers[0].viscosity_s = 0.01;
	scene->solver = CAU_SOLVER_DIAGONAL;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	free(scene);
}

// ---- free bodies

static void a_body_falls_by_half_g_t_squared(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_slab(scene, "body", (double[3]){0.02, 0.02, 0.01}, (int32_t[3]){4, 4, 2});
	cau_default_gravity(scene->gravity_m_s2);
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 60);
	cau_frame frame = stage_frame(session);
	double way = scene->gravity_m_s2[2] / 2;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double fallen = frame.position[3 * v + 2] - session->tissue.rest[3 * v + 2];
		assert_true(fabs(fallen / way - 1) <= 1e-9);
	}
	cau_session_destroy(session);
	free(scene);
}

static cau_vec3 angular_momentum(const cau_session *session)
{
	cau_vec3 sum = {0, 0, 0}, centre = {0, 0, 0};
	double mass = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double m = session->tissue.mass[v];
		centre = cau_add_scaled(centre, m, cau_vec3_of(session->vertices.position + 3 * v));
		mass += m;
	}
	centre = cau_scale(1 / mass, centre);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		cau_vec3 arm = cau_sub(cau_vec3_of(session->vertices.position + 3 * v), centre);
		cau_vec3 moment = cau_cross(arm, cau_vec3_of(session->vertices.velocity + 3 * v));
		sum = cau_add_scaled(sum, session->tissue.mass[v], moment);
	}
	return sum;
}

// Rotates a block at `rad_s` for a second. Returns its energy at the end, relative to that at the
// start.
static double spin(const cau_scene_def *scene, double rad_s)
{
	cau_session *session = stage_open(scene, 1);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		cau_vec3 at = cau_vec3_of(session->tissue.rest + 3 * v);
		cau_vec3_to(cau_cross((cau_vec3){0, 0, rad_s}, at), session->vertices.velocity + 3 * v);
	}
	cau_vec3 before = angular_momentum(session);
	double start_j = stage_balance(session).kinetic_j;
	stage_step(session, (int32_t)lround(1 / scene->step_s));
	cau_vec3 change = cau_sub(angular_momentum(session), before);
	cau_balance end = stage_balance(session);
	double ends = (end.kinetic_j + end.elastic_j) / start_j;
	print_message("angular momentum changed by %.1e, energy is %.4f of the first\n",
	              cau_length(change) / cau_length(before), ends);
	assert_true(cau_length(change) <= 1e-9 * cau_length(before));
	cau_session_destroy(session);
	return ends;
}

// As with implicit Euler (spin_test.c), energy stays within a hundredth.
static void a_block_keeps_its_angular_momentum(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_slab(scene, "cake", (double[3]){0.04, 0.04, 0.02}, (int32_t[3]){6, 6, 3});
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	assert_true(fabs(spin(scene, 10) - 1) <= 0.01);
	// Viscosity must not damp a rotation, because a rotation stretches nothing.
	scene->layers[0].viscosity_s = 0.05;
	assert_true(fabs(spin(scene, 10) - 1) <= 0.01);
	free(scene);
}

// ---- tools

// A block hits a ball at 1 m/s, 16 mm a tick. Its energy may not increase.
static void what_hits_a_tool_gains_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_slab(scene, "block", (double[3]){0.02, 0.02, 0.01}, (int32_t[3]){6, 6, 3});
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0.03);
	ball->hot_radius_m = 0.02;
	cau_session *session = stage_open(scene, 1);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		session->vertices.velocity[3 * v + 2] = 1;
	double start_j = stage_balance(session).kinetic_j, most_j = 0;
	for (int tick = 0; tick < 30; tick++) {
		stage_step(session, 1);
		cau_balance now = stage_balance(session);
		most_j = fmax(most_j, now.kinetic_j + now.elastic_j);
	}
	print_message("it has at most %.3f of its energy after the impact\n", most_j / start_j);
	assert_true(most_j <= start_j);
	cau_session_destroy(session);
	free(scene);
}

static void press(cau_session *session, int tick)
{
	stage_move(session, "hook", 0.0002 * tick, 0, 0.004 - 0.0004 * fmin(tick, 20));
	if (tick == 10)
		stage_energize(session, "hook", 1);
	stage_step(session, 1);
}

// A tool presses, cuts and slides. The bits are the same on any number of threads, and from a
// snapshot of any tick.
static void bits_do_not_depend_on_threads_or_snapshots(void **state)
{
	(void)state;
	enum { TICKS = 40, HALF = 23 };
	cau_scene_def *scene = stage_layered();
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	for (int32_t i = 0; i < scene->layer_count; i++)
		scene->layers[i].viscosity_s = scene->layers[i].kind == CAU_LAYER_LINKS ? 0 : 0.005;
	cau_session *one = stage_open(scene, 1), *three = stage_open(scene, 3);
	cau_session *later = stage_open(scene, 2);
	for (int tick = 0; tick < TICKS; tick++) {
		if (tick == HALF) {
			stage_bytes kept = stage_snapshot(one);
			cau_error error = {0};
			bool exact;
			assert_int_equal(cau_session_restore(later, kept.bytes, kept.count, &exact, &error),
			                 CAU_OK);
			assert_true(exact);
			free(kept.bytes);
		}
		press(one, tick);
		press(three, tick);
		if (tick >= HALF)
			press(later, tick);
	}
	assert_true(cau_session_hash(one) == cau_session_hash(three));
	assert_true(cau_session_hash(one) == cau_session_hash(later));
	cau_session_destroy(one);
	cau_session_destroy(three);
	cau_session_destroy(later);
	free(scene);
}

// ---- cuts

static void a_cut_ends_without_a_fault(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene_named("fascia");
	scene->integrator = CAU_INTEGRATOR_SDIRK2;
	cau_session *session = stage_open(scene, 2);
	cau_pose first = scene->tools[0].pose;
	double gained_j = 0;
	for (int tick = 0; tick < 360; tick++) {
		stage_cut_tick(session, &scene->cut, &first, tick);
		stage_step(session, 1);
		cau_statistics statistics = stage_frame(session).statistics;
		gained_j = fmax(gained_j, statistics.energy_gain_j / statistics.energy_scale_j);
	}
	cau_frame frame = stage_frame(session);
	print_message("%d elements removed, a tick gained %.1e of its energy at most\n",
	              frame.statistics.elements_removed, gained_j);
	assert_true(frame.statistics.elements_removed > 20);
	assert_true(gained_j < 1e-3);
	cau_session_destroy(session);
	free(scene);
}

static int make_shape(void **state)
{
	*state = slowest_mode();
	return 0;
}

static int free_shape(void **state)
{
	free(*state);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_undamped_swing_is_kept),
		cmocka_unit_test(it_is_kept_at_the_default_accuracy),
		cmocka_unit_test(implicit_euler_is_as_it_was),
		cmocka_unit_test(damping_is_the_tissues),
		cmocka_unit_test(a_sheets_damping_is_its_own_too),
		cmocka_unit_test(viscosity_damps_with_implicit_euler),
		cmocka_unit_test(viscosity_has_its_range),
		cmocka_unit_test(a_body_falls_by_half_g_t_squared),
		cmocka_unit_test(a_block_keeps_its_angular_momentum),
		cmocka_unit_test(what_hits_a_tool_gains_nothing),
		cmocka_unit_test(bits_do_not_depend_on_threads_or_snapshots),
		cmocka_unit_test(a_cut_ends_without_a_fault),
	};
	return cmocka_run_group_tests(tests, make_shape, free_shape);
}
