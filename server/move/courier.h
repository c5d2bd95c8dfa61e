// SPDX-License-Identifier: GPL-3.0-or-later
// Proofs that the source and the target of a move give each other. A courier carries them and need
// not be trusted. All are 64 hex digits; `release`, `seal` and `receipt` are SHA-256 hashes.
//
//     proof    a random number of the source. The source shows it once the session belongs to the
//              target. Its hash came with the first piece.
//     release  made of the source's secret and the move's name, so that the source can make it
//              after a restart, too. The source shows it once this move can never be decided. Its
//              hash came with the first piece.
//     seal     a chained hash of the pieces so far. Each piece carries its own seal at its end.
//     receipt  made of the last seal. The target shows it once all pieces are on its disk.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/sha256.h"

// length of the seal at the end of a piece, without a terminating zero
enum { CAU_SEAL_BYTES = CAU_SHA256_TEXT_BYTES - 1 };

typedef char cau_move_hash[CAU_SHA256_TEXT_BYTES];

// The next four functions return false if memory runs out.

// True if the hash of `key` is `lock`.
bool cau_move_opens(const char *key, const char *lock);
bool cau_move_release(const char *secret, const char *move, cau_move_hash release);
// Computes the seal of this piece. `before` is the seal of the previous piece, or "" for the first.
// The seal at the end of `piece` is not among its `byte_count` bytes.
bool cau_move_seal(const char *before, const void *piece, size_t byte_count, cau_move_hash seal);
bool cau_move_receipt(const char *move, const char *seal, cau_move_hash receipt);

// Called at points after a commit to the disk and before the answer to the courier. This definition
// does nothing. A test replaces it by a function that ends the process there.
void cau_fault_point(const char *name);
