// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-mesh: makes tetrahedra inside a closed surface, or inside the labels of a segmentation.
// Users run it, and so does the daemon, with limits on memory and time, because uploaded files are
// untrusted.
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "cautery/options.h"
#include "cautery/solid.h"

enum { EXIT_USAGE = 2, EXIT_INPUT = 3, EXIT_OUTPUT = 4 };
static const double a_while_s = 0.5; // time between lines of progress

typedef struct asked {
	const char *out, *labels, *name;
	double edge;
	int32_t memory_mb, time_s;
	bool strict, with_parent, help, version;
} asked;

#define AT(member) offsetof(asked, member)
static const cau_option rows[] = {
	{"out", "FILE", CAU_OPTION_TEXT, AT(out),
     .meaning = "where the solid goes, a Gmsh file; \"-\": standard output"},
	{"edge", "L", CAU_OPTION_NUMBER, AT(edge), 1e-9, 1e9,
     .meaning = "length of an edge, in units of the file (of a segmentation: mm);\n"
                "default: a length that gives about 8,000 tetrahedra"},
	{"labels", "A,B", CAU_OPTION_TEXT, AT(labels),
     .meaning = "labels of a segmentation to keep (default: all but 0)"},
	{"name", "N", CAU_OPTION_TEXT, AT(name),
     .meaning = "name of standard input in messages (default: \"standard input\")"},
	{"strict", NULL, CAU_OPTION_FLAG, AT(strict),
     .meaning = "refuses a surface that is open or has to be mended"},
	{"memory-mb", "N", CAU_OPTION_WHOLE, AT(memory_mb), 64, 1e6,
     .meaning = "largest memory (default: no limit)"},
	{"time-s", "N", CAU_OPTION_WHOLE, AT(time_s), 1, 1e6,
     .meaning = "largest processor time (default: no limit)"},
	{"with-parent", NULL, CAU_OPTION_FLAG, AT(with_parent),
     .meaning = "ends when its parent process ends"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "this text"},
	{"version", NULL, CAU_OPTION_HELP, AT(version), .meaning = "version of this program"},
};

static const cau_command_line line = {
	.program = "cautery-mesh",
	.words = "FILE",
	.word_count = 1,
	.summary =
		"Fills a closed or nearly closed surface with tetrahedra (STL, PLY, OBJ and the other\n"
		"mesh formats), or the labels of a segmentation (NRRD, NIfTI). The report goes to\n"
		"standard error. FILE \"-\" is standard input.\n",
	.closing = "Exit code: 0 done; 2 options; 3 the file cannot be read or filled;\n"
			   "4 the solid cannot be written.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows,
};

// ---- limits
static bool bound(int resource, rlim_t most)
{
	struct rlimit limit = {most, most};
	return setrlimit((__rlimit_resource_t)resource, &limit) == 0;
}

// Whether the process limits its memory. Sanitizers reserve more address space than any machine has
// memory, so builds with them set no limit.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const bool bounds_memory = false;
#else
static const bool bounds_memory = true;
#endif

static bool take_bounds(const asked *options)
{
	bool taken = true;
	if (options->memory_mb && bounds_memory)
		taken = bound(RLIMIT_AS, (rlim_t)options->memory_mb << 20);
	if (options->time_s)
		taken &= bound(RLIMIT_CPU, (rlim_t)options->time_s);
	taken &= bound(RLIMIT_CORE, 0); // a core file would contain the input
	if (options->with_parent) {
		pid_t parent = getppid();
		taken &= prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent && parent != 1;
	}
	return taken;
}

// ---- progress
typedef struct shown {
	double at_s;
	bool terminal;
	char stage[24];
} shown;

// Shows the progress: on a terminal as one line that is overwritten, otherwise as a line for each
// stage.
static void show(void *user, const char *stage, double share)
{
	shown *last = user;
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	double now_s = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
	bool other = strcmp(stage, last->stage) != 0;
	if (last->terminal ? !other && now_s - last->at_s < a_while_s : !other)
		return;
	fprintf(stderr, last->terminal ? "\r\033[K%s %.0f %%" : "%s: %.0f %%\n", stage, 100 * share);
	if (last->terminal && share >= 1)
		fputs("\r\033[K", stderr);
	last->at_s = now_s;
	snprintf(last->stage, sizeof last->stage, "%s", stage);
}

