// SPDX-License-Identifier: GPL-3.0-or-later
// The settings of cauteryd, from one table. Flags override the environment, which overrides a JSON
// file, which overrides the defaults.
//
//     setting `max_sessions`: flag --max-sessions 8, environment CAUTERY_MAX_SESSIONS=8,
//     file {"max_sessions": 8}
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>

#include "cautery/message_choices.h"
#include "cautery/status.h"

enum { CAU_CONFIG_TEXT_BYTES = 512 };

// TEXT(name, default, meaning) INTEGER(name, default, least, most, meaning)
// REAL(name, default, least, most, meaning) SWITCH(name, default, meaning)
#define CAU_CONFIG_TABLE(TEXT, INTEGER, REAL, SWITCH)                                              \
	TEXT(listen, "127.0.0.1",                                                                      \
	     "address to listen on; other addresses than loopback need tokens and TLS")                \
	INTEGER(port, 8740, 0, 65535, "port of HTTP and WebSocket; 0: any free port")                  \
	INTEGER(agent_port, 0, 0, 65535, "port of HAProxy's agent-check, at `listen`; 0: none")        \
	TEXT(store, "cautery.db", "file of the store")                                                 \
	TEXT(backups, "", "folder of the store's copies; empty: `backups` beside the store")           \
	TEXT(scenes, "", "folder of named scenes; empty: the installed one")                           \
	TEXT(viewer, "", "folder of viewer files to serve; empty: the installed one")                  \
	TEXT(manual, "", "folder of the manual to serve at /manual/; empty: the installed one")        \
	TEXT(label, "d1",                                                                              \
	     "label of this daemon, with which the ids of its sessions begin; without `-`")            \
	TEXT(etcd, "", "addresses of etcd (http://HOST:PORT,...), which allows each label one daemon") \
	REAL(etcd_ttl_s, 15, 2, 3600,                                                                  \
	     "etcd frees the label if the daemon does not renew it for this time")                     \
	SWITCH(take_label, false, "serve this store although etcd has a newer store of this label")    \
	TEXT(demo, "",                                                                                 \
	     "scene of a session that starts with the daemon if the store has none of this scene")     \
	TEXT(tokens, "", "file of access tokens, one in each line; empty: every client is admin")      \
	TEXT(tls_certificate, "", "file of the certificate and its chain (PEM); empty: no TLS")        \
	TEXT(tls_key, "", "file of the certificate's key (PEM)")                                       \
	SWITCH(tls_by_proxy, false,                                                                    \
	       "allow plain HTTP on other addresses, because a proxy terminates TLS")                  \
	TEXT(trusted_proxies, "", "proxies whose X-Forwarded-For is trusted, separated by commas")     \
	TEXT(hosts, "", "further accepted Host names, separated by commas")                            \
	TEXT(origins, "", "further accepted Origins, separated by commas")                             \
	TEXT(log_level, "info", "lowest level that is logged: debug, info, notice, warning, error")    \
	TEXT(log_format, "text", "format of log lines: text (key=value) or json")                      \
	TEXT(trace_session, "", "folder for a trace of each session's decisions; empty: none")         \
	INTEGER(workers, 0, 0, 256, "threads that compute steps; 0: one for each core")                \
	INTEGER(session_threads, 1, 1, 16, "largest number of threads for a step of one session")      \
	INTEGER(max_sessions, 64, 1, 4096, "largest number of sessions")                               \
	INTEGER(max_session_vertices, 4000000, 3, 100000000,                                           \
	        "largest number of vertices of a session")                                             \
	INTEGER(max_session_elements, 16000000, 1, 1000000000,                                         \
	        "largest number of elements of a session")                                             \
	INTEGER(max_session_bytes, 4000000000, 1000000, 1000000000000,                                 \
	        "largest estimated memory of a session, bytes")                                        \
	INTEGER(max_sessions_bytes, 16000000000, 1000000, 1000000000000,                               \
	        "largest estimated memory of all sessions, bytes")                                     \
	INTEGER(look_bytes, 67108864, 0, 1000000000000,                                                \
	        "bytes of stored states that a session keeps for past views")                          \
	INTEGER(max_connections, 1024, 1, 65536, "largest number of WebSocket connections")            \
	INTEGER(max_subscribers, 128, 1, 4096, "largest number of streams of a session")               \
	INTEGER(max_message_bytes, 1048576, 4096, 67108864, "largest message of a client, bytes")      \
	INTEGER(max_upload_bytes, 67108864, 1024, 1073741824, "largest uploaded mesh, bytes")          \
	INTEGER(max_connection_upload_bytes, 134217728, 65536, 17179869184,                            \
	        "largest size of all uploads of one connection, bytes")                                \
	INTEGER(max_all_upload_bytes, 536870912, 65536, 1099511627776,                                 \
	        "largest size of all uploads together, bytes")                                         \
	INTEGER(mesh_memory_mb, 2048, 64, 1000000,                                                     \
	        "memory to fill one uploaded surface with tetrahedra, MB")                             \
	INTEGER(mesh_time_s, 20, 1, 3600,                                                              \
	        "processor time to fill one uploaded surface with tetrahedra, s")                      \
	INTEGER(max_requests_per_s, 2000, 1, 1000000,                                                  \
	        "largest number of messages of one client in a second")                                \
	INTEGER(queue_commands, 256, 8, 65536, "capacity of a session's queue of commands")            \
	INTEGER(queue_reads, 64, 8, 65536,                                                             \
	        "largest number of waiting requests that only read a session")                         \
	INTEGER(quota_connection, 120, 1, 1000000,                                                     \
	        "largest number of expensive requests of one connection a minute")                     \
	INTEGER(quota_address, 600, 1, 1000000,                                                        \
	        "largest number of expensive requests of one address a minute")                        \
	INTEGER(quota_view, 300, 1, 1000000,                                                           \
	        "largest number of expensive requests of all viewers a minute")                        \
	INTEGER(quota_operate, 1200, 1, 1000000,                                                       \
	        "largest number of expensive requests of all operators a minute")                      \
	INTEGER(quota_admin, 1200, 1, 1000000,                                                         \
	        "largest number of expensive requests of all admins a minute")                         \
	INTEGER(quota_all, 2400, 1, 1000000,                                                           \
	        "largest number of expensive requests of all clients a minute")                        \
	INTEGER(subscriber_bytes, 196608, 16384, 16777216,                                             \
	        "bytes of frames that may be on the way to one subscriber")                            \
	REAL(hello_timeout_s, 5, 0.05, 60, "time after which a connection without hello is closed")    \
	REAL(browser_deadline_s, 0.25, 0.02, 10,                                                       \
	     "silence of a WebSocket driver after which energy goes off")                              \
	REAL(resume_s, 10, 0, 600,                                                                     \
	     "time for which a client keeps its tools after its connection was lost")                  \
	REAL(ping_s, 10, 0.5, 3600,                                                                    \
	     "silence before a ping; after three unanswered pings the connection closes")              \
	REAL(slow_close_s, 30, 1, 3600,                                                                \
	     "a connection closes if it takes no frame of its stream for this time")                   \
	REAL(checkpoint_s, 10, 0.1, 3600, "time between checkpoints of a driven session")              \
	REAL(retention_h, 24, 0.01, 8760, "time for which the branches before a rewind are kept")      \
	INTEGER(retention_bytes, 1073741824, 1048576, 1099511627776,                                   \
	        "largest size of a session in the store, bytes")                                       \
	INTEGER(store_bytes, 17179869184, 0, 1125899906842624,                                         \
	        "largest size of the store with all tables, bytes; 0: no limit")                       \
	INTEGER(ephemeral_bytes, 1073741824, 1048576, 1099511627776,                                   \
	        "largest memory for the history of all ephemeral sessions, bytes")                     \
	REAL(drain_s, 10, 0.1, 600, "longest wait for checkpoints at shutdown")                        \
	SWITCH(dds, false, "also serve clients over DDS")                                              \
	INTEGER(dds_domain, 0, 0, 230, "DDS domain")                                                   \
	TEXT(dds_config, "", "file of Cyclone DDS settings; empty: loopback only")                     \
	TEXT(dds_security, "", "folder of this daemon's DDS identity; empty: no DDS Security")         \
	SWITCH(dds_optional, false, "if DDS cannot be opened, start with WebSocket only")              \
	SWITCH(dds_network, false,                                                                     \
	       "allow DDS on other networks without DDS Security, if the network is guarded")          \
	TEXT(dds_role, "operate", "role of DDS participants: view, operate or admin")                  \
	TEXT(dds_roles, "", "file of roles of DDS Security identities, `ROLE SUBJECT` in each line")   \
	REAL(dds_deadline_s, 0.25, 0.02, 1, "silence of a DDS driver after which energy goes off")

