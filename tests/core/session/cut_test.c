// SPDX-License-Identifier: GPL-3.0-or-later
// States after any sequence of cuts (core/README.md, "What must hold, whatever the speed"). The
// counters agree with a recount, and the system with a reassembly. Vertices without elements are
// frozen, held tissue stays held, free tissue falls.
#include "core/session/busy_scene.h"

#include <stdio.h>

#include "session/session_internal.h"

// Largest relative error of the system's solution (core/README.md, "What must hold, whatever the
// speed"). The larger of the two bounds holds.
static const double system_tolerance = 1e-10;
static const double condition_tolerance = 1e-13; // largest error, times the condition number
// Greatest delay of a falling strip by waiting downdates, as a share of the fallen height.
static const double fall_tolerance = 0.02;

// One session is cut for four tests, which run in this order: first the counters are checked, then,
// after the factor has settled, the system and the loose vertices.
static struct {
	cau_scene_def *scene;
	cau_session *session;
} busy;

static int make_busy(void **state)
{
	(void)state;
	busy.scene = busy_scene();
	busy.session = stage_open(busy.scene, 1);
	busy_run(busy.session, BUSY_TICKS);
	return 0;
}

static int drop_busy(void **state)
{
	(void)state;
	cau_session_destroy(busy.session);
	free(busy.scene);
	return 0;
}

// ---- the counters
static void *copy_of(const void *array, size_t bytes)
{
	void *copy = malloc(bytes + 1);
	assert_non_null(copy);
	memcpy(copy, array, bytes);
	return copy;
}

typedef struct book {
	const void *array;
	size_t bytes;
	void *copy;
} book;

static void shares_equal_a_recount(void **state)
{
	(void)state;
	cau_session *session = busy.session;
	cau_session_info info = stage_info(session);
	cau_dissection *d = &session->dissection;
	assert_true(d->elements_removed > 500);
	book books[] = {
		{d->share_count[CAU_PRIMITIVE_TRIANGLE], (size_t)info.triangle_count, NULL},
		{d->share_count[CAU_PRIMITIVE_TETRAHEDRON], (size_t)info.tetrahedron_count, NULL},
		{d->share_count[CAU_PRIMITIVE_LINK], (size_t)info.link_count, NULL},
		{d->alive.element[CAU_ELEMENT_TRIANGLE], (size_t)info.triangle_count, NULL},
		{d->alive.element[CAU_ELEMENT_TETRAHEDRON], (size_t)info.tetrahedron_count, NULL},
		{d->alive.element[CAU_ELEMENT_LINK], (size_t)info.link_count, NULL},
		{d->alive.element[CAU_ELEMENT_HINGE], (size_t)info.hinge_count, NULL},
		{d->live_elements, (size_t)info.vertex_count * sizeof(int32_t), NULL},
		{d->face_owners, (size_t)info.face_count, NULL},
		{d->face_mask, ((size_t)info.face_count + 31) / 32 * sizeof(uint32_t), NULL},
	};
	for (size_t k = 0; k < sizeof books / sizeof *books; k++)
		books[k].copy = copy_of(books[k].array, books[k].bytes);
	cau_dissection_recount(d);
	for (size_t k = 0; k < sizeof books / sizeof *books; k++) {
		if (memcmp(books[k].array, books[k].copy, books[k].bytes) != 0)
			fail_msg("book %zu differs from a recount", k);
		free(books[k].copy);
	}
}

// Counts the shares by hand: the edges of an element that have not parted in its layer.
static void shares_are_counts_of_whole_edges(void **state)
{
	(void)state;
	const cau_tissue *t = &busy.session->tissue;
	const cau_dissection *d = &busy.session->dissection;
	uint8_t *count = calloc((size_t)t->tetrahedron_count, 1);
	assert_non_null(count);
	const int32_t *first = t->edges.first[CAU_PRIMITIVE_TETRAHEDRON];
	for (int32_t e = 0; e < t->edges.edge_count; e++)
		for (int32_t k = first[e]; k < first[e + 1]; k++) {
			int32_t i = t->edges.sharer[CAU_PRIMITIVE_TETRAHEDRON][k];
			count[i] = (uint8_t)(count[i] + !(d->parted[e] >> t->tetrahedron_layer[i] & 1));
		}
	assert_memory_equal(count, d->share_count[CAU_PRIMITIVE_TETRAHEDRON],
	                    (size_t)t->tetrahedron_count);
	free(count);
}

// ---- the system
static void settle_factor(cau_session *session)
{
	stage_move(session, "hook", 0, 0, 0.2);
	stage_energize(session, "hook", 0);
	stage_step(session, 30);
	assert_int_equal(stage_frame(session).statistics.pending_downdates, 0);
}

