// SPDX-License-Identifier: GPL-3.0-or-later
// The command line of cautery-bench.
#include "bench/bench.h"

#include "cautery/options.h"

#define AT(member) offsetof(bench_options, member)

static const char *const solvers[] = {"cholesky", "diagonal", "newton", NULL};
static const char *const precisions[] = {"single", "double", NULL};

static const cau_option rows[] = {
	{"scene", "NAME|FILE", CAU_OPTION_TEXT, AT(scene),
     .meaning = "fascia, fat, fat-neohookean, layers ... (default fat)"},
	{"scenes", "DIR", CAU_OPTION_TEXT, AT(scenes_directory), .meaning = "where named scenes are"},
	{"threads", "T", CAU_OPTION_WHOLE, AT(threads), 1, 16,
     .meaning = "threads of a step (default 1)"},
	{"iterations", "K", CAU_OPTION_WHOLE, AT(iterations), 1, 1000,
     .meaning = "iterations of a step (default 10)"},
	{"steps", "N", CAU_OPTION_WHOLE, AT(steps), 1, 100000,
     .meaning = "measured steps after the warm-up (default 300)"},
	{"solver", "S", CAU_OPTION_CHOICE, AT(solver), .choices = solvers,
     .meaning = "cholesky, diagonal or newton (default: the scene's)"},
	{"precision", "P", CAU_OPTION_CHOICE, AT(precision), .choices = precisions,
     .meaning = "single or double (default: the scene's)"},
	{"isa", "TIER", CAU_OPTION_TEXT, AT(instruction_set),
     .meaning = "highest instruction set: baseline, avx2, avx512"},
	{"cut", NULL, CAU_OPTION_FLAG, AT(cut),
     .meaning = "draw the scene's tool across it, energized"},
	{"repeat", "R", CAU_OPTION_WHOLE, AT(repeat), 1, 100,
     .meaning = "cut, or go through the sizes, R times, each step's (size's) time the\n"
                "least of them (default 1)"},
	{"error", NULL, CAU_OPTION_FLAG, AT(error),
     .meaning = "error of K iterations against the converged step under the scene's pull"},
	{"accuracy", "A", CAU_OPTION_NUMBER, AT(accuracy), 1e-4, 1,
     .meaning = "steps that end at this error against K iterations, alternating; with --cut\n"
                "also the errors along the cut, as reported and as they are"},
	{"rest", NULL, CAU_OPTION_FLAG, AT(rest),
     .meaning = "the same at rest and awake, and the cost of a resting session"},
	{"scaling", NULL, CAU_OPTION_FLAG, AT(scaling), .meaning = "step time against size"},
	{"update", NULL, CAU_OPTION_FLAG, AT(update),
     .meaning = "cost of updating the matrix for a cut, three ways"},
	{"remesh", NULL, CAU_OPTION_FLAG, AT(remesh),
     .meaning = "the scene's cut by a method that changes the topology, beside ours"},
	{"classroom", NULL, CAU_OPTION_FLAG, AT(classroom),
     .meaning = "many sessions at the pace of the clock, N ticks long, by a few workers; each as\n"
                "accurate as its scene says"},
	{"sessions", "S", CAU_OPTION_WHOLE, AT(sessions), 1, 1024,
     .meaning = "sessions of the classroom (default 64)"},
	{"driven", "D", CAU_OPTION_WHOLE, AT(driven), 0, 1024,
     .meaning = "of them, along the scene's cut, to and fro (default 4)"},
	{"workers", "W", CAU_OPTION_WHOLE, AT(workers), 1, 16,
     .meaning = "threads that step them (default 2)"},
	{"json", NULL, CAU_OPTION_FLAG, AT(json),
     .meaning = "the last line of standard output is one JSON object; its `machine` says\n"
                "describes the machine and its other load meanwhile"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "this text"},
};

static const cau_command_line line = {
	.program = "cautery-bench",
	.summary = "Measures steps of a scene.\n",
	.closing = "Exit codes: 0 measured, 1 the scene could not be run, 2 the arguments are wrong.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows,
};

void bench_options_help(FILE *out)
{
	cau_options_help(&line, out);
}

bool bench_options_read(int argument_count, char **arguments, bench_options *options,
                        FILE *complaints)
{
	*options = (bench_options){.scene = "fat",
	                           .scenes_directory = CAU_BENCH_SCENES,
	                           .threads = 1,
	                           .iterations = 10,
	                           .steps = 300,
	                           .repeat = 1,
	                           .sessions = 64,
	                           .driven = 4,
	                           .workers = 2,
	                           .solver = -1,
	                           .precision = -1};
	return cau_options_read(&line, argument_count, arguments, options, NULL, complaints);
}
