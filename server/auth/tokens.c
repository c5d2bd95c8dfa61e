// SPDX-License-Identifier: GPL-3.0-or-later
// Tokens. The main thread reads the file at the start and at a reload, while the network thread
// checks tokens. A lock, held for moments, guards the list.
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "auth/auth.h"
#include "cautery/sha256.h"
#include "clock/clock.h"
#include "config/config.h"

enum {
	MAX_TOKENS = 256,
	LEAST_TOKEN_BYTES = 16,
	MOST_TOKEN_BYTES = 128,
	NAME_BYTES = CAU_AUTH_NAME_BYTES,
	// capacity for a word of a line: more than the longest token or list of sessions
	WORD_BYTES = 160,
	MOST_QUOTA = 1000000,
};

static const char hash_mark[] = "sha256:";

// A token of the file. Only its hash is kept. Tokens are random, so nobody can guess a token from
// its hash.
typedef struct token {
	char hash[CAU_SHA256_TEXT_BYTES];
	char name[NAME_BYTES]; // the owner's name, for the log; "": no name was given
	int64_t expires_us;    // Unix time; INT64_MAX: never
	cau_role role;
	cau_auth_bounds bounds;
	uint64_t grant; // stays the same as long as the token is in the file
	int line;       // number of its line in the file
} token;

typedef struct token_list {
	int count;
	token tokens[MAX_TOKENS];
} token_list;

struct cau_auth {
	bool required;
	pthread_mutex_t mutex; // guards the members below
	uint64_t last_grant;
	token_list list;
};

// Grant of every connection if there is no file of tokens.
enum { GRANT_OF_ALL = 1 };

// Reads the second word of a line: a hash, or a token whose hash is kept.
static cau_status read_secret(token *made, const char *word, int number, cau_error *error)
{
	size_t bytes = strlen(word);
	if (strncmp(word, hash_mark, sizeof hash_mark - 1) == 0) {
		const char *hash = word + sizeof hash_mark - 1;
		if (strlen(hash) != sizeof made->hash - 1 ||
		    strspn(hash, "0123456789abcdef") != sizeof made->hash - 1)
			return cau_fail(error, CAU_BAD_VALUE, "tokens",
			                "line %d: a hash must have 64 digits 0-9 and a-f", number);
		memcpy(made->hash, hash, sizeof made->hash);
		return CAU_OK;
	}
	if (bytes < LEAST_TOKEN_BYTES || bytes > MOST_TOKEN_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, "tokens",
		                "line %d: a token must have %d to %d characters", number, LEAST_TOKEN_BYTES,
		                MOST_TOKEN_BYTES);
	if (!cau_sha256(word, bytes, made->hash))
		return cau_fail(error, CAU_NO_MEMORY, "tokens", "no memory for tokens");
	return CAU_OK;
}

// Reads a list such as `d1-anna-*,d1-demo`. No entry may be empty, and a `*` must be an entry's
// last character.
static cau_status read_sessions(token *made, const char *list, int number, cau_error *error)
{
	bool right = *list && strlen(list) < sizeof made->bounds.sessions;
	for (const char *at = list; right && *at;) {
		size_t bytes = strcspn(at, ","), plain = strcspn(at, ",*");
		right = bytes > 0 && bytes - plain <= 1 && (at[bytes] == 0 || at[bytes + 1]);
		at += bytes + (at[bytes] == ',');
	}
	if (!right)
		return cau_fail(error, CAU_BAD_VALUE, "tokens",
		                "line %d: sessions= needs ids with commas between, as in "
		                "d1-anna-*,d1-demo; at most %d characters",
		                number, CAU_AUTH_SESSIONS_BYTES - 1);
	snprintf(made->bounds.sessions, sizeof made->bounds.sessions, "%s", list);
	return CAU_OK;
}

