// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/options.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>

#include "cautery/client.h"

enum {
	OPTION_URL = 1000,
	OPTION_TOKEN,
	OPTION_SCENE,
	OPTION_SESSIONS,
	OPTION_VIEWERS,
	OPTION_SECONDS,
	OPTION_WARM_UP,
	OPTION_SLOW,
	OPTION_RATE,
	OPTION_JSON,
	OPTION_HELP,
};

static const struct option long_options[] = {
	{"url", required_argument, NULL, OPTION_URL},
	{"token", required_argument, NULL, OPTION_TOKEN},
	{"scene", required_argument, NULL, OPTION_SCENE},
	{"sessions", required_argument, NULL, OPTION_SESSIONS},
	{"viewers", required_argument, NULL, OPTION_VIEWERS},
	{"seconds", required_argument, NULL, OPTION_SECONDS},
	{"warm-up", required_argument, NULL, OPTION_WARM_UP},
	{"slow", required_argument, NULL, OPTION_SLOW},
	{"rate", required_argument, NULL, OPTION_RATE},
	{"json", no_argument, NULL, OPTION_JSON},
	{"help", no_argument, NULL, OPTION_HELP},
	{NULL, 0, NULL, 0},
};

void load_options_help(FILE *out)
{
	fputs(
		"cautery-load [options]\n"
		"Loads a running daemon with sessions, viewers and drivers, and measures what they see.\n"
		"\n"
		"  --url U         where the daemon is (default: CAUTERYD_URL, else " CAU_CLIENT_DEFAULT_URL
		")\n"
		"  --token T       access token, role operate or more (default: CAUTERYD_TOKEN)\n"
		"  --scene NAME    of the sessions (default fascia)\n"
		"  --sessions S    sessions made, and removed in the end (default 1)\n"
		"  --viewers V     of each session; the first one drives its tool (default 1)\n"
		"  --seconds T     measured (default 10)\n"
		"  --warm-up W     seconds before that (default 2)\n"
		"  --slow P        per cent of the other viewers that read 50 ms in every second\n"
		"  --rate HZ       frames a second that viewers ask for (default 60)\n"
		"  --json          one JSON object as the last line of output\n"
		"  --help          this text\n"
		"\n"
		"Exit code: 0 measured; 1 the daemon refused; 2 options; 3 no daemon, or lost.\n",
		out);
}

static bool read_number(const char *name, double least, double most, double *value,
                        FILE *complaints)
{
	char *end;
	*value = strtod(optarg, &end);
	if (end != optarg && *end == 0 && *value >= least && *value <= most)
		return true;
	fprintf(complaints, "cautery-load: --%s wants a number from %g to %g, not \"%s\"\n", name,
	        least, most, optarg);
	return false;
}

static bool read_count(const char *name, double most, int32_t *value, FILE *complaints)
{
	double number;
	if (!read_number(name, 1, most, &number, complaints))
		return false;
	*value = (int32_t)number;
	if (*value == number)
		return true;
	fprintf(complaints, "cautery-load: --%s wants a whole number, not \"%s\"\n", name, optarg);
	return false;
}

static bool read_option(int code, load_options *options, FILE *complaints)
{
	switch (code) {
	case OPTION_URL:
		options->url = optarg;
		return true;
	case OPTION_TOKEN:
		options->token = optarg;
		return true;
	case OPTION_SCENE:
		options->scene = optarg;
		return true;
	case OPTION_SESSIONS:
		return read_count("sessions", 4096, &options->sessions, complaints);
	case OPTION_VIEWERS:
		return read_count("viewers", 4096, &options->viewers, complaints);
	case OPTION_SECONDS:
		return read_number("seconds", 0.5, 86400, &options->seconds, complaints);
	case OPTION_WARM_UP:
		return read_number("warm-up", 0, 3600, &options->warm_up_s, complaints);
	case OPTION_SLOW:
		return read_number("slow", 0, 100, &options->slow_pct, complaints);
	case OPTION_RATE:
		return read_number("rate", 0.1, 1000, &options->rate_hz, complaints);
	case OPTION_JSON:
		return options->json = true;
	case OPTION_HELP:
		return options->help = true;
	default:
		return false; // getopt_long has said why
	}
}

bool load_options_read(int argument_count, char **arguments, load_options *options,
                       FILE *complaints)
{
	const char *url = getenv("CAUTERYD_URL");
	*options = (load_options){.url = url ? url : CAU_CLIENT_DEFAULT_URL,
	                          .token = getenv("CAUTERYD_TOKEN"),
	                          .scene = "fascia",
	                          .sessions = 1,
	                          .viewers = 1,
	                          .seconds = 10,
	                          .warm_up_s = 2,
	                          .rate_hz = 60};
	optind = 0; // glibc: start afresh, so that tests may call this again
	for (int code; (code = getopt_long(argument_count, arguments, "", long_options, NULL)) != -1;)
		if (!read_option(code, options, complaints))
			return false;
	if (optind < argument_count) {
		fprintf(complaints, "cautery-load: \"%s\" belongs to no option\n", arguments[optind]);
		return false;
	}
	return true;
}
