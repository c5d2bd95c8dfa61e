// SPDX-License-Identifier: GPL-3.0-or-later
// Names of sessions, tools and snapshots, for the inputs that take them.

export const NAME_PATTERN = '[a-z][a-z0-9]*([_\\-][a-z0-9]+)*';
