// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/nearest.h"

#include <string.h>

enum {
	LONGEST = 63,
	LETTERS_PER_SLIP = 3, // a word of three letters may hold one slip, one of six two
};

static size_t least(size_t a, size_t b)
{
	return a < b ? a : b;
}

// Slips between two words (optimal string alignment).
static size_t slips(const char *a, size_t a_length, const char *b, size_t b_length)
{
	size_t table[LONGEST + 1][LONGEST + 1];
	for (size_t i = 0; i <= a_length; i++)
		for (size_t j = 0; j <= b_length; j++) {
			if (!i || !j) {
				table[i][j] = i + j;
				continue;
			}
			size_t replaced = table[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
			table[i][j] = least(replaced, 1 + least(table[i - 1][j], table[i][j - 1]));
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				table[i][j] = least(table[i][j], table[i - 2][j - 2] + 1);
		}
	return table[a_length][b_length];
}

const char *cli_nearest(const char *word, const char *const *words, size_t count)
{
	const char *nearest = NULL;
	size_t length = strlen(word);
	// not as many as it has letters: any other word would be that near
	size_t fewest = least(length, (length + LETTERS_PER_SLIP - 1) / LETTERS_PER_SLIP + 1);
	if (length > LONGEST)
		return NULL;
	for (size_t i = 0; i < count; i++) {
		size_t other = strlen(words[i]);
		size_t away = other > LONGEST ? fewest : slips(word, length, words[i], other);
		if (other > length && strncmp(word, words[i], length) == 0)
			away = least(away, 1); // the rest was left out
		if (away >= fewest)
			continue;
		fewest = away;
		nearest = words[i];
	}
	return nearest;
}
