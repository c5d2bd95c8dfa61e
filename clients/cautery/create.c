// SPDX-License-Identifier: GPL-3.0-or-later
// The command `create`: creates a session from a scene of the daemon, a local scene file or a mesh.
// The daemon reads a mesh file, reports how it read it, and makes a scene around the mesh.
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/cli.h"
#include "cautery/name.h"
#include "cautery/progress.h"
#include "cautery/scene_json.h"

enum { MESH_BYTES_MAX = 1 << 30, KINDS_MAX = 24, MENDS_MAX = 16, REGIONS_MAX = 64 };

// ---- mesh files --------------------------------------------------------------------------------
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

// Reads a mesh file. TetGen splits a mesh into two files of one name (.node and .ele or .face);
// both are read, points first. The caller frees *bytes.
static cau_status read_mesh_file(const char *file, char **bytes, size_t *byte_count,
                                 cau_error *error)
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

// True if `argument` means a mesh file: an existing file that is not a scene file, or a text that
// cannot be the name of a scene.
static bool is_mesh_file(const char *argument)
{
	struct stat about;
	const char *ending = strrchr(argument, '.');
	if (ending && strcasecmp(ending, ".json") == 0)
		return false;
	return (stat(argument, &about) == 0 && S_ISREG(about.st_mode)) || !cau_name_is_valid(argument);
}

// ---- the report on a mesh ----------------------------------------------------------------------
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

// Makes the server read the upload `name` of `file` with the options --as, --unit-m and --strict.
// Prints the report and fills *scene with a scene around the mesh. Error texts name these options.
static cli_exit mesh_scene(cli *c, const char *file, const char *name, cau_scene_def *scene)
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

// Makes the server read the upload of `file`, a mesh of a scene file, with the scene's unit and
// strictness. Prints the report.
static cli_exit report_mesh(cli *c, const char *file, const cau_mesh_def *mesh)
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

// ---- uploads -----------------------------------------------------------------------------------
// Uploads `file` and changes the mesh to source `bytes`.
static cli_exit upload_mesh(cli *c, const char *file, cau_mesh_def *mesh)
{
	char *bytes = NULL;
	size_t byte_count = 0;
	cau_wire_upload_result result = {0};
	cli_progress progress;
	if (read_mesh_file(file, &bytes, &byte_count, &c->error))
		return cli_fail_file(c);
	const char *slash = strrchr(file, '/');
	cli_progress_begin(&progress, c->complaints, file);
	cau_status status =
		cau_client_upload(c->client, mesh->name, slash ? slash + 1 : file, bytes, byte_count,
	                      cli_progress_bytes, &progress, &result, &c->error);
	cli_progress_end(&progress);
	free(bytes);
	if (status)
		return cli_fail(c);
	mesh->source = CAU_MESH_BYTES;
	memcpy(mesh->file, result.file, sizeof result.file);
	return CLI_DONE;
}

// Uploads the mesh files of a scene file. Relative names start at the folder of the scene file.
static cli_exit upload_meshes(cli *c, cau_scene_def *scene)
{
	cli_exit code = CLI_DONE;
	for (int32_t i = 0; !code && i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		char file[2 * CAU_TEXT_BYTES];
		bool beside = scene->directory[0] && mesh->file[0] != '/';
		if (mesh->source != CAU_MESH_FILE)
			continue;
		snprintf(file, sizeof file, "%s%s%s", beside ? scene->directory : "", beside ? "/" : "",
		         mesh->file);
		mesh->strict |= cli_value(c, "strict") != NULL;
		code = upload_mesh(c, file, mesh);
		if (!code)
			code = report_mesh(c, file, mesh);
	}
	return code;
}

// Discards the uploads, because the session has its own copies. An older server does not know this
// request, but discards the uploads when the connection closes.
static void discard_meshes(cli *c, const cau_scene_def *scene)
{
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (scene->meshes[i].source == CAU_MESH_BYTES)
			cau_client_discard_upload(c->client, scene->meshes[i].name, NULL);
}

static cli_exit read_scene(cli *c, const char *file, cau_scene_def *scene)
{
	char *text;
	size_t bytes;
	if (cli_read_file(file, CAU_SCENE_JSON_MAX_BYTES, &text, &bytes, &c->error))
		return cli_fail_file(c);
	cau_status status = cau_scene_from_json(file, text, bytes, scene, &c->error);
	const char *slash = strrchr(file, '/');
	snprintf(scene->directory, sizeof scene->directory, "%.*s", slash ? (int)(slash - file) : 0,
	         file);
	free(text);
	return status ? cli_fail_file(c) : CLI_DONE;
}

static cli_exit create(cli *c, cau_wire_session_create *params, cau_wire_session_description *d)
{
	params->has_client_sequence = true;
	params->client_sequence = cau_client_next_sequence(c->client);
	return cau_client_call(c->client, CAU_METHOD_SESSION_CREATE, params, d, &c->error) ? cli_fail(c)
	                                                                                   : CLI_DONE;
}

