# cautery_fuzz(NAME mesh_msh SOURCES msh_fuzz.c LIBRARIES cautery::core SEEDS seeds/msh)
#
# A fuzz target for one parser or decoder; its source defines LLVMFuzzerTestOneInput() and includes
# "fuzz/fuzz_target.h". SEEDS names a folder of small inputs (optional). THREADS: the target makes threads.
# Without it a target that makes one ends with an error (cautery_without_threads() in tests/CMakeLists.txt).
#   -DCAUTERY_FUZZ=ON  (clang): the test fuzz_NAME mutates the seeds for CAUTERY_FUZZ_SECONDS
#                      and keeps a minimised corpus in the tree.
#   otherwise:         the test replay_NAME runs the target over the seeds, the empty input and a
#                      fixed pseudo-random set, so that every build exercises it.
set(CAUTERY_FUZZ_SECONDS 10 CACHE STRING "Seconds that each fuzz test runs")
add_custom_target(fuzz_targets) # all of them, and nothing else

function(cautery_fuzz)
  cmake_parse_arguments(F "THREADS" "NAME;SEEDS" "SOURCES;LIBRARIES" ${ARGN})
  if(F_SEEDS)
    cmake_path(ABSOLUTE_PATH F_SEEDS BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  add_executable(fuzz_${F_NAME} ${F_SOURCES})
  target_link_libraries(fuzz_${F_NAME} PRIVATE cautery_compiler ${F_LIBRARIES} m)
  target_include_directories(fuzz_${F_NAME} PRIVATE
    "${PROJECT_SOURCE_DIR}/core" "${PROJECT_SOURCE_DIR}/protocol" "${PROJECT_SOURCE_DIR}/tests")
  set_target_properties(fuzz_${F_NAME} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/fuzz" CAUTERY_WARNINGS_ONLY OFF)

  add_dependencies(fuzz_targets fuzz_${F_NAME})

  if(NOT CAUTERY_FUZZ)
    if(NOT TARGET cautery_replay) # compiled once for all of them
      add_library(cautery_replay OBJECT "${PROJECT_SOURCE_DIR}/tests/fuzz/replay.c")
      target_link_libraries(cautery_replay PRIVATE cautery_compiler)
      target_include_directories(cautery_replay PRIVATE "${PROJECT_SOURCE_DIR}/tests")
    endif()
    target_sources(fuzz_${F_NAME} PRIVATE $<TARGET_OBJECTS:cautery_replay>)
    add_test(NAME replay_${F_NAME} COMMAND fuzz_${F_NAME} ${F_SEEDS})
    if(NOT F_THREADS)
      cautery_without_threads(fuzz_${F_NAME})
    endif()
    set_tests_properties(replay_${F_NAME} PROPERTIES LABELS "unit;unthreaded" TIMEOUT 120)
    return()
  endif()

  math(EXPR timeout "${CAUTERY_FUZZ_SECONDS} + 120")
  target_link_options(fuzz_${F_NAME} PRIVATE -fsanitize=fuzzer)
  add_test(NAME fuzz_${F_NAME} COMMAND "${PROJECT_SOURCE_DIR}/tests/fuzz/fuzz.sh" $<TARGET_FILE:fuzz_${F_NAME}>
    ${CAUTERY_FUZZ_SECONDS} "${CMAKE_BINARY_DIR}/fuzz/corpus/${F_NAME}"
    "${CMAKE_BINARY_DIR}/fuzz/${F_NAME}-" ${F_SEEDS})
  set_tests_properties(fuzz_${F_NAME} PROPERTIES LABELS fuzz TIMEOUT ${timeout})
endfunction()
