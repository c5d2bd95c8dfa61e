// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/scene_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/defaults.h"

static char *read_file(const char *path, size_t *bytes)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES);
	assert_non_null(text);
	*bytes = fread(text, 1, CAU_SCENE_JSON_MAX_BYTES, file);
	fclose(file);
	return text;
}

static cau_scene_def *scene_of(const char *text)
{
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	if (cau_scene_from_json("test", text, strlen(text), scene, &error))
		fail_msg("%s: %s: %s", text, error.path, error.reason);
	return scene;
}

// Parses, prints and parses again. The struct has the same bytes, including padding, because both
// parses start from zeroes.
static void check_round_trip(const char *name, const char *text, size_t bytes)
{
	cau_scene_def *first = malloc(sizeof *first), *second = malloc(sizeof *second);
	char *printed = malloc(CAU_SCENE_JSON_MAX_BYTES);
	cau_error error = {0};
	size_t printed_bytes = 0;
	assert_true(first && second && printed);
	if (cau_scene_from_json(name, text, bytes, first, &error) ||
	    cau_scene_to_json(first, printed, CAU_SCENE_JSON_MAX_BYTES, &printed_bytes, &error) ||
	    cau_scene_from_json(name, printed, printed_bytes, second, &error))
		fail_msg("%s: %s: %s", name, error.path, error.reason);
	assert_memory_equal(first, second, sizeof *first);
	free(printed);
	free(second);
	free(first);
}

static void every_scene_file_comes_back(void **state)
{
	(void)state;
	int count = 0;
	DIR *folder = opendir(CAU_TEST_SCENES);
	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder));) {
		const char *ending = strrchr(entry->d_name, '.');
		if (!ending || strcmp(ending, ".json") != 0)
			continue;
		char path[1024];
		size_t bytes;
		snprintf(path, sizeof path, "%s/%s", CAU_TEST_SCENES, entry->d_name);
		char *text = read_file(path, &bytes);
		check_round_trip(entry->d_name, text, bytes);
		cau_scene_def *scene = malloc(sizeof *scene);
		assert_int_equal(cau_scene_from_json(path, text, bytes, scene, NULL), CAU_OK);
		// A scene has the name of its file, a pull and a cut.
		assert_int_equal(strlen(scene->name), (size_t)(ending - entry->d_name));
		assert_memory_equal(scene->name, entry->d_name, strlen(scene->name));
		assert_true(scene->pull.present && scene->cut.present);
		free(scene);
		free(text);
		count++;
	}
	closedir(folder);
	assert_int_equal(count, 14);
}

