// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <unistd.h>

#include "bench/bench.h"
#include "bench/machine.h"

static void print_steps(const bench_options *options, const bench_steps_result *result)
{
	static const char *const stages[] = {
#define X(code, name) name,
		CAU_STAGE_TABLE(X)
#undef X
	};
	const bench_timing *t = &result->timing;
	if (!options->json) {
		printf("%s: %d vertices, %d tetrahedra, %d triangles, T=%d K=%d\n", options->scene,
		       result->vertices, result->tetrahedra, result->triangles, options->threads,
		       options->iterations);
		printf("  %.1f steps/s, median %.3f ms, p99 %.3f ms, %.2f x K cholmod_solve2 (%.3f ms)\n",
		       t->steps_per_s, t->median_ms, t->p99_ms, result->frame_over_cholmod,
		       result->cholmod_ms);
		for (int s = 0; s < CAU_STAGE_COUNT; ++s)
			printf("  %-8s %.3f ms\n", stages[s], t->stage_ms[s]);
		return;
	}
	printf("\"steps_per_s\":%.6g,\"ms_median\":%.6g,\"ms_p99\":%.6g,\"stages\":{", t->steps_per_s,
	       t->median_ms, t->p99_ms);
	for (int s = 0; s < CAU_STAGE_COUNT; ++s)
		printf("%s\"%s\":%.6g", s ? "," : "", stages[s], t->stage_ms[s]);
	printf(
		"},\"frame_over_cholmod\":%.6g,\"cholmod_ms\":%.6g,\"allocations_per_step\":%.6g,"
		"\"bytes_session\":%.0f,\"contacts\":%d,\"vertices\":%d,\"tetrahedra\":%d,\"triangles\":%d,"
		"\"hash\":\"%016llx\"",
		result->frame_over_cholmod, result->cholmod_ms, result->allocations_per_step,
		result->bytes_session, result->contacts, result->vertices, result->tetrahedra,
		result->triangles, (unsigned long long)result->hash);
}

static void print_cut(const bench_options *options, const bench_cut_result *result)
{
	printf(options->json ? "\"plain_ms\":%.6g,\"plain_p99_ms\":%.6g,\"cut_p99_ms\":%.6g,\"cut_p99_"
	                       "over_plain\":%.6g,"
	                       "\"elements_removed\":%d,\"cutting_steps\":%d,\"refactorisations\":%d,"
	                       "\"deferred_max_s\":%.6g"
	                     : "  plain %.3f ms (p99 %.3f), cutting p99 %.3f ms, ratio %.2f; %d "
	                       "elements removed in %d "
	                       "cutting steps, %d factorisations, longest wait %.4f s\n",
	       result->plain_median_ms, result->plain_p99_ms, result->cut_p99_ms,
	       result->cut_p99_over_plain, result->elements_removed, result->cutting_steps,
	       result->refactorisations, result->deferred_max_s);
}

static void print_error(const bench_options *options, const bench_error_result *result)
{
	printf(options->json ? "\"error_at_K\":%.6g,\"error_max\":%.6g,\"iterations_to_1pct\":%d,"
	                       "\"ms_to_1pct\":%.6g,\"reference_residual\":%.3g"
	                     : "  error %.4g at K (worst %.4g); %d iterations, %.3f ms to 1 %%; the "
	                       "reference's residual is %.2g\n",
	       result->error_at_k, result->error_max, result->iterations_to_1pct, result->ms_to_1pct,
	       result->reference_residual);
	if (options->json)
		fputs(",\"error_curve\":[", stdout);
	for (int i = 0; i < BENCH_CURVE; ++i)
		printf(options->json ? "%s{\"iterations\":%d,\"error\":%.6g,\"ms\":%.6g}"
		                     : "%s  %3d iterations: error %.4g, %.3f ms",
		       i ? options->json ? "," : "\n" : "", result->curve_iterations[i],
		       result->curve_error[i], result->curve_ms[i]);
	fputs(options->json ? "]" : "\n", stdout);
}

static void print_accuracy(const bench_options *options, const bench_accuracy_result *result)
{
	printf(options->json ? "\"speedup_over_k\":%.6g,\"iterations_mean\":%.6g"
	                     : "  %.2f times the steps of K iterations, %.2f iterations",
	       result->speedup_over_k, result->iterations_mean);
	if (options->rest)
		printf(options->json ? ",\"rest_core_share\":%.3g"
		                     : ", at rest and awake; a session that rests takes %.2g of a core\n",
		       result->rest_core_share);
	else
		printf(options->json ? ",\"error_p95\":%.6g" : ", error p95 %.4g\n", result->error_p95);
}

