// SPDX-License-Identifier: GPL-3.0-or-later
// The records of a snapshot that are not plain arrays: tools, commands and materials, member by
// member.
#pragma once

#include "session/session_internal.h"
#include "session/snapshot_bytes.h"

// All of a tool but its heat grid. `session` has the tissue that it holds.
void cau_snapshot_pass_tool(snapshot_archive *archive, const cau_session *session, cau_tool *tool);
// Origin and temperatures of a grid that has been made.
void cau_snapshot_pass_grid(snapshot_archive *archive, cau_heat_grid *grid);
// A command that waits. Of its values only those of its kind are passed; read, the rest are zero.
void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command);
// The materials of a layer: those of its kind.
void cau_snapshot_pass_layer(snapshot_archive *archive, cau_layer_def *layer);
