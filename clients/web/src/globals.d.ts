// SPDX-License-Identifier: GPL-3.0-or-later
/// <reference types="vite/client" />

declare const __VIEWER_VERSION__: string;
