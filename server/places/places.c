// SPDX-License-Identifier: GPL-3.0-or-later
#include "places/places.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool cau_place_find(const char *name, char *path, size_t bytes)
{
	char program[PATH_MAX];
	struct stat info;
	if (bytes > 0)
		*path = 0;
	// The kernel's name of the program has no links in it. It does not end with a zero.
	ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
	if (length <= 0)
		return false;
	program[length] = 0;
	char *slash = strrchr(program, '/'); // end of the path of bin, before cauteryd
	*slash = 0;
	slash = strrchr(program, '/'); // end of the path before bin
	if (!slash)
		return false;
	*slash = 0;
	int wanted = snprintf(path, bytes, "%s/share/cautery/%s", program, name);
	if (wanted > 0 && (size_t)wanted < bytes && stat(path, &info) == 0 && S_ISDIR(info.st_mode))
		return true;
	if (bytes > 0)
		*path = 0;
	return false;
}
