// SPDX-License-Identifier: GPL-3.0-or-later
// Proofs between the two daemons of a move. A courier carries them, and need not be trusted. All
// are 64 hex digits; `release`, `seal` and `receipt` are SHA-256 hashes.
//
//     proof    a random number of the source. It shows it once the session is the target's; its
//              hash came with the first piece.
//     release  made of the source's secret and the move's name, so that the source knows it after
//              a restart, too. It shows it once this move can never be decided; its hash came with
//              the first piece.
//     seal     of the pieces so far, a chain. Each piece carries its own at its end.
//     receipt  made of the last seal. The target shows it once all pieces are on its disk.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/sha256.h"

enum { CAU_SEAL_BYTES = CAU_SHA256_TEXT_BYTES - 1 }; // at the end of a piece, without a zero

typedef char cau_move_hash[CAU_SHA256_TEXT_BYTES];

// All return false if memory ran out.

// Whether the hash of `key` is `lock`.
bool cau_move_opens(const char *key, const char *lock);
bool cau_move_release(const char *secret, const char *move, cau_move_hash release);
// The seal after this piece, whose own seal is not among its bytes, from the one before ("": none).
bool cau_move_seal(const char *before, const void *piece, size_t byte_count, cau_move_hash seal);
bool cau_move_receipt(const char *move, const char *seal, cau_move_hash receipt);

// A place after a commit to the disk and before the answer to the courier. Here it does nothing; a
// test puts a function of its own in this one's place, which ends the process there.
void cau_fault_point(const char *name);
