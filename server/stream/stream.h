// SPDX-License-Identifier: GPL-3.0-or-later
// The streams of one session: frames encoded once for each profile, kept in a short ring, shared by
// every subscriber. The session's worker joins and publishes; any thread takes frames.
#pragma once

#include <pthread.h>

#include "buffer/buffer.h"
#include "buffer/shelf.h"
#include "cautery/frame_codec.h"
#include "cautery/topology_codec.h"

enum {
	RING_FRAMES = 16, // deltas kept for subscribers that are a little behind
	SENT_FRAMES = 32, // of each subscriber whose bytes are known
};

typedef struct cau_ring_frame {
	uint64_t sequence;
	cau_buffer *buffer;
} cau_ring_frame;

// The stream for those that keep falling behind: every second frame of the same chain.
typedef struct cau_half_lane {
	int32_t subscribers;              // mutex
	cau_ring_frame ring[RING_FRAMES]; // mutex, by half the sequence modulo RING_FRAMES
	void *storage;                    // worker, like what follows; NULL until somebody needs it
	cau_frame_thinner *thinner;
} cau_half_lane;

typedef struct cau_stream {
	bool used;                        // slot taken; changed by the worker under the mutex
	int32_t subscribers;              // mutex
	bool key_wanted;                  // mutex
	uint64_t epoch;                   // mutex: of what is in the ring
	uint64_t newest;                  // mutex: sequence
	double newest_s;                  // mutex: when it came
	cau_ring_frame ring[RING_FRAMES]; // mutex, by sequence modulo RING_FRAMES
	cau_ring_frame key;               // mutex
	cau_half_lane half;
	cau_buffer *topology;    // mutex
	cau_stream_def def;      // worker
	double rate_hz, next_s;  // worker
	void *storage, *scratch; // worker; one piece of profile_shelf
	size_t scratch_bytes;
	cau_frame_encoder *encoder; // worker
} cau_stream;

typedef struct cau_stream_counts {
	uint64_t frames, frame_bytes, key_frames;
	int32_t subscribers, half_rate; // now
} cau_stream_counts;

// `worker` marks what only the session's worker touches, `mutex` what the mutex guards.
typedef struct cau_streams {
	const char *id;           // of the session, for the log; borrowed
	uint32_t session;         // its number
	int64_t subscribers_most; // of all profiles
	size_t in_flight_most;    // bytes sent to a subscriber that acknowledges, and not acknowledged
	uint64_t epoch;           // worker
	pthread_mutex_t mutex;    // held for moments; no other lock is taken under it
	cau_stream stream[CAU_STREAM_PROFILES_MAX];
	cau_shelf *profile_shelf, *opening_shelf; // memory of a profile, and for opening one
	cau_buffer *topology;     // worker; the newest, from which the next is made; NULL: none yet
	cau_stream_counts counts; // mutex; those of now are 0 here
} cau_streams;

// One stream of one connection; zeroed but for `stream` at the start.
typedef struct cau_subscriber {
	int32_t stream;
	bool topology_sent, has_key, wants_key, acknowledges;
	uint64_t epoch, sequence; // of the last frame sent
	double key_asked_s;       // a key frame at most once a second
	double waiting_since_s;   // frames are there and it takes none; 0: not so
	bool half;                // it keeps falling behind: every second frame (half_rate.c)
	int32_t falls, steady;    // falls of late; frames taken since the last one
	size_t in_flight;         // bytes sent and not acknowledged
	struct {
		uint64_t sequence;
		size_t bytes;
	} sent[SENT_FRAMES]; // by sequence modulo SENT_FRAMES
} cau_subscriber;

// A zeroed struct, whose bounds and names the caller sets.
void cau_streams_init(cau_streams *streams);
void cau_streams_finish(cau_streams *streams);

// ---- profiles.c: on the worker

// What a subscriber asks for.
typedef struct cau_stream_wish {
	double rate_hz, step_m;
	uint32_t channels;
	bool plain; // a stream that never uses meshoptimizer's codec, or none
} cau_stream_wish;

// What is the same for a session's whole life.
typedef struct cau_stream_shape {
	int32_t vertex_count, face_count;
	const int32_t *face, *face_layer; // (face_count x 3), (face_count)
	const float *texture;             // (face_count x 3 x 2)
	const double *rest_position;      // m, (vertex_count x 3)
} cau_stream_shape;

// Bytes that opening a profile takes; and, on the builder, allocating them beforehand. The builder
// also encodes the topology, so that no slice of a worker does it. If that fails, the slice of the
// first session.join encodes it.
size_t cau_streams_opening_bytes(int32_t vertex_count, int32_t face_count);
cau_status cau_streams_stock(cau_streams *streams, const cau_stream_shape *shape, cau_error *error);

// A stream that fits, opened if need be, with the subscriber counted; it ends with
// cau_streams_leave. *woken: nothing was published there, so a frame is due now. CAU_LIMIT: the
// session has as many subscribers as it may.
cau_status cau_streams_join(cau_streams *streams, const cau_stream_wish *wish,
                            const cau_stream_shape *shape, const cau_stream **joined, bool *woken,
                            cau_error *error);
// The channels that somebody watches: CAU_CHANNEL_*.
uint32_t cau_streams_watched(cau_streams *streams);

// ---- publish.c: on the worker

// A moment at which frames may be due.
typedef struct cau_stream_moment {
	double now_s;
	bool all;    // whatever the streams' rates: something has changed without a step
	bool moving; // time goes on
	// What there is to be seen; called at most once, and only if a frame is due.
	const cau_stream_sample *(*sample)(void *user);
	void *user;
} cau_stream_moment;

// A new epoch, which it returns: what was published before does not lead to what comes.
uint64_t cau_streams_restart(cau_streams *streams);
// Makes the frames that are due; *made: there are some. A profile that cannot be encoded is told,
// the others go on.
cau_status cau_streams_publish(cau_streams *streams, const cau_stream_moment *moment, bool *made,
                               cau_error *error);

// ---- subscribers.c: from any thread

// The frame that the subscriber should get now, shared for the caller, or NULL. *wake: it waits for
// a key frame that the worker is to make.
cau_buffer *cau_streams_next_frame(cau_streams *streams, cau_subscriber *subscriber, double now_s,
                                   bool *wake);
// It holds everything up to this frame.
void cau_streams_acknowledge(cau_subscriber *subscriber, uint64_t epoch, uint64_t sequence);
// True if there is something that the subscriber has not got.
bool cau_streams_has_frame(cau_streams *streams, const cau_subscriber *subscriber);
void cau_streams_leave(cau_streams *streams, const cau_subscriber *subscriber);
void cau_streams_count(cau_streams *streams, cau_stream_counts *counts);
