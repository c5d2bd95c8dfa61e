// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/sweep.h"

#include <string.h>

#include "cautery/assert.h"
#include "solve/kernels.h"

enum {
	// most columns of a subtree that becomes one dense block; 32 to 64 were fastest
	LEAF_COLUMNS = 48,
	PAD = 16,
};

// A supernode while the supernodes are being formed.
typedef struct draft {
	int32_t first, last;   // columns [first, last)
	int32_t subtree_first; // first column of its whole subtree
	int64_t entries;       // nonzero entries without padding
} draft;

static int32_t pad(int32_t count)
{
	return (count + PAD - 1) / PAD * PAD;
}

// Returns the number of distinct rows at or after `last` in columns [first, last), and lists them
// in `out` if it is not NULL. `mark` (n) is scratch, -1 at first. If a column's parent is in the
// range, the parent has all of the column's rows (T. Davis, Direct Methods for Sparse Linear
// Systems, 2006, section 4.1).
static int32_t rows_below(const cau_factor *factor, int32_t first, int32_t last, int32_t *mark,
                          int32_t stamp, int32_t *out)
{
	int32_t count = 0;
	for (int32_t j = first; j < last; j++) {
		const int32_t *row;
		const double *value;
		double pivot;
		int32_t n = cau_factor_column(factor, j, &row, &value, &pivot);
		CAU_ASSERT(!n || row[0] > j, "column %d begins with row %d", j, row[0]);
		if (n && row[0] < last)
			continue;
		for (int32_t k = 0; k < n; k++)
			if (row[k] >= last && mark[row[k]] != stamp) {
				mark[row[k]] = stamp;
				if (out)
					out[count] = row[k];
				count++;
			}
	}
	return count;
}

static int32_t column_parent(const cau_factor *factor, int32_t j)
{
	const int32_t *row;
	const double *value;
	double pivot;
	return cau_factor_column(factor, j, &row, &value, &pivot) ? row[0] : -1;
}

static int32_t column_count(const cau_factor *factor, int32_t j)
{
	const int32_t *row;
	const double *value;
	double pivot;
	return cau_factor_column(factor, j, &row, &value, &pivot);
}

// True if two neighbouring drafts are better stored as one dense block: the block then has few
// extra zeros.
static bool worth_merging(int64_t columns, int64_t rows, int64_t entries)
{
	CAU_ASSERT(columns > 0 && rows >= 0 && entries > 0, "%lld columns, %lld rows, %lld entries",
	           (long long)columns, (long long)rows, (long long)entries);
	int64_t area = columns * (columns + 1) / 2 + columns * rows;
	return columns <= CAU_NODE_COLUMNS && (area - entries) * 5 <= area;
}

// Forms the supernodes: whole leaf subtrees, then chains of columns with the same rows, then
// neighbours if few zeros are added. Returns their number. `drafts` has capacity n.
static int32_t shape(const cau_factor *factor, draft *drafts, int32_t *subtree_first, int32_t *mark)
{
	int32_t n = cau_factor_size(factor), count = 0;
	for (int32_t j = 0; j < n; j++)
		subtree_first[j] = j;
	for (int32_t j = 0; j < n; j++) {
		int32_t parent = column_parent(factor, j);
		CAU_ASSERT(parent < 0 || parent > j, "column %d under column %d", j, parent);
		if (parent >= 0 && subtree_first[j] < subtree_first[parent])
			subtree_first[parent] = subtree_first[j];
	}
	int32_t stamp = 0;
	memset(mark, -1, (size_t)n * sizeof *mark);
	for (int32_t j = 0; j < n; j++) {
		int64_t entries = 1 + column_count(factor, j);
		if (j + 1 - subtree_first[j] <= LEAF_COLUMNS) {
			int64_t sum = entries;
			while (count && drafts[count - 1].first >= subtree_first[j])
				sum += drafts[--count].entries;
			drafts[count++] = (draft){subtree_first[j], j + 1, subtree_first[j], sum};
			continue;
		}
		draft fresh = {j, j + 1, subtree_first[j], entries};
		while (count) {
			draft *before = &drafts[count - 1];
			int32_t parent = column_parent(factor, before->last - 1);
			if (before->last != fresh.first || parent < fresh.first || parent >= fresh.last)
				break;
			int32_t rows = rows_below(factor, before->first, fresh.last, mark, stamp++, NULL);
			if (!worth_merging(fresh.last - before->first, rows, before->entries + fresh.entries))
				break;
			fresh.first = before->first;
			fresh.entries += before->entries;
			count--;
		}
		drafts[count++] = fresh;
	}
	CAU_ASSERT(count <= n, "%d supernodes of %d columns", count, n);
	return count;
}

