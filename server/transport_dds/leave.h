// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves a domain, in bounded time.
#pragma once

#include <dds/dds.h>

// Closes everything in the domain. Cyclone wakes its receiving thread with a packet to itself and
// waits for it; where the interface has gone that packet goes nowhere. After a while the domain is
// left to the end of the process instead, and the log says so.
void cau_dds_leave(dds_entity_t domain);