static const char everything[] =
	"{\"name\":\"all\",\"description\":\"\xc3\xa9\",\"step_s\":0.005,\"damping_per_s\":1,"
	"\"ambient_c\":20,\"tolerance\":0.001,\"iterations\":20,\"solver\":\"diagonal\","
	"\"precision\":\"double\",\"parting\":\"elements\",\"seed\":9007199254740991,\"gravity_m_s2\":["
	"0,1,-2],"
	"\"meshes\":[{\"source\":\"file\",\"name\":\"a\",\"file\":\"a.msh\",\"unit_m\":0.001,"
	"\"translate_m\":[1,2,3]},{\"source\":\"bytes\",\"name\":\"b\",\"file\":\"b.obj\"},"
	"{\"source\":\"sheet\",\"name\":\"c\",\"size_m\":[1,2],\"cells\":[3,4],"
	"\"texture_turn_rad\":0.5},{\"source\":\"pattern\",\"name\":\"d\",\"cells\":[5]}],"
	"\"layers\":[{\"kind\":\"fat\",\"name\":\"f\",\"mesh\":\"a\",\"tissue\":\"liver\","
	"\"perfusion\":0,\"coagulated_tear\":0.3,"
	"\"young_modulus_pa\":1234.5,"
	"\"model\":\"stvk\",\"target\":[1,2,3,0.1,0.2,0.3],\"absorption_per_s\":3,"
	"\"regions\":[{\"region\":3,\"poisson_ratio\":0.25},{\"region\":7,\"ignition_c\":99}]},"
	"{\"kind\":\"membrane\",\"name\":\"m\",\"of\":\"f\",\"thickness_m\":0.0001,"
	"\"regions\":[{\"region\":2,\"shrink\":[0.5,0.25]}]},"
	"{\"kind\":\"links\",\"name\":\"l\",\"of\":\"s\",\"to\":\"m\",\"per_vertex\":2}],"
	"\"pins\":[{\"kind\":\"rim\"},{\"kind\":\"box\",\"layer\":\"f\",\"least_m\":[0,0,0],"
	"\"most_m\":[1,1,1]},{\"kind\":\"sphere\",\"center_m\":[1,2,3],\"radius_m\":0.5},"
	"{\"kind\":\"nearest\",\"center_m\":[1,2,3]}],"
	"\"tools\":[{\"name\":\"t\",\"shape\":\"bipolar\",\"jaw_open_rad\":0.3,"
	"\"position_m\":[0.1,0.2,0.3],\"rotation\":[0.7071,0.7071,0,0]}],"
	"\"pull\":{\"selection\":{\"kind\":\"rim\",\"layer\":\"m\"},\"move_m\":[0,0,1],"
	"\"duration_s\":2},"
	"\"cut\":{\"tool\":\"t\",\"from_m\":[0,0,0],\"to_m\":[1,0,0],\"rotation\":[0,1,0,0],"
	"\"dwell_s\":1,\"speed_m_s\":0.01}}";

static void every_member_comes_back(void **state)
{
	(void)state;
	check_round_trip("everything", everything, sizeof everything - 1);
	cau_scene_def *scene = scene_of(everything);
	assert_int_equal(scene->solver, CAU_SOLVER_DIAGONAL);
	assert_int_equal(scene->precision, CAU_PRECISION_DOUBLE);
	assert_int_equal(scene->parting, CAU_PARTING_ELEMENTS);
	assert_true(scene->seed == 9007199254740991u);
	assert_int_equal(scene->mesh_count, 4);
	assert_string_equal(scene->meshes[0].file, "a.msh");
	assert_true(scene->meshes[2].size_m[1] == 2.0 && scene->meshes[2].size_m[2] == 0.01);
	assert_true(scene->meshes[2].cells[1] == 4 && scene->meshes[2].cells[2] == 1);
	assert_int_equal(scene->tools[0].shape, CAU_TOOL_BIPOLAR);
	assert_true(scene->pull.present && scene->pull.move_m[2] == 1.0);
	assert_true(scene->cut.present && scene->cut.rotation[1] == 1.0);
	assert_int_equal(scene->layers[0].tissue, CAU_LIVING_LIVER);
	assert_true(scene->layers[0].perfusion == 0 && scene->layers[1].perfusion == 1);
	assert_true(scene->layers[0].coagulated_tear == 0.3 && scene->layers[1].coagulated_tear == 1);
	assert_int_equal(scene->layers[1].tissue, CAU_LIVING_CONNECTIVE);
	assert_int_equal(scene->pins[3].kind, CAU_SELECT_NEAREST);
	assert_string_equal(scene->directory, "");
	free(scene);
}

static void regions_inherit_from_their_layer(void **state)
{
	(void)state;
	cau_scene_def *scene = scene_of(everything);
	const cau_layer_def *fat = &scene->layers[0], *membrane = &scene->layers[1];
	assert_int_equal(fat->material_count, 3);
	cau_fat_material wanted = fat->fat[0];
	wanted.region = 3;
	wanted.poisson_ratio = 0.25;
	assert_memory_equal(&fat->fat[1], &wanted, sizeof wanted);
	wanted = fat->fat[0];
	wanted.region = 7;
	wanted.heat.ignition_c = 99.0;
	assert_memory_equal(&fat->fat[2], &wanted, sizeof wanted);
	assert_int_equal(membrane->material_count, 2);
	assert_true(membrane->sheet[1].thickness_m == 0.0001);
	assert_true(membrane->sheet[1].shrink[1] == 0.25 && membrane->sheet[0].shrink[1] == 1.0);
	free(scene);
}

