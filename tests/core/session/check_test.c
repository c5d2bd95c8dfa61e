// SPDX-License-Identifier: GPL-3.0-or-later
// Any input ends in a clear error with a path, or in a bounded step. It never causes a crash, a
// corrupt session or a hang.
#include "core/session/stage.h"

#include <stdio.h>

#include "session/session_internal.h"

// ---- scenes
static void expect_refused_field(cau_scene_def *scene, double *field, const char *path)
{
	double before = *field;
	for (int k = 0; k < STAGE_ABSURD_COUNT; k++) {
		*field = stage_absurd[k];
		cau_error error = {0};
		cau_status status = cau_scene_check(scene, &error);
		if (status != CAU_BAD_VALUE || !strstr(error.path, path) || !error.reason[0])
			fail_msg("%s = %g gave %s at \"%s\": %s", path, stage_absurd[k],
			         cau_status_name(status), error.path, error.reason);
		stage_refuse(scene, CAU_BAD_VALUE, &error);
	}
	*field = before;
	cau_error error = {0};
	assert_int_equal(cau_scene_check(scene, &error), CAU_OK);
}

static void absurd_numbers_in_scenes(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
#define CHECK(field, default_, least, most, unit, meaning)                                         \
	expect_refused_field(scene, &object->field, #field);
	{
		cau_scene_def *object = scene;
		CAU_TIME_TABLE(CHECK)
	}
	{
		cau_sheet_material *object = &scene->layers[0].sheet[0];
		CAU_SHEET_TABLE(CHECK)
		for (int i = 0; i < 3; i++)
			expect_refused_field(scene, &object->target[i], "layers[0].target");
		for (int i = 0; i < 2; i++) {
			expect_refused_field(scene, &object->strain_max[i], "layers[0].strain_m");
			expect_refused_field(scene, &object->strain_min[i], "layers[0].strain_m");
			expect_refused_field(scene, &object->shrink[i], "layers[0].shrink");
		}
	}
	{
		cau_fat_material *object = &scene->layers[1].fat[0];
		CAU_FAT_TABLE(CHECK)
		for (int i = 0; i < 6; i++)
			expect_refused_field(scene, &object->target[i], "layers[1].target");
		for (int i = 0; i < 3; i++)
			expect_refused_field(scene, &object->shrink[i], "layers[1].shrink");
	}
	{
		cau_link_material *object = &scene->layers[3].link;
		CAU_LINK_TABLE(CHECK)
	}
	{
		cau_heat_material *object = &scene->layers[1].fat[0].heat;
		CAU_HEAT_TABLE(CHECK)
	}
	{
		cau_tool_def *object = &scene->tools[0];
		CAU_TOOL_TABLE(CHECK)
	}
#undef CHECK
	for (int c = 0; c < 3; c++) {
		expect_refused_field(scene, &scene->gravity_m_s2[c], "gravity_m_s2");
		expect_refused_field(scene, &scene->layers[0].fibre[c], "layers[0].fibre");
		expect_refused_field(scene, &scene->pins[0].least_m[c], "pins[0].least_m");
		expect_refused_field(scene, &scene->pins[0].most_m[c], "pins[0].most_m");
		expect_refused_field(scene, &scene->meshes[0].translate_m[c], "meshes[0].translate_m");
		expect_refused_field(scene, &scene->tools[1].pose.position_m[c], "tools[1].position_m");
	}
	for (int c = 0; c < 4; c++)
		expect_refused_field(scene, &scene->tools[1].pose.rotation[c], "tools[1].rotation");
	free(scene);
}

static void absurd_generated_meshes(void **state)
{
	(void)state;
	cau_error error;
	for (int k = 0; k < STAGE_ABSURD_COUNT; k++)
		for (int c = 0; c < 3; c++) {
			cau_scene_def *scene = stage_layered();
			scene->meshes[1].size_m[c] = stage_absurd[k];
			cau_session_def def = cau_default_session_def();
			def.scene = scene;
			cau_session *session = NULL;
			error = (cau_error){0};
			assert_int_not_equal(cau_session_create(&def, &session, &error), CAU_OK);
			if (!strstr(error.path, "meshes[1]") || !error.reason[0])
				fail_msg("size %g: path \"%s\", reason \"%s\"", stage_absurd[k], error.path,
				         error.reason);
			free(scene);
		}
	const int32_t cells[] = {0, -1, INT32_MAX, INT32_MIN, 1000000};
	for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
		cau_scene_def *scene = stage_layered();
		scene->meshes[1].cells[1] = cells[k];
		cau_session_def def = cau_default_session_def();
		def.scene = scene;
		cau_session *session = NULL;
		error = (cau_error){0};
		// The check counts the vertices and elements of the cells before they are meshed.
		cau_error checked = {0};
		assert_int_not_equal(cau_scene_check(scene, &checked), CAU_OK);
		assert_string_equal(checked.path, "meshes[1].cells");
		assert_int_not_equal(cau_session_create(&def, &session, &error), CAU_OK);
		if (!strstr(error.path, "meshes[1]") || !error.reason[0])
			fail_msg("%d cells: path \"%s\", reason \"%s\"", cells[k], error.path, error.reason);
		free(scene);
	}
}

