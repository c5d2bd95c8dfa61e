// SPDX-License-Identifier: GPL-3.0-or-later
// Finds whether this system supports images (core/base/image.c): files in memory that can be
// sealed. If it does, a session without shared pages is a failure, and the test must not be
// skipped.
#pragma once

#include <fcntl.h>
#include <stdbool.h>
#include <sys/mman.h>
#include <unistd.h>

static inline bool images_here(void)
{
	int file = memfd_create("cautery-test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	bool sealed = file >= 0 && fcntl(file, F_ADD_SEALS, F_SEAL_WRITE) == 0;
	if (file >= 0)
		close(file);
	return sealed;
}
