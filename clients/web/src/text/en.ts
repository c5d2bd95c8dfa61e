// SPDX-License-Identifier: GPL-3.0-or-later
// Every text of the page, in English. The groups are named after the modules that show them. A text with values is a
// function.

export const en = {
  // ---- the document

  // ---- panels, a to i

  // ---- panels, l to z

  // ---- hands, model and scene
};
