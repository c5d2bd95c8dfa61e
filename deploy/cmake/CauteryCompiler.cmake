# Compiler rules that every target of the project shares.
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS ON) # vector extensions, POSIX
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

add_library(cautery_compiler INTERFACE)
# A broken rule names its file from the source folder on, and not the folder of whoever built it.
target_compile_options(cautery_compiler INTERFACE "-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=")
target_compile_options(cautery_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wvla -Wstrict-prototypes -Wmissing-prototypes
  -ffp-contract=off -fno-math-errno -fno-omit-frame-pointer)
target_compile_definitions(cautery_compiler INTERFACE _GNU_SOURCE)
if(CAUTERY_WERROR)
  target_compile_options(cautery_compiler INTERFACE -Werror)
endif()
if(CAUTERY_FUZZ)
  if(NOT CMAKE_C_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "CAUTERY_FUZZ needs clang (libFuzzer): configure with -DCMAKE_C_COMPILER=clang")
  endif()
  if(NOT CAUTERY_SANITIZE)
    set(CAUTERY_SANITIZE address,undefined)
  endif()
endif()
# Clang's tree runs fuzz targets alone. What these link and never come to is neither sanitized nor optimised,
# so that it compiles ten times as fast. A folder sets CAUTERY_WARNINGS_ONLY for its targets.
define_property(TARGET PROPERTY CAUTERY_WARNINGS_ONLY INITIALIZE_FROM_VARIABLE CAUTERY_WARNINGS_ONLY)
set(cautery_runs "$<NOT:$<BOOL:$<TARGET_PROPERTY:CAUTERY_WARNINGS_ONLY>>>")
target_compile_options(cautery_compiler INTERFACE "$<$<NOT:${cautery_runs}>:-O0>")
if(CAUTERY_SANITIZE)
  set(instrumented -fsanitize=${CAUTERY_SANITIZE} -fno-sanitize-recover=all)
  if(CAUTERY_FUZZ)
    list(APPEND instrumented -fsanitize=fuzzer-no-link)
  endif()
  target_compile_options(cautery_compiler INTERFACE "$<${cautery_runs}:${instrumented}>")
  target_link_options(cautery_compiler INTERFACE -fsanitize=${CAUTERY_SANITIZE})
  if(CMAKE_C_COMPILER_ID STREQUAL "GNU")
    # gcc's instrumented code trips its own flow analysis; the plain builds keep the warning.
    target_compile_options(cautery_compiler INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()

# CAU_ASSERT (core/types/cautery/assert.h): on in Debug and under sanitizers, compiled away elsewhere.
set(CAUTERY_ASSERTIONS "$<CONFIG:Debug>")
if(CAUTERY_SANITIZE)
  set(CAUTERY_ASSERTIONS 1)
endif()
target_compile_definitions(cautery_compiler INTERFACE $<${CAUTERY_ASSERTIONS}:CAU_ASSERTIONS>)
