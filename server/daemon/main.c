// SPDX-License-Identifier: GPL-3.0-or-later
// cauteryd: reads its settings, starts the daemon, waits for signals, and drains.
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/config.h"
#include "config/setting.h"
#include "daemon/daemon.h"
#include "log/log.h"
#include "store/store.h"

// Exit codes: 0 after a drain, 1 if the daemon could not start, 2 for wrong settings.
enum { EXIT_STARTED = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

// limit on open descriptors, the same number as in deploy/systemd/common.conf
enum { FILES = 8192 };

static void block_signals(sigset_t *signals)
{
	sigemptyset(signals);
	sigaddset(signals, SIGTERM);
	sigaddset(signals, SIGINT);
	sigaddset(signals, SIGHUP);
	sigaddset(signals, SIGUSR1);
	sigaddset(signals, SIGUSR2);
	pthread_sigmask(SIG_BLOCK, signals, NULL); // later threads inherit the mask
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN); // the store handles the error of a file that may not grow
}

// Raises the limit on descriptors. Connections without hello may be thousands
// (transport_ws/strangers.c), but a shell gives its programs 1,024 descriptors. Set the hard limit
// for a lower number.
static void raise_file_limit(void)
{
	struct rlimit files;
	if (getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur >= FILES)
		return;
	files.rlim_cur = files.rlim_max < FILES ? files.rlim_max : FILES;
	setrlimit(RLIMIT_NOFILE, &files);
}

static int fail(const char *event, const cau_error *error)
{
	cau_log(CAU_LOG_ERROR, NULL, event, "status=%s file=\"%s\" path=\"%s\" reason=\"%s\"",
	        cau_status_name(error->status), error->file, error->path, error->reason);
	return EXIT_FAILED;
}

static void print_ready(const cau_config *config)
{
	// RFC 3986: an IPv6 address is in brackets
	bool bracketed = strchr(config->listen, ':') != NULL;
	printf("{\"address\": \"%s\", \"port\": %lld, \"url\": \"%s://%s%s%s:%lld/\", \"pid\": %d}\n",
	       config->listen, (long long)config->port, *config->tls_certificate ? "https" : "http",
	       bracketed ? "[" : "", config->listen, bracketed ? "]" : "", (long long)config->port,
	       getpid());
	fflush(stdout);
}

// The program's arguments, and the settings at the start.
typedef struct call {
	int argument_count;
	char **arguments;
	cau_config settings;
} call;

// Reads the settings again. Only the log level takes effect at once. For other changed settings,
// logs that they need a restart.
static void reload_settings(call *called)
{
	cau_config now;
	cau_config_request request;
	cau_error error = {0};
	cau_status status =
		cau_config_load(&now, &request, called->argument_count, called->arguments, environ, &error);
	if (!status && !cau_log_set_level(now.log_level))
		status = cau_fail(&error, CAU_BAD_VALUE, "log_level",
		                  "`%.20s` is not a level: use debug, info, notice, warning or error",
		                  now.log_level);
	if (status) {
		cau_log(CAU_LOG_ERROR, NULL, "reload_failed",
		        "setting=%s status=%s file=\"%s\" reason=\"%s\" kept=true", error.path,
		        cau_status_name(status), error.file, error.reason);
		return;
	}
	for (size_t i = 0; i < cau_setting_count; i++)
		if (strcmp(cau_settings[i].name, "log_level") != 0 &&
		    !cau_setting_same(&cau_settings[i], &called->settings, &now))
			cau_log(CAU_LOG_WARNING, NULL, "needs_restart", "setting=%s", cau_settings[i].name);
}

static int run(cau_config *config, bool json, call *called)
{
	sigset_t signals;
	cau_error error = {0};
	cau_daemon *daemon;
	block_signals(&signals);
	raise_file_limit();
	if (cau_daemon_start(&daemon, config, &error))
		return fail("start_failed", &error);
	if (json)
		print_ready(config);
	int signal_number = 0;
	while (signal_number != SIGTERM && signal_number != SIGINT) {
		signal_number = 0;
		if (cau_daemon_wait(daemon, &signals, &signal_number))
			break;
		if (signal_number == SIGHUP) {
			reload_settings(called);
			cau_daemon_reload(daemon);
		}
		if (signal_number == SIGUSR1 || signal_number == SIGUSR2)
			cau_daemon_stand_aside(daemon, signal_number == SIGUSR1);
	}
	cau_log(CAU_LOG_NOTICE, NULL, "ending", "signal=%d", signal_number);
	cau_daemon_stop(daemon);
	cau_log(CAU_LOG_NOTICE, NULL, "ended", "pid=%d", getpid());
	return EXIT_STARTED;
}

// Copies the store to a file that other users cannot read.
static int back_up(const cau_config *config, const char *file)
{
	cau_error error = {0};
	umask(0077);
	if (cau_store_backup(config->store, file, &error)) {
		snprintf(error.file, sizeof error.file, "%.255s", file);
		return fail("backup_failed", &error);
	}
	cau_log(CAU_LOG_NOTICE, NULL, "backed_up", "store=\"%s\" file=\"%s\"", config->store, file);
	return EXIT_STARTED;
}

int main(int argument_count, char **arguments)
{
	cau_config config;
	cau_config_request request;
	cau_error error = {0};
	if (cau_config_load(&config, &request, argument_count, arguments, environ, &error)) {
		fail("bad_settings", &error);
		return EXIT_USAGE;
	}
	if (request.help) {
		cau_config_help(stdout);
		return EXIT_STARTED;
	}
	if (request.version) {
		puts("cauteryd " CAUTERY_VERSION);
		return EXIT_STARTED;
	}
	if (request.settings_schema) {
		cau_config_schema(stdout);
		return EXIT_STARTED;
	}
	if (request.print_config) {
		cau_config_print(&config, stdout);
		return EXIT_STARTED;
	}
	if (!cau_log_set_format(config.log_format)) {
		cau_fail(&error, CAU_BAD_VALUE, "log_format", "`%.20s` is not a format: use text or json",
		         config.log_format);
		fail("bad_settings", &error);
		return EXIT_USAGE;
	}
	if (!cau_log_set_level(config.log_level)) {
		cau_fail(&error, CAU_BAD_VALUE, "log_level",
		         "`%.20s` is not a level: use debug, info, notice, warning or error",
		         config.log_level);
		fail("bad_settings", &error);
		return EXIT_USAGE;
	}
	if (request.backup)
		return back_up(&config, request.backup);
	call called = {argument_count, arguments, config};
	return run(&config, request.json, &called);
}
