// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that is made from a mesh alone: the tissue stays in place for 60 s, the grasper holds it,
// and the ball cuts it. Tested with a block, a hollow box and organs made here, and with the files
// of CAUTERY_MESHES, if there are any. With --long: 30 organs.
#include "core/session/stage.h"

#include <dirent.h>
#include <stdio.h>

#include "cautery/mesh_scene.h"
#include "cautery/solid.h"

static const double stand_s = 60;
static const double drift_most = 0.02; // largest motion of tissue at rest, as a share of its size

// Writes a block of 4 x 4 x 4 hexahedra, 60 mm wide, or its surface as quadrangles.
static size_t write_block(bool solid, char *text, size_t bytes)
{
	enum { N = 5 };
	FILE *out = fmemopen(text, bytes, "w");
	assert_non_null(out);
	fprintf(out, "MeshVersionFormatted 2\nDimension 3\nVertices %d\n", N * N * N);
	for (int i = 0; i < N * N * N; i++)
		fprintf(out, "%g %g %g 0\n", 0.015 * (i % N), 0.015 * (i / N % N), 0.015 * (i / N / N));
	int axis[3] = {1, N, N * N};
	if (solid)
		fprintf(out, "Hexahedra 64\n");
	for (int c = 0; c < 64 && solid; c++) {
		int v = 1 + c % 4 + c / 4 % 4 * N + c / 16 * N * N;
		fprintf(out, "%d %d %d %d %d %d %d %d 1\n", v, v + 1, v + 1 + N, v + N, v + N * N,
		        v + 1 + N * N, v + 1 + N + N * N, v + N + N * N);
	}
	if (!solid)
		fprintf(out, "Quadrilaterals 96\n");
	for (int q = 0; q < 96 && !solid; q++) {
		int a = axis[q / 32], b = axis[(q / 32 + 1) % 3], far = q / 16 % 2;
		int v = 1 + far * 4 * axis[(q / 32 + 2) % 3] + q % 4 * a + q / 4 % 4 * b;
		fprintf(out, "%d %d %d %d 1\n", v, far ? v + a : v + b, v + a + b, far ? v + b : v + a);
	}
	fprintf(out, "End\n");
	long count = ftell(out);
	fclose(out);
	return (size_t)count;
}

static void assert_finite(const cau_frame *frame, int32_t vertex_count)
{
	for (int32_t i = 0; i < 3 * vertex_count; i++)
		assert_true(isfinite(frame->position[i]));
}

// Runs the session. Nothing may move far, and nothing may end the session.
static void stand(cau_session *session, const cau_session_info *info, double size_m)
{
	stage_step(session, (int)(stand_s / info->step_s));
	cau_frame frame = stage_frame(session);
	assert_finite(&frame, info->vertex_count);
	for (int32_t i = 0; i < 3 * info->vertex_count; i++)
		assert_true(fabs(frame.position[i] - info->rest_position[i]) < drift_most * size_m);
}

// Moves the ball through the upper half, from side to side.
static int32_t cut(cau_session *session, const cau_session_info *info, const cau_mesh_report *r)
{
	double radius_m = stage_tool(session, "ball")->definition.hot_radius_m;
	double cut_s = (r->most_m[0] - r->least_m[0] + 2 * radius_m) / (radius_m / 2);
	int ticks = (int)(cut_s / info->step_s);
	double z = 0.3 * r->least_m[2] + 0.7 * r->most_m[2];
	stage_energize(session, "ball", 1);
	for (int tick = 0; tick < ticks; tick++) {
		double s = (tick + 1.0) / ticks;
		stage_move(session, "ball",
		           r->least_m[0] - radius_m + s * (r->most_m[0] - r->least_m[0] + 2 * radius_m),
		           0.5 * (r->least_m[1] + r->most_m[1]), z);
		stage_step(session, 1);
	}
	cau_frame frame = stage_frame(session);
	assert_finite(&frame, info->vertex_count);
	return frame.statistics.elements_removed + frame.statistics.edges_parted;
}