static void print_along(const bench_options *options, const bench_along_result *r)
{
	printf(options->json
	           ? "\"along\":{\"steps\":%d,\"above\":%.6g,\"reported_p50\":%.6g,\"reported_"
	             "p95\":%.6g,\"sampled\":%d,\"true_p50\":%.6g,\"true_p95\":%.6g,\"true_"
	             "most\":%.6g,\"optimistic\":%.6g,\"iterations_mean\":%.6g,\"ms_median\":%.6g,"
	             "\"ms_p99\":%.6g,\"elements_removed\":%d}"
	           : "  along the cut, %d steps: reported error above the wanted one in %.3g of "
	             "them, p50 %.4g, p95 %.4g; %d computed again: true error p50 %.4g, p95 %.4g, "
	             "most %.4g, above 3 x the reported in %.3g; %.2f iterations, CPU median %.3f "
	             "ms, p99 %.3f ms; %d elements removed\n",
	       r->steps, r->above, r->reported_p50, r->reported_p95, r->sampled, r->true_p50,
	       r->true_p95, r->true_most, r->optimistic, r->iterations_mean, r->ms_median, r->ms_p99,
	       r->elements_removed);
}

static void print_limit(const bench_options *options, const bench_limit_result *result)
{
	printf(options->json ? "\"bytes_step\":%.0f,\"bandwidth_b_s\":%.4g,\"limit_ms\":%.6g"
	                     : "  moves %.0f bytes a step; at %.3g B/s a core: %.3f ms\n",
	       result->bytes_step, result->bandwidth_b_s, result->limit_ms);
}

static void print_scaling(const bench_options *options, const bench_scaling_result *result)
{
	printf(options->json ? "\"scaling_exponent\":%.6g,\"scaling\":[" : "  exponent %.3f:",
	       result->exponent);
	for (int32_t i = 0; i < result->count; ++i)
		printf(options->json ? "%s{\"elements\":%d,\"ms\":%.6g}" : "%s %d: %.3f ms", i ? "," : "",
		       result->tetrahedra[i], result->ms[i]);
	printf(options->json ? "]" : "\n");
}

static void print_update(const bench_options *options, const bench_update_result *result)
{
	if (options->json)
		printf("\"update\":[");
	for (int i = 0; i < BENCH_UPDATES; i++) {
		const bench_update_row *row = &result->row[i];
		printf(options->json ? "%s{\"elements\":%d,\"downdate_ms\":%.6g,\"refactor_ms\":%.6g,"
		                       "\"anew_ms\":%.6g}"
		                     : "%s  %3d elements: downdates %.3f ms, numbers anew %.3f ms, order, "
		                       "pattern and numbers anew %.3f ms\n",
		       i && options->json ? "," : "", row->elements, row->downdate_ms, row->refactor_ms,
		       row->anew_ms);
	}
	if (options->json)
		putchar(']');
}

static void print_remesh(const bench_options *options, const bench_remesh_result *r)
{
	printf(options->json ? "\"remesh\":{\"vertices\":%d,\"elements\":%d,\"changes\":%d,"
	                       "\"vertices_added\":%d,\"elements_added\":%d,\"ill_shaped\":%d,"
	                       "\"inserts\":%lld,\"deletes\":%lld,"
	                     : "  re-meshed: %d vertices and %d elements, changed in %d ticks: %d "
	                       "vertices and %d elements more, %d ill-shaped, %lld inserts, %lld "
	                       "deletes\n",
	       r->vertices, r->elements, r->changes, r->vertices_added, r->elements_added,
	       r->ill_shaped, (long long)r->inserts, (long long)r->deletes);
	printf(options->json
	           ? "\"remesh_s\":%.6g,\"assemble_s\":%.6g,\"factor_s\":%.6g,"
	             "\"buffer_bytes\":%.0f,\"system_bytes\":%.0f,"
	           : "  %.4f s of re-meshing, %.4f s of assembly, %.4f s of factors, %.0f bytes "
	             "of buffers, %.0f of systems\n",
	       r->remesh_s, r->assemble_s, r->factor_s, r->buffer_bytes, r->system_bytes);
	printf(options->json ? "\"our_changes\":%d,\"edges_parted\":%d,\"elements_removed\":%d,"
	                       "\"refactorisations\":%d,\"our_mask_bytes\":%.0f,\"our_s\":%.6g}"
	                     : "  ours: changed in %d ticks, %d edges parted, %d elements removed, %d "
	                       "factorisations, %.0f bytes of masks, %.4f s\n",
	       r->our_changes, r->edges_parted, r->elements_removed, r->refactorisations,
	       r->our_mask_bytes, r->our_s);
}

