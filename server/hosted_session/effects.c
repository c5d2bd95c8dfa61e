// SPDX-License-Identifier: GPL-3.0-or-later
// Connects the session's decisions (server/session) with other threads. An event is handled under
// one short lock. Its effects are carried out here, except acts of the worker.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

static cau_order *order_of(uint64_t ticket)
{
	return (cau_order *)(uintptr_t)ticket;
}

// ---- effects ------------------------------------------------------------------------------------

// Notifies clients under the lock, so that they receive the decisions in the order of the
// decisions.
static void tell(cau_hosted *h, const cau_effects *effects)
{
	for (int32_t i = 0; i < effects->count; i++)
		if (effects->list[i].kind == CAU_EFFECT_TELL) {
			cau_driver_notify(&h->identity, &effects->list[i].drive);
			h->frames.dirty = true;
		}
}

void cau_hosted_answer_unstored(cau_hosted *h, cau_order *order)
{
	bool pause = order->kind == CAU_ORDER_PAUSE;
	cau_wire_session_summary summary;
	cau_hosted_summary(h, &summary);
	summary.has_stored = true;
	summary.stored = false;
	summary.state = CAU_SESSION_PAUSED;
	cau_wire_command_result result = {.tick = summary.tick,
	                                  .sequence = (int64_t)order->as.command.sequence,
	                                  .has_stored = true,
	                                  .stored = false};
	if (order->reply.answer)
		cau_answer_now(&order->reply, pause ? (void *)&summary : (void *)&result);
	cau_log(CAU_LOG_WARNING, h->identity.id, "not_stored", "order=%s tool=%s client=\"%s\"",
	        pause ? "pause" : "energy_off", pause ? "" : order->as.command.tool, order->asker.name);
	free(order);
}

// Carries out effects after the lock is released. If the order that is being submitted was refused,
// *own is that refusal.
static void perform(cau_hosted *h, const cau_effects *effects, const cau_order *submitted,
                    const cau_effect **own)
{
	for (int32_t i = 0; i < effects->count; i++) {
		const cau_effect *effect = &effects->list[i];
		switch (effect->kind) {
		case CAU_EFFECT_REFUSE:
			if (own && submitted == order_of(effect->ticket))
				*own = effect;
			else
				cau_answer_fail(order_of(effect->ticket), &effect->error, effect->code);
			break;
		case CAU_EFFECT_REPLACED:
			free(order_of(effect->ticket));
			break;
		case CAU_EFFECT_UNSTORED:
			cau_hosted_answer_unstored(h, order_of(effect->ticket));
			break;
		case CAU_EFFECT_WAKE:
			cau_worker_pool_wake(h->identity.around->pool, &h->task);
			break;
		case CAU_EFFECT_ARMED:
			h->identity.around->armed(h->identity.around->user);
			break;
		case CAU_EFFECT_TELL:
			break;
		}
	}
}

// Handles one event under the lock. The trace gets the event before the call, and the effects after
// the call. Because of the lock, the trace has the order of the calls.
static void apply(cau_hosted *h, const cau_logic_event *event, cau_effects *effects)
{
	cau_trace_take(h->decisions.trace, event);
	cau_logic_take(h->decisions.logic, event, effects);
	cau_trace_effects(h->decisions.trace, effects);
	tell(h, effects);
}

static void take(cau_hosted *h, const cau_logic_event *event, const cau_order *submitted,
                 cau_effects *effects, const cau_effect **own)
{
	pthread_mutex_lock(&h->decisions.lock);
	apply(h, event, effects);
	pthread_mutex_unlock(&h->decisions.lock);
	perform(h, effects, submitted, own);
}

void cau_decide(cau_hosted *h, const cau_logic_event *event)
{
	cau_effects effects;
	take(h, event, NULL, &effects, NULL);
}

cau_status cau_decide_order(cau_hosted *h, cau_order *order, const cau_asked *asked,
                            cau_error *error)
{
	cau_effects effects;
	const cau_effect *own = NULL;
	take(h,
	     &(cau_logic_event){.kind = CAU_LOGIC_ORDER, .time_s = cau_monotonic_s(), .asked = asked},
	     order, &effects, &own);
	if (!own)
		return CAU_OK;
	*error = own->error;
	return own->error.status;
}

// ---- commands that wait for later ticks ---------------------------------------------------------

// Describes a waiting command. Its ticket points to an order that is still allocated, because
// orders leave the queue only under the lock.
static void describe_later(const cau_waiting *waiting, cau_wire_waiting_command *to)
{
	const cau_asked *asked = &waiting->asked;
	const cau_order *order = order_of(asked->ticket);
	*to = (cau_wire_waiting_command){.number = (int64_t)waiting->moment,
	                                 .tick = (int64_t)asked->tick,
	                                 .has_tool = *asked->tool != 0,
	                                 .sequence = (int64_t)order->as.command.sequence,
	                                 .client = asked->asker.client};
	snprintf(to->method, sizeof to->method, "%s", cau_method_describe(order->reply.method)->name);
	memcpy(to->tool, asked->tool, sizeof to->tool);
	snprintf(to->name, sizeof to->name, "%.64s", asked->asker.name);
}