// Each count of cells is allowed for one axis. Their product does not fit into 64 bits.
static void more_cells_than_can_be_counted(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	for (int c = 0; c < 3; c++)
		scene->meshes[1].cells[c] = INT32_MAX;
	cau_error error;
	stage_refuse(scene, CAU_LIMIT, &error);
	assert_string_equal(error.path, "meshes[1].cells");
	free(scene);
}

static void time_steps_of_zero_and_of_a_year(void **state)
{
	(void)state;
	const double steps[] = {0, -1.0 / 60, 365.25 * 86400, 1e-9};
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		cau_scene_def *scene = stage_layered();
		cau_error error;
		scene->step_s = steps[k];
		stage_refuse(scene, CAU_BAD_VALUE, &error);
		assert_string_equal(error.path, "step_s");
		free(scene);
	}
}

static void materials_outside_their_theory(void **state)
{
	(void)state;
	cau_error error;
	cau_scene_def *scene = stage_layered();
	scene->layers[1].fat[0].poisson_ratio = 0.4501;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_string_equal(error.path, "layers[1].poisson_ratio");
	scene->layers[1].fat[0].poisson_ratio = 0.34;
	scene->layers[1].fat[0].model = CAU_MODEL_ENERGY;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_string_equal(error.path, "layers[1].poisson_ratio");
	scene->layers[1].fat[0].poisson_ratio = 0.3;
	const double indefinite[6] = {1, 1, 1, 1.01, 0, 0}; // the least eigenvalue is -0.01
	memcpy(scene->layers[1].fat[0].target, indefinite, sizeof indefinite);
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_string_equal(error.path, "layers[1].target");
	scene->layers[1].fat[0].target[3] = 0;
	scene->layers[0].sheet[0].target[2] = -1.01;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_string_equal(error.path, "layers[0].target");
	free(scene);
}

static void names_and_references(void **state)
{
	(void)state;
	cau_error error;
	cau_scene_def *scene = stage_layered();
	strcpy(scene->layers[2].of, "nothing");
	stage_refuse(scene, CAU_NOT_FOUND, &error);
	assert_string_equal(error.path, "layers[2].of");
	strcpy(scene->layers[2].of, "fascia"); // the layer is not fat
	stage_refuse(scene, CAU_NOT_FOUND, &error);
	strcpy(scene->layers[2].of, "fat");
	strcpy(scene->layers[3].to, "links");
	stage_refuse(scene, CAU_NOT_FOUND, &error);
	strcpy(scene->layers[3].to, "membrane");
	strcpy(scene->tools[1].name, "hook");
	stage_refuse(scene, CAU_ALREADY_EXISTS, &error);
	strcpy(scene->tools[1].name, "jaws");
	strcpy(scene->pins[0].layer, "nothing");
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_true(strstr(error.path, "pins[0]") != NULL);
	scene->pins[0].layer[0] = 0;
	scene->layer_count = CAU_MAX_LAYERS + 1;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	scene->layer_count = -1;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	free(scene);
}

