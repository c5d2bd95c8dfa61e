// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target: reads a recording and its descriptions to the end or to the first error.
#include "fuzz/fuzz_target.h"

#include <stdlib.h>

#include "cautery/recording.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	cli_recording recording;
	cau_error error = {0};
	uint32_t kind = 1, bytes = 0;
	cau_wire_stream_description description;
	FILE *file = size ? fmemopen((void *)(uintptr_t)data, size, "rb") : NULL;
	if (!file)
		return 0;
	cau_status status = cli_recording_read(&recording, file, &error);
	while (!status && kind) {
		status = cli_recording_next(&recording, &kind, &bytes, &error);
		if (!status && kind && bytes > size)
			abort(); // a record cannot be longer than the input
		if (!status && kind == CLI_RECORD_DESCRIPTION)
			status = cli_recording_read_description(&recording, bytes, &description, &error);
	}
	cli_recording_close(&recording, NULL);
	return 0;
}
