// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a fuzz target without libFuzzer. The inputs are all files of the folders in the arguments,
// each of these files cut short and with flipped bits, the empty input, and a fixed pseudo-random
// set.
#include "fuzz/fuzz_target.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

enum {
	LARGEST_SEED_BYTES = 1 << 20,
	MUTATIONS_PER_SEED = 64,
	RANDOM_INPUTS = 256,
	LARGEST_RANDOM_BYTES = 512,
};

// Returns the next number of the generator xorshift64, so that every run has the same inputs.
static uint64_t next_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

// Runs the parser on an allocation of exactly `bytes`, so that a sanitizer detects an access one
// byte beyond.
static bool run_exact(const uint8_t *data, size_t bytes)
{
	uint8_t *exact = calloc(bytes ? bytes : 1, 1);
	if (!exact)
		return false;
	for (size_t i = 0; i < bytes; i++)
		exact[i] = data[i];
	LLVMFuzzerTestOneInput(exact, bytes);
	free(exact);
	return true;
}

static bool run_mutations(uint8_t *data, size_t bytes, uint64_t *random)
{
	for (int i = 0; i < MUTATIONS_PER_SEED && bytes > 0; i++) {
		size_t at = (size_t)(next_random(random) % bytes);
		uint8_t kept = data[at];
		data[at] = (uint8_t)(kept ^ (1u << (next_random(random) % 8)));
		bool ran = run_exact(data, bytes);
		data[at] = kept;
		if (!ran || !run_exact(data, at))
			return false;
	}
	return true;
}

static bool run_file(const char *path, uint8_t *buffer, uint64_t *random)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		perror(path);
		return false;
	}
	size_t bytes = fread(buffer, 1, LARGEST_SEED_BYTES, file);
	bool read = !ferror(file);
	fclose(file);
	return read && run_exact(buffer, bytes) && run_mutations(buffer, bytes, random);
}

static bool run_folder(const char *folder, uint8_t *buffer, uint64_t *random)
{
	struct dirent **entries;
	int count = scandir(folder, &entries, NULL, alphasort);
	if (count < 0) {
		perror(folder);
		return false;
	}
	bool ran = true;
	for (int i = 0; i < count; i++) {
		char path[4096];
		int length = snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
		if (ran && entries[i]->d_name[0] != '.')
			ran = length < (int)sizeof path && run_file(path, buffer, random);
		free(entries[i]);
	}
	free(entries);
	printf("%s: %d entries\n", folder, count - 2);
	return ran && count > 2;
}

static bool run_random(uint8_t *buffer, uint64_t *random)
{
	for (int i = 0; i < RANDOM_INPUTS; i++) {
		size_t bytes = (size_t)(next_random(random) % LARGEST_RANDOM_BYTES);
		for (size_t j = 0; j < bytes; j++)
			buffer[j] = (uint8_t)next_random(random);
		if (!run_exact(buffer, bytes))
			return false;
	}
	return true;
}

int main(int argument_count, char **arguments)
{
	uint64_t random = 0x9E3779B97F4A7C15u;
	uint8_t *buffer = calloc(LARGEST_SEED_BYTES, 1);
	bool ran = buffer && run_exact(buffer, 0) && run_random(buffer, &random);
	for (int i = 1; ran && i < argument_count; i++)
		ran = run_folder(arguments[i], buffer, &random);
	free(buffer);
	return ran ? EXIT_SUCCESS : EXIT_FAILURE;
}