static void print_classroom(const bench_options *options, const bench_classroom_result *result)
{
	printf(options->json ? "\"sessions\":%d,\"driven\":%d,\"workers\":%d,"
	                       "\"realtime_factor_min\":%.6g,\"bytes_session_further\":%.0f,"
	                       "\"cores\":%.4g,\"class_elements_removed\":%d"
	                     : "  %d sessions, %d driven, %d workers: %.4f of real time at least, %.0f "
	                       "bytes each after the first, %.2f cores, %d elements removed\n",
	       options->sessions, options->driven, options->workers, result->realtime_factor_min,
	       result->bytes_session_further, result->cores, result->elements_removed);
}

static void print_machine(const bench_options *options, const bench_steps_result *result,
                          const bench_cpu_time *before)
{
	bench_machine machine;
	bench_cpu_time after;
	bench_machine_read("", &machine);
	bench_cpu_time_read("", &after);
	bench_disturbance disturbance =
		bench_disturbance_between(before, &after, (double)sysconf(_SC_CLK_TCK));
	(options->json ? bench_machine_write_json
	               : bench_machine_write)(stdout, &machine, result->instruction_set, &disturbance);
}

typedef struct results {
	bench_steps_result steps;
	bench_limit_result limit;
	bench_cut_result cut;
	bench_error_result error;
	bench_accuracy_result accuracy;
	bench_along_result along;
	bench_scaling_result scaling;
	bench_update_result update;
	bench_remesh_result remesh;
	bench_classroom_result classroom;
} results;

static bool wants_accuracy(const bench_options *options)
{
	return options->accuracy > 0 || options->rest;
}

static bool wants_along(const bench_options *options)
{
	return options->accuracy > 0 && options->cut;
}

// Runs all wanted measurements. Returns 0, or 1 after an error message.
static int measure(const bench_options *options, results *of)
{
	return bench_steps(options, &of->steps) || bench_limit(options, &of->limit) ||
	       (options->cut && bench_cut(options, &of->cut)) ||
	       (options->error && bench_error(options, &of->error)) ||
	       (wants_accuracy(options) && bench_accuracy(options, &of->accuracy)) ||
	       (wants_along(options) && bench_along(options, &of->along)) ||
	       (options->scaling && bench_scaling(options, &of->scaling)) ||
	       (options->update && bench_update(options, &of->update)) ||
	       (options->remesh && bench_remesh(options, &of->remesh)) ||
	       (options->classroom && bench_classroom(options, &of->classroom));
}

// Returns `measured`. Writes a comma before a further part of the JSON.
static bool has_part(const bench_options *options, bool measured)
{
	fputs(measured && options->json ? "," : "", stdout);
	return measured;
}

static void print(const bench_options *options, const results *of)
{
	if (options->json)
		printf("{\"scene\":\"%s\",\"threads\":%d,\"iterations\":%d,", options->scene,
		       options->threads, options->iterations);
	print_steps(options, &of->steps);
	fputs(options->json ? "," : "", stdout);
	print_limit(options, &of->limit);
	if (has_part(options, options->cut))
		print_cut(options, &of->cut);
	if (has_part(options, options->error))
		print_error(options, &of->error);
	if (has_part(options, wants_accuracy(options)))
		print_accuracy(options, &of->accuracy);
	if (has_part(options, wants_along(options)))
		print_along(options, &of->along);
	if (has_part(options, options->scaling))
		print_scaling(options, &of->scaling);
	if (has_part(options, options->update))
		print_update(options, &of->update);
	if (has_part(options, options->remesh))
		print_remesh(options, &of->remesh);
	if (has_part(options, options->classroom))
		print_classroom(options, &of->classroom);
	fputs(options->json ? "," : "", stdout);
}

int main(int argc, char **argv)
{
	bench_options options;
	bench_cpu_time before;
	results of = {0};
	if (!bench_options_read(argc, argv, &options, stderr))
		return 2;
	if (options.help) {
		bench_options_help(stdout);
		return 0;
	}
	bench_cpu_time_read("", &before);
	if (measure(&options, &of))
		return 1;
	print(&options, &of);
	print_machine(&options, &of.steps, &before);
	puts(options.json ? "}" : "");
	return 0;
}
