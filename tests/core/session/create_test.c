// SPDX-License-Identifier: GPL-3.0-or-later
// Creation of a session in stages. The counts at each border are right. A refusal at any border
// leaves no memory behind. A session that another thread takes over during a cut keeps its bits. So
// does a session that begins with a snapshot.
#include "core/session/busy_scene.h"

#include <pthread.h>

#include "session/session_internal.h"

// Reports of a session's creation at its borders, and the border at which it must stop.
typedef struct borders {
	int stop_at; // a CAU_BUILD_* to refuse, or -1
	cau_status refusal;
	int count;
	cau_build_border seen[CAU_BUILD_STAGE_COUNT];
} borders;

static cau_status note_border(void *user, const cau_build_border *border, cau_error *error)
{
	borders *noted = user;
	assert_true(noted->count < CAU_BUILD_STAGE_COUNT);
	noted->seen[noted->count++] = *border;
	if ((int)border->next != noted->stop_at)
		return CAU_OK;
	return cau_fail(error, noted->refusal, "scene", "no further than stage %d", noted->stop_at);
}

static cau_status create(const cau_scene_def *scene, int threads, borders *noted,
                         cau_session **session, cau_error *error)
{
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	def.thread_count = threads;
	def.border = note_border;
	def.user = noted;
	return cau_session_create(&def, session, error);
}

static void borders_come_in_order_and_know_ever_more(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	borders noted = {.stop_at = -1};
	cau_session *session = NULL;
	cau_error error = {0};
	assert_int_equal(create(scene, 1, &noted, &session, &error), CAU_OK);
	cau_session_info info = stage_info(session);
	assert_int_equal(noted.count, CAU_BUILD_STAGE_COUNT);
	for (int k = 0; k < noted.count; k++) {
		const cau_build_border *border = &noted.seen[k];
		assert_int_equal(border->next, k);
		// Meshes are generated here, so their vertices are known before the meshes exist.
		assert_int_equal(border->vertex_count, info.vertex_count);
		assert_true(border->bytes > 0);
		assert_int_equal(border->factor_entries > 0, k >= CAU_BUILD_FACTOR);
		if (k >= CAU_BUILD_ORDER)
			assert_int_equal(border->element_count, info.triangle_count + info.tetrahedron_count +
			                                            info.link_count + info.hinge_count);
	}
	assert_true(noted.seen[CAU_BUILD_MESH].element_count > 0);
	cau_session_destroy(session);
	free(scene);
}

// The estimate at a border includes the memory that a step allocates later.
static void newtons_room_is_asked_for(void **state)
{
	(void)state;
	cau_build_border last[2];
	for (int newton = 0; newton <= 1; newton++) {
		cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
		stage_add_taut_sheet(scene);
		scene->solver = newton ? CAU_SOLVER_NEWTON : CAU_SOLVER_CHOLESKY;
		borders noted = {.stop_at = -1};
		cau_session *session = NULL;
		cau_error error = {0};
		assert_int_equal(create(scene, 1, &noted, &session, &error), CAU_OK);
		last[newton] = noted.seen[CAU_BUILD_FACTOR];
		cau_session_destroy(session);
		free(scene);
	}
	assert_int_equal(last[0].factor_entries, last[1].factor_entries);
	assert_true(last[1].bytes >= last[0].bytes + 96 * (size_t)last[1].factor_entries);
}

// Tested with and without helper threads. The address sanitizer finds memory that is left behind.
static void a_refusal_at_any_border_leaves_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	for (int threads = 1; threads <= 2; threads++)
		for (int stage = 0; stage < CAU_BUILD_STAGE_COUNT; stage++) {
			borders noted = {.stop_at = stage, .refusal = CAU_LIMIT};
			cau_session *session = NULL;
			cau_error error = {0};
			assert_int_equal(create(scene, threads, &noted, &session, &error), CAU_LIMIT);
			assert_null(session);
			assert_int_equal(noted.count, stage + 1); // no border follows the refused one
			assert_int_equal(error.status, CAU_LIMIT);
			assert_string_equal(error.path, "scene");
		}
	free(scene);
}

// ---- a session taken over by another thread
enum { TICKS = 60 };

static void hash_run(cau_session *session, int from, int to, uint64_t *hash)
{
	for (int tick = from; tick < to; tick++) {
		busy_run(session, 1);
		hash[tick] = cau_session_hash(session);
	}
}

typedef struct takeover {
	cau_session *session;
	int from, to;
	uint64_t *hash;
	bool in_the_making; // a factor was being computed at the takeover
} takeover;

// The thread that takes the session over creates its helpers, and steps the session from then on.
static void *take_over(void *context)
{
	takeover *work = context;
	cau_error error = {0};
	work->in_the_making = work->session->update.making;
	assert_int_equal(cau_session_adopt(work->session, &error), CAU_OK);
	hash_run(work->session, work->from, work->to, work->hash);
	return NULL;
}

