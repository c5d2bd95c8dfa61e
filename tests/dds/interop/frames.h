// SPDX-License-Identifier: GPL-3.0-or-later
// The protocol's decoder for a program in C++. Its inputs are the members of a frame on DDS; its
// outputs are the decoded values.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The members of cautery::StreamDescription, with the session's number.
typedef struct frames_description {
	uint32_t session_number;
	uint16_t profile;
	uint32_t channels;
	int32_t vertex_count, face_count;
	double origin_m[3], step_m, stress_step_pa;
} frames_description;

typedef struct frames_decoder frames_decoder;

// Returns a decoder for the stream. Returns NULL if the description is invalid or memory ran out.
frames_decoder *frames_create(const frames_description *description);
void frames_destroy(frames_decoder *decoder);

// Takes a key frame or a delta. Returns NULL on success, else the reason, which is valid until the
// next call.
const char *frames_take(frames_decoder *decoder, const void *bytes, size_t byte_count);
// Takes a topology frame. Returns NULL on success, else the reason, like frames_take.
const char *frames_take_topology(frames_decoder *decoder, const void *bytes, size_t byte_count);

// The functions below read the decoder's state. They return 0 or NULL before the first key frame.
uint64_t frames_epoch(const frames_decoder *decoder);
uint64_t frames_sequence(const frames_decoder *decoder);
uint64_t frames_tick(const frames_decoder *decoder);
int32_t frames_gone_faces(const frames_decoder *decoder);
const int32_t *frames_quantised(const frames_decoder *decoder); // (vertex_count x 3)
// Returns the largest vertex index of the topology's faces, or -1 before the topology.
int32_t frames_last_vertex(const frames_decoder *decoder);

#ifdef __cplusplus
}
#endif
