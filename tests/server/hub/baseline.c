// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon for tests that runs as on a processor without wide vector instructions. It is linked
// with --wrap=cau_default_session_def, so that its sessions use the lowest instruction tier.
#include "cautery/session.h"

cau_session_def __real_cau_default_session_def(void);
cau_session_def __wrap_cau_default_session_def(void);

cau_session_def __wrap_cau_default_session_def(void)
{
	cau_session_def def = __real_cau_default_session_def();
	def.instruction_set = "baseline";
	return def;
}
