// SPDX-License-Identifier: GPL-3.0-or-later
// The DDS transport: a thread that takes tool commands from native and ROS 2 topics, hands them to
// sessions as orders, and publishes the tools' states. protocol/idl/README.md has topics and rules.
#pragma once

#include "hub/hub.h"
#include "metrics/exposition.h"

typedef struct cau_dds cau_dds;

// Of the transport's own thread, as the system shows it.
#define CAU_DDS_THREAD_NAME "cautery-dds"

// Opens the domain and adds a sink to the hub: before sessions exist. CAU_UNSUPPORTED in a build
// without DDS. `config` and `hub` are borrowed.
cau_status cau_dds_create(cau_dds **dds, const cau_config *config, cau_hub *hub, cau_error *error);
cau_status cau_dds_start(cau_dds *dds, cau_error *error);
// Reads the file of dds_roles anew; on failure roles stay as they were, and the error says which
// line is wrong. Clients whose role is less than it was lose their tools, energy off, and go on
// with what they are now. Any thread.
cau_status cau_dds_reload(cau_dds *dds, cau_error *error);
// Ends the thread and closes everything on the wire; sessions may go on. Takes NULL.
void cau_dds_stop(cau_dds *dds);
// Its part of /metrics; `dds` is the transport. Any thread.
void cau_dds_write_metrics(void *dds, FILE *out, cau_metrics_format format);
// After the hub's sessions are gone. Takes NULL.
void cau_dds_destroy(cau_dds *dds);
