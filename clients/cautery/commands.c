// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "cautery/commands.h"

const cli_command *const cli_commands[] = {
	&cli_ls,       &cli_scenes,    &cli_create,  &cli_info,     &cli_watch,  &cli_tool,
	&cli_run,      &cli_record,    &cli_export,  &cli_log,      &cli_rm,     &cli_pause,
	&cli_resume,   &cli_step,      &cli_speed,   &cli_reset,    &cli_rewind, &cli_fork,
	&cli_snapshot, &cli_snapshots, &cli_restore, &cli_timeline, NULL,
};

const cli_command *cli_find_command(const char *name)
{
	for (int i = 0; cli_commands[i]; i++)
		if (strcmp(cli_commands[i]->name, name) == 0)
			return cli_commands[i];
	return NULL;
}
