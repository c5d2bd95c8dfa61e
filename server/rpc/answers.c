// SPDX-License-Identifier: GPL-3.0-or-later
// Counts the answers to each method, from any thread.
#include "rpc/internal.h"

// The words of the columns. Column 0 is for results, the others are for errors.
static const struct {
	int32_t code;
	const char *word;
} columns[CAU_ANSWER_COLUMNS] = {{0, "ok"},
#define X(number, code, word, sentence) {(number), word},
                                 CAU_RPC_ERROR_TABLE(X)
#undef X
};

void cau_answers_count(cau_service *service, cau_method method, int32_t code)
{
	int column = 0;
	while (column < CAU_ANSWER_COLUMNS - 1 && columns[column].code != code)
		column++;
	atomic_fetch_add_explicit(&service->answers[method][column], 1, memory_order_relaxed);
}

const char *cau_answers_method_name(cau_method method)
{
	return method == CAU_METHOD_COUNT ? "none" : cau_method_describe(method)->name;
}

void cau_calls_write(cau_service *service, cau_metrics_format format, FILE *out)
{
	static const cau_metric_family family = {"calls", CAU_METRIC_COUNTER, "",
	                                         "Requests and notifications on WebSocket, by method"};
	cau_metrics_begin(out, format, &family);
	for (int m = 0; m < CAU_METHOD_COUNT; m++)
		if (cau_method_describe((cau_method)m)->form != CAU_FORM_PUSH)
			cau_metrics_sample(out, format, &family, "method",
			                   cau_answers_method_name((cau_method)m), (double)service->calls[m]);
}

// True if the count is written to /metrics. The counts of results begin with 0 for each method that
// clients may call, so that the first call shows as an increase. The counts of errors begin with
// the first error, because there are too many to write them all.
static bool is_told(int method, int column, uint64_t count)
{
	cau_method_form form =
		method < CAU_METHOD_COUNT ? cau_method_describe((cau_method)method)->form : CAU_FORM_PUSH;
	return count > 0 || (column == 0 && (form == CAU_FORM_REQUEST || form == CAU_FORM_EITHER_WAY));
}

void cau_answers_write(cau_service *service, cau_metrics_format format, FILE *out)
{
	static const cau_metric_family family = {
		"answers", CAU_METRIC_COUNTER, "",
		"Answers on WebSocket by method and code; method none: answers to invalid requests"};
	cau_metrics_begin(out, format, &family);
	for (int m = 0; m <= CAU_METHOD_COUNT; m++)
		for (int c = 0; c < CAU_ANSWER_COLUMNS; c++) {
			uint64_t count = service->answers[m][c];
			cau_metric_label labels[] = {{"method", cau_answers_method_name((cau_method)m)},
			                             {"code", columns[c].word}};
			if (is_told(m, c, count))
				cau_metrics_sample_labelled(out, format, &family, labels, 2, (double)count);
		}
}
