// SPDX-License-Identifier: Apache-2.0
// Functions that write the generated files. They use the model; only write_examples uses the
// codecs.
#pragma once

#include <stdio.h>

#include "generate/model.h"

void write_typescript(FILE *out, const model *from);
void write_python(FILE *out, const model *from);
void write_asyncapi(FILE *out, const model *from);
void write_markdown(FILE *out, const model *from);
void write_examples(FILE *out);
void write_idl(FILE *out);
