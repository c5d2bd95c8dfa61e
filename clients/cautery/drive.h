// SPDX-License-Identifier: GPL-3.0-or-later
// What commands that drive tools share.
#pragma once

#include "cautery/cli.h"

// Joins the session's tools, mask and statistics at 60 Hz.
cli_exit cli_join_tools(cli *c, cau_client_stream **stream);

// Becomes the tool's driver, if it exists and somebody else or nobody drives it.
cli_exit cli_take(cli *c, const cau_client_stream *stream, const char *tool);

// NULL: there is no such tool.
const cau_stream_tool *cli_find_tool(const cau_client_stream *stream, const char *tool);
