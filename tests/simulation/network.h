// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's network: a double of server/transport_ws. A connection is a queue of whole
// messages with a delay. Messages are delivered in order, and no message is delivered after a cut.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "transport_ws/network.h"

typedef struct sim_link sim_link;

typedef struct sim_message {
	struct sim_message *next;
	int64_t sent_ns, due_ns;
	uint64_t tag; // a number that the client chooses
	bool binary;
	size_t bytes;
	char text[];
} sim_message;

// Callbacks of the client's end of a connection. They run on the daemon's network thread. After
// `closed`, no callback is called.
typedef struct sim_end {
	// the daemon is about to read the message
	void (*arriving)(void *client, const sim_message *message);
	void (*arrived)(void *client, const sim_message *message); // the daemon has read the message
	void (*text)(void *client, const char *text, size_t bytes);
	void (*frame)(void *client, const unsigned char *bytes, size_t count);
	void (*closed)(void *client, int code); // code 0: the connection was lost
} sim_end;

void sim_network_begin(const sim_end *end);
// Kills the machine's network and its connections, and calls `closed` of each client.
void sim_network_kill(int machine);

// Opens a connection. Returns NULL if no daemon accepts connections on this machine.
sim_link *sim_link_open(int machine, void *client, int64_t delay_ns);
// Sends a message. `text` is copied.
void sim_link_send(sim_link *link, const void *text, size_t bytes, bool binary, uint64_t tag,
                   int64_t delay_ns);
// Cuts the connection: messages under way do not arrive. `closed` is called when the daemon has
// noticed the cut.
void sim_link_cut(sim_link *link);
// Sets whether the client reads, and the largest number of frames in a round of the network.
void sim_link_read(sim_link *link, bool reads, int frames);
// Returns the bytes of replies that wait for the client.
size_t sim_link_waiting(const sim_link *link);
