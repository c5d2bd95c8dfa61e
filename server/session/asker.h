// SPDX-License-Identifier: GPL-3.0-or-later
// Who asks a session for something: a connection's client, or a DDS writer.
#pragma once

#include <stdint.h>

#include "cautery/message_choices.h"

typedef struct cau_asker {
	uint32_t client; // the number in frames; 0: nobody
	char name[65];
	char client_id[65];
	cau_role role;
	double deadline_s; // silence after which its energy is cut
} cau_asker;
