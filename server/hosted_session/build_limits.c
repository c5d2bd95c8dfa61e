// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/life.h"

#include <stdatomic.h>
#include <stdio.h>
#include <sys/stat.h>

#define MEGABYTE 1e6

// Estimated time to build a session, s for each vertex. The builder sorts its jobs by it. A sheet
// of 250,000 vertices takes 10 s.
#define BUILT_VERTEX_S 4e-5

// ---- time ---------------------------------------------------------------------------------------

enum { BYTES_OF_VERTEX = 100 }; // estimated bytes of a mesh file for each vertex

// Size of a mesh file, looked up where the core will read it (core/mesh/mesh_make.c). Returns 0 if
// there is no such file, because the building then ends soon.
static double bytes_of_file(const char *directory, const char *file)
{
	char path[600];
	struct stat status;
	bool alone = *file == '/' || !*directory;
	int length =
		snprintf(path, sizeof path, "%s%s%s", alone ? "" : directory, alone ? "" : "/", file);
	bool there = length < (int)sizeof path && stat(path, &status) == 0;
	return there ? (double)status.st_size : 0;
}

static double vertices_of(const cau_scene_def *scene, const cau_mesh_def *mesh)
{
	double x = mesh->cells[0] + 1.0, y = mesh->cells[1] + 1.0, z = mesh->cells[2] + 1.0;
	switch (mesh->source) {
	case CAU_MESH_SHEET:
	case CAU_MESH_PATTERN:
		return x * y;
	case CAU_MESH_SLAB:
		return x * y * z;
	case CAU_MESH_FILE:
		return bytes_of_file(scene->directory, mesh->file) / BYTES_OF_VERTEX;
	default:
		return (double)mesh->byte_count / BYTES_OF_VERTEX;
	}
}

double cau_building_expects_s(const cau_scene_def *scene)
{
	double vertices = 0;
	for (int32_t i = 0; i < scene->mesh_count; i++)
		vertices += vertices_of(scene, &scene->meshes[i]);
	return BUILT_VERTEX_S * vertices;
}

// ---- memory and counts --------------------------------------------------------------------------

cau_status cau_building_hold(const cau_surroundings *around, int64_t *held, int64_t bytes,
                             const char *holder, cau_error *error)
{
	int64_t more = bytes - *held, most = around->config->max_sessions_bytes;
	int64_t all = atomic_fetch_add(around->memory_held, more) + more;
	if (more > 0 && all > most) {
		atomic_fetch_sub(around->memory_held, more);
		return cau_fail(
			error, CAU_LIMIT, "",
			"%s takes about %.0f MB of memory, all sessions then %.0f MB; they may take "
			"%.0f MB (setting max_sessions_bytes)",
			holder, (double)bytes / MEGABYTE, (double)all / MEGABYTE, (double)most / MEGABYTE);
	}
	*held = bytes;
	return CAU_OK;
}

void cau_building_release(const cau_surroundings *around, int64_t *held)
{
	if (*held)
		atomic_fetch_sub(around->memory_held, *held);
	*held = 0;
}

cau_status cau_building_hold_session(const cau_surroundings *around, int64_t *held, int64_t bytes,
                                     cau_error *error)
{
	int64_t most = around->config->max_session_bytes;
	if (bytes > most)
		return cau_fail(error, CAU_LIMIT, "",
		                "the session takes about %.0f MB of memory; a session may take %.0f MB "
		                "(setting max_session_bytes)",
		                (double)bytes / MEGABYTE, (double)most / MEGABYTE);
	return cau_building_hold(around, held, bytes, "the session", error);
}

static cau_status check_count(const char *what, int64_t count, int64_t most, const char *setting,
                              cau_error *error)
{
	if (count <= most)
		return CAU_OK;
	return cau_fail(error, CAU_LIMIT, "",
	                "the session has %lld %s; a session may have %lld "
	                "(setting %s)",
	                (long long)count, what, (long long)most, setting);
}

cau_status cau_building_check_limits(const cau_surroundings *around, int64_t *held,
                                     const cau_build_border *border, cau_error *error)
{
	const cau_config *config = around->config;
	cau_status status = check_count("vertices", border->vertex_count, config->max_session_vertices,
	                                "max_session_vertices", error);
	if (!status)
		status = check_count("elements", border->element_count, config->max_session_elements,
		                     "max_session_elements", error);
	return status ? status : cau_building_hold_session(around, held, (int64_t)border->bytes, error);
}
