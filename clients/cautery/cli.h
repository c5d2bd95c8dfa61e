// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations for all commands of `cautery`: arguments, connection, results, exit codes and local
// files, and the table of the commands.
#pragma once

#include <stdio.h>

#include <cjson/cJSON.h>

#include "cautery/client.h"
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

// ---- contexts (local_file.c) -------------------------------------------------------------------
// Contexts: named daemons, each with its URL and the file of its token. They are stored in
// $XDG_CONFIG_HOME/cautery/contexts.json, or in ~/.config/cautery/contexts.json if that variable is
// not set. Only the owner can read the file.
//
//   {"current": "theatre",
//    "contexts": {"theatre": {"url": "wss://or1:8740", "token_file": "theatre.token"}}}
enum { CLI_CONTEXT_TEXT_BYTES = 1024 };

typedef struct cli_context {
	char url[CLI_CONTEXT_TEXT_BYTES];
	char token_file[CLI_CONTEXT_TEXT_BYTES]; // "" if there is none
} cli_context;

// Finds the context `name`. NULL means the current context; if there is none, *context is empty.
// Errors: CAU_NOT_FOUND, CAU_IO, CAU_BAD_SYNTAX, CAU_NO_MEMORY; error->file names the file.
cau_status cli_context_find(const char *name, cli_context *context, cau_error *error);

// Reads the whole file. The caller deletes *all. A missing file has no contexts. Errors: CAU_IO,
// CAU_BAD_SYNTAX, CAU_NO_MEMORY; error->file names the file.
cau_status cli_contexts_read(cJSON **all, cau_error *error);
// Replaces the file only after the new one is written completely. Errors: CAU_IO, CAU_NO_MEMORY.
cau_status cli_contexts_write(const cJSON *all, cau_error *error);
cJSON *cli_contexts_of(const cJSON *all); // returns the member "contexts"
const char *cli_context_text(const cJSON *object,
                             const char *member); // "" if there is no such member

// ---- a command and its arguments ---------------------------------------------------------------
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

// ---- words -------------------------------------------------------------------------------------
// The protocol's words for the numbers of enumerations. A number that this version does not know
// gives "?".
const char *cli_state_word(int32_t state);       // CAU_SESSION_*
const char *cli_layer_word(int32_t kind);        // CAU_LAYER_*
const char *cli_shape_word(int32_t shape);       // CAU_TOOL_*
const char *cli_energy_off_word(int32_t reason); // CAU_ENERGY_OFF_*
const char *cli_event_word(int32_t kind);        // CAU_EVENT_*
int32_t cli_shape_of_word(const char *word);     // -1 if the word is not a shape

// ---- local files (local_file.c) ----------------------------------------------------------------
// Reads and writes whole local files. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY; error->file names
// the file.

// Reads a file and adds a zero after the last byte. The name "-" means standard input. The caller
// frees *bytes.
cau_status cli_read_file(const char *name, size_t bytes_max, char **bytes, size_t *byte_count,
                         cau_error *error);

// Writes a file. The name "-" means standard output. An incomplete file is removed.
cau_status cli_write_file(const char *name, const void *bytes, size_t byte_count, cau_error *error);

// ---- driving a tool (tool.c) -------------------------------------------------------------------
// Joins the session at 60 Hz for the tools, the face mask and the statistics.
cli_exit cli_join_tools(cli *c, cau_client_stream **stream);

// Becomes the driver of the tool, if the tool exists and this client does not drive it already.
cli_exit cli_take(cli *c, const cau_client_stream *stream, const char *tool);

// Returns the newest state of a tool, or NULL if there is no such tool.
const cau_stream_tool *cli_find_tool(const cau_client_stream *stream, const char *tool);

// ---- all commands, each with its file ----------------------------------------------------------
extern const cli_command *const cli_commands[]; // in commands.c; NULL marks the end

extern const cli_command cli_ls, cli_scenes, cli_instruments;        // list.c
extern const cli_command cli_create;                                 // create.c
extern const cli_command cli_info;                                   // list.c
extern const cli_command cli_watch;                                  // watch.c
extern const cli_command cli_tool;                                   // tool.c
extern const cli_command cli_run;                                    // run.c
extern const cli_command cli_record;                                 // record.c
extern const cli_command cli_export, cli_log;                        // files.c
extern const cli_command cli_rm;                                     // list.c
extern const cli_command cli_pause, cli_resume, cli_step;            // time.c
extern const cli_command cli_speed, cli_reset;                       // time.c
extern const cli_command cli_rewind, cli_fork, cli_snapshot;         // history.c
extern const cli_command cli_snapshots, cli_restore;                 // history.c
extern const cli_command cli_events;                                 // events.c
extern const cli_command cli_pin, cli_unpin, cli_force, cli_gravity; // tissue.c
extern const cli_command cli_material;                               // material.c
extern const cli_command cli_backup;                                 // daemon.c
extern const cli_command cli_move;                                   // move.c
extern const cli_command cli_ping;                                   // daemon.c
extern const cli_command cli_context_ls, cli_context_set;            // context.c
extern const cli_command cli_context_use, cli_context_rm;            // context.c
extern const cli_command cli_token;                                  // token.c
extern const cli_command cli_mesh;                                   // mesh.c
extern const cli_command cli_completion, cli_complete;               // completion.c
