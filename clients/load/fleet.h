// SPDX-License-Identifier: GPL-3.0-or-later
// The sessions, viewers and drivers of one run, with the measured values.
#pragma once

#include "cautery/client.h"
#include "load/options.h"
#include "load/samples.h"

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

// drive.c
cau_status load_drive(load_session *session, double now_s);
void load_note_command(load_session *session, double decoded_s);
// Counts acknowledged requests that the session's log does not have.
cau_status load_count_lost(load_session *session, int64_t *lost, cau_error *error);

// frames.c
void load_take_frame(void *user, cau_client *client, cau_client_stream *stream,
                     const cau_client_frame *frame);