static void a_pin_that_holds_nothing(void **state)
{
	(void)state;
	const double least[3] = {5, 5, 5}, most[3] = {6, 6, 6};
	cau_scene_def *scene = stage_layered();
	cau_error error;
	stage_pin_box(scene, least, most);
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_true(strstr(error.path, "pins[1]") != NULL);
	free(scene);
}

static void everything_pinned_and_let_go(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	scene->pins[0] = stage_everything();
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 5);
	cau_command unpin;
	cau_default_command(&unpin, CAU_COMMAND_UNPIN);
	unpin.as.selection = stage_everything();
	stage_submit(session, &unpin);
	stage_step(session, 60);
	cau_session_info info = stage_info(session);
	cau_frame frame = stage_frame(session);
	double dt = info.step_s, way = 9.81 * dt * dt * 60 * 61 / 2; // the body falls freely
	double fallen = stage_farthest(&frame, info.rest_position, info.vertex_count);
	if (!(fabs(fallen - way) <= 1e-3 * way)) // tolerance for single precision and swinging links
		fail_msg("fell %g m instead of %g", fallen, way);
	cau_session_destroy(session);
	free(scene);
}

// ---- meshes
static void open_mesh(const char *name, const char *text, int kind, cau_status expected,
                      cau_error *error)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_layer_def *layer = stage_add_sheet(scene, "body", 1, 1, 1, 1);
	cau_mesh_def *mesh = stage_mesh_of(scene, layer);
	cau_default_layer_def(layer, kind);
	strcpy(layer->name, "body");
	strcpy(layer->mesh, mesh->name);
	mesh->source = CAU_MESH_BYTES;
	strcpy(mesh->file, name);
	mesh->bytes = text;
	mesh->byte_count = strlen(text);
	if (expected) {
		stage_refuse(scene, expected, error);
	} else {
		cau_session *session = stage_open(scene, 1);
		stage_step(session, 20);
		assert_int_equal(stage_frame(session).statistics.inverted, 0);
		cau_session_destroy(session);
	}
	free(scene);
}

static void bad_meshes(void **state)
{
	(void)state;
	static const char head[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n"
							   "3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n";
	char text[512];
	cau_error error;
	// This tetrahedron is inverted; cleaning turns it.
	snprintf(text, sizeof text, "%s1 4 0 1 3 2 4\n$EndElements\n", head);
	open_mesh("t.msh", text, CAU_LAYER_FAT, CAU_OK, &error);
	snprintf(text, sizeof text, "%s1 4 0 1 2 3 3\n$EndElements\n", head);
	open_mesh("t.msh", text, CAU_LAYER_FAT, CAU_BAD_MESH, &error);
	assert_true(strstr(error.reason, "0") != NULL); // the error names the element
	snprintf(text, sizeof text, "%s1 4 0 1 2 3 9\n$EndElements\n", head);
	open_mesh("t.msh", text, CAU_LAYER_FAT, CAU_BAD_MESH, &error);
	// A triangle without area, a fat without tetrahedra, a word in place of a number, and files
	// without a mesh are refused.
	open_mesh("t.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", CAU_LAYER_FASCIA, CAU_BAD_MESH,
	          &error);
	open_mesh("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", CAU_LAYER_FAT, CAU_BAD_MESH, &error);
	open_mesh("t.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", CAU_LAYER_FASCIA, CAU_BAD_MESH,
	          &error);
	open_mesh("t.stl", "solid", CAU_LAYER_FASCIA, CAU_BAD_SYNTAX, &error);
	open_mesh("t.txt", "a letter", CAU_LAYER_FASCIA, CAU_UNSUPPORTED, &error);
	open_mesh("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", CAU_LAYER_FASCIA, CAU_OK, &error);
}

// A texture without area gives no material direction, but is accepted.
static void degenerate_texture(void **state)
{
	(void)state;
	cau_error error;
	open_mesh("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvt 2 2\nf 1/1 2/2 3/3\n",
	          CAU_LAYER_FASCIA, CAU_OK, &error);
}

// A region that the layer's mesh lacks is refused, in a definition and in a command. The error
// lists the existing regions. Region 0 means the default.
static void regions_that_no_mesh_has(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_session *session = NULL;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	const double size_m[3] = {0.04, 0.03, 0.01};
	stage_add_slab(scene, "fat", size_m, (int32_t[3]){2, 2, 1});
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	int32_t layer = 0;
	while (scene->layers[layer].kind != CAU_LAYER_FAT)
		layer++;
	scene->layers[layer].material_count = 2;
	scene->layers[layer].fat[1] = scene->layers[layer].fat[0];
	scene->layers[layer].fat[1].region = 99;
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_NOT_FOUND);
	assert_non_null(strstr(error.path, ".regions[0].region"));
	assert_non_null(strstr(error.reason, "no region 99; its regions are: 0"));

	scene->layers[layer].material_count = 1;
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_OK);
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_SET_MATERIAL);
	command.as.material.kind = CAU_LAYER_FAT;
	memcpy(command.as.material.layer, scene->layers[layer].name, CAU_NAME_BYTES);
	command.as.material.fat = scene->layers[layer].fat[0];
	assert_int_equal(cau_session_submit(session, &command, &error), CAU_OK);
	command.as.material.fat.region = 99;
	assert_int_equal(cau_session_submit(session, &command, &error), CAU_NOT_FOUND);
	assert_string_equal(error.path, "material.region");
	assert_non_null(strstr(error.reason, "no region 99; its regions are: 0"));
	cau_session_destroy(session);
	free(scene);
}

