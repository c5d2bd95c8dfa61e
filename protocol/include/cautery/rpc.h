// SPDX-License-Identifier: Apache-2.0
// Reads and writes JSON-RPC 2.0 messages by the tables of messages.h. Reading allocates one
// document, which cau_rpc_finish frees. Writing uses the caller's buffer.
//
//     #include "cautery/rpc.h"
//
//     // Answers a session.step request. A request that cannot be read gets an error.
//     static cau_status answer(const char *text, size_t bytes, cau_rpc_buffer *out,
//                              cau_error *error)
//     {
//         cau_rpc_message message;
//         cau_rpc_fault fault;
//         cau_wire_session_step params = {0};
//         cau_wire_tick_result result = {.tick = 7};
//         if (cau_rpc_read(text, bytes, 65536, &message, &fault))
//             return cau_rpc_write_error(out, &message.id, &fault, error);
//         cau_status status = cau_rpc_params(&message, &params, error);
//         if (status) {
//             cau_rpc_fault_of_error(&fault, error);
//             status = cau_rpc_write_error(out, &message.id, &fault, error);
//         } else {
//             status = cau_rpc_write_result(out, &message.id, message.method, &result, error);
//         }
//         cau_rpc_finish(&message);
//         return status;
//     }
#pragma once

#include "cautery/command.h"
#include "cautery/messages.h"
#include "cautery/rpc_errors.h"

#ifdef __cplusplus
extern "C" {
#endif

// The WebSocket subprotocol that clients offer in Sec-WebSocket-Protocol.
#define CAU_SUBPROTOCOL "cautery.v1"

enum { CAU_RPC_ID_BYTES = 65 }; // size of an id that is text, with its zero

// The id of a request.
typedef struct cau_rpc_id {
	enum { CAU_RPC_ID_NONE, CAU_RPC_ID_NUMBER, CAU_RPC_ID_TEXT } kind; // no id, or its type
	int64_t number;              // the id, if `kind` is CAU_RPC_ID_NUMBER
	char text[CAU_RPC_ID_BYTES]; // the id, if `kind` is CAU_RPC_ID_TEXT
} cau_rpc_id;

// The member `error` of an answer. `path` starts in the request: "params.rotation[2]".
typedef struct cau_rpc_fault {
	int32_t code;     // CAU_RPC_*, or the code that the server sent
	char status[33];  // data.status: the word in CAU_RPC_ERROR_TABLE
	char path[160];   // data.path; may be empty
	char reason[320]; // data.reason
	// Only for CAU_RPC_MOVED. data.moved_to is the session's id on its new daemon. data.url is the
	// address of that daemon, or empty if both daemons have the same address.
	char moved_to[CAU_NAME_BYTES], url[256];
} cau_rpc_fault;

// A message that was read. Free it with cau_rpc_finish.
typedef struct cau_rpc_message {
	enum {
		CAU_RPC_REQUEST,      // has an id and needs an answer
		CAU_RPC_NOTIFICATION, // needs no answer
		CAU_RPC_RESULT,       // a successful answer; read it with cau_rpc_result
		CAU_RPC_ERROR,        // an answer with an error, in `fault`
	} kind;                   // kind of the message
	cau_rpc_id id;            // id of a request or answer
	cau_method method;        // method of a request or notification
	cau_rpc_fault fault;      // error of a CAU_RPC_ERROR
	void *document;           // private; cau_rpc_finish frees it
} cau_rpc_message;

// Reads a text message of at most `bytes_max` bytes: strict JSON, then the rules of JSON-RPC 2.0.
// It refuses batches, ids that are null, fractions or longer than 64 bytes, unknown members, and
// params by position. On failure *fault has the reason, and message->id is the id to answer
// (CAU_RPC_ID_NONE: answer with id null). If no answer is allowed, message->kind is
// CAU_RPC_NOTIFICATION. The message need not be finished then. Returns CAU_OK, CAU_BAD_SYNTAX,
// CAU_BAD_VALUE, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_rpc_read(const char *text, size_t bytes, size_t bytes_max, cau_rpc_message *message,
                        cau_rpc_fault *fault);
void cau_rpc_finish(cau_rpc_message *message); // may be called twice

// Fills the C type of the method's params (see cau_method_describe). Missing required members,
// unknown members and values out of range are errors. `params` must be zeroed, except the lists and
// scenes that it borrows. Error paths start with "params".
cau_status cau_rpc_params(const cau_rpc_message *message, void *params, cau_error *error);

// Refuses members of params that the method does not have. It is for handlers that read no params.
// For commands, cau_rpc_command checks this. Errors: CAU_BAD_VALUE with the member's path.
cau_status cau_rpc_params_known(const cau_rpc_message *message, cau_error *error);

// Members that are common to many methods.
typedef struct cau_rpc_envelope {
	bool has_session;             // `session` is present
	char session[CAU_NAME_BYTES]; // the session's id
	bool has_client_sequence;     // `client_sequence` is present
	int64_t client_sequence;      // the client's number of this change
} cau_rpc_envelope;

// Reads only `session` and `client_sequence` from any method's params.
cau_status cau_rpc_envelope_read(const cau_rpc_message *message, cau_rpc_envelope *envelope,
                                 cau_error *error);

// Reads the command of a method that is a command (cau_method_info.command >= 0).
cau_status cau_rpc_command(const cau_rpc_message *message, cau_command *command, cau_error *error);

// Reads the result of an answer to `method`. Error paths start with "result". Unknown members are
// skipped, because the server may be newer.
cau_status cau_rpc_result(const cau_rpc_message *message, cau_method method, void *result,
                          cau_error *error);

// Fills *fault from an error: the code for its status, its path and its reason.
void cau_rpc_fault_of_error(cau_rpc_fault *fault, const cau_error *error);
// Fills *fault from a code and a reason, without a path.
void cau_rpc_fault_of_code(cau_rpc_fault *fault, cau_rpc_error_code code, const char *reason);

// ---- writing ------------------------------------------------------------------------------------
// Writers write into `buffer`, with a closing zero. `bytes` is the length without the zero, even if
// the text did not fit. Errors: CAU_LIMIT (capacity), CAU_BAD_VALUE (a member out of its range,
// text that is not UTF-8).
typedef struct cau_rpc_buffer {
	char *buffer;    // borrowed
	size_t capacity; // size of `buffer`, including the closing zero
	size_t bytes;    // length of the text
} cau_rpc_buffer;

// Writes a request. `params` is the method's C type.
cau_status cau_rpc_write_request(cau_rpc_buffer *out, int64_t id, cau_method method,
                                 const void *params, cau_error *error);
// Writes a notification. `params` is the method's C type.
cau_status cau_rpc_write_notification(cau_rpc_buffer *out, cau_method method, const void *params,
                                      cau_error *error);
// Writes a command. `id` is NULL for a notification. `envelope` may be NULL.
cau_status cau_rpc_write_command(cau_rpc_buffer *out, const int64_t *id,
                                 const cau_rpc_envelope *envelope, const cau_command *command,
                                 cau_error *error);
// Writes an answer. `result` is the C type of the method's result.
cau_status cau_rpc_write_result(cau_rpc_buffer *out, const cau_rpc_id *id, cau_method method,
                                const void *result, cau_error *error);
// Writes an error answer. An `id` of kind NONE is written as null.
cau_status cau_rpc_write_error(cau_rpc_buffer *out, const cau_rpc_id *id,
                               const cau_rpc_fault *fault, cau_error *error);

#ifdef __cplusplus
}
#endif
