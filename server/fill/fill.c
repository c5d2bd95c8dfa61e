// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill/fill.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cautery/assert.h"

enum { LOOK_MS = 100, ARGUMENTS_MAX = 24, NUMBER_BYTES = 32, PATH_BYTES = 4096 };
// Ratio of the allowed wall time to the allowed processor time. It is above 1 because a busy
// machine gives the process little time.
static const double wall_share = 4;

struct cau_filling {
	atomic_int holders;
	atomic_bool cancelled, ended;
	atomic_bool done; // set after bytes and byte_count
	void *bytes;
	size_t byte_count;
};

cau_filling *cau_filling_create(void)
{
	cau_filling *filling = calloc(1, sizeof *filling);
	if (filling)
		atomic_init(&filling->holders, 1);
	return filling;
}

cau_filling *cau_filling_share(cau_filling *filling)
{
	atomic_fetch_add(&filling->holders, 1);
	return filling;
}

void cau_filling_release(cau_filling *filling)
{
	if (!filling || atomic_fetch_sub(&filling->holders, 1) != 1)
		return;
	free(filling->bytes);
	free(filling);
}

void cau_filling_cancel(cau_filling *filling)
{
	atomic_store(&filling->cancelled, true);
}

bool cau_filling_is_cancelled(const cau_filling *filling)
{
	return atomic_load(&filling->cancelled);
}

void cau_filling_end(cau_filling *filling)
{
	atomic_store(&filling->ended, true);
}

bool cau_filling_has_ended(const cau_filling *filling)
{
	return atomic_load(&filling->ended);
}

bool cau_filling_solid(const cau_filling *filling, const void **bytes, size_t *byte_count)
{
	if (!atomic_load(&filling->done))
		return false;
	*bytes = filling->bytes;
	*byte_count = filling->byte_count;
	return true;
}

// ---- the process
typedef struct process {
	pid_t pid;
	// in, out: files of standard input and output; said: pipe of standard error
	int in, out, said;
	// Output of standard error. The buffer is one byte shorter than a report, because a line feed
	// is added to a last line without one.
	char text[CAU_FILL_REPORT_BYTES - 1];
	size_t text_bytes;
} process;

typedef struct command {
	char path[PATH_BYTES];
	char number[3][NUMBER_BYTES];
	char *word[ARGUMENTS_MAX];
	int count;
} command;

static void add(command *of, const char *word)
{
	CAU_ASSERT(of->count < ARGUMENTS_MAX - 1, "%d arguments", of->count);
	of->word[of->count++] = (char *)word;
}

// Finds cautery-mesh, which is in the folder of the running program.
static bool find_program(char path[static PATH_BYTES])
{
	ssize_t length = readlink("/proc/self/exe", path, PATH_BYTES - 1);
	path[length > 0 ? length : 0] = 0;
	char *slash = strrchr(path, '/');
	if (!slash || (size_t)(slash - path) + sizeof "/cautery-mesh" > PATH_BYTES)
		return false;
	memcpy(slash, "/cautery-mesh", sizeof "/cautery-mesh");
	return access(path, X_OK) == 0;
}

static void make_command(const cau_fill_wish *wish, command *of)
{
	add(of, of->path);
	add(of, "--out=-");
	add(of, "--with-parent");
	snprintf(of->number[0], NUMBER_BYTES, "--memory-mb=%lld", (long long)wish->memory_mb);
	snprintf(of->number[1], NUMBER_BYTES, "--time-s=%lld", (long long)wish->time_s);
	add(of, of->number[0]);
	add(of, of->number[1]);
	add(of, "--name");
	add(of, wish->file_name);
	if (wish->edge > 0) {
		snprintf(of->number[2], NUMBER_BYTES, "--edge=%.9g", wish->edge);
		add(of, of->number[2]);
	}
	if (wish->labels[0]) {
		add(of, "--labels");
		add(of, wish->labels);
	}
	if (wish->strict)
		add(of, "--strict");
	add(of, "-"); // standard input
}

static bool write_all(int file, const void *bytes, size_t byte_count)
{
	const char *at = bytes;
	while (byte_count) {
		ssize_t written = write(file, at, byte_count);
		if (written < 0 && errno == EINTR)
			continue;
		if (written <= 0)
			return false;
		at += written;
		byte_count -= (size_t)written;
	}
	return lseek(file, 0, SEEK_SET) == 0;
}

