# Debian packages, one for each component of what is installed.
# deploy/package.sh configures a tree for them (prefix /usr, hardened) and runs cpack there.
set(CAUTERY_PACKAGER "Cautery developers <maintainers@users.noreply.github.com>" CACHE STRING
  "Name and address that packages give as their maintainer's")
set(CAUTERY_PACKAGE_REVISION 1 CACHE STRING "Revision of the packages, behind the version")
set(version "${PROJECT_VERSION}-${CAUTERY_PACKAGE_REVISION}")

# The date of the last commit, so that the same sources make the same packages.
execute_process(COMMAND git log -1 --format=%aD WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT date)
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()

set(debian "${PROJECT_SOURCE_DIR}/deploy/debian")
configure_file("${debian}/changelog.in" "${CMAKE_BINARY_DIR}/debian/changelog" @ONLY)
# Without a name and a time in the compressed file, each build makes the same bytes.
function(compress from to)
  execute_process(COMMAND gzip -9nc "${from}" OUTPUT_FILE "${to}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
compress("${CMAKE_BINARY_DIR}/debian/changelog" "${CMAKE_BINARY_DIR}/debian/changelog.Debian.gz")
compress("${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${CMAKE_BINARY_DIR}/debian/changelog.gz")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME cautery)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "${CAUTERY_PACKAGER}")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE "${CAUTERY_PACKAGE_REVISION}")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_BINARY_DIR}/server/dds_identity")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# package(COMPONENT NAME SECTION DEPENDS DESCRIPTION): a component's fields, and its papers.
macro(package component name section depends description)
  string(TOUPPER ${component} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${description}")
  install(FILES "${debian}/copyright" "${CMAKE_BINARY_DIR}/debian/changelog.Debian.gz"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${name}" COMPONENT ${component})
endmacro()

# Each line of what follows is a line of the field; an empty one parts paragraphs.
package(daemon cauteryd science "init-system-helpers (>= 1.52), systemd | systemd-standalone-sysusers"
  "simulation server for energized soft-tissue dissection
cauteryd simulates the dissection of soft tissue with energized
instruments. It holds many sessions, takes tool commands over WebSocket
and DDS, and streams moved vertices and removed faces to thin clients, a
viewer for browsers among them, which it serves itself.

This package has the daemon with its scenes, viewer and manual, the unit
files, cautery-sim, which runs a scene without a server, and
cautery-mesh, which fills surfaces with tetrahedra. It is for training
and research, and no medical device.")
package(clients cautery-clients science ""
  "command line, load generator and robot controller for cauteryd
cauteryd simulates the dissection of soft tissue with energized
instruments.

This package has its clients: cautery, the command line; cautery-load,
which loads a daemon with sessions and viewers and measures what they
see; and cautery-robot, which drives a tool over DDS.")
package(development libcautery-dev libdevel "libwebsockets-dev, libcjson-dev, libssl-dev, libmeshoptimizer-dev"
  "client library of cauteryd, development files
cauteryd simulates the dissection of soft tissue with energized
instruments.

This package has what writing a client takes: an archive with headers,
pkg-config and CMake files, the message tables (AsyncAPI, IDL), the pages
of the protocol and an example.")
package(core libcautery-core0.1 libs ""
  "simulation of energized soft-tissue dissection, shared library
The core of cauteryd as a library: programs make sessions of tissue from
scene files, step them and read positions, without a server.

It is under the GPL, version 3 or later, and so is what contains it. It is
for training and research, and no medical device.")
package(coredevelopment libcautery-core-dev libdevel
  "libcautery-core0.1 (= ${version}), libcautery-dev (= ${version})"
  "simulation of energized soft-tissue dissection, development files
The core of cauteryd as a library: programs make sessions of tissue from
scene files, step them and read positions, without a server.

This package has its headers, pkg-config and CMake files, and its page.")
package(python python3-cautery python "python3 (>= 3.11), python3-numpy"
  "client of cauteryd for Python
cauteryd simulates the dissection of soft tissue with energized
instruments.

This package is its client in pure Python: a function for each request,
streams as numpy arrays, and tasks for learners. It holds nothing of the
core and is under the Apache licence.")
package(pythoncore python3-cautery-core python
  "python3 (>= 3.11), python3-numpy, python3-cautery (= ${version}), libcautery-core0.1 (= ${version})"
  "simulation of energized soft-tissue dissection in a Python process
The core of cauteryd for Python: sessions of tissue, steps, snapshots, and
tasks for learners, without a server.

It is under the GPL, version 3 or later, and so is what contains it. It is
for training and research, and no medical device.")
foreach(each PYTHON PYTHONCORE) # no programs
  set(CPACK_DEBIAN_${each}_PACKAGE_ARCHITECTURE all)
  set(CPACK_DEBIAN_${each}_PACKAGE_SHLIBDEPS OFF)
endforeach()
# ldconfig is asked, and dependents find the package, as with Debian's own libraries.
file(WRITE "${CMAKE_BINARY_DIR}/debian/triggers" "activate-noawait ldconfig\n")
file(WRITE "${CMAKE_BINARY_DIR}/debian/shlibs" "libcautery-core 0.1 libcautery-core0.1 (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_CORE_PACKAGE_CONTROL_EXTRA "${CMAKE_BINARY_DIR}/debian/triggers;${CMAKE_BINARY_DIR}/debian/shlibs")
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS cautery-clients)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA
  "${debian}/postinst;${debian}/prerm;${debian}/postrm;${debian}/conffiles")
install(FILES "${CMAKE_BINARY_DIR}/debian/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/cauteryd"
  COMPONENT daemon)

include(CPack)