#define CAU_CONFIG_TEXT(name, default_, meaning) char name[CAU_CONFIG_TEXT_BYTES];
#define CAU_CONFIG_INTEGER(name, default_, least, most, meaning) int64_t name;
#define CAU_CONFIG_REAL(name, default_, least, most, meaning) double name;
#define CAU_CONFIG_SWITCH(name, default_, meaning) bool name;

typedef struct cau_config {
	CAU_CONFIG_TABLE(CAU_CONFIG_TEXT, CAU_CONFIG_INTEGER, CAU_CONFIG_REAL, CAU_CONFIG_SWITCH)
} cau_config;

#undef CAU_CONFIG_TEXT
#undef CAU_CONFIG_INTEGER
#undef CAU_CONFIG_REAL
#undef CAU_CONFIG_SWITCH

// The requests of the command line besides settings.
typedef struct cau_config_request {
	bool help, version, json, print_config, settings_schema;
	const char *backup; // file for a copy of the store; NULL: no copy is requested
} cau_config_request;

void cau_config_default(cau_config *config);

// Sets one setting from text, as flags, environment and file do. CAU_NOT_FOUND: there is no such
// setting; CAU_BAD_VALUE: wrong type or out of range.
cau_status cau_config_set(cau_config *config, const char *name, const char *text, cau_error *error);

