// SPDX-License-Identifier: GPL-3.0-or-later
// Daemons that somebody works with, by name: where each is and which file holds the token for it.
// Kept in $XDG_CONFIG_HOME/cautery/contexts.json (~/.config/... where that is not set), for its
// owner alone:
//
//     {"current": "theatre",
//      "contexts": {"theatre": {"url": "wss://or1:8740", "token_file": "theatre.token"}}}
#pragma once

#include <cjson/cJSON.h>

#include "cautery/status.h"

enum { CLI_CONTEXT_TEXT_BYTES = 1024 };

typedef struct cli_context {
	char url[CLI_CONTEXT_TEXT_BYTES];
	char token_file[CLI_CONTEXT_TEXT_BYTES]; // "": none
} cli_context;

// The context of this name; NULL: the current one, and where there is none all stays empty. Errors:
// CAU_NOT_FOUND, CAU_IO, CAU_BAD_SYNTAX, CAU_NO_MEMORY; error->file names the file.
cau_status cli_context_find(const char *name, cli_context *context, cau_error *error);

// The whole file, to be deleted; one that is not there holds nothing. Errors: as above.
cau_status cli_contexts_read(cJSON **all, cau_error *error);
// Into its place only when it is whole. Errors: CAU_IO, CAU_NO_MEMORY.
cau_status cli_contexts_write(const cJSON *all, cau_error *error);
cJSON *cli_contexts_of(const cJSON *all);                              // its member "contexts"
const char *cli_context_text(const cJSON *object, const char *member); // "": there is none
