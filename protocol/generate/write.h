// SPDX-License-Identifier: Apache-2.0
// The generated files, each from the model or, the examples, from the codecs.
#pragma once

#include <stdio.h>

#include "generate/model.h"

void write_typescript(FILE *out, const model *from);
void write_python(FILE *out, const model *from);
void write_asyncapi(FILE *out, const model *from);
void write_markdown(FILE *out, const model *from);
void write_examples(FILE *out);
void write_idl(FILE *out);
