// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a solid: reads the file, chooses an edge length, meshes, writes, reports.
#include "cautery/solid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "solid/mesher.h"

// ---- the file: Gmsh 2.2, binary, with a physical group for each label
// Gmsh's number for the element type tetrahedron. Number of tags of an element: physical group and
// entity.
enum { TETRAHEDRON = 4, TAGS = 2 };

static void put_whole(FILE *out, int32_t value)
{
	fwrite(&value, sizeof value, 1, out);
}

static int32_t value_of(const cau_volume *volume, int32_t label)
{
	CAU_ASSERT(label >= 1, "a tetrahedron of label %d", label);
	return volume->label_count ? volume->label[label].value : 1;
}

static void put_names(FILE *out, const cau_volume *volume)
{
	if (!volume->label_count)
		return;
	fprintf(out, "$PhysicalNames\n%d\n", volume->label_count);
	for (int32_t k = 1; k <= volume->label_count; k++) {
		const cau_label *label = &volume->label[k];
		if (label->name[0])
			fprintf(out, "3 %d \"%s\"\n", label->value, label->name);
		else
			fprintf(out, "3 %d \"label %d\"\n", label->value, label->value);
	}
	fputs("$EndPhysicalNames\n", out);
}

static void put_file(FILE *out, const cau_tets *tets, const cau_volume *volume)
{
	fputs("$MeshFormat\n2.2 1 8\n", out);
	put_whole(out, 1); // shows the byte order
	fputs("\n$EndMeshFormat\n", out);
	put_names(out, volume);
	fprintf(out, "$Nodes\n%d\n", tets->vertex_count);
	for (int32_t v = 0; v < tets->vertex_count; v++) {
		put_whole(out, v + 1);
		fwrite(tets->position + 3 * (size_t)v, sizeof *tets->position, 3, out);
	}
	fprintf(out, "\n$EndNodes\n$Elements\n%d\n", tets->count);
	put_whole(out, TETRAHEDRON);
	put_whole(out, tets->count);
	put_whole(out, TAGS);
	for (int32_t i = 0; i < tets->count; i++) {
		put_whole(out, i + 1);
		put_whole(out, value_of(volume, tets->label[i]));
		put_whole(out, value_of(volume, tets->label[i]));
		for (int k = 0; k < 4; k++)
			put_whole(out, tets->vertex[4 * (size_t)i + (size_t)k] + 1);
	}
	fputs("\n$EndElements\n", out);
}

// Writes the file. The region of a tetrahedron is its label's value, or 1 without labels. The
// caller frees *bytes.
static cau_status write_gmsh(const cau_tets *tets, const cau_volume *volume, unsigned char **bytes,
                             size_t *byte_count, cau_error *error)
{
	char *text = NULL;
	FILE *out = open_memstream(&text, byte_count);
	if (out)
		put_file(out, tets, volume);
	bool written = out && !ferror(out);
	if (out && fclose(out))
		written = false;
	*bytes = (unsigned char *)text;
	return written ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the file");
}

// ---- the solid
// TETRAHEDRA_CHOSEN: default target number of tetrahedra. On one core, a session steps this number
// in real time, with time left for a cut.
enum { TETRAHEDRA_CHOSEN = 8000, MORE_MOST = 16, SAMPLES = 24, SAMPLES_LEAST = 200, TRIES = 5 };
// Spacing of the lattice for edges of mean length 1. Edges of the lattice are as long as its
// spacing (2 of 6) or sqrt(3)/2 of the spacing (4 of 6). Their mean is 0.911 of the spacing.
static const double spacing_of_edge = 1.0 / 0.911;
static const double tetrahedra_of_cell = 12;
// Least spacing, as a share of the longest side. A shorter spacing comes only from rounding.
static const double spacing_least = 1e-4;

