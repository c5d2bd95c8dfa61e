// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/courier.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/chunk_codec.h"
#include "cautery/sha256.h"
#include "simulation/promises.h"
#include "simulation/world.h"

// longest wait for one answer, or for a daemon that does not run
#define PATIENCE_NS (10 * SIM_SECOND)
#define LOOK_NS SIM_MS

enum {
	SIDES = 2, // connections of the courier: SOURCE, TARGET
	SOURCE = 0,
	TARGET = 1,
	PIECE_MOST = 5 << 20, // bytes of memory for a piece, which has at most 4 MiB and one record
	PART_ENDS = 1,        // flags of a piece
	ENDS = 2,
};

static struct {
	bool under_way;
	int place, machine[SIDES];
	char id[SIDES][NAME_MOST], move[NAME_MOST];
	char receipt[72];
	unsigned char *piece;
	size_t piece_bytes, piece_got;
} courier;

void courier_begin(void)
{
	memset(&courier, 0, sizeof courier);
	courier.piece = malloc(PIECE_MOST);
	assert(courier.piece);
}

// ---- requests
static bool connect_to(int side)
{
	int client = CLIENTS + side;
	for (int64_t end_ns = sim_now() + PATIENCE_NS; sim_now() < end_ns; sim_sleep(LOOK_NS)) {
		sim_client *c = &sim_clients[client];
		if (c->link && c->machine != courier.machine[side])
			clients_cut(client);
		else if (!c->link)
			clients_connect(client, courier.machine[side]);
		else if (c->greeted)
			return true;
	}
	return false;
}

// Returns the text of the result. Returns NULL after an error, without an answer, or without a
// connection.
static const char *ask_side(int side, const char *method, const char *params)
{
	if (!connect_to(side))
		return NULL;
	uint64_t number = clients_ask(CLIENTS + side, ASK_MOVING, method, -1, -1, false, params);
	int64_t end_ns = sim_now() + PATIENCE_NS;
	while (number && sim_now() < end_ns) {
		const sim_request *r = clients_request(number);
		if (r->answered)
			return r->ok ? r->result : NULL;
		if (!sim_clients[CLIENTS + side].link)
			return NULL;
		sim_sleep(LOOK_NS);
	}
	return NULL;
}

static const char *ask_about(int side, const char *method, const char *more)
{
	char params[512];
	snprintf(params, sizeof params, "\"session\":\"%s\",\"move\":\"%s\"%s", courier.id[side],
	         courier.move, more);
	return ask_side(side, method, params);
}

// ---- pieces
void courier_chunk(int client, const unsigned char *bytes, size_t count)
{
	cau_chunk chunk;
	if (client != CLIENTS + SOURCE || cau_chunk_read(bytes, count, &chunk, NULL))
		return;
	assert(chunk.offset + chunk.byte_count <= PIECE_MOST);
	memcpy(courier.piece + chunk.offset, chunk.data, chunk.byte_count);
	courier.piece_got += chunk.byte_count;
}

static bool read_piece(void)
{
	char bytes[24];
	courier.piece_got = 0;
	const char *result = ask_about(SOURCE, "move.read", "");
	if (!result || !clients_member(result, "byte_count", bytes, sizeof bytes))
		return false;
	courier.piece_bytes = strtoull(bytes, NULL, 10);
	int64_t end_ns = sim_now() + PATIENCE_NS;
	while (courier.piece_got < courier.piece_bytes && sim_now() < end_ns)
		sim_sleep(LOOK_NS);
	return courier.piece_got == courier.piece_bytes;
}

static void send_chunks(uint32_t transfer)
{
	static unsigned char message[CAU_CHUNK_HEADER_BYTES + CAU_CHUNK_BYTES_MAX];
	for (size_t at = 0; at < courier.piece_bytes; at += CAU_CHUNK_BYTES_MAX) {
		size_t left = courier.piece_bytes - at;
		cau_chunk chunk = {.transfer = transfer,
		                   .offset = at,
		                   .data = courier.piece + at,
		                   .byte_count = left < CAU_CHUNK_BYTES_MAX ? left : CAU_CHUNK_BYTES_MAX};
		cau_chunk_header_write(message, &chunk);
		memcpy(message + CAU_CHUNK_HEADER_BYTES, chunk.data, chunk.byte_count);
		sim_client *c = &sim_clients[CLIENTS + TARGET];
		if (c->link)
			sim_link_send(c->link, message, CAU_CHUNK_HEADER_BYTES + chunk.byte_count, true, 0,
			              SIM_MS);
	}
}

