# Finds lib3mf (its C interface, version 1), for which Debian 12 ships no CMake configuration.
#
#   lib3MF::lib3MF  imported target
#   lib3MF_FOUND
#
# Hints: lib3MF_ROOT, CMAKE_PREFIX_PATH.

find_path(lib3MF_INCLUDE_DIR Model/COM/NMR_DLLInterfaces.h PATH_SUFFIXES lib3mf)
find_library(lib3MF_LIBRARY 3MF)
mark_as_advanced(lib3MF_INCLUDE_DIR lib3MF_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(lib3MF
  REQUIRED_VARS lib3MF_LIBRARY lib3MF_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install lib3mf-dev, or configure with -DMESHGRAFT_WITH_3MF=OFF")

if(lib3MF_FOUND AND NOT TARGET lib3MF::lib3MF)
  add_library(lib3MF::lib3MF UNKNOWN IMPORTED)
  set_target_properties(lib3MF::lib3MF PROPERTIES
    IMPORTED_LOCATION "${lib3MF_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${lib3MF_INCLUDE_DIR}")
endif()
