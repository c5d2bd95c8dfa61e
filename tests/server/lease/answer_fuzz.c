// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the answers of etcd: all values that are read from them must be within their bounds.
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "lease/etcd.h"
#include "lease/logic.h"

static void check_values(const cau_etcd_value *values)
{
	cau_generation generation;
	for (int i = 0; i < 2; i++) {
		const cau_etcd_value *value = &values[i];
		if (value->is_there ? value->revision <= 0 || value->bytes > sizeof value->text
		                    : value->bytes != 0)
			abort();
		char text[CAU_GENERATION_BYTES];
		if (!cau_generation_read(value->text, value->bytes, &generation))
			continue;
		cau_generation_write(generation, text);
		if (strlen(text) != value->bytes || memcmp(text, value->text, value->bytes) != 0)
			abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static const char *const keys[] = {"cautery/d1/generation", "cautery/d1/holder"};
	bool success = false;
	cau_error error = {0};
	cau_etcd_lease lease;
	cau_etcd_value values[2];
	char *text = malloc(bytes + 1);
	if (!text)
		return 0;
	memcpy(text, data, bytes);
	text[bytes] = 0;
	if (!cau_etcd_read_lease(text, bytes, &lease, &error) && (lease.id <= 0 || lease.ttl_s < 0))
		abort();
	if (!cau_etcd_read_values(text, bytes, keys, values, 2, &error))
		check_values(values);
	if (cau_etcd_read_success(text, bytes, &success, &error) && success)
		abort();
	free(text);
	return 0;
}
