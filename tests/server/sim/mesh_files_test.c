// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the program on real mesh files. It must cut each for ten seconds without a fault, and edges
// must part. The folder comes from CAUTERY_MESHES; without it the test is skipped.
#include "sim_fixture.h"

#include <sys/wait.h>

typedef struct mesh_file {
	const char *name;
	const char *unit_m; // the unit that gives the mesh the size of an organ
} mesh_file;

static const mesh_file files[] = {
	{"liver.msh", "0.03"},     {"liver-smoothUV.obj", "0.03"}, {"liver_low_volume.msh", "0.01"},
	{"msh4_cube.msh", "0.05"}, {"Cautery-Hook.obj", "0.002"},
};

static int removed_elements(const char *program, const char *folder, const mesh_file *file)
{
	char command[1024], output[8192];
	snprintf(command, sizeof command, "%s --scene %s/%s --unit-m %s --cut --seconds 10 --json",
	         program, folder, file->name, file->unit_m);
	FILE *pipe = popen(command, "r");
	if (!pipe)
		return -1;
	size_t used = fread(output, 1, sizeof output - 1, pipe);
	output[used] = 0;
	int status = pclose(pipe);
	const char *place = strstr(output, "\"elements_removed\":");
	if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !place)
		return -1;
	return atoi(place + strlen("\"elements_removed\":"));
}

int main(int argument_count, char **arguments)
{
	const char *folder = getenv("CAUTERY_MESHES");
	int failures = 0;
	if (argument_count < 2) {
		fputs("the program to test is the first argument\n", stderr);
		return 1;
	}
	if (!folder || access(folder, R_OK) != 0) {
		puts("skipped: CAUTERY_MESHES names no folder with real meshes");
		return 77;
	}
	// Under sanitizers, only the first two files are tested: a solid and a surface.
	size_t count = CAU_TEST_SANITIZED ? 2 : sizeof files / sizeof *files;
	for (size_t i = 0; i < count; i++) {
		int removed = removed_elements(arguments[1], folder, &files[i]);
		printf("%s: %d elements removed\n", files[i].name, removed);
		failures += removed <= 0;
	}
	return failures > 0;
}
