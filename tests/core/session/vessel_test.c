// SPDX-License-Identifier: GPL-3.0-or-later
// A blood vessel in a session (core/vessel). The vessel bleeds where it is cut, but not where jaws
// press it shut or a seal holds. Snapshots restore its state.
#include "core/session/stage.h"

#include "session/session_internal.h"

static const double sealed_m = -0.005, deep_m = -0.007, above_m = 0.04;
// Numbers of ticks for each action. Under sanitizers these tests use half as many cells along each
// axis, and skip tests that need fine cells.
enum {
	TRAVEL = 12, // ticks for a motion: twice those for 48 mm, the longest, at the tools' 0.5 m/s
	CLOSING = 40,
	OPENING = 20,  // ticks: the jaws open in a few, then the tissue springs back
	SEALING = 180, // largest number of ticks until the vessel is sealed
	HOLDING = 30,  // ticks after the vessel is sealed, in which the rest of the seal becomes strong
	CUTTING = CAU_TEST_SANITIZED ? 35 : 70
};

static cau_session *open_pedicle(int32_t threads)
{
	cau_scene_def *scene = stage_scene_light("pedicle");
	scene->iterations = 10; // a third of the scene's number: these tests need no exact motion
	cau_session *session = stage_open(scene, threads);
	free(scene);
	return session;
}

static const cau_vessel_state *artery(const cau_session *session)
{
	cau_frame frame = stage_frame(session);
	assert_int_equal(frame.vessel_count, 1);
	assert_string_equal(frame.vessels[0]->name, "artery");
	return frame.vessels[0];
}

static void put(cau_session *session, const char *tool, double x, double y, double z)
{
	cau_pose pose = stage_tool(session, tool)->asked_pose;
	pose.position_m[0] = x;
	pose.position_m[1] = y;
	pose.position_m[2] = z;
	stage_turn(session, tool, &pose);
}

static void close_forceps(cau_session *session)
{
	put(session, "forceps", sealed_m, 0, deep_m);
	stage_step(session, TRAVEL);
	stage_grasp(session, "forceps");
	stage_step(session, CLOSING);
}

static void withdraw_forceps(cau_session *session)
{
	stage_energize(session, "forceps", 0);
	stage_release(session, "forceps");
	stage_step(session, OPENING);
	put(session, "forceps", sealed_m, 0, above_m);
	stage_step(session, TRAVEL);
}

static void seal(cau_session *session)
{
	close_forceps(session);
	stage_energize(session, "forceps", 1);
	int ticks = 0;
	for (; ticks < SEALING - HOLDING && !(artery(session)->flags & CAU_VESSEL_SEALED); ticks++)
		stage_step(session, 1);
	stage_step(session, HOLDING);
	withdraw_forceps(session);
}

// Draws the energized needle across the strip, which is 4 mm wide.
static void divide(cau_session *session, double x)
{
	put(session, "needle", x, -0.008, above_m);
	stage_step(session, TRAVEL);
	put(session, "needle", x, -0.008, deep_m);
	stage_step(session, TRAVEL);
	stage_energize(session, "needle", 1);
	for (int k = 0; k < CUTTING; k++) {
		put(session, "needle", x, -0.0035 + 0.007 * k / CUTTING, deep_m);
		stage_step(session, 1);
	}
	stage_energize(session, "needle", 0);
	stage_step(session, 1);
}

static double blood_m3(const cau_session *session)
{
	double sum = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		sum += session->vessels->blood.volume_m3[v];
	return sum;
}

// Sessions that several tests use: a session whose vessel was cut, with a snapshot of its
// beginning, and a session whose vessel was sealed. Tests that change a session run after the tests
// that only read it.
static struct {
	cau_session *cut, *sealed;
	stage_bytes beginning;
	uint64_t sealed_hash;
} made;

static int make_sessions(void **state)
{
	(void)state;
	made.cut = open_pedicle(1);
	made.beginning = stage_snapshot(made.cut);
	divide(made.cut, sealed_m);
	made.sealed = open_pedicle(1);
	seal(made.sealed);
	made.sealed_hash = cau_session_hash(made.sealed);
	return 0;
}

static int drop_sessions(void **state)
{
	(void)state;
	free(made.beginning.bytes);
	cau_session_destroy(made.cut);
	cau_session_destroy(made.sealed);
	return 0;
}

