// SPDX-License-Identifier: GPL-3.0-or-later
// The roles of authenticated identities.
#include "transport_dds/roles.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "config/config.h"

enum { LINE_BYTES = 512 };

static const char spaces[] = " \t\r\n";

static cau_status add(cau_dds_roles *roles, cau_role role, const char *subject, int number,
                      cau_error *error)
{
	for (int i = 0; i < roles->count; i++)
		if (strcmp(roles->identities[i].subject, subject) == 0)
			return cau_fail(error, CAU_BAD_VALUE, "dds_roles", "line %d: %.100s has a role already",
			                number, subject);
	if (roles->count == CAU_DDS_ROLES_MOST)
		return cau_fail(error, CAU_LIMIT, "dds_roles", "more than %d identities",
		                CAU_DDS_ROLES_MOST);
	roles->identities[roles->count].role = role;
	snprintf(roles->identities[roles->count++].subject, CAU_DDS_SUBJECT_BYTES, "%s", subject);
	return CAU_OK;
}

// Reads one line: a role and a subject. A subject may contain spaces.
static cau_status read_line(cau_dds_roles *roles, char *line, int number, cau_error *error)
{
	cau_role role;
	char *word = line + strspn(line, spaces);
	if (!*word || *word == '#')
		return CAU_OK;
	size_t word_bytes = strcspn(word, spaces);
	char *subject = word + word_bytes + strspn(word + word_bytes, spaces);
	size_t bytes = strlen(subject);
	word[word_bytes] = 0;
	while (bytes > 0 && strchr(spaces, subject[bytes - 1]))
		subject[--bytes] = 0;
	if (!cau_role_read(word, &role))
		return cau_fail(error, CAU_BAD_VALUE, "dds_roles",
		                "line %d: roles are view, operate, admin", number);
	if (!strchr(subject, '=') || bytes >= CAU_DDS_SUBJECT_BYTES)
		return cau_fail(error, CAU_BAD_SYNTAX, "dds_roles",
		                "line %d must be `ROLE SUBJECT`, as in `operate CN=knee-robot,O=Cautery`",
		                number);
	return add(roles, role, subject, number, error);
}

static cau_status read_file(cau_dds_roles *roles, const char *file, cau_error *error)
{
	struct stat info;
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(file, CAU_NAMED_FILE_BYTES, &info, reason);
	if (!stream)
		return cau_fail(error, CAU_IO, "dds_roles", "cannot open %.200s: %s", file, reason);
	cau_status status = CAU_OK;
	if (info.st_mode & (S_IWGRP | S_IWOTH))
		status = cau_fail(error, CAU_BAD_VALUE, "dds_roles",
		                  "%.200s can be written by other users: chmod go-w", file);
	char line[LINE_BYTES];
	for (int number = 1; !status && fgets(line, sizeof line, stream); number++)
		status = strlen(line) + 1 < sizeof line
		             ? read_line(roles, line, number, error)
		             : cau_fail(error, CAU_LIMIT, "dds_roles",
		                        "line %d is longer than %zu bytes with its line end", number,
		                        sizeof line - 2);
	fclose(stream);
	return status;
}

cau_status cau_dds_roles_read(cau_dds_roles *roles, const cau_config *config, cau_error *error)
{
	*roles = (cau_dds_roles){.named = *config->dds_roles != 0};
	if (!cau_role_read(config->dds_role, &roles->role_else))
		return cau_fail(error, CAU_BAD_VALUE, "dds_role",
		                "is not a role: use view, operate or admin");
	return roles->named ? read_file(roles, config->dds_roles, error) : CAU_OK;
}

cau_role cau_dds_roles_find(const cau_dds_roles *roles, const char *subject)
{
	if (!roles->named)
		return roles->role_else;
	for (int i = 0; subject && i < roles->count; i++)
		if (strcmp(roles->identities[i].subject, subject) == 0)
			return roles->identities[i].role;
	return subject ? roles->role_else : (cau_role)0;
}
