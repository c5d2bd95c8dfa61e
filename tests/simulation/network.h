// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's network: a double of server/transport_ws. Connections are queues of whole
// messages with a delay. What a message says is delivered in order, and nothing after a cut.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "transport_ws/network.h"

typedef struct sim_link sim_link;

typedef struct sim_message {
	struct sim_message *next;
	int64_t sent_ns, due_ns;
	uint64_t tag; // the client's own
	bool binary;
	size_t bytes;
	char text[];
} sim_message;

// Callbacks of a client's end of a connection, on the network thread of the daemon. None is called
// after `closed`.
typedef struct sim_end {
	void (*arriving)(void *client, const sim_message *message); // the daemon is about to read it
	void (*arrived)(void *client, const sim_message *message);  // and has
	void (*text)(void *client, const char *text, size_t bytes);
	void (*frame)(void *client, const unsigned char *bytes, size_t count);
	void (*closed)(void *client, int code); // 0: lost
} sim_end;

void sim_network_begin(const sim_end *end);
// Ends the machine's network and its connections, and calls `closed` of each client.
void sim_network_kill(int machine);

// NULL: no daemon accepts connections on this machine.
sim_link *sim_link_open(int machine, void *client, int64_t delay_ns);
// `text` is copied.
void sim_link_send(sim_link *link, const void *text, size_t bytes, bool binary, uint64_t tag,
                   int64_t delay_ns);
// The connection is lost: what is under way does not arrive. The client is told `closed` when the
// daemon has noticed.
void sim_link_cut(sim_link *link);
// Whether its client takes what comes, and how many frames at most a round of the network.
void sim_link_read(sim_link *link, bool reads, int frames);
// Bytes of replies that wait for the client.
size_t sim_link_waiting(const sim_link *link);
