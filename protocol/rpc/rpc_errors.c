// SPDX-License-Identifier: Apache-2.0
#include "cautery/rpc_errors.h"

#include <stddef.h>
#include <string.h>

#include "cautery/assert.h"

typedef struct error_row {
	int code;
	const char *word;
	const char *sentence;
} error_row;

static const error_row rows[] = {
#define X(number, code, word, sentence) {number, word, sentence},
	CAU_RPC_ERROR_TABLE(X)
#undef X
};

static const error_row *find(int code)
{
	const error_row *internal = NULL;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		if (rows[i].code == code)
			return &rows[i];
		if (rows[i].code == CAU_RPC_INTERNAL)
			internal = &rows[i];
	}
	CAU_ASSERT(internal != NULL, "no row for code %d, nor for internal errors", code);
	return internal;
}

cau_rpc_error_code cau_rpc_error_of_status(cau_status status)
{
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (strcmp(rows[i].word, cau_status_name(status)) == 0)
			return (cau_rpc_error_code)rows[i].code;
	return CAU_RPC_INTERNAL;
}

const char *cau_rpc_error_word(int code)
{
	return find(code)->word;
}

const char *cau_rpc_error_sentence(int code)
{
	return find(code)->sentence;
}

const char *cau_close_reason(cau_close_code code)
{
	switch (code) {
#define X(number, name, reason)                                                                    \
	case CAU_CLOSE_##name:                                                                         \
		return reason;
		CAU_CLOSE_TABLE(X)
#undef X
	}
	return "";
}
