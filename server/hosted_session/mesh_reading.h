// SPDX-License-Identifier: GPL-3.0-or-later
// mesh.read: an upload as a mesh, read on the builder.
#pragma once

#include "builder/builder.h"
#include "cautery/session.h"
#include "fill/fill.h"
#include "hosted_session/sink.h"

// What is to be read.
typedef struct cau_mesh_asked {
	unsigned char *bytes; // malloc'ed, taken
	size_t byte_count;
	char file_name[129]; // as the user calls it
	char upload[160];    // what a mesh of source bytes says in `file`
	double unit_m;       // 0: guessed
	int layer_kind;      // -1: by the elements
	bool strict;
	bool as_it_is;                         // never filled
	double edge_m;                         // 0: chosen
	char labels[256];                      // of a segmentation; "": all
	char pin[64];                          // sides; "": chosen
	cau_filling *filling;                  // taken: where the solid goes, if it becomes one
	int64_t memory_mb, time_s, most_bytes; // bounds of filling
} cau_mesh_asked;

// Has it read, and answers through `reply`. Takes the bytes and the filling, on failure too.
cau_status cau_mesh_ask(cau_builder *builder, const cau_mesh_asked *asked, const cau_reply *reply,
                        cau_error *error);

// Logs what became of the mesh files of a scene that was built: one line for each line of a report.
// report: of each mesh, or NULL.
void cau_mesh_log(const char *session, const cau_scene_def *scene, const cau_mesh_report *report);
