// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes settings files: settings that are accepted can be printed and read again.
#include <stdlib.h>
#include <string.h>

#include "config/config.h"
#include "fuzz/fuzz_target.h"

static void read_again(const cau_config *config)
{
	char *text = NULL;
	size_t bytes = 0;
	cau_config again;
	FILE *stream = open_memstream(&text, &bytes);
	if (!stream)
		return;
	cau_config_print(config, stream);
	fclose(stream);
	cau_config_default(&again);
	if (cau_config_read_text(&again, text, bytes, NULL))
		abort();
	free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	cau_config config;
	cau_error error;
	char *text = malloc(size + 1);
	if (!text)
		return 0;
	memcpy(text, data, size);
	text[size] = 0;
	cau_config_default(&config);
	if (cau_config_read_text(&config, text, size, &error) == CAU_OK)
		read_again(&config);
	free(text);
	return 0;
}
