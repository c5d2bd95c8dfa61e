// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the report of mesh files, or why they are refused, one block for each file. The set of
// small files (file_set.py) is tested with this program.
//
//     mesh_report [--strict] [--unit-m U] FILE ...
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "mesh/mesh.h"

static void report_file(const char *file, double unit_m, int strict)
{
	cau_mesh_def def;
	cau_mesh mesh;
	cau_mesh_report report;
	cau_error error = {0};
	char text[CAU_MESH_TEXT_BYTES];
	cau_default_mesh_def(&def);
	def.source = CAU_MESH_FILE;
	def.unit_m = unit_m;
	def.strict = strict;
	snprintf(def.file, sizeof def.file, "%s", file);
	printf("== %s\n", strrchr(file, '/') ? strrchr(file, '/') + 1 : file);
	if (cau_mesh_make(&def, "", &mesh, &report, &error)) {
		printf("refused: %s%s%s\n", error.path, error.path[0] ? ": " : "", error.reason);
		return;
	}
	cau_mesh_report_text(&report, text);
	fputs(text, stdout);
	cau_mesh_finish(&mesh);
}

int main(int argument_count, char **arguments)
{
	double unit_m = 1;
	int strict = 0;
	for (int i = 1; i < argument_count; i++) {
		if (!strcmp(arguments[i], "--strict"))
			strict = 1;
		else if (!strcmp(arguments[i], "--unit-m") && i + 1 < argument_count)
			unit_m = strtod(arguments[++i], NULL);
		else
			report_file(arguments[i], unit_m, strict);
	}
	return 0;
}
