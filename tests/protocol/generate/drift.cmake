# Fails if a file of the tree is not what the message tables make today.
#   cmake -DGENERATE=program -DSCRATCH=folder -DROOT=tree -P drift.cmake
file(MAKE_DIRECTORY "${SCRATCH}")
execute_process(COMMAND "${GENERATE}" "${SCRATCH}" COMMAND_ERROR_IS_FATAL ANY)
set(drifted "")
foreach(file protocol/asyncapi.json protocol/messages.md protocol/examples.md protocol/idl/channels.idl
    clients/web/src/wire/messages.gen.ts clients/python/cautery/messages.py)
  get_filename_component(name "${file}" NAME)
  execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${SCRATCH}/${name}" "${ROOT}/${file}"
    RESULT_VARIABLE differs ERROR_QUIET)
  if(differs)
    list(APPEND drifted "${file}")
  endif()
endforeach()
if(drifted)
  message(FATAL_ERROR "not what the message tables make; build the target 'messages': ${drifted}")
endif()
