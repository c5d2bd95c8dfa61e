// SPDX-License-Identifier: GPL-3.0-or-later
// Makes and checks the proofs of a move, and answers its courier.
#include "move/courier.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "move/internal.h"

// ---- proofs
bool cau_move_opens(const char *key, const char *lock)
{
	cau_move_hash hash;
	return cau_sha256(key, strlen(key), hash) && strcmp(hash, lock) == 0;
}

// Hashes three texts, each at most as long as a hash.
static bool hash_texts(const char *use, const char *first, const char *second, cau_move_hash hash)
{
	char text[3 * CAU_SHA256_TEXT_BYTES];
	int bytes = snprintf(text, sizeof text, "%s %s %s", use, first, second);
	CAU_ASSERT(bytes > 0 && (size_t)bytes < sizeof text, "%d bytes", bytes);
	return cau_sha256(text, (size_t)bytes, hash);
}

bool cau_move_release(const char *secret, const char *move, cau_move_hash release)
{
	return hash_texts("release", secret, move, release);
}

bool cau_move_seal(const char *before, const void *piece, size_t byte_count, cau_move_hash seal)
{
	cau_move_hash own;
	return cau_sha256(piece, byte_count, own) && hash_texts("seal", before, own, seal);
}

bool cau_move_receipt(const char *move, const char *seal, cau_move_hash receipt)
{
	return hash_texts("receipt", move, seal, receipt);
}

__attribute__((weak)) void cau_fault_point(const char *name)
{
	(void)name;
}

// ---- answers
void cau_move_fail(const cau_reply *reply, cau_status status, int32_t code, const char *path,
                   const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, path, "%s", reason);
	cau_reply_fail(reply, &error, code);
}

void cau_move_answer(const cau_reply *reply, const void *result)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	// Without a receiver no client waits for an answer, and the method that would name the answer
	// is unknown.
	if (!reply->answer)
		return;
	char *text = cau_answer_text(reply->method, result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	free(text);
}

void cau_move_decided(const cau_reply *reply, const cau_tombstone *moved)
{
	cau_wire_move_decision result = {.moved = true, .has_target = true, .has_proof = true};
	memcpy(result.target, moved->to.session, sizeof result.target);
	memcpy(result.proof, moved->proof, sizeof result.proof);
	cau_move_answer(reply, &result);
}

void cau_move_kept(const cau_reply *reply, const char *release)
{
	cau_wire_move_decision result = {.moved = false, .has_release = true};
	snprintf(result.release, sizeof result.release, "%s", release);
	cau_move_answer(reply, &result);
}
