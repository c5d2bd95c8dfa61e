// SPDX-License-Identifier: GPL-3.0-or-later
// Sorts the pairs that blocks found by their parts, and makes the list of pairs.
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

enum { FEW = 64 }; // number of pairs below which sorting by digits is slower

static bool is_before(const cau_collide_found *a, const cau_collide_found *b)
{
	return a->first != b->first ? a->first < b->first : a->second < b->second;
}

// Sorts a few pairs [Shell 1959; gaps of Ciura 2001].
static void sort_few(cau_collide_found *found, int32_t count)
{
	static const int32_t gaps[] = {23, 10, 4, 1};
	for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++)
		for (int32_t gap = gaps[g], i = gap; i < count; i++) {
			cau_collide_found moved = found[i];
			int32_t at = i;
			for (; at >= gap && is_before(&moved, &found[at - gap]); at -= gap)
				found[at] = found[at - gap];
			found[at] = moved;
		}
}

// ---- many pairs: radix sort by bytes of their parts, the least significant byte first
enum { DIGITS = 2 * sizeof(int32_t), RADIX = 256 };

static int digit_of(const cau_collide_found *found, int digit)
{
	int32_t part = digit < DIGITS / 2 ? found->second : found->first;
	return part >> (8 * (digit % (DIGITS / 2))) & (RADIX - 1);
}

// Sorts the pairs by one digit. Returns false if all pairs have the same digit; then no pair is
// moved.
static bool sort_by_digit(const cau_collide_found *from, cau_collide_found *to, int32_t count,
                          int digit)
{
	int32_t place[RADIX] = {0}, before = 0;
	for (int32_t i = 0; i < count; i++)
		place[digit_of(&from[i], digit)]++;
	if (place[digit_of(&from[0], digit)] == count)
		return false;
	for (int k = 0; k < RADIX; k++) {
		int32_t here = place[k];
		place[k] = before;
		before += here;
	}
	for (int32_t i = 0; i < count; i++)
		to[place[digit_of(&from[i], digit)]++] = from[i];
	return true;
}

static void sort_many(cau_collide_found *found, int32_t count)
{
	cau_collide_found other[CAU_COLLIDE_SLICE], *from = found, *to = other;
	CAU_ASSERT(count <= CAU_COLLIDE_SLICE, "%d found by a block", count);
	for (int digit = 0; digit < DIGITS; digit++)
		if (sort_by_digit(from, to, count, digit)) {
			cau_collide_found *sorted = to;
			to = from;
			from = sorted;
		}
	if (from != found)
		memcpy(found, from, (size_t)count * sizeof *found);
}

void cau_collide_sort(cau_collide_found *found, int32_t count)
{
	if (count < FEW)
		sort_few(found, count);
	else
		sort_many(found, count);
}

void cau_collide_gather(cau_collide *collide)
{
	collide->pair_count = 0;
	for (int32_t b = 0; b < collide->surface.block_count; b++)
		for (int kind = 0; kind < 2; kind++)
			for (int32_t k = 0; k < collide->search.slice[b].count[kind]; k++) {
				const cau_collide_found *found =
					&collide->search.list[kind][(size_t)b * CAU_COLLIDE_SLICE + (size_t)k];
				if (collide->pair_count == collide->most_pairs)
					return;
				collide->seen.apart_m[collide->pair_count] = 0; // the distance is not measured yet
				cau_collide_pair *pair = &collide->pair[collide->pair_count++];
				pair->kind = (cau_gap_kind)kind;
				pair->thickness_m = found->thickness_m;
				pair->stiffness = found->stiffness;
				pair->plane = (cau_vec3){0, 0, 0};
				pair->slope = 0;
				pair->vertex[0] = found->first;
				if (kind == CAU_GAP_VERTEX_FACE) {
					memcpy(pair->vertex + 1,
					       collide->tissue->faces.vertex + 3 * (size_t)found->second,
					       3 * sizeof(int32_t));
				} else {
					memcpy(pair->vertex, collide->tissue->edges.vertex + 2 * (size_t)found->first,
					       2 * sizeof(int32_t));
					memcpy(pair->vertex + 2,
					       collide->tissue->edges.vertex + 2 * (size_t)found->second,
					       2 * sizeof(int32_t));
				}
			}
}
