// SPDX-License-Identifier: GPL-3.0-or-later
// Requests to etcd by its JSON gateway (v3) over HTTP, and its answers.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

// ---- answers (answer.c) -------------------------------------------------------------------------
// Reads etcd's answers from its JSON gateway (v3). The functions are pure and check bytes from
// outside. Unknown members are skipped. Known members must be as etcd writes them: numbers as text,
// keys and values in base64. `text` has a zero behind its bytes.

enum {
	CAU_ETCD_ANSWER_BYTES = 16384, // ten times the longest expected answer
	CAU_ETCD_VALUE_BYTES = 256,
};

typedef struct cau_etcd_lease {
	int64_t id;
	double ttl_s; // 0: the lease does not exist any more
} cau_etcd_lease;

// Reads the answer of lease/grant ({"ID": "..", "TTL": ".."}) or lease/keepalive (the same in
// "result"). An answer of keepalive without a TTL means that the lease is gone. Errors:
// CAU_CORRUPT.
cau_status cau_etcd_read_lease(const char *text, size_t bytes, cau_etcd_lease *lease,
                               cau_error *error);

typedef struct cau_etcd_value {
	bool is_there;
	int64_t revision; // revision of the last change; 0: the key is not there
	int64_t lease;    // the key's lease; 0: no lease
	size_t bytes;
	char text[CAU_ETCD_VALUE_BYTES];
} cau_etcd_value;

// Reads the answer of kv/range: the value of each of `count` keys, which are plain text. Errors:
// CAU_CORRUPT.
cau_status cau_etcd_read_values(const char *text, size_t bytes, const char *const *keys,
                                cau_etcd_value *values, size_t count, cau_error *error);

// Reads the answer of kv/txn: *success: its conditions held. Errors: CAU_CORRUPT.
cau_status cau_etcd_read_success(const char *text, size_t bytes, bool *success, cau_error *error);

// ---- requests -----------------------------------------------------------------------------------
// Sends requests to etcd by its JSON gateway over HTTP. Each request goes to one of several
// addresses, and has one answer and a time limit. The caller waits, so only the daemon's start and
// the lease's thread call these functions.

typedef struct cau_etcd cau_etcd;

// Makes a client of etcd. `addresses`: "http://10.0.0.21:2379,http://10.0.0.22:2379"; the text is
// copied. One thread at a time uses the client. Errors: CAU_BAD_VALUE, CAU_NO_MEMORY.
cau_status cau_etcd_create(cau_etcd **etcd, const char *addresses, cau_error *error);
void cau_etcd_destroy(cau_etcd *etcd); // `etcd` may be NULL

// Ask etcd about leases. Every request goes to the address that answered last. CAU_IO: the address
// did not answer within `limit_s`, or answered with an error. CAU_CORRUPT: the answer cannot be
// read. After either, the next request goes to the next address.
cau_status cau_etcd_grant(cau_etcd *etcd, double ttl_s, double limit_s, cau_etcd_lease *lease,
                          cau_error *error);
cau_status cau_etcd_renew(cau_etcd *etcd, int64_t id, double limit_s, cau_etcd_lease *lease,
                          cau_error *error);
cau_status cau_etcd_revoke(cau_etcd *etcd, int64_t id, double limit_s, cau_error *error);

// The two keys of a label: a common beginning, then one of two names.
enum { CAU_ETCD_KEY_BYTES = 96 };
typedef struct cau_etcd_keys {
	char generation[CAU_ETCD_KEY_BYTES], holder[CAU_ETCD_KEY_BYTES];
} cau_etcd_keys;
// Fills *keys with "cautery/LABEL/generation" and "cautery/LABEL/holder".
void cau_etcd_name_keys(const char *label, cau_etcd_keys *keys);

cau_status cau_etcd_read(cau_etcd *etcd, const cau_etcd_keys *keys, double limit_s,
                         cau_etcd_value *generation, cau_etcd_value *holder, cau_error *error);
// Writes both keys if neither key has changed since they were read. The holder is bound to the
// lease. *taken: both keys were written.
cau_status cau_etcd_claim(cau_etcd *etcd, const cau_etcd_keys *keys,
                          const cau_etcd_value *generation, const cau_etcd_value *holder,
                          const char *new_generation, const char *new_holder, int64_t lease,
                          double limit_s, bool *taken, cau_error *error);
