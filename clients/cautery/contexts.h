// SPDX-License-Identifier: GPL-3.0-or-later
// Contexts: named daemons, each with its URL and the file of its token. They are stored in
// $XDG_CONFIG_HOME/cautery/contexts.json, or in ~/.config/cautery/contexts.json if that variable is
// not set. Only the owner can read the file.
//
//   {"current": "theatre",
//    "contexts": {"theatre": {"url": "wss://or1:8740", "token_file": "theatre.token"}}}
#pragma once

#include <cjson/cJSON.h>

#include "cautery/status.h"

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
