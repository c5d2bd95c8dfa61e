// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the step time over the number of elements. The slab grows in its plane from its own size
// to eight times as many cells. The exponent is fitted to the logarithms by least squares. The time
// of a size is the smallest median of several runs.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"

static void grow(cau_scene_def *scene, double side)
{
	for (int32_t i = 0; i < scene->mesh_count; ++i)
		for (int c = 0; c < 2; ++c) {
			scene->meshes[i].size_m[c] *= side;
			scene->meshes[i].cells[c] = (int32_t)(scene->meshes[i].cells[c] * side + 0.5);
		}
	for (int32_t i = 0; i < scene->pin_count; ++i)
		for (int c = 0; c < 2; ++c) {
			// the pinned ends move outwards with the slab
			double middle = (scene->pins[i].least_m[c] + scene->pins[i].most_m[c]) / 2;
			double half = (scene->pins[i].most_m[c] - scene->pins[i].least_m[c]) / 2;
			if (half > 1e-3)
				half *= side;
			scene->pins[i].least_m[c] = middle * side - half;
			scene->pins[i].most_m[c] = middle * side + half;
		}
}

static double median_step_ms(cau_session *session, int32_t steps)
{
	double *ms = calloc((size_t)steps, sizeof *ms);
	for (int32_t i = -10; i < steps; ++i) {
		bench_keep_awake(session);
		double start = bench_now_s();
		cau_session_step(session, NULL);
		if (i >= 0)
			ms[i] = 1e3 * (bench_now_s() - start);
	}
	double median = bench_quantile(ms, steps, 0.5);
	free(ms);
	return median;
}

static double slope(const bench_scaling_result *result)
{
	double sx = 0, sy = 0, sxx = 0, sxy = 0, n = result->count;
	for (int32_t i = 0; i < result->count; ++i) {
		double x = log(result->tetrahedra[i]), y = log(result->ms[i]);
		sx += x, sy += y, sxx += x * x, sxy += x * y;
	}
	return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

static int measure(const bench_options *options, int doubled, bench_scaling_result *result)
{
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	grow(scene, sqrt((double)(1 << doubled)));
	cau_session *session = bench_session(scene, options, options->threads);
	free(scene);
	if (!session)
		return 1;
	cau_session_info info;
	cau_session_describe(session, &info);
	result->tetrahedra[doubled] =
		info.tetrahedron_count ? info.tetrahedron_count : info.triangle_count;
	double ms = median_step_ms(session, options->steps < 40 ? options->steps : 40);
	if (result->ms[doubled] == 0 || ms < result->ms[doubled])
		result->ms[doubled] = ms;
	cau_session_destroy(session);
	return 0;
}

int bench_scaling(const bench_options *options, bench_scaling_result *result)
{
	memset(result, 0, sizeof *result);
	result->count = 4;
	// The sizes alternate, so that other load on the machine affects all sizes alike.
	for (int32_t r = 0; r < options->repeat; ++r)
		for (int doubled = 0; doubled < result->count; ++doubled)
			if (measure(options, doubled, result))
				return 1;
	result->exponent = slope(result);
	return 0;
}
