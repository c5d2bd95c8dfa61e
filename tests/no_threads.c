// SPDX-License-Identifier: GPL-3.0-or-later
// Linked into tests that the thread sanitizer skips (CMakeLists.txt): shows that they make no
// thread.
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

int pthread_create(pthread_t *restrict thread, const pthread_attr_t *restrict attributes,
                   void *(*run)(void *), void *restrict argument)
{
	(void)thread, (void)attributes, (void)run, (void)argument;
	fputs("a test of a room without threads made one: see rooms_without_threads in "
	      "tests/CMakeLists.txt\n",
	      stderr);
	abort();
}
