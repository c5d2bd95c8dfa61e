// SPDX-License-Identifier: GPL-3.0-or-later
// What the commands of `cautery` share: their arguments, the connection, and how they end.
#pragma once

#include <stdio.h>

#include "cautery/client.h"
#include "cautery/contexts.h"
#include "cautery/json_writer.h"

// Exit codes, as --help and clients/README.md state them.
typedef enum cli_exit {
	CLI_DONE = 0,
	CLI_REFUSED = 1,    // the server answered with an error, or the session is faulted or gone
	CLI_USAGE = 2,      // arguments
	CLI_CONNECTION = 3, // no server, no answer in time, connection lost
	CLI_FILE = 4,       // a file here cannot be read or written, or does not hold what it should
	CLI_INCOMPLETE = 5, // a script was refused in part, lost its energy, or was interrupted
} cli_exit;

enum { CLI_ARGUMENTS_MAX = 128, CLI_OPTIONS_MAX = 12 };

typedef struct cli cli;

typedef struct cli_option {
	const char *name;     // without the dashes; NULL ends a table
	const char *argument; // as help shows it; NULL: a flag
	const char *meaning;
} cli_option;

typedef struct cli_command {
	const char *name;      // one word, or two: "snapshot ls"
	const char *also;      // another name, or NULL
	const char *arguments; // as help shows them
	const char *summary;   // one line
	const char *help;      // more lines, may be NULL
	int least, most;       // arguments, a session that may be left out not counted
	bool session_optional; // one more argument in front: the session; else the only one there is
	cli_option options[CLI_OPTIONS_MAX];
	cli_exit (*run)(cli *c);
} cli_command;

static const double cli_tick_max = 9007199254740991.0; // of the wire

struct cli {
	FILE *out, *complaints;
	const cli_command *const *commands; // ends with NULL
	const cli_command *command;
	const char *word; // the command's first
	const char *arguments[CLI_ARGUMENTS_MAX];
	int argument_count;
	const char *values[CLI_OPTIONS_MAX];    // of the command's options; NULL: not given; flags: ""
	const char *url, *token_file, *context; // NULL: not given
	const char *label;                      // one, or several for ls
	double timeout_s;
	bool json, help, version;
	cau_client_def def; // what cli_connect uses; commands may set callbacks before
	char daemon_url[CLI_CONTEXT_TEXT_BYTES], token[CAU_CLIENT_TOKEN_BYTES]; // def's; "": none
	cau_loop *loop;
	cau_client *client;
	char session[CAU_NAME_BYTES]; // chosen by cli_connect
	cau_error error;
};

// Reads the command line. On a mistake, says it on c->complaints and returns false.
bool cli_read(cli *c, int argument_count, char **arguments);
// The same without asking whether it is whole, and with what is given there alone.
bool cli_read_words(cli *c, int argument_count, char **arguments);
int cli_common_options(const cli_option **options); // how many, that of all zeros included
void cli_help(const cli *c);                        // of the command, or of all

const char *cli_value(const cli *c, const char *option); // NULL: not given
// The number of an option or `otherwise`; sets *bad and complains if it is none or out of bounds.
double cli_number(const cli *c, const char *option, double least, double most, double otherwise,
                  bool *bad);
bool cli_read_number(const cli *c, const char *what, const char *text, double least, double most,
                     double *value);

// Connects and, for commands about a session, finds which one. CLI_DONE or how it failed, told.
cli_exit cli_connect(cli *c);
// Connects to the daemon of a session, or else of a label; either may be NULL. What was connected
// before is closed.
cli_exit cli_connect_to(cli *c, const char *session, const char *label);
// The labels of the daemons behind the address; none: one daemon alone. Leaves no connection.
cli_exit cli_find_fleet(cli *c, cau_fleet *fleet);
void cli_finish(cli *c);

// Tells c->error and returns the exit code that belongs to it.
cli_exit cli_fail(cli *c);
cli_exit cli_fail_file(cli *c); // the same, where a file here is to blame
// The same, where there was no memory. Here, so that the analyzer knows that it is not CLI_DONE.
static inline cli_exit cli_fail_memory(cli *c)
{
	cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory on this machine");
	cli_fail(c);
	return CLI_CONNECTION;
}
void cli_complain(const cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
// There is no such `what` as `word`; which of the words may have been meant.
void cli_complain_unknown(const cli *c, const char *what, const char *word,
                          const char *const *words, size_t count);

// Calls the method and prints its result: with --json, as JSON. `result` may be NULL.
cli_exit cli_call(cli *c, cau_method method, const void *params, void *result);
// The method's result as one line of JSON, by the message tables.
void cli_print_result(const cli *c, cau_method method, const void *result);

// Sends a command of the session and tells from which tick on it is `done`.
cli_exit cli_command_session(cli *c, const cau_command *command, const char *done);

// The session of the command as parameter of a method.
#define CLI_SESSION_PARAMS(c, params)                                                              \
	do {                                                                                           \
		(params)->has_session = true;                                                              \
		memcpy((params)->session, (c)->session, sizeof(params)->session);                          \
	} while (0)
#define CLI_CHANGE_PARAMS(c, params)                                                               \
	do {                                                                                           \
		CLI_SESSION_PARAMS(c, params);                                                             \
		(params)->has_client_sequence = true;                                                      \
		(params)->client_sequence = cau_client_next_sequence((c)->client);                         \
	} while (0)

// True after SIGINT or SIGTERM, once cli_watch_signals was called.
void cli_watch_signals(void);
bool cli_interrupted(void);