// Links between sheets that lie on each other have no length.
static void links_without_length(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	scene->meshes[0].translate_m[2] = 0;
	scene->meshes[0].cells[0] = 6;
	scene->meshes[0].cells[1] = 5; // the same cells as the slab's, so vertices coincide
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	assert_true(info.link_count >= 7 * 6); // each vertex is linked to the vertex at its position
	stage_step(session, 120);
	cau_frame frame = stage_frame(session);
	// The fascia sinks with the slab below it, by its own weight on 5 kPa.
	double sunk = stage_farthest(&frame, info.rest_position, info.vertex_count);
	if (!(sunk < 1e-3))
		fail_msg("sank by %g m", sunk);
	cau_session_destroy(session);
	free(scene);
}

// Ten layers of links between two sheets, each with eight links at a vertex and a reach over the
// whole sheet. The search and the step stay bounded, and pulled links hold the sheets together.
static void a_million_links(void **state)
{
	(void)state;
	enum { CELLS = 113, TIES = 10 };
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	cau_layer_def *upper = stage_add_sheet(scene, "upper", 0.1, 0.1, CELLS, CELLS);
	stage_mesh_of(scene, upper)->translate_m[2] = 0.001;
	stage_add_sheet(scene, "lower", 0.1, 0.1, CELLS, CELLS);
	for (int k = 0; k < TIES; k++) {
		char name[16];
		snprintf(name, sizeof name, "ties-%d", k);
		cau_link_material *link = &stage_add_links(scene, name, "upper", "lower")->link;
		link->per_vertex = 8;
		link->reach_m = 0.1;
	}
	const double least[3] = {-1, -1, 0.0009}, most[3] = {1, 1, 0.0011};
	stage_pin_box(scene, least, most);
	cau_session *session = stage_open(scene, 2);
	cau_session_info info = stage_info(session);
	assert_true(info.link_count >= 1000000);
	stage_step(session, 3);
	cau_frame frame = stage_frame(session);
	assert_true(stage_farthest(&frame, info.rest_position, info.vertex_count) < 0.0005);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(absurd_numbers_in_scenes),
		cmocka_unit_test(absurd_generated_meshes),
		cmocka_unit_test(more_cells_than_can_be_counted),
		cmocka_unit_test(time_steps_of_zero_and_of_a_year),
		cmocka_unit_test(materials_outside_their_theory),
		cmocka_unit_test(names_and_references),
		cmocka_unit_test(a_pin_that_holds_nothing),
		cmocka_unit_test(everything_pinned_and_let_go),
		cmocka_unit_test(bad_meshes),
		cmocka_unit_test(degenerate_texture),
		cmocka_unit_test(regions_that_no_mesh_has),
		cmocka_unit_test(links_without_length),
		cmocka_unit_test(a_million_links),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
