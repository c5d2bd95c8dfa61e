// SPDX-License-Identifier: GPL-3.0-or-later
// The frame's changes against a full recount.
#include <stdlib.h>
#include <string.h>

#include "core/dissect/cutting.h"
#include "frame/frame_state.h"

typedef struct framed {
	rig r;
	cau_frame_state frame;
} framed;

static void make(framed *f)
{
	memset(f, 0, sizeof *f);
	rig_begin(&f->r);
	add_all_layers(&f->r);
	rig_build(&f->r, NULL, 1);
	assert_int_equal(cau_frame_create(&f->frame, &f->r.tissue, &f->r.dissection, &f->r.arena, NULL),
	                 CAU_OK);
}

static int32_t words(const framed *f)
{
	return (f->r.tissue.faces.face_count + 31) / 32;
}

static void test_a_new_frame_tells_everything(void **state)
{
	(void)state;
	framed f;
	make(&f);
	assert_int_equal(f.frame.moved_count, f.r.tissue.vertex_count);
	assert_int_equal(f.frame.mask_changed_count, words(&f));
	rig_finish(&f.r);
}

static void test_moved_vertices(void **state)
{
	(void)state;
	framed f;
	make(&f);
	double *x = f.r.solver.position;
	const int32_t moved[] = {0, 5, 6, 100};
	for (int k = 0; k < 4; k++)
		x[3 * moved[k] + k % 3] += 1e-9;
	cau_frame_update(&f.frame, &f.r.dissection, f.r.tissue.rest, x);
	assert_int_equal(f.frame.moved_count, 4);
	assert_memory_equal(f.frame.moved, moved, sizeof moved);
	cau_frame_update(&f.frame, &f.r.dissection, x, x);
	assert_int_equal(f.frame.moved_count, 0);
	assert_int_equal(f.frame.mask_changed_count, 0);
	rig_finish(&f.r);
}

static void test_mask_and_visible_vertices_after_cuts(void **state)
{
	(void)state;
	framed f;
	make(&f);
	const cau_tissue *t = &f.r.tissue;
	uint64_t random = 191;
	uint32_t *known = cau_arena_array(&f.r.arena, (size_t)words(&f), sizeof *known);
	memcpy(known, f.r.dissection.face_mask, (size_t)words(&f) * sizeof *known);
	int32_t changes = 0;
	for (int tick = 0; tick < 20; tick++) {
		cut_random_edges(&f.r, &random, 1 + tick);
		cau_frame_update(&f.frame, &f.r.dissection, t->rest, t->rest);
		// A viewer applies the changed words.
		for (int32_t k = 0; k < f.frame.mask_changed_count; k++) {
			int32_t w = f.frame.mask_changed[k];
			assert_true(!k || w > f.frame.mask_changed[k - 1]);
			assert_true(known[w] != f.r.dissection.face_mask[w]);
			known[w] = f.r.dissection.face_mask[w];
			changes++;
		}
		assert_memory_equal(known, f.r.dissection.face_mask, (size_t)words(&f) * sizeof *known);
	}
	assert_true(changes > 20);
	uint8_t *visible = cau_arena_array(&f.r.arena, (size_t)t->vertex_count, 1);
	for (int32_t face = 0; face < t->faces.face_count; face++)
		for (int i = 0; i < 3 && !(known[face >> 5] >> (face & 31) & 1); i++)
			visible[t->faces.vertex[3 * face + i]] = 1;
	assert_memory_equal(f.frame.vertex_visible, visible, (size_t)t->vertex_count);
	rig_finish(&f.r);
}

