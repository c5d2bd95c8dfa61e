// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-load: puts a load of scripted clients on a running daemon.
#include <math.h>

#include "load/load.h"

static volatile sig_atomic_t interrupted;

static void on_signal(int signal_number)
{
	interrupted = signal_number;
}

// The first signal ends the measured window, the second the program.
static void catch_signals(void)
{
	struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}

static double daemon_memory(load_fleet *fleet)
{
	double bytes = NAN;
	cau_error error = {0};
	if (load_daemon_memory(fleet->options->url, fleet->options->token, &bytes, &error)) {
		fprintf(stderr, "cautery-load: the daemon's memory is not known: %s\n", error.reason);
		return NAN;
	}
	return bytes;
}

// Measures while all clients run. Processor time is the difference between before and after.
static cau_status measure(load_fleet *fleet, load_result *result)
{
	load_cpu before = load_cpu_read();
	double own_s = load_own_cpu_s(), start_s = cau_client_now();
	fleet->measuring = true;
	cau_status status = load_fleet_run(fleet, fleet->options->seconds);
	fleet->measuring = false;
	load_cpu after = load_cpu_read();
	double end_s = cau_client_now();
	result->window_s = end_s - start_s;
	result->end_s = end_s + fleet->clock.offset_s;
	result->load_cpu_pct = 100.0 * (load_own_cpu_s() - own_s) / result->window_s;
	result->steal_pct = after.total > before.total
	                        ? 100.0 * (after.steal - before.steal) / (after.total - before.total)
	                        : NAN;
	return status;
}

static void judge(load_fleet *fleet, load_result *result)
{
	int32_t others = fleet->options->sessions * (fleet->options->viewers - 1);
	result->realtime_factor_min = INFINITY;
	for (int32_t s = 0; s < fleet->options->sessions; s++) {
		load_session *session = &fleet->sessions[s];
		cau_error error = {0};
		result->realtime_factor_min =
			fmin(result->realtime_factor_min, load_realtime_factor(session, result->end_s));
		result->acknowledged += session->driver.acknowledged_count;
		if (result->lost_acknowledged < 0 ||
		    !load_count_lost(session, &result->lost_acknowledged, &error))
			continue;
		fprintf(stderr, "cautery-load: %s: the log cannot be read: %s\n", session->id,
		        error.reason);
		result->lost_acknowledged = -1;
	}
	result->rss_per_viewer = others ? (result->rss_after - result->rss_before) / others : NAN;
}

static cau_status run(load_fleet *fleet, load_result *result)
{
	const load_options *options = fleet->options;
	cau_status status = load_fleet_run(fleet, options->warm_up_s);
	result->rss_before = daemon_memory(fleet);
	if (!status)
		status = load_fleet_add_viewers(fleet);
	if (!status)
		status = load_fleet_run(fleet, options->warm_up_s);
	if (!status && interrupted)
		status = cau_fail(&fleet->error, CAU_BAD_STATE, NULL,
		                  "interrupted before anything was measured");
	if (!status)
		status = measure(fleet, result);
	if (status)
		return status;
	result->rss_after = daemon_memory(fleet);
	load_fleet_settle(fleet);
	judge(fleet, result);
	return CAU_OK;
}

int main(int argument_count, char **arguments)
{
	load_options options;
	load_fleet fleet;
	load_result result = {0};
	if (!load_options_read(argument_count, arguments, &options, stderr))
		return LOAD_BAD_USAGE;
	if (options.version) {
		puts("cautery-load " CAUTERY_VERSION);
		return LOAD_DONE;
	}
	if (options.help) {
		load_options_help(stdout);
		return LOAD_DONE;
	}
	char token[CAU_CLIENT_TOKEN_BYTES];
	cau_error error = {0};
	if (options.token_file && cau_client_read_token(options.token_file, token, &error)) {
		fprintf(stderr, "cautery-load: %s: %s\n", error.file, error.reason);
		return LOAD_BAD_USAGE;
	}
	if (options.token_file)
		options.token = token;
	catch_signals();
	options.interrupted = &interrupted;
	cau_status status = load_fleet_start(&fleet, &options);
	if (!status)
		status = run(&fleet, &result);
	if (status)
		fprintf(stderr, "cautery-load: %s%s%s\n", fleet.error.path, *fleet.error.path ? ": " : "",
		        fleet.error.reason);
	else if (options.json)
		load_report_json(stdout, &fleet, &result);
	else
		load_report_text(stdout, &fleet, &result);
	load_fleet_finish(&fleet);
	return !status ? LOAD_DONE : status == CAU_IO ? LOAD_CONNECTION : LOAD_FAILED;
}