// ---- files
static unsigned char *read_input(size_t *byte_count)
{
	size_t room = 1 << 20, count = 0, got;
	unsigned char *bytes = malloc(room);
	while (bytes && (got = fread(bytes + count, 1, room - count, stdin)) > 0) {
		count += got;
		if (count < room)
			continue;
		unsigned char *more = realloc(bytes, room *= 2);
		if (!more)
			free(bytes);
		bytes = more;
	}
	*byte_count = count;
	return bytes;
}

// Writes the output completely or not at all: to a file beside the target, which is then renamed.
static bool write_output(const char *path, const cau_solid *solid)
{
	char beside[4096];
	if (strcmp(path, "-") == 0)
		return fwrite(solid->bytes, 1, solid->byte_count, stdout) == solid->byte_count &&
		       fflush(stdout) == 0;
	if (snprintf(beside, sizeof beside, "%s.part", path) >= (int)sizeof beside) {
		errno = ENAMETOOLONG;
		return false;
	}
	FILE *out = fopen(beside, "we");
	if (!out)
		return false;
	bool written = fwrite(solid->bytes, 1, solid->byte_count, out) == solid->byte_count;
	written = fclose(out) == 0 && written;
	if (written && rename(beside, path) == 0)
		return true;
	int reason = errno;
	unlink(beside);
	errno = reason;
	return false;
}

// Returns `reason` without the core's prefix "strict refuses". Its caller writes the option's name
// instead.
static const char *own_words(const char *reason)
{
	static const char strict[] = "strict refuses";
	return strncmp(reason, strict, sizeof strict - 1) ? reason : reason + sizeof strict - 1;
}

static int fail(const char *file, const cau_error *error)
{
	bool strict = own_words(error->reason) != error->reason;
	if (error->path[0] && !strict)
		fprintf(stderr, "cautery-mesh: %s: --%s: %s\n", file, error->path, error->reason);
	else
		fprintf(stderr, "cautery-mesh: %s: %s%s\n", file, strict ? "--strict refuses" : "",
		        own_words(error->reason));
	return EXIT_INPUT;
}

static int run(const asked *options, const char *file)
{
	cau_error error = {0};
	cau_solid solid;
	shown last = {.terminal = isatty(STDERR_FILENO)};
	bool piped = strcmp(file, "-") == 0;
	if (piped)
		file = options->name ? options->name : "standard input";
	cau_solid_wish wish = {.file = file,
	                       .edge = options->edge,
	                       .labels = options->labels,
	                       .strict = options->strict,
	                       .progress = show,
	                       .user = &last};
	unsigned char *bytes = piped ? read_input(&wish.byte_count) : NULL;
	wish.bytes = bytes;
	if (piped && !bytes) {
		fputs("cautery-mesh: no memory for standard input\n", stderr);
		return EXIT_INPUT;
	}
	cau_status status = cau_solid_make(&wish, &solid, &error);
	free(bytes);
	int code = 0;
	if (status) {
		code = fail(file, &error);
	} else {
		fputs(solid.text, stderr);
		if (!write_output(options->out, &solid)) {
			fprintf(stderr, "cautery-mesh: cannot write %s: %s\n", options->out, strerror(errno));
			code = EXIT_OUTPUT;
		}
	}
	cau_solid_finish(&solid);
	return code;
}

int main(int argument_count, char **arguments)
{
	asked options = {0};
	const char *file = NULL;
	if (!cau_options_read(&line, argument_count, arguments, &options, &file, stderr))
		return EXIT_USAGE;
	if (options.version) {
		puts("cautery-mesh " CAUTERY_VERSION);
		return 0;
	}
	if (options.help) {
		cau_options_help(&line, stdout);
		return 0;
	}
	if (!options.out) {
		fputs("cautery-mesh: --out FILE is missing: the file for the solid\n", stderr);
		return EXIT_USAGE;
	}
	if (!take_bounds(&options)) {
		fprintf(stderr, "cautery-mesh: the limits of memory and time cannot be set: %s\n",
		        strerror(errno));
		return EXIT_USAGE;
	}
	return run(&options, file);
}