// Starts the process, with an empty environment, so that it cannot read secrets of the daemon.
static int spawn(process *of, command *line, int said)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	sigset_t none, all;
	char *environment[] = {NULL};
	sigemptyset(&none);
	sigfillset(&all);
	posix_spawn_file_actions_init(&files);
	posix_spawn_file_actions_adddup2(&files, of->in, STDIN_FILENO);
	posix_spawn_file_actions_adddup2(&files, of->out, STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&files, said, STDERR_FILENO);
	posix_spawnattr_init(&attributes);
	posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &all);
	int failed = posix_spawn(&of->pid, line->path, &files, &attributes, line->word, environment);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&files);
	return failed;
}

static cau_status start(process *of, const cau_fill_wish *wish, cau_error *error)
{
	command line = {0};
	int pipes[2] = {-1, -1};
	if (!find_program(line.path))
		return cau_fail(
			error, CAU_IO, "",
			"the program cautery-mesh is missing in the daemon's folder: install it there");
	make_command(wish, &line);
	of->in = memfd_create("mesh", MFD_CLOEXEC);
	of->out = memfd_create("solid", MFD_CLOEXEC);
	if (of->in < 0 || of->out < 0 || pipe2(pipes, O_CLOEXEC) ||
	    !write_all(of->in, wish->bytes, wish->byte_count)) {
		int reason = errno;
		if (pipes[1] >= 0)
			close(pipes[1]);
		of->said = pipes[0];
		return cau_fail(error, CAU_IO, "", "the files for cautery-mesh cannot be opened: %s",
		                strerror(reason));
	}
	of->said = pipes[0];
	int failed = spawn(of, &line, pipes[1]);
	close(pipes[1]);
	return failed
	           ? cau_fail(error, CAU_IO, "", "cautery-mesh cannot be started: %s", strerror(failed))
	           : CAU_OK;
}

// Reads output of the process from its pipe. Returns false if the process has ended.
static bool hear(process *of)
{
	size_t room = sizeof of->text - 1 - of->text_bytes;
	char unwanted[512];
	ssize_t got = room ? read(of->said, of->text + of->text_bytes, room)
	                   : read(of->said, unwanted, sizeof unwanted);
	of->text_bytes += room && got > 0 ? (size_t)got : 0;
	of->text[of->text_bytes] = 0;
	return got > 0 || (got < 0 && errno == EINTR);
}

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Waits until the process ends, or kills it. Returns its exit status. *why: the reason for a kill,
// or "" if the time was used up; NULL stays if the process ended by itself.
static int wait_for(process *of, const cau_filling *filling, const cau_fill_wish *wish,
                    const char **why)
{
	double end_s = now_s() + wall_share * (double)wish->time_s;
	struct pollfd said = {.fd = of->said, .events = POLLIN};
	for (bool goes_on = true; goes_on;) {
		int ready = poll(&said, 1, LOOK_MS);
		goes_on = ready <= 0 || hear(of);
		if (cau_filling_is_cancelled(filling))
			*why = "the meshing was cancelled";
		else if (wish->is_over(wish->user))
			*why = "the server is shutting down";
		else if (now_s() > end_s)
			*why = "";
		if (!*why)
			continue;
		kill(of->pid, SIGKILL);
		goes_on = false;
	}
	int state = 0;
	while (waitpid(of->pid, &state, 0) < 0 && errno == EINTR)
		;
	return state;
}

// ---- reports and errors of the process
// Copies the report without the lines of progress.
static void take_report(char *text, char *report)
{
	size_t used = 0;
	for (char *line = text, *rest = text; *line; line = rest) {
		size_t length = strcspn(line, "\n");
		rest = line + length + (line[length] == '\n');
		if (length > 2 && strncmp(line + length - 2, " %", 2) == 0)
			continue;
		memcpy(report + used, line, length);
		used += length;
		report[used++] = '\n';
	}
	report[used] = 0;
}

