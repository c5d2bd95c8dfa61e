// SPDX-License-Identifier: Apache-2.0
#include <ctype.h>

#include "cautery/stream.h"
#include "generate/write.h"

void write_idl(FILE *out)
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
