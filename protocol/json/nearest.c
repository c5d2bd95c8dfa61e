// SPDX-License-Identifier: Apache-2.0
#include "cautery/nearest.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#include "cautery/assert.h"

enum {
	LONGEST = 63,
	// number of letters for each allowed slip: one slip in a word of three letters, two in a word
	// of six
	LETTERS_PER_SLIP = 3,
};

static int least(int a, int b)
{
	return a < b ? a : b;
}

static bool same_letter(char a, char b)
{
	return tolower((unsigned char)a) == tolower((unsigned char)b);
}

// Returns the optimal string alignment distance of words of at most LONGEST bytes.
static int distance(const char *a, const char *b)
{
	int rows[3][LONGEST + 1];
	int a_count = (int)strlen(a), b_count = (int)strlen(b);
	CAU_ASSERT(a_count <= LONGEST && b_count <= LONGEST, "words of %d and %d letters", a_count,
	           b_count);
	for (int j = 0; j <= b_count; j++)
		rows[0][j] = j;
	for (int i = 1; i <= a_count; i++) {
		int *row = rows[i % 3];
		const int *above = rows[(i + 2) % 3], *second = rows[(i + 1) % 3];
		row[0] = i;
		for (int j = 1; j <= b_count; j++) {
			int change = above[j - 1] + !same_letter(a[i - 1], b[j - 1]);
			row[j] = least(change, least(above[j], row[j - 1]) + 1);
			if (i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) &&
			    same_letter(a[i - 2], b[j - 1]))
				row[j] = least(row[j], second[j - 2] + 1);
		}
	}
	return rows[a_count % 3][b_count];
}

const char *cau_nearest(const char *word, const char *const *words, size_t count)
{
	const char *nearest = NULL;
	size_t length = strlen(word);
	if (length > LONGEST)
		return NULL;
	// The slips must be fewer than the letters: with as many slips as letters, any word of this
	// length would be near.
	int fewest = least((int)length, ((int)length + LETTERS_PER_SLIP - 1) / LETTERS_PER_SLIP + 1);
	for (size_t i = 0; i < count; i++) {
		size_t other = strlen(words[i]);
		int away = other <= LONGEST ? distance(word, words[i]) : fewest;
		// A shortened word is likelier than a different one: the unit is left out
		// ("young_modulus"), or the end of a command.
		if (other > length && strncmp(word, words[i], length) == 0)
			away = least(away, 1);
		if (away >= fewest)
			continue;
		fewest = away;
		nearest = words[i];
	}
	return nearest;
}
