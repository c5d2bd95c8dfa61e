// SPDX-License-Identifier: Apache-2.0
// generate DIRECTORY: writes all files that are generated from the message tables and the codecs.
#include <ctype.h>
#include <stdlib.h>

#include "cautery/stream.h"
#include "generate/model.h"

// ---- channels.idl
static void write_idl(FILE *out)
{
	fputs("// SPDX-License-Identifier: Apache-2.0\n"
	      "// Generated from core/types/cautery/channels.h; do not edit. After a change there, "
	      "build\n"
	      "// the target `messages`. Constants, and no types: what a frame's `stream.channels` "
	      "means.\n"
	      "module cautery {\n\n",
	      out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		fprintf(out, "  // %s\n  const unsigned long CHANNEL_", info->meaning);
		for (const char *c = info->name; *c; c++)
			fputc(toupper((unsigned char)*c), out);
		fprintf(out, " = %u;\n", 1u << i);
	}
	fputs("};\n", out);
}

// ---- all files
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
