// SPDX-License-Identifier: GPL-3.0-or-later
// write_seeds FOLDER: writes frames as seeds for the fuzz targets. Run it by hand when the layout
// changes.
#include <stdio.h>
#include <stdlib.h>

#include "cautery/topology_codec.h"
#include "protocol/wire/seed_stream.h"
#include "protocol/wire/tissue.h"

static int write_seed(const char *folder, const char *name, const uint8_t *bytes, size_t count)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "wb");
	if (!file || fwrite(bytes, 1, count, file) != count) {
		perror(path);
		return 1;
	}
	return fclose(file) != 0;
}

static int write_topology(const char *folder, const cau_stream_def *def, const tissue *of)
{
	static int32_t face[SEED_FACES * 3];
	static uint8_t layer[SEED_FACES];
	static float texture[SEED_FACES * 6];
	for (int32_t i = 0; i < SEED_FACES * 3; i++)
		face[i] = (i * 7) % SEED_VERTICES;
	cau_topology topology = {
		.face = face, .face_layer = layer, .texture = texture, .rest_position = of->position};
	size_t capacity = cau_topology_bytes_max(def), count;
	uint8_t *bytes = malloc(capacity);
	void *scratch = malloc(cau_topology_scratch_bytes(def));
	int failed =
		!bytes || !scratch ||
		cau_topology_encode(def, SEED_EPOCH, &topology, scratch, bytes, capacity, &count, NULL) ||
		write_seed(folder, "topology", bytes, count);
	free(bytes);
	free(scratch);
	return failed;
}

int main(int argument_count, char **arguments)
{
	static const double speeds[] = {0.0, 0.01, 0.05, 1.0, 100.0};
	cau_stream_def def = seed_stream_def();
	size_t storage = cau_frame_encoder_bytes(&def), capacity = cau_frame_bytes_max(&def), count;
	cau_frame_encoder *encoder;
	uint8_t *bytes = malloc(capacity);
	tissue of;
	tissue_init(&of, SEED_COLUMNS, SEED_ROWS);
	void *room = malloc(storage);
	if (argument_count != 2 || !bytes || !room ||
	    cau_frame_encoder_init(room, storage, &def, SEED_EPOCH, &encoder, NULL)) {
		free(bytes);
		free(room);
		return EXIT_FAILURE;
	}
	int failed = write_topology(arguments[1], &def, &of);
	for (int i = 0; i < 5 && !failed; i++) {
		char name[32];
		tissue_move(&of, 4 * i, speeds[i]);
		cau_stream_sample sample = tissue_sample(&of);
		snprintf(name, sizeof name, "%s-%d", i ? "delta" : "key", i);
		failed = cau_frame_encode(encoder, &sample, bytes, capacity, &count, NULL) ||
		         write_seed(arguments[1], name, bytes, count);
	}
	free(encoder);
	free(bytes);
	tissue_finish(&of);
	return failed;
}
