// SPDX-License-Identifier: Apache-2.0
// generate DIRECTORY: writes all files that are generated from the message tables and the codecs.
#include <stdlib.h>

#include "generate/write.h"

static model messages;

static void typescript(FILE *out)
{
	write_typescript(out, &messages);
}

static void python(FILE *out)
{
	write_python(out, &messages);
}

static void asyncapi(FILE *out)
{
	write_asyncapi(out, &messages);
}

static void markdown(FILE *out)
{
	write_markdown(out, &messages);
}

static int write_file(const char *directory, const char *name, void (*write)(FILE *out))
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", directory, name);
	FILE *out = fopen(path, "wb");
	if (!out) {
		perror(path);
		return EXIT_FAILURE;
	}
	write(out);
	if (fclose(out) != 0) {
		perror(path);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

int main(int argument_count, char **arguments)
{
	if (argument_count != 2) {
		fprintf(stderr, "usage: %s DIRECTORY\n", arguments[0]);
		return EXIT_FAILURE;
	}
	model_make(&messages);
	int failed = write_file(arguments[1], "messages.gen.ts", typescript);
	failed |= write_file(arguments[1], "messages.py", python);
	failed |= write_file(arguments[1], "asyncapi.json", asyncapi);
	failed |= write_file(arguments[1], "messages.md", markdown);
	failed |= write_file(arguments[1], "examples.md", write_examples);
	failed |= write_file(arguments[1], "channels.idl", write_idl);
	return failed;
}