#define CHECK_DEFAULT(field, default_, least, most, unit, meaning)                                 \
	assert_true(at->field == (default_) && (default_) >= (least) && (default_) <= (most));

static void a_bare_scene_has_the_tables_defaults(void **state)
{
	(void)state;
	cau_scene_def *scene =
		scene_of("{\"name\":\"bare\",\"layers\":[{\"kind\":\"fascia\",\"name\":\"a\"},"
	             "{\"kind\":\"membrane\",\"name\":\"b\"},{\"kind\":\"fat\",\"name\":\"c\"},"
	             "{\"kind\":\"links\",\"name\":\"d\"}],"
	             "\"tools\":[{\"name\":\"t\",\"shape\":\"spatula\"}],"
	             "\"meshes\":[{\"source\":\"slab\",\"name\":\"m\"}]}");
	{
		const cau_scene_def *at = scene;
		CAU_TIME_TABLE(CHECK_DEFAULT)
	}
	for (int i = 0; i < 2; i++) {
		const cau_sheet_material *at = &scene->layers[i].sheet[0];
		CAU_SHEET_TABLE(CHECK_DEFAULT)
		assert_true(at->target[0] == 1.0 && at->target[1] == 1.0 && at->target[2] == 0.0);
		assert_true(at->strain_min[0] == -0.1 && at->strain_max[1] == 0.1 && at->shrink[0] == 1.0);
	}
	{
		const cau_fat_material *at = &scene->layers[2].fat[0];
		CAU_FAT_TABLE(CHECK_DEFAULT)
		assert_int_equal(at->model, CAU_MODEL_NEOHOOKEAN);
		assert_true(at->target[2] == 1.0 && at->target[3] == 0.0);
	}
	{
		const cau_link_material *at = &scene->layers[3].link;
		CAU_LINK_TABLE(CHECK_DEFAULT)
	}
	{
		const cau_tool_def *at = &scene->tools[0];
		CAU_TOOL_TABLE(CHECK_DEFAULT)
		assert_int_equal(at->shape, CAU_TOOL_SPATULA);
		assert_true(at->pose.position_m[2] == 0.05 && at->pose.rotation[0] == 1.0);
	}
	assert_true(scene->layers[0].sheet[0].heat.ignition_c == 172.0);
	assert_true(scene->layers[1].sheet[0].heat.ignition_c == 96.4);
	assert_true(scene->layers[2].fat[0].heat.ignition_c == 76.0);
	assert_true(scene->layers[3].link.heat.ignition_c == 172.0);
	assert_true(scene->iterations == 10 && scene->solver == CAU_SOLVER_CHOLESKY &&
	            scene->precision == CAU_PRECISION_SINGLE && scene->gravity_m_s2[2] == -9.81);
	assert_true(scene->meshes[0].unit_m == 1.0 && scene->layers[0].fibre[0] == 1.0);
	assert_false(scene->pull.present || scene->cut.present);
	free(scene);
}

typedef struct refusal {
	const char *text;
	const char *path;
	const char *reason;
} refusal;

#define SCENE(members) "{\"name\":\"x\"," members "}"
#define LAYER(members) SCENE("\"layers\":[{\"kind\":\"fascia\",\"name\":\"a\"},{" members "}]")
#define FAT(members) LAYER("\"kind\":\"fat\",\"name\":\"b\"," members)

