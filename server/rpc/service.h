// SPDX-License-Identifier: GPL-3.0-or-later
// The methods of the wire protocol over WebSocket connections. Turns received messages into orders
// for the hub, and sends the hub's answers. Runs on the network thread; other threads only post
// messages to it.
#pragma once

#include "auth/auth.h"
#include "builder/builder.h"
#include "hub/hub.h"
#include "metrics/exposition.h"
#include "move/move.h"
#include "transport_ws/network.h"

typedef struct cau_service cau_service;

typedef struct cau_service_def {
	const cau_config *config; // borrowed, like all members here
	const cau_auth *auth;
	cau_hub *hub;
	cau_moves *moves;
	cau_store *store;
	cau_builder *builder; // reads uploads and copies the store
} cau_service_def;

// Makes the service and registers its sink with the hub.
cau_status cau_service_create(cau_service **service, const cau_service_def *def, cau_error *error);
// Destroys the service, after the network and the builder have ended and the hub's sessions are
// gone. `service` may be NULL.
void cau_service_destroy(cau_service *service);

// Returns the functions that the network calls.
cau_network_handler cau_service_handler(cau_service *service);
// Makes the network thread close connections whose token was revoked, or now has a lower role than
// theirs. Any thread may call it.
void cau_service_check_tokens(cau_service *service);
// Sets the network, once it exists.
void cau_service_set_network(cau_service *service, cau_network *network);
// Adds a function that writes more of /metrics, on the network thread. `user` must exist longer
// than the network.
void cau_service_add_metrics(cau_service *service,
                             void (*write)(void *user, FILE *out, cau_metrics_format format),
                             void *user);
// Returns a count that increases ten times a second while the network thread runs.
unsigned long cau_service_ticks(cau_service *service);
// Makes the service answer requests with `draining` from now on.
void cau_service_drain(cau_service *service);