static void the_system_equals_a_reassembly(void **state)
{
	(void)state;
	cau_session *session = busy.session;
	settle_factor(session);
	// The factor is not canonical.
	assert_true(stage_frame(session).statistics.factor_operations > 0);
	const cau_system *system = &session->solver.system;
	size_t rows = (size_t)system->row_count, entries = (size_t)system->matrix.first[rows];
	cau_matrix matrix = system->matrix;
	matrix.value = malloc(entries * sizeof(double));
	double *b = malloc(3 * rows * sizeof(double)), *x = malloc(3 * rows * sizeof(double));
	double *fresh_x = malloc(3 * rows * sizeof(double));
	assert_true(matrix.value && b && x && fresh_x);
	cau_system_assemble(system, &session->tissue, &session->dissection.alive,
	                    session->solver.step_s, matrix.value);
	cau_factor *fresh = NULL;
	cau_error error = {0};
	assert_int_equal(cau_factor_create(&fresh, &matrix, NULL, &error), CAU_OK);
	double condition = 0;
	for (size_t r = 0; r < rows; r++) {
		double inertia = session->tissue.mass[system->vertex_of_row[r]] /
		                 (session->solver.step_s * session->solver.step_s);
		condition = fmax(condition, matrix.value[matrix.first[r]] / inertia);
	}
	for (size_t i = 0; i < 3 * rows; i++)
		b[i] = sin(0.7 * (double)i) + 0.3 * cos(13.1 * (double)i);
	assert_int_equal(cau_factor_solve(session->solver.factor, b, x, &error), CAU_OK);
	assert_int_equal(cau_factor_solve(fresh, b, fresh_x, &error), CAU_OK);
	double most = 0, off = 0, tolerance = fmax(system_tolerance, condition_tolerance * condition);
	for (size_t i = 0; i < 3 * rows; i++) {
		most = fmax(most, fabs(fresh_x[i]));
		off = fmax(off, fabs(x[i] - fresh_x[i]));
	}
	print_message("%d downdates: off by %.1e of the solution, %.1e allowed\n",
	              stage_frame(session).statistics.factor_operations, off / most, tolerance);
	assert_true(off <= tolerance * most);
	cau_factor_destroy(fresh);
	free(matrix.value);
	free(b);
	free(x);
	free(fresh_x);
}

// ---- vertices without elements
static void isolated_vertices_are_frozen(void **state)
{
	(void)state;
	cau_session *session = busy.session;
	int32_t n = stage_info(session).vertex_count, isolated = 0;
	double *before = copy_of(stage_frame(session).position, 3 * (size_t)n * sizeof(double));
	stage_step(session, 20);
	cau_frame frame = stage_frame(session);
	for (size_t v = 0; v < (size_t)n; v++) {
		if (session->dissection.live_elements[v] || session->vertices.pinned[v])
			continue;
		isolated++;
		assert_memory_equal(frame.position + 3 * v, before + 3 * v, 3 * sizeof(double));
		assert_false(frame.vertex_visible[v]);
	}
	assert_true(isolated > 0);
	assert_int_equal(isolated, frame.statistics.frozen_vertices);
	free(before);
}

// ---- a strip, pinned at one end, cut through in the middle
enum { STRIP_TICKS = 90, CUT_TICKS = 30 };

static cau_scene_def *strip_scene(int fineness)
{
	const double least[3] = {-0.1, -0.1, -0.1}, most[3] = {-0.0299, 0.1, 0.1};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	scene->damping_per_s = 2;
	cau_layer_def *fascia =
		stage_add_sheet(scene, "fascia", 0.06, 0.01, 48 * fineness, 8 * fineness);
	fascia->sheet[0].heat.absorption_per_s = 1000; // the strip parts at once
	fascia->sheet[0].limit_stiffness_pa = 1e5;
	stage_pin_box(scene, least, most);
	// The needle is above the strip's middle, over its whole width.
	cau_tool_def *needle = stage_add_tool(scene, "needle", CAU_TOOL_CAPSULE, 0, -0.006, 0.05);
	needle->tip_length_m = 0.012;
	needle->hot_radius_m = 0.002;
	needle->drag_ns_m = 0;
	needle->pose.rotation[0] = sqrt(0.5); // the needle lies along y
	needle->pose.rotation[1] = -sqrt(0.5);
	// The jaws come from beyond the free end, and open along z.
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.024, 0, 0);
	jaws->pose.rotation[0] = sqrt(0.5);
	jaws->pose.rotation[2] = sqrt(0.5);
	return scene;
}

