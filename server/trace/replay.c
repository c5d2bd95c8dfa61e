// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include "trace/fields.h"

typedef struct replay {
	FILE *trace;
	char *line; // the present line without its line feed; NULL: none
	size_t line_bytes;
	uint64_t number; // number of the present line
	cau_logic *logic;
	cau_trace_counts *counts;
} replay;

// Reads the next complete line. Returns false if there is none.
static bool next_line(replay *r)
{
	ssize_t length = getline(&r->line, &r->line_bytes, r->trace);
	r->number++;
	if (length <= 0 || r->line[length - 1] != '\n')
		return false;
	r->line[length - 1] = 0;
	return true;
}

static cau_status differs(const replay *r, const char *said, const char *says, cau_error *error)
{
	char path[32];
	snprintf(path, sizeof path, "line %llu", (unsigned long long)r->number);
	return cau_fail(error, CAU_CORRUPT, path, "the trace has '%.120s', the replay '%.120s'", said,
	                says);
}

// ---- a call -------------------------------------------------------------------------------------

static cau_status begin(replay *r, const cau_trace_call *call, cau_error *error)
{
	free(r->logic);
	r->logic = malloc(cau_logic_bytes(call->capacity));
	if (!r->logic)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a queue of %d", call->capacity);
	cau_logic_init(r->logic, call->capacity);
	r->logic->step_s = call->step_s;
	return CAU_OK;
}

static void take(replay *r, const cau_trace_call *call, cau_effects *effects)
{
	cau_logic_take(r->logic,
	               &(cau_logic_event){.kind = call->event,
	                                  .time_s = call->time_s,
	                                  .alive_s = call->alive_s,
	                                  .client = call->client,
	                                  .number = call->number,
	                                  .tool = call->subject,
	                                  .cause = call->cause,
	                                  .asked = &call->asked,
	                                  .store_takes = call->store_takes,
	                                  .state = call->state,
	                                  .tick = call->tick,
	                                  .step_s = call->step_s,
	                                  .tools = call->tools,
	                                  .tool_count = call->tool_count},
	               effects);
	r->counts->events++;
	r->counts->of_event[call->event]++;
}

// Makes the call and writes its result to `answer`.
static void make_call(replay *r, const cau_trace_call *call, FILE *answer)
{
	cau_effects effects = {.count = 0};
	cau_action action = {.act = CAU_ACT_NOTHING};
	switch (call->what) {
	case CAU_TRACE_TAKE:
		take(r, call, &effects);
		break;
	case CAU_TRACE_NEXT:
		cau_logic_next(r->logic, call->time_s, &action, &effects);
		r->counts->acts += action.act != CAU_ACT_NOTHING;
		break;
	case CAU_TRACE_DONE:
		cau_logic_done(r->logic, call->time_s, call->outcome, &effects);
		break;
	case CAU_TRACE_STEPPED:
		cau_logic_stepped(r->logic, call->time_s, call->faulted ? call->cause : NULL, &effects);
		break;
	case CAU_TRACE_INIT:
	case CAU_TRACE_WHAT_COUNT:
		break;
	}
	r->counts->effects += (uint64_t)effects.count;
	cau_trace_action(answer, &action);
	cau_trace_effects(answer, &effects);
}

// Compares the lines of the trace with the machine's answer, line by line. *more: a call follows. A
// trace may end anywhere.
static cau_status compare(replay *r, char *answer, bool *more, cau_error *error)
{
	char *says = answer;
	while ((*more = next_line(r)) && r->line[0] == ' ') {
		char *end = strchr(says, '\n');
		if (end)
			*end = 0;
		if (!end || strcmp(says, r->line) != 0)
			return differs(r, r->line, end ? says : "", error);
		says = end + 1;
	}
	says[strcspn(says, "\n")] = 0;
	return *more && *says ? differs(r, "", says, error) : CAU_OK;
}

// ---- the whole trace ----------------------------------------------------------------------------

static cau_status replay_call(replay *r, bool *more, cau_error *error)
{
	cau_trace_call call;
	char *answer = NULL;
	size_t answer_bytes;
	cau_status status = cau_trace_read(r->line, &call, error);
	if (!status && call.what == CAU_TRACE_INIT)
		status = begin(r, &call, error);
	if (!status && !r->logic)
		status = cau_fail(error, CAU_BAD_SYNTAX, "", "the trace does not begin with 'init'");
	if (status)
		return status;
	FILE *to = open_memstream(&answer, &answer_bytes);
	if (!to)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an answer");
	make_call(r, &call, to);
	bool written = fclose(to) == 0;
	status = written ? compare(r, answer, more, error)
	                 : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an answer");
	free(answer);
	return status;
}

cau_status cau_trace_replay(FILE *trace, cau_trace_counts *counts, cau_error *error)
{
	replay r = {.trace = trace, .counts = counts};
	cau_status status = CAU_OK;
	*counts = (cau_trace_counts){0};
	bool more = next_line(&r);
	if (!more)
		status = cau_fail(error, CAU_BAD_SYNTAX, "", "the trace is empty");
	while (!status && more) {
		uint64_t number = r.number;
		status = replay_call(&r, &more, error);
		if (status == CAU_BAD_SYNTAX && error)
			snprintf(error->path, sizeof error->path, "line %llu", (unsigned long long)number);
	}
	free(r.logic);
	free(r.line);
	return status;
}
