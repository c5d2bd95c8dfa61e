// SPDX-License-Identifier: GPL-3.0-or-later
// The client that sends a request to a session: a client of a connection, or a DDS writer.
#pragma once

#include <stdint.h>

#include "cautery/message_choices.h"

typedef struct cau_asker {
	uint32_t client; // number of the client, as in frames; 0: no client
	char name[65];
	char client_id[65];
	cau_role role;
	double deadline_s; // the client's energy is cut off after a silence of this length, s
} cau_asker;
