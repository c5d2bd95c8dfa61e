// SPDX-License-Identifier: GPL-3.0-or-later
// The pages /healthz, /readyz, /api/sessions, /api/fleet; /metrics is in metrics.c.
#include <stdio.h>
#include <string.h>

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
	bool resumed = cau_hub_resuming(service->hub) == 0, store = health.state == CAU_STORE_READY;
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

void cau_service_page(void *user, cau_page *page)
{
	cau_service *service = user;
	page->status = 503;
	page->content_type = "application/json";
	FILE *out = open_memstream(&page->body, &page->bytes);
	if (!out)
		return;
	unsigned status = 200;
	if (strcmp(page->path, "/healthz") == 0) {
		status = write_health(out);
	} else if (strcmp(page->path, "/readyz") == 0) {
		status = write_ready(service, out);
	} else if (strcmp(page->path, "/metrics") == 0) {
		cau_metrics_format format = cau_metrics_choose(page->accept);
		page->content_type = cau_metrics_content_type(format);
		status = cau_service_metrics(service, format, out);
	} else if (strcmp(page->path, "/api/fleet") == 0) {
		// with several daemons, the proxy in front of them answers this page
		fputs("{\"labels\": []}\n", out);
	} else {
		status = write_sessions(service, out);
	}
	page->status = fclose(out) ? 503 : status;
}
