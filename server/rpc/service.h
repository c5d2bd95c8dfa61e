// SPDX-License-Identifier: GPL-3.0-or-later
// The wire's methods over WebSocket connections: what arrives becomes orders for the hub, what
// comes back from it is sent. Lives on the network thread; other threads only post to it.
#pragma once

#include "auth/auth.h"
#include "builder/builder.h"
#include "hub/hub.h"
#include "metrics/exposition.h"
#include "move/move.h"
#include "transport_ws/network.h"

typedef struct cau_service cau_service;

typedef struct cau_service_def {
	const cau_config *config; // borrowed, like all here
	const cau_auth *auth;
	cau_hub *hub;
	cau_moves *moves;
	cau_store *store;
	cau_builder *builder; // reads uploads and copies the store
} cau_service_def;

// Registers its sink with the hub.
cau_status cau_service_create(cau_service **service, const cau_service_def *def, cau_error *error);
// After the network and the builder have ended, and the hub's sessions are gone. Takes NULL.
void cau_service_destroy(cau_service *service);

// What the network calls.
cau_network_handler cau_service_handler(cau_service *service);
// Soon, on the network thread: closes connections whose token was taken back, or has a lesser role
// than they have. Any thread.
void cau_service_check_tokens(cau_service *service);
// Once the network exists.
void cau_service_set_network(cau_service *service, cau_network *network);
// More for /metrics, written on the network thread; `user` outlives the network.
void cau_service_add_metrics(cau_service *service,
                             void (*write)(void *user, FILE *out, cau_metrics_format format),
                             void *user);
// Counts up while the network thread lives, ten times a second.
unsigned long cau_service_ticks(cau_service *service);
// From now on requests are answered with `draining`.
void cau_service_drain(cau_service *service);
