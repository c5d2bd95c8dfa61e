// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that a slice of a session needs at once and by the megabyte: for a checkpoint, for what a
// file shows, for who joins.
//
// The kernel finds a page when it is first written to: in 1 us at the best, and in 11 us on a
// virtual machine whose host has to find it too. For the 8 MB of a checkpoint of 40,000 vertices
// that is 22 ms, where copying them takes 2. So the builder, which may take its time, makes the
// memory and touches it, and a slice gets it from the shelf and has it put back.
//
// What was taken may outlive the session: the store keeps a checkpoint until it is committed.
#pragma once

#include <stddef.h>

typedef struct cau_shelf cau_shelf;

cau_shelf *cau_shelf_create(void); // NULL: no memory for it
// Frees what lies on it; what is taken is freed when it is given back. Takes NULL.
void cau_shelf_release(cau_shelf *shelf);

// Lays `count` touched pieces of `bytes` each on an empty shelf, which from then on keeps as many.
// Without memory for them it holds fewer: what is missing is made when it is taken.
void cau_shelf_stock(cau_shelf *shelf, size_t bytes, int count);

// A piece of at least `bytes`, from the shelf if one lies there. The pages of one that is too small
// stay as it grows. NULL: no memory, or no shelf. Any thread.
void *cau_shelf_take(cau_shelf *shelf, size_t bytes);
// Puts a piece on the shelf from which it was taken. Takes NULL. Any thread.
void cau_shelf_give_back(void *memory);
