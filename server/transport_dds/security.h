// SPDX-License-Identifier: GPL-3.0-or-later
// DDS Security for the daemon's participant.
#pragma once

#include <dds/dds.h>

#include "config/config.h"

// Adds the identity in the folder config->dds_security to the participant's QoS. Adds nothing if
// the setting is empty. Returns CAU_NOT_FOUND if one of its files cannot be read.
cau_status cau_dds_secure(dds_qos_t *qos, const cau_config *config, cau_error *error);
