// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/network.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "simulation/disk.h"
#include "simulation/faults.h"
#include "simulation/scheduler.h"

#define TICK_NS (100 * SIM_MS)  // interval of the handler's `tick`, the same as in the real network
#define WAITED_NS (20 * SIM_MS) // the same as WAITED_S of the real network

struct sim_link {
	cau_connection connection; // must be first: a pointer to it is converted to the link
	void *client;
	int64_t open_ns;  // time when the link's request arrives
	int64_t empty_ns; // time when no message was waiting
	int64_t due_ns;   // time at which the present message could have been read
	bool opened, lost, wants_frame, reads;
	int frames_a_round;
	sim_message *first, *last;
	struct sim_link *next_new;
};

struct cau_network {
	cau_network_def def;
	int machine;
	pthread_t thread;
	bool started, ending;
	atomic_bool woken;
	cau_close_code ending_code;
	uint64_t last_id;
	cau_connection *connections;
	sim_link *arriving; // links whose request has not arrived
	int64_t tick_ns;
	cau_network_counts counts;
};

static struct {
	sim_end end;
	cau_network *networks[DISK_MACHINES];
} net;

void sim_network_begin(const sim_end *end)
{
	memset(&net, 0, sizeof net);
	net.end = *end;
}

static sim_link *link_of(cau_connection *connection)
{
	return (sim_link *)connection;
}

// ---- the client's end
sim_link *sim_link_open(int machine, void *client, int64_t delay_ns)
{
	cau_network *network = net.networks[machine];
	if (!network || network->ending)
		return NULL;
	sim_link *link = calloc(1, sizeof *link);
	assert(link);
	link->connection.network = network;
	link->client = client;
	link->open_ns = sim_now() + delay_ns;
	link->reads = true;
	link->frames_a_round = 16;
	link->next_new = network->arriving;
	network->arriving = link;
	sim_wake_all(network);
	return link;
}

void sim_link_send(sim_link *link, const void *text, size_t bytes, bool binary, uint64_t tag,
                   int64_t delay_ns)
{
	int64_t due_ns = sim_now() + delay_ns;
	sim_message *message = malloc(sizeof *message + bytes + 1);
	assert(message);
	if (link->last && due_ns < link->last->due_ns)
		due_ns = link->last->due_ns;
	if (due_ns < link->open_ns)
		due_ns = link->open_ns;
	*message = (sim_message){
		.sent_ns = sim_now(), .due_ns = due_ns, .tag = tag, .binary = binary, .bytes = bytes};
	memcpy(message->text, text, bytes);
	message->text[bytes] = 0;
	*(link->first ? &link->last->next : &link->first) = message;
	link->last = message;
	sim_wake_all(link->connection.network);
}

void sim_link_cut(sim_link *link)
{
	link->lost = true;
	sim_wake_all(link->connection.network);
}

void sim_link_read(sim_link *link, bool reads, int frames)
{
	link->reads = reads;
	link->frames_a_round = frames;
	sim_wake_all(link->connection.network);
}

size_t sim_link_waiting(const sim_link *link)
{
	return link->connection.output.bytes;
}

// ---- one round of the network thread
static void unlink_connection(cau_network *network, cau_connection *c)
{
	*(c->previous ? &c->previous->next : &network->connections) = c->next;
	if (c->next)
		c->next->previous = c->previous;
}

static void drop_queues(sim_link *link)
{
	for (sim_message *next; link->first; link->first = next) {
		next = link->first->next;
		free(link->first);
	}
	for (cau_buffer *next; link->connection.output.first; link->connection.output.first = next) {
		next = link->connection.output.first->next;
		cau_buffer_release(link->connection.output.first);
	}
}

static void end_link(cau_network *network, sim_link *link, int code)
{
	network->def.handler.closed(network->def.handler.user, &link->connection);
	unlink_connection(network, &link->connection);
	void *client = link->client;
	drop_queues(link);
	free(link);
	net.end.closed(client, code);
}

