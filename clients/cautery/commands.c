// SPDX-License-Identifier: GPL-3.0-or-later
// The table of all commands, in the order of --help.
#include "cautery/cli.h"

const cli_command *const cli_commands[] = {
	&cli_ls,          &cli_scenes,      &cli_instruments, &cli_create,   &cli_info,
	&cli_watch,       &cli_tool,        &cli_run,         &cli_record,   &cli_export,
	&cli_log,         &cli_rm,          &cli_pause,       &cli_resume,   &cli_step,
	&cli_speed,       &cli_reset,       &cli_rewind,      &cli_fork,     &cli_snapshot,
	&cli_snapshots,   &cli_restore,     &cli_events,      &cli_pin,      &cli_unpin,
	&cli_force,       &cli_gravity,     &cli_material,    &cli_ping,     &cli_context_ls,
	&cli_context_set, &cli_context_use, &cli_context_rm,  &cli_backup,   &cli_move,
	&cli_token,       &cli_mesh,        &cli_completion,  &cli_complete, NULL,
};
