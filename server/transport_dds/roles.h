// SPDX-License-Identifier: GPL-3.0-or-later
// The role that an authenticated identity has.
#pragma once

#include "cautery/message_choices.h"
#include "cautery/status.h"
#include "config/config.h"
#include "dds_identity/identity.h"

enum { CAU_DDS_ROLES_MOST = 256 };

typedef struct cau_dds_roles {
	bool named; // there is a file: who has proved no name has the least role
	cau_role role_else;
	int count;
	struct {
		char subject[CAU_DDS_SUBJECT_BYTES];
		cau_role role;
	} identities[CAU_DDS_ROLES_MOST];
} cau_dds_roles;

// Reads the settings dds_role and dds_roles: `ROLE SUBJECT` a line; lines that begin with `#` are
// comments. A file that others than its owner can write is refused, and so is a subject named
// twice.
cau_status cau_dds_roles_read(cau_dds_roles *roles, const cau_config *config, cau_error *error);

// The role of who has proved this subject name; NULL: of who has proved none.
cau_role cau_dds_roles_find(const cau_dds_roles *roles, const char *subject);