// Reads `name=anna`, `expires=2027-01-31T12:00:00Z`, `sessions=d1-anna-*` or `quota=60`.
static cau_status read_field(token *made, const char *word, int number, cau_error *error)
{
	const char *value = strchr(word, '=');
	value = value ? value + 1 : "";
	if (strncmp(word, "name=", 5) == 0 && *value && strlen(value) < sizeof made->name) {
		snprintf(made->name, sizeof made->name, "%s", value);
		return CAU_OK;
	}
	if (strncmp(word, "expires=", 8) == 0) {
		struct tm utc = {0};
		const char *end = strptime(value, "%Y-%m-%dT%H:%M:%SZ", &utc);
		if (!end || *end)
			return cau_fail(error, CAU_BAD_VALUE, "tokens",
			                "line %d: expires= needs a UTC time, as in 2027-01-31T12:00:00Z",
			                number);
		made->expires_us = (int64_t)timegm(&utc) * 1000000;
		return CAU_OK;
	}
	if (strncmp(word, "sessions=", 9) == 0)
		return read_sessions(made, value, number, error);
	if (strncmp(word, "quota=", 6) == 0) {
		char *end;
		long long most = strtoll(value, &end, 10);
		if (*end || most < 1 || most > MOST_QUOTA || *value < '0' || *value > '9')
			return cau_fail(
				error, CAU_BAD_VALUE, "tokens",
				"line %d: quota= needs a number of expensive requests a minute, 1 to %d", number,
				MOST_QUOTA);
		made->bounds.quota = most;
		return CAU_OK;
	}
	return cau_fail(error, CAU_BAD_SYNTAX, "tokens",
	                "line %d is not `ROLE TOKEN`, with name=N, expires=TIME, sessions=LIST and "
	                "quota=N or without",
	                number);
}

static bool same_bytes(const char *a, const char *b, size_t bytes)
{
	unsigned char difference = 0;
	for (size_t i = 0; i < bytes; i++)
		difference |= (unsigned char)(a[i] ^ b[i]);
	return difference == 0;
}

// Finds a token by its hash. Every token of the list is compared, so that a wrong token takes as
// long as a right one.
static const token *find_hash(const token_list *list, const char *hash)
{
	const token *found = NULL;
	for (int i = 0; i < list->count; i++)
		if (same_bytes(list->tokens[i].hash, hash, sizeof list->tokens[i].hash))
			found = &list->tokens[i];
	return found;
}

static cau_status read_line(token_list *list, char *line, int number, cau_error *error)
{
	char role[16], word[WORD_BYTES + 1];
	int taken = 0;
	token made = {.expires_us = INT64_MAX};
	line[strcspn(line, "#\r\n")] = 0;
	int fields = sscanf(line, "%15s %160s%n", role, word, &taken);
	if (fields <= 0)
		return CAU_OK;
	if (fields != 2)
		return cau_fail(error, CAU_BAD_SYNTAX, "tokens", "line %d is not `ROLE TOKEN`", number);
	if (!cau_role_read(role, &made.role))
		return cau_fail(error, CAU_BAD_VALUE, "tokens", "line %d: roles are view, operate, admin",
		                number);
	cau_status status = read_secret(&made, word, number, error);
	for (int more; !status && sscanf(line += taken, " %160s%n", word, &more) == 1; taken = more)
		status = read_field(&made, word, number, error);
	explicit_bzero(word, sizeof word);
	if (status)
		return status;
	const token *twin = find_hash(list, made.hash);
	if (twin)
		return cau_fail(error, CAU_BAD_VALUE, "tokens",
		                "lines %d and %d have the same token: keep one of them", number,
		                twin->line);
	made.line = number;
	if (list->count == MAX_TOKENS)
		return cau_fail(error, CAU_LIMIT, "tokens", "more than %d tokens", MAX_TOKENS);
	list->tokens[list->count++] = made;
	return CAU_OK;
}

static cau_status read_tokens(token_list *list, const char *file, cau_error *error)
{
	struct stat info;
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(file, CAU_NAMED_FILE_BYTES, &info, reason);
	if (!stream)
		return cau_fail(error, CAU_IO, "tokens", "cannot open %.200s: %s", file, reason);
	cau_status status = CAU_OK;
	if (info.st_mode & (S_IRWXG | S_IRWXO))
		status = cau_fail(error, CAU_BAD_VALUE, "tokens",
		                  "%.200s can be read by other users: chmod 600", file);
	char line[512];
	for (int number = 1; !status && fgets(line, sizeof line, stream); number++)
		status = strlen(line) + 1 < sizeof line
		             ? read_line(list, line, number, error)
		             : cau_fail(error, CAU_LIMIT, "tokens",
		                        "line %d is longer than %zu bytes with its line end", number,
		                        sizeof line - 2);
	fclose(stream);
	explicit_bzero(line, sizeof line);
	if (!status && list->count == 0)
		status = cau_fail(error, CAU_BAD_VALUE, "tokens", "%.200s contains no token", file);
	if (status && error)
		snprintf(error->file, sizeof error->file, "%s", file);
	return status;
}

