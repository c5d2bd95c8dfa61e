// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a mesh: its measured properties.
#pragma once

#include "mesh/mesh_builder.h"

// Lists the regions that were read, with their names in the file.
void cau_mesh_report_regions(const cau_mesh_builder *builder, cau_mesh_report *report);
// Measures the clean mesh: counts, components, rim, regions, size, unit, quality.
cau_status cau_mesh_report_measure(const cau_mesh *mesh, double unit_m, cau_mesh_report *report,
                                   cau_error *error);
