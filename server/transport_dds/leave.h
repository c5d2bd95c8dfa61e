// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves a DDS domain, in bounded time.
#pragma once

#include <dds/dds.h>

// Closes everything in the domain. Cyclone wakes its receiving thread with a packet to itself and
// waits for that thread. If the network interface is gone, the packet is lost, and Cyclone would
// wait for ever. So this function waits only for a while. The domain then stays open until the
// process ends, and a log line reports this.
void cau_dds_leave(dds_entity_t domain);
