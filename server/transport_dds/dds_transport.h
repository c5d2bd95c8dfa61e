// SPDX-License-Identifier: GPL-3.0-or-later
// The DDS transport: a thread that takes tool commands from native and ROS 2 topics, passes them to
// sessions as orders, and publishes the tools' states. Topics and rules are in
// protocol/idl/README.md.
#pragma once

#include "hub/hub.h"
#include "metrics/exposition.h"

typedef struct cau_dds cau_dds;

// Name of the transport's thread in the operating system.
#define CAU_DDS_THREAD_NAME "cautery-dds"

// Opens the domain and adds a sink to the hub. Call it before sessions exist. Returns
// CAU_UNSUPPORTED in a build without DDS. `config` and `hub` are borrowed.
cau_status cau_dds_create(cau_dds **dds, const cau_config *config, cau_hub *hub, cau_error *error);
cau_status cau_dds_start(cau_dds *dds, cau_error *error);
// Reads the file of dds_roles again. On failure the roles stay as they were, and the error names
// the wrong line. A client whose role became smaller loses its tools with energy off, and continues
// with the new role. Any thread may call it.
cau_status cau_dds_reload(cau_dds *dds, cau_error *error);
// Ends the thread and closes everything on the wire; sessions may continue. `dds` may be NULL.
void cau_dds_stop(cau_dds *dds);
// Writes the transport's part of /metrics. `dds` is the cau_dds. Any thread may call it.
void cau_dds_write_metrics(void *dds, FILE *out, cau_metrics_format format);
// Frees the transport. Call it after the hub's sessions are gone. `dds` may be NULL.
void cau_dds_destroy(cau_dds *dds);
