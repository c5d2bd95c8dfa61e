// SPDX-License-Identifier: Apache-2.0
// Error codes of answers and close codes of connections.
//
//     #include "cautery/rpc_errors.h"
//
//     // Prints an error like an answer's members code, message and data.status.
//     static void tell(FILE *out, cau_status status)
//     {
//         int code = cau_rpc_error_of_status(status);
//         fprintf(out, "%d %s (%s)\n", code, cau_rpc_error_sentence(code),
//                 cau_rpc_error_word(code));
//     }
#pragma once

#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

// X(number, code, word in data.status, sentence in message)
#define CAU_RPC_ERROR_TABLE(X)                                                                     \
	X(-32700, PARSE, "bad_syntax", "the text is not well formed")                                  \
	X(-32600, INVALID_REQUEST, "invalid_request",                                                  \
	  "the message is not a valid JSON-RPC 2.0 request")                                           \
	X(-32601, METHOD_NOT_FOUND, "method_not_found", "there is no such method")                     \
	X(-32602, BAD_VALUE, "bad_value", "a value is missing, of the wrong type or out of its range") \
	X(-32603, INTERNAL, "internal", "the server has an internal error")                            \
	X(-32003, BAD_MESH, "bad_mesh", "the mesh cannot be simulated")                                \
	X(-32004, BAD_STATE, "bad_state", "the request does not fit the present state")                \
	X(-32005, NOT_FOUND, "not_found", "nothing has this name")                                     \
	X(-32006, ALREADY_EXISTS, "already_exists", "the name is taken")                               \
	X(-32007, LIMIT, "limit", "a configured limit is reached")                                     \
	X(-32008, UNSUPPORTED, "unsupported", "this build cannot do that")                             \
	X(-32009, NO_MEMORY, "no_memory", "memory ran out")                                            \
	X(-32010, IO, "io", "a file could not be read or written")                                     \
	X(-32011, NUMERICAL, "numerical", "the simulation failed numerically")                         \
	X(-32012, FAULTED, "faulted", "the session is faulted: rewind or reset it")                    \
	X(-32013, CORRUPT, "corrupt", "the data is damaged or of another version")                     \
	X(-32040, NOT_HERE, "not_here", "this daemon does not have the session")                       \
	X(-32041, HELLO_REQUIRED, "hello_required", "the first message must be hello")                 \
	X(-32042, UNAUTHORIZED, "unauthorized", "the token is missing or unknown")                     \
	X(-32043, FORBIDDEN, "forbidden", "the role or the token does not allow this")                 \
	X(-32044, VERSION, "version", "the server does not support this version of the protocol")      \
	X(-32045, NOT_DRIVER, "not_driver", "another client drives this tool")                         \
	X(-32046, RATE, "rate", "the client sends too many messages a second")                         \
	X(-32047, DRAINING, "draining", "the server is shutting down")                                 \
	X(-32048, STORE_FULL, "store_full", "the store is full")                                       \
	X(-32049, SEQUENCE_PAST, "sequence_past",                                                      \
	  "the answer to this client_sequence is no longer kept")                                      \
	X(-32050, SEQUENCE_CONFLICT, "sequence_conflict",                                              \
	  "this client_sequence belongs to another method")                                            \
	X(-32051, MOVED, "moved", "another daemon has the session now")

// The code of an error, from CAU_RPC_ERROR_TABLE.
typedef enum cau_rpc_error_code {
#define X(number, code, word, sentence) CAU_RPC_##code = (number),
	CAU_RPC_ERROR_TABLE(X)
#undef X
} cau_rpc_error_code;

// Returns the code with the same word as the status, or CAU_RPC_INTERNAL if there is none.
cau_rpc_error_code cau_rpc_error_of_status(cau_status status);
// Returns the word in data.status, or "internal" for an unknown code.
const char *cau_rpc_error_word(int code);
// Returns the sentence in the message; for an unknown code, that of "internal".
const char *cau_rpc_error_sentence(int code);

// X(number, code, reason in the close frame)
#define CAU_CLOSE_TABLE(X)                                                                         \
	X(1000, DONE, "done")                                                                          \
	X(1001, DRAINING, "the server is shutting down")                                               \
	X(1002, PROTOCOL, "the client violated the WebSocket protocol")                                \
	X(1003, UNSUPPORTED, "a binary message was not a chunk of an upload")                          \
	X(1007, NOT_UTF8, "a text message was not UTF-8")                                              \
	X(1009, TOO_BIG, "a message was longer than the limit")                                        \
	X(1011, INTERNAL, "the server has an internal error")                                          \
	X(1013, FULL, "the server has too many connections")                                           \
	X(4001, NO_HELLO, "the client sent no hello within 5 s")                                       \
	X(4002, UNAUTHORIZED, "the token is missing or unknown")                                       \
	X(4003, VERSION, "client and server support no common version of the protocol")                \
	X(4004, TOO_SLOW, "the client did not read its frames fast enough")                            \
	X(4005, RATE, "the client sends too many messages a second")                                   \
	X(4006, NO_ANSWER, "the client did not answer pings")                                          \
	X(4007, RESUMED, "another connection took over this one")                                      \
	X(4008, GARBAGE, "the client sent too many malformed messages")

// The code with which a connection is closed, from CAU_CLOSE_TABLE.
typedef enum cau_close_code {
#define X(number, code, reason) CAU_CLOSE_##code = (number),
	CAU_CLOSE_TABLE(X)
#undef X
} cau_close_code;

// Returns the reason that is sent with a close code.
const char *cau_close_reason(cau_close_code code);

#ifdef __cplusplus
}
#endif