static void sort_rows(int32_t *row, int32_t count)
{
	CAU_ASSERT(count >= 0, "%d rows", count);
	for (int32_t gap = count / 2; gap > 0; gap /= 2)
		for (int32_t i = gap; i < count; i++) {
			int32_t value = row[i], k = i;
			for (; k >= gap && row[k - gap] > value; k -= gap)
				row[k] = row[k - gap];
			row[k] = value;
		}
}

// Divides the tree into at most CAU_SWEEP_TASKS disjoint subtrees of about equal work. One thread
// handles the supernodes above them.
static void choose_tasks(cau_sweep *sweep, const int64_t *subtree_work,
                         const int32_t *subtree_first)
{
	int32_t count = sweep->supernode_count, candidates[CAU_SWEEP_TASKS], used = 0;
	for (int32_t s = count - 1; s >= 0 && used < CAU_SWEEP_TASKS; s--)
		if (sweep->supernode[s].parent < 0)
			candidates[used++] = s;
	for (;;) { // replace the largest subtree by its children while there are not too many
		int32_t largest = -1;
		for (int32_t i = 0; i < used; i++)
			if (subtree_first[candidates[i]] < candidates[i] &&
			    (largest < 0 || subtree_work[candidates[i]] > subtree_work[candidates[largest]]))
				largest = i;
		if (largest < 0)
			break;
		int32_t node = candidates[largest], children = 0;
		for (int32_t s = subtree_first[node]; s < node; s++)
			children += sweep->supernode[s].parent == node;
		if (used - 1 + children > CAU_SWEEP_TASKS)
			break;
		candidates[largest] = candidates[--used];
		CAU_ASSERT(used >= 0 && used + children <= CAU_SWEEP_TASKS, "%d tasks and %d more", used,
		           children);
		for (int32_t s = subtree_first[node]; s < node; s++)
			if (sweep->supernode[s].parent == node)
				candidates[used++] = s;
	}
	sort_rows(candidates, used);
	sweep->task_count = used;
	for (int32_t i = 0; i < used; i++) {
		sweep->task_first[i] = subtree_first[candidates[i]];
		sweep->task_last[i] = candidates[i] + 1;
		for (int32_t s = sweep->task_first[i]; s < sweep->task_last[i]; s++)
			sweep->supernode[s].task = i;
	}
}

// Finds parents, subtree ranges and work of the supernode tree, then the tasks.
static void link_tree(cau_sweep *sweep, int64_t *work, int32_t *first)
{
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		first[s] = s;
		work[s] = (int64_t)sweep->supernode[s].padded_rows * sweep->supernode[s].columns;
	}
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		cau_supernode *node = &sweep->supernode[s];
		node->task = -1;
		node->parent = node->rows ? sweep->column_node[sweep->row_global[node->row]] : -1;
		CAU_ASSERT(node->parent < 0 || (node->parent > s && node->parent < sweep->supernode_count),
		           "supernode %d under %d of %d", s, node->parent, sweep->supernode_count);
		if (node->parent >= 0) {
			work[node->parent] += work[s];
			if (first[s] < first[node->parent])
				first[node->parent] = first[s];
		}
	}
	choose_tasks(sweep, work, first);
}

