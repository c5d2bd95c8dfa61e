// SPDX-License-Identifier: GPL-3.0-or-later
// Gathers the layers' meshes into one vertex array, and lists the regions of each layer.
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "tissue/tissue_internal.h"

// ---- regions
static int compare(const void *left, const void *right)
{
	int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
	return (a > b) - (a < b);
}

cau_status cau_region_list_make(cau_region_list *list, const int32_t *region, int32_t count,
                                cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(count >= 0, "%d elements", count);
	int32_t *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
	if (!sorted)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the regions");
	int32_t kept = 0;
	for (int32_t i = 0; i < count; i++) // many consecutive elements have the same region
		if (!kept || sorted[kept - 1] != region[i])
			sorted[kept++] = region[i];
	qsort(sorted, (size_t)kept, sizeof *sorted, compare);
	int32_t distinct = 0;
	for (int32_t i = 0; i < kept; i++)
		if (!distinct || sorted[distinct - 1] != sorted[i])
			sorted[distinct++] = sorted[i];
	list->count = distinct;
	list->region = cau_arena_copy(arena, sorted, (size_t)distinct, sizeof *sorted);
	free(sorted);
	return list->region ? CAU_OK
	                    : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the regions");
}

cau_status cau_region_list_check(const cau_region_list *list, const char *layer, int32_t region,
                                 const char *path, cau_error *error)
{
	if (list->count && bsearch(&region, list->region, (size_t)list->count, sizeof region, compare))
		return CAU_OK;
	char names[160] = "none";
	size_t length = 0;
	for (int32_t i = 0; i < list->count && length < sizeof names - 24; i++)
		length += (size_t)snprintf(names + length, sizeof names - length, "%s%d", i ? ", " : "",
		                           list->region[i]);
	if (list->count && length >= sizeof names - 24)
		snprintf(names + length, sizeof names - length, ", ...");
	return cau_fail(error, CAU_NOT_FOUND, path,
	                "the mesh of layer \"%.48s\" has no region %d; its regions are: %s", layer,
	                region, names);
}

// ---- layers
// State of gathering the scene's meshes. A mesh that several layers use has one copy of its
// vertices.
typedef struct gathering {
	cau_mesh mesh[CAU_MAX_MESHES];
	int32_t first_vertex[CAU_MAX_MESHES]; // -1: not used by any layer yet
	cau_face_table boundary[CAU_MAX_LAYERS];
} gathering;

static int32_t find_mesh(const cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (!strcmp(scene->meshes[i].name, name))
			return i;
	return -1;
}

static int32_t find_layer(const cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (!strcmp(scene->layers[i].name, name))
			return i;
	return -1;
}

static cau_status make_meshes(gathering *work, const cau_scene_def *scene, cau_mesh_report *report,
                              cau_error *error)
{
	CAU_ASSERT(scene->mesh_count <= CAU_MAX_MESHES, "%d meshes", scene->mesh_count);
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_error inner = {0};
		cau_status status =
			cau_mesh_make(&scene->meshes[i], scene->directory, &work->mesh[i], &report[i], &inner);
		if (!status)
			continue;
		char path[sizeof inner.path];
		snprintf(path, sizeof path, "meshes[%d]%s%.120s", i, inner.path[0] ? "." : "", inner.path);
		if (error && inner.file[0])
			memcpy(error->file, inner.file, sizeof error->file);
		return cau_fail(error, status, path, "%s", inner.reason);
	}
	return CAU_OK;
}

// Finds the boundary faces of a fat layer's mesh, oriented outward.
static cau_status make_boundary(const cau_mesh *mesh, cau_face_table *boundary, cau_error *error)
{
	CAU_ASSERT(mesh->tetrahedron_count > 0, "the boundary of %d tetrahedra",
	           mesh->tetrahedron_count);
	cau_primitives fat = {
		.vertex_count = mesh->vertex_count,
		.tetrahedron_count = mesh->tetrahedron_count,
		.tetrahedron = mesh->tetrahedron,
	};
	return cau_face_table_make(&fat, boundary, error);
}

static int32_t count_boundary(const cau_face_table *boundary)
{
	int32_t count = 0;
	for (int32_t f = 0; f < boundary->face_count; f++)
		count += boundary->owner[2 * f + 1] < 0;
	return count;
}

// Returns the mesh of a layer's elements: its own mesh, or that of the fat whose membrane it is.
static int32_t mesh_of(const cau_scene_def *scene, int32_t layer)
{
	CAU_ASSERT_INDEX(layer, scene->layer_count);
	const cau_layer_def *def = &scene->layers[layer];
	if (def->kind == CAU_LAYER_LINKS)
		return -1;
	if (def->kind == CAU_LAYER_MEMBRANE && def->of[0])
		return find_mesh(scene, scene->layers[find_layer(scene, def->of)].mesh);
	return find_mesh(scene, def->mesh);
}