// Exposure of a vertex is the largest exposure over ignition of its edges. cau_frame_rebuild finds
// the same exposures.
static void test_exposure_of_vertices(void **state)
{
	(void)state;
	framed f;
	make(&f);
	const cau_tissue *t = &f.r.tissue;
	uint64_t random = 192;
	float *expected = cau_arena_array(&f.r.arena, (size_t)t->vertex_count, sizeof *expected);
	for (int tick = 0; tick < 4; tick++) {
		cau_dissection_begin(&f.r.dissection);
		for (int k = 0; k < 30; k++)
			expose_by_hand(&f.r.dissection,
			               (int32_t)random_between(&random, 0, t->edges.edge_count),
			               random_between(&random, 0, 300) * (1 + tick));
		cau_frame_update(&f.frame, &f.r.dissection, t->rest, t->rest);
		for (int32_t k = 0; k < f.r.dissection.touched_count; k++) {
			int32_t edge = f.r.dissection.touched[k];
			float value = (float)cau_dissection_heated(&f.r.dissection, edge);
			for (int i = 0; i < 2; i++) {
				float *at = &expected[t->edges.vertex[2 * edge + i]];
				*at = value > *at ? value : *at;
			}
		}
		assert_memory_equal(f.frame.exposure, expected, (size_t)t->vertex_count * sizeof(float));
	}
	int32_t charred = 0;
	for (int32_t v = 0; v < t->vertex_count; v++) {
		assert_true(expected[v] >= 0 && expected[v] <= 1);
		charred += expected[v] > 0;
	}
	assert_true(charred > 50);
	cau_frame_rebuild(&f.frame, &f.r.dissection);
	// The helper expose_by_hand may have lowered an edge's exposure.
	for (int32_t v = 0; v < t->vertex_count; v++)
		assert_true(f.frame.exposure[v] <= expected[v]);
	rig_finish(&f.r);
}

// Charring is the share of a vertex's edges that have parted, in one layer or several. It is
// counted again from all edges.
static void test_charring_is_the_share_of_parted_edges(void **state)
{
	(void)state;
	framed f;
	make(&f);
	const cau_tissue *t = &f.r.tissue;
	const cau_dissection *d = &f.r.dissection;
	size_t n = (size_t)t->vertex_count;
	uint64_t random = 193;
	int32_t *edges = cau_arena_array(&f.r.arena, n, sizeof *edges);
	int32_t *parted = cau_arena_array(&f.r.arena, n, sizeof *parted);
	int32_t between = 0; // values strictly between 0 and 1
	for (int tick = 0; tick < 20; tick++) {
		cut_random_edges(&f.r, &random, 1 + tick);
		cau_frame_update(&f.frame, d, t->rest, t->rest);
		memset(edges, 0, n * sizeof *edges);
		memset(parted, 0, n * sizeof *parted);
		for (int32_t k = 0; k < 2 * t->edges.edge_count; k++) {
			edges[t->edges.vertex[k]]++;
			parted[t->edges.vertex[k]] += d->parted[k / 2] != 0;
		}
		for (int32_t v = 0; v < t->vertex_count; v++) {
			assert_true(f.frame.charring[v] == (float)parted[v] / (float)edges[v]);
			between += parted[v] > 0 && parted[v] < edges[v];
		}
	}
	assert_true(between > 100);
	float *before = cau_arena_array(&f.r.arena, n, sizeof *before);
	memcpy(before, f.frame.charring, n * sizeof *before);
	cau_frame_rebuild(&f.frame, d); // a restore does the same
	assert_memory_equal(f.frame.charring, before, n * sizeof *before);
	rig_finish(&f.r);
}

// Heat below ignition raises the exposure, but not the charring.
static void test_heat_below_ignition_chars_nothing(void **state)
{
	(void)state;
	framed f;
	make(&f);
	uint32_t layers = 0;
	cau_dissection_begin(&f.r.dissection);
	for (int32_t edge = 0; edge < f.r.tissue.edges.edge_count; edge += 3)
		expose_by_hand(&f.r.dissection, edge, 1);
	cau_dissection_part(&f.r.dissection, &layers);
	cau_frame_update(&f.frame, &f.r.dissection, f.r.tissue.rest, f.r.tissue.rest);
	assert_int_equal(layers, 0);
	int32_t exposed = 0;
	for (int32_t v = 0; v < f.r.tissue.vertex_count; v++) {
		exposed += f.frame.exposure[v] > 0;
		assert_true(f.frame.charring[v] == 0);
	}
	assert_true(exposed > 50);
	rig_finish(&f.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_new_frame_tells_everything),
		cmocka_unit_test(test_moved_vertices),
		cmocka_unit_test(test_mask_and_visible_vertices_after_cuts),
		cmocka_unit_test(test_exposure_of_vertices),
		cmocka_unit_test(test_charring_is_the_share_of_parted_edges),
		cmocka_unit_test(test_heat_below_ignition_chars_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
