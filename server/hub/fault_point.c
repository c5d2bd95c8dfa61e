// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/fault_point.h"

__attribute__((weak)) void cau_fault_point(const char *name)
{
	(void)name;
}
