// SPDX-License-Identifier: GPL-3.0-or-later
// Tokens are read at the start and when the daemon is told to read them anew, by the main thread,
// while the network thread asks: a lock held for moments stands between the two.
#include <pthread.h>
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
	uint64_t grant; // stays as long as the token is in the file
} token;

typedef struct token_list {
	int count;
	token tokens[MAX_TOKENS];
} token_list;

struct cau_auth {
	bool required;
	pthread_mutex_t mutex; // guards what follows
	uint64_t last_grant;
	token_list list;
};

// Without tokens everybody has this one.
enum { GRANT_OF_ALL = 1 };

static cau_status read_line(token_list *list, char *line, int number, cau_error *error)
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
	if (list->count == MAX_TOKENS)
		return cau_fail(error, CAU_LIMIT, "tokens", "more than %d tokens", MAX_TOKENS);
	token *made = &list->tokens[list->count++];
	memcpy(made->text, text, bytes + 1);
	made->bytes = bytes;
	made->role = role;
	return CAU_OK;
}

static cau_status read_tokens(token_list *list, const char *file, cau_error *error)
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
		status = strlen(line) + 1 < sizeof line
		             ? read_line(list, line, number, error)
		             : cau_fail(error, CAU_LIMIT, "tokens", "line %d is too long", number);
	fclose(stream);
	explicit_bzero(line, sizeof line);
	if (!status && list->count == 0)
		status = cau_fail(error, CAU_BAD_VALUE, "tokens", "%.200s has no token", file);
	if (status && error)
		snprintf(error->file, sizeof error->file, "%s", file);
	return status;
}

static bool same_bytes(const char *a, const char *b, size_t bytes)
{
	unsigned char difference = 0;
	for (size_t i = 0; i < bytes; i++)
		difference |= (unsigned char)(a[i] ^ b[i]);
	return difference == 0;
}

static const token *find_token(const token_list *list, const char *text, size_t bytes)
{
	const token *found = NULL;
	for (int i = 0; i < list->count; i++)
		if (list->tokens[i].bytes == bytes && same_bytes(list->tokens[i].text, text, bytes))
			found = &list->tokens[i];
	return found;
}

// Puts a list that has been read in the place of the one before. A token that was in both keeps its
// grant.
static void take_list(cau_auth *auth, token_list *read)
{
	pthread_mutex_lock(&auth->mutex);
	for (int i = 0; i < read->count; i++) {
		token *now = &read->tokens[i];
		const token *before = find_token(&auth->list, now->text, now->bytes);
		now->grant = before ? before->grant : ++auth->last_grant;
	}
	auth->list = *read;
	pthread_mutex_unlock(&auth->mutex);
}

cau_status cau_auth_reload(cau_auth *auth, const cau_config *config, cau_error *error)
{
	if (!auth->required)
		return CAU_OK;
	token_list *read = calloc(1, sizeof *read);
	if (!read)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tokens");
	cau_status status = read_tokens(read, config->tokens, error);
	if (!status)
		take_list(auth, read);
	explicit_bzero(read, sizeof *read);
	free(read);
	return status;
}

cau_status cau_auth_create(cau_auth **made, const cau_config *config, cau_error *error)
{
	*made = NULL;
	cau_auth *auth = calloc(1, sizeof *auth);
	if (!auth)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tokens");
	pthread_mutex_init(&auth->mutex, NULL);
	auth->required = *config->tokens != 0;
	auth->last_grant = GRANT_OF_ALL;
	cau_status status = cau_auth_reload(auth, config, error);
	if (status)
		cau_auth_destroy(auth);
	else
		*made = auth;
	return status;
}

void cau_auth_destroy(cau_auth *auth)
{
	if (!auth)
		return;
	pthread_mutex_destroy(&auth->mutex);
	explicit_bzero(auth, sizeof *auth);
	free(auth);
}

// The token of this text or, with NULL, of this grant: a copy of its grant and role. False: none.
static bool look_up(const cau_auth *auth, const char *text, size_t bytes, uint64_t *grant,
                    cau_role *role)
{
	cau_auth *locked = (cau_auth *)auth; // const to callers: they change nothing that they can see
	const token *found = NULL;
	pthread_mutex_lock(&locked->mutex);
	if (text)
		found = find_token(&auth->list, text, bytes);
	for (int i = 0; i < auth->list.count && !text; i++)
		if (auth->list.tokens[i].grant == *grant)
			found = &auth->list.tokens[i];
	*role = found ? found->role : CAU_ROLE_ADMIN;
	*grant = found ? found->grant : auth->required ? 0 : GRANT_OF_ALL;
	pthread_mutex_unlock(&locked->mutex);
	return found || !auth->required;
}

bool cau_auth_role(const cau_auth *auth, const char *text, size_t bytes, cau_role *role)
{
	uint64_t grant;
	return look_up(auth, text, bytes, &grant, role);
}

uint64_t cau_auth_grant(const cau_auth *auth, const char *text, size_t bytes)
{
	uint64_t grant;
	cau_role role;
	look_up(auth, text, bytes, &grant, &role);
	return grant;
}

bool cau_auth_grant_role(const cau_auth *auth, uint64_t grant, cau_role *role)
{
	return look_up(auth, NULL, 0, &grant, role);
}

bool cau_auth_required(const cau_auth *auth)
{
	return auth->required;
}
