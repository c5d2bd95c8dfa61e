// SPDX-License-Identifier: GPL-3.0-or-later
// The door between the session's decisions (server/session) and the threads around them: events go
// in under one short lock, and what they lead to is done here, but for what is the worker's.
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

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

void cau_hosted_answer_unstored(cau_hosted *h, cau_order *order)
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

// Into the trace, if there is one, goes each call before it is made and what came of it, under the
// lock: it is the order of both that counts.
static void apply(cau_hosted *h, const cau_logic_event *event, cau_effects *effects)
{
	cau_trace_take(h->trace, event);
	cau_logic_take(h->logic, event, effects);
	cau_trace_effects(h->trace, effects);
	tell(h, effects);
}

static void take(cau_hosted *h, const cau_logic_event *event, const cau_order *submitted,
                 cau_effects *effects, const cau_effect **own)
{
	pthread_mutex_lock(&h->deciding);
	apply(h, event, effects);
	pthread_mutex_unlock(&h->deciding);
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

// ---- what waits for later ticks -----------------------------------------------------------------

// A ticket in the queue is an order that lives: orders leave it under the lock.
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
	pthread_mutex_lock(&h->deciding);
	for (const cau_waiting *waiting; (waiting = cau_logic_later(h->logic, &place));)
		if (count < capacity)
			describe_later(waiting, &list[count++]);
	pthread_mutex_unlock(&h->deciding);
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
	pthread_mutex_lock(&h->deciding);
	int32_t before = count_later(h->logic);
	apply(h, &event, &effects);
	int32_t cancelled = before - count_later(h->logic);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
	return cancelled;
}

// ---- the worker's side --------------------------------------------------------------------------

// Whether the core heats what the machine has on, and nothing else, in the tick that is to begin.
// Under the lock, so that no cut comes between.
static void compare(cau_hosted *h)
{
	const char *allowed[CAU_MAX_TOOLS];
	int32_t count = 0;
	for (int32_t i = 0; i < h->logic->drive_count; i++) {
		const cau_drive *drive = &h->logic->drives[i];
		if (drive->enabled && drive->lit && !drive->freeze)
			allowed[count++] = drive->tool;
	}
	const char *odd = cau_session_heats_beyond(h->core, allowed, count);
	snprintf(h->odd_tool, sizeof h->odd_tool, "%s", odd ? odd : "");
}

bool cau_decide_broken(cau_hosted *h, char *reason, size_t bytes)
{
	pthread_mutex_lock(&h->deciding);
	bool broken = *h->logic->broken, first = broken && !h->rule_reported;
	snprintf(reason, bytes, "%s", h->logic->fault);
	h->rule_reported = broken;
	pthread_mutex_unlock(&h->deciding);
	return first;
}

void cau_decide_next(cau_hosted *h, cau_action *action)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	double now_s = cau_monotonic_s(), due_s = h->logic->next_step_s;
	cau_trace_next(h->trace, now_s);
	cau_logic_next(h->logic, now_s, action, &effects);
	h->late_s = h->logic->state == CAU_SESSION_RUNNING ? now_s - due_s : -1;
	cau_trace_action(h->trace, action);
	if (action->act == CAU_ACT_STEP)
		compare(h);
	cau_trace_effects(h->trace, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	double now_s = cau_monotonic_s();
	cau_trace_done(h->trace, now_s, outcome);
	cau_logic_done(h->logic, now_s, outcome, &effects);
	cau_trace_effects(h->trace, &effects);
	tell(h, &effects);
	pthread_mutex_unlock(&h->deciding);
	perform(h, &effects, NULL, NULL);
}

void cau_decide_stepped(cau_hosted *h, const char *fault)
{
	cau_effects effects;
	pthread_mutex_lock(&h->deciding);
	double now_s = cau_monotonic_s();
	cau_trace_stepped(h->trace, now_s, fault);
	cau_logic_stepped(h->logic, now_s, fault, &effects);
	cau_trace_effects(h->trace, &effects);
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
		// what waits in a core of an older build's store may light or move it yet: that goes too
		tools[i].lit =
			frame.tools[i].energized || cau_session_waiting(h->core, frame.tools[i].name) > 0;
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

// ---- the trace ----------------------------------------------------------------------------------

enum { TRACES_MOST = 1000 }; // of one session in one folder

void cau_decide_trace(cau_hosted *h)
{
	const char *folder = h->around->config->trace_session;
	char path[CAU_CONFIG_TEXT_BYTES + 100];
	if (!*folder)
		return;
	for (int i = 1; i <= TRACES_MOST && !h->trace; i++) {
		snprintf(path, sizeof path, "%s/%s.%d.trace", folder, h->id, i);
		h->trace = fopen(path, "wxe");
		if (!h->trace && errno != EEXIST)
			break;
	}
	if (!h->trace) {
		cau_log(CAU_LOG_WARNING, h->id, "not_traced", "file=\"%s\" reason=\"%s\"", path,
		        strerror(errno));
		return;
	}
	cau_trace_init(h->trace, h->logic->capacity, h->logic->step_s);
	cau_log(CAU_LOG_INFO, h->id, "traced", "file=\"%s\"", path);
}

// After a slice, so that little is lost with a daemon that is killed. What could not be written
// ends the trace: one with a gap could not be played again.
void cau_decide_flush_trace(cau_hosted *h)
{
	if (!h->trace)
		return;
	pthread_mutex_lock(&h->deciding);
	bool failed = fflush(h->trace) || ferror(h->trace);
	int reason = errno;
	FILE *ended = failed ? h->trace : NULL;
	if (failed)
		h->trace = NULL;
	pthread_mutex_unlock(&h->deciding);
	if (!failed)
		return;
	fclose(ended);
	cau_log(CAU_LOG_WARNING, h->id, "trace_ended", "reason=\"%s\"", strerror(reason));
}

// ---- from any thread ----------------------------------------------------------------------------

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