// ---- a scene around a mesh ---------------------------------------------------------------------
static cli_exit make_mesh_scene(cli *c, const char *file, cau_scene_def *scene)
{
	const char *kind = cli_value(c, "as");
	if (kind && strcmp(kind, "fat") != 0 && strcmp(kind, "fascia") != 0) {
		cli_complain(c, "--as needs fat or fascia, not \"%s\"", kind);
		return CLI_USAGE;
	}
	cau_mesh_def mesh = {.name = "mesh", .source = CAU_MESH_FILE};
	if (strlen(file) >= sizeof mesh.file) {
		cli_complain(c, "a file name of more than %zu bytes", sizeof mesh.file - 1);
		return CLI_USAGE;
	}
	cli_exit code = upload_mesh(c, file, &mesh);
	return code ? code : mesh_scene(c, file, mesh.name, scene);
}

// ---- the command -------------------------------------------------------------------------------
static bool ends_with(const char *text, const char *ending)
{
	size_t length = strlen(text), tail = strlen(ending);
	return length > tail && strcmp(text + length - tail, ending) == 0;
}

// Returns the value of the option `kind`. If the option is not given, returns the argument if it is
// a file of that kind, else NULL.
static const char *source_of(const cli *c, const char *kind)
{
	const char *said = cli_value(c, kind);
	if (said || !c->argument_count)
		return said;
	bool fits = strcmp(kind, "mesh") == 0 ? is_mesh_file(c->arguments[0])
	                                      : ends_with(c->arguments[0], ".json");
	return fits ? c->arguments[0] : NULL;
}

static cli_exit fill_params(cli *c, cau_wire_session_create *params, cau_scene_def *scene)
{
	const char *definition = source_of(c, "definition"), *mesh = source_of(c, "mesh");
	const char *name = cli_value(c, "name");
	params->has_name = name;
	snprintf(params->name, sizeof params->name, "%s", name ? name : "");
	params->has_paused = true;
	params->paused = cli_value(c, "paused");
	params->has_scene = !definition && !mesh;
	if (params->has_scene) {
		snprintf(params->scene, sizeof params->scene, "%s", c->arguments[0]);
		return CLI_DONE;
	}
	params->has_definition = true;
	params->definition = scene;
	cli_exit code = definition ? read_scene(c, definition, scene) : CLI_DONE;
	if (!code)
		code = mesh ? make_mesh_scene(c, mesh, scene) : upload_meshes(c, scene);
	return code;
}

static cli_exit run(cli *c)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_create params = {0};
	cau_wire_session_description d = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                  .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	int sources = c->argument_count + !!cli_value(c, "definition") + !!cli_value(c, "mesh");
	if (sources != 1) {
		cli_complain(
			c,
			"give one of SCENE, FILE, --definition and --mesh: the scene or mesh of the session");
		return CLI_USAGE;
	}
	cau_scene_def *scene = calloc(1, sizeof *scene);
	d.definition = calloc(1, sizeof *d.definition);
	cli_exit code = scene && d.definition ? cli_connect(c) : cli_fail_memory(c);
	if (!code)
		code = fill_params(c, &params, scene);
	if (!code) {
		code = create(c, &params, &d);
		if (params.has_definition)
			discard_meshes(c, scene);
	}
	if (!code && c->json)
		cli_print_result(c, CAU_METHOD_SESSION_CREATE, &d);
	else if (!code)
		fprintf(c->out, "%s\n", d.summary.session);
	free(scene);
	free(d.definition);
	return code;
}

const cli_command cli_create = {
	.name = "create",
	.arguments = "SCENE | FILE | --definition FILE | --mesh FILE",
	.summary = "creates a session and prints its id",
	.help =
		"SCENE is one of `cautery scenes`. FILE is a scene (.json) or a mesh: Gmsh, VTK, VTU,\n"
		"OBJ, STL, PLY, Medit, TetGen, USD text, NRRD or NIfTI. The meshes of a scene file are "
		"uploaded. For\n"
		"a mesh alone, its report is printed and a scene is made: its lowest tenth (of an open\n"
		"sheet: its rim) is pinned, the tools are a hot ball and a grasper, without gravity.\n"
		"A closed or nearly closed surface, and a segmentation (NRRD, NIfTI), is filled with\n"
		"tetrahedra.\n",
	.most = 1,
	.options =
		{{"name", "N", "name of the session, without the daemon's label"},
         {"paused", NULL, "the session starts paused"},
         {"definition", "FILE", "use a local scene file (.json)"},
         {"mesh", "FILE", "use a local mesh file"},
         {"as", "KIND",
          "kind of tissue: fat (tetrahedra) or fascia (triangles); default: fat if possible"},
         {"strict", NULL, "refuse a mesh that needs repair"},
         {"unit-m", "U", "metres in one unit of the mesh (0.001 for millimetres)"},
         {"edge-mm", "L", "edge length of the tetrahedra that fill the mesh, mm"},
         {"labels", "A,B", "labels of a segmentation to keep (default: all)"},
         {"pin", "SIDES",
          "pinned sides: bottom, top, left, right, front, back, with commas, or none (default: "
          "bottom)"}},
	.run = run};
