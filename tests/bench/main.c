// SPDX-License-Identifier: GPL-3.0-or-later
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/bench.h"
#include "bench/machine.h"

static const char help[] =
	"cautery-bench: measures steps of a scene\n"
	"\n"
	"  --scene NAME|FILE   fascia, fat, fat-neohookean, layers ... (default fat)\n"
	"  --scenes DIR        where named scenes are\n"
	"  --threads T         threads of a step (default 1)\n"
	"  --iterations K      iterations of a step (default 10)\n"
	"  --steps N           measured steps after the warm-up (default 300)\n"
	"  --solver S          cholesky or diagonal (default: the scene's)\n"
	"  --precision P       single or double (default: the scene's)\n"
	"  --isa TIER          highest instruction set: baseline, avx2, avx512\n"
	"  --cut               draw the scene's tool across it, energized\n"
	"  --repeat R          cut, or go through the sizes, R times, each step's (size's) time the\n"
	"                      least of them (default 1)\n"
	"  --error             error of K iterations against the converged step under the scene's "
	"pull\n"
	"  --scaling           step time against size\n"
	"  --json              the last line of standard output is one JSON object; its `machine` "
	"says\n"
	"                      on what it was measured, and what else that machine did meanwhile\n"
	"\n"
	"Exit codes: 0 measured, 1 the scene could not be run, 2 the arguments are wrong.\n";

static int choose(const char *text, const char *const *names, int count)
{
	for (int i = 0; i < count; ++i)
		if (!strcmp(text, names[i]))
			return i;
	fprintf(stderr, "cautery-bench: \"%s\" is no choice; see --help\n", text);
	exit(2);
}

static int32_t number(const char *text, long least, long most)
{
	char *end;
	long value = strtol(text, &end, 10);
	if (*end || end == text || value < least || value > most) {
		fprintf(stderr, "cautery-bench: \"%s\" is not a number from %ld to %ld\n", text, least,
		        most);
		exit(2);
	}
	return (int32_t)value;
}

static bench_options parse(int argc, char **argv)
{
	static const struct option known[] = {
		{"scene", 1, NULL, 's'},      {"scenes", 1, NULL, 'd'},  {"threads", 1, NULL, 't'},
		{"iterations", 1, NULL, 'k'}, {"steps", 1, NULL, 'n'},   {"solver", 1, NULL, 'o'},
		{"precision", 1, NULL, 'p'},  {"isa", 1, NULL, 'i'},     {"cut", 0, NULL, 'c'},
		{"error", 0, NULL, 'e'},      {"scaling", 0, NULL, 'g'}, {"json", 0, NULL, 'j'},
		{"repeat", 1, NULL, 'r'},     {"help", 0, NULL, 'h'},    {NULL, 0, NULL, 0}};
	static const char *const solvers[] = {"cholesky", "diagonal"};
	static const char *const precisions[] = {"single", "double"};
	bench_options options = {.scene = "fat",
	                         .scenes_directory = CAU_BENCH_SCENES,
	                         .threads = 1,
	                         .iterations = 10,
	                         .steps = 300,
	                         .repeat = 1,
	                         .solver = -1,
	                         .precision = -1};
	for (int c; (c = getopt_long(argc, argv, "", known, NULL)) != -1;)
		switch (c) {
		case 's':
			options.scene = optarg;
			break;
		case 'd':
			options.scenes_directory = optarg;
			break;
		case 't':
			options.threads = number(optarg, 1, 16);
			break;
		case 'k':
			options.iterations = number(optarg, 1, 1000);
			break;
		case 'n':
			options.steps = number(optarg, 1, 100000);
			break;
		case 'o':
			options.solver = choose(optarg, solvers, 2);
			break;
		case 'p':
			options.precision = choose(optarg, precisions, 2);
			break;
		case 'i':
			options.instruction_set = optarg;
			break;
		case 'c':
			options.cut = true;
			break;
		case 'r':
			options.repeat = number(optarg, 1, 100);
			break;
		case 'e':
			options.error = true;
			break;
		case 'g':
			options.scaling = true;
			break;
		case 'j':
			options.json = true;
			break;
		case 'h':
			fputs(help, stdout);
			exit(0);
		default:
			fputs("see --help\n", stderr);
			exit(2);
		}
	return options;
}

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

int main(int argc, char **argv)
{
	bench_options options = parse(argc, argv);
	bench_cpu_time before;
	bench_steps_result steps;
	bench_cut_result cut;
	bench_error_result error;
	bench_scaling_result scaling;
	bench_limit_result limit;
	bench_cpu_time_read("", &before);
	if (bench_steps(&options, &steps) || bench_limit(&options, &limit) ||
	    (options.cut && bench_cut(&options, &cut)) ||
	    (options.error && bench_error(&options, &error)) ||
	    (options.scaling && bench_scaling(&options, &scaling)))
		return 1;
	if (options.json)
		printf("{\"scene\":\"%s\",\"threads\":%d,\"iterations\":%d,", options.scene,
		       options.threads, options.iterations);
	print_steps(&options, &steps);
	fputs(options.json ? "," : "", stdout);
	print_limit(&options, &limit);
	if (options.cut) {
		fputs(options.json ? "," : "", stdout);
		print_cut(&options, &cut);
	}
	if (options.error) {
		fputs(options.json ? "," : "", stdout);
		print_error(&options, &error);
	}
	if (options.scaling) {
		fputs(options.json ? "," : "", stdout);
		print_scaling(&options, &scaling);
	}
	fputs(options.json ? "," : "", stdout);
	print_machine(&options, &steps, &before);
	puts(options.json ? "}" : "");
	return 0;
}
