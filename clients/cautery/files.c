// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `export` and `log`: download files from the daemon.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/progress.h"

static cli_exit download(cli *c, cau_method method, const void *params, const char *file)
{
	cau_wire_transfer transfer = {0};
	unsigned char *bytes = NULL;
	cli_progress progress;
	cli_exit code = CLI_DONE;
	cli_progress_begin(&progress, c->complaints, file);
	cau_status status = cau_client_download(c->client, method, params, cli_progress_bytes,
	                                        &progress, &transfer, &bytes, &c->error);
	cli_progress_end(&progress);
	if (status)
		code = cli_fail(c);
	else if (cli_write_file(file, bytes, (size_t)transfer.byte_count, &c->error))
		code = cli_fail_file(c);
	else if (c->json)
		cli_print_result(c, method, &transfer);
	else if (strcmp(file, "-") != 0)
		fprintf(c->out, "%s: %lld bytes\n", file, (long long)transfer.byte_count);
	free(bytes);
	return code;
}

static bool choose_format(cli *c, int32_t *format)
{
	const char *given = cli_value(c, "format");
	const char *file = c->arguments[c->argument_count - 1], *ending = strrchr(file, '.');
	if (!given && ending)
		given = ending + 1;
	*format = !given                      ? -1
	          : strcmp(given, "vtu") == 0 ? CAU_EXPORT_VTU
	          : strcmp(given, "obj") == 0 ? CAU_EXPORT_OBJ
	                                      : -1;
	if (*format < 0)
		cli_complain(c, "the format is not known: name FILE with .vtu or .obj, or give --format");
	return *format >= 0;
}

static cli_exit run_export(cli *c)
{
	cau_wire_session_export params = {0};
	cli_exit code = choose_format(c, &params.format) ? cli_connect(c) : CLI_USAGE;
	if (code)
		return code;
	CLI_SESSION_PARAMS(c, &params);
	return download(c, CAU_METHOD_SESSION_EXPORT, &params, c->arguments[0]);
}

static cli_exit run_log(cli *c)
{
	bool bad = false;
	cau_wire_session_log params = {.has_from_tick = true, .has_to_tick = cli_value(c, "to")};
	params.from_tick = (int64_t)cli_number(c, "from", 0, cli_tick_max, 0, &bad);
	params.to_tick = (int64_t)cli_number(c, "to", 0, cli_tick_max, 0, &bad);
	cli_exit code = bad ? CLI_USAGE : cli_connect(c);
	if (code)
		return code;
	CLI_SESSION_PARAMS(c, &params);
	return download(c, CAU_METHOD_SESSION_LOG, &params, c->arguments[0]);
}

const cli_command cli_export = {
	.name = "export",
	.arguments = "[SESSION] FILE",
	.summary = "writes the present tissue to a file: .vtu for ParaView, .obj for other programs",
	.least = 1,
	.most = 1,
	.session_optional = true,
	.options = {{"format", "F", "vtu or obj (default: FILE's ending)"}},
	.run = run_export};

const cli_command cli_log = {.name = "log",
                             .arguments = "[SESSION] FILE",
                             .summary = "writes the commands of a session as a script",
                             .help = "`cautery run` and `cautery-sim --script` run it again.\n",
                             .least = 1,
                             .most = 1,
                             .session_optional = true,
                             .options = {{"from", "TICK", "first tick (default 0)"},
                                         {"to", "TICK", "last tick (default: now)"}},
                             .run = run_log};
