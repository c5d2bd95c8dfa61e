// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/factor.h"

#include <cholmod.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cautery/assert.h"

struct cau_factor {
	cholmod_common common;
	cholmod_factor *l;
	bool canonical;               // result of cau_factor_refactor, without updates since
	int32_t *inverse;             // (n): index in L of each row of A
	cholmod_dense *b, *x, *y, *e; // scratch of cau_factor_solve
	int update_first[CAU_UPDATE_RANK + 1];
	int update_row[CAU_UPDATE_RANK * 8];
	double update_value[CAU_UPDATE_RANK * 8];
};

static pthread_mutex_t analysis_lock = PTHREAD_MUTEX_INITIALIZER;

static cholmod_sparse view_of(const cau_matrix *matrix)
{
	CAU_ASSERT(matrix->n > 0 && matrix->first[0] == 0, "a matrix of %d rows from %d on", matrix->n,
	           matrix->first[0]);
	CAU_ASSERT(matrix->first[matrix->n] >= matrix->n, "%d entries in %d rows with diagonals",
	           matrix->first[matrix->n], matrix->n);
	return (cholmod_sparse){
		.nrow = (size_t)matrix->n,
		.ncol = (size_t)matrix->n,
		.nzmax = (size_t)matrix->first[matrix->n],
		.p = matrix->first,
		.i = matrix->row,
		.x = matrix->value,
		.stype = -1,
		.itype = CHOLMOD_INT,
		.xtype = CHOLMOD_REAL,
		.dtype = CHOLMOD_DOUBLE,
		.sorted = 1,
		.packed = 1,
	};
}

// Makes CHOLMOD allocate a factor's arrays in pages that sessions can share. The library has one
// set of allocation functions for the whole program.
static void choose_memory(void)
{
	SuiteSparse_config.malloc_func = cau_large_malloc;
	SuiteSparse_config.calloc_func = cau_large_calloc;
	SuiteSparse_config.realloc_func = cau_large_realloc;
	SuiteSparse_config.free_func = cau_large_free;
}

static void start(cholmod_common *common)
{
	static pthread_once_t chosen = PTHREAD_ONCE_INIT;
	pthread_once(&chosen, choose_memory);
	cholmod_start(common);
	common->print = 0;
	common->try_catch = 1;
	common->supernodal = CHOLMOD_SIMPLICIAL;
	common->final_ll = 0;
	common->final_monotonic = 1;
	common->final_pack = 1;
	common->nmethods = 1;
	common->method[0].ordering = CHOLMOD_METIS;
	common->postorder = 1;
}

static cau_status create_empty(cau_factor **out, cau_error *error)
{
	cau_factor *factor = calloc(1, sizeof *factor);
	if (!factor)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a factor");
	start(&factor->common);
	*out = factor;
	return CAU_OK;
}

static cau_status finish_analysis(cau_factor *factor, cau_error *error)
{
	int32_t n = (int32_t)factor->l->n;
	factor->inverse = cau_large_malloc((size_t)n * sizeof *factor->inverse);
	if (!factor->inverse)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a factor of %d rows", n);
	const int *permutation = factor->l->Perm;
	for (int32_t k = 0; k < n; k++) {
		CAU_ASSERT_INDEX(permutation[k], n);
		factor->inverse[permutation[k]] = k;
	}
	return CAU_OK;
}

// Finds the order and pattern. METIS uses rand, whose state all threads share, so a lock is held. A
// given permutation needs no METIS and does not wait for other analyses.
static cholmod_factor *analyse(cau_factor *factor, const cau_matrix *matrix,
                               const int32_t *permutation)
{
	cholmod_sparse a = view_of(matrix);
	if (permutation)
		return cholmod_analyze_p(&a, (int *)(uintptr_t)permutation, NULL, 0, &factor->common);
	pthread_mutex_lock(&analysis_lock);
	cholmod_factor *l = cholmod_analyze_p(&a, NULL, NULL, 0, &factor->common);
	pthread_mutex_unlock(&analysis_lock);
	return l;
}

cau_status cau_factor_analyse(cau_factor **out, const cau_matrix *matrix,
                              const int32_t *permutation, cau_error *error)
{
	cau_factor *factor = NULL;
	cau_status status = create_empty(&factor, error);
	if (status)
		return status;
	if (permutation) {
		factor->common.method[0].ordering = CHOLMOD_GIVEN;
		factor->common.postorder = 0; // the given order is a postorder already
	}
	factor->l = analyse(factor, matrix, permutation);
	if (!factor->l)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to analyse a system of %d rows",
		                  matrix->n);
	if (!status)
		status = finish_analysis(factor, error);
	if (status) {
		cau_factor_destroy(factor);
		return status;
	}
	*out = factor;
	return CAU_OK;
}

cau_status cau_factor_create(cau_factor **out, const cau_matrix *matrix, const int32_t *permutation,
                             cau_error *error)
{
	cau_status status = cau_factor_analyse(out, matrix, permutation, error);
	if (status)
		return status;
	status = cau_factor_refactor(*out, matrix, error);
	if (status) {
		cau_factor_destroy(*out);
		*out = NULL;
	}
	return status;
}

int64_t cau_factor_entries(const cau_factor *factor)
{
	return (int64_t)factor->common.lnz;
}

void cau_factor_destroy(cau_factor *factor)
{
	if (!factor)
		return;
	cholmod_free_dense(&factor->b, &factor->common);
	cholmod_free_dense(&factor->x, &factor->common);
	cholmod_free_dense(&factor->y, &factor->common);
	cholmod_free_dense(&factor->e, &factor->common);
	cholmod_free_factor(&factor->l, &factor->common);
	cholmod_finish(&factor->common);
	cau_large_free(factor->inverse);
	free(factor);
}

