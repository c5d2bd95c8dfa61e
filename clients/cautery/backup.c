// SPDX-License-Identifier: GPL-3.0-or-later
// The command `backup`: copies the daemon's store to the daemon's own disk.
#include <string.h>

#include "cautery/commands.h"

static cli_exit run(cli *c)
{
	cau_wire_store_backup params = {.has_name = c->argument_count > 0};
	cau_wire_store_copy result = {0};
	if (params.has_name && strlen(c->arguments[0]) >= sizeof params.name) {
		fprintf(c->complaints, "cautery backup: NAME has at most %zu characters\n",
		        sizeof params.name - 1);
		return CLI_USAGE;
	}
	if (params.has_name)
		snprintf(params.name, sizeof params.name, "%s", c->arguments[0]);
	cli_exit code = cli_connect(c);
	if (!code)
		code = cli_call(c, CAU_METHOD_STORE_BACKUP, &params, &result);
	if (!code && !c->json)
		fprintf(c->out, "%s: %lld bytes\n", result.file, (long long)result.byte_count);
	return code;
}

const cli_command cli_backup = {
	.name = "backup",
	.arguments = "[NAME]",
	.summary = "copies the store of the running daemon; prints the path of the copy",
	.help =
		"The copy is on the daemon's machine, in the folder of its setting `backups`, as NAME.db\n"
		"(by default the time). The copy is checked. No file is replaced. Needs role admin. To\n"
		"restore: stop the daemon, replace its store with the copy, and start the daemon.\n",
	.most = 1,
	.run = run};
