// SPDX-License-Identifier: GPL-3.0-or-later
// /healthz, /readyz, /metrics, /api/sessions.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "rpc/internal.h"

static const char *const states[] = {
#define X(code, name) name,
	CAU_SESSION_STATE_TABLE(X)
#undef X
};

static unsigned write_health(FILE *out)
{
	fputs("{\"status\": \"ok\"}\n", out);
	return 200;
}

static unsigned write_ready(cau_service *service, FILE *out)
{
	cau_store_health health;
	cau_store_get_health(service->store, &health);
	bool resumed = cau_hub_ready(service->hub), store = health.state == CAU_STORE_READY;
	bool ready = resumed && store && !service->draining;
	fprintf(out, "{\"ready\": %s, \"sessions_resumed\": %s, \"store\": \"%s\", \"draining\": %s}\n",
	        ready ? "true" : "false", resumed ? "true" : "false",
	        cau_store_state_name(health.state), service->draining ? "true" : "false");
	return ready ? 200 : 503;
}

typedef struct writing {
	FILE *out;
	bool any;
} writing;

static void write_session(void *user, cau_hosted *hosted)
{
	writing *w = user;
	cau_wire_session_summary s;
	cau_hosted_summary(hosted, &s);
	fprintf(w->out,
	        "%s\n  {\"session\": \"%s\", \"scene\": \"%s\", \"state\": \"%s\", \"tick\": %lld, "
	        "\"time_s\": %.9g, \"realtime_factor\": %.4g, \"vertex_count\": %lld, "
	        "\"face_count\": %lld, \"tool_count\": %lld, \"subscriber_count\": %lld}",
	        w->any ? "," : "", s.session, s.scene, states[s.state], (long long)s.tick, s.time_s,
	        s.realtime_factor, (long long)s.vertex_count, (long long)s.face_count,
	        (long long)s.tool_count, (long long)s.subscriber_count);
	w->any = true;
}

static unsigned write_sessions(cau_service *service, FILE *out)
{
	writing w = {out, false};
	fprintf(out, "{\"daemon\": \"%s\", \"sessions\": [", service->config->label);
	cau_hub_each(service->hub, write_session, &w);
	fputs(w.any ? "\n]}\n" : "]}\n", out);
	return 200;
}

// ---- metrics
static void metric(FILE *out, const char *name, const char *type, const char *help, double value)
{
	fprintf(out, "# HELP cautery_%s %s\n# TYPE cautery_%s %s\ncautery_%s %.17g\n", name, help, name,
	        type, name, value);
}

static void write_network(cau_service *service, FILE *out)
{
	cau_network_counts n = cau_network_count(service->network);
	metric(out, "connections", "gauge", "WebSocket connections open", (double)n.connections);
	metric(out, "connections_total", "counter", "WebSocket connections accepted",
	       (double)n.accepted);
	metric(out, "handshakes_refused_total", "counter", "Upgrade requests refused",
	       (double)n.refused_handshakes);
	metric(out, "connections_closed_slow_total", "counter", "Connections closed for slowness",
	       (double)n.closed_slow);
	metric(out, "connections_closed_error_total", "counter", "Connections closed for a rule broken",
	       (double)n.closed_errors);
	metric(out, "messages_received_total", "counter", "Messages from clients",
	       (double)n.messages_in);
	metric(out, "received_bytes_total", "counter", "Bytes of messages from clients",
	       (double)n.bytes_in);
	metric(out, "messages_sent_total", "counter", "Messages to clients", (double)n.messages_out);
	metric(out, "sent_bytes_total", "counter", "Bytes of messages to clients", (double)n.bytes_out);
	metric(out, "requests_total", "counter", "Text messages read", (double)service->requests);
	metric(out, "request_errors_total", "counter", "Requests answered at once with an error",
	       (double)service->errors);
}

static void write_store(cau_service *service, FILE *out)
{
	cau_store_metrics m;
	cau_store_health health;
	cau_store_get_metrics(service->store, &m);
	cau_store_get_health(service->store, &health);
	metric(out, "store_ready", "gauge", "1 if the store takes requests",
	       health.state == CAU_STORE_READY);
	metric(out, "store_commits_total", "counter", "Groups committed", (double)m.commits);
	metric(out, "store_records_total", "counter", "Rows committed", (double)m.records);
	metric(out, "store_failed_batches_total", "counter", "Batches that failed",
	       (double)m.failed_batches);
	metric(out, "store_full_total", "counter", "Times the disk was found full",
	       (double)m.full_count);
	metric(out, "store_queue_batches", "gauge", "Batches waiting", m.queue_batches);
	metric(out, "store_commit_p99_seconds", "gauge", "99th percentile of commits", m.commit_p99_s);
	metric(out, "store_database_bytes", "gauge", "Size of the store", (double)m.database_bytes);
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

static void write_process(FILE *out)
{
	struct rusage usage;
	long pages = resident_pages();
	getrusage(RUSAGE_SELF, &usage);
	metric(out, "resident_bytes", "gauge", "Resident memory",
	       (double)pages * (double)sysconf(_SC_PAGESIZE));
	metric(out, "cpu_seconds_total", "counter", "Processor time used",
	       (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
	           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec));
}

static void write_session_metrics(void *user, cau_hosted *hosted)
{
	FILE *out = ((writing *)user)->out;
	cau_hosted_counts c;
	cau_wire_session_summary s;
	cau_hosted_count(hosted, &c);
	cau_hosted_summary(hosted, &s);
	const struct {
		const char *name;
		double value;
	} rows[] = {
		{"session_steps_total", (double)c.steps},
		{"session_step_seconds_total", c.step_seconds},
		{"session_realtime_factor", c.realtime_factor},
		{"session_frames_total", (double)c.frames},
		{"session_frame_bytes_total", (double)c.frame_bytes},
		{"session_key_frames_total", (double)c.key_frames},
		{"session_commands_total", (double)c.commands},
		{"session_motions_total", (double)c.motions},
		{"session_refused_total", (double)c.refused},
		{"session_watchdog_cuts_total", (double)c.watchdog_cuts},
		{"session_subscribers", (double)s.subscriber_count},
		{"session_subscribers_half_rate", c.half_rate},
		{"session_paused", s.state == CAU_SESSION_PAUSED},
		{"session_faulted", s.state == CAU_SESSION_FAULTED},
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		fprintf(out, "cautery_%s{session=\"%s\"} %.17g\n", rows[i].name, s.session, rows[i].value);
}

static unsigned write_metrics(cau_service *service, FILE *out)
{
	writing w = {out, false};
	metric(out, "sessions", "gauge", "Sessions hosted", cau_hub_count(service->hub));
	write_network(service, out);
	write_store(service, out);
	write_process(out);
	cau_hub_each(service->hub, write_session_metrics, &w);
	return 200;
}

unsigned cau_service_page(void *user, const char *path, char **body, size_t *bytes)
{
	cau_service *service = user;
	FILE *out = open_memstream(body, bytes);
	if (!out)
		return 503;
	unsigned status = strcmp(path, "/healthz") == 0   ? write_health(out)
	                  : strcmp(path, "/readyz") == 0  ? write_ready(service, out)
	                  : strcmp(path, "/metrics") == 0 ? write_metrics(service, out)
	                                                  : write_sessions(service, out);
	return fclose(out) ? 503 : status;
}
