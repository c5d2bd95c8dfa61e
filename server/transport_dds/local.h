// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps DDS on this machine.
#pragma once

#include "cautery/status.h"

// Cyclone binds the ports that it receives on to every address, whatever interfaces it is given:
// packets of other machines would reach them. This ties each UDP socket of the process that is not
// on a loopback address to the loopback device. To be called when the domain has its sockets and no
// participant yet. CAU_IO: the kernel does not allow it (before 5.7 it takes CAP_NET_RAW).
cau_status cau_dds_stay_local(cau_error *error);
