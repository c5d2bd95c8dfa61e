// SPDX-License-Identifier: GPL-3.0-or-later
// All commands of `cautery`. The comment after each command names its file.
#pragma once

#include "cautery/cli.h"

extern const cli_command *const cli_commands[]; // NULL marks the end

extern const cli_command cli_ls, cli_scenes, cli_instruments;        // list.c
extern const cli_command cli_create;                                 // create.c
extern const cli_command cli_info;                                   // info.c
extern const cli_command cli_watch;                                  // watch.c
extern const cli_command cli_tool;                                   // tool.c
extern const cli_command cli_run;                                    // run.c
extern const cli_command cli_record;                                 // record.c
extern const cli_command cli_export, cli_log;                        // files.c
extern const cli_command cli_rm;                                     // list.c
extern const cli_command cli_pause, cli_resume, cli_step;            // time.c
extern const cli_command cli_speed, cli_reset;                       // time.c
extern const cli_command cli_rewind, cli_fork, cli_snapshot;         // history.c
extern const cli_command cli_snapshots, cli_restore;                 // history.c
extern const cli_command cli_events;                                 // events.c
extern const cli_command cli_pin, cli_unpin, cli_force, cli_gravity; // tissue.c
extern const cli_command cli_material;                               // material.c
extern const cli_command cli_backup;                                 // backup.c
extern const cli_command cli_move;                                   // move.c
extern const cli_command cli_ping;                                   // ping.c
extern const cli_command cli_context_ls, cli_context_set;            // context.c
extern const cli_command cli_context_use, cli_context_rm;            // context.c
extern const cli_command cli_token;                                  // token.c
extern const cli_command cli_mesh;                                   // mesh.c
extern const cli_command cli_completion, cli_complete;               // completion.c
