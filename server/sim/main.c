// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-sim: runs a scene and a script without a server.
#include <stdlib.h>

#include "embed/whole_file.h"
#include "sim/run.h"
#include "sim/scene.h"

enum { SCRIPT_MAX_BYTES = 1 << 28 };

// Gets the script's text: from a file or from the scene's own cut. Otherwise *text is NULL, for no
// commands. The caller frees *text.
static cau_status get_script(const sim_options *options, const cau_scene_def *scene, char **text,
                             size_t *bytes, cau_error *error)
{
	*text = NULL;
	*bytes = 0;
	if (options->script)
		return embed_read_file(options->script, SCRIPT_MAX_BYTES, text, bytes, error);
	if (options->cut || options->print_cut)
		return sim_cut_script(scene, text, bytes, error);
	return CAU_OK;
}

static sim_exit run(const sim_options *options, const cau_scene_def *scene, const char *text,
                    size_t bytes)
{
	sim_result result;
	cau_error error = {0};
	bool in_input = false;
	cau_status status = sim_run(options, scene, options->script ? options->script : "cut",
	                            text ? text : "", bytes, stderr, &result, &in_input, &error);
	if (status)
		sim_report_error(stderr, &error);
	if (options->json)
		sim_report_json(stdout, scene, options, &result, status ? &error : NULL);
	else if (!in_input)
		sim_report_text(stdout, scene, options, &result);
	if (status)
		return in_input ? SIM_BAD_INPUT : SIM_FAILED;
	return result.refusals > 0 ? SIM_REFUSED : SIM_DONE;
}

int main(int argument_count, char **arguments)
{
	sim_options options;
	cau_error error = {0};
	char *text = NULL;
	size_t bytes = 0;
	sim_exit code = SIM_BAD_INPUT;
	if (!sim_options_read(argument_count, arguments, &options, stderr))
		return SIM_BAD_USAGE;
	if (options.version) {
		puts("cautery-sim " CAUTERY_VERSION);
		return SIM_DONE;
	}
	if (options.help) {
		sim_options_help(stdout);
		return SIM_DONE;
	}
	cau_scene_def *scene = malloc(sizeof *scene);
	if (!scene)
		return SIM_FAILED;
	if (sim_scene_load(options.scene, options.scenes, options.unit_m, options.strict, scene,
	                   &error) ||
	    get_script(&options, scene, &text, &bytes, &error)) {
		sim_report_error(stderr, &error);
		if (options.json)
			sim_report_json_error(stdout, &error);
	} else if (options.print_cut) {
		code = fwrite(text, 1, bytes, stdout) == bytes ? SIM_DONE : SIM_FAILED;
	} else {
		code = run(&options, scene, text, bytes);
	}
	free(text);
	free(scene);
	return (int)code;
}
