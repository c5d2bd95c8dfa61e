// SPDX-License-Identifier: GPL-3.0-or-later
// Participant indices. Each DDS program on a machine has one index in its domain, and two ports
// that follow from the index.
#pragma once

#include "cautery/status.h"
#include "config/config.h"

// Explains in *error why Cyclone DDS opened no domain; `word` is Cyclone's own short reason.
// Returns CAU_LIMIT if programs of this machine hold all participant indices, else CAU_IO.
cau_status cau_dds_explain_domain(const cau_config *config, const char *word, cau_error *error);
