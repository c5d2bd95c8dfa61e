// SPDX-License-Identifier: GPL-3.0-or-later
// The commands about the daemon itself: `ping` measures round trips to it, `backup` copies its
// store to its own disk.
#include <math.h>
#include <string.h>

#include "cautery/cli.h"

// ---- ping --------------------------------------------------------------------------------------
typedef struct round_trips {
	int count;
	double least_ms, most_ms, sum_ms;
} round_trips;

static cli_exit ping_once(cli *c, round_trips *trips)
{
	cau_wire_heartbeat_result result = {0};
	double sent_s = cau_client_now();
	if (cau_client_call(c->client, CAU_METHOD_HEARTBEAT, &(cau_wire_heartbeat){.visible = true},
	                    &result, &c->error))
		return cli_fail(c);
	double took_ms = 1e3 * (cau_client_now() - sent_s);
	trips->least_ms = trips->count ? fmin(trips->least_ms, took_ms) : took_ms;
	trips->most_ms = fmax(trips->most_ms, took_ms);
	trips->sum_ms += took_ms;
	trips->count++;
	if (!c->json) {
		fprintf(c->out, "%.2f ms\n", took_ms);
		fflush(c->out);
	}
	return CLI_DONE;
}

static void wait_until(cli *c, double until_s)
{
	for (double now_s; (now_s = cau_client_now()) < until_s && !cli_interrupted();)
		cau_loop_wait(c->loop, fmin(until_s - now_s, 0.25));
}

static void print_end(const cli *c, const round_trips *trips)
{
	double mean_ms = trips->sum_ms / trips->count;
	if (c->json)
		fprintf(c->out,
		        "{\"count\": %d, \"least_ms\": %.3f, \"mean_ms\": %.3f, \"most_ms\": %.3f}\n",
		        trips->count, trips->least_ms, mean_ms, trips->most_ms);
	else
		fprintf(c->out, "%d round trips: least %.2f ms, mean %.2f ms, most %.2f ms\n", trips->count,
		        trips->least_ms, mean_ms, trips->most_ms);
}

static cli_exit run_ping(cli *c)
{
	bool bad = false;
	round_trips trips = {0};
	int count = (int)cli_number(c, "count", 1, 1e6, 4, &bad);
	double every_s = cli_number(c, "every", 0.001, 3600, 0.25, &bad);
	cli_watch_signals();
	cli_exit code = bad ? CLI_USAGE : cli_connect(c);
	while (!code && trips.count < count && !cli_interrupted()) {
		if (trips.count)
			wait_until(c, cau_client_now() + every_s);
		code = ping_once(c, &trips);
	}
	if (!code)
		print_end(c, &trips);
	return code;
}

const cli_command cli_ping = {
	.name = "ping",
	.arguments = "",
	.summary = "measures the round-trip time of requests",
	.options = {{"count", "N", "number of requests (default 4)"},
                {"every", "S", "seconds between requests (default 0.25)"}},
	.run = run_ping};

// ---- backup ------------------------------------------------------------------------------------
static cli_exit run_backup(cli *c)
{
	cau_wire_store_backup params = {.has_name = c->argument_count > 0};
	cau_wire_store_copy result = {0};
	if (params.has_name && strlen(c->arguments[0]) >= sizeof params.name) {
		fprintf(c->complaints, "cautery backup: NAME has at most %zu characters\n",
		        sizeof params.name - 1);
		return CLI_USAGE;
	}
	if (params.has_name)
		snprintf(params.name, sizeof params.name, "%s", c->arguments[0]);
	cli_exit code = cli_connect(c);
	if (!code)
		code = cli_call(c, CAU_METHOD_STORE_BACKUP, &params, &result);
	if (!code && !c->json)
		fprintf(c->out, "%s: %lld bytes\n", result.file, (long long)result.byte_count);
	return code;
}

const cli_command cli_backup = {
	.name = "backup",
	.arguments = "[NAME]",
	.summary = "copies the store of the running daemon; prints the path of the copy",
	.help =
		"The copy is on the daemon's machine, in the folder of its setting `backups`, as NAME.db\n"
		"(by default the time). The copy is checked. No file is replaced. Needs role admin. To\n"
		"restore: stop the daemon, replace its store with the copy, and start the daemon.\n",
	.most = 1,
	.run = run_backup};
