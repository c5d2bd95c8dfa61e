// SPDX-License-Identifier: GPL-3.0-or-later
// The door between the session's decisions (server/session) and the threads around them: events go
// in under one short lock, and what they lead to is done here, but for what is the worker's.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/tools.h"

static cau_order *order_of(uint64_t ticket)
{
	return (cau_order *)(uintptr_t)ticket;
}

// ---- effects ------------------------------------------------------------------------------------

// Under the lock, so that nobody hears of two decisions in the other order.
static void tell(cau_hosted *h, const cau_effects *effects)
{
	for (int32_t i = 0; i < effects->count; i++)
		if (effects->list[i].kind == CAU_EFFECT_TELL)
			cau_drive_tell(h, &effects->list[i].drive);
}

// It acts at the next tick border, whatever the store says; the log will not show it.
static void answer_unstored(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_wire_session_summary summary;
	cau_hosted_summary(h, &summary);
	summary.has_stored = true;
	summary.stored = false;
	summary.state = CAU_SESSION_PAUSED;
	cau_wire_command_result result = {.tick = summary.tick,
	                                  .sequence = (int64_t)order->as.command.sequence,
	                                  .has_stored = true,
	                                  .stored = false};
	bool pause = order->kind == CAU_ORDER_PAUSE;
	char *text = order->reply.answer ? cau_answer_text(order->reply.method,
	                                                   pause ? (void *)&summary : (void *)&result,
	                                                   &outcome.text_bytes, &error)
	                                 : NULL;
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(&order->reply, &outcome);
	cau_log(CAU_LOG_WARNING, h->id, "not_stored", "order=%s tool=%s client=\"%s\"",
	        pause ? "pause" : "energy_off", pause ? "" : order->as.command.tool, order->asker.name);
	free(text);
	free(order);
}

// After the lock is given back. The refusal of the order that is just being submitted goes to *own.
static void perform(cau_hosted *h, const cau_effects *effects, const cau_order *submitted,
                    const cau_effect **own)
{
	for (int32_t i = 0; i < effects->count; i++) {
		const cau_effect *effect = &effects->list[i];
		switch (effect->kind) {
		case CAU_EFFECT_REFUSE:
			if (submitted == order_of(effect->ticket))
				*own = effect;
			else
				cau_answer_fail(order_of(effect->ticket), &effect->error, effect->code);
			break;
		case CAU_EFFECT_REPLACED:
			free(order_of(effect->ticket));
			break;
		case CAU_EFFECT_UNSTORED:
			answer_unstored(h, order_of(effect->ticket));
			break;
		case CAU_EFFECT_WAKE:
			cau_worker_pool_wake(h->around->pool, &h->task);
			break;
		case CAU_EFFECT_ARMED:
			h->around->armed(h->around->user);
			break;
		case CAU_EFFECT_TELL:
			break;
		}
	}
}

static void take(cau_hosted *h, const cau_logic_event *event, const cau_order *submitted,
                 cau_effects *effects, const cau_effect **own)
{
	pthread_mutex_lock(&h->deciding);
	cau_logic_take(h->logic, event, effects);
	tell(h, effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, effects, submitted, own);
}

void cau_decide(cau_hosted *h, const cau_logic_event *event)
{
	cau_effects effects;
	take(h, event, NULL, &effects, NULL);
}

// ---- the worker's side --------------------------------------------------------------------------

