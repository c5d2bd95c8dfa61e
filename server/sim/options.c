// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/run.h"

#include "cautery/options.h"

#define AT(member) offsetof(sim_options, member)

static const cau_option rows[] = {
	{"scene", "S", CAU_OPTION_TEXT, AT(scene),
     .meaning = "a scene's name, a scene file (.json) or a mesh file"},
	{"scenes", "DIR", CAU_OPTION_TEXT, AT(scenes),
     .meaning = "folder of named scenes (default: the installed scenes)"},
	{"script", "FILE", CAU_OPTION_TEXT, AT(script),
     .meaning = "file of commands, one JSON object in each line, in the order of their ticks"},
	{"cut", NULL, CAU_OPTION_FLAG, AT(cut),
     .meaning = "run the cut of the scene instead of a script"},
	{"print-cut", NULL, CAU_OPTION_FLAG, AT(print_cut),
     .meaning = "print the cut of the scene as a script and end"},
	{"seconds", "T", CAU_OPTION_NUMBER, AT(seconds), 0, 1e6,
     .meaning = "simulated time (default: the time of the script and one second more)"},
	{"threads", "N", CAU_OPTION_WHOLE, AT(threads), 1, 16,
     .meaning = "number of threads, 1 to 16; the hash does not depend on it (default 1)"},
	{"unit-m", "U", CAU_OPTION_NUMBER, AT(unit_m), 1e-9, 1000,
     .meaning = "metres in one unit of a mesh file (default: guessed from its size)"},
	{"strict", NULL, CAU_OPTION_FLAG, AT(strict),
     .meaning = "refuse a mesh file that needs repair"},
	{"snapshot-at", "K", CAU_OPTION_LONG, AT(snapshot_at), 0, 1e9,
     .meaning = "at tick K, continue from a snapshot in a new session"},
	{"vtu", "DIR", CAU_OPTION_TEXT, AT(vtu),
     .meaning = "write the tissue for ParaView, with a collection cautery.pvd"},
	{"vtu-every", "N", CAU_OPTION_WHOLE, AT(vtu_every), 1, 1e9,
     .meaning = "ticks between the files of --vtu (default 10)"},
	{"csv", "FILE", CAU_OPTION_TEXT, AT(csv), .meaning = "write the statistics of every tick"},
	{"json", NULL, CAU_OPTION_FLAG, AT(json), .meaning = "print one JSON object as the last line"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "print this text"},
	{"version", NULL, CAU_OPTION_HELP, AT(version), .meaning = "print the version of this program"},
};

static const cau_command_line line = {
	.program = "cautery-sim",
	.summary = "Runs a scene without a server and prints a hash of its last state.\n",
	.closing =
		"Exit code: 0 done; 1 the simulation failed or a file could not be written;\n"
		"2 options; 3 scene, mesh or script; 4 done, but commands were refused at their tick.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows,
};

void sim_options_help(FILE *out)
{
	cau_options_help(&line, out);
}

bool sim_options_read(int argument_count, char **arguments, sim_options *options, FILE *complaints)
{
	*options = (sim_options){.seconds = -1.0, .threads = 1, .vtu_every = 10, .snapshot_at = -1};
	if (!cau_options_read(&line, argument_count, arguments, options, NULL, complaints))
		return false;
	if (options->help || options->version)
		return true;
	if (!options->scene) {
		fputs("cautery-sim: --scene is needed (see --help)\n", complaints);
		return false;
	}
	if (options->cut && options->script) {
		fputs("cautery-sim: --cut and --script exclude each other\n", complaints);
		return false;
	}
	return true;
}
