// SPDX-License-Identifier: GPL-3.0-or-later
// write_frames FOLDER: writes a topology frame, a key frame and deltas from the C encoder. For each
// frame it also writes the C decoder's state, for comparison with the viewer's decoder.
#include <stdio.h>
#include <stdlib.h>

#include "cautery/topology_codec.h"
#include "protocol/wire/tissue.h"

enum { COLUMNS = 40, ROWS = 25, FRAMES = 24 };
static const uint64_t stream_epoch = 0xfedcba9876543210u;

static int write_file(const char *folder, const char *kind, int number, const void *bytes,
                      size_t count, const char *mode)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s-%02d.bin", folder, kind, number);
	FILE *file = fopen(path, mode);
	if (!file || fwrite(bytes, 1, count, file) != count) {
		perror(path);
		if (file)
			fclose(file);
		return 1;
	}
	return fclose(file) != 0;
}

static int write_topology(const char *folder, const cau_stream_def *def, const tissue *of)
{
	size_t faces = (size_t)def->face_count, capacity = cau_topology_bytes_max(def), count = 0;
	int32_t *face = calloc(3 * faces, sizeof *face);
	uint8_t *layer = calloc(faces, 1), *bytes = malloc(capacity);
	float *texture = calloc(6 * faces, sizeof *texture);
	void *scratch = malloc(cau_topology_scratch_bytes(def));
	int failed = !face || !layer || !bytes || !texture || !scratch;
	for (int32_t i = 0; !failed && i < def->face_count; i++) {
		layer[i] = (uint8_t)(i % 3);
		for (int32_t c = 0; c < 3; c++) {
			face[3 * i + c] = (i * 7 + c) % def->vertex_count;
			texture[6 * i + 2 * c] = 0.25f * (float)i;
			texture[6 * i + 2 * c + 1] = -0.5f * (float)c;
		}
	}
	cau_topology topology = {
		.face = face, .face_layer = layer, .texture = texture, .rest_position = of->position};
	failed = failed || cau_topology_encode(def, stream_epoch, &topology, scratch, bytes, capacity,
	                                       &count, NULL);
	failed = failed || write_file(folder, "topology", 0, bytes, count, "wb");
	free(face);
	free(layer);
	free(texture);
	free(scratch);
	free(bytes);
	return failed;
}

// Writes the state of the C decoder: epoch, sequence, tick, then every array, all little-endian.
static int write_state(const char *folder, int number, const cau_frame_decoder *decoder)
{
	const cau_stream_state *state = cau_frame_decoder_state(decoder);
	const cau_stream_def *def = cau_frame_decoder_def(decoder);
	uint64_t head[3] = {state->epoch, state->sequence, state->tick};
	size_t vertices = (size_t)def->vertex_count, words = ((size_t)def->face_count + 31) / 32;
	const struct {
		const void *bytes;
		size_t count;
	} parts[] = {
		{head, sizeof head},
		{state->quantised, 12 * vertices},
		{state->face_mask, 4 * words},
	};
	int failed = 0;
	for (size_t i = 0; i < sizeof parts / sizeof parts[0] && !failed; i++)
		failed =
			write_file(folder, "state", number, parts[i].bytes, parts[i].count, i ? "ab" : "wb");
	for (int i = 0; i < CAU_SCALAR_COUNT && !failed; i++)
		failed = write_file(folder, "state", number, state->scalar[i], 4 * vertices, "ab");
	return failed;
}

static int write_frames(const char *folder, const cau_stream_def *def, tissue *of)
{
	static const double speeds[] = {0.0, 0.01, 0.3, 3.0};
	size_t bytes_max = cau_frame_bytes_max(def), count;
	size_t encoder_bytes = cau_frame_encoder_bytes(def),
		   decoder_bytes = cau_frame_decoder_bytes(def);
	void *encoder_storage = malloc(encoder_bytes), *decoder_storage = malloc(decoder_bytes);
	uint8_t *bytes = malloc(bytes_max);
	cau_frame_encoder *encoder;
	cau_frame_decoder *decoder;
	int failed =
		!bytes || !encoder_storage || !decoder_storage ||
		cau_frame_encoder_init(encoder_storage, encoder_bytes, def, stream_epoch, &encoder, NULL) ||
		cau_frame_decoder_init(decoder_storage, decoder_bytes, def, &decoder, NULL);
	for (int i = 0; i < FRAMES && !failed; i++) {
		tissue_move(of, i, speeds[i % 4]);
		cau_stream_sample sample = tissue_sample(of);
		failed = cau_frame_encode(encoder, &sample, bytes, bytes_max, &count, NULL) ||
		         cau_frame_decode(decoder, bytes, count, NULL) ||
		         write_file(folder, "frame", i, bytes, count, "wb") ||
		         write_state(folder, i, decoder);
	}
	failed = failed || cau_frame_encode_key(encoder, bytes, bytes_max, &count, NULL) ||
	         write_file(folder, "key", FRAMES - 1, bytes, count, "wb");
	free(bytes);
	free(encoder_storage);
	free(decoder_storage);
	return failed;
}

int main(int argument_count, char **arguments)
{
	if (argument_count != 2) {
		fputs("usage: write_frames FOLDER\n", stderr);
		return EXIT_FAILURE;
	}
	tissue of;
	tissue_init(&of, COLUMNS, ROWS);
	cau_stream_def def = tissue_stream_def(&of);
	int failed = write_topology(arguments[1], &def, &of) || write_frames(arguments[1], &def, &of);
	tissue_finish(&of);
	return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
