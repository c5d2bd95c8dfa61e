// SPDX-License-Identifier: GPL-3.0-or-later
// Finds why DDS does not match a writer with a reader.
#pragma once

#include <dds/dds.h>

// Returns DDS's name of the first policy of which the writer offers less than the reader requests;
// NULL if there is no such policy. Reliability is checked last. A policy that a QoS does not set
// has DDS's default.
const char *cau_dds_mismatch(const dds_qos_t *offered, const dds_qos_t *requested);
