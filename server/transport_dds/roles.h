// SPDX-License-Identifier: GPL-3.0-or-later
// The roles of authenticated identities.
#pragma once

#include "cautery/message_choices.h"
#include "cautery/status.h"
#include "config/config.h"
#include "dds_identity/identity.h"

enum { CAU_DDS_ROLES_MOST = 256 };

typedef struct cau_dds_roles {
	bool named; // there is a file, so a participant without a proved name has the least role
	cau_role role_else;
	int count;
	struct {
		char subject[CAU_DDS_SUBJECT_BYTES];
		cau_role role;
	} identities[CAU_DDS_ROLES_MOST];
} cau_dds_roles;

// Reads the settings dds_role and dds_roles. The file has one `ROLE SUBJECT` for each line; lines
// that begin with `#` are comments. A file that users other than its owner can write is refused. A
// file that names a subject twice is refused too.
cau_status cau_dds_roles_read(cau_dds_roles *roles, const cau_config *config, cau_error *error);

// Returns the role of a participant that has proved this subject name. `subject` is NULL for a
// participant without a proved name.
cau_role cau_dds_roles_find(const cau_dds_roles *roles, const char *subject);
