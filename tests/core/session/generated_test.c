// SPDX-License-Identifier: GPL-3.0-or-later
// Random scenes: slabs, sheets, strands and stacks of all laws, pinned somewhere, that fall, or are
// pressed, grasped and released, or cut through. Sampled steps are computed again from the same
// state with up to 400 iterations, in the same precision. The assertions hold for all of these
// scenes. Too many scenes have errors above 1 %, or gain energy (.github/KNOWN_BUGS.md); these are
// counted and printed. The environment variables CAUTERY_SCENES (number) and CAUTERY_SCENES_SEED
// choose other scenes.
#include "core/session/stage.h"

#include <stdio.h>

#include "core/rig/step_error.h"
#include "session/session_internal.h"

enum { SCENES = CAU_TEST_SANITIZED ? 2 : 16, FIRST_SEED = 1000 };
enum { TICKS = 150, SAMPLE_EVERY = 10, SAMPLES = TICKS / SAMPLE_EVERY, CONVERGED = 400 };
static const double converged_residual = 1e-8, wanted = 0.01;
// Largest sum of the gains of a scene's steps, as a share of the largest energy_scale_j of a step.
// Above this sum the scene is counted as one that gains energy.
static const double gain_most = 0.01;
static const double steps_right = 0.95; // share of a scene's steps that must be right
// Largest share of steps with a true error above three times the reported error. One more such step
// is counted as chance.
static const double flattered_most = 0.01;

