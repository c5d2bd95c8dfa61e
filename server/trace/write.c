// SPDX-License-Identifier: GPL-3.0-or-later
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "trace/fields.h"

// ---- one member ---------------------------------------------------------------------------------

static uint64_t unsigned_at(const void *at, size_t bytes)
{
	uint32_t narrow;
	uint64_t wide;
	CAU_ASSERT(bytes == sizeof narrow || bytes == sizeof wide, "a number of %zu bytes", bytes);
	if (bytes == sizeof wide)
		return memcpy(&wide, at, sizeof wide), wide;
	return memcpy(&narrow, at, sizeof narrow), narrow;
}

static int64_t signed_at(const void *at, size_t bytes)
{
	uint64_t value = unsigned_at(at, bytes);
	return bytes == sizeof(int64_t) ? (int64_t)value : (int32_t)(uint32_t)value;
}

static void write_text(FILE *to, const char *text)
{
	fputc('"', to);
	for (; *text; text++) {
		unsigned char c = (unsigned char)*text;
		if (c == '"' || c == '\\')
			fprintf(to, "\\%c", c);
		else if (c < ' ')
			fprintf(to, "\\x%02x", c);
		else
			fputc(c, to);
	}
	fputc('"', to);
}

static void write_field(FILE *to, const field *f, const void *at)
{
	double real;
	bool truth;
	switch (f->kind) {
	case FIELD_UNSIGNED:
		if (unsigned_at(at, f->bytes))
			fprintf(to, " %s=%" PRIu64, f->name, unsigned_at(at, f->bytes));
		break;
	case FIELD_SIGNED:
		if (signed_at(at, f->bytes))
			fprintf(to, " %s=%" PRId64, f->name, signed_at(at, f->bytes));
		break;
	case FIELD_REAL:
		memcpy(&real, at, sizeof real);
		if (real != 0 || signbit(real))
			fprintf(to, " %s=%a", f->name, real);
		break;
	case FIELD_TRUTH:
		memcpy(&truth, at, sizeof truth);
		if (truth)
			fprintf(to, " %s=1", f->name);
		break;
	case FIELD_CHOICE:
		CAU_ASSERT_INDEX(signed_at(at, f->bytes), f->word_count);
		if (signed_at(at, f->bytes))
			fprintf(to, " %s=%s", f->name, f->words[signed_at(at, f->bytes)]);
		break;
	case FIELD_TEXT:
		if (*(const char *)at) {
			fprintf(to, " %s=", f->name);
			write_text(to, at);
		}
		break;
	}
}

static void write_fields(FILE *to, const field_list *list, const void *of)
{
	for (int32_t i = 0; i < list->count; i++)
		write_field(to, &list->fields[i], (const char *)of + list->fields[i].offset);
}

// ---- calls --------------------------------------------------------------------------------------

void cau_trace_write(FILE *to, const cau_trace_call *call)
{
	CAU_ASSERT_INDEX(call->what, CAU_TRACE_WHAT_COUNT);
	fputs(cau_trace_what_words[call->what], to);
	write_fields(to, &cau_trace_call_fields, call);
	fputc('\n', to);
}

void cau_trace_init(FILE *to, int32_t capacity, double step_s)
{
	if (to)
		cau_trace_write(
			to, &(cau_trace_call){.what = CAU_TRACE_INIT, .capacity = capacity, .step_s = step_s});
}

void cau_trace_take(FILE *to, const cau_logic_event *event)
{
	if (!to)
		return;
	cau_trace_call call = {.what = CAU_TRACE_TAKE,
	                       .time_s = event->time_s,
	                       .alive_s = event->alive_s,
	                       .event = event->kind,
	                       .client = event->client,
	                       .number = event->number,
	                       .store_takes = event->store_takes,
	                       .state = event->state,
	                       .tick = event->tick,
	                       .step_s = event->step_s,
	                       .tool_count = event->tool_count};
	CAU_ASSERT(event->tool_count <= CAU_MAX_TOOLS, "%d tools", event->tool_count);
	snprintf(call.subject, sizeof call.subject, "%s", event->tool ? event->tool : "");
	snprintf(call.cause, sizeof call.cause, "%s", event->cause ? event->cause : "");
	if (event->asked)
		call.asked = *event->asked;
	for (int32_t i = 0; i < event->tool_count; i++)
		call.tools[i] = event->tools[i];
	cau_trace_write(to, &call);
}

void cau_trace_next(FILE *to, double now_s)
{
	if (to)
		cau_trace_write(to, &(cau_trace_call){.what = CAU_TRACE_NEXT, .time_s = now_s});
}

void cau_trace_done(FILE *to, double now_s, cau_outcome_kind outcome)
{
	if (to)
		cau_trace_write(
			to, &(cau_trace_call){.what = CAU_TRACE_DONE, .time_s = now_s, .outcome = outcome});
}

void cau_trace_stepped(FILE *to, double now_s, const char *fault)
{
	if (!to)
		return;
	cau_trace_call call = {.what = CAU_TRACE_STEPPED, .time_s = now_s, .faulted = fault != NULL};
	snprintf(call.cause, sizeof call.cause, "%s", fault ? fault : "");
	cau_trace_write(to, &call);
}

// ---- the results of calls -----------------------------------------------------------------------

void cau_trace_action(FILE *to, const cau_action *action)
{
	if (!to || action->act == CAU_ACT_NOTHING)
		return;
	fputc(' ', to);
	write_fields(to, &cau_trace_action_fields, action);
	write_fields(to, &cau_trace_drive_fields, &action->drive);
	fputc('\n', to);
}

void cau_trace_effects(FILE *to, const cau_effects *effects)
{
	if (!to)
		return;
	for (int32_t i = 0; i < effects->count; i++) {
		const cau_effect *effect = &effects->list[i];
		fprintf(to, "  effect=%s", cau_trace_effect_words[effect->kind]);
		if (effect->ticket)
			fprintf(to, " ticket=%" PRIu64, effect->ticket);
		if (effect->kind == CAU_EFFECT_REFUSE)
			write_fields(to, &cau_trace_effect_fields, effect);
		if (effect->kind == CAU_EFFECT_TELL)
			write_fields(to, &cau_trace_drive_fields, &effect->drive);
		fputc('\n', to);
	}
}
