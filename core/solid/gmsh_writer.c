// SPDX-License-Identifier: GPL-3.0-or-later
#include "solid/gmsh_writer.h"

#include <stdio.h>
#include <stdlib.h>

#include "cautery/assert.h"

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

cau_status cau_gmsh_write(const cau_tets *tets, const cau_volume *volume, unsigned char **bytes,
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
