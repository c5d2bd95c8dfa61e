// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations for all commands of `cautery`: arguments, connection, results and exit codes.
#pragma once

#include <stdio.h>

#include "cautery/client.h"
#include "cautery/contexts.h"
#include "cautery/json_writer.h"

// Exit codes, as documented by --help and clients/README.md.
typedef enum cli_exit {
	CLI_DONE = 0,
	CLI_REFUSED = 1,    // the server answered with an error, or the session is faulted or gone
	CLI_USAGE = 2,      // wrong arguments
	CLI_CONNECTION = 3, // no server, no answer in time, or connection lost
	CLI_FILE = 4,       // a local file cannot be read or written, or has the wrong content
	CLI_INCOMPLETE = 5, // a script was partly refused, lost its energy, or was interrupted
} cli_exit;

enum { CLI_ARGUMENTS_MAX = 128, CLI_OPTIONS_MAX = 12 };

typedef struct cli cli;

typedef struct cli_option {
	const char *name;     // the option's name without the dashes; NULL marks the end of a table
	const char *argument; // name of the option's value in --help; NULL for a flag
	const char *meaning;
} cli_option;

typedef struct cli_command {
	const char *name;      // one word, or two: "snapshot ls"
	const char *also;      // alias, or NULL
	const char *arguments; // the arguments' names in --help
	const char *summary;   // summary in one line
	const char *help;      // more lines for --help, or NULL
	int least, most;       // number of arguments, without an optional session
	bool session_optional; // an optional session precedes the arguments; the default is the
	                       // daemon's only session
	cli_option options[CLI_OPTIONS_MAX];
	cli_exit (*run)(cli *c);
} cli_command;

// Largest tick that a message can carry: 2^53 - 1.
static const double cli_tick_max = 9007199254740991.0;

struct cli {
	FILE *out, *complaints;
	const cli_command *const *commands; // NULL marks the end
	const cli_command *command;
	const char *word; // first word of the command
	const char *arguments[CLI_ARGUMENTS_MAX];
	int argument_count;
	const char *values[CLI_OPTIONS_MAX]; // values of the command's options: NULL if not given, ""
	                                     // for a flag
	const char *url, *token_file, *context; // NULL if not given
	const char *label;                      // label of a daemon; `ls` takes several labels
	double timeout_s;
	bool json, help, version;
	// definition for cli_connect; a command may set callbacks before it connects
	cau_client_def def;
	// strings that `def` points to; the token is "" if there is none
	char daemon_url[CLI_CONTEXT_TEXT_BYTES], token[CAU_CLIENT_TOKEN_BYTES];
	cau_loop *loop;
	cau_client *client;
	char session[CAU_NAME_BYTES]; // the session's id; cli_connect sets it
	cau_error error;
};

// Reads the command line. Reports a mistake on c->complaints and returns false.
bool cli_read(cli *c, int argument_count, char **arguments);
// Reads the words of the command line as cli_read does, but accepts an incomplete command line.
bool cli_read_words(cli *c, int argument_count, char **arguments);
// Returns the number of common options, including the all-zero entry at the end.
int cli_common_options(const cli_option **options);
// Prints help for c->command, or for the program if no command is given.
void cli_help(const cli *c);

// Returns the option's value, "" for a flag, or NULL if the option is not given.
const char *cli_value(const cli *c, const char *option);
// Returns the value of a numeric option, or `otherwise` if it is not given. Sets *bad and complains
// if the value is not a number or is out of bounds.
double cli_number(const cli *c, const char *option, double least, double most, double otherwise,
                  bool *bad);
bool cli_read_number(const cli *c, const char *what, const char *text, double least, double most,
                     double *value);

// Connects and, for commands about a session, chooses the session. Returns CLI_DONE, or the exit
// code of a failure that is already printed.
cli_exit cli_connect(cli *c);
// Connects to the daemon that has `session`, or to the daemon of `label`. Either may be NULL.
// Closes the earlier connection first.
cli_exit cli_connect_to(cli *c, const char *session, const char *label);
// Finds the labels of the daemons behind the address. A single daemon has no labels. Leaves no
// connection open.
cli_exit cli_find_fleet(cli *c, cau_fleet *fleet);
void cli_finish(cli *c);

// Prints c->error and returns the exit code for it.
cli_exit cli_fail(cli *c);
// Prints c->error and returns CLI_FILE.
cli_exit cli_fail_file(cli *c);
// Reports that this program is out of memory. It is inline so that the analyzer sees that the
// result is not CLI_DONE.
static inline cli_exit cli_fail_memory(cli *c)
{
	cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory on this machine");
	cli_fail(c);
	return CLI_CONNECTION;
}
void cli_complain(const cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Complains that there is no `what` named `word`, and suggests a similar one of `words`.
void cli_complain_unknown(const cli *c, const char *what, const char *word,
                          const char *const *words, size_t count);

// Calls the method. Prints the result as JSON if --json is given. `result` may be NULL.
cli_exit cli_call(cli *c, cau_method method, const void *params, void *result);
// Prints the method's result as one line of JSON.
void cli_print_result(const cli *c, cau_method method, const void *result);

// Sends a command to the session and prints `done` with the tick at which the command acts.
cli_exit cli_command_session(cli *c, const cau_command *command, const char *done);

// Sets the `session` of a method's params to the session of the command line.
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

// cli_interrupted is true after SIGINT or SIGTERM, if cli_watch_signals was called before.
void cli_watch_signals(void);
bool cli_interrupted(void);
