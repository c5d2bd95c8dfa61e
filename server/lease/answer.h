// SPDX-License-Identifier: GPL-3.0-or-later
// Reads etcd's answers from its JSON gateway (v3). The functions are pure and check bytes from
// outside. Unknown members are skipped. Known members must be as etcd writes them: numbers as text,
// keys and values in base64. `text` has a zero behind its bytes.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

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
