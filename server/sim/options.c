// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/options.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>

enum {
	OPTION_SCENE = 1000,
	OPTION_SCENES,
	OPTION_SCRIPT,
	OPTION_CUT,
	OPTION_PRINT_CUT,
	OPTION_SECONDS,
	OPTION_THREADS,
	OPTION_UNIT,
	OPTION_SNAPSHOT,
	OPTION_VTU,
	OPTION_VTU_EVERY,
	OPTION_CSV,
	OPTION_JSON,
	OPTION_HELP,
};

static const struct option long_options[] = {
	{"scene", required_argument, NULL, OPTION_SCENE},
	{"scenes", required_argument, NULL, OPTION_SCENES},
	{"script", required_argument, NULL, OPTION_SCRIPT},
	{"cut", no_argument, NULL, OPTION_CUT},
	{"print-cut", no_argument, NULL, OPTION_PRINT_CUT},
	{"seconds", required_argument, NULL, OPTION_SECONDS},
	{"threads", required_argument, NULL, OPTION_THREADS},
	{"unit-m", required_argument, NULL, OPTION_UNIT},
	{"snapshot-at", required_argument, NULL, OPTION_SNAPSHOT},
	{"vtu", required_argument, NULL, OPTION_VTU},
	{"vtu-every", required_argument, NULL, OPTION_VTU_EVERY},
	{"csv", required_argument, NULL, OPTION_CSV},
	{"json", no_argument, NULL, OPTION_JSON},
	{"help", no_argument, NULL, OPTION_HELP},
	{NULL, 0, NULL, 0},
};

void sim_options_help(FILE *out)
{
	fputs("cautery-sim --scene S [options]\n"
	      "Runs a scene without a server and prints a hash of its last state.\n"
	      "\n"
	      "  --scene S         a scene's name, a scene file (.json) or a mesh (.msh, .obj, .vtk)\n"
	      "  --scenes DIR      where names are looked up (default: the installed scenes)\n"
	      "  --script FILE     commands, one JSON object a line, with ticks that never fall\n"
	      "  --cut             in place of a script: the cut that the scene describes\n"
	      "  --print-cut       print that cut as a script and end\n"
	      "  --seconds T       simulated time (default: the script's and one second more)\n"
	      "  --threads N       1 to 16 threads; the hash does not depend on it (default 1)\n"
	      "  --unit-m U        metres in one unit of a mesh file (default 1)\n"
	      "  --snapshot-at K   at tick K, go on from a snapshot in a fresh session\n"
	      "  --vtu DIR         write the tissue for ParaView, with a collection cautery.pvd\n"
	      "  --vtu-every N     ticks between those files (default 10)\n"
	      "  --csv FILE        write the statistics of every tick\n"
	      "  --json            one JSON object as the last line of output\n"
	      "  --help            this text\n"
	      "\n"
	      "Exit code: 0 done; 1 the simulation failed or a file could not be written;\n"
	      "2 options; 3 scene, mesh or script; 4 done, but commands were refused at their tick.\n",
	      out);
}

// A finite number within the bounds; complains and returns false otherwise.
static bool read_number(const char *name, const char *text, double least, double most,
                        double *value, FILE *complaints)
{
	char *end;
	*value = strtod(text, &end);
	if (end != text && *end == 0 && *value >= least && *value <= most)
		return true;
	fprintf(complaints, "cautery-sim: --%s wants a number from %g to %g, not \"%s\"\n", name, least,
	        most, text);
	return false;
}

static bool read_integer(const char *name, const char *text, double least, double most,
                         int64_t *value, FILE *complaints)
{
	double number;
	if (!read_number(name, text, least, most, &number, complaints))
		return false;
	*value = (int64_t)number;
	if ((double)*value == number)
		return true;
	fprintf(complaints, "cautery-sim: --%s wants a whole number, not \"%s\"\n", name, text);
	return false;
}

static bool read_count(const char *name, const char *text, double most, int32_t *value,
                       FILE *complaints)
{
	int64_t number;
	if (!read_integer(name, text, 1, most, &number, complaints))
		return false;
	*value = (int32_t)number;
	return true;
}

static bool read_option(int code, sim_options *options, FILE *complaints)
{
	switch (code) {
	case OPTION_SCENE:
		options->scene = optarg;
		return true;
	case OPTION_SCENES:
		options->scenes = optarg;
		return true;
	case OPTION_SCRIPT:
		options->script = optarg;
		return true;
	case OPTION_CUT:
		return options->cut = true;
	case OPTION_PRINT_CUT:
		return options->print_cut = true;
	case OPTION_SECONDS:
		return read_number("seconds", optarg, 0.0, 1e6, &options->seconds, complaints);
	case OPTION_THREADS:
		return read_count("threads", optarg, 16, &options->threads, complaints);
	case OPTION_UNIT:
		return read_number("unit-m", optarg, 1e-9, 1000.0, &options->unit_m, complaints);
	case OPTION_SNAPSHOT:
		return read_integer("snapshot-at", optarg, 0, 1e9, &options->snapshot_at, complaints);
	case OPTION_VTU:
		options->vtu = optarg;
		return true;
	case OPTION_VTU_EVERY:
		return read_count("vtu-every", optarg, 1e9, &options->vtu_every, complaints);
	case OPTION_CSV:
		options->csv = optarg;
		return true;
	case OPTION_JSON:
		return options->json = true;
	case OPTION_HELP:
		return options->help = true;
	default:
		return false; // getopt_long has said why
	}
}

bool sim_options_read(int argument_count, char **arguments, sim_options *options, FILE *complaints)
{
	*options = (sim_options){
		.unit_m = 1.0, .seconds = -1.0, .threads = 1, .vtu_every = 10, .snapshot_at = -1};
	optind = 0; // glibc: start afresh, so that tests may call this again
	for (int code; (code = getopt_long(argument_count, arguments, "", long_options, NULL)) != -1;)
		if (!read_option(code, options, complaints))
			return false;
	if (options->help)
		return true;
	if (optind < argument_count) {
		fprintf(complaints, "cautery-sim: \"%s\" is not an option\n", arguments[optind]);
		return false;
	}
	if (!options->scene) {
		fputs("cautery-sim: --scene is needed (--help tells more)\n", complaints);
		return false;
	}
	if (options->cut && options->script) {
		fputs("cautery-sim: --cut and --script exclude each other\n", complaints);
		return false;
	}
	return true;
}
