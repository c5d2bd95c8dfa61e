// SPDX-License-Identifier: GPL-3.0-or-later
// Restricts DDS to this machine.
#pragma once

#include "cautery/status.h"

// Ties each UDP socket of the process that is not on a loopback address to the loopback device.
// Cyclone binds its receiving ports to every address, even if its settings name only some
// interfaces. So packets of other machines would arrive without this. Call it when the domain has
// its sockets and no participant yet. Returns CAU_IO if the kernel refuses (before 5.7 it requires
// CAP_NET_RAW).
cau_status cau_dds_stay_local(cau_error *error);
