// SPDX-License-Identifier: GPL-3.0-or-later
// The command `token`: makes a token for a user and a line for the daemon's file of tokens.
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

#include "cautery/cli.h"
#include "cautery/name.h"
#include "cautery/sha256.h"

enum { RANDOM_BYTES = 32, DAY_S = 86400, QUOTA_MOST = 1000000, SESSIONS_BYTES_MOST = 151 };

#define NAME_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"

static const char *const roles[] = {"view", "operate", "admin"};
enum { ROLE_COUNT = sizeof roles / sizeof *roles };

static bool make_token(char text[2 * RANDOM_BYTES + 1])
{
	unsigned char bytes[RANDOM_BYTES];
	if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
		return false;
	for (int i = 0; i < RANDOM_BYTES; i++)
		snprintf(text + (size_t)(2 * i), 3, "%02x", bytes[i]);
	explicit_bzero(bytes, sizeof bytes);
	return true;
}

// Creates a new file that only the owner can read. An existing file is refused, because other users
// may have it open.
static bool write_secret(cli *c, const char *file, const char *text)
{
	int descriptor = open(file, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	FILE *stream = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
	bool written = stream && fprintf(stream, "%s\n", text) > 0;
	if (stream && fclose(stream) == 0 && written)
		return true;
	snprintf(c->error.file, sizeof c->error.file, "%.255s", file);
	cau_fail(&c->error, CAU_IO, NULL, "%s", strerror(errno));
	return false;
}

static bool is_role(const cli *c, const char *word)
{
	for (int i = 0; i < ROLE_COUNT; i++)
		if (strcmp(roles[i], word) == 0)
			return true;
	cli_complain_unknown(c, "role", word, roles, ROLE_COUNT);
	return false;
}

// Prints the line for the daemon's file of tokens. `quota` 0 means no quota.
static void print_line(const cli *c, const char *hash, const char *name, double days, double quota)
{
	const char *sessions = cli_value(c, "sessions");
	char expires[64] = "";
	struct tm utc;
	time_t until = time(NULL) + (time_t)(days * DAY_S);
	if (days > 0)
		strftime(expires, sizeof expires, " expires=%Y-%m-%dT%H:%M:%SZ", gmtime_r(&until, &utc));
	fprintf(c->out, "%s sha256:%s%s%s%s", c->arguments[0], hash, name ? " name=" : "",
	        name ? name : "", expires);
	if (sessions)
		fprintf(c->out, " sessions=%s", sessions);
	if (quota > 0)
		fprintf(c->out, " quota=%.0f", quota);
	fputc('\n', c->out);
}

// Checks a list of sessions by the daemon's rules. NULL means all sessions.
static bool are_sessions(const cli *c, const char *list)
{
	bool right = !list || (*list && strlen(list) <= SESSIONS_BYTES_MOST);
	for (const char *at = list; right && at && *at;) {
		size_t bytes = strcspn(at, ","), plain = strspn(at, NAME_LETTERS);
		right = bytes > 0 && (plain == bytes || (plain + 1 == bytes && at[plain] == '*'));
		right = right && (!at[bytes] || at[bytes + 1]);
		at += bytes + (at[bytes] == ',');
	}
	if (!right)
		cli_complain(c,
		             "--sessions needs ids with commas between, as in d1-anna-*,d1-demo; at most "
		             "%d characters",
		             SESSIONS_BYTES_MOST);
	return right;
}

static cli_exit run(cli *c)
{
	bool bad = false;
	char text[2 * RANDOM_BYTES + 1], hash[CAU_SHA256_TEXT_BYTES];
	const char *file = cli_value(c, "out"), *name = cli_value(c, "name");
	double days = cli_number(c, "days", 0.001, 36500, 0, &bad);
	double quota = floor(cli_number(c, "quota", 1, QUOTA_MOST, 0, &bad));
	if (bad || !is_role(c, c->arguments[0]))
		return CLI_USAGE;
	if (!file) {
		cli_complain(c, "--out FILE is missing: the file for the token");
		return CLI_USAGE;
	}
	if (name && (!cau_name_is_valid(name) || strlen(name) >= CAU_NAME_BYTES - 1)) {
		cli_complain(c, "\"%s\" is not a valid name: %s", name, CAU_NAME_RULE);
		return CLI_USAGE;
	}
	if (!make_token(text) || !cau_sha256(text, strlen(text), hash)) {
		cau_fail(&c->error, CAU_IO, NULL, "the system gives no random numbers");
		return cli_fail_file(c);
	}
	if (!are_sessions(c, cli_value(c, "sessions")))
		return CLI_USAGE;
	bool written = write_secret(c, file, text);
	explicit_bzero(text, sizeof text);
	if (!written)
		return cli_fail_file(c);
	print_line(c, hash, name, days, quota);
	return CLI_DONE;
}

const cli_command cli_token = {
	.name = "token",
	.arguments = "view|operate|admin",
	.summary = "makes an access token, and prints the line for the daemon's file of tokens",
	.help =
		"The token is written into a new file, for the option --token-file of its user. The line\n"
		"holds only its hash. The daemon reads its file of tokens again when it reloads "
		"(SIGHUP).\n",
	.least = 1,
	.most = 1,
	.options =
		{{"out", "FILE", "new file into which the token is written"},
         {"name", "N", "owner of the token, for the daemon's log"},
         {"sessions", "LIST",
          "sessions that the token allows, with commas; d1-anna-* for all with this beginning"},
         {"quota", "N", "expensive requests a minute (default: the quota of the role)"},
         {"days", "D", "days until the token expires (default: never)"}},
	.run = run};
