// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the program cautery-sim in tests.
#pragma once

#include "sim_fixture.h"

#include <sys/wait.h>

static const char *program; // path of the program: the test's first argument

// Runs the program with these arguments. Its standard output goes to `output`. Returns its exit
// code.
static inline int run_program(const char *arguments, char *output, size_t bytes)
{
	char command[1024];
	snprintf(command, sizeof command, "%s --scenes %s %s 2>%s", program, CAU_TEST_LIGHT_SCENES,
	         arguments, fixture_path("complaints"));
	FILE *pipe = popen(command, "r");
	assert_non_null(pipe);
	size_t used = fread(output, 1, bytes - 1, pipe);
	output[used] = 0;
	int status = pclose(pipe);
	assert_true(WIFEXITED(status));
	return WEXITSTATUS(status);
}

// Reads the hash from the JSON object that is the last line of the output.
static inline void read_hash(const char *arguments, char hash[17])
{
	char output[8192];
	assert_int_equal(run_program(arguments, output, sizeof output), 0);
	const char *line = strrchr(output, '{');
	assert_non_null(line);
	const char *place = strstr(line, "\"hash\":\"");
	assert_non_null(place);
	snprintf(hash, 17, "%s", place + strlen("\"hash\":\""));
	assert_int_equal(strlen(hash), 16);
	assert_int_equal(strspn(hash, "0123456789abcdef"), 16);
}