typedef struct work {
	const cau_solid_wish *wish;
	cau_solid *solid;
	cau_mesh surface;
	cau_volume volume;
	bool is_volume, is_closed; // is_closed: a volume, or a surface without a rim
	cau_domain domain;
	cau_tets tets;
	size_t text_bytes;
} work;

// Moves past the text that snprintf has added to the report.
static void advance(work *of, int length)
{
	size_t left = CAU_SOLID_TEXT_BYTES - of->text_bytes;
	of->text_bytes += length < 0 ? 0 : (size_t)length < left ? (size_t)length : left - 1;
}

#define PUT(of, ...)                                                                               \
	advance(of, snprintf((of)->solid->text + (of)->text_bytes,                                     \
	                     CAU_SOLID_TEXT_BYTES - (of)->text_bytes, __VA_ARGS__))

static void tell(const work *of, const char *stage, double share)
{
	if (of->wish->progress)
		of->wish->progress(of->wish->user, stage, share);
}

static void tell_cutting(void *user, double share)
{
	tell(user, "cutting", share);
}

// ---- reading
static const char *letters_of(const cau_volume *volume, char letters[4])
{
	static const char *const both[3] = {"LR", "PA", "IS"};
	for (int i = 0; i < 3; i++) {
		int along = 0;
		for (int c = 1; c < 3; c++)
			along = fabs(volume->axis[i][c]) > fabs(volume->axis[i][along]) ? c : along;
		letters[i] = both[along][volume->axis[i][along] > 0];
	}
	letters[3] = 0;
	return letters;
}

static cau_status read_volume(work *of, const void *bytes, size_t byte_count, cau_error *error)
{
	cau_volume *volume = &of->volume;
	char letters[4];
	cau_status status = cau_volume_read(bytes, byte_count, of->wish->labels, volume, error);
	if (status)
		return status;
	double step[3];
	for (int i = 0; i < 3; i++)
		step[i] =
			sqrt(volume->axis[i][0] * volume->axis[i][0] + volume->axis[i][1] * volume->axis[i][1] +
		         volume->axis[i][2] * volume->axis[i][2]);
	PUT(of, "format: %s, %d x %d x %d voxels of %.3g x %.3g x %.3g mm\n", volume->format,
	    volume->size[0], volume->size[1], volume->size[2], step[0], step[1], step[2]);
	if (volume->framed)
		PUT(of,
		    "orientation: the file's axes run to %s; of the mesh x is right, y front, z head "
		    "(RAS)\n",
		    letters_of(volume, letters));
	else
		PUT(of, "orientation: the file states none, so that left and right may be exchanged\n");
	cau_domain_of_volume(volume, &of->domain);
	of->is_closed = true;
	of->solid->unit_m = 1e-3;
	return CAU_OK;
}

static cau_status judge_surface(const work *of, int32_t turned, const cau_mesh_report *report,
                                cau_error *error)
{
	if (!of->wish->strict)
		return CAU_OK;
	if (report->open_edge_count)
		return cau_fail(error, CAU_BAD_MESH, "strict",
		                "strict refuses to fill an open surface: %d edges on its rim",
		                report->open_edge_count);
	if (turned)
		return cau_fail(error, CAU_BAD_MESH, "strict",
		                "strict refuses to turn %d triangles whose normal points inward", turned);
	return cau_mesh_report_refuse(report, error);
}

