// SPDX-License-Identifier: GPL-3.0-or-later
// Why DDS does not match a writer with a reader.
#pragma once

#include <dds/dds.h>

// The first policy of which less is offered than requested, as DDS names it, or NULL; reliability
// is looked at last. What a QoS does not tell is DDS's default.
const char *cau_dds_mismatch(const dds_qos_t *offered, const dds_qos_t *requested);