// Closes the jaws around the highest vertex, deeper each time, until they hold something.
static int32_t grasp(cau_session *session, const cau_session_info *info)
{
	cau_frame frame = stage_frame(session);
	int32_t top = 0;
	for (int32_t v = 1; v < info->vertex_count; v++)
		top = frame.position[3 * v + 2] > frame.position[3 * top + 2] ? v : top;
	int32_t held = 0;
	for (int mm = 2; mm <= 10 && !held; mm += 2) {
		stage_move(session, "grasper", frame.position[3 * top], frame.position[3 * top + 1],
		           info->rest_position[3 * top + 2] - 1e-3 * mm);
		stage_step(session, (int)(0.5 / info->step_s));
		stage_grasp(session, "grasper");
		stage_step(session, (int)(0.3 / info->step_s));
		held = stage_tool(session, "grasper")->grasped_vertices;
		if (!held)
			stage_release(session, "grasper");
		stage_step(session, 1);
		frame = stage_frame(session);
	}
	return held;
}

static void live(const cau_mesh_wish *wish)
{
	static cau_mesh_report report;
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	if (cau_mesh_scene(wish, scene, &report, &error))
		fail_msg("%s: %s: %s", wish->file, error.path, error.reason);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	double size_m = 0;
	for (int c = 0; c < 3; c++)
		size_m = fmax(size_m, report.most_m[c] - report.least_m[c]);
	stand(session, &info, size_m);
	int32_t held = grasp(session, &info);
	stage_release(session, "grasper");
	int32_t parted = cut(session, &info, &report);
	print_message("%s: stood, %d vertices held, %d elements and edges parted\n", wish->file, held,
	              parted);
	assert_true(held > 0);
	assert_true(parted > 0);
	cau_session_destroy(session);
	free(scene);
}

static void blocks_live(void **state)
{
	(void)state;
	static char text[1 << 16];
	for (int solid = 0; solid < 2; solid++) {
		size_t count = write_block(solid, text, sizeof text);
		live(&(cau_mesh_wish){
			.file = solid ? "block" : "box", .bytes = text, .byte_count = count, .layer_kind = -1});
	}
}

static void real_files_live(void **state)
{
	static const char *const files[] = {"liver.msh", "liver_low_volume.msh", "liver-smoothUV.obj"};
	const char *folder = getenv("CAUTERY_MESHES");
	(void)state;
	size_t count = CAU_TEST_SANITIZED ? 1 : sizeof files / sizeof *files;
	for (size_t i = 0; i < count; i++) {
		char path[600];
		snprintf(path, sizeof path, "%s/%s", folder ? folder : "", files[i]);
		FILE *file = folder ? fopen(path, "r") : NULL;
		if (!file) {
			print_message("skipped: %s is not in the folder that CAUTERY_MESHES names\n", files[i]);
			continue;
		}
		fclose(file);
		live(&(cau_mesh_wish){.file = path, .layer_kind = -1});
	}
}

// ---- organs: balls with bumps, stretched, in millimetres, as from segmentations
enum { ROWS = 24, FACETS = 2 * ROWS * (2 * ROWS) - 4 * ROWS, ORGANS = 30, BUMPS = 5 };