// Cuts the strip through. `fresh`: the system is factored again in every tick. `held`: the grasper
// holds the strip's end.
static cau_session *cut_strip(const cau_scene_def *scene, int held, int fresh)
{
	cau_session *session = stage_open(scene, 1);
	cau_error error = {0};
	if (held)
		stage_grasp(session, "jaws");
	stage_energize(session, "needle", 1);
	cau_pose pose = scene->tools[0].pose;
	for (int tick = 0; tick < STRIP_TICKS; tick++) {
		pose.position_m[2] = fmax(0, 0.05 - 0.008 * tick);
		// Gravity pulls a free strip from its pins during the cut. It pulls a held strip away from
		// the jaws after the cut.
		if (tick == (held ? CUT_TICKS : 0))
			stage_gravity(session, held ? -9.81 : 9.81, 0, 0);
		stage_turn(session, "needle", &pose);
		stage_step(session, 1);
		if (fresh)
			assert_int_equal(
				cau_matrix_update_refactor(&session->update, &session->dissection.alive, &error),
				CAU_OK);
	}
	return session;
}

static void assert_falls_alike(int fineness, int by_new_factor)
{
	cau_scene_def *scene = strip_scene(fineness);
	scene->tools[1].pose.position_m[2] = 0.5; // the grasper is far away
	cau_session *kept = cut_strip(scene, 0, 0), *fresh = cut_strip(scene, 0, 1);
	cau_session_info info = stage_info(kept);
	cau_frame a = stage_frame(kept), b = stage_frame(fresh);

	assert_true(a.statistics.elements_removed > 20);
	assert_int_equal(a.statistics.refactorisations > 0, by_new_factor);
	double fallen = stage_farthest(&b, info.rest_position, info.vertex_count);
	double apart = stage_farthest(&a, b.position, info.vertex_count);
	print_message("it has fallen %.3f m, %.2e of that differently; deferred for %.0f ms at most\n",
	              fallen, apart / fallen, 1e3 * a.statistics.deferred_max_s);
	assert_true(fallen > 0.5);
	assert_true(apart <= fall_tolerance * fallen);
	assert_int_equal(a.statistics.deferred_max_s > 0, by_new_factor);
	assert_true(a.statistics.deferred_max_s <= 0.05); // core/DECISIONS.md, "What a cut does"
	cau_session_destroy(kept);
	cau_session_destroy(fresh);
	free(scene);
}

static void a_strip_falls_as_with_a_fresh_factor(void **state)
{
	(void)state;
	assert_falls_alike(1, 0); // downdates suffice for the few elements that part at once
	assert_falls_alike(2, 1); // more elements need a new factor
}

static double weight_beyond(const cau_session *session, double x_m)
{
	double mass = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		if (session->tissue.rest[3 * (size_t)v] > x_m && session->dissection.live_elements[v])
			mass += session->tissue.mass[v];
	return 9.81 * mass;
}

static void a_grasped_strip_stays_held(void **state)
{
	(void)state;
	cau_scene_def *scene = strip_scene(1);
	cau_session *session = cut_strip(scene, 1, 0);
	cau_session_info info = stage_info(session);
	assert_true(stage_frame(session).statistics.elements_removed > 40);
	stage_step(session, 300); // the strip hangs still from the jaws
	cau_frame frame = stage_frame(session);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->grasping && jaws->grasped_vertices > 5);
	for (int32_t v = 0; v < info.vertex_count; v++)
		if (info.rest_position[3 * (size_t)v] > 0.005 && session->dissection.live_elements[v])
			assert_true(frame.position[3 * (size_t)v] > -0.01); // the strip hangs and does not fall
	// The jaws carry the hanging strip. Single precision and ten iterations leave an error of 0.1
	// %.
	double weight = weight_beyond(session, 0);
	print_message("the jaws carry %.4g N of %.4g N\n", -jaws->raw_force_n[0], weight);
	assert_true(fabs(-jaws->raw_force_n[0] - weight) <= 1e-3 * weight);
	// The released strip falls.
	stage_release(session, "jaws");
	stage_step(session, 30);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	assert_false(stage_tool(session, "jaws")->grasping);
	frame = stage_frame(session);
	assert_true(frame.position[3 * (size_t)(info.vertex_count - 1)] < -0.5);
	cau_session_destroy(session);
	free(scene);
}

// The held end itself is burnt away. The jaws report that they are empty.
static void burnt_out_of_the_jaws(void **state)
{
	(void)state;
	cau_scene_def *scene = strip_scene(1);
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 10);
	assert_true(stage_tool(session, "jaws")->grasped_vertices > 0);
	stage_energize(session, "needle", 1);
	cau_pose pose = scene->tools[0].pose;
	for (int tick = 0; tick < 300; tick++) {
		pose.position_m[0] = 0.031 - 0.0001 * tick;
		pose.position_m[2] = 0;
		stage_turn(session, "needle", &pose);
		stage_step(session, 1);
	}
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->grasping);
	assert_int_equal(jaws->grasped_vertices, 0);
	cau_session_destroy(session);
	free(scene);
}

