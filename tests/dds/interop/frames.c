// SPDX-License-Identifier: GPL-3.0-or-later
#include "frames.h"

#include <stdlib.h>

#include "cautery/topology_codec.h"

struct frames_decoder {
	cau_stream_def def;
	cau_frame_decoder *decoder;
	void *storage, *scratch;
	cau_topology_arrays topology;
	int32_t last_vertex;
	cau_error error;
};

static bool allocate(frames_decoder *d)
{
	size_t faces = (size_t)d->def.face_count, vertices = (size_t)d->def.vertex_count;
	size_t bytes = cau_frame_decoder_bytes(&d->def);
	d->storage = malloc(bytes);
	d->scratch = malloc(cau_topology_scratch_bytes(&d->def));
	d->topology.face = calloc(3 * faces + 1, sizeof *d->topology.face);
	d->topology.face_layer = calloc(faces + 1, 1);
	d->topology.texture = calloc(6 * faces + 1, sizeof *d->topology.texture);
	d->topology.rest = calloc(3 * vertices + 1, sizeof *d->topology.rest);
	return d->storage && d->scratch && d->topology.face && d->topology.face_layer &&
	       d->topology.texture && d->topology.rest &&
	       !cau_frame_decoder_init(d->storage, bytes, &d->def, &d->decoder, &d->error);
}

frames_decoder *frames_create(const frames_description *description)
{
	frames_decoder *d = calloc(1, sizeof *d);
	if (!d)
		return NULL;
	d->def = (cau_stream_def){
		.session = description->session_number,
		.profile = description->profile,
		.channels = description->channels,
		.vertex_count = description->vertex_count,
		.face_count = description->face_count,
		.origin_m = {description->origin_m[0], description->origin_m[1], description->origin_m[2]},
		.step_m = description->step_m,
		.stress_step_pa = description->stress_step_pa,
	};
	d->last_vertex = -1;
	if (!cau_stream_def_check(&d->def, &d->error) && allocate(d))
		return d;
	frames_destroy(d);
	return NULL;
}

void frames_destroy(frames_decoder *d)
{
	if (!d)
		return;
	free(d->storage);
	free(d->scratch);
	free(d->topology.face);
	free(d->topology.face_layer);
	free(d->topology.texture);
	free(d->topology.rest);
	free(d);
}

const char *frames_take(frames_decoder *d, const void *bytes, size_t byte_count)
{
	return cau_frame_decode(d->decoder, bytes, byte_count, &d->error) ? d->error.reason : NULL;
}

const char *frames_take_topology(frames_decoder *d, const void *bytes, size_t byte_count)
{
	if (cau_topology_decode(&d->def, bytes, byte_count, d->scratch, &d->topology, &d->error))
		return d->error.reason;
	for (int32_t i = 0; i < 3 * d->def.face_count; i++)
		if (d->topology.face[i] > d->last_vertex)
			d->last_vertex = d->topology.face[i];
	return NULL;
}

uint64_t frames_epoch(const frames_decoder *d)
{
	return cau_frame_decoder_state(d->decoder)->epoch;
}

uint64_t frames_sequence(const frames_decoder *d)
{
	return cau_frame_decoder_state(d->decoder)->sequence;
}

uint64_t frames_tick(const frames_decoder *d)
{
	return cau_frame_decoder_state(d->decoder)->tick;
}

int32_t frames_gone_faces(const frames_decoder *d)
{
	const cau_stream_state *state = cau_frame_decoder_state(d->decoder);
	int32_t gone = 0;
	for (int32_t word = 0; state->synced && word < (d->def.face_count + 31) / 32; word++)
		gone += __builtin_popcount(state->face_mask[word]);
	return gone;
}

const int32_t *frames_quantised(const frames_decoder *d)
{
	const cau_stream_state *state = cau_frame_decoder_state(d->decoder);
	return state->synced ? state->quantised : NULL;
}

int32_t frames_last_vertex(const frames_decoder *d)
{
	return d->last_vertex;
}