// Returns the next random number from 0 to 1 [Knuth's MMIX].
static double next(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

typedef struct organ {
	double size[3], bump[BUMPS], turn[BUMPS];
	int missing; // number of facets missing at a hole
	bool turned; // true if some facets look inward
} organ;

static organ organ_of(int number)
{
	organ of = {0};
	uint64_t state = 7919u * (uint64_t)(number + 1);
	for (int k = 0; k < 8; k++)
		next(&state);
	for (int c = 0; c < 3; c++)
		of.size[c] = 25 + 45 * next(&state);
	for (int k = 0; k < BUMPS; k++) {
		of.bump[k] = 0.09 * next(&state);
		of.turn[k] = 6.28 * next(&state);
	}
	of.missing = number % 3 == 2 ? 20 + (int)(60 * next(&state)) : 0;
	of.turned = number % 4 == 1;
	return of;
}

static void place_on(const organ *of, int row, int column, float x[3])
{
	double down = M_PI * row / ROWS, turn = M_PI * (column % (2 * ROWS)) / ROWS;
	double radius = 1;
	for (int k = 0; k < BUMPS; k++)
		radius += of->bump[k] * sin(down) * sin(down) * sin((k + 1) * turn + of->turn[k]);
	x[0] = (float)(of->size[0] * radius * sin(down) * cos(turn));
	x[1] = (float)(of->size[1] * radius * sin(down) * sin(turn));
	x[2] = (float)(of->size[2] * radius * cos(down));
}

static size_t put_facet(const organ *of, const int corner[3][2], int number, unsigned char *at)
{
	float facet[4][3] = {{0}};
	bool inward = of->turned && number % 9 == 4;
	for (int k = 0; k < 3; k++)
		place_on(of, corner[inward ? 2 - k : k][0], corner[inward ? 2 - k : k][1], facet[k + 1]);
	memcpy(at, facet, sizeof facet);
	memset(at + sizeof facet, 0, 2);
	return sizeof facet + 2;
}

static size_t write_organ(const organ *of, unsigned char *bytes)
{
	size_t used = 84;
	int number = 0;
	memset(bytes, 0, used);
	for (int row = 0; row < ROWS; row++)
		for (int column = 0; column < 2 * ROWS; column++)
			for (int half = 0; half < 2; half++) {
				const int corner[2][3][2] = {
					{{row, column}, {row + 1, column}, {row, column + 1}},
					{{row + 1, column}, {row + 1, column + 1}, {row, column + 1}}};
				if ((half == 0 && row == 0) || (half == 1 && row == ROWS - 1))
					continue; // at a pole this facet is a line
				if (number++ >= of->missing)
					used += put_facet(of, corner[half], number, bytes + used);
			}
	uint32_t facets = (uint32_t)((used - 84) / 50);
	memcpy(bytes + 80, &facets, sizeof facets);
	return used;
}

// Makes an organ as the server does: guesses the unit from the surface, then fills the surface.
static void organ_lives(int number)
{
	static unsigned char bytes[84 + 50 * FACETS];
	static cau_mesh_report report;
	cau_solid solid;
	cau_error error = {0};
	organ of = organ_of(number);
	char name[32];
	snprintf(name, sizeof name, "organ-%d.stl", number);
	size_t count = write_organ(&of, bytes);
	cau_mesh_wish wish = {.file = name, .bytes = bytes, .byte_count = count, .layer_kind = -1};
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	if (cau_mesh_scene(&wish, scene, &report, &error))
		fail_msg("%s: %s", name, error.reason);
	free(scene);
	assert_true(report.unit_guessed && report.unit_m == 0.001);
	assert_true(report.opening <= CAU_NEARLY_CLOSED);
	cau_solid_wish asked = {.file = name, .bytes = bytes, .byte_count = count};
	if (cau_solid_make(&asked, &solid, &error))
		fail_msg("%s: %s", name, error.reason);
	wish.bytes = solid.bytes;
	wish.byte_count = solid.byte_count;
	wish.unit_m = report.unit_m;
	live(&wish);
	cau_solid_finish(&solid);
}

static bool all_organs;

static void organs_live(void **state)
{
	(void)state;
	// Numbers of organs: one with a hole, and one that also has facets that look inward.
	static const int some[] = {5, 17};
	for (int k = 0; k < (all_organs ? ORGANS : CAU_TEST_SANITIZED ? 1 : 2); k++)
		organ_lives(all_organs ? k : some[k]);
}

int main(int argument_count, char **arguments)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(blocks_live),
	                                   cmocka_unit_test(real_files_live),
	                                   cmocka_unit_test(organs_live)};
	all_organs = argument_count > 1 && strcmp(arguments[1], "--long") == 0;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
