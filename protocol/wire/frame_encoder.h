// SPDX-License-Identifier: Apache-2.0
// Internals of the encoder, for the thinner, which makes other frames of the same states.
#pragma once

#include <stdbool.h>

#include "cautery/frame_codec.h"
#include "wire/arrays.h"

typedef struct cau_tool_set {
	int32_t count;
	cau_stream_tool tools[CAU_MAX_TOOLS];
} cau_tool_set;

struct cau_frame_encoder {
	cau_stream_def def;
	cau_frame_header header;           // header of the last frame
	uint32_t *held[CAU_CHANNEL_COUNT]; // state of decoders that have all frames
	uint32_t *next[CAU_CHANNEL_COUNT]; // state of these decoders after the frame that is being made
	cau_tool_set tools;
	cau_stream_statistics statistics;
	int32_t vessel_count;
	cau_vessel_state vessels[CAU_MAX_VESSELS];
	int32_t contact_count;
	cau_tool_contact contacts[CAU_MAX_TOOLS];
	uint8_t *scratch;
};

// True if decoders that know the tools of `set` need the names of `tools`.
bool cau_tool_sets_differ(const cau_tool_set *set, const cau_stream_tool *tools, int32_t count);

cau_status cau_encoder_check_capacity(const cau_frame_encoder *encoder, size_t capacity,
                                      cau_error *error);

// Writes the delta from `base`, the arrays of the state with that sequence, to the present state.
// Returns its length.
size_t cau_encoder_write_delta(const cau_frame_encoder *encoder,
                               uint32_t *const base[CAU_CHANNEL_COUNT], uint64_t base_sequence,
                               bool names, void *bytes);