static void admit(cau_network *network, sim_link *link)
{
	cau_connection *c = &link->connection;
	c->id = ++network->last_id;
	c->opened_s = c->input.heard_s = cau_monotonic_s();
	snprintf(c->address, sizeof c->address, "127.0.0.1");
	c->next = network->connections;
	if (c->next)
		c->next->previous = c;
	network->connections = c;
	link->opened = true;
	// No message was sent before the link opened.
	link->empty_ns = link->open_ns;
	network->counts.accepted++;
	bool opened = network->def.handler.opened(network->def.handler.user, c, "");
	assert(opened);
	(void)opened;
}

static void admit_arrived(cau_network *network, int64_t now_ns)
{
	for (sim_link **at = &network->arriving; *at;) {
		sim_link *link = *at;
		if (link->open_ns > now_ns) {
			at = &link->next_new;
			continue;
		}
		*at = link->next_new;
		admit(network, link);
	}
}

static void read_one(cau_network *network, sim_link *link)
{
	const cau_network_handler *handler = &network->def.handler;
	sim_message *message = link->first;
	link->first = message->next;
	if (!link->first)
		link->last = NULL;
	link->due_ns = message->due_ns;
	net.end.arriving(link->client, message);
	if (message->binary)
		handler->binary(handler->user, &link->connection, message->text, message->bytes);
	else
		handler->text(handler->user, &link->connection, message->text, message->bytes);
	network->counts.messages_in++;
	net.end.arrived(link->client, message);
	free(message);
}

static void write_replies(sim_link *link)
{
	cau_connection *c = &link->connection;
	while (link->reads && c->output.first) {
		cau_buffer *buffer = c->output.first;
		c->output.first = buffer->next;
		if (!c->output.first)
			c->output.last = NULL;
		c->output.bytes -= buffer->byte_count;
		net.end.text(link->client, (const char *)cau_buffer_bytes(buffer), buffer->byte_count);
		cau_buffer_release(buffer);
	}
}

static void write_frames(cau_network *network, sim_link *link)
{
	const cau_network_handler *handler = &network->def.handler;
	for (int i = 0; link->wants_frame && link->reads && i < link->frames_a_round; i++) {
		cau_buffer *frame = handler->next_frame(handler->user, &link->connection);
		link->wants_frame = frame != NULL;
		if (frame)
			net.end.frame(link->client, cau_buffer_bytes(frame), frame->byte_count);
		cau_buffer_release(frame);
	}
}

// Serves a link. Returns false if the connection has ended.
static bool serve_link(cau_network *network, sim_link *link, int64_t now_ns)
{
	cau_connection *c = &link->connection;
	while (!link->lost && !c->end.code && link->first && link->first->due_ns <= now_ns)
		read_one(network, link);
	link->empty_ns = now_ns;
	if (link->lost) {
		end_link(network, link, 0);
		return false;
	}
	write_replies(link);
	if (c->end.code && (!link->reads || !c->output.first)) {
		end_link(network, link, c->end.code);
		return false;
	}
	if (!c->end.code)
		write_frames(network, link);
	return true;
}

static int64_t next_due(const cau_network *network)
{
	int64_t due_ns = network->tick_ns;
	for (const sim_link *l = network->arriving; l; l = l->next_new)
		due_ns = l->open_ns < due_ns ? l->open_ns : due_ns;
	for (cau_connection *c = network->connections; c; c = c->next) {
		const sim_link *link = link_of(c);
		if (link->first && link->first->due_ns < due_ns)
			due_ns = link->first->due_ns;
		if (link->lost || (link->wants_frame && link->reads))
			due_ns = sim_now();
	}
	return due_ns;
}

static void go_round(cau_network *network)
{
	const cau_network_handler *handler = &network->def.handler;
	int64_t now_ns = sim_now();
	if (atomic_exchange(&network->woken, false))
		handler->woken(handler->user);
	admit_arrived(network, now_ns);
	for (cau_connection *c = network->connections, *next; c; c = next) {
		next = c->next;
		serve_link(network, link_of(c), now_ns);
	}
	if (now_ns >= network->tick_ns) {
		network->tick_ns = now_ns + TICK_NS;
		handler->tick(handler->user);
	}
}

