// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots that earlier builds wrote are still read. tests/data has, of each of two builds, the
// snapshot of what run() leads to and its positions (m, n x 3 doubles) one tick later:
//
//     older_snapshot.bin, older_snapshot_next.bin  of version 1: elements stood in other slots, and
//                                                  heat was not what it is now
//     snapshot_6.bin, snapshot_6_next.bin          of version 6, by the heat of today
//
// Where heat is mended again, another pair belongs beside these: `--write FOLDER` makes one.
#include <stdio.h>

#include "core/session/stage.h"

enum { AT_TICK = 40, MOST_BYTES = 1 << 20 };

typedef struct stored {
	const char *snapshot, *next;
	int32_t removed; // elements, by then
	int32_t alike;   // of so many vertices one may be elsewhere in what this build comes to
	bool same_build_may_have_written_it;
} stored;

// Rounding lets another element or two go in 40 ticks of a cut, and what hangs on them is
// elsewhere: a twentieth. What the heat of version 1 reached half a cell further out is another.
static const stored of_version[] = {
	{"older_snapshot.bin", "older_snapshot_next.bin", 186, 10, false},
	{"snapshot_6.bin", "snapshot_6_next.bin", 187, 20, true},
};
enum { STORED = sizeof of_version / sizeof *of_version };

static void hot(cau_heat_material *heat)
{
	heat->absorption_per_s = 8; // parts within ticks instead of seconds
}

// As it was when the snapshot was written, so not shared with busy_scene.h, which may change. More
// than 256 elements of each kind, so that version 1 dealt them to batches, and some left over.
static cau_scene_def *small_scene(void)
{
	const double size[3] = {0.03, 0.03, 0.008};
	const int32_t cells[3] = {5, 5, 3};
	const double least[3] = {-0.1, -0.1, -0.0081}, most[3] = {0.1, 0.1, -0.0079};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.03, 0.03, 13, 13);
	stage_mesh_of(scene, fascia)->translate_m[2] = 0.002;
	fascia->sheet[0].target[0] = 0.4;
	fascia->sheet[0].shrink[0] = 0.3;
	fascia->sheet[0].bending_stiffness_nm = 1e-5;
	hot(&fascia->sheet[0].heat);
	cau_layer_def *fat = stage_add_slab(scene, "fat", size, cells);
	fat->fat[0].limit = CAU_LIMIT_TARGET;
	fat->fat[0].target[0] = 0.7;
	fat->fat[0].shrink[0] = 0.3;
	fat->fat[0].yield_strain = 0.01;
	fat->fat[0].plastic_strain_max = 0.16;
	hot(&fat->fat[0].heat);
	stage_add_membrane(scene, "membrane", "fat");
	hot(&scene->layers[2].sheet[0].heat);
	hot(&stage_add_links(scene, "links", "fascia", "membrane")->link.heat);
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, -0.012, 0, 0.02);
	return scene;
}

// A cut; then the hook goes, and its heat with it, which would be most of the snapshot.
static void run(cau_session *session)
{
	for (int tick = 0; tick < AT_TICK; tick++) {
		double s = (double)tick / AT_TICK;
		if (tick < AT_TICK - 3)
			stage_move(session, "hook", -0.012 + 0.02 * s, 0.004 * s,
			           tick < 6 ? 0.02 - 0.003 * tick : 0.001);
		if (tick == 5)
			stage_energize(session, "hook", 1);
		if (tick == AT_TICK - 3) {
			cau_command remove = stage_command(CAU_COMMAND_TOOL_REMOVE);
			stage_submit(session, &remove);
		}
		stage_step(session, 1);
	}
}

static stage_bytes read_data(const char *name)
{
	char path[512];
	snprintf(path, sizeof path, "%s/%s", CAU_TEST_DATA, name);
	FILE *file = fopen(path, "rb");
	if (!file)
		fail_msg("%s cannot be read", path);
	stage_bytes data = {.bytes = malloc(MOST_BYTES)};
	assert_non_null(data.bytes);
	data.count = fread(data.bytes, 1, MOST_BYTES, file);
	fclose(file);
	return data;
}

