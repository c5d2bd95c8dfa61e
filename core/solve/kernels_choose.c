// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/kernels.h"

#include <string.h>

extern const cau_kernels cau_kernels_single_baseline, cau_kernels_double_baseline;
#if defined(__x86_64__)
extern const cau_kernels cau_kernels_single_avx2, cau_kernels_double_avx2;
extern const cau_kernels cau_kernels_single_avx512, cau_kernels_double_avx512;
#endif

#if defined(__x86_64__)
static bool allowed(const char *tier, const char *ceiling)
{
	if (!ceiling || !*ceiling || !strcmp(ceiling, tier))
		return true;
	return !strcmp(ceiling, "avx512") && !strcmp(tier, "avx2");
}
#endif

const cau_kernels *cau_kernels_choose(bool single, const char *ceiling)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
	    allowed("avx512", ceiling))
		return single ? &cau_kernels_single_avx512 : &cau_kernels_double_avx512;
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && allowed("avx2", ceiling))
		return single ? &cau_kernels_single_avx2 : &cau_kernels_double_avx2;
#else
	(void)ceiling;
#endif
	return single ? &cau_kernels_single_baseline : &cau_kernels_double_baseline;
}