static cau_status count_layers(cau_tissue *tissue, gathering *work, const cau_scene_def *scene,
                               cau_error *error)
{
	for (int32_t i = 0; i < scene->layer_count; i++) {
		cau_tissue_layer *layer = &tissue->layer[i];
		layer->def = scene->layers[i];
		int32_t m = mesh_of(scene, i);
		if (m < 0)
			continue;
		const cau_mesh *mesh = &work->mesh[m];
		if (work->first_vertex[m] < 0) {
			work->first_vertex[m] = tissue->vertex_count;
			tissue->vertex_count += mesh->vertex_count;
		}
		layer->first_vertex = work->first_vertex[m];
		layer->vertex_count = mesh->vertex_count;
		char path[64];
		snprintf(path, sizeof path, "layers[%d].mesh", i);
		if (layer->def.kind == CAU_LAYER_FAT) {
			if (!mesh->tetrahedron_count)
				return cau_fail(error, CAU_BAD_MESH, path, "mesh \"%s\" has no tetrahedra for fat",
				                scene->meshes[m].name);
			layer->tetrahedron_count = mesh->tetrahedron_count;
		} else if (layer->def.of[0]) {
			cau_status status = make_boundary(mesh, &work->boundary[i], error);
			if (status)
				return status;
			layer->triangle_count = count_boundary(&work->boundary[i]);
		} else {
			if (!mesh->triangle_count)
				return cau_fail(error, CAU_BAD_MESH, path,
				                "mesh \"%s\" has no triangles for a sheet", scene->meshes[m].name);
			layer->triangle_count = mesh->triangle_count;
		}
		layer->first_triangle = tissue->triangle_count;
		layer->first_tetrahedron = tissue->tetrahedron_count;
		tissue->triangle_count += layer->triangle_count;
		tissue->tetrahedron_count += layer->tetrahedron_count;
	}
	return CAU_OK;
}

static int32_t material_of_region(const cau_layer_def *def, int32_t region)
{
	CAU_ASSERT(def->material_count >= 1 && def->material_count <= CAU_MAX_MATERIALS, "%d materials",
	           def->material_count);
	for (int32_t i = 1; i < def->material_count; i++)
		if ((def->kind == CAU_LAYER_FAT ? def->fat[i].region : def->sheet[i].region) == region)
			return i;
	return 0;
}

static void copy_tetrahedra(cau_tissue *tissue, int32_t layer_index, const cau_mesh *mesh)
{
	const cau_tissue_layer *layer = &tissue->layer[layer_index];
	CAU_ASSERT(layer->first_tetrahedron + mesh->tetrahedron_count <= tissue->tetrahedron_count,
	           "tetrahedra %d + %d of %d", layer->first_tetrahedron, mesh->tetrahedron_count,
	           tissue->tetrahedron_count);
	for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
		int32_t to = layer->first_tetrahedron + t;
		for (int i = 0; i < 4; i++)
			tissue->tetrahedron[4 * to + i] = layer->first_vertex + mesh->tetrahedron[4 * t + i];
		tissue->tetrahedron_layer[to] = layer_index;
		tissue->tetrahedron_material[to] =
			material_of_region(&layer->def, mesh->tetrahedron_region[t]);
	}
}

static void copy_boundary(cau_tissue *tissue, int32_t layer_index, const cau_mesh *mesh,
                          const cau_face_table *boundary)
{
	const cau_tissue_layer *layer = &tissue->layer[layer_index];
	int32_t to = layer->first_triangle;
	for (int32_t f = 0; f < boundary->face_count; f++) {
		if (boundary->owner[2 * f + 1] >= 0)
			continue;
		for (int i = 0; i < 3; i++)
			tissue->triangle[3 * to + i] = layer->first_vertex + boundary->vertex[3 * f + i];
		tissue->triangle_layer[to] = layer_index;
		tissue->triangle_material[to] =
			material_of_region(&layer->def, mesh->tetrahedron_region[boundary->owner[2 * f]]);
		to++;
		CAU_ASSERT(to <= layer->first_triangle + layer->triangle_count,
		           "more than %d triangles bound layer %d", layer->triangle_count, layer_index);
	}
}

static void copy_triangles(cau_tissue *tissue, int32_t layer_index, const cau_mesh *mesh)
{
	const cau_tissue_layer *layer = &tissue->layer[layer_index];
	CAU_ASSERT(layer->first_triangle + mesh->triangle_count <= tissue->triangle_count,
	           "triangles %d + %d of %d", layer->first_triangle, mesh->triangle_count,
	           tissue->triangle_count);
	for (int32_t t = 0; t < mesh->triangle_count; t++) {
		int32_t to = layer->first_triangle + t;
		for (int i = 0; i < 3; i++)
			tissue->triangle[3 * to + i] = layer->first_vertex + mesh->triangle[3 * t + i];
		for (int i = 0; i < 6 && mesh->texture; i++)
			tissue->texture[6 * (size_t)to + (size_t)i] = (float)mesh->texture[6 * t + i];
		tissue->triangle_layer[to] = layer_index;
		tissue->triangle_material[to] = material_of_region(&layer->def, mesh->triangle_region[t]);
	}
}