// ---- random numbers
static uint64_t drawn(uint64_t *seed)
{
	*seed += 0x9e3779b97f4a7c15u; // splitmix64
	uint64_t z = *seed;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static double between(uint64_t *seed, double least, double most)
{
	return least + (most - least) * (double)(drawn(seed) >> 11) * 0x1p-53;
}

static double of_magnitude(uint64_t *seed, double least, double most)
{
	return exp(between(seed, log(least), log(most)));
}

static int one_of(uint64_t *seed, int count)
{
	return (int)(drawn(seed) % (uint64_t)count);
}

// ---- a scene
typedef enum deed { FALL, PRESS, GRASP, CUT, DEEDS } deed;
static const char *const deed_names[DEEDS] = {"falls", "pressed", "grasped", "cut"};

typedef struct generated {
	cau_scene_def *scene;
	deed what;
	double size_m[3], depth_m, speed_m_s, sideways_m;
	char text[256];
	int text_bytes;
} generated;

#define SAY(of, ...)                                                                               \
	((of)->text_bytes += snprintf((of)->text + (of)->text_bytes,                                   \
	                              sizeof(of)->text - (size_t)(of)->text_bytes, __VA_ARGS__))

static void draw_sheet(uint64_t *seed, generated *of, cau_sheet_material *sheet)
{
	sheet->thickness_m = of_magnitude(seed, 1e-4, 1e-3);
	sheet->limit_stiffness_pa = of_magnitude(seed, 1e4, 5e6);
	sheet->limit = one_of(seed, 3) ? CAU_LIMIT_TARGET : CAU_LIMIT_RANGE;
	for (int c = 0; c < 2; c++) {
		sheet->target[c] = one_of(seed, 2) ? 1 : between(seed, 0.3, 1);
		sheet->strain_min[c] = -between(seed, 0.05, 0.4);
		sheet->strain_max[c] = between(seed, 0.02, 0.4);
	}
	if (one_of(seed, 3) == 0)
		sheet->bending_stiffness_nm = of_magnitude(seed, 1e-8, 1e-5);
	SAY(of, " sheet %.2f mm %.2g Pa %s", 1e3 * sheet->thickness_m, sheet->limit_stiffness_pa,
	    sheet->limit == CAU_LIMIT_RANGE ? "range" : "target");
}

static void draw_fat(uint64_t *seed, generated *of, cau_fat_material *fat)
{
	static const int models[] = {CAU_MODEL_NEOHOOKEAN, CAU_MODEL_COROTATED, CAU_MODEL_STVK};
	static const char *const names[] = {"neohookean", "corotated", "stvk"};
	int model = one_of(seed, 3);
	fat->model = models[model];
	fat->young_modulus_pa = of_magnitude(seed, 2e3, 1e5);
	fat->poisson_ratio = between(seed, 0.2, 0.45);
	if (one_of(seed, 3) == 0) {
		fat->yield_strain = between(seed, 0.01, 0.1);
		fat->plastic_strain_max = between(seed, 0.05, 0.2);
	}
	SAY(of, " fat %.2g Pa %.2f %s%s", fat->young_modulus_pa, fat->poisson_ratio, names[model],
	    fat->plastic_strain_max > 0 ? " plastic" : "");
}

static void add_slab(uint64_t *seed, generated *of)
{
	int32_t cells[3];
	double cell = between(seed, 2e-3, 4e-3);
	of->size_m[2] = between(seed, 4e-3, 16e-3);
	for (int c = 0; c < 3; c++)
		cells[c] = (int32_t)fmax(2, of->size_m[c] / cell);
	draw_fat(seed, of, stage_add_slab(of->scene, "fat", of->size_m, cells)->fat);
}

static cau_layer_def *add_sheet(uint64_t *seed, generated *of)
{
	double cell = between(seed, 1.5e-3, 3e-3);
	cau_layer_def *layer = stage_add_sheet(of->scene, "fascia", of->size_m[0], of->size_m[1],
	                                       (int32_t)fmax(2, of->size_m[0] / cell),
	                                       (int32_t)fmax(2, of->size_m[1] / cell));
	draw_sheet(seed, of, layer->sheet);
	return layer;
}

static void add_tissue(uint64_t *seed, generated *of)
{
	enum { SLAB, SHEET, COVERED, STACK, STRAND, KINDS };
	int kind = one_of(seed, KINDS);
	of->size_m[0] = between(seed, 0.03, 0.06);
	of->size_m[1] = kind == STRAND ? between(seed, 4e-3, 8e-3) : between(seed, 0.02, 0.04);
	if (kind == SHEET || (kind == STRAND && one_of(seed, 2))) {
		add_sheet(seed, of);
		return;
	}
	add_slab(seed, of);
	if (kind != COVERED && kind != STACK)
		return;
	stage_add_membrane(of->scene, "membrane", "fat");
	draw_sheet(seed, of, of->scene->layers[of->scene->layer_count - 1].sheet);
	if (kind == COVERED)
		return;
	stage_mesh_of(of->scene, add_sheet(seed, of))->translate_m[2] = 2e-3;
	cau_layer_def *links = stage_add_links(of->scene, "links", "fascia", "membrane");
	links->link.young_modulus_pa = of_magnitude(seed, 1e4, 1e6);
	SAY(of, " links %.2g Pa", links->link.young_modulus_pa);
}

static void add_pins(uint64_t *seed, generated *of)
{
	enum { ONE_END, BOTH_ENDS, CORNERS, BOTTOM, WAYS };
	static const char *const names[] = {"one end", "both ends", "corners", "bottom"};
	const double x = of->size_m[0] / 2 - 1e-6, y = of->size_m[1] / 2 - 1e-6;
	bool flat = of->size_m[2] == 0; // the bottom of a sheet is the whole sheet
	int way = one_of(seed, flat ? BOTTOM : WAYS);
	const double left[2][3] = {{-1, -1, -1}, {-x, 1, 1}}, right[2][3] = {{x, -1, -1}, {1, 1, 1}};
	const double corner[4][2][3] = {{{-1, -1, -1}, {-x, -y, 1}},
	                                {{x, -1, -1}, {1, -y, 1}},
	                                {{-1, y, -1}, {-x, 1, 1}},
	                                {{x, y, -1}, {1, 1, 1}}};
	const double bottom[2][3] = {{-1, -1, -1}, {1, 1, 1e-6 - of->size_m[2]}};
	if (way == ONE_END || way == BOTH_ENDS)
		stage_pin_box(of->scene, left[0], left[1]);
	if (way == BOTH_ENDS)
		stage_pin_box(of->scene, right[0], right[1]);
	for (int k = 0; way == CORNERS && k < (flat ? 2 : 4); k++)
		stage_pin_box(of->scene, corner[k][0], corner[k][1]);
	if (way == BOTTOM)
		stage_pin_box(of->scene, bottom[0], bottom[1]);
	SAY(of, ", pinned at %s", names[way]);
}

static void add_deed(uint64_t *seed, generated *of)
{
	static const int shapes[DEEDS] = {CAU_TOOL_SPHERE, CAU_TOOL_SPHERE, CAU_TOOL_GRASPER,
	                                  CAU_TOOL_HOOK};
	of->what = (deed)one_of(seed, DEEDS);
	of->depth_m = between(seed, 2e-3, 8e-3);
	of->sideways_m = between(seed, -0.01, 0.01);
	of->speed_m_s = of_magnitude(seed, 0.01, 0.2);
	cau_tool_def *tool = stage_add_tool(of->scene, "tool", shapes[of->what], 0, 0, 0.05);
	tool->max_speed_m_s = 2;
	SAY(of, ", %s at %.0f mm/s", deed_names[of->what], 1e3 * of->speed_m_s);
}

static generated make(uint64_t seed)
{
	generated of = {.scene = stage_scene(CAU_PRECISION_SINGLE)};
	drawn(&seed);
	add_tissue(&seed, &of);
	add_pins(&seed, &of);
	add_deed(&seed, &of);
	of.scene->accuracy = wanted;
	of.scene->parting = CAU_PARTING_ELEMENTS;
	cau_default_gravity(of.scene->gravity_m_s2);
	if (one_of(&seed, 3) == 0) {
		of.scene->contact_thickness_m = 5e-4;
		SAY(&of, ", touching");
	}
	return of;
}

// ---- the run of a scene
static void fall(const generated *of, cau_session *session, int tick)
{
	(void)of;
	if (tick == TICKS / 2) // then the scene falls sideways
		stage_gravity(session, 5, 3, -7);
}

static void press(const generated *of, cau_session *session, int tick)
{
	double in = fmin(tick * of->speed_m_s / 60, of->depth_m);
	double along = tick > TICKS / 2 ? fmin((tick - TICKS / 2) * of->speed_m_s / 60, 0.01) : 0;
	stage_move(session, "tool", along, of->sideways_m / 3, 3e-3 - in);
}

static void grasp(const generated *of, cau_session *session, int tick)
{
	enum { CLOSED = 15, OPEN = 90 };
	double way = tick > CLOSED ? fmin((tick - CLOSED) * of->speed_m_s / 60, 3 * of->depth_m) : 0;
	stage_move(session, "tool", way * of->sideways_m / 0.01, 0, way - 1e-3);
	if (tick == CLOSED - 5)
		stage_grasp(session, "tool");
	if (tick == OPEN)
		stage_release(session, "tool");
}

static void cut(const generated *of, cau_session *session, int tick)
{
	double far = of->size_m[1] / 2 + 5e-3;
	if (tick == 5)
		stage_energize(session, "tool", 1);
	if (tick == 100)
		stage_energize(session, "tool", 0);
	double lift = tick > 100 ? 0.05 : -2e-3;
	stage_move(session, "tool", of->sideways_m, fmin(-far + 2 * far * tick / 90, far), lift);
}

static void advance(const generated *of, cau_session *session, int tick)
{
	static void (*const deeds[DEEDS])(const generated *, cau_session *, int) = {
		[FALL] = fall, [PRESS] = press, [GRASP] = grasp, [CUT] = cut};
	deeds[of->what](of, session, tick);
}

typedef struct verdict {
	double p95, worst, gain, above, unsettled;
	int32_t long_inverted, unreported, flattered, samples;
	double iterations;
} verdict;

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double volume(const cau_session *session, int32_t element)
{
	cau_vec3 x[4];
	for (int k = 0; k < 4; k++) {
		int32_t v = session->tissue.primitives.tetrahedron[4 * (size_t)element + (size_t)k];
		x[k] = cau_vec3_of(session->vertices.position + 3 * (size_t)v);
	}
	return cau_dot(cau_cross(cau_sub(x[1], x[0]), cau_sub(x[2], x[0])), cau_sub(x[3], x[0]));
}

// Counts here, independently, how many ticks in a row each tetrahedron was inverted.
static void count_inverted(const cau_session *session, int32_t *ticks)
{
	for (int32_t t = 0; t < session->tissue.primitives.tetrahedron_count; t++)
		ticks[t] = volume(session, t) < 0 ? ticks[t] + 1 : 0;
}

static void sample(cau_session *session, cau_session *exact, const generated *of, int tick,
                   double *error, verdict *found)
{
	stage_bytes shot = stage_snapshot(session);
	assert_int_equal(cau_session_restore(exact, shot.bytes, shot.count, NULL, NULL), CAU_OK);
	free(shot.bytes);
	advance(of, exact, tick);
	stage_step(exact, 1);
	advance(of, session, tick);
	stage_step(session, 1);
	double is = step_error(session, exact->vertices.position, wanted);
	found->unsettled = fmax(found->unsettled, exact->solver.result.residual);
	found->flattered += is > 3 * session->solver.accuracy.error;
	error[found->samples++] = is;
}

static verdict run(const generated *of)
{
	verdict found = {0};
	double error[SAMPLES], gained = 0, range = 0;
	cau_session *session = stage_open(of->scene, 1), *exact = stage_open(of->scene, 1);
	exact->solver.accuracy.wanted = 0;
	exact->solver.settings.iterations = CONVERGED;
	exact->solver.settings.tolerance = converged_residual;
	int32_t *ticks =
		calloc((size_t)session->tissue.primitives.tetrahedron_count + 1, sizeof *ticks);
	for (int tick = 0; tick < TICKS; tick++) {
		if (tick % SAMPLE_EVERY == 5) {
			sample(session, exact, of, tick, error, &found);
		} else {
			advance(of, session, tick);
			stage_step(session, 1);
		}
		cau_statistics now = stage_frame(session).statistics;
		gained += fmax(now.energy_gain_j, 0);
		range = fmax(range, now.energy_scale_j);
		found.above += now.error > wanted;
		found.iterations += now.iterations;
		count_inverted(session, ticks);
	}
	cau_statistics last = stage_frame(session).statistics;
	for (int i = 0; i < CAU_MAX_LAYERS; i++)
		found.long_inverted += last.long_inverted[i];
	int32_t own = 0;
	for (int32_t t = 0; t < session->tissue.primitives.tetrahedron_count; t++)
		own += ticks[t] > 40; // longer than half a second, after which it is reported
	found.unreported = own > found.long_inverted ? own - found.long_inverted : 0;
	found.gain = range > 0 ? gained / range : 0;
	qsort(error, (size_t)found.samples, sizeof *error, compare);
	found.p95 = error[(int)(steps_right * (found.samples - 1) + 0.5)];
	found.worst = error[found.samples - 1];
	found.above /= TICKS;
	found.iterations /= TICKS;
	free(ticks);
	cau_session_destroy(session);
	cau_session_destroy(exact);
	return found;
}

static int setting(const char *name, int otherwise)
{
	const char *text = getenv(name);
	return text ? atoi(text) : otherwise;
}

static void generated_scenes_are_right(void **state)
{
	(void)state;
	int count = setting("CAUTERY_SCENES", SCENES), wrong = 0, gaining = 0, silent = 0,
		flattered = 0;
	int first = setting("CAUTERY_SCENES_SEED", FIRST_SEED), samples = 0;
	for (int k = 0; k < count; k++) {
		generated of = make((uint64_t)(first + k));
		verdict found = run(&of);
		bool is_wrong = found.p95 > wanted, gains = found.gain > gain_most;
		print_message(
			"%d%s: p95 %.2g%s, worst %.2g, %.0f %% report more, %.1f iterations, gain %.2g%s, "
			"%d long inverted%s, %d flattered, residual %.1g\n",
			first + k, of.text, found.p95, is_wrong ? " WRONG" : "", found.worst, 100 * found.above,
			found.iterations, found.gain, gains ? " GAINS" : "", found.long_inverted,
			found.unreported ? " SILENT" : "", found.flattered, found.unsettled);
		wrong += is_wrong;
		gaining += gains;
		silent += found.unreported > 0;
		flattered += found.flattered;
		samples += found.samples;
		free(of.scene);
	}
	print_message("of %d scenes %d wrong, %d gain energy, %d inverted in silence; %d of %d samples "
	              "flattered\n",
	              count, wrong, gaining, silent, flattered, samples);
	assert_int_equal(silent, 0);
	assert_true(flattered <= 1 + flattered_most * samples);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(generated_scenes_are_right)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
