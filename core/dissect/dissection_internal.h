// SPDX-License-Identifier: GPL-3.0-or-later
// Interfaces between the files of core/dissect. Two files have the rules of parting: by elements
// and their doses (doses.c), and by edges (dissection.c). Both use books.c, which uses no other
// file. dissection.c also calls the other files.
#pragma once

#include <stdbool.h>

#include "dissect/dissection.h"

// ---- books.c
const cau_heat_material *cau_dissection_heat_of(const cau_tissue *tissue, int primitive,
                                                int32_t index);
bool cau_dissection_lives(const cau_dissection *dissection, int primitive, int32_t index);
// Removes a live primitive and appends it to `removed`, with the hinges of a triangle.
void cau_dissection_remove(cau_dissection *dissection, int primitive, int32_t index);
// Adds an edge to the list of edges that changed in the present tick.
void cau_dissection_touch(cau_dissection *dissection, int32_t edge);
// Returns the index of a triangle or a tetrahedron in the arrays of doses.
int32_t cau_doses_place(const cau_tissue *tissue, int primitive, int32_t index);
// Parts an edge in these layers (bits). The edge must not have parted in any of these layers
// before.
void cau_dissection_lose_edge(cau_dissection *dissection, int32_t edge, uint16_t layers);

// ---- doses.c
cau_status cau_doses_create(cau_doses *doses, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error);
void cau_doses_begin(cau_doses *doses);
void cau_doses_expose(cau_dissection *dissection, const cau_near *near, const double *position,
                      const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                      double jaw, double duration_s);
void cau_doses_part(cau_dissection *dissection, uint32_t *layers);
// Removes a live triangle or tetrahedron, if elements part one by one.
void cau_doses_lose(cau_dissection *dissection, int primitive, int32_t index);

// ---- tears.c
cau_status cau_tears_create(cau_tears *tears, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error);