static cau_status read_surface(work *of, const void *bytes, size_t byte_count, cau_error *error)
{
	cau_mesh *surface = &of->surface;
	cau_mesh_report *report = calloc(1, sizeof *report);
	int32_t turned = 0;
	if (!report)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a report");
	cau_status status = CAU_OK;
	if (of->wish->labels && *of->wish->labels)
		status = cau_fail(error, CAU_BAD_VALUE, "labels", "a surface has no labels");
	if (!status)
		status = cau_mesh_read(of->wish->file, bytes, byte_count, surface, report, error);
	if (!status)
		status = cau_mesh_clean(surface, report, error);
	if (!status)
		status = cau_mesh_report_measure(surface, 1, report, error);
	if (!status && surface->tetrahedron_count)
		status = cau_fail(error, CAU_BAD_MESH, NULL,
		                  "this file has tetrahedra already: there is nothing to fill");
	if (!status)
		status = cau_domain_of_surface(surface, &of->domain, &turned, error);
	of->is_closed = !report->open_edge_count;
	if (!status)
		status = judge_surface(of, turned, report, error);
	if (!status) {
		PUT(of, "surface: %d triangles, %d %s, %d open edges", surface->triangle_count,
		    report->component_count, report->component_count == 1 ? "component" : "components",
		    report->open_edge_count);
		if (turned)
			PUT(of, ", %d triangles turned outward", turned);
		PUT(of, "\n");
	}
	free(report);
	return status;
}

static cau_status read_domain(work *of, cau_error *error)
{
	const void *bytes = of->wish->bytes;
	size_t byte_count = of->wish->byte_count;
	void *own = NULL;
	cau_status status = CAU_OK;
	tell(of, "reading", 0);
	if (!bytes) {
		status = cau_mesh_file_load(of->wish->file, &own, &byte_count, error);
		bytes = own;
	}
	of->is_volume = !status && cau_solid_is_volume(bytes, byte_count);
	if (!status)
		status = (of->is_volume ? read_volume : read_surface)(of, bytes, byte_count, error);
	free(own);
	return status;
}

// ---- meshing
// Returns the volume inside the domain. Samples the middles of SAMPLES^3 cells of the box. If few
// samples are inside, the tissue is thin. Then the domain's own volume is better, if the domain is
// closed.
static double volume_inside(const cau_domain *domain, bool closed)
{
	double cell = 1;
	int inside = 0;
	for (int c = 0; c < 3; c++)
		cell *= (domain->most[c] - domain->least[c]) / SAMPLES;
	for (int i = 0; i < SAMPLES * SAMPLES * SAMPLES; i++) {
		const int index[3] = {i % SAMPLES, i / SAMPLES % SAMPLES, i / (SAMPLES * SAMPLES)};
		double x[3];
		for (int c = 0; c < 3; c++)
			x[c] = domain->least[c] +
			       (index[c] + 0.5) * (domain->most[c] - domain->least[c]) / SAMPLES;
		inside += domain->label_at(domain, x, NULL) != 0;
	}
	return inside >= SAMPLES_LEAST || !closed ? cell * inside : domain->volume;
}

static double longest_side(const cau_domain *domain)
{
	double longest = 0;
	for (int c = 0; c < 3; c++)
		longest = fmax(longest, domain->most[c] - domain->least[c]);
	return longest;
}

// Returns how many tetrahedra a chosen edge should make.
static int32_t aim_of(const work *of)
{
	return of->wish->tetrahedra > 0 ? of->wish->tetrahedra : TETRAHEDRA_CHOSEN;
}

static cau_status choose_spacing(work *of, double *spacing, cau_error *error)
{
	double edge = of->wish->edge;
	if (!(edge >= 0) || !isfinite(edge))
		return cau_fail(error, CAU_BAD_VALUE, "edge", "an edge must be above zero");
	if (edge > 0) {
		*spacing = edge * spacing_of_edge;
		return CAU_OK;
	}
	*spacing = cbrt(tetrahedra_of_cell * volume_inside(&of->domain, of->is_closed) / aim_of(of));
	if (*spacing > spacing_least * longest_side(&of->domain) && isfinite(*spacing))
		return CAU_OK;
	return cau_fail(error, CAU_BAD_MESH, NULL,
	                "nothing is inside this %s: use it as a sheet (as fascia), or choose an edge",
	                of->is_volume ? "segmentation" : "surface");
}

static cau_status too_thin(const work *of, cau_error *error)
{
	return cau_fail(error, CAU_BAD_VALUE, "edge",
	                "an edge of %.3g is longer than the tissue is thick: choose a shorter one%s",
	                of->tets.spacing / spacing_of_edge,
	                of->wish->edge > 0 ? "" : ", or crop the file");
}