static const refusal refused[] = {
	{"[]", "", "an object is needed, not an array of 0"},
	{"{}", "name", "missing: a string is needed"},
	{"{\"name\":\"X\"}", "name",
     "\"X\" is not a name: [a-z][a-z0-9]*([_-][a-z0-9]+)*, at most 48 bytes"},
	{SCENE("\"step_s\":0"), "step_s", "0 is outside 0.001 to 0.0333333333 s"},
	{SCENE("\"step_s\":31536000"), "step_s", "31536000 is outside 0.001 to 0.0333333333 s"},
	{SCENE("\"step_s\":\"1\""), "step_s", "a number is needed, not \"1\""},
	{SCENE("\"step\":1"), "step", "unknown: did you mean \"step_s\"?"},
	{SCENE("\"layer\":[]"), "layer", "unknown: did you mean \"layers\"?"},
	{SCENE("\"iterations\":1.5"), "iterations", "an integer is needed, not 1.5"},
	{SCENE("\"iterations\":0"), "iterations", "0 is outside 1 to 1000"},
	{SCENE("\"seed\":-1"), "seed", "-1 is outside 0 to 9007199254740991"},
	{SCENE("\"solver\":\"choleski\""), "solver",
     "\"choleski\" is none of cholesky, diagonal, newton; did you mean \"cholesky\"?"},
	{SCENE("\"gravity_m_s2\":[0,0]"), "gravity_m_s2", "an array of 3 is needed, not an array of 2"},
	{SCENE("\"gravity_m_s2\":[0,0,null]"), "gravity_m_s2[2]", "a number is needed, not null"},
	{SCENE("\"gravity_m_s2\":[0,-981,0]"), "gravity_m_s2[1]", "-981 is outside -100 to 100 m/s^2"},
	{SCENE("\"layers\":{}"), "layers", "an array of 0 to 12 is needed, not an object"},
	{SCENE("\"layers\":[3]"), "layers[0]", "an object is needed, not 3"},
	{LAYER("\"name\":\"b\""), "layers[1].kind", "missing: a string is needed"},
	{LAYER("\"kind\":\"skin\",\"name\":\"b\""), "layers[1].kind",
     "\"skin\" is none of fascia, membrane, fat, links"},
	{LAYER("\"kind\":\"fat\""), "layers[1].name", "missing: a string is needed"},
	{FAT("\"poisson_ratio\":0.5"), "layers[1].poisson_ratio", "0.5 is outside 0 to 0.45"},
	{FAT("\"young_modulus_pa\":-1"), "layers[1].young_modulus_pa", "-1 is outside 1 to 1e+10 Pa"},
	{FAT("\"young_modulus\":1"), "layers[1].young_modulus",
     "unknown: did you mean \"young_modulus_pa\"?"},
	{FAT("\"thickness_m\":1"), "layers[1].thickness_m", "unknown"},
	{FAT("\"to\":\"a\""), "layers[1].to", "a layer of kind \"fat\" has no such member"},
	{FAT("\"target\":[1,1,0]"), "layers[1].target", "an array of 6 is needed, not an array of 3"},
	{FAT("\"strain_max\":[0,-0.1,0]"), "layers[1].strain_max[1]", "-0.1 is outside 0 to 100"},
	{FAT("\"regions\":[{}]"), "layers[1].regions[0].region", "missing: an integer is needed"},
	{FAT("\"regions\":[{\"region\":1},{\"region\":2,\"density_kg_m3\":0}]"),
     "layers[1].regions[1].density_kg_m3", "0 is outside 1 to 25000 kg/m^3"},
	{FAT("\"regions\":[{\"region\":1,\"name\":\"c\"}]"), "layers[1].regions[0].name", "unknown"},
	{LAYER("\"kind\":\"links\",\"name\":\"b\",\"regions\":[]"), "layers[1].regions", "unknown"},
	{SCENE("\"meshes\":[{\"source\":\"sheet\",\"name\":\"a\",\"file\":\"b\"}]"), "meshes[0].file",
     "a mesh of kind \"sheet\" has no such member"},
	{SCENE("\"meshes\":[{\"source\":\"file\",\"name\":\"a\"}]"), "meshes[0].file",
     "missing: a string is needed"},
	{SCENE("\"meshes\":[{\"source\":\"slab\",\"name\":\"a\",\"cells\":[1,2.5]}]"),
     "meshes[0].cells[1]", "an integer is needed, not 2.5"},
	{SCENE("\"meshes\":[{\"source\":\"slab\",\"name\":\"a\",\"cells\":[]}]"), "meshes[0].cells",
     "an array of 1 to 3 is needed, not an array of 0"},
	{SCENE("\"pins\":[{\"kind\":\"box\",\"least_m\":[0,0,0]}]"), "pins[0].most_m",
     "missing: an array of 3 is needed"},
	{SCENE("\"pins\":[{\"kind\":\"box\",\"radius_m\":1}]"), "pins[0].radius_m",
     "a selection of kind \"box\" has no such member"},
	{SCENE("\"tools\":[{\"name\":\"t\",\"shape\":\"hook\",\"rotation\":[1,1,0,0]}]"),
     "tools[0].rotation", "a quaternion of length 1.41421, not within 0.001 of 1"},
	{SCENE("\"tools\":[{\"name\":\"t\",\"shape\":\"hook\",\"hot_radius_mm\":3}]"),
     "tools[0].hot_radius_mm", "unknown: did you mean \"hot_radius_m\"?"},
	{SCENE("\"pull\":{}"), "pull.selection", "missing: an object is needed"},
	{SCENE("\"pull\":{\"selection\":{\"kind\":\"rim\",\"layer\":3}}"), "pull.selection.layer",
     "a string is needed, not 3"},
	{SCENE("\"cut\":{\"tool\":\"t\",\"from_m\":[0,0,0]}"), "cut.to_m",
     "missing: an array of 3 is needed"},
	{SCENE("\"cut\":null"), "cut", "an object is needed, not null"},
	{SCENE("\"directory\":\"/etc\""), "directory", "unknown"},
};

