// SPDX-License-Identifier: GPL-3.0-or-later
// The streams of one session. Frames are encoded once for each profile, kept in a short ring, and
// shared by all subscribers. The session's worker joins and publishes; any thread takes frames.
#pragma once

#include <pthread.h>

#include "buffer/buffer.h"
#include "cautery/frame_codec.h"
#include "cautery/topology_codec.h"

enum {
	RING_FRAMES = 16, // deltas kept for subscribers that are a little behind
	SENT_FRAMES = 32, // frames of each subscriber whose sizes are kept
};

typedef struct cau_ring_frame {
	uint64_t sequence;
	cau_buffer *buffer;
} cau_ring_frame;

// The frames for subscribers that keep falling behind: every second frame of the same chain.
typedef struct cau_half_lane {
	int32_t subscribers; // guarded by the mutex
	// index: half the sequence, modulo RING_FRAMES; guarded by the mutex
	cau_ring_frame ring[RING_FRAMES];
	// NULL until a subscriber needs the lane; only the worker uses this and `thinner`
	void *storage;
	cau_frame_thinner *thinner;
} cau_half_lane;

typedef struct cau_stream {
	// the slot is taken; only the worker changes this, under the mutex
	bool used;
	int32_t subscribers;              // guarded by the mutex
	bool key_wanted;                  // a subscriber waits for a key frame; guarded by the mutex
	uint64_t epoch;                   // epoch of the frames in the ring; guarded by the mutex
	uint64_t newest;                  // sequence of the newest frame; guarded by the mutex
	double newest_s;                  // when the newest frame was made; guarded by the mutex
	cau_ring_frame ring[RING_FRAMES]; // index: sequence modulo RING_FRAMES; guarded by the mutex
	cau_ring_frame key;               // newest key frame; guarded by the mutex
	cau_half_lane half;
	cau_buffer *topology;    // guarded by the mutex
	cau_stream_def def;      // used by the worker only
	double rate_hz, next_s;  // used by the worker only
	void *storage, *scratch; // one piece of profile_shelf; used by the worker only
	size_t scratch_bytes;
	cau_frame_encoder *encoder; // used by the worker only
} cau_stream;

typedef struct cau_stream_counts {
	uint64_t frames, frame_bytes, key_frames;
	int32_t subscribers, half_rate; // present numbers
} cau_stream_counts;

// The streams of one session.
typedef struct cau_streams {
	const char *id;           // session's id, for the log; borrowed
	uint32_t session;         // session's number
	int64_t subscribers_most; // largest number of subscribers of all profiles together
	// largest number of bytes that are sent to an acknowledging subscriber and not acknowledged
	size_t in_flight_most;
	uint64_t epoch;        // used by the worker only
	pthread_mutex_t mutex; // held for moments; no other lock is taken while it is held
	cau_stream stream[CAU_STREAM_PROFILES_MAX];
	cau_shelf *profile_shelf, *opening_shelf; // memory of a profile, and working memory to open one
	// the newest topology, from which the next is made; NULL: none yet; used by the worker only
	cau_buffer *topology;
	cau_stream_counts counts; // guarded by the mutex; `subscribers` and `half_rate` are 0 here
} cau_streams;

// One connection's subscription to a stream. At the start all members but `stream` are zero.
typedef struct cau_subscriber {
	int32_t stream;
	bool topology_sent, has_key, wants_key, acknowledges;
	uint64_t epoch, sequence; // epoch and sequence of the last frame that was sent
	double key_asked_s;       // when a key frame was last requested, at most once a second
	// time since which frames are ready and the subscriber takes none; 0: the subscriber takes them
	double waiting_since_s;
	bool half; // the subscriber keeps falling behind and gets every second frame (ring.c)
	int32_t falls, steady; // recent falls; frames taken since the last fall
	size_t in_flight;      // bytes sent and not acknowledged
	struct {
		uint64_t sequence;
		size_t bytes;
	} sent[SENT_FRAMES]; // index: sequence modulo SENT_FRAMES
} cau_subscriber;

// Initialises a zeroed struct in which the caller has set the limits and names.
void cau_streams_init(cau_streams *streams);
void cau_streams_finish(cau_streams *streams);

// ---- profiles.c: on the worker's thread

// The stream that a subscriber requests.
typedef struct cau_stream_wish {
	double rate_hz, step_m;
	uint32_t channels;
	bool plain; // never uses meshoptimizer's codec
} cau_stream_wish;

// The tissue's data that stay the same for the whole session.
typedef struct cau_stream_shape {
	int32_t vertex_count, face_count;
	const int32_t *face, *face_layer; // face: (face_count x 3), face_layer: (face_count)
	// (face_count x 3 x 2): texture coordinates of the faces' corners
	const float *texture;
	const double *rest_position; // (vertex_count x 3), m
} cau_stream_shape;

// cau_streams_opening_bytes returns the bytes that opening a profile takes. cau_streams_stock
// allocates these bytes beforehand and encodes the topology. The builder calls it, so that no slice
// of a worker has to do this. If it fails, the slice of the first session.join encodes the
// topology.
size_t cau_streams_opening_bytes(int32_t vertex_count, int32_t face_count);
cau_status cau_streams_stock(cau_streams *streams, const cau_stream_shape *shape, cau_error *error);

// Returns a stream that fits, opened if necessary, and counts the subscriber until
// cau_streams_leave. *woken: the stream had no subscribers before, so a frame is due now.
// CAU_LIMIT: the session has its largest number of subscribers.
cau_status cau_streams_join(cau_streams *streams, const cau_stream_wish *wish,
                            const cau_stream_shape *shape, const cau_stream **joined, bool *woken,
                            cau_error *error);
// Returns the channels that have subscribers: CAU_CHANNEL_*.
uint32_t cau_streams_watched(cau_streams *streams);

// ---- publish.c: on the worker's thread

// A moment at which frames may be due.
typedef struct cau_stream_moment {
	double now_s;
	// frames are due whatever the streams' rates are, because something has changed without a step
	bool all;
	bool moving; // simulated time advances
	// Returns the present state. Called at most once, and only if a frame is due.
	const cau_stream_sample *(*sample)(void *user);
	void *user;
} cau_stream_moment;

// Begins a new epoch and returns it. Frames of the old epoch are no base for later deltas.
uint64_t cau_streams_restart(cau_streams *streams);
// Makes the frames that are due; *made: at least one was made. If a profile cannot be encoded,
// *error has the reason, and the other profiles continue.
cau_status cau_streams_publish(cau_streams *streams, const cau_stream_moment *moment, bool *made,
                               cau_error *error);

// ---- subscribers.c: from any thread

// Returns the frame that the subscriber must get now, or NULL. The frame is shared: the caller
// releases it. *wake: the subscriber waits for a key frame that the worker must make.
cau_buffer *cau_streams_next_frame(cau_streams *streams, cau_subscriber *subscriber, double now_s,
                                   bool *wake);
// Notes that the subscriber has every frame up to this one.
void cau_streams_acknowledge(cau_subscriber *subscriber, uint64_t epoch, uint64_t sequence);
// True if a frame is there that the subscriber has not got.
bool cau_streams_has_frame(cau_streams *streams, const cau_subscriber *subscriber);
void cau_streams_leave(cau_streams *streams, const cau_subscriber *subscriber);
void cau_streams_count(cau_streams *streams, cau_stream_counts *counts);
