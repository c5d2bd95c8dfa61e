// SPDX-License-Identifier: GPL-3.0-or-later
// cautery: the command-line client of cauteryd.
#include "cautery/cli.h"

int main(int argument_count, char **arguments)
{
	cli c = {.out = stdout,
	         .complaints = stderr,
	         .commands = cli_commands,
	         .def = cau_default_client_def()};
	c.def.name = "cautery";
	if (!cli_read(&c, argument_count, arguments))
		return CLI_USAGE;
	if (c.version) {
		puts("cautery " CAUTERY_VERSION " (" CAU_SUBPROTOCOL ")");
		return CLI_DONE;
	}
	if (c.help) {
		cli_help(&c);
		return CLI_DONE;
	}
	cli_exit code = c.command->run(&c);
	cli_finish(&c);
	return (int)code;
}