// Reads a JSON object of settings. `text` has a zero behind its `bytes` bytes.
cau_status cau_config_read_text(cau_config *config, const char *text, size_t bytes,
                                cau_error *error);
// Reads a JSON object of settings from a file of at most 64 KiB.
cau_status cau_config_read_file(cau_config *config, const char *file, cau_error *error);

// Reads every CAUTERY_* variable of an environment that ends with NULL. CAUTERY_CONFIG,
// CAUTERY_MESHES and CAUTERY_JOBS are not settings.
cau_status cau_config_read_environment(cau_config *config, char *const *environment,
                                       cau_error *error);

// Reads all settings in order: defaults, file (--config or CAUTERY_CONFIG), environment, flags.
// Then checks conditions between several settings.
cau_status cau_config_load(cau_config *config, cau_config_request *request, int argument_count,
                           char *const *arguments, char *const *environment, cau_error *error);

// Writes the settings as one JSON object.
void cau_config_print(const cau_config *config, FILE *stream);
// Writes a JSON Schema (2020-12) of the file that --config reads: types, bounds, defaults,
// meanings.
void cau_config_schema(FILE *stream);
// Writes the usage text.
void cau_config_help(FILE *stream);

// ---- roles
// The words for roles in settings and files: view, operate, admin.

const char *cau_role_word(cau_role role);
// Returns false if the word names no role; *role then stays unchanged.
bool cau_role_read(const char *word, cau_role *role);

// ---- files that a setting names
// Tokens, certificate and key, roles, settings, scenes. They are read at the start and at a signal,
// by a thread that must not block. So only regular files of bounded size are opened: a FIFO would
// wait for a writer, and a device may never end.

enum {
	CAU_NAMED_FILE_REASON_BYTES = 96,
	CAU_NAMED_FILE_BYTES =
		1 << 20, // limit for tokens, keys and roles, far more than such files need
};

// Opens a regular file of at most `most_bytes` for reading. `info` may be NULL. On failure returns
// NULL; `reason` then is the end of "cannot read FILE: ...".
FILE *cau_named_file_open(const char *path, int64_t most_bytes, struct stat *info,
                          char reason[CAU_NAMED_FILE_REASON_BYTES]);
