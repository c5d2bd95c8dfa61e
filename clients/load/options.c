// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <stdlib.h>

#include "cautery/client.h"
#include "cautery/options.h"

#define AT(member) offsetof(load_options, member)

static const cau_option rows[] = {
	{"url", "U", CAU_OPTION_TEXT, AT(url),
     .meaning = "address of the daemon (default: CAUTERYD_URL, else " CAU_CLIENT_DEFAULT_URL ")"},
	{"token-file", "F", CAU_OPTION_TEXT, AT(token_file),
     .meaning = "file with an access token of role operate or admin (default: CAUTERYD_TOKEN)"},
	{"scene", "NAME", CAU_OPTION_TEXT, AT(scene),
     .meaning = "scene of the sessions (default fascia)"},
	{"sessions", "S", CAU_OPTION_WHOLE, AT(sessions), 1, 4096,
     .meaning = "number of sessions, which are removed at the end (default 1)"},
	{"viewers", "V", CAU_OPTION_WHOLE, AT(viewers), 1, 4096,
     .meaning = "viewers of each session; the first viewer drives the tool (default 1)"},
	{"seconds", "T", CAU_OPTION_NUMBER, AT(seconds), 0.5, 86400,
     .meaning = "seconds to measure (default 10); Ctrl-C ends them early"},
	{"warm-up", "W", CAU_OPTION_NUMBER, AT(warm_up_s), 0, 3600,
     .meaning = "seconds before measuring (default 2)"},
	{"slow", "P", CAU_OPTION_NUMBER, AT(slow_pct), 0, 100,
     .meaning = "per cent of the other viewers that read for only 50 ms in every second"},
	{"rate", "HZ", CAU_OPTION_NUMBER, AT(rate_hz), 0.1, 1000,
     .meaning = "frames a second that viewers ask for (default 60)"},
	{"json", NULL, CAU_OPTION_FLAG, AT(json), .meaning = "print one JSON object as the last line"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "print this text"},
	{"version", NULL, CAU_OPTION_HELP, AT(version), .meaning = "print the version of this program"},
};

static const cau_command_line line = {
	.program = "cautery-load",
	.summary =
		"Loads a running daemon with sessions, viewers and drivers, and measures what they see.\n",
	.closing = "Exit code: 0 measured; 1 the daemon refused; 2 options; 3 no daemon, or lost.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows,
};

void load_options_help(FILE *out)
{
	cau_options_help(&line, out);
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
	return cau_options_read(&line, argument_count, arguments, options, NULL, complaints);
}
