// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "auth/auth.h"
#include "config/role.h"

enum { MAX_TOKENS = 256, TOKEN_BYTES = 129, LEAST_TOKEN_BYTES = 16 };

typedef struct token {
	char text[TOKEN_BYTES];
	size_t bytes;
	cau_role role;
} token;

struct cau_auth {
	bool required;
	int count;
	token tokens[MAX_TOKENS];
};

static cau_status read_line(cau_auth *auth, char *line, int number, cau_error *error)
{
	char word[16], text[TOKEN_BYTES + 1], more[2];
	cau_role role;
	line[strcspn(line, "#\r\n")] = 0;
	int fields = sscanf(line, "%15s %129s %1s", word, text, more);
	if (fields <= 0)
		return CAU_OK;
	if (fields != 2)
		return cau_fail(error, CAU_BAD_SYNTAX, "tokens", "line %d is not `ROLE TOKEN`", number);
	size_t bytes = strlen(text);
	if (!cau_role_read(word, &role))
		return cau_fail(error, CAU_BAD_VALUE, "tokens", "line %d: roles are view, operate, admin",
		                number);
	if (bytes < LEAST_TOKEN_BYTES || bytes >= TOKEN_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, "tokens", "line %d: a token has %d to %d characters",
		                number, LEAST_TOKEN_BYTES, TOKEN_BYTES - 1);
	if (auth->count == MAX_TOKENS)
		return cau_fail(error, CAU_LIMIT, "tokens", "more than %d tokens", MAX_TOKENS);
	token *made = &auth->tokens[auth->count++];
	memcpy(made->text, text, bytes + 1);
	made->bytes = bytes;
	made->role = role;
	return CAU_OK;
}

static cau_status read_tokens(cau_auth *auth, const char *file, cau_error *error)
{
	struct stat info;
	FILE *stream = fopen(file, "r");
	if (!stream || fstat(fileno(stream), &info)) {
		if (stream)
			fclose(stream);
		return cau_fail(error, CAU_IO, "tokens", "cannot open %.200s", file);
	}
	cau_status status = CAU_OK;
	if (info.st_mode & (S_IRWXG | S_IRWXO))
		status =
			cau_fail(error, CAU_BAD_VALUE, "tokens", "%.200s is open to others: chmod 600", file);
	char line[512];
	for (int number = 1; !status && fgets(line, sizeof line, stream); number++)
		status = read_line(auth, line, number, error);
	fclose(stream);
	if (!status && auth->count == 0)
		status = cau_fail(error, CAU_BAD_VALUE, "tokens", "%.200s has no token", file);
	return status;
}

cau_status cau_auth_create(cau_auth **made, const cau_config *config, cau_error *error)
{
	*made = NULL;
	cau_auth *auth = calloc(1, sizeof *auth);
	if (!auth)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tokens");
	auth->required = *config->tokens != 0;
	cau_status status = auth->required ? read_tokens(auth, config->tokens, error) : CAU_OK;
	if (status)
		cau_auth_destroy(auth);
	else
		*made = auth;
	return status;
}

void cau_auth_destroy(cau_auth *auth)
{
	if (auth)
		explicit_bzero(auth, sizeof *auth);
	free(auth);
}

static bool same_bytes(const char *a, const char *b, size_t bytes)
{
	unsigned char difference = 0;
	for (size_t i = 0; i < bytes; i++)
		difference |= (unsigned char)(a[i] ^ b[i]);
	return difference == 0;
}

bool cau_auth_role(const cau_auth *auth, const char *text, size_t bytes, cau_role *role)
{
	bool found = !auth->required;
	*role = CAU_ROLE_ADMIN;
	for (int i = 0; i < auth->count; i++)
		if (auth->tokens[i].bytes == bytes && same_bytes(auth->tokens[i].text, text, bytes)) {
			*role = auth->tokens[i].role;
			found = true;
		}
	return found;
}

bool cau_auth_required(const cau_auth *auth)
{
	return auth->required;
}