static void what_is_whole_does_not_bleed(void **state)
{
	(void)state;
	cau_session *session = open_pedicle(1);
	stage_step(session, 10);
	assert_int_equal(artery(session)->flags, 0);
	assert_true(artery(session)->bleeding_m3_s == 0 && artery(session)->burst_pa == 0);
	assert_true(artery(session)->point_count > 10);
	// The drawn line reaches from end to end of the strip.
	const cau_vessel_state *vessel = artery(session);
	assert_true(fabs((double)vessel->point[0].position_m[0] + 0.02) < 1e-6);
	assert_true(fabs((double)vessel->point[vessel->point_count - 1].position_m[0] - 0.02) < 1e-6);
	cau_session_destroy(session);
}

// Both stumps bleed: the stump with 12 kPa more than the stump with 4 kPa. The blood on the tissue
// is at most the blood that was shed.
static void what_is_cut_bleeds_from_both_stumps(void **state)
{
	(void)state;
	cau_session *session = made.cut;
	const cau_vessel_state *vessel = artery(session);
	const cau_vessel_def *def = &session->scene->vessels[0];
	assert_int_equal(vessel->flags & (CAU_VESSEL_CUT | CAU_VESSEL_BLEEDS | CAU_VESSEL_SEALED),
	                 CAU_VESSEL_CUT | CAU_VESSEL_BLEEDS);
	double most = cau_vessel_outflow(def, 12000, 1) + cau_vessel_outflow(def, 4000, 1);
	assert_true(vessel->bleeding_m3_s > 0.7 * most && vessel->bleeding_m3_s <= most);
	assert_true(vessel->shed_m3 > 0);
	assert_true(blood_m3(session) > 0 && blood_m3(session) <= vessel->shed_m3 * (1 + 1e-9));
	bool parted = false;
	for (int32_t i = 0; i < vessel->point_count; i++)
		parted |= vessel->point[i].open < 0;
	assert_true(parted);
	cau_session_watch(session, CAU_CHANNEL_BLOOD);
	float deepest = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		deepest = fmaxf(deepest, stage_frame(session).blood[v]);
	assert_true(deepest > 5e-5F);
}

// Jaws stop the flow while they press. Without heat the flow returns afterwards.
static void pressure_stops_bleeding_and_heals_nothing(void **state)
{
	(void)state;
	cau_session *session = open_pedicle(1);
	divide(session, 0.004);
	double free_m3_s = artery(session)->bleeding_m3_s;
	close_forceps(session); // the forceps close on the first end's side of the cut
	const cau_vessel_state *vessel = artery(session);
	assert_true(vessel->flags & CAU_VESSEL_SHUT);
	// The other stump still bleeds, with the 4 kPa of its end.
	double other = cau_vessel_outflow(&session->scene->vessels[0], 4000, 1);
	assert_true(vessel->bleeding_m3_s <= other && vessel->bleeding_m3_s < 0.5 * free_m3_s);
	withdraw_forceps(session);
	assert_true(artery(session)->bleeding_m3_s > 0.9 * free_m3_s);
	assert_int_equal(artery(session)->flags & CAU_VESSEL_SEALED, 0);
	cau_session_destroy(session);
}

static void what_is_sealed_is_divided_without_blood(void **state)
{
	(void)state;
	cau_session *session = made.sealed;
	const cau_vessel_state *vessel = artery(session);
	assert_int_equal(vessel->flags & (CAU_VESSEL_SEALED | CAU_VESSEL_CUT), CAU_VESSEL_SEALED);
	assert_true(vessel->burst_pa > 12000);
	if (!CAU_TEST_SANITIZED) {
		divide(session, sealed_m);
		vessel = artery(session);
		assert_int_equal(vessel->flags & (CAU_VESSEL_SEALED | CAU_VESSEL_CUT | CAU_VESSEL_BLEEDS),
		                 CAU_VESSEL_SEALED | CAU_VESSEL_CUT);
		assert_true(vessel->shed_m3 == 0 && blood_m3(session) == 0);
	}
}

// Heat without compression denatures the wall, but does not seal it.
static void heat_alone_seals_nothing(void **state)
{
	(void)state;
	cau_session *session = open_pedicle(1);
	cau_bioheat *bioheat = &session->heat.cells->bioheat;
	int32_t tetrahedra = session->tissue.tetrahedron_count;
	for (int32_t t = 0; t < tetrahedra && bioheat->cells.count < 20000; t++)
		cau_tissue_cells_fill(
			session->heat.cells,
			cau_tissue_cells_element(&session->tissue, CAU_PRIMITIVE_TETRAHEDRON, t));
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		bioheat->temperature[i] = 95;
	bioheat->cold = false;
	stage_step(session, 60);
	assert_true(session->vessels->open[session->vessels->station_count / 2] > 0.9);
	assert_true(artery(session)->burst_pa == 0);
	cau_session_destroy(session);
}

