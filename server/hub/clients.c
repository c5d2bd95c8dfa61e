// SPDX-License-Identifier: GPL-3.0-or-later
// The clients of the hub. A client is kept for a while after its connection is lost, so that it can
// return to its tools.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "cautery/assert.h"
#include "cautery/sha256.h"
#include "hub/internal.h"

enum { CLIENTS_MOST = 1 << 20, OWNER_MOST_BYTES = 512 };

// Makes new random bytes in hex at every call. A client_id must reveal nothing about the secret
// token.
static bool make_random(char hex[CAU_RESUME_BYTES])
{
	unsigned char bytes[(CAU_RESUME_BYTES - 1) / 2];
	if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
		return false;
	for (size_t i = 0; i < sizeof bytes; i++)
		snprintf(hex + 2 * i, 3, "%02x", bytes[i]);
	return true;
}

bool cau_hub_bind_client_id(char client_id[65], const char *owner)
{
	char both[OWNER_MOST_BYTES + 65];
	if (!*owner)
		return true;
	// Neither text contains a zero, so the zero between them makes each pair distinct.
	int at = snprintf(both, OWNER_MOST_BYTES, "%s", owner) + 1;
	int bytes = snprintf(both + at, 65, "%.64s", client_id);
	bool bound = cau_sha256(both, (size_t)at + (size_t)bytes, client_id);
	if (!bound)
		*client_id = 0;
	return bound;
}

// True if a client that resumes keeps its earlier client_id. A request that is sent again then acts
// once.
static bool keeps_client_id(const cau_client *client, const cau_client *kept)
{
	return *kept->asker.client_id &&
	       (!*client->said_id || !*kept->said_id || strcmp(client->said_id, kept->said_id) == 0);
}

// Gives an id to a client that sends none, to distinguish the client's requests from those of other
// clients.
static bool fill_client_id(cau_client *client, const cau_client *kept)
{
	cau_asker *asker = &client->asker;
	char hex[CAU_RESUME_BYTES];
	if (keeps_client_id(client, kept)) {
		const char *said = *kept->said_id ? kept->said_id : kept->asker.client_id;
		if (!*client->said_id)
			snprintf(client->said_id, sizeof client->said_id, "%s", said);
		memcpy(asker->client_id, kept->asker.client_id, sizeof asker->client_id);
		return true;
	}
	if (*asker->client_id)
		return true;
	if (!*client->said_id) {
		if (!make_random(hex))
			return false;
		snprintf(client->said_id, sizeof client->said_id, "made-%s", hex);
	}
	memcpy(asker->client_id, client->said_id, sizeof asker->client_id);
	return cau_hub_bind_client_id(asker->client_id, client->owner);
}

static cau_client *find_number(cau_hub *hub, uint32_t number)
{
	for (int32_t i = 0; i < hub->client_count; i++)
		if (hub->clients[i].asker.client == number)
			return &hub->clients[i];
	return NULL;
}

static cau_client *find_token(cau_hub *hub, const char *token)
{
	if (!token || !*token)
		return NULL;
	for (int32_t i = 0; i < hub->client_count; i++)
		if (strcmp(hub->clients[i].resume, token) == 0)
			return &hub->clients[i];
	return NULL;
}

static cau_client *add_client(cau_hub *hub)
{
	if (hub->client_count == hub->client_capacity) {
		int32_t capacity = hub->client_capacity ? 2 * hub->client_capacity : 16;
		cau_client *grown = capacity > CLIENTS_MOST
		                        ? NULL
		                        : realloc(hub->clients, (size_t)capacity * sizeof *grown);
		if (!grown)
			return NULL;
		hub->clients = grown;
		hub->client_capacity = capacity;
	}
	cau_client *client = &hub->clients[hub->client_count++];
	// The entry counts as a lost client until a client takes it.
	*client = (cau_client){.asker.client = ++hub->last_client, .lost = true};
	return client;
}

// Puts `client` into its earlier entry, or into a new one.
static bool take_place(cau_client *client, cau_client *kept)
{
	client->asker.client = kept->asker.client;
	if (!make_random(client->resume) || !fill_client_id(client, kept))
		return false;
	client->lost = false;
	*kept = *client;
	return true;
}

bool cau_hub_attach(cau_hub *hub, cau_client *client, const char *resume, uint64_t *replaced)
{
	*replaced = 0;
	pthread_mutex_lock(&hub->mutex);
	cau_client *kept = find_token(hub, resume);
	if (kept && !kept->lost)
		*replaced = kept->connection;
	else if (!kept)
		kept = add_client(hub);
	bool attached = kept && take_place(client, kept);
	pthread_mutex_unlock(&hub->mutex);
	return attached;
}

bool cau_hub_keeps(cau_hub *hub, const char *resume)
{
	pthread_mutex_lock(&hub->mutex);
	bool kept = find_token(hub, resume) != NULL;
	pthread_mutex_unlock(&hub->mutex);
	return kept;
}