// Replaces the list by the list that was read. A token that is in both lists keeps its grant.
static void take_list(cau_auth *auth, token_list *read)
{
	pthread_mutex_lock(&auth->mutex);
	for (int i = 0; i < read->count; i++) {
		token *now = &read->tokens[i];
		const token *before = find_hash(&auth->list, now->hash);
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

// Copies the token with this hash or, if `hash` is NULL, with this grant. Returns false if there is
// no such token, or if the token has expired.
static bool look_up(const cau_auth *auth, const char *hash, uint64_t grant, token *copy)
{
	// `auth` is const because callers see no change; only the mutex changes
	cau_auth *locked = (cau_auth *)auth;
	const token *found = NULL;
	pthread_mutex_lock(&locked->mutex);
	if (hash)
		found = find_hash(&auth->list, hash);
	for (int i = 0; i < auth->list.count && !hash; i++)
		if (auth->list.tokens[i].grant == grant)
			found = &auth->list.tokens[i];
	if (found && cau_wall_us() >= found->expires_us)
		found = NULL;
	if (found)
		*copy = *found;
	pthread_mutex_unlock(&locked->mutex);
	if (!found && !auth->required)
		*copy = (token){.role = CAU_ROLE_ADMIN, .grant = GRANT_OF_ALL};
	return found || !auth->required;
}

static bool look_up_text(const cau_auth *auth, const char *text, size_t bytes, token *copy)
{
	char hash[CAU_SHA256_TEXT_BYTES] = "";
	if (auth->required && (bytes > MOST_TOKEN_BYTES || !cau_sha256(text, bytes, hash)))
		return false;
	return look_up(auth, hash, 0, copy);
}

bool cau_auth_role(const cau_auth *auth, const char *text, size_t bytes, cau_role *role)
{
	token found;
	bool known = look_up_text(auth, text, bytes, &found);
	if (known)
		*role = found.role;
	return known;
}

uint64_t cau_auth_grant(const cau_auth *auth, const char *text, size_t bytes)
{
	token found;
	return look_up_text(auth, text, bytes, &found) ? found.grant : 0;
}

bool cau_auth_grant_role(const cau_auth *auth, uint64_t grant, cau_role *role)
{
	token found;
	bool known = look_up(auth, NULL, grant, &found);
	if (known)
		*role = found.role;
	return known;
}

void cau_auth_grant_name(const cau_auth *auth, uint64_t grant, char name[CAU_AUTH_NAME_BYTES])
{
	token found;
	bool known = look_up(auth, NULL, grant, &found);
	snprintf(name, CAU_AUTH_NAME_BYTES, "%s", known ? found.name : "");
}

void cau_auth_grant_owner(const cau_auth *auth, uint64_t grant, char owner[CAU_AUTH_OWNER_BYTES])
{
	token found;
	bool known = auth->required && look_up(auth, NULL, grant, &found);
	if (known && *found.name)
		snprintf(owner, CAU_AUTH_OWNER_BYTES, "name:%s", found.name);
	else
		snprintf(owner, CAU_AUTH_OWNER_BYTES, "%s", known ? found.hash : "");
}

bool cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant, cau_auth_bounds *bounds)
{
	token found;
	bool known = look_up(auth, NULL, grant, &found);
	if (known)
		*bounds = found.bounds;
	return known;
}

bool cau_auth_session_allowed(const cau_auth_bounds *bounds, const char *session)
{
	if (!*bounds->sessions)
		return true;
	for (const char *at = bounds->sessions; *at;) {
		size_t bytes = strcspn(at, ","), plain = strcspn(at, ",*");
		bool same = strncmp(session, at, plain) == 0 && *session;
		if (same && (plain < bytes || !session[plain]))
			return true;
		at += bytes + (at[bytes] == ',');
	}
	return false;
}

bool cau_auth_sees_all(const cau_auth *auth, const char *text, size_t bytes)
{
	token found;
	return look_up_text(auth, text, bytes, &found) && !*found.bounds.sessions;
}

bool cau_auth_required(const cau_auth *auth)
{
	return auth->required;
}
