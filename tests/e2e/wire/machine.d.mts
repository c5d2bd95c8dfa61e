// SPDX-License-Identifier: GPL-3.0-or-later
/** By how much a bound in seconds is longer on this machine; at least 1. */
export function slowness(): number;