cau_status cau_factor_refactor(cau_factor *factor, const cau_matrix *matrix, cau_error *error)
{
	CAU_ASSERT((size_t)matrix->n == factor->l->n, "%d rows for a factor of %zu", matrix->n,
	           factor->l->n);
	cholmod_sparse a = view_of(matrix);
	factor->canonical = false;
	int done = cholmod_factorize(&a, factor->l, &factor->common);
	if (!done || factor->common.status < CHOLMOD_OK)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to factor a system of %d rows",
		                matrix->n);
	if (factor->l->minor < factor->l->n || !(cau_factor_least_pivot(factor) > 0))
		return cau_fail(error, CAU_NUMERICAL, NULL,
		                "the solver cannot factor the system matrix of this scene: its masses and "
		                "stiffnesses are not finite or too far apart in size; check the materials, "
		                "step_s and the mesh for slivers");
	factor->canonical = true;
	return CAU_OK;
}

bool cau_factor_is_canonical(const cau_factor *factor)
{
	return factor->canonical;
}

// Copies one short column of C, sorted by its row indices in L.
static void place_column(cau_factor *factor, int at, int count, const int32_t *row,
                         const double *value)
{
	for (int i = 0; i < count; i++) {
		CAU_ASSERT_INDEX(row[i], factor->l->n);
		int place = factor->inverse[row[i]], k = at + i;
		for (; k > at && factor->update_row[k - 1] > place; k--) {
			factor->update_row[k] = factor->update_row[k - 1];
			factor->update_value[k] = factor->update_value[k - 1];
		}
		factor->update_row[k] = place;
		factor->update_value[k] = value[i];
	}
}

cau_status cau_factor_update(cau_factor *factor, int32_t columns, const int32_t *first,
                             const int32_t *row, const double *value, int add, cau_error *error)
{
	CAU_ASSERT(columns >= 1 && first[0] == 0, "an update of %d columns from %d on", columns,
	           first[0]);
	if (columns > CAU_UPDATE_RANK || first[columns] > CAU_UPDATE_RANK * 8)
		return cau_fail(error, CAU_LIMIT, NULL, "an update of rank %d is above %d", columns,
		                CAU_UPDATE_RANK);
	for (int32_t k = 0; k < columns; k++) {
		CAU_ASSERT(first[k] < first[k + 1], "column %d of the update has entries %d to %d", k,
		           first[k], first[k + 1]);
		factor->update_first[k] = first[k];
		place_column(factor, first[k], first[k + 1] - first[k], row + first[k], value + first[k]);
	}
	factor->update_first[columns] = first[columns];
	cholmod_sparse c = {
		.nrow = factor->l->n,
		.ncol = (size_t)columns,
		.nzmax = (size_t)first[columns],
		.p = factor->update_first,
		.i = factor->update_row,
		.x = factor->update_value,
		.itype = CHOLMOD_INT,
		.xtype = CHOLMOD_REAL,
		.dtype = CHOLMOD_DOUBLE,
		.sorted = 1,
		.packed = 1,
	};
	factor->canonical = false;
	if (!cholmod_updown(add, &c, factor->l, &factor->common))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an update of the factor");
	return CAU_OK;
}

int32_t cau_factor_size(const cau_factor *factor)
{
	CAU_ASSERT(factor->l->n <= INT32_MAX, "%zu rows", factor->l->n);
	return (int32_t)factor->l->n;
}

const int32_t *cau_factor_permutation(const cau_factor *factor)
{
	return factor->l->Perm;
}

const int32_t *cau_factor_places(const cau_factor *factor)
{
	return factor->inverse;
}

int32_t cau_factor_column(const cau_factor *factor, int32_t j, const int32_t **row,
                          const double **value, double *pivot)
{
	CAU_ASSERT_INDEX(j, factor->l->n);
	const int *first = factor->l->p, *count = factor->l->nz;
	CAU_ASSERT(count[j] >= 1, "column %d has %d entries", j, count[j]);
	*row = (const int *)factor->l->i + first[j] + 1;
	*value = (const double *)factor->l->x + first[j] + 1;
	*pivot = ((const double *)factor->l->x)[first[j]];
	return count[j] - 1;
}

double cau_factor_least_pivot(const cau_factor *factor)
{
	double least = 1e300;
	const int *first = factor->l->p;
	const double *x = factor->l->x;
	for (size_t j = 0; j < factor->l->n; j++)
		least = x[first[j]] < least ? x[first[j]] : least;
	return least;
}

cau_status cau_factor_solve(cau_factor *factor, const double *b, double *x, cau_error *error)
{
	size_t n = factor->l->n, bytes = 3 * n * sizeof(double);
	if (!factor->b)
		factor->b = cholmod_allocate_dense(n, 3, n, CHOLMOD_REAL, &factor->common);
	if (!factor->b)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to solve");
	memcpy(factor->b->x, b, bytes);
	if (!cholmod_solve2(CHOLMOD_A, factor->l, factor->b, NULL, &factor->x, NULL, &factor->y,
	                    &factor->e, &factor->common))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to solve");
	memcpy(x, factor->x->x, bytes);
	return CAU_OK;
}

int32_t cau_factor_pages(const cau_factor *factor, cau_pages *pages)
{
	const cholmod_factor *l = factor->l;
	const void *const array[CAU_FACTOR_PARTS] = {
		l->x, l->i, l->p, l->nz, l->Perm, l->ColCount, l->next, l->prev, factor->inverse};
	for (int k = 0; k < CAU_FACTOR_PARTS; k++)
		pages[k] = cau_large_pages(array[k]);
	return CAU_FACTOR_PARTS;
}