// Sets the unit vectors t_u, t_v from the texture: (t_u, t_v) = D_m (u_j - u_i, u_k - u_i)^-1 (eq.
// 9), made orthogonal. Returns false if the texture gives no direction.
static bool texture_frame(double edge[2][3], const double uv[6], double frame[6])
{
	double a = uv[2] - uv[0], b = uv[4] - uv[0], c = uv[3] - uv[1], d = uv[5] - uv[1];
	double det = a * d - b * c;
	if (cau_texture_is_flat(uv))
		return false;
	cau_vec3 j = cau_vec3_of(edge[0]), k = cau_vec3_of(edge[1]);
	cau_vec3 u = cau_sub(cau_scale(d / det, j), cau_scale(c / det, k));
	cau_vec3 v = cau_sub(cau_scale(a / det, k), cau_scale(b / det, j));
	u = cau_unit_or(u, (cau_vec3){0, 0, 0});
	v = cau_unit_or(cau_add_scaled(v, -cau_dot(u, v), u), (cau_vec3){0, 0, 0});
	cau_vec3_to(u, frame);
	cau_vec3_to(v, frame + 3);
	return cau_dot(u, u) > 0.5 && cau_dot(v, v) > 0.5; // both have unit length, so neither is 0
}

// Sets the frame of a triangle without texture: the fibre direction projected into the triangle's
// plane. If the fibre is normal to the plane, takes the world axis closest to the plane.
static void fibre_frame(double edge[2][3], const double fibre[3], double frame[6])
{
	cau_vec3 n = cau_cross(cau_vec3_of(edge[0]), cau_vec3_of(edge[1]));
	n = cau_unit_or(n, (cau_vec3){0, 0, 1});
	cau_vec3 along = cau_unit_or(cau_vec3_of(fibre), (cau_vec3){1, 0, 0});
	cau_vec3 u = cau_add_scaled(along, -cau_dot(along, n), n);
	if (cau_length(u) < 1e-3) { // within a twentieth of a degree of the normal
		int axis = fabs(n.x) <= fabs(n.y) ? (fabs(n.x) <= fabs(n.z) ? 0 : 2)
		                                  : (fabs(n.y) <= fabs(n.z) ? 1 : 2);
		cau_vec3 e = {axis == 0, axis == 1, axis == 2};
		u = cau_add_scaled(e, -cau_dot(e, n), n);
	}
	u = cau_unit_or(u, (cau_vec3){1, 0, 0});
	cau_vec3_to(u, frame);
	cau_vec3_to(cau_cross(n, u), frame + 3);
}

// Sets the frames of a layer's triangles, from the texture if it has a direction, otherwise from
// the layer's fibre.
static void make_frames(cau_tissue *tissue, int32_t layer_index, const cau_mesh *mesh)
{
	const cau_tissue_layer *layer = &tissue->layer[layer_index];
	for (int32_t t = 0; t < layer->triangle_count; t++) {
		int32_t triangle = layer->first_triangle + t;
		CAU_ASSERT_INDEX(triangle, tissue->triangle_count);
		const int32_t *vertex = tissue->triangle + 3 * triangle;
		double edge[2][3];
		for (int e = 0; e < 2; e++)
			for (int i = 0; i < 3; i++)
				edge[e][i] = tissue->rest[3 * vertex[e + 1] + i] - tissue->rest[3 * vertex[0] + i];
		double *frame = tissue->triangle_frame + 6 * triangle;
		if (!mesh->texture || layer->def.of[0] ||
		    !texture_frame(edge, mesh->texture + 6 * t, frame))
			fibre_frame(edge, layer->def.fibre, frame);
	}
}