// Numbers the columns above the tasks.
static void number_top(cau_sweep *sweep, int32_t *top_number)
{
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		const cau_supernode *node = &sweep->supernode[s];
		if (node->task >= 0)
			continue;
		sweep->top_node[sweep->top_node_count++] = s;
		for (int32_t j = 0; j < node->columns; j++) {
			CAU_ASSERT_INDEX(sweep->top_count, sweep->n);
			top_number[node->first + j] = sweep->top_count;
			sweep->top_column[sweep->top_count++] = node->first + j;
		}
	}
	// padding at the end, because vectors of lanes may begin at any column
	sweep->padded_n = pad(sweep->n) + PAD;
	sweep->padded_top = pad(sweep->top_count);
}

int32_t cau_sweep_task_place(const cau_sweep *sweep, int32_t task)
{
	CAU_ASSERT(task >= 0 && task <= sweep->task_count, "task %d of %d", task, sweep->task_count);
	return sweep->padded_n + task * (sweep->padded_top + 1);
}

// Finds the field index of each supernode's columns and rows.
static void name_places(cau_sweep *sweep, const int32_t *top_number)
{
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		cau_supernode *node = &sweep->supernode[s];
		int32_t task = node->task, own = node->columns;
		int32_t sums = task < 0 ? 0 : cau_sweep_task_place(sweep, task);
		node->spare = 4 * (task < 0 ? cau_sweep_task_place(sweep, sweep->task_count)
		                            : sums + sweep->padded_top);
		int32_t *forward = sweep->forward_place + node->place,
				*backward = sweep->backward_place + node->place;
		for (int32_t i = 0; i < own; i++)
			forward[i] = backward[i] = 4 * (node->first + i);
		for (int32_t i = 0; i < node->rows; i++) {
			int32_t row = sweep->row_global[node->row + i];
			CAU_ASSERT_INDEX(row, sweep->n);
			int above = task >= 0 && sweep->supernode[sweep->column_node[row]].task < 0;
			backward[own + i] = 4 * row;
			forward[own + i] = 4 * (above ? sums + top_number[row] : row);
		}
		// indices of padded rows, where W' has zeros
		for (int32_t i = own + node->rows; i < node->padded_rows; i++) {
			forward[i] = node->spare;
			backward[i] = 4 * node->first;
		}
	}
}

static void lay_out(cau_sweep *sweep)
{
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		cau_supernode *node = &sweep->supernode[s];
		int32_t rows = node->columns + node->rows;
		CAU_ASSERT(node->columns >= 1 && node->columns <= CAU_NODE_COLUMNS,
		           "supernode %d has %d columns", s, node->columns);
		node->padded_rows = pad(rows);
		node->place = sweep->place_count;
		sweep->place_count += node->padded_rows;
		node->panel = sweep->panel_entries;
		sweep->panel_entries += (int64_t)node->padded_rows * node->columns;
		int64_t dense = (int64_t)node->columns * (node->columns + node->padded_rows);
		if (dense > sweep->max_dense)
			sweep->max_dense = dense;
	}
}

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the packed factor");
}

