// SPDX-License-Identifier: GPL-3.0-or-later
// mesh.read: reads an uploaded mesh on the builder.
#pragma once

#include "builder/builder.h"
#include "cautery/session.h"
#include "fill/fill.h"
#include "hosted_session/sink.h"

// A request to read a mesh.
typedef struct cau_mesh_asked {
	unsigned char *bytes; // malloc'ed; ownership is taken
	size_t byte_count;
	char file_name[129]; // file name as the user gave it
	char upload[160];    // `file` of a mesh whose source are the uploaded bytes
	double unit_m;       // length of one unit of the file, m; 0: guessed
	int layer_kind;      // kind of layer to make; -1: decided by the elements
	bool strict;
	bool as_it_is;                         // the surface is never filled with tetrahedra
	double edge_m;                         // edge length of tetrahedra, m; 0: chosen automatically
	char labels[256];                      // labels of a segmentation to use; "": all
	char pin[64];                          // sides to pin; "": chosen automatically
	cau_filling *filling;                  // ownership is taken; receives the solid, if one is made
	int64_t memory_mb, time_s, most_bytes; // limits of filling
} cau_mesh_asked;

// Reads the mesh on the builder, and answers through `reply`. Takes ownership of the bytes and of
// the filling, even on failure.
cau_status cau_mesh_ask(cau_builder *builder, const cau_mesh_asked *asked, const cau_reply *reply,
                        cau_error *error);

// Logs the reports on the mesh files of a scene that was built, one log line for each line of a
// report. `report` has one entry for each mesh; it may be NULL.
void cau_mesh_log(const char *session, const cau_scene_def *scene, const cau_mesh_report *report);
