// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes clients' frames with the decoder of all C clients. Compares them with the states that the
// core's double had when the frames were made.
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/frame_codec.h"
#include "hosted_session/internal.h"
#include "simulation/courier.h"
#include "simulation/promises.h"
#include "simulation/world.h"

#define WRAPPED __attribute__((used))
#define ACK_NS (100 * SIM_MS) // interval of a client's acknowledgements, as the protocol says

enum {
	SEEN = 1024,       // states of a session that are kept for late frames
	SENT = 256,        // largest number of unacknowledged frames of a stream
	FRAME_MOST = 4096, // largest number of bytes of a frame; frames of nine vertices are shorter
};

typedef struct stream {
	uint32_t number; // the session's number on its daemon
	int place;
	cau_stream_def def;
	cau_frame_decoder *decoder;
	void *storage;
	uint64_t tick, epoch;
	bool lost;         // the client waits for a requested key frame
	bool acknowledged; // a frame of the stream was acknowledged at least once
	size_t in_flight;
	struct {
		uint64_t sequence;
		size_t bytes;
	} sent[SENT];
	int sent_at;
	int64_t ack_ns;
} stream;

typedef struct seen_state {
	bool used;
	uint64_t tick;
	double height_m;    // height of the first vertex
	unsigned energized; // tools with energy on, one bit for each tool
} seen_state;

static struct {
	seen_state states[SESSIONS][SEEN];
	int at[SESSIONS];
	size_t in_flight_most;
} seen;

void streams_begin(const sim_profile *profile)
{
	memset(&seen, 0, sizeof seen);
	seen.in_flight_most = (size_t)profile->subscriber_bytes;
}

// ---- states of the core
static unsigned energized_bit(const char *tool, bool energized)
{
	for (int t = 0; t < TOOLS; t++)
		if (energized && strcmp(tool, sim_tools[t]) == 0)
			return 1u << t;
	return 0;
}

void __real_cau_frames_publish(cau_hosted *h, double now_s);
void __wrap_cau_frames_publish(cau_hosted *h, double now_s);
WRAPPED void __wrap_cau_frames_publish(cau_hosted *h, double now_s)
{
	cau_frame frame;
	int place = sim_session_of(cau_hosted_id(h));
	if (place >= 0 && h->core.session) {
		cau_session_frame(h->core.session, &frame);
		seen_state *state = &seen.states[place][seen.at[place]++ % SEEN];
		*state = (seen_state){true, frame.tick, frame.position[2], 0};
		for (int32_t i = 0; i < frame.tool_count; i++)
			state->energized |= energized_bit(frame.tools[i].name, frame.tools[i].energized);
	}
	__real_cau_frames_publish(h, now_s);
}

// Compares the frame with the states of its tick. After rewinds, one tick may have several states.
static void compare(const stream *s, int client)
{
	double position[3 * 9];
	const cau_stream_state *state = cau_frame_decoder_state(s->decoder);
	bool known = false;
	unsigned energized = 0;
	cau_frame_decoder_position(s->decoder, position);
	for (int32_t i = 0; i < state->tool_count; i++)
		energized |= energized_bit(state->tools[i].name, state->tools[i].energized);
	for (int i = 0; i < SEEN; i++) {
		const seen_state *was = &seen.states[s->place][i];
		if (!was->used || was->tick != state->tick)
			continue;
		known = true;
		if (was->energized == energized &&
		    fabs(was->height_m - position[2]) <= 0.51 * s->def.step_m)
			return;
	}
	if (known)
		sim_fail("stream",
		         "client %d holds height %.6f m, energy %#x at tick %llu, which never was", client,
		         position[2], energized, (unsigned long long)state->tick);
}

// ---- joining
static double number_of(const char *text, const char *name)
{
	char key[48];
	snprintf(key, sizeof key, "\"%s\":", name);
	const char *at = strstr(text, key);
	assert(at);
	at += strlen(key);
	return strtod(at + (*at == '['), NULL);
}

static uint32_t channels_of(const char *text)
{
	uint32_t channels = 0;
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		char word[48];
		snprintf(word, sizeof word, "\"%s\"", cau_channel_describe((cau_channel_index)i)->name);
		channels |= strstr(text, word) ? 1u << i : 0;
	}
	return channels;
}

static void close_stream(stream *s)
{
	if (s)
		free(s->storage);
	free(s);
}

void streams_joined(int client, int place, const char *result)
{
	const char *origin = strstr(result, "\"origin_m\":[");
	cau_error error = {0};
	stream *s = calloc(1, sizeof *s);
	assert(s && origin);
	close_stream(sim_clients[client].streams[place]);
	sim_clients[client].streams[place] = s;
	s->place = place;
	s->number = (uint32_t)number_of(result, "session_number");
	s->def = (cau_stream_def){.session = s->number,
	                          .profile = (uint16_t)number_of(result, "profile"),
	                          .channels = channels_of(strstr(result, "\"channels\":")),
	                          .vertex_count = (int32_t)number_of(result, "vertex_count"),
	                          .face_count = (int32_t)number_of(result, "face_count"),
	                          .step_m = number_of(result, "step_m"),
	                          .stress_step_pa = number_of(result, "stress_step_pa")};
	sscanf(origin, "\"origin_m\":[%lf,%lf,%lf]", &s->def.origin_m[0], &s->def.origin_m[1],
	       &s->def.origin_m[2]);
	size_t bytes = cau_frame_decoder_bytes(&s->def);
	s->storage = malloc(bytes);
	cau_status status = cau_frame_decoder_init(s->storage, bytes, &s->def, &s->decoder, &error);
	if (status)
		sim_fail("stream", "no decoder for %s: %s %s", result, error.path, error.reason);
}

