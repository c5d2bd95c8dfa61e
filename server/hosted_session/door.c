// SPDX-License-Identifier: GPL-3.0-or-later
// Turns calls of transports, the watchdog and the store into events of a session's decisions.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/hosted.h"
#include "hosted_session/internal.h"

static cau_ask ask_of_command(const cau_order *order)
{
	static const cau_ask asks[CAU_COMMAND_COUNT] = {
		[CAU_COMMAND_TOOL_ADD] = CAU_ASK_TOOL_ADD,
		[CAU_COMMAND_TOOL_REMOVE] = CAU_ASK_TOOL_REMOVE,
		[CAU_COMMAND_TOOL_CONFIGURE] = CAU_ASK_TOOL_KEEP,
		[CAU_COMMAND_TOOL_MOVE] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_TOOL_GRASP] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_TOOL_RELEASE] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_TOOL_HOLD] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_PIN] = CAU_ASK_TISSUE,
		[CAU_COMMAND_UNPIN] = CAU_ASK_TISSUE,
		[CAU_COMMAND_SET_MATERIAL] = CAU_ASK_TISSUE,
		[CAU_COMMAND_SET_GRAVITY] = CAU_ASK_TISSUE,
		[CAU_COMMAND_SET_FORCE] = CAU_ASK_TISSUE,
	};
	const cau_command *command = &order->as.command;
	if (command->kind == CAU_COMMAND_TOOL_ENERGIZE)
		return command->as.energized ? CAU_ASK_ENERGY_ON : CAU_ASK_ENERGY_OFF;
	return order->motion ? CAU_ASK_MOTION : asks[command->kind];
}

static cau_ask ask_of(const cau_order *order)
{
#define CHANGE(kind, ask, apply) [CAU_ORDER_##kind] = CAU_ASK_##ask,
#define READ(...)
	static const cau_ask asks[CAU_ORDER_COUNT] = {CAU_ORDER_TABLE(CHANGE, READ)};
#undef CHANGE
#undef READ
	return order->kind == CAU_ORDER_COMMAND ? ask_of_command(order) : asks[order->kind];
}

static cau_part *part_of(cau_asked *asked, const char *tool, int32_t command)
{
	for (int32_t i = 0; i < asked->part_count; i++)
		if (strcmp(asked->parts[i].tool, tool) == 0)
			return &asked->parts[i];
	cau_part *made = &asked->parts[asked->part_count++];
	memcpy(made->tool, tool, sizeof made->tool);
	made->command = command;
	return made;
}

// Describes what an advance does with each tool. The transport ensures that the advance's commands
// use at most CAU_MAX_TOOLS tools, and that at most one command sets a tool's energy.
static void describe_parts(const cau_advance *advance, cau_asked *asked)
{
	asked->ticks = advance->ticks;
	for (int32_t i = 0; i < advance->command_count; i++) {
		const cau_command *command = &advance->commands[i];
		cau_part *part = part_of(asked, command->tool, i);
		bool energy = command->kind == CAU_COMMAND_TOOL_ENERGIZE;
		part->uses |= !energy;
		part->on |= energy && command->as.energized;
		part->off |= energy && !command->as.energized;
		if (energy && command->as.energized)
			part->limit = (uint64_t)command->as.ticks;
	}
}

static void name_tool(const cau_order *order, cau_asked *asked)
{
	const char *tool = "";
	if (order->kind == CAU_ORDER_COMMAND)
		tool = order->as.command.kind == CAU_COMMAND_TOOL_ADD ? order->as.command.as.definition.name
		       : asked->ask == CAU_ASK_TISSUE                 ? ""
		                                                      : order->as.command.tool;
	else if (asked->ask >= CAU_ASK_TAKE_OVER && asked->ask <= CAU_ASK_REQUEST_TAKEOVER)
		tool = order->as.tool.tool;
	snprintf(asked->tool, sizeof asked->tool, "%s", tool);
}

