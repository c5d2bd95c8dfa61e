// SPDX-License-Identifier: GPL-3.0-or-later
// Forged snapshots with a right hash. The input bytes say which numbers of a good snapshot change
// (forgery.h). One in sixteen of the restored snapshots is also stepped, because steps take
// longest.
#include "core/session/forgery.h"
#include "fuzz/fuzz_target.h"

enum { STEPPED = 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static forgery *of[FORGERY_KINDS];
	if (!bytes)
		return -1;
	size_t kind = data[0] / FORGERY_SHOTS % FORGERY_KINDS;
	if (!of[kind])
		of[kind] = forgery_create((int)kind);
	forgery *f = of[kind];
	if (!forgery_restore(f, forgery_make(f, data, bytes)) && data[bytes - 1] % STEPPED == 0)
		forgery_step(f);
	return 0;
}