void streams_forget(int client)
{
	for (int i = 0; i < SESSIONS; i++) {
		close_stream(sim_clients[client].streams[i]);
		sim_clients[client].streams[i] = NULL;
	}
}

// A client that asks for a key frame has lost its state, so it gets a new decoder.
void streams_key_asked(int client, int place)
{
	stream *s = sim_clients[client].streams[place];
	if (!s)
		return;
	cau_status status = cau_frame_decoder_init(s->storage, cau_frame_decoder_bytes(&s->def),
	                                           &s->def, &s->decoder, NULL);
	assert(!status);
	(void)status;
	s->tick = 0;
	s->lost = true;
}

// ---- frames
static stream *find(int client, uint32_t number)
{
	for (int i = 0; i < SESSIONS; i++)
		if (sim_clients[client].streams[i] && sim_clients[client].streams[i]->number == number)
			return sim_clients[client].streams[i];
	return NULL;
}

// Decodes a frame. Every received frame must apply, because no frame is lost on the way.
static void decode(stream *s, int client, const cau_frame_header *header,
                   const unsigned char *bytes, size_t count)
{
	cau_error error = {0};
	if (s->lost && header->kind != CAU_FRAME_KEY)
		return;
	s->lost = false;
	if (cau_frame_decode(s->decoder, bytes, count, &error))
		sim_fail("stream", "client %d cannot take frame %llu of kind %d: %s %s", client,
		         (unsigned long long)header->sequence, header->kind, error.path, error.reason);
	if (header->epoch == s->epoch && header->tick < s->tick)
		sim_fail("stream", "client %d gets tick %llu after %llu of one epoch", client,
		         (unsigned long long)header->tick, (unsigned long long)s->tick);
	for (int i = 0; header->epoch != s->epoch && i < SENT; i++)
		// An acknowledgement of the new epoch acknowledges these frames, too.
		s->sent[i].sequence = 0;
	s->epoch = header->epoch;
	s->tick = header->tick;
	compare(s, client);
}

static void count_flight(stream *s, int client, uint64_t sequence, size_t count)
{
	s->sent[s->sent_at % SENT].sequence = sequence;
	s->sent[s->sent_at++ % SENT].bytes = count;
	s->in_flight += count;
	if (s->acknowledged && s->in_flight > seen.in_flight_most + FRAME_MOST)
		sim_fail("budget", "%zu bytes are in flight to client %d, at most %zu may be", s->in_flight,
		         client, seen.in_flight_most);
}

void streams_frame(int client, const unsigned char *bytes, size_t count)
{
	cau_frame_header header;
	cau_error error = {0};
	if (count >= 4 && memcmp(bytes, "CAUC", 4) == 0) {
		courier_chunk(client, bytes, count);
		return;
	}
	if (cau_frame_header_read(bytes, count, &header, &error))
		sim_fail("stream", "client %d gets what is no frame: %s", client, error.reason);
	promises_counted.frames++;
	stream *s = find(client, header.session);
	if (!s || header.kind == CAU_FRAME_TOPOLOGY)
		return;
	decode(s, client, &header, bytes, count);
	count_flight(s, client, header.sequence, count);
}

// ---- acknowledging
void streams_acknowledge(void)
{
	int64_t now_ns = sim_now();
	for (int c = 0; c < CLIENTS; c++)
		for (int i = 0; i < SESSIONS; i++) {
			stream *s = sim_clients[c].streams[i];
			char params[160], id[NAME_MOST];
			if (!s || !s->epoch || now_ns < s->ack_ns || !sim_clients[c].beats)
				continue;
			s->ack_ns = now_ns + ACK_NS;
			sim_session_id(i, sim_clients[c].machine, id);
			snprintf(params, sizeof params,
			         "\"session\":\"%s\",\"epoch\":\"%016llx\",\"sequence\":%llu", id,
			         (unsigned long long)s->epoch,
			         (unsigned long long)cau_frame_decoder_state(s->decoder)->sequence);
			clients_notify(c, "stream.ack", params);
		}
}

// Called when the daemon is about to read the acknowledgement.
void streams_ack_arriving(int client, const char *text)
{
	char id[NAME_MOST] = "";
	unsigned long long sequence = 0, epoch = 0;
	const char *session = strstr(text, "\"session\":\""), *number = strstr(text, "\"sequence\":");
	const char *of = strstr(text, "\"epoch\":\"");
	if (!session || !number || !of || sscanf(of, "\"epoch\":\"%llx", &epoch) != 1 ||
	    sscanf(session, "\"session\":\"%48[^\"]", id) != 1 ||
	    sscanf(number, "\"sequence\":%llu", &sequence) != 1)
		return;
	int place = sim_session_of(id);
	stream *s = place >= 0 ? sim_clients[client].streams[place] : NULL;
	if (!s || s->epoch != epoch)
		return;
	s->acknowledged = true;
	s->in_flight = 0;
	for (int i = s->sent_at > SENT ? s->sent_at - SENT : 0; i < s->sent_at; i++)
		if (s->sent[i % SENT].sequence <= sequence)
			s->sent[i % SENT].bytes = 0;
		else
			s->in_flight += s->sent[i % SENT].bytes;
}