static void refuses_and_says_where(void **state)
{
	(void)state;
	cau_scene_def *scene = malloc(sizeof *scene);
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
		const refusal *r = &refused[i];
		cau_error error = {0};
		cau_status status = cau_scene_from_json("x.json", r->text, strlen(r->text), scene, &error);
		if (status != CAU_BAD_VALUE || strcmp(error.path, r->path) != 0 ||
		    strcmp(error.reason, r->reason) != 0)
			fail_msg("%s: status %d, %s: %s", r->text, (int)status, error.path, error.reason);
		assert_string_equal(error.file, "x.json");
		assert_int_equal(cau_scene_from_json(NULL, r->text, strlen(r->text), scene, NULL),
		                 CAU_BAD_VALUE);
	}
	free(scene);
}

// Tries a member of a table just inside and just outside its range, by its JSON name.
static void check_row(const char *before, const char *field, double least, double most)
{
	const double values[] = {least, most, least - 1e-6 * (1.0 + most), most * 1.001 + 1.0};
	cau_scene_def *scene = malloc(sizeof *scene);
	for (int i = 0; i < 4; i++) {
		char text[512];
		cau_error error = {0};
		snprintf(text, sizeof text, "{\"name\":\"x\",%s\"%s\":%.17g%s", before, field, values[i],
		         *before ? "}]}" : "}");
		cau_status status = cau_scene_from_json("x", text, strlen(text), scene, &error);
		if (status != (i < 2 ? CAU_OK : CAU_BAD_VALUE))
			fail_msg("%s: %d, %s: %s", text, (int)status, error.path, error.reason);
	}
	free(scene);
}