static cau_session *open_stored(const stored *of, const cau_scene_def *scene)
{
	stage_bytes older = read_data(of->snapshot);
	cau_session *session = stage_open(scene, 1);
	cau_error error = {0};
	bool exact = true;
	if (cau_session_restore(session, older.bytes, older.count, &exact, &error))
		fail_msg("%s: %s", of->snapshot, error.reason);
	assert_true(!exact || of->same_build_may_have_written_it);
	free(older.bytes);
	return session;
}

// Two builds, as two instruction sets, round differently: some 1e-7 m in the next tick, in which
// the farthest vertex moves 1 mm. Elements in each other's places are 1 mm off.
static void goes_on(const stored *of)
{
	cau_scene_def *scene = small_scene();
	cau_session *session = open_stored(of, scene);
	stage_bytes next = read_data(of->next);
	int32_t n = stage_info(session).vertex_count;
	assert_int_equal(next.count, (size_t)n * 3 * sizeof(double));
	assert_int_equal(stage_frame(session).tick, AT_TICK);
	assert_int_equal(stage_frame(session).statistics.elements_removed, of->removed);
	stage_step(session, 1);
	cau_frame frame = stage_frame(session);
	double off = stage_farthest(&frame, (const double *)(void *)next.bytes, n);
	if (!(off < 5e-6))
		fail_msg("%s: a vertex is %.1e m off", of->snapshot, off);
	free(next.bytes);
	cau_session_destroy(session);
	free(scene);
}

static void it_goes_on_as_that_build_did(void **state)
{
	(void)state;
	for (int i = 0; i < STORED; i++)
		goes_on(&of_version[i]);
}

static void is_led_to(const stored *of)
{
	cau_scene_def *scene = small_scene();
	cau_session *older = open_stored(of, scene), *session = stage_open(scene, 1);
	run(session);
	cau_frame had = stage_frame(older), has = stage_frame(session);
	int32_t removed = has.statistics.elements_removed;
	assert_in_range(removed, of->removed - 5, of->removed + 5);
	int32_t n = stage_info(session).vertex_count, elsewhere = 0;
	for (int32_t v = 0; v < n; v++)
		elsewhere += cau_length(cau_sub(cau_vec3_of(&had.position[3 * v]),
		                                cau_vec3_of(&has.position[3 * v]))) > 2e-4;
	print_message("%s: %d elements removed, %d here; %d of %d vertices elsewhere\n", of->snapshot,
	              of->removed, removed, elsewhere, n);
	if (elsewhere > n / of->alike)
		fail_msg("%s: %d of %d vertices are elsewhere", of->snapshot, elsewhere, n);
	cau_session_destroy(session);
	cau_session_destroy(older);
	free(scene);
}

static void it_is_what_the_commands_lead_to(void **state)
{
	(void)state;
	for (int i = 0; i < STORED; i++)
		is_led_to(&of_version[i]);
}

// Written anew it is of this build's version, and exact.
static void is_exact_anew(const stored *of)
{
	cau_scene_def *scene = small_scene();
	cau_session *older = open_stored(of, scene), *session = stage_open(scene, 1);
	stage_bytes shot = stage_snapshot(older);
	cau_error error = {0};
	bool exact = false;
	assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, &exact, &error), CAU_OK);
	assert_true(exact);
	stage_step(older, 10);
	stage_step(session, 10);
	assert_true(cau_session_hash(older) == cau_session_hash(session));
	free(shot.bytes);
	cau_session_destroy(session);
	cau_session_destroy(older);
	free(scene);
}

static void written_anew_it_is_exact(void **state)
{
	(void)state;
	for (int i = 0; i < STORED; i++)
		is_exact_anew(&of_version[i]);
}

