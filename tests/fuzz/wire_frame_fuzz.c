// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for frames, topology frames and chunks. Inputs are used unchanged, and with a
// corrected header so that their sections are reached. Accepted input must leave the decoder in a
// valid state.
#include "fuzz/fuzz_target.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/chunk_codec.h"
#include "cautery/name.h"
#include "cautery/topology_codec.h"
#include "protocol/wire/seed_stream.h"

static void require(bool kept)
{
	if (!kept)
		abort();
}

static void check_state(const cau_stream_def *def, const cau_stream_state *state)
{
	for (int32_t i = 0; i < 3 * def->vertex_count; i++)
		require(abs(state->quantised[i]) <= 1 << 30);
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)channel);
		for (int32_t i = 0; info->scalar >= 0 && i < def->vertex_count; i++)
			require(state->scalar[info->scalar][i] <= info->most);
	}
	require(state->tool_count >= 0 && state->tool_count <= CAU_MAX_TOOLS);
	for (int32_t i = 0; i < state->tool_count; i++)
		require(cau_name_is_valid(state->tools[i].name));
}

static void decode(cau_frame_decoder *decoder, const uint8_t *data, size_t bytes)
{
	cau_error error;
	cau_frame_decode(decoder, data, bytes, &error);
	if (cau_frame_decoder_state(decoder)->synced)
		check_state(cau_frame_decoder_def(decoder), cau_frame_decoder_state(decoder));
}

static void decode_topology(const cau_stream_def *def, const uint8_t *data, size_t bytes)
{
	static int32_t face[SEED_FACES * 3], rest[SEED_VERTICES * 3];
	static uint8_t layer[SEED_FACES];
	static float texture[SEED_FACES * 6];
	cau_topology_arrays arrays = {face, layer, texture, rest, false};
	void *scratch = malloc(cau_topology_scratch_bytes(def));
	if (scratch && cau_topology_decode(def, data, bytes, scratch, &arrays, NULL) == CAU_OK)
		for (int32_t i = 0; i < 3 * SEED_FACES; i++)
			require(face[i] >= 0 && face[i] < SEED_VERTICES);
	free(scratch);
}

static void put_header_right(uint8_t *frame, size_t bytes, const cau_stream_state *state)
{
	uint32_t byte_count = (uint32_t)bytes, session = SEED_SESSION;
	uint64_t sequence = state->sequence + 1;
	memcpy(frame, "CAUF", 4);
	frame[4] = CAU_FRAME_VERSION;
	memcpy(frame + 8, &byte_count, 4);
	memcpy(frame + 12, &session, 4);
	memcpy(frame + 16, &(uint64_t){SEED_EPOCH}, 8);
	memcpy(frame + 24, &sequence, 8);
	memcpy(frame + 32, &state->sequence, 8);
	memcpy(frame + 64, &(uint16_t){0}, 2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_stream_def def = seed_stream_def();
	size_t storage_bytes = cau_frame_decoder_bytes(&def);
	cau_frame_decoder *decoder;
	void *storage = malloc(storage_bytes);
	uint8_t *frame = malloc(bytes ? bytes : 1);
	cau_chunk chunk;
	if (!storage || !frame ||
	    cau_frame_decoder_init(storage, storage_bytes, &def, &decoder, NULL) != CAU_OK)
		abort();
	cau_chunk_read(data, bytes, &chunk, NULL);
	decode(decoder, data, bytes);
	decode_topology(&def, data, bytes);
	if (bytes >= CAU_FRAME_HEADER_BYTES) {
		memcpy(frame, data, bytes);
		for (int kind = CAU_FRAME_KEY; kind <= CAU_FRAME_DELTA; kind++) {
			put_header_right(frame, bytes, cau_frame_decoder_state(decoder));
			frame[5] = (uint8_t)kind;
			decode(decoder, frame, bytes);
		}
		frame[5] = CAU_FRAME_TOPOLOGY;
		decode_topology(&def, frame, bytes);
	}
	free(frame);
	free(storage);
	return 0;
}
