// SPDX-License-Identifier: GPL-3.0-or-later
// The records of a snapshot that are not plain arrays: tools, commands and materials, member by
// member.
#pragma once

#include "session/session_internal.h"
#include "session/snapshot_bytes.h"

// Passes a tool without its heat grid. `session` has the tissue that the tool holds.
void cau_snapshot_pass_tool(snapshot_archive *archive, const cau_session *session, cau_tool *tool);
// Passes origin and temperatures of a created grid.
void cau_snapshot_pass_grid(snapshot_archive *archive, cau_heat_grid *grid);
// Passes a waiting command. Only the values of its kind are passed; reading sets all other values
// to zero.
void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command);
// Passes the materials of a layer, of the layer's kind.
void cau_snapshot_pass_layer(snapshot_archive *archive, cau_layer_def *layer);
