// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "cautery/scene_json.h"
#include "session/session_internal.h"

double bench_now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double bench_cpu_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double bench_quantile(double *values, int32_t count, double quantile)
{
	if (count <= 0)
		return 0;
	qsort(values, (size_t)count, sizeof *values, compare);
	int32_t at = (int32_t)(quantile * (count - 1) + 0.5);
	return values[at];
}

static char *read_file(const char *path, size_t *bytes)
{
	FILE *file = fopen(path, "rb");
	if (!file)
		return NULL;
	char *text = NULL;
	if (!fseek(file, 0, SEEK_END)) {
		long size = ftell(file);
		rewind(file);
		text = size >= 0 ? malloc((size_t)size + 1) : NULL;
		*bytes = text ? fread(text, 1, (size_t)size, file) : 0;
	}
	fclose(file);
	return text;
}

cau_scene_def *bench_scene_as_it_is(const bench_options *options)
{
	char path[512];
	if (strchr(options->scene, '/') || strchr(options->scene, '.'))
		snprintf(path, sizeof path, "%s", options->scene);
	else
		snprintf(path, sizeof path, "%s/%s.json", options->scenes_directory, options->scene);
	size_t bytes = 0;
	char *text = read_file(path, &bytes);
	cau_scene_def *scene = calloc(1, sizeof *scene);
	cau_error error = {0};
	if (!text || !scene || cau_scene_from_json(path, text, bytes, scene, &error)) {
		fprintf(stderr, "cautery-bench: %s: %s %s\n", path, error.path,
		        text ? error.reason : "cannot be read");
		free(scene);
		free(text);
		return NULL;
	}
	free(text);
	return scene;
}

cau_scene_def *bench_scene(const bench_options *options)
{
	cau_scene_def *scene = bench_scene_as_it_is(options);
	if (!scene)
		return NULL;
	scene->iterations = options->iterations;
	scene->accuracy = 0; // each step has exactly `iterations` iterations
	if (options->solver >= 0)
		scene->solver = options->solver;
	if (options->precision >= 0)
		scene->precision = options->precision;
	return scene;
}

// The last scene with prestress of which a session was made, and its state at rest. Coming to rest
// takes seconds. Another session of an equal scene starts from this state, with the same bits.
static struct {
	cau_scene_def *scene;
	void *shot;
	size_t bytes;
} at_rest;

static bool rest_is_known(const cau_scene_def *scene)
{
	return at_rest.shot && memcmp(at_rest.scene, scene, sizeof *scene) == 0;
}

static cau_status keep_rest(const cau_scene_def *scene, cau_session *session, cau_error *error)
{
	free(at_rest.scene);
	free(at_rest.shot);
	size_t most = cau_session_snapshot_bytes(session);
	at_rest.scene = malloc(sizeof *scene);
	at_rest.shot = malloc(most);
	if (!at_rest.scene || !at_rest.shot)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a snapshot");
	memcpy(at_rest.scene, scene, sizeof *scene);
	return cau_session_snapshot(session, at_rest.shot, most, &at_rest.bytes, error);
}

cau_session *bench_session(const cau_scene_def *scene, const bench_options *options,
                           int32_t threads)
{
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	def.thread_count = threads;
	def.instruction_set = options->instruction_set;
	def.unsettled = rest_is_known(scene);
	cau_session *session = NULL;
	cau_error error = {0};
	cau_status status = cau_session_create(&def, &session, &error);
	if (!status && def.unsettled)
		status = cau_session_restore(session, at_rest.shot, at_rest.bytes, NULL, &error);
	else if (!status && cau_session_has_tension(session))
		status = keep_rest(scene, session, &error);
	if (!status)
		return session;
	fprintf(stderr, "cautery-bench: %s: %s %s\n", options->scene, error.path, error.reason);
	cau_session_destroy(session);
	return NULL;
}

void bench_submit(cau_session *session, const cau_command *command)
{
	cau_error error = {0};
	if (cau_session_submit(session, command, &error)) {
		fprintf(stderr, "cautery-bench: %s %s\n", error.path, error.reason);
		exit(1);
	}
}

void bench_keep_awake(cau_session *session)
{
	cau_command command;
	memset(&command, 0, sizeof command);
	command.kind = CAU_COMMAND_SET_GRAVITY;
	memcpy(command.as.gravity_m_s2, session->scene->gravity_m_s2, sizeof command.as.gravity_m_s2);
	bench_submit(session, &command);
}
