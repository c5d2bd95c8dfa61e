// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/mesh_scene.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/local_file.h"
#include "cautery/name.h"

enum { MESH_BYTES_MAX = 1 << 30, KINDS_MAX = 24, MENDS_MAX = 16, REGIONS_MAX = 64 };

// ---- mesh files
// Finds the second file of a TetGen pair. Returns false if `file` is not part of a pair, or if the
// second file does not exist.
static bool find_partner(const char *file, char *partner, size_t bytes)
{
	static const char *const pairs[][2] = {
		{".node", ".ele"}, {".node", ".face"}, {".ele", ".node"}, {".face", ".node"}};
	size_t length = strlen(file);
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		size_t ending = strlen(pairs[i][0]);
		if (length < ending || strcasecmp(file + length - ending, pairs[i][0]) != 0)
			continue;
		snprintf(partner, bytes, "%.*s%s", (int)(length - ending), file, pairs[i][1]);
		if (access(partner, R_OK) == 0)
			return true;
	}
	return false;
}

cau_status cli_read_mesh_file(const char *file, char **bytes, size_t *byte_count, cau_error *error)
{
	char partner[2 * CAU_TEXT_BYTES], *other = NULL;
	size_t other_count = 0, length = strlen(file);
	cau_status status = cli_read_file(file, MESH_BYTES_MAX, bytes, byte_count, error);
	if (!status && !*byte_count) {
		free(*bytes);
		*bytes = NULL;
		status = cau_fail(error, CAU_BAD_MESH, NULL, "the file is empty");
		snprintf(error->file, sizeof error->file, "%.255s", file);
	}
	if (status || !find_partner(file, partner, sizeof partner))
		return status;
	status = cli_read_file(partner, MESH_BYTES_MAX, &other, &other_count, error);
	bool points = length >= 5 && strcasecmp(file + length - 5, ".node") == 0;
	const char *first = points ? *bytes : other, *second = points ? other : *bytes;
	size_t first_count = points ? *byte_count : other_count;
	size_t second_count = points ? other_count : *byte_count;
	char *joined = status ? NULL : malloc(first_count + second_count + 1);
	if (joined) {
		memcpy(joined, first, first_count);
		joined[first_count] = '\n';
		memcpy(joined + first_count + 1, second, second_count);
	} else if (!status) {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for two files");
	}
	free(*bytes);
	free(other);
	*bytes = joined;
	*byte_count = first_count + second_count + 1;
	return status;
}

bool cli_is_mesh_file(const char *argument)
{
	struct stat about;
	const char *ending = strrchr(argument, '.');
	if (ending && strcasecmp(ending, ".json") == 0)
		return false;
	return (stat(argument, &about) == 0 && S_ISREG(about.st_mode)) || !cau_name_is_valid(argument);
}

// ---- error texts
// Replaces the names of the protocol in `text` by the names of the command-line options.
static void use_own_words(char *text, size_t bytes)
{
	static const char *const words[][2] = {{"unit_m", "--unit-m"},
	                                       {"strict refuses", "--strict refuses"},
	                                       {"(labels)", "(--labels)"},
	                                       {"(as fascia)", "(--as fascia)"},
	                                       {"(as fat)", "(--as fat)"}};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		char *at = strstr(text, words[i][0]);
		size_t from = strlen(words[i][0]), to = strlen(words[i][1]);
		for (; at; at = strstr(at + to, words[i][0])) {
			size_t rest = strlen(at + from) + 1;
			if ((size_t)(at - text) + to + rest > bytes)
				return;
			memmove(at + to, at + from, rest);
			memcpy(at, words[i][1], to);
		}
	}
}

// A mesh reading with memory for its lists.
typedef struct mesh_reading {
	cau_wire_mesh_reading wire;
	cau_wire_mesh_kind kinds[KINDS_MAX];
	cau_wire_mesh_mend mends[MENDS_MAX];
	cau_wire_mesh_region regions[REGIONS_MAX];
} mesh_reading;

// Fails with the file and the reason. The error's path points into params that the user did not
// write, so it is removed.
static cli_exit fail_reading(cli *c, const char *file)
{
	c->error.path[0] = 0;
	snprintf(c->error.file, sizeof c->error.file, "%.255s", file);
	return cli_fail(c);
}

// Requests the report and prints it. `options` is true if the user gave options; then error texts
// name options.
static cli_exit read_mesh(cli *c, const char *file, const cau_wire_mesh_read *params, bool options,
                          cau_scene_def *scene)
{
	mesh_reading *reading = calloc(1, sizeof *reading);
	if (!reading)
		return cli_fail_memory(c);
	cau_wire_mesh_report *report = &reading->wire.report;
	reading->wire.definition = scene;
	report->kinds = (cau_wire_list){reading->kinds, 0, KINDS_MAX};
	report->mended = (cau_wire_list){reading->mends, 0, MENDS_MAX};
	report->regions = (cau_wire_list){reading->regions, 0, REGIONS_MAX};
	cau_status status =
		cau_client_call(c->client, CAU_METHOD_MESH_READ, params, &reading->wire, &c->error);
	if (options) {
		use_own_words(report->text, sizeof report->text);
		use_own_words(reading->wire.note, sizeof reading->wire.note);
		use_own_words(c->error.reason, sizeof c->error.reason);
	}
	if (!status)
		fprintf(c->complaints, "%s\n%s", file, report->text);
	if (!status && options && reading->wire.has_note)
		fprintf(c->complaints, "note: %s\n", reading->wire.note);
	free(reading);
	return status ? fail_reading(c, file) : CLI_DONE;
}

// Copies the text of an option, which the server checks. Returns false if the option is not given.
static bool take_text(const cli *c, const char *option, char *text, size_t bytes)
{
	const char *value = cli_value(c, option);
	snprintf(text, bytes, "%s", value ? value : "");
	return value != NULL;
}

cli_exit cli_mesh_scene(cli *c, const char *file, const char *name, cau_scene_def *scene)
{
	cau_wire_mesh_read params = {0};
	bool bad = false;
	const char *kind = cli_value(c, "as");
	snprintf(params.upload, sizeof params.upload, "%s", name);
	params.has_unit_m = cli_value(c, "unit-m") != NULL;
	params.unit_m = cli_number(c, "unit-m", 1e-9, 1000, 1, &bad);
	params.has_as = kind != NULL;
	params.as = kind && strcmp(kind, "fat") == 0 ? CAU_LAYER_FAT : CAU_LAYER_FASCIA;
	params.has_strict = params.strict = cli_value(c, "strict") != NULL;
	params.has_edge_m = cli_value(c, "edge-mm") != NULL;
	params.edge_m = 1e-3 * cli_number(c, "edge-mm", 1e-3, 10000, 1, &bad);
	params.has_labels = take_text(c, "labels", params.labels, sizeof params.labels);
	params.has_pin = take_text(c, "pin", params.pin, sizeof params.pin);
	return bad ? CLI_USAGE : read_mesh(c, file, &params, true, scene);
}

cli_exit cli_mesh_report(cli *c, const char *file, const cau_mesh_def *mesh)
{
	cau_wire_mesh_read params = {.has_unit_m = true,
	                             .unit_m = mesh->unit_m,
	                             .has_strict = true,
	                             .strict = mesh->strict,
	                             .has_as_it_is = true,
	                             .as_it_is = true};
	snprintf(params.upload, sizeof params.upload, "%s", mesh->name);
	cau_scene_def *unused = calloc(1, sizeof *unused);
	if (!unused)
		return cli_fail_memory(c);
	cli_exit code = read_mesh(c, file, &params, false, unused);
	free(unused);
	return code;
}
