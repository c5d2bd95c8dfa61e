// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations for the files of cautery-load.
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery/client.h"
#include "cautery/status.h"

// ---- options (options.c) -----------------------------------------------------------------------
// Exit codes, as --help states them.
typedef enum load_exit {
	LOAD_DONE = 0,
	LOAD_FAILED = 1,     // the daemon refused a request that the load needs
	LOAD_BAD_USAGE = 2,  // wrong options
	LOAD_CONNECTION = 3, // no daemon, or connection lost
} load_exit;

typedef struct load_options {
	const char *url, *scene;
	const char *token_file; // file of the token, or NULL
	// the token, from the environment or from token_file after that is read; or NULL
	const char *token;
	int32_t sessions;
	int32_t viewers; // viewers of each session; viewer 0 drives
	double seconds;  // length of the measurement after the warm-up
	double warm_up_s;
	double slow_pct; // percentage of the viewers that do not drive
	double rate_hz;
	bool json, help, version;
	// if not 0: end the measurement now, report, and remove the sessions
	const volatile sig_atomic_t *interrupted;
} load_options;

// Reads the command line. Prints a mistake on `complaints` and returns false.
bool load_options_read(int argument_count, char **arguments, load_options *options,
                       FILE *complaints);
void load_options_help(FILE *out);

// ---- measured values (report.c) ----------------------------------------------------------------
// A list of measured values and its percentiles.

// Largest number of values, in 256 MiB. Further values are only counted in `lost`.
enum { LOAD_SAMPLES_MAX = 1 << 26 };

typedef struct load_samples {
	float *value;
	size_t count, capacity;
	size_t lost;
} load_samples;

void load_samples_add(load_samples *samples, double value);
// Sorts the values. Returns the smallest value that at least `share` (0 to 1) of all values do not
// exceed; NAN without values.
double load_samples_percentile(load_samples *samples, double share);
void load_samples_finish(load_samples *samples);

// ---- sessions, viewers and drivers (fleet.c) ---------------------------------------------------
// The sessions, viewers and drivers of one run, with the measured values.
enum {
	// largest number of commands that are sent and not yet shown by a frame
	LOAD_OPEN_COMMANDS = 256,
	LOAD_ACKNOWLEDGED_MAX = 65536,
};

typedef struct load_fleet load_fleet;
typedef struct load_session load_session;

typedef struct load_viewer {
	load_session *session;
	cau_client *client;
	cau_client_stream *stream;
	bool slow, reading;
	double turn_s; // time at which a slow viewer starts or stops reading
	double gap_s;  // time since which frames do not fit the state, or 0
} load_viewer;

// The simulated time of a frame, and the time of its publication on the server's clock.
typedef struct load_mark {
	double time_s, published_s;
} load_mark;

typedef struct load_driver {
	int64_t sequence; // sequence of the last sent command
	double sent_s[LOAD_OPEN_COMMANDS];
	int64_t shown; // last sequence that a frame has shown
	double due_s, request_due_s;
	double start_s;        // time at which the motion began
	int64_t *acknowledged; // sequences of acknowledged requests
	int32_t acknowledged_count;
} load_driver;

struct load_session {
	load_fleet *fleet;
	char id[CAU_NAME_BYTES];
	cau_cut_def cut; // the scene's cut, which is the motion
	char tool[CAU_NAME_BYTES];
	load_viewer *viewers; // viewer 0 drives
	load_driver driver;
	load_mark first, last; // first and last frame in the measured window, from the driver's stream
	bool has_first;
};

struct load_fleet {
	const load_options *options;
	cau_loop *loop;
	load_session *sessions;
	cau_client_clock clock;
	bool measuring;
	load_samples frame_ms, command_ms;
	double position_bytes, moved, delta_bytes; // sums over delta frames
	uint64_t frames, bytes, decode_errors, gaps, gaps_unrecovered, commands, refused;
	cau_error error;
};

// Connects drivers, creates sessions and joins the drivers. Returns CAU_OK, or an error with the
// reason in fleet->error. Call load_fleet_finish in either case.
cau_status load_fleet_start(load_fleet *fleet, const load_options *options);
cau_status load_fleet_add_viewers(load_fleet *fleet); // adds all viewers except the drivers
// Runs all clients for `seconds`.
cau_status load_fleet_run(load_fleet *fleet, double seconds);
// Makes slow readers read again, and counts streams that do not catch up.
void load_fleet_settle(load_fleet *fleet);
void load_fleet_finish(load_fleet *fleet); // removes the sessions

// ---- driving (drive.c) and frames (frames.c) ---------------------------------------------------
cau_status load_drive(load_session *session, double now_s);
void load_note_command(load_session *session, double decoded_s);
// Counts acknowledged requests that the session's log does not have.
cau_status load_count_lost(load_session *session, int64_t *lost, cau_error *error);

void load_take_frame(void *user, cau_client *client, cau_client_stream *stream,
                     const cau_client_frame *frame);

// ---- results (report.c) ------------------------------------------------------------------------
typedef struct load_result {
	double window_s, end_s; // length of the measurement; its end on the server's clock
	double realtime_factor_min;
	double steal_pct;      // stolen share of this machine's processor time; NAN if unknown
	double load_cpu_pct;   // processor time of this program, percent of one core
	double rss_per_viewer; // memory of the daemon for each added viewer, bytes; NAN if unknown or
	                       // without added viewers
	double rss_before, rss_after;
	int64_t lost_acknowledged; // negative if the log could not be read
	int64_t acknowledged;
} load_result;

double load_realtime_factor(const load_session *session, double end_s);
void load_report_text(FILE *out, load_fleet *fleet, const load_result *result);
void load_report_json(FILE *out, load_fleet *fleet, const load_result *result);

// ---- machine and daemon (machine.c) ------------------------------------------------------------
// Processor time of this machine since boot, in kernel ticks. It is zero if /proc does not report
// it.
typedef struct load_cpu {
	double total, steal;
} load_cpu;
load_cpu load_cpu_read(void);

double load_own_cpu_s(void); // processor time of this process

// Reads the daemon's resident memory from /metrics at the URL's host and port, by plain HTTP only.
// `token` may be NULL. Errors: CAU_IO, CAU_UNSUPPORTED (TLS), CAU_NOT_FOUND (no such metric).
cau_status load_daemon_memory(const char *url, const char *token, double *bytes, cau_error *error);
