// SPDX-License-Identifier: GPL-3.0-or-later
// Replays a trace of a session's decisions, and writes its counts as JSON. Exits with 1 if the
// machine answers differently.
//     test_replay_trace FILE
#include <stdlib.h>

#include "trace/trace.h"

int main(int argc, char **argv)
{
	cau_error error = {0};
	cau_trace_counts counts;
	FILE *trace = argc == 2 ? fopen(argv[1], "r") : NULL;
	if (!trace) {
		perror(argc == 2 ? argv[1] : "test_replay_trace FILE");
		return 2;
	}
	cau_status status = cau_trace_replay(trace, &counts, &error);
	fclose(trace);
	if (status) {
		fprintf(stderr, "%s: %s: %s\n", argv[1], error.path, error.reason);
		return EXIT_FAILURE;
	}
	printf("{\"events\":%llu,\"acts\":%llu,\"effects\":%llu,\"of_event\":[",
	       (unsigned long long)counts.events, (unsigned long long)counts.acts,
	       (unsigned long long)counts.effects);
	for (int i = 0; i < CAU_LOGIC_EVENT_COUNT; i++)
		printf("%s%llu", i ? "," : "", (unsigned long long)counts.of_event[i]);
	printf("]}\n");
	return EXIT_SUCCESS;
}