static cau_status mesh_with(work *of, double spacing, cau_error *error)
{
	cau_tets_finish(&of->tets);
	tell(of, "lattice", 0.1);
	cau_status status = cau_lattice(&of->domain, spacing, &of->tets, error);
	int64_t most = MORE_MOST * (int64_t)aim_of(of);
	// The number of tetrahedra is checked before the lattice is cut.
	if (!status && !(of->wish->edge > 0) && of->tets.count > most)
		return cau_fail(error, CAU_BAD_VALUE, "edge",
		                "the tissue is so thin that its solid needs more than %lld tetrahedra: "
		                "make a sheet of it (as "
		                "fascia), or choose an edge",
		                (long long)most);
	return status ? status : cau_stuff(&of->domain, &of->tets, tell_cutting, of, error);
}

// Meshes with the wanted or chosen edge. Tissue that is thinner than the edge vanishes. If nothing
// is left, a chosen edge is halved.
static cau_status make_tets(work *of, cau_error *error)
{
	double spacing = 0;
	cau_status status = choose_spacing(of, &spacing, error);
	int tries = of->wish->edge > 0 ? 1 : TRIES;
	for (int k = 0; k < tries && !status && !of->tets.count; k++) {
		status = mesh_with(of, spacing / (1 << k), error);
		if (status == CAU_LIMIT && k)
			return too_thin(of, error);
	}
	if (!status && !of->tets.count)
		return too_thin(of, error);
	if (status)
		return status;
	PUT(of, "edge: %.3g of a longest side of %.3g (%s)\n", of->tets.spacing / spacing_of_edge,
	    longest_side(&of->domain), of->wish->edge > 0 ? "asked for" : "chosen");
	tell(of, "smoothing", 0.6);
	return cau_smooth(&of->domain, &of->tets, error);
}

// ---- the report
static void put_labels(work *of)
{
	int64_t count[CAU_SOLID_LABEL_MAX + 1] = {0};
	for (int32_t i = 0; i < of->tets.count; i++)
		count[of->tets.label[i]]++;
	PUT(of, "solid: %d vertices, %d tetrahedra, least angle between faces %.1f degrees\n",
	    of->tets.vertex_count, of->tets.count, cau_least_angle_deg(&of->tets));
	for (int32_t k = 1; k <= of->volume.label_count; k++) {
		const cau_label *label = &of->volume.label[k];
		PUT(of, "label %d%s%s%s: %lld voxels, %lld tetrahedra%s\n", label->value,
		    label->name[0] ? " \"" : "", label->name, label->name[0] ? "\"" : "",
		    (long long)label->voxel_count, (long long)count[k],
		    count[k] ? "" : " (lost: thinner than an edge; choose a shorter one)");
	}
}

cau_status cau_solid_make(const cau_solid_wish *wish, cau_solid *solid, cau_error *error)
{
	CAU_ASSERT(wish->file != NULL, "a solid of %zu bytes without a name", wish->byte_count);
	*solid = (cau_solid){0};
	work *of = calloc(1, sizeof *of);
	if (!of)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for meshing");
	of->wish = wish;
	of->solid = solid;
	cau_status status = read_domain(of, error);
	if (!status)
		status = make_tets(of, error);
	if (!status) {
		put_labels(of);
		status = write_gmsh(&of->tets, &of->volume, &solid->bytes, &solid->byte_count, error);
	}
	if (!status)
		tell(of, "done", 1);
	cau_domain_finish(&of->domain);
	cau_tets_finish(&of->tets);
	cau_volume_finish(&of->volume);
	cau_mesh_finish(&of->surface);
	free(of);
	return status;
}

void cau_solid_finish(cau_solid *solid)
{
	free(solid->bytes);
	solid->bytes = NULL;
	solid->byte_count = 0;
}
