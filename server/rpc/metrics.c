// SPDX-License-Identifier: GPL-3.0-or-later
// /metrics: what the daemon counts. Every session's numbers are taken before the first is written,
// since a family's samples stand together and sessions come and go meanwhile.
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "rpc/internal.h"

typedef struct exposition {
	FILE *out;
	cau_metrics_format format;
} exposition;

// A family of one sample.
static void single(const exposition *to, const char *name, cau_metric_type type, const char *unit,
                   const char *help, double value)
{
	cau_metric_family family = {name, type, unit, help};
	cau_metrics_begin(to->out, to->format, &family);
	cau_metrics_sample(to->out, to->format, &family, NULL, NULL, value);
}

static void gauge(const exposition *to, const char *name, const char *unit, const char *help,
                  double value)
{
	single(to, name, CAU_METRIC_GAUGE, unit, help, value);
}

static void counter(const exposition *to, const char *name, const char *unit, const char *help,
                    double value)
{
	single(to, name, CAU_METRIC_COUNTER, unit, help, value);
}

static void write_network(cau_service *service, const exposition *to)
{
	cau_network_counts n = cau_network_count(service->network);
	gauge(to, "connections", "", "WebSocket connections open", (double)n.connections);
	counter(to, "connections_accepted", "", "WebSocket connections accepted", (double)n.accepted);
	counter(to, "handshakes_refused", "", "Upgrade requests refused", (double)n.refused_handshakes);
	counter(to, "connections_closed_slow", "", "Connections closed for slowness",
	        (double)n.closed_slow);
	counter(to, "connections_closed_error", "", "Connections closed for a rule broken",
	        (double)n.closed_errors);
	counter(to, "messages_received", "", "Messages from clients", (double)n.messages_in);
	counter(to, "received_bytes", "bytes", "Bytes of messages from clients", (double)n.bytes_in);
	counter(to, "messages_sent", "", "Messages to clients", (double)n.messages_out);
	counter(to, "sent_bytes", "bytes", "Bytes of messages to clients", (double)n.bytes_out);
	counter(to, "requests", "", "Text messages read", (double)service->requests);
	counter(to, "request_errors", "", "Requests answered at once with an error",
	        (double)service->errors);
}

static void write_store(cau_service *service, const exposition *to)
{
	cau_store_metrics m;
	cau_store_health health;
	cau_store_get_metrics(service->store, &m);
	cau_store_get_health(service->store, &health);
	gauge(to, "store_ready", "", "1 if the store takes requests", health.state == CAU_STORE_READY);
	counter(to, "store_commits", "", "Groups committed", (double)m.commits);
	counter(to, "store_records", "", "Rows committed", (double)m.records);
	counter(to, "store_failed_batches", "", "Batches that failed", (double)m.failed_batches);
	counter(to, "store_full", "", "Times the disk was found full", (double)m.full_count);
	gauge(to, "store_queue_batches", "", "Batches waiting", m.queue_batches);
	gauge(to, "store_commit_p99_seconds", "seconds", "99th percentile of commits", m.commit_p99_s);
	gauge(to, "store_database_bytes", "bytes", "Size of the store", (double)m.database_bytes);
}

// The second number of statm; 0 if it cannot be read.
static long resident_pages(void)
{
	char line[128] = "", *resident = line;
	FILE *statm = fopen("/proc/self/statm", "r");
	if (!statm)
		return 0;
	if (fgets(line, sizeof line, statm))
		strtol(line, &resident, 10);
	fclose(statm);
	return strtol(resident, NULL, 10);
}

static void write_process(const exposition *to)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	double user_s = (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec;
	double system_s = (double)usage.ru_stime.tv_sec + 1e-6 * (double)usage.ru_stime.tv_usec;
	gauge(to, "resident_bytes", "bytes", "Resident memory",
	      (double)resident_pages() * (double)sysconf(_SC_PAGESIZE));
	counter(to, "cpu_seconds", "seconds", "Processor time used", user_s + system_s);
}

// ---- sessions

// What is told of each session: name, type, unit, help, and the value from its counts `c` and its
// summary `s`.
#define SESSION_METRICS(X)                                                                         \
	X("session_steps", COUNTER, "", "Steps computed", c->steps)                                    \
	X("session_step_seconds", COUNTER, "seconds", "Wall time spent in steps", c->step_seconds)     \
	X("session_energy_gain_joules", COUNTER, "joules", "Energy that steps made out of nothing",    \
	  c->energy_gain_j)                                                                            \
	X("session_realtime_factor", GAUGE, "", "Simulated over wall time", c->realtime_factor)        \
	X("session_frames", COUNTER, "", "Delta frames encoded", c->frames)                            \
	X("session_frame_bytes", COUNTER, "bytes", "Bytes of delta frames", c->frame_bytes)            \
	X("session_key_frames", COUNTER, "", "Key frames encoded", c->key_frames)                      \
	X("session_commands", COUNTER, "", "Commands applied", c->commands)                            \
	X("session_motions", COUNTER, "", "Tool motions applied", c->motions)                          \
	X("session_refused", COUNTER, "", "Motions refused, and what DDS did not let in", c->refused)  \
	X("session_watchdog_cuts", COUNTER, "", "Times a driver's silence cut energy",                 \
	  c->watchdog_cuts)                                                                            \
	X("session_subscribers", GAUGE, "", "Streams joined", s->subscriber_count)                     \
	X("session_subscribers_half_rate", GAUGE, "", "Streams served at half rate", c->half_rate)     \
	X("session_resting", GAUGE, "", "1 while its tissue is at rest", c->resting)                   \
	X("session_paused", GAUGE, "", "1 while it is paused", s->state == CAU_SESSION_PAUSED)         \
	X("session_faulted", GAUGE, "", "1 after a fault", s->state == CAU_SESSION_FAULTED)

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

static void write_rows(const exposition *to, const session_rows *taken)
{
	for (int f = 0; f < SESSION_FAMILIES && taken->count; f++) {
		const cau_metric_family *family = &session_families[f];
		cau_metrics_begin(to->out, to->format, family);
		for (size_t i = 0; i < taken->count; i++)
			cau_metrics_sample(to->out, to->format, family, "session", taken->rows[i].id,
			                   taken->rows[i].values[f]);
	}
}

unsigned cau_service_metrics(cau_service *service, cau_metrics_format format, FILE *out)
{
	exposition to = {out, format};
	session_rows taken = {0};
	cau_hub_each(service->hub, take_session, &taken);
	gauge(&to, "sessions", "", "Sessions hosted", (double)taken.count);
	gauge(&to, "longest_slice_seconds", "seconds",
	      "Processor time of the longest piece of work on a worker thread, steps not counted",
	      cau_hub_longest_slice_s(service->hub));
	write_network(service, &to);
	write_store(service, &to);
	write_process(&to);
	if (service->write_more_metrics)
		service->write_more_metrics(service->more_metrics_user, out, format);
	write_rows(&to, &taken);
	cau_metrics_end(out, format);
	free(taken.rows);
	return taken.failed ? 503 : 200;
}