typedef struct cut {
	uint32_t client;
	const char *cause;
} cut;

static void cut_one(void *user, cau_hosted *hosted)
{
	const cut *what = user;
	cau_hosted_cut(hosted, what->client, what->cause);
}

void cau_hub_detach(cau_hub *hub, uint32_t number, uint64_t connection)
{
	pthread_mutex_lock(&hub->mutex);
	cau_client *client = find_number(hub, number);
	bool its_own = client && client->connection == connection;
	if (its_own) {
		client->lost = true;
		client->lost_s = cau_monotonic_s();
	}
	pthread_mutex_unlock(&hub->mutex);
	if (its_own)
		cau_hub_each(hub, cut_one, &(cut){number, "the driver's connection was lost"});
}

typedef struct client_sign {
	uint32_t client;
	double alive_s;
} client_sign;

static void feed_one(void *user, cau_hosted *hosted)
{
	const client_sign *given = user;
	cau_hosted_feed(hosted, given->client, given->alive_s);
}

void cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s)
{
	if (visible)
		cau_hub_each(hub, feed_one, &(client_sign){number, alive_s});
	else
		cau_hub_each(hub, cut_one, &(cut){number, "the driver's page is hidden"});
}

bool cau_hub_find_client(cau_hub *hub, uint32_t number, cau_asker *asker)
{
	pthread_mutex_lock(&hub->mutex);
	const cau_client *client = find_number(hub, number);
	if (client)
		*asker = client->asker;
	pthread_mutex_unlock(&hub->mutex);
	return client != NULL;
}

uint32_t cau_hub_expect(cau_hub *hub, const cau_client *client)
{
	pthread_mutex_lock(&hub->mutex);
	cau_client *kept = find_token(hub, client->resume);
	if (!kept && (kept = add_client(hub))) {
		uint32_t number = kept->asker.client;
		*kept = *client;
		kept->asker.client = number;
		kept->lost = true;
		kept->lost_s = cau_monotonic_s();
	}
	uint32_t number = kept ? kept->asker.client : 0;
	pthread_mutex_unlock(&hub->mutex);
	return number;
}

bool cau_hub_resume_token(cau_hub *hub, uint32_t number, char token[CAU_RESUME_BYTES])
{
	pthread_mutex_lock(&hub->mutex);
	const cau_client *client = find_number(hub, number);
	if (client)
		memcpy(token, client->resume, CAU_RESUME_BYTES);
	pthread_mutex_unlock(&hub->mutex);
	return client && *token;
}

// ---- signs of life ------------------------------------------------------------------------------

static void begin_window(cau_sign_of_life *sign, double arrival_s, double least_s)
{
	sign->window_from_s = arrival_s;
	sign->window_least_s = least_s;
}

static void begin(cau_sign_of_life *sign, double arrival_s, double difference_s)
{
	sign->clocked = true;
	sign->least_s = difference_s;
	sign->measured_s = sign->alive_s = arrival_s;
	begin_window(sign, arrival_s, difference_s);
}

// Notes a smaller difference: the clock was set forward, or the first message was delayed for long.
static void note_leap(cau_sign_of_life *sign, double arrival_s, double difference_s,
                      double deadline_s)
{
	if (sign->least_s - difference_s > deadline_s)
		sign->measured_s = arrival_s + deadline_s;
	sign->least_s = fmin(sign->least_s, difference_s);
}

static void let_grow_old(cau_sign_of_life *sign, double arrival_s, double client_s)
{
	double difference_s = arrival_s - client_s;
	bool set_back = client_s < sign->client_s;
	if (set_back || arrival_s - sign->arrival_s > CAU_SIGN_GAP_S)
		begin_window(sign, arrival_s, difference_s);
	sign->window_least_s = fmin(sign->window_least_s, difference_s);
	if (arrival_s - sign->window_from_s < CAU_SIGN_WINDOW_S)
		return;
	sign->least_s = sign->window_least_s;
	begin_window(sign, arrival_s, INFINITY);
}

double cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                             double deadline_s)
{
	CAU_ASSERT(deadline_s >= 0, "a deadline of %g s", deadline_s);
	CAU_ASSERT(arrival_s >= sign->arrival_s, "arrived at %g s, after %g s", arrival_s,
	           sign->arrival_s);
	double difference_s = arrival_s - client_s;
	if (!sign->clocked)
		begin(sign, arrival_s, difference_s);
	note_leap(sign, arrival_s, difference_s, deadline_s);
	let_grow_old(sign, arrival_s, client_s);
	sign->arrival_s = arrival_s;
	sign->client_s = client_s;
	if (arrival_s >= sign->measured_s)
		sign->alive_s = fmax(sign->alive_s, fmin(arrival_s, client_s + sign->least_s));
	CAU_ASSERT(sign->alive_s <= arrival_s, "alive at %g s, which arrived at %g s", sign->alive_s,
	           arrival_s);
	return sign->alive_s;
}