static bool send_piece(void)
{
	char params[256], transfer[24], hash[65];
	snprintf(params, sizeof params,
	         "\"name\":\"piece\",\"file_name\":\"piece.caum\",\"byte_count\":%zu",
	         courier.piece_bytes);
	const char *result = ask_side(TARGET, "upload.begin", params);
	if (!result || !clients_member(result, "transfer", transfer, sizeof transfer) ||
	    !cau_sha256(courier.piece, courier.piece_bytes, hash))
		return false;
	send_chunks((uint32_t)strtoul(transfer, NULL, 10));
	snprintf(params, sizeof params, "\"transfer\":%s,\"sha256\":\"%s\"", transfer, hash);
	if (!ask_side(TARGET, "upload.end", params))
		return false;
	result = ask_about(TARGET, "move.receive", ",\"upload\":\"piece\"");
	if (result)
		clients_member(result, "receipt", courier.receipt, sizeof courier.receipt);
	return result;
}

static bool carry(int flag)
{
	do {
		if (!read_piece() || !send_piece())
			return false;
	} while (!(courier.piece[12] & flag));
	return true;
}

// ---- the decision
static bool accept_proof(const char *decision)
{
	char proof[72], more[96];
	if (!clients_member(decision, "proof", proof, sizeof proof))
		return false;
	// From this point on, only the target may serve the session.
	promises_moving(courier.place, courier.machine[TARGET]);
	snprintf(more, sizeof more, ",\"proof\":\"%s\"", proof);
	return ask_about(TARGET, "move.accept", more);
}

static bool walk(void)
{
	char params[256], more[96];
	snprintf(params, sizeof params, "\"session\":\"%s\",\"target\":\"%s\",\"label\":\"%s\"",
	         courier.id[SOURCE], courier.id[TARGET], daemons_label(courier.machine[TARGET]));
	const char *begun = ask_side(SOURCE, "move.begin", params);
	if (!begun || !clients_member(begun, "move", courier.move, sizeof courier.move))
		return false;
	if (!carry(PART_ENDS) || !ask_about(TARGET, "move.ready", "") ||
	    !ask_about(SOURCE, "move.hold", "") || !carry(ENDS))
		return false;
	snprintf(more, sizeof more, ",\"receipt\":\"%s\"", courier.receipt);
	const char *decision = ask_about(SOURCE, "move.commit", more);
	return decision && accept_proof(decision);
}

// Ends a move that was not completed. Returns false while the outcome is open.
static bool settle(void)
{
	char more[128], release[72];
	const char *moves = ask_side(TARGET, "move.list", "");
	if (!moves)
		return false;
	if (!courier.move[0] || !strstr(moves, courier.move))
		// The target knows nothing of the move, or the move is over.
		return true;
	const char *decision = ask_about(SOURCE, "move.cancel", "");
	if (!decision)
		return false;
	if (strstr(decision, "\"moved\":true"))
		return accept_proof(decision);
	if (!clients_member(decision, "release", release, sizeof release))
		return false;
	snprintf(more, sizeof more, ",\"release\":\"%s\"", release);
	return ask_about(TARGET, "move.forget", more);
}

static void *run(void *argument)
{
	(void)argument;
	sim_set_name(sim_self(), "courier");
	bool over = walk();
	promises_counted.moves += over;
	// The loop repeats while a disk is full or a daemon is down.
	for (; !over; sim_sleep(SIM_SECOND / 2))
		over = settle();
	sim_sessions[courier.place].moving = false;
	courier.under_way = false;
	return NULL;
}

void courier_move(int place)
{
	sim_session *moved = &sim_sessions[place];
	if (courier.under_way || !moved->made || !moved->wanted || moved->ephemeral)
		return;
	courier.under_way = moved->moving = true;
	courier.place = place;
	courier.move[0] = courier.receipt[0] = 0;
	courier.machine[SOURCE] = moved->machine;
	courier.machine[TARGET] = !moved->machine;
	for (int side = 0; side < SIDES; side++)
		sim_session_id(place, courier.machine[side], courier.id[side]);
	sim_let_go(sim_start(run, NULL));
}

bool courier_is_idle(void)
{
	return !courier.under_way;
}