// Describes an order for the decisions.
static void describe(const cau_order *order, cau_asked *asked)
{
	*asked = (cau_asked){.ticket = (uintptr_t)order,
	                     .ask = ask_of(order),
	                     .asker = order->asker,
	                     .numbered = order->client_sequence && !order->motion,
	                     .alive_s = order->alive_s};
	name_tool(order, asked);
	if (order->kind == CAU_ORDER_COMMAND)
		asked->tick = order->as.command.tick;
	if (asked->ask == CAU_ASK_ENERGY_ON)
		asked->limit = (uint64_t)order->as.command.as.ticks;
	if (asked->ask == CAU_ASK_ADVANCE)
		describe_parts(order->as.advance, asked);
	if (asked->ask == CAU_ASK_STEP)
		asked->ticks = order->as.ticks;
	if (asked->ask == CAU_ASK_SPEED)
		asked->speed = order->as.speed;
	if (asked->ask == CAU_ASK_HAND_OVER && order->as.tool.to) {
		asked->to = (cau_asker){.client = order->as.tool.to,
		                        .role = order->as.tool.to_role,
		                        .deadline_s = order->as.tool.to_deadline_s};
		memcpy(asked->to.name, order->as.tool.to_name, sizeof asked->to.name);
	}
}

cau_status cau_hosted_submit(cau_hosted *h, cau_order *order, cau_error *error)
{
	cau_asked asked;
	bool motion = order->motion;
	if (h->life.ended)
		return cau_fail(error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
	order->came_s = cau_monotonic_s();
	if (cau_suspension_cancel(&h->suspension, h->identity.id, order))
		return CAU_OK;
	if (cau_reads_are(order))
		return cau_reads_submit(h, order, error);
	describe(order, &asked);
	cau_status status = cau_decide_order(h, order, &asked, error);
	if (status && motion)
		cau_refusals_note(&h->refusals, order, error);
	return status;
}

void cau_hosted_feed(cau_hosted *h, uint32_t client, double alive_s)
{
	cau_hosted_feed_tool(h, client, "", alive_s);
}

void cau_hosted_feed_tool(cau_hosted *h, uint32_t client, const char *tool, double alive_s)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_ALIVE,
	                                 .time_s = cau_monotonic_s(),
	                                 .alive_s = alive_s,
	                                 .client = client,
	                                 .tool = tool});
}

void cau_hosted_cut(cau_hosted *h, uint32_t client, const char *cause)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_AWAY,
	                                 .time_s = cau_monotonic_s(),
	                                 .client = client,
	                                 .cause = cause});
}

void cau_hosted_forget_client(cau_hosted *h, uint32_t client)
{
	cau_past_views_give_up(&h->past, client);
	cau_decide(h, &(cau_logic_event){
					  .kind = CAU_LOGIC_FORGET, .time_s = cau_monotonic_s(), .client = client});
}

double cau_hosted_watch(cau_hosted *h, double now_s)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_TIME, .time_s = now_s});
	return cau_decisions_look_s(&h->decisions);
}

void cau_hosted_store_takes(cau_hosted *h, bool takes, const char *reason)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_STORE,
	                                 .time_s = cau_monotonic_s(),
	                                 .store_takes = takes,
	                                 .cause = reason});
}

// Submits an order to destroy the session in the name of its creator. The creator is gone, so no
// answer is sent.
static void destroy_for(cau_hosted *h)
{
	cau_error error = {0};
	cau_order *order = calloc(1, sizeof *order);
	if (order) {
		order->kind = CAU_ORDER_DESTROY;
		order->asker = h->identity.creator;
	}
	if (!order || cau_hosted_submit(h, order, &error)) {
		free(order);
		cau_hosted_end(h);
	}
}

void cau_hosted_abandon(cau_hosted *h, uint32_t client)
{
	if (h->creation.origin.kind == CAU_ORIGIN_STORE || h->identity.creator.client != client ||
	    !client)
		return;
	if (h->creation.starting)
		h->creation.abandoned = true;
	else if (h->identity.around->ephemeral)
		destroy_for(h);
}

bool cau_hosted_is_ephemeral(const cau_hosted *h)
{
	return h->identity.around->ephemeral;
}

bool cau_hosted_is_advanced_by(cau_hosted *h, uint32_t client)
{
	return client && cau_decisions_now(&h->decisions).lockstep == client;
}

bool cau_hosted_is_own_ephemeral(const cau_hosted *h, uint32_t client)
{
	return h->identity.around->ephemeral && h->identity.creator.client == client;
}