// Turns "cautery-mesh: FILE: --edge: asks for ..." into an error: its reason, and the parameter
// that it concerns.
static cau_status take_complaint(const char *file_name, const char *text, cau_error *error)
{
	static const char *const parameters[][2] = {
		{"--edge: ", "edge_m"}, {"--labels: ", "labels"}, {"--strict refuses", "strict"}};
	const char *at = strstr(text, "cautery-mesh: ");
	if (!at)
		return cau_fail(error, CAU_IO, "", "cautery-mesh ended without a reason");
	at += strlen("cautery-mesh: ");
	size_t name = strlen(file_name);
	if (strncmp(at, file_name, name) == 0 && strncmp(at + name, ": ", 2) == 0)
		at += name + 2;
	for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++) {
		size_t length = strlen(parameters[i][0]);
		if (strncmp(at, parameters[i][0], length) != 0)
			continue;
		at += i == 2 ? 2 : length; // "strict refuses ..." is part of the sentence, so it stays
		return cau_fail(error, CAU_BAD_MESH, parameters[i][1], "%.*s", (int)strcspn(at, "\n"), at);
	}
	return cau_fail(error, CAU_BAD_MESH, "", "%.*s", (int)strcspn(at, "\n"), at);
}

static cau_status judge(const process *of, int state, const char *why, const cau_fill_wish *wish,
                        cau_error *error)
{
	if (why && *why)
		return cau_fail(error, CAU_BAD_STATE, "", "%s", why);
	if (why || (WIFSIGNALED(state) && (WTERMSIG(state) == SIGXCPU || WTERMSIG(state) == SIGKILL)))
		return cau_fail(error, CAU_LIMIT, "",
		                "meshing took more than %lld s (setting mesh_time_s): choose a longer edge",
		                (long long)wish->time_s);
	if (WIFSIGNALED(state))
		return cau_fail(error, CAU_IO, "", "cautery-mesh was ended by signal %d", WTERMSIG(state));
	if (WEXITSTATUS(state) != 0 && strstr(of->text, ": no memory for "))
		return cau_fail(error, CAU_LIMIT, "",
		                "meshing needs more than %lld MB (setting mesh_memory_mb): choose a longer "
		                "edge, or crop the file",
		                (long long)wish->memory_mb);
	return WEXITSTATUS(state) ? take_complaint(wish->file_name, of->text, error) : CAU_OK;
}

static cau_status take_solid(cau_filling *filling, const process *of, const cau_fill_wish *wish,
                             cau_error *error)
{
	struct stat about;
	if (fstat(of->out, &about) || about.st_size <= 0 || about.st_size > wish->most_bytes)
		return cau_fail(error, CAU_LIMIT, "",
		                "the solid has more than %lld bytes (setting max_upload_bytes): choose a "
		                "longer edge",
		                (long long)wish->most_bytes);
	size_t byte_count = (size_t)about.st_size, done = 0;
	char *bytes = malloc(byte_count);
	while (bytes && done < byte_count) {
		ssize_t got = pread(of->out, bytes + done, byte_count - done, (off_t)done);
		if (got <= 0)
			break;
		done += (size_t)got;
	}
	if (!bytes || done < byte_count) {
		free(bytes);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a solid of %zu bytes", byte_count);
	}
	CAU_ASSERT(!filling->bytes, "a filling is filled twice (%zu bytes)", filling->byte_count);
	filling->bytes = bytes;
	filling->byte_count = byte_count;
	atomic_store(&filling->done, true);
	return CAU_OK;
}

cau_status cau_fill(cau_filling *filling, const cau_fill_wish *wish,
                    char report[static CAU_FILL_REPORT_BYTES], cau_error *error)
{
	report[0] = 0;
	process *of = calloc(1, sizeof *of);
	if (!of)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a process");
	of->in = of->out = of->said = -1;
	cau_status status = start(of, wish, error);
	if (!status) {
		const char *why = NULL;
		int state = wait_for(of, filling, wish, &why);
		status = judge(of, state, why, wish, error);
	}
	if (!status)
		status = take_solid(filling, of, wish, error);
	if (!status)
		take_report(of->text, report);
	const int files[] = {of->in, of->out, of->said};
	for (size_t i = 0; i < sizeof files / sizeof *files; i++)
		if (files[i] >= 0)
			close(files[i]);
	free(of);
	return status;
}
