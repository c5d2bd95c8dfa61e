// SPDX-License-Identifier: GPL-3.0-or-later
// The command `create`: creates a session from a scene of the daemon, a local scene file or a mesh.
#include <stdlib.h>
#include <string.h>

#include "cautery/commands.h"
#include "cautery/local_file.h"
#include "cautery/mesh_scene.h"
#include "cautery/progress.h"
#include "cautery/scene_json.h"

// Uploads `file` and changes the mesh to source `bytes`.
static cli_exit upload_mesh(cli *c, const char *file, cau_mesh_def *mesh)
{
	char *bytes = NULL;
	size_t byte_count = 0;
	cau_wire_upload_result result = {0};
	cli_progress progress;
	if (cli_read_mesh_file(file, &bytes, &byte_count, &c->error))
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
			code = cli_mesh_report(c, file, mesh);
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
	return code ? code : cli_mesh_scene(c, file, mesh.name, scene);
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
	bool fits = strcmp(kind, "mesh") == 0 ? cli_is_mesh_file(c->arguments[0])
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
