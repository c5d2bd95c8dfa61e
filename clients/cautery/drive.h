// SPDX-License-Identifier: GPL-3.0-or-later
// Functions for the commands that drive tools.
#pragma once

#include "cautery/cli.h"

// Joins the session at 60 Hz for the tools, the face mask and the statistics.
cli_exit cli_join_tools(cli *c, cau_client_stream **stream);

// Becomes the driver of the tool, if the tool exists and this client does not drive it already.
cli_exit cli_take(cli *c, const cau_client_stream *stream, const char *tool);

// Returns the newest state of a tool, or NULL if there is no such tool.
const cau_stream_tool *cli_find_tool(const cau_client_stream *stream, const char *tool);
