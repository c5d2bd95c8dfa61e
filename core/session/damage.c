// SPDX-License-Identifier: GPL-3.0-or-later
// Heat damage inside and outside a region, as volumes of the tissue at rest.
#include "base/vector.h"
#include "cautery/assert.h"
#include "session/session_internal.h"

static bool is_inside(const cau_selection *region, cau_vec3 place)
{
	double at[3];
	cau_vec3_to(place, at);
	if (region->kind == CAU_SELECT_SPHERE)
		return cau_length(cau_sub(place, cau_vec3_of(region->center_m))) <= region->radius_m;
	for (int c = 0; c < 3; c++)
		if (at[c] < region->least_m[c] || at[c] > region->most_m[c])
			return false;
	return true;
}

// Adds an element to the damage on its side of the region, by its corners and rest volume. `alive`:
// the element is not removed.
static void add(const cau_session *session, const cau_selection *region, const int32_t *vertex,
                int corners, double volume_m3, bool alive, cau_damage damage[2])
{
	CAU_ASSERT(volume_m3 > 0, "an element of %g m^3", volume_m3);
	cau_vec3 middle = {0, 0, 0};
	double exposure = 0;
	for (int i = 0; i < corners; i++) {
		cau_vec3 corner = cau_vec3_of(session->tissue.rest + 3 * (size_t)vertex[i]);
		middle = cau_add(middle, cau_scale(1.0 / corners, corner));
		exposure += (double)session->view.frame.exposure[vertex[i]] / corners;
	}
	cau_damage *to = &damage[!is_inside(region, middle)];
	to->removed_count += !alive;
	to->removed_m3 += alive ? 0 : volume_m3;
	to->damaged_m3 += alive ? volume_m3 * exposure : 0;
}

void cau_session_damage(const cau_session *session, const cau_selection *region, cau_damage *inside,
                        cau_damage *outside)
{
	CAU_ASSERT(region->kind == CAU_SELECT_BOX || region->kind == CAU_SELECT_SPHERE,
	           "a region of kind %d", region->kind);
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *tetrahedron, *triangle, *link;
	cau_damage damage[2] = {{0}, {0}};
	cau_session_alive(session, &tetrahedron, &triangle, &link);
	for (int32_t t = 0; t < tissue->tetrahedron_count; t++)
		add(session, region, tissue->tetrahedron + 4 * (size_t)t, 4, tissue->tetrahedron_volume[t],
		    tetrahedron[t], damage);
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		add(session, region, tissue->triangle + 3 * (size_t)t, 3,
		    tissue->triangle_area[t] * cau_triangle_material(tissue, t)->thickness_m, triangle[t],
		    damage);
	*inside = damage[0];
	*outside = damage[1];
}