int32_t cau_hosted_waiting(cau_hosted *h, cau_wire_waiting_command *list, int32_t capacity)
{
	int32_t count = 0, place = 0;
	pthread_mutex_lock(&h->decisions.lock);
	for (const cau_waiting *waiting; (waiting = cau_logic_later(h->decisions.logic, &place));)
		if (count < capacity)
			describe_later(waiting, &list[count++]);
	pthread_mutex_unlock(&h->decisions.lock);
	return count;
}

static int32_t count_later(const cau_logic *logic)
{
	int32_t count = 0, place = 0;
	while (cau_logic_later(logic, &place))
		count++;
	return count;
}

int32_t cau_hosted_cancel(cau_hosted *h, uint32_t client, uint64_t number)
{
	cau_effects effects;
	cau_logic_event event = {
		.kind = CAU_LOGIC_CANCEL, .time_s = cau_monotonic_s(), .client = client, .number = number};
	pthread_mutex_lock(&h->decisions.lock);
	int32_t before = count_later(h->decisions.logic);
	apply(h, &event, &effects);
	int32_t cancelled = before - count_later(h->decisions.logic);
	pthread_mutex_unlock(&h->decisions.lock);
	perform(h, &effects, NULL, NULL);
	return cancelled;
}

// ---- acts of the worker -------------------------------------------------------------------------

// Compares the tools that the core would heat in the next tick with the tools whose energy is on.
// Called under the lock, so that no energy cut-off comes in between.
static void compare(cau_hosted_decisions *decisions, const cau_session *core)
{
	const char *allowed[CAU_MAX_TOOLS];
	int32_t count = 0;
	for (int32_t i = 0; i < decisions->logic->drive_count; i++) {
		const cau_drive *drive = &decisions->logic->drives[i];
		if (drive->enabled && drive->energized && !drive->freeze)
			allowed[count++] = drive->tool;
	}
	const char *odd = cau_session_heats_beyond(core, allowed, count);
	snprintf(decisions->odd_tool, sizeof decisions->odd_tool, "%s", odd ? odd : "");
}

void cau_decide_next(cau_hosted *h, cau_action *action)
{
	cau_effects effects;
	pthread_mutex_lock(&h->decisions.lock);
	double now_s = cau_monotonic_s(), due_s = h->decisions.logic->next_step_s;
	cau_trace_next(h->decisions.trace, now_s);
	cau_logic_next(h->decisions.logic, now_s, action, &effects);
	h->pace.late_s = h->decisions.logic->state == CAU_SESSION_RUNNING ? now_s - due_s : -1;
	cau_trace_action(h->decisions.trace, action);
	if (action->act == CAU_ACT_STEP)
		compare(&h->decisions, h->core.session);
	cau_trace_effects(h->decisions.trace, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->decisions.lock);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome)
{
	cau_effects effects;
	pthread_mutex_lock(&h->decisions.lock);
	double now_s = cau_monotonic_s();
	cau_trace_done(h->decisions.trace, now_s, outcome);
	cau_logic_done(h->decisions.logic, now_s, outcome, &effects);
	cau_trace_effects(h->decisions.trace, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->decisions.lock);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_stepped(cau_hosted *h, const char *fault)
{
	cau_effects effects;
	pthread_mutex_lock(&h->decisions.lock);
	double now_s = cau_monotonic_s();
	cau_trace_stepped(h->decisions.trace, now_s, fault);
	cau_logic_stepped(h->decisions.logic, now_s, fault, &effects);
	cau_trace_effects(h->decisions.trace, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->decisions.lock);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_arrived(cau_hosted *h, int state, const char *cause)
{
	cau_frame frame;
	cau_arrived_tool tools[CAU_MAX_TOOLS];
	cau_session_frame(h->core.session, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++) {
		memcpy(tools[i].name, frame.tools[i].name, sizeof tools[i].name);
		// A store of an older build may have commands that wait in the core. These commands could
		// still enable or move the tool, so they are voided too.
		tools[i].energized = frame.tools[i].energized ||
		                     cau_session_waiting(h->core.session, frame.tools[i].name) > 0;
	}
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                                 .time_s = cau_monotonic_s(),
	                                 .cause = cause,
	                                 .state = state,
	                                 .tick = h->core.tick,
	                                 .step_s = h->core.info.step_s,
	                                 .tools = tools,
	                                 .tool_count = frame.tool_count});
}