static void every_scalar_has_its_range(void **state)
{
	(void)state;
	int rows = 0;
#define ROW(field, default_, least, most, unit, meaning)                                           \
	check_row(before, #field, least, most);                                                        \
	rows++;
	const char *before = "";
	CAU_TIME_TABLE(ROW)
	before = "\"layers\":[{\"kind\":\"fascia\",\"name\":\"a\",";
	CAU_SHEET_TABLE(ROW)
	CAU_HEAT_TABLE(ROW)
	before = "\"layers\":[{\"kind\":\"fat\",\"name\":\"a\",";
	CAU_FAT_TABLE(ROW)
	CAU_HEAT_TABLE(ROW)
	before = "\"layers\":[{\"kind\":\"links\",\"name\":\"a\",";
	CAU_LINK_TABLE(ROW)
	CAU_HEAT_TABLE(ROW)
	before = "\"tools\":[{\"name\":\"a\",\"shape\":\"hook\",";
	CAU_TOOL_TABLE(ROW)
#undef ROW
	assert_true(rows > 40);
}

static void syntax_is_the_scans_business(void **state)
{
	(void)state;
	cau_scene_def *scene = malloc(sizeof *scene);
	cau_error error = {0};
	static const char twice[] = "{\"name\":\"a\",\n\"name\":\"b\"}";
	assert_int_equal(cau_scene_from_json("s", twice, strlen(twice), scene, &error), CAU_BAD_SYNTAX);
	assert_string_equal(error.reason, "line 2, column 2 (byte 14): the object has this name twice");
	assert_int_equal(cau_scene_from_json("s", twice, CAU_SCENE_JSON_MAX_BYTES + 1, scene, &error),
	                 CAU_LIMIT);
	free(scene);
}

static void too_many_of_anything_is_refused(void **state)
{
	(void)state;
	char text[4096];
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene);
	size_t used = (size_t)sprintf(text, "{\"name\":\"x\",\"pins\":[");
	for (int i = 0; i <= CAU_MAX_PINS; i++)
		used += (size_t)sprintf(text + used, "%s{\"kind\":\"rim\"}", i ? "," : "");
	used += (size_t)sprintf(text + used, "]}");
	assert_int_equal(cau_scene_from_json("x", text, used, scene, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "pins");
	used = (size_t)sprintf(text, "{\"name\":\"x\",\"layers\":[{\"kind\":\"fat\",\"name\":\"a\","
	                             "\"regions\":[");
	for (int i = 0; i < CAU_MAX_MATERIALS; i++)
		used += (size_t)sprintf(text + used, "%s{\"region\":%d}", i ? "," : "", i + 1);
	used += (size_t)sprintf(text + used, "]}]}");
	assert_int_equal(cau_scene_from_json("x", text, used, scene, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "layers[0].regions");
	free(scene);
}

static void writing_refuses_what_it_cannot_say(void **state)
{
	(void)state;
	char text[64];
	size_t bytes = 0;
	cau_error error = {0};
	cau_scene_def *scene = scene_of(everything);
	assert_int_equal(cau_scene_to_json(scene, text, sizeof text, &bytes, &error), CAU_LIMIT);
	assert_true(bytes > sizeof text);
	for (int kind = 0; kind < 6; kind++) {
		static const char *const reasons[] = {"step_s is ",
		                                      "solver is 77, not one of",
		                                      "99 layers",
		                                      "layers[0] has 0 materials, not 1 to 16",
		                                      "the text of description has no zero byte",
		                                      "seed is 18446744073709551615"};
		cau_scene_def *bad = scene_of(everything);
		if (kind == 0)
			bad->step_s = 0.0 / (bad->damping_per_s - 1.0);
		else if (kind == 1)
			bad->solver = 77;
		else if (kind == 2)
			bad->layer_count = 99;
		else if (kind == 3)
			bad->layers[0].material_count = 0;
		else if (kind == 4)
			memset(bad->description, 'x', sizeof bad->description);
		else
			bad->seed = UINT64_MAX;
		assert_int_equal(cau_scene_to_json(bad, text, sizeof text, NULL, &error), CAU_BAD_VALUE);
		assert_non_null(strstr(error.reason, reasons[kind]));
		free(bad);
	}
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_scene_file_comes_back),
		cmocka_unit_test(every_member_comes_back),
		cmocka_unit_test(regions_inherit_from_their_layer),
		cmocka_unit_test(a_bare_scene_has_the_tables_defaults),
		cmocka_unit_test(refuses_and_says_where),
		cmocka_unit_test(every_scalar_has_its_range),
		cmocka_unit_test(syntax_is_the_scans_business),
		cmocka_unit_test(too_many_of_anything_is_refused),
		cmocka_unit_test(writing_refuses_what_it_cannot_say),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
