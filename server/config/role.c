// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/role.h"

#include <string.h>

static const char *const words[CAU_ROLE_COUNT] = {
#define X(code, name) [CAU_ROLE_##code] = (name),
	CAU_ROLE_TABLE(X)
#undef X
};

const char *cau_role_word(cau_role role)
{
	return words[role];
}

bool cau_role_read(const char *word, cau_role *role)
{
	for (int i = 0; i < CAU_ROLE_COUNT; i++)
		if (strcmp(word, words[i]) == 0) {
			*role = (cau_role)i;
			return true;
		}
	return false;
}