void cau_decide_next(cau_hosted *h, cau_action *action)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	cau_logic_next(h->logic, cau_monotonic_s(), action, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	cau_logic_done(h->logic, cau_monotonic_s(), outcome, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_stepped(cau_hosted *h, const char *fault)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	cau_logic_stepped(h->logic, cau_monotonic_s(), fault, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_arrived(cau_hosted *h, int state, const char *cause)
{
	cau_frame frame;
	cau_arrived_tool tools[CAU_MAX_TOOLS];
	cau_session_frame(h->core, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++) {
		memcpy(tools[i].name, frame.tools[i].name, sizeof tools[i].name);
		tools[i].lit = frame.tools[i].energized;
	}
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                                 .time_s = cau_monotonic_s(),
	                                 .cause = cause,
	                                 .state = state,
	                                 .tick = h->tick,
	                                 .step_s = h->info.step_s,
	                                 .tools = tools,
	                                 .tool_count = frame.tool_count});
}

// ---- from any thread ----------------------------------------------------------------------------

static cau_ask ask_of_command(const cau_order *order)
{
	static const cau_ask asks[CAU_COMMAND_COUNT] = {
		[CAU_COMMAND_TOOL_ADD] = CAU_ASK_TOOL_ADD,
		[CAU_COMMAND_TOOL_REMOVE] = CAU_ASK_TOOL_REMOVE,
		[CAU_COMMAND_TOOL_CONFIGURE] = CAU_ASK_TOOL_KEEP,
		[CAU_COMMAND_TOOL_MOVE] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_TOOL_GRASP] = CAU_ASK_TOOL_USE,
		[CAU_COMMAND_TOOL_RELEASE] = CAU_ASK_TOOL_USE,
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

// What there is to decide about an order.
static void describe(const cau_order *order, cau_asked *asked)
{
	*asked = (cau_asked){.ticket = (uintptr_t)order,
	                     .ask = ask_of(order),
	                     .asker = order->asker,
	                     .numbered = order->client_sequence && !order->motion};
	name_tool(order, asked);
	if (asked->ask == CAU_ASK_ENERGY_ON || asked->ask == CAU_ASK_ENERGY_OFF)
		asked->tick = order->as.command.tick;
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
	cau_effects effects;
	const cau_effect *own = NULL;
	if (h->ended)
		return cau_fail(error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
	if (cau_building_cancel(h, order))
		return CAU_OK;
	if (cau_reads_are(order))
		return cau_reads_submit(h, order, error);
	describe(order, &asked);
	take(h,
	     &(cau_logic_event){.kind = CAU_LOGIC_ORDER, .time_s = cau_monotonic_s(), .asked = &asked},
	     order, &effects, &own);
	if (!own)
		return CAU_OK;
	*error = own->error;
	if (order->motion)
		cau_drive_refuse(h, order, error);
	return own->error.status;
}

void cau_hosted_feed(cau_hosted *h, uint32_t client)
{
	cau_hosted_feed_tool(h, client, "");
}

void cau_hosted_feed_tool(cau_hosted *h, uint32_t client, const char *tool)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_ALIVE,
	                                 .time_s = cau_monotonic_s(),
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
	cau_decide(h, &(cau_logic_event){
					  .kind = CAU_LOGIC_FORGET, .time_s = cau_monotonic_s(), .client = client});
}

double cau_hosted_watch(cau_hosted *h, double now_s)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_TIME, .time_s = now_s});
	pthread_mutex_lock(&h->deciding);
	double look_s = cau_logic_look_s(h->logic);
	pthread_mutex_unlock(&h->deciding);
	return look_s;
}

void cau_hosted_store_takes(cau_hosted *h, bool takes, const char *reason)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_STORE,
	                                 .time_s = cau_monotonic_s(),
	                                 .store_takes = takes,
	                                 .cause = reason});
}

bool cau_decide_find(cau_hosted *h, const char *tool, cau_drive *drive)
{
	pthread_mutex_lock(&h->deciding);
	const cau_drive *found = cau_logic_drive(h->logic, tool);
	if (found)
		*drive = *found;
	pthread_mutex_unlock(&h->deciding);
	return found != NULL;
}

int32_t cau_decide_drives(cau_hosted *h, cau_drive *drives)
{
	pthread_mutex_lock(&h->deciding);
	int32_t count = h->logic->drive_count;
	memcpy(drives, h->logic->drives, (size_t)count * sizeof *drives);
	pthread_mutex_unlock(&h->deciding);
	return count;
}