// ---- versions 6 and 7, in which jaws closed whole: tests/data/held_snapshot_6.bin and _7.bin are
// a sheet held by closed jaws, with shears on their way in a command for tick 40.

static cau_scene_def *held_scene(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_sheet(scene, "sheet", 0.06, 0.05, 6, 5)->sheet[0].limit_stiffness_pa = 1e6;
	cau_default_selection(&scene->pins[scene->pin_count++], CAU_SELECT_RIM);
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.004, 0.003, -0.002);
	jaws->shaft_radius_m = 1e-3;
	jaws->tip_length_m = 4e-3;
	jaws->grid_cells = 8;
	return scene;
}

static void go_on_holding(const char *snapshot, const char *then)
{
	cau_scene_def *scene = held_scene();
	cau_session *session = stage_open(scene, 1);
	stage_bytes older = read_data(snapshot), next = read_data(then);
	cau_error error = {0};
	bool exact = true;
	if (cau_session_restore(session, older.bytes, older.count, &exact, &error))
		fail_msg("%s: %s", snapshot, error.reason);
	assert_false(exact);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->jaw == 0 && jaws->asked_jaw == 0 && jaws->grasping);
	assert_int_equal(jaws->grasped_vertices, 2);
	assert_true(jaws->definition.close_force_n == 8 && jaws->definition.force_max_n == 20);
	int32_t n = stage_info(session).vertex_count;
	assert_int_equal(next.count, (size_t)n * 3 * sizeof(double));
	stage_step(session, 1);
	cau_frame frame = stage_frame(session);
	double off = stage_farthest(&frame, (const double *)(void *)next.bytes, n);
	if (!(off < 5e-6)) // as above
		fail_msg("%s: a vertex is %.1e m off", snapshot, off);
	stage_step(session, 12);
	const cau_tool_def *shears = &stage_tool(session, "shears")->definition;
	assert_true(shears->friction == 0.5 && shears->close_force_n == 8);
	assert_true(shears->pose.position_m[2] == 0.05 && shears->pose.rotation[0] == 1);
	free(older.bytes);
	free(next.bytes);
	cau_session_destroy(session);
	free(scene);
}

static void jaws_that_closed_whole_go_on_holding(void **state)
{
	(void)state;
	go_on_holding("held_snapshot_6.bin", "held_snapshot_6_next.bin");
	go_on_holding("held_snapshot_7.bin", "held_snapshot_7_next.bin");
}

// ---- a pair of today's

static void write_data(const char *folder, const char *name, const void *bytes, size_t count)
{
	char path[512];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "wb");
	if (!file || fwrite(bytes, 1, count, file) != count || fclose(file))
		fail_msg("%s cannot be written", path);
}

static void write_pair(void **folder)
{
	cau_scene_def *scene = small_scene();
	cau_session *session = stage_open(scene, 1);
	run(session);
	stage_bytes shot = stage_snapshot(session);
	write_data(*folder, "snapshot.bin", shot.bytes, shot.count);
	print_message("%d elements removed\n", stage_frame(session).statistics.elements_removed);
	stage_step(session, 1);
	size_t bytes = (size_t)stage_info(session).vertex_count * 3 * sizeof(double);
	write_data(*folder, "snapshot_next.bin", stage_frame(session).position, bytes);
	free(shot.bytes);
	cau_session_destroy(session);
	free(scene);
}

int main(int count, char **argument)
{
	const struct CMUnitTest writing[] = {
		cmocka_unit_test_prestate(write_pair, argument[count - 1])};
	if (count == 3 && !strcmp(argument[1], "--write"))
		return cmocka_run_group_tests(writing, NULL, NULL);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_goes_on_as_that_build_did),
		cmocka_unit_test(it_is_what_the_commands_lead_to),
		cmocka_unit_test(written_anew_it_is_exact),
		cmocka_unit_test(jaws_that_closed_whole_go_on_holding),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