static cau_status allocate(cau_tissue *tissue, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(tissue->vertex_count >= 0 && tissue->triangle_count >= 0 &&
	               tissue->tetrahedron_count >= 0,
	           "%d vertices, %d triangles, %d tetrahedra", tissue->vertex_count,
	           tissue->triangle_count, tissue->tetrahedron_count);
	size_t n = (size_t)tissue->vertex_count, t = (size_t)tissue->triangle_count;
	size_t k = (size_t)tissue->tetrahedron_count;
	tissue->rest = cau_arena_array(arena, 3 * n, sizeof(double));
	tissue->mass = cau_arena_array(arena, n, sizeof(double));
	tissue->pinned = cau_arena_array(arena, n, 1);
	tissue->triangle = cau_arena_array(arena, 3 * t, sizeof(int32_t));
	tissue->triangle_layer = cau_arena_array(arena, t, sizeof(int32_t));
	tissue->triangle_material = cau_arena_array(arena, t, sizeof(int32_t));
	tissue->triangle_frame = cau_arena_array(arena, 6 * t, sizeof(double));
	tissue->texture = cau_arena_array(arena, 6 * t, sizeof(float));
	tissue->tetrahedron = cau_arena_array(arena, 4 * k, sizeof(int32_t));
	tissue->tetrahedron_layer = cau_arena_array(arena, k, sizeof(int32_t));
	tissue->tetrahedron_material = cau_arena_array(arena, k, sizeof(int32_t));
	if (!tissue->rest || !tissue->mass || !tissue->pinned || !tissue->triangle ||
	    !tissue->triangle_layer || !tissue->triangle_material || !tissue->triangle_frame ||
	    !tissue->texture || !tissue->tetrahedron || !tissue->tetrahedron_layer ||
	    !tissue->tetrahedron_material)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d vertices",
		                tissue->vertex_count);
	return CAU_OK;
}

// Lists the regions of a layer's elements. The layer's materials may name only these.
static cau_status find_regions(cau_tissue *tissue, int32_t index, const gathering *work,
                               const cau_scene_def *scene, cau_arena *arena, cau_error *error)
{
	cau_tissue_layer *layer = &tissue->layer[index];
	int32_t m = mesh_of(scene, index);
	if (m < 0)
		return CAU_OK;
	bool solid = layer->def.kind == CAU_LAYER_FAT || layer->def.of[0];
	const cau_mesh *mesh = &work->mesh[m];
	cau_status status = cau_region_list_make(
		&layer->regions, solid ? mesh->tetrahedron_region : mesh->triangle_region,
		solid ? mesh->tetrahedron_count : mesh->triangle_count, arena, error);
	for (int32_t k = 1; k < layer->def.material_count && !status; k++) {
		char path[80];
		snprintf(path, sizeof path, "layers[%d].regions[%d].region", index, k - 1);
		status =
			cau_region_list_check(&layer->regions, layer->def.name,
		                          layer->def.kind == CAU_LAYER_FAT ? layer->def.fat[k].region
		                                                           : layer->def.sheet[k].region,
		                          path, error);
	}
	return status;
}

static void copy_layers(cau_tissue *tissue, const gathering *work, const cau_scene_def *scene)
{
	for (int32_t m = 0; m < scene->mesh_count; m++)
		if (work->first_vertex[m] >= 0)
			memcpy(tissue->rest + 3 * (size_t)work->first_vertex[m], work->mesh[m].position,
			       3 * (size_t)work->mesh[m].vertex_count * sizeof(double));
	for (int32_t i = 0; i < scene->layer_count; i++) {
		int32_t m = mesh_of(scene, i);
		if (m < 0)
			continue;
		if (tissue->layer[i].def.kind == CAU_LAYER_FAT) {
			copy_tetrahedra(tissue, i, &work->mesh[m]);
			continue;
		}
		if (tissue->layer[i].def.of[0])
			copy_boundary(tissue, i, &work->mesh[m], &work->boundary[i]);
		else
			copy_triangles(tissue, i, &work->mesh[m]);
		make_frames(tissue, i, &work->mesh[m]);
	}
}

cau_status cau_tissue_gather(cau_tissue *tissue, const cau_scene_def *scene, cau_arena *arena,
                             cau_error *error)
{
	CAU_ASSERT(scene->layer_count <= CAU_MAX_LAYERS, "%d layers", scene->layer_count);
	gathering *work = cau_arena_array(arena, 1, sizeof *work);
	tissue->layer_count = scene->layer_count;
	tissue->layer = cau_arena_array(arena, (size_t)scene->layer_count, sizeof *tissue->layer);
	tissue->mesh_report =
		cau_arena_array(arena, (size_t)scene->mesh_count, sizeof *tissue->mesh_report);
	if (!work || !tissue->layer || !tissue->mesh_report)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the layers");
	for (int32_t m = 0; m < CAU_MAX_MESHES; m++)
		work->first_vertex[m] = -1;
	cau_status status = make_meshes(work, scene, tissue->mesh_report, error);
	if (!status)
		status = count_layers(tissue, work, scene, error);
	for (int32_t i = 0; i < scene->layer_count && !status; i++)
		status = find_regions(tissue, i, work, scene, arena, error);
	if (!status)
		status = allocate(tissue, arena, error);
	if (!status)
		copy_layers(tissue, work, scene);
	for (int32_t m = 0; m < scene->mesh_count; m++)
		cau_mesh_finish(&work->mesh[m]);
	for (int32_t i = 0; i < scene->layer_count; i++)
		cau_face_table_finish(&work->boundary[i]);
	return status;
}
