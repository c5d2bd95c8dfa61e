// SPDX-License-Identifier: GPL-3.0-or-later
#include "clients/haptics/loop.h"

#include <time.h>

#include "clients/haptics/hand.h"

enum { PENDING = 16 }; // largest number of records that are on the link
static const double tick_s = 1.0 / 60, period_s = 0.001;
// Time from a tick until its record is on the link, s: the duration of a step of `fat` on two
// cores.
static const double compute_s = 0.005;

cau_scene_def *loop_scene(double young_modulus_pa)
{
	cau_scene_def *scene = stage_scene_named("fat");
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (scene->layers[i].kind == CAU_LAYER_FAT)
			scene->layers[i].fat[0].young_modulus_pa = young_modulus_pa;
	return scene;
}

typedef struct closed_loop {
	cau_session *session;
	cau_pose turned; // pose with the rotation of the tool; the position is set before each use
	cau_haptics *haptics;
	simulated_hand hand;
	int ticks, sent, taken; // numbers of finished ticks, sent records and taken records
	cau_tool_contact record[PENDING];
	double arrives_s[PENDING];
	double spent_s; // processor time of all ticks
} closed_loop;

static double clock_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// Computes a tick. It uses the device's position that was sent one link delay before.
static void tick(closed_loop *loop, const loop_def *def, const loop_log *log)
{
	double time_s = ++loop->ticks * tick_s, sent_s = fmax(time_s - def->delay_s, 0);
	int at = (int)(sent_s / period_s);
	at = at < log->count ? at : log->count - 1;
	cau_pose pose = loop->turned;
	memcpy(pose.position_m, log->place_m[at], sizeof pose.position_m);
	stage_turn(loop->session, "ball", &pose);
	double start = clock_s();
	stage_step(loop->session, 1);
	loop->spent_s += clock_s() - start;
	cau_frame frame = stage_frame(loop->session);
	assert_non_null(frame.contacts);
	loop->record[loop->sent % PENDING] = frame.contacts[0];
	loop->arrives_s[loop->sent++ % PENDING] = time_s + compute_s + def->delay_s;
	assert_true(loop->sent - loop->taken <= PENDING);
}

static void render(closed_loop *loop, loop_log *log, int step)
{
	double time_s = step * period_s, jump[3];
	while (loop->taken < loop->sent && loop->arrives_s[loop->taken % PENDING] <= time_s)
		cau_haptics_take(loop->haptics, &loop->record[loop->taken++ % PENDING]);
	cau_haptics_device device = {.pose = loop->turned};
	memcpy(device.pose.position_m, loop->hand.place_m, sizeof loop->hand.place_m);
	memcpy(device.velocity_m_s, loop->hand.velocity_m_s, sizeof loop->hand.velocity_m_s);
	cau_haptics_render(loop->haptics, &device, time_s, log->force_n[step]);
	cau_haptics_report report;
	cau_haptics_describe(loop->haptics, &report);
	log->limited += report.limited;
	for (int i = 0; i < 3; i++)
		jump[i] = log->force_n[step][i] - (step ? log->force_n[step - 1][i] : 0);
	log->most_jump_n = fmax(log->most_jump_n, cau_length(cau_vec3_of(jump)));
	log->most_given_j = fmax(log->most_given_j, loop->hand.given_j);
}

loop_log loop_run(const loop_def *def)
{
	int steps = (int)(def->seconds / period_s);
	size_t bytes = (size_t)steps * sizeof(double[3]);
	loop_log log = {.place_m = malloc(bytes), .force_n = malloc(bytes), .wanted_m = malloc(bytes)};
	assert_true(log.place_m && log.force_n && log.wanted_m);
	cau_scene_def *scene = loop_scene(def->young_modulus_pa);
	closed_loop loop = {.session = stage_open(scene, 1), .turned = scene->tools[0].pose};
	free(scene);
	cau_session_watch(loop.session, CAU_CHANNEL_TOOL_CONTACT);
	cau_haptics_def haptics = cau_default_haptics_def();
	cau_error error;
	assert_int_equal(cau_haptics_create(&haptics, &loop.haptics, &error), CAU_OK);
	def->lead(def, 0, loop.hand.wanted_m);
	memcpy(loop.hand.place_m, loop.hand.wanted_m, sizeof loop.hand.place_m);
	for (int step = 0; step < steps; step++) {
		double time_s = step * period_s;
		memcpy(log.place_m[step], loop.hand.place_m, sizeof loop.hand.place_m);
		log.count = step + 1;
		if (time_s >= (loop.ticks + 1) * tick_s)
			tick(&loop, def, &log);
		render(&loop, &log, step);
		def->lead(def, time_s, loop.hand.wanted_m);
		memcpy(log.wanted_m[step], loop.hand.wanted_m, sizeof loop.hand.wanted_m);
		hand_move(&loop.hand, log.force_n[step]);
	}
	log.tick_s = loop.spent_s / loop.ticks;
	cau_haptics_destroy(loop.haptics);
	cau_session_destroy(loop.session);
	return log;
}

void loop_finish(loop_log *log)
{
	free(log->place_m);
	free(log->force_n);
	free(log->wanted_m);
}

double (*loop_reference(const loop_def *def, const loop_log *log, double step_s))[3]
{
	double(*force_n)[3] = calloc((size_t)log->count, sizeof *force_n), now_n[3] = {0};
	cau_scene_def *scene = loop_scene(def->young_modulus_pa);
	scene->step_s = step_s;
	cau_session *session = stage_open(scene, 1);
	cau_pose pose = scene->tools[0].pose;
	assert_non_null(force_n);
	free(scene);
	int ticks = 0;
	for (int step = 0; step < log->count; step++) {
		if (step * period_s >= (ticks + 1) * step_s - 1e-9) {
			memcpy(pose.position_m, log->place_m[step], sizeof pose.position_m);
			stage_turn(session, "ball", &pose);
			stage_step(session, 1);
			ticks++;
			memcpy(now_n, stage_tool(session, "ball")->raw_force_n, sizeof now_n);
		}
		memcpy(force_n[step], now_n, sizeof now_n);
	}
	cau_session_destroy(session);
	return force_n;
}
