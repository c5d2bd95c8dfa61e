// SPDX-License-Identifier: GPL-3.0-or-later
// The command `mesh`: starts the program cautery-mesh, so that users find it. It needs no daemon.
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "cautery/cli.h"

enum { WORDS_MAX = 16, PATH_BYTES = 4096 };

// Starts cautery-mesh from the folder of this program, or from the shell's search path.
static void start(char **words)
{
	char path[PATH_BYTES];
	ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
	path[length > 0 ? length : 0] = 0;
	char *slash = strrchr(path, '/');
	if (slash && (size_t)(slash - path) + sizeof "/cautery-mesh" <= sizeof path) {
		memcpy(slash, "/cautery-mesh", sizeof "/cautery-mesh");
		execv(path, words);
	}
	execvp(words[0], words);
}

static cli_exit run(cli *c)
{
	static const char *const options[] = {"out", "edge", "labels"};
	char dashed[3][16], *words[WORDS_MAX] = {"cautery-mesh"};
	int count = 1;
	for (int i = 0; i < 3; i++) {
		snprintf(dashed[i], sizeof dashed[i], "--%s", options[i]);
		if (!cli_value(c, options[i]))
			continue;
		words[count++] = dashed[i];
		words[count++] = (char *)cli_value(c, options[i]);
	}
	if (cli_value(c, "strict"))
		words[count++] = "--strict";
	words[count++] = "--";
	words[count] = (char *)c->arguments[0];
	fflush(c->out);
	start(words);
	cli_complain(c, "cautery-mesh cannot be started (install the daemon's package): %s",
	             strerror(errno));
	return CLI_FILE;
}

const cli_command cli_mesh = {
	.name = "mesh",
	.arguments = "FILE",
	.summary = "fills a surface or a segmentation with tetrahedra",
	.help = "The same as cautery-mesh(1). `cautery create FILE` does it on the daemon.\n",
	.least = 1,
	.most = 1,
	.options = {{"out", "FILE",
                 "file for the solid, in the format of Gmsh; \"-\": standard output"},
                {"edge", "L", "length of an edge, in units of the file"},
                {"labels", "A,B", "labels of a segmentation to keep (default: all)"},
                {"strict", NULL, "refuse a surface that is open or needs repair"}},
	.run = run};
