// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/drive.h"

#include <string.h>

cli_exit cli_join_tools(cli *c, cau_client_stream **stream)
{
	cau_wire_session_join join = {
		.has_rate_hz = true,
		.rate_hz = 60,
		.has_channels = true,
		.channels = CAU_CHANNEL_MASK | CAU_CHANNEL_TOOLS | CAU_CHANNEL_STATISTICS,
	};
	CLI_SESSION_PARAMS(c, &join);
	return cau_client_join(c->client, &join, stream, &c->error) ? cli_fail(c) : CLI_DONE;
}

const cau_stream_tool *cli_find_tool(const cau_client_stream *stream, const char *tool)
{
	for (int32_t i = 0; i < stream->state->tool_count; i++)
		if (strcmp(stream->state->tools[i].name, tool) == 0)
			return &stream->state->tools[i];
	return NULL;
}

cli_exit cli_take(cli *c, const cau_client_stream *stream, const char *tool)
{
	cau_wire_tool_ref params = {0};
	const cau_stream_tool *found = cli_find_tool(stream, tool);
	if (!found || found->driver == (uint32_t)cau_client_server(c->client)->client)
		return CLI_DONE;
	snprintf(params.tool, sizeof params.tool, "%s", tool);
	CLI_CHANGE_PARAMS(c, &params);
	return cau_client_call(c->client, CAU_METHOD_TOOL_TAKE_OVER, &params, NULL, &c->error)
	           ? cli_fail(c)
	           : CLI_DONE;
}