static void *live(void *argument)
{
	cau_network *network = argument;
	sim_set_name(sim_self(), "cautery-net");
	network->tick_ns = sim_now();
	while (!network->ending) {
		go_round(network);
		int64_t due_ns = next_due(network);
		if (!network->woken && !network->ending && due_ns > sim_now())
			sim_wait(network, due_ns);
		sim_point();
	}
	while (network->connections) {
		write_replies(link_of(network->connections));
		end_link(network, link_of(network->connections), (int)network->ending_code);
	}
	return NULL;
}

// ---- functions that the daemon calls
cau_status cau_network_create(cau_network **made, const cau_network_def *def, cau_error *error)
{
	(void)error;
	cau_network *network = calloc(1, sizeof *network);
	assert(network);
	network->def = *def;
	network->machine = sim_machine();
	*made = network;
	return CAU_OK;
}

cau_status cau_network_start(cau_network *network, cau_error *error)
{
	(void)error;
	network->started = pthread_create(&network->thread, NULL, live, network) == 0;
	net.networks[network->machine] = network;
	return CAU_OK;
}

void cau_network_wake(cau_network *network)
{
	network->woken = true;
	sim_wake_all(network);
}

void cau_network_stop(cau_network *network, cau_close_code code, double seconds)
{
	(void)seconds;
	net.networks[network->machine] = NULL;
	network->ending_code = code;
	network->ending = true;
	sim_wake_all(network);
	if (network->started)
		pthread_join(network->thread, NULL);
	network->started = false;
}

cau_status cau_network_reload_tls(cau_network *network, cau_error *error)
{
	(void)network, (void)error;
	return CAU_OK;
}

void cau_network_destroy(cau_network *network)
{
	while (network && network->arriving) {
		sim_link *link = network->arriving;
		void *client = link->client;
		network->arriving = link->next_new;
		drop_queues(link);
		free(link);
		net.end.closed(client, 0);
	}
	free(network);
}

cau_connection *cau_network_first(cau_network *network)
{
	return network->connections;
}

cau_connection *cau_network_find(cau_network *network, uint64_t id)
{
	cau_connection *c = network->connections;
	while (c && c->id != id)
		c = c->next;
	return c && !c->end.code ? c : NULL;
}

cau_network_counts cau_network_count(cau_network *network)
{
	return network->counts;
}

bool cau_connection_has_place(const cau_connection *connection, bool resumes)
{
	(void)connection, (void)resumes;
	return true;
}

void cau_connection_serve(cau_connection *connection, cau_role role)
{
	(void)role;
	connection->served = true;
}

double cau_connection_sent_after_s(const cau_connection *connection, double now_s)
{
	const sim_link *link = (const sim_link *)connection;
	int64_t now_ns = sim_now();
	bool waited = now_ns - link->due_ns > WAITED_NS && !faults_act(FAULT_stop_not_seen, 1);
	return waited ? now_s - 1e-9 * (double)(now_ns - link->empty_ns) : now_s;
}

void cau_connection_send(cau_connection *c, cau_buffer *buffer)
{
	if (!buffer || c->end.code) {
		cau_buffer_release(buffer);
		return;
	}
	buffer->next = NULL;
	*(c->output.last ? &c->output.last->next : &c->output.first) = buffer;
	c->output.last = buffer;
	c->output.bytes += buffer->byte_count;
	link_of(c)->wants_frame = true; // a socket that accepts replies is also asked for frames
	if (c->output.bytes > CAU_CONTROL_BYTES_MAX)
		cau_connection_close(c, CAU_CLOSE_TOO_SLOW, NULL);
}

void cau_connection_want_frame(cau_connection *connection)
{
	link_of(connection)->wants_frame = true;
}

void cau_connection_close(cau_connection *connection, cau_close_code code, const char *reason)
{
	(void)reason;
	if (!connection->end.code)
		connection->end.code = (int)code;
}

void cau_connection_close_late(cau_connection *connection, cau_close_code code)
{
	cau_connection_close(connection, code, NULL);
}

// ---- death of a machine
void sim_network_kill(int machine)
{
	cau_network *network = net.networks[machine];
	net.networks[machine] = NULL;
	for (cau_connection *c = network ? network->connections : NULL, *next; c; c = next) {
		next = c->next;
		net.end.closed(link_of(c)->client, 0);
	}
	for (sim_link *l = network ? network->arriving : NULL; l; l = l->next_new)
		net.end.closed(l->client, 0);
}