// ---- layers
// A needle between fascia and fat parts only the links. Then the fascia can be lifted off.
static void links_part_and_fascia_comes_off(void **state)
{
	(void)state;
	const double size[3] = {0.05, 0.04, 0.008}, least[3] = {-1, -1, -0.0081},
				 most[3] = {1, 1, -0.0079};
	const int32_t cells[3] = {12, 10, 2};
	double lifted[2];
	for (int cut = 0; cut < 2; cut++) {
		cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
		scene->damping_per_s = 10;
		cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.05, 0.04, 20, 16);
		stage_mesh_of(scene, fascia)->translate_m[2] = 0.004;
		stage_add_slab(scene, "fat", size, cells);
		stage_add_membrane(scene, "membrane", "fat");
		cau_link_material *link = &stage_add_links(scene, "links", "fascia", "membrane")->link;
		link->reach_m = 0.008;
		link->heat.absorption_per_s = 60;
		stage_pin_box(scene, least, most);
		cau_tool_def *needle =
			stage_add_tool(scene, "needle", CAU_TOOL_CAPSULE, 0.08, -0.025, 0.002);
		needle->hot_radius_m = 0.0008;
		needle->grid_step_m = 0.0008;
		needle->tip_length_m = 0.05;
		needle->grid_cells = 64;
		needle->pose.rotation[0] = sqrt(0.5);
		needle->pose.rotation[1] = -sqrt(0.5); // along y, between the layers
		cau_session *session = stage_open(scene, 1);
		stage_energize(session, "needle", cut);
		cau_pose pose = needle->pose;
		for (int tick = 0; tick < 320 && cut; tick++) {
			pose.position_m[0] = 0.03 - 0.0002 * tick;
			stage_turn(session, "needle", &pose);
			stage_step(session, 1);
		}
		const uint8_t *tetrahedra, *triangles, *links;
		cau_session_alive(session, &tetrahedra, &triangles, &links);
		cau_session_info info = stage_info(session);
		int32_t live_links = 0, dead = 0;
		for (int32_t k = 0; k < info.link_count; k++)
			live_links += links[k];
		for (int32_t k = 0; k < info.triangle_count; k++)
			dead += !triangles[k];
		for (int32_t k = 0; k < info.tetrahedron_count; k++)
			dead += !tetrahedra[k];
		assert_int_equal(dead, 0);
		if (cut)
			assert_int_equal(live_links, 0);
		else
			assert_int_equal(live_links, info.link_count);
		// Lifts every vertex of the fascia a little, with 60 mN in all.
		cau_selection sheet = stage_everything();
		strcpy(sheet.layer, "fascia");
		stage_force(session, sheet, 0, 0, 0.06 / (21 * 17));
		stage_step(session, 30);
		lifted[cut] = stage_frame(session).position[2] - info.rest_position[2];
		cau_session_destroy(session);
		free(scene);
	}
	print_message("the same pull lifts the fascia by %.2f mm tied, by %.0f mm parted\n",
	              1e3 * lifted[0], 1e3 * lifted[1]);
	assert_true(lifted[0] < 0.01);
	assert_true(lifted[1] > 0.1);
}

// A pivot below its bound causes a whole new factor within the tick, after the columns of the
// contacts were computed. The step continues, and a snapshot of it gives the same bits.
static void a_new_factor_amid_contacts(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	session->update.least_pivot_bound = other->update.least_pivot_bound = INFINITY;
	int32_t made = 0;
	cau_error error = {0};
	bool exact;
	for (int tick = 0; tick < BUSY_TICKS / 2; tick++) {
		int32_t before = stage_frame(session).statistics.refactorisations;
		busy_run(session, 1);
		cau_statistics after = stage_frame(session).statistics;
		if (after.refactorisations == before || !after.contacts)
			continue;
		made++;
		stage_bytes shot = stage_snapshot(session);
		assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error),
		                 CAU_OK);
		free(shot.bytes);
		busy_run(session, 1);
		busy_run(other, 1);
		assert_true(cau_session_hash(session) == cau_session_hash(other));
	}
	assert_true(made > 3);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shares_are_counts_of_whole_edges),
		cmocka_unit_test(shares_equal_a_recount), // the recount changes the session's counters
		cmocka_unit_test(the_system_equals_a_reassembly),
		cmocka_unit_test(isolated_vertices_are_frozen),
		cmocka_unit_test(a_new_factor_amid_contacts),
		cmocka_unit_test(a_strip_falls_as_with_a_fresh_factor),
		cmocka_unit_test(a_grasped_strip_stays_held),
		cmocka_unit_test(burnt_out_of_the_jaws),
		cmocka_unit_test(links_part_and_fascia_comes_off),
	};
	return cmocka_run_group_tests(tests, make_busy, drop_busy);
}
