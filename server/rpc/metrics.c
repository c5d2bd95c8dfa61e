// SPDX-License-Identifier: GPL-3.0-or-later
// Writes /metrics. The numbers of all sessions are read before any is written, because the samples
// of a family must be together, and sessions may be created or destroyed meanwhile.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

// ---- the metrics of sessions

// The metrics of each session: name, type, unit, help, and value. The value is from the session's
// counts `c` and summary `s`.
#define SESSION_METRICS(X)                                                                         \
	X("session_steps", COUNTER, "", "Steps computed", c->steps)                                    \
	X("session_step_seconds", COUNTER, "seconds", "Wall time spent in steps", c->step_seconds)     \
	X("session_energy_gain_joules", COUNTER, "joules",                                             \
	  "Energy that steps gained without a source", c->energy_gain_j)                               \
	X("session_realtime_factor", GAUGE, "", "Simulated time over wall time", c->realtime_factor)   \
	X("session_speed", GAUGE, "", "Wanted simulated time over wall time", s->speed)                \
	X("session_running", GAUGE, "", "1 while the session runs", s->state == CAU_SESSION_RUNNING)   \
	X("session_frames", COUNTER, "", "Delta frames encoded", c->frames)                            \
	X("session_frame_bytes", COUNTER, "bytes", "Bytes of delta frames", c->frame_bytes)            \
	X("session_key_frames", COUNTER, "", "Key frames encoded", c->key_frames)                      \
	X("session_commands", COUNTER, "", "Commands applied", c->commands)                            \
	X("session_motions", COUNTER, "", "Tool motions applied", c->motions)                          \
	X("session_refused", COUNTER, "", "Motions refused, and DDS samples refused", c->refused)      \
	X("session_watchdog_cuts", COUNTER, "",                                                        \
	  "Number of times that energy went off because a driver was silent", c->watchdog_cuts)        \
	X("session_subscribers", GAUGE, "", "Streams of the session", s->subscriber_count)             \
	X("session_subscribers_half_rate", GAUGE, "", "Streams served at half rate", c->half_rate)     \
	X("session_resting", GAUGE, "", "1 while the tissue of the session is at rest", c->resting)    \
	X("session_contacts_left_out", GAUGE, "",                                                      \
	  "Vertices near tools that exceeded the contact capacity of the last step",                   \
	  c->contacts_left_out)                                                                        \
	X("session_touching_cut_short", GAUGE, "",                                                     \
	  "Number of times in the last step that tissue contact exceeded its capacity or diverged",    \
	  c->touching_cut_short)                                                                       \
	X("session_paused", GAUGE, "", "1 while the session is paused",                                \
	  s->state == CAU_SESSION_PAUSED)                                                              \
	X("session_faulted", GAUGE, "", "1 while the session is faulted",                              \
	  s->state == CAU_SESSION_FAULTED)

static const cau_metric_family session_families[] = {
#define X(name, type, unit, help, value) {name, CAU_METRIC_##type, unit, help},
	SESSION_METRICS(X)
#undef X
};
enum { SESSION_FAMILIES = sizeof session_families / sizeof session_families[0] };

typedef struct session_row {
	char id[CAU_NAME_BYTES];
	double values[SESSION_FAMILIES];
} session_row;

typedef struct session_rows {
	session_row *rows; // malloc'ed
	size_t count, capacity;
	bool failed; // memory ran out
} session_rows;

static bool make_room(session_rows *taken)
{
	if (taken->count < taken->capacity)
		return true;
	size_t capacity = taken->capacity ? 2 * taken->capacity : 16;
	session_row *grown = realloc(taken->rows, capacity * sizeof *grown);
	if (!grown)
		return false;
	taken->rows = grown;
	taken->capacity = capacity;
	return true;
}

static void take_session(void *user, cau_hosted *hosted)
{
	session_rows *taken = user;
	cau_hosted_counts counts, *c = &counts;
	cau_wire_session_summary summary, *s = &summary;
	cau_hosted_count(hosted, c);
	cau_hosted_summary(hosted, s);
	taken->failed = taken->failed || !make_room(taken);
	if (taken->failed)
		return;
	session_row *row = &taken->rows[taken->count++];
	snprintf(row->id, sizeof row->id, "%s", cau_hosted_id(hosted));
	double *value = row->values;
#define X(name, type, unit, help, value_) *value++ = (double)(value_);
	SESSION_METRICS(X)
#undef X
}

static void write_rows(FILE *out, cau_metrics_format format, const session_rows *taken)
{
	for (int f = 0; f < SESSION_FAMILIES && taken->count; f++) {
		const cau_metric_family *family = &session_families[f];
		cau_metrics_begin(out, format, family);
		for (size_t i = 0; i < taken->count; i++)
			cau_metrics_sample(out, format, family, "session", taken->rows[i].id,
			                   taken->rows[i].values[f]);
	}
}

unsigned cau_service_metrics(cau_service *service, cau_metrics_format format, FILE *out)
{
	static const cau_metric_family sessions = {"sessions", CAU_METRIC_GAUGE, "",
	                                           "Sessions of the daemon"};
	session_rows taken = {0};
	cau_hub_each(service->hub, take_session, &taken);
	cau_metrics_begin(out, format, &sessions);
	cau_metrics_sample(out, format, &sessions, NULL, NULL, (double)taken.count);
	cau_service_daemon_metrics(service, format, out);
	if (service->write_more_metrics)
		service->write_more_metrics(service->more_metrics_user, out, format);
	write_rows(out, format, &taken);
	cau_metrics_end(out, format);
	free(taken.rows);
	return taken.failed ? 503 : 200;
}