static cau_status shape_supernodes(cau_sweep *sweep, cau_arena *arena, const cau_factor *factor,
                                   cau_arena *scratch, cau_error *error)
{
	size_t n = (size_t)sweep->n;
	draft *drafts = cau_arena_array(scratch, n, sizeof *drafts);
	int32_t *subtree_first = cau_arena_array(scratch, n, sizeof(int32_t));
	int32_t *mark = cau_arena_array(scratch, n, sizeof(int32_t));
	sweep->column_node = cau_arena_array(arena, n, sizeof(int32_t));
	if (!drafts || !subtree_first || !mark || !sweep->column_node)
		return no_memory(error);
	sweep->supernode_count = shape(factor, drafts, subtree_first, mark);
	sweep->supernode =
		cau_arena_array(arena, (size_t)sweep->supernode_count, sizeof *sweep->supernode);
	if (!sweep->supernode)
		return no_memory(error);
	memset(mark, -1, n * sizeof *mark);
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		cau_supernode *node = &sweep->supernode[s];
		node->first = drafts[s].first;
		node->columns = drafts[s].last - drafts[s].first;
		node->row = sweep->row_count;
		node->rows = rows_below(factor, drafts[s].first, drafts[s].last, mark, s, NULL);
		sweep->row_count += node->rows;
		for (int32_t j = 0; j < node->columns; j++)
			sweep->column_node[node->first + j] = s;
	}
	sweep->row_global = cau_arena_array(arena, (size_t)sweep->row_count, sizeof(int32_t));
	if (!sweep->row_global)
		return no_memory(error);
	memset(mark, -1, n * sizeof *mark);
	for (int32_t s = 0; s < sweep->supernode_count; s++) {
		const cau_supernode *node = &sweep->supernode[s];
		int32_t *row = sweep->row_global + node->row;
		rows_below(factor, node->first, node->first + node->columns, mark, s, row);
		sort_rows(row, node->rows);
	}
	lay_out(sweep);
	sweep->forward_place = cau_arena_array(arena, (size_t)sweep->place_count, sizeof(int32_t));
	sweep->backward_place = cau_arena_array(arena, (size_t)sweep->place_count, sizeof(int32_t));
	return sweep->forward_place && sweep->backward_place ? CAU_OK : no_memory(error);
}

cau_status cau_sweep_create(cau_sweep *sweep, cau_arena *arena, const cau_factor *factor,
                            const cau_kernels *kernels, int64_t whole_panels, cau_error *error)
{
	*sweep = (cau_sweep){.kernels = kernels, .n = cau_factor_size(factor)};
	cau_arena scratch = {0};
	cau_status status = shape_supernodes(sweep, arena, factor, &scratch, error);
	size_t nodes = (size_t)sweep->supernode_count, n = (size_t)sweep->n;
	int64_t *work = cau_arena_array(&scratch, nodes, sizeof *work);
	int32_t *first = cau_arena_array(&scratch, nodes, sizeof *first);
	int32_t *top_number = cau_arena_array(&scratch, n, sizeof *top_number);
	sweep->top_node = cau_arena_array(arena, nodes, sizeof(int32_t));
	sweep->top_column = cau_arena_array(arena, n, sizeof(int32_t));
	if (!status && (!work || !first || !top_number || !sweep->top_node || !sweep->top_column))
		status = no_memory(error);
	if (!status) {
		sweep->narrow =
			kernels->single && sweep->panel_entries * (int64_t)sizeof(float) > whole_panels;
		link_tree(sweep, work, first);
		number_top(sweep, top_number);
		name_places(sweep, top_number);
		size_t size = kernels->vectors->real_bytes;
		cau_sweep_panels panels = {0};
		status = cau_sweep_create_panels(sweep, &panels, error);
		cau_sweep_swap_panels(sweep, &panels);
		int32_t places = cau_sweep_task_place(sweep, sweep->task_count) + 1;
		sweep->field = cau_arena_array(arena, 4 * (size_t)places, size);
		sweep->dense = cau_arena_array(arena, CAU_PACK_PARTS * (size_t)sweep->max_dense, size);
		sweep->row_place = cau_arena_array(arena, CAU_PACK_PARTS * n, sizeof(int32_t));
		if (!status && (!sweep->field || !sweep->dense || !sweep->row_place))
			status = no_memory(error);
	}
	if (!status)
		cau_sweep_pack(sweep, factor);
	cau_arena_finish(&scratch);
	return status;
}

void cau_sweep_finish(cau_sweep *sweep)
{
	cau_pages_give_back(&sweep->pages);
}