static void threads_and_a_restore_change_no_bit(void **state)
{
	(void)state;
	cau_session *session = made.cut, *threaded = open_pedicle(2);
	divide(threaded, sealed_m);
	assert_true(cau_session_hash(session) == cau_session_hash(threaded));
	stage_bytes bytes = stage_snapshot(session);
	cau_session *restored = open_pedicle(1);
	bool exact = false;
	assert_int_equal(cau_session_restore(restored, bytes.bytes, bytes.count, &exact, NULL), CAU_OK);
	assert_true(exact);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	const cau_vessel_state *before = artery(session), *after = artery(restored);
	assert_true(after->shed_m3 == before->shed_m3);
	assert_true(after->bleeding_m3_s == before->bleeding_m3_s && after->bleeding_m3_s > 0);
	assert_int_equal(after->flags, before->flags);
	stage_step(session, 30);
	stage_step(restored, 30);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	assert_true(artery(restored)->shed_m3 == artery(session)->shed_m3);
	free(bytes.bytes);
	cau_session_destroy(threaded);
	cau_session_destroy(restored);
}

// The session with the cut vessel is restored to its beginning. Then it continues like a fresh
// session.
static void a_rewind_leaves_nothing_behind(void **state)
{
	(void)state;
	cau_session *session = made.cut;
	assert_true(artery(session)->flags & CAU_VESSEL_BLEEDS);
	assert_int_equal(
		cau_session_restore(session, made.beginning.bytes, made.beginning.count, NULL, NULL),
		CAU_OK);
	assert_int_equal(artery(session)->flags, 0);
	assert_true(blood_m3(session) == 0);
	seal(session);
	assert_true(cau_session_hash(session) == made.sealed_hash);
	assert_int_equal(artery(session)->flags, CAU_VESSEL_SEALED);
	// Clients see the seal after the jaws have opened.
	float least = 1;
	for (int32_t i = 0; i < artery(session)->point_count; i++)
		least = fminf(least, artery(session)->point[i].open);
	assert_true(least == 0);
}

static void refuse_with(void (*spoil)(cau_vessel_def *vessel), cau_status status, const char *word)
{
	cau_scene_def *scene = stage_scene_named("pedicle");
	cau_error error = {0};
	spoil(&scene->vessels[0]);
	stage_refuse(scene, status, &error);
	if (!strstr(error.reason, word) && !strstr(error.path, word))
		fail_msg("\"%s\" (%s) lacks \"%s\"", error.reason, error.path, word);
	free(scene);
}

static void leave_the_layer(cau_vessel_def *vessel)
{
	vessel->points_m[1][2] = 0.01;
}
static void have_no_lumen(cau_vessel_def *vessel)
{
	vessel->wall_m = vessel->radius_m;
}
static void be_of_another_layer(cau_vessel_def *vessel)
{
	strcpy(vessel->layer, "fascia");
}
static void have_one_point(cau_vessel_def *vessel)
{
	vessel->point_count = 1;
}
static void have_no_length(cau_vessel_def *vessel)
{
	memcpy(vessel->points_m[1], vessel->points_m[0], sizeof vessel->points_m[0]);
}
static void have_no_number(cau_vessel_def *vessel)
{
	vessel->points_m[0][1] = NAN;
}

static void wrong_vessels_are_refused(void **state)
{
	(void)state;
	refuse_with(leave_the_layer, CAU_BAD_VALUE, "leaves");
	refuse_with(have_no_lumen, CAU_BAD_VALUE, "lumen");
	refuse_with(be_of_another_layer, CAU_NOT_FOUND, "fascia");
	refuse_with(have_one_point, CAU_BAD_VALUE, "points");
	refuse_with(have_no_length, CAU_BAD_VALUE, "the same position");
	refuse_with(have_no_number, CAU_BAD_VALUE, "points");
	cau_scene_def *scene = stage_scene_named("pedicle");
	cau_error error = {0};
	scene->energy = CAU_ENERGY_PAPER;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_non_null(strstr(error.reason, "energy"));
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_whole_does_not_bleed),
		cmocka_unit_test(what_is_cut_bleeds_from_both_stumps),
		cmocka_unit_test(pressure_stops_bleeding_and_heals_nothing),
		cmocka_unit_test(what_is_sealed_is_divided_without_blood),
		cmocka_unit_test(heat_alone_seals_nothing),
		cmocka_unit_test(threads_and_a_restore_change_no_bit),
		cmocka_unit_test(a_rewind_leaves_nothing_behind),
		cmocka_unit_test(wrong_vessels_are_refused),
	};
	return cmocka_run_group_tests(tests, make_sessions, drop_sessions);
}