static void hand_over(takeover *work)
{
	pthread_t thread;
	assert_int_equal(pthread_create(&thread, NULL, take_over, work), 0);
	assert_int_equal(pthread_join(thread, NULL), 0);
}

// Another thread takes the session over at every tenth tick, and at every tick in which a factor is
// being computed in the background.
static void a_session_taken_over_mid_cut_keeps_its_bits(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	uint64_t alone[TICKS], handed[TICKS];
	cau_session *session = stage_open(scene, 1);
	hash_run(session, 0, TICKS, alone);
	assert_true(stage_frame(session).statistics.elements_removed > 100);
	cau_session_destroy(session);
	for (int threads = 1; threads <= 2; threads++) {
		session = stage_open(scene, threads);
		int while_making = 0;
		for (int tick = 0; tick < TICKS; tick++) {
			takeover work = {session, tick, tick + 1, handed, false};
			if (tick % 10 == 5 || session->update.making)
				hand_over(&work);
			else
				hash_run(session, tick, tick + 1, handed);
			while_making += work.in_the_making;
		}
		assert_true(while_making > 0);
		assert_memory_equal(handed, alone, sizeof alone);
		cau_session_destroy(session);
	}
	free(scene);
}

// ---- sessions that begin with a snapshot
static cau_session *open_unsettled(const cau_scene_def *scene)
{
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	def.unsettled = true;
	cau_session *session = NULL;
	cau_error error = {0};
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_OK);
	return session;
}

static void expect_restored(cau_session *session, stage_bytes shot)
{
	bool exact = false;
	cau_error error = {0};
	assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, &exact, &error), CAU_OK);
	assert_true(exact);
}

// Cuts with an energized hook in the middle of the tissue.
static uint64_t hash_of_burning(cau_session *session, int ticks)
{
	const cau_cut_def *cut = &session->scene->cut;
	const cau_pose from = stage_tool(session, cut->tool)->pose;
	for (int tick = 0; tick < ticks; tick++) {
		stage_cut_tick(session, cut, &from, tick);
		stage_step(session, 1);
	}
	return cau_session_hash(session);
}

static void what_begins_with_a_snapshot_need_not_settle(void **state)
{
	(void)state;
	static const char *const scenes[] = {"fascia", "layers"};
	for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
		cau_scene_def *scene = stage_scene_light(scenes[k]);
		cau_session *settled = stage_open(scene, 1), *begun = open_unsettled(scene);
		stage_bytes first = stage_snapshot(settled);
		cau_error error = {0};
		assert_int_equal(cau_session_step(begun, &error), CAU_FAULTED);
		// the session without a restore lacks its built-in tension
		assert_true(cau_session_hash(begun) != cau_session_hash(settled));
		expect_restored(begun, first);
		assert_int_equal(cau_session_hash(begun), cau_session_hash(settled));
		uint64_t reached = hash_of_burning(settled, 100);
		assert_int_equal(hash_of_burning(begun, 100), reached);
		// A session can also begin with the later state of the other session.
		stage_bytes later = stage_snapshot(settled);
		cau_session *joined = open_unsettled(scene);
		expect_restored(joined, later);
		stage_step(settled, 20);
		stage_step(joined, 20);
		assert_int_equal(cau_session_hash(joined), cau_session_hash(settled));
		cau_session_destroy(joined);
		cau_session_destroy(begun);
		cau_session_destroy(settled);
		free(later.bytes);
		free(first.bytes);
		free(scene);
	}
}

// A mesh file may give an element another material and be otherwise equal.
static void tissue_is_known_by_its_materials_too(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1), *same = stage_open(scene, 1);
	cau_tissue *tissue = &session->tissue;
	uint64_t hash = cau_session_tissue_hash(session);
	assert_int_equal(cau_session_tissue_hash(same), hash);
	tissue->tetrahedron_material[tissue->tetrahedron_count - 1]++;
	assert_true(cau_session_tissue_hash(session) != hash);
	tissue->tetrahedron_material[tissue->tetrahedron_count - 1]--;
	assert_int_equal(cau_session_tissue_hash(session), hash);
	tissue->triangle_material[0]++;
	assert_true(cau_session_tissue_hash(session) != hash);
	cau_session_destroy(same);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(borders_come_in_order_and_know_ever_more),
		cmocka_unit_test(newtons_room_is_asked_for),
		cmocka_unit_test(a_refusal_at_any_border_leaves_nothing),
		cmocka_unit_test(a_session_taken_over_mid_cut_keeps_its_bits),
		cmocka_unit_test(what_begins_with_a_snapshot_need_not_settle),
		cmocka_unit_test(tissue_is_known_by_its_materials_too),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
