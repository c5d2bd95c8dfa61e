// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the results of an exposure as one line of CSV (measured.h has the names of all numbers):
//
//     paper_measured_probe jaws TISSUE NAME=NUMBER...    a cross-section of jaws
//     paper_measured_probe cut TISSUE NAME=NUMBER...     an electrode drawn through a sheet
//     paper_measured_probe needle TISSUE NAME=NUMBER...  a cooled needle in an organ
//     paper_measured_probe seal RADIUS_MM WALL_MM FUSION the pressure that a seal bears, Pa
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bioheat/bioheat.h"
#include "measured.h"
#include "vessel/vessels.h"

static _Noreturn void usage(const char *why, const char *what)
{
	fprintf(stderr,
	        "%s%s\nusage: paper_measured_probe jaws|cut|needle TISSUE NAME=NUMBER... | seal "
	        "RADIUS_MM WALL_MM FUSION\n",
	        why, what);
	exit(2);
}

static cau_bioheat_material tissue_named(const char *name)
{
	static const char *const names[CAU_LIVING_COUNT] = {
#define X(code, text) [CAU_LIVING_##code] = text,
		CAU_LIVING_TABLE(X)
#undef X
	};
	for (int i = 0; i < CAU_LIVING_COUNT; i++)
		if (!strcmp(names[i], name))
			return cau_living_tissue(i);
	usage("no such tissue: ", name);
}

// Fills `number` from the arguments NAME=NUMBER. Each name must occur once.
static void read_numbers(int count, char **text, const char *const *name, int names, double *number)
{
	for (int k = 0; k < names; k++)
		number[k] = NAN;
	for (int i = 0; i < count; i++) {
		char *equals = strchr(text[i], '='), *end = NULL;
		int k = 0;
		while (equals && k < names &&
		       (strlen(name[k]) != (size_t)(equals - text[i]) ||
		        strncmp(name[k], text[i], strlen(name[k])) != 0))
			k++;
		if (!equals || k == names || !isnan(number[k]))
			usage("unknown or given twice: ", text[i]);
		number[k] = strtod(equals + 1, &end);
		if (end == equals + 1 || *end || !isfinite(number[k]))
			usage("not a number: ", text[i]);
	}
	for (int k = 0; k < names; k++)
		if (isnan(number[k]))
			usage("missing: ", name[k]);
}

static void print_numbers(const char *const *name, int names, const double *number)
{
	for (int k = 0; k < names; k++)
		printf("%s%s", k ? "," : "", name[k]);
	printf("\n");
	for (int k = 0; k < names; k++)
		printf("%s%.9g", k ? "," : "", number[k]);
	printf("\n");
}

#define NAME(name) #name,
// All members are doubles in the order of the table, so a union gives access by index.
#define RUN(kind, TABLE, RESULTS)                                                                  \
	static void run_##kind(int count, char **text, cau_bioheat_material tissue)                    \
	{                                                                                              \
		static const char *const in[] = {TABLE(NAME)}, *const out[] = {RESULTS(NAME)};             \
		union {                                                                                    \
			kind##_def def;                                                                        \
			double number[sizeof in / sizeof *in];                                                 \
		} given;                                                                                   \
		union {                                                                                    \
			kind##_found found;                                                                    \
			double number[sizeof out / sizeof *out];                                               \
		} result;                                                                                  \
		read_numbers(count, text, in, (int)(sizeof in / sizeof *in), given.number);                \
		result.found = kind##_run(&given.def, tissue);                                             \
		print_numbers(out, (int)(sizeof out / sizeof *out), result.number);                        \
	}

RUN(section, SECTION_TABLE, SECTION_RESULTS)
RUN(cut, CUT_TABLE, CUT_RESULTS)
RUN(needle, NEEDLE_TABLE, NEEDLE_RESULTS)

static void print_seal(char **text)
{
	cau_vessel_def def = {.radius_m = 1e-3 * strtod(text[0], NULL),
	                      .wall_m = 1e-3 * strtod(text[1], NULL)};
	printf("pressure_pa\n%.9g\n", cau_seal_strength(&def, strtod(text[2], NULL)));
}

int main(int argc, char **argv)
{
	if (argc == 5 && !strcmp(argv[1], "seal"))
		print_seal(argv + 2);
	else if (argc >= 3 && !strcmp(argv[1], "jaws"))
		run_section(argc - 3, argv + 3, tissue_named(argv[2]));
	else if (argc >= 3 && !strcmp(argv[1], "cut"))
		run_cut(argc - 3, argv + 3, tissue_named(argv[2]));
	else if (argc >= 3 && !strcmp(argv[1], "needle"))
		run_needle(argc - 3, argv + 3, tissue_named(argv[2]));
	else
		usage("what?", "");
	return 0;
}
