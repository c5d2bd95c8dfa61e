// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/decisions.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "log/log.h"
#include "trace/trace.h"

// ---- copies, made under the lock ----------------------------------------------------------------

int cau_decisions_state(cau_hosted_decisions *decisions)
{
	pthread_mutex_lock(&decisions->lock);
	int state = decisions->logic->state;
	pthread_mutex_unlock(&decisions->lock);
	return state;
}

cau_decided cau_decisions_now(cau_hosted_decisions *decisions)
{
	pthread_mutex_lock(&decisions->lock);
	cau_decided now = {.state = decisions->logic->state,
	                   .speed = decisions->logic->speed,
	                   .tick_s = decisions->logic->next_step_s,
	                   .period_s = decisions->logic->step_s / decisions->logic->speed,
	                   .lockstep = decisions->logic->lockstep,
	                   .steps_left = decisions->logic->steps_left,
	                   .drive_count = decisions->logic->drive_count};
	memcpy(now.fault, decisions->logic->fault, sizeof now.fault);
	pthread_mutex_unlock(&decisions->lock);
	return now;
}

double cau_decisions_due_s(cau_hosted_decisions *decisions)
{
	pthread_mutex_lock(&decisions->lock);
	double due_s = cau_logic_due_s(decisions->logic);
	pthread_mutex_unlock(&decisions->lock);
	return due_s;
}

double cau_decisions_look_s(cau_hosted_decisions *decisions)
{
	pthread_mutex_lock(&decisions->lock);
	double look_s = cau_logic_look_s(decisions->logic);
	pthread_mutex_unlock(&decisions->lock);
	return look_s;
}

bool cau_decisions_find(cau_hosted_decisions *decisions, const char *tool, cau_drive *drive)
{
	pthread_mutex_lock(&decisions->lock);
	const cau_drive *found = cau_logic_drive(decisions->logic, tool);
	if (found)
		*drive = *found;
	pthread_mutex_unlock(&decisions->lock);
	return found != NULL;
}

int32_t cau_decisions_drives(cau_hosted_decisions *decisions, cau_drive *drives)
{
	pthread_mutex_lock(&decisions->lock);
	int32_t count = decisions->logic->drive_count;
	memcpy(drives, decisions->logic->drives, (size_t)count * sizeof *drives);
	pthread_mutex_unlock(&decisions->lock);
	return count;
}

bool cau_decisions_broken(cau_hosted_decisions *decisions, char *reason, size_t bytes)
{
	pthread_mutex_lock(&decisions->lock);
	bool broken = *decisions->logic->broken, first = broken && !decisions->rule_reported;
	snprintf(reason, bytes, "%s", decisions->logic->fault);
	decisions->rule_reported = broken;
	pthread_mutex_unlock(&decisions->lock);
	return first;
}

// ---- the trace ----------------------------------------------------------------------------------

enum { TRACES_MOST = 1000 }; // most traces of one session in one folder

void cau_decisions_open_trace(cau_hosted_decisions *decisions, const cau_hosted_identity *identity)
{
	const char *folder = identity->around->config->trace_session;
	char path[CAU_CONFIG_TEXT_BYTES + 100];
	if (!*folder)
		return;
	for (int i = 1; i <= TRACES_MOST && !decisions->trace; i++) {
		snprintf(path, sizeof path, "%s/%s.%d.trace", folder, identity->id, i);
		decisions->trace = fopen(path, "wxe");
		if (!decisions->trace && errno != EEXIST)
			break;
	}
	if (!decisions->trace) {
		cau_log(CAU_LOG_WARNING, identity->id, "not_traced", "file=\"%s\" reason=\"%s\"", path,
		        strerror(errno));
		return;
	}
	cau_trace_init(decisions->trace, decisions->logic->capacity, decisions->logic->step_s);
	cau_log(CAU_LOG_INFO, identity->id, "traced", "file=\"%s\"", path);
}

// Writes the trace to its file after a slice, so that a killed daemon loses little of it. A write
// error ends the trace, because a trace with a gap cannot be replayed.
void cau_decisions_flush_trace(cau_hosted_decisions *decisions, const char *id)
{
	if (!decisions->trace)
		return;
	pthread_mutex_lock(&decisions->lock);
	bool failed = fflush(decisions->trace) || ferror(decisions->trace);
	int reason = errno;
	FILE *ended = failed ? decisions->trace : NULL;
	if (failed)
		decisions->trace = NULL;
	pthread_mutex_unlock(&decisions->lock);
	if (!failed)
		return;
	fclose(ended);
	cau_log(CAU_LOG_WARNING, id, "trace_ended", "reason=\"%s\"", strerror(reason));
}

// ---- creation and destruction -------------------------------------------------------------------

void cau_decisions_init(cau_hosted_decisions *decisions, int32_t orders, double step_s)
{
	pthread_mutex_init(&decisions->lock, NULL);
	cau_logic_init(decisions->logic, orders);
	decisions->logic->step_s = step_s;
}

void cau_decisions_finish(cau_hosted_decisions *decisions)
{
	pthread_mutex_destroy(&decisions->lock);
	if (decisions->trace)
		fclose(decisions->trace);
	free(decisions->logic);
}
