# Finds SuiteSparse's CAMD, for which Debian 12 ships no CMake configuration.
#
#   CAMD::CAMD    imported target
#   CAMD_FOUND
#
# Hints: CAMD_ROOT, CMAKE_PREFIX_PATH.

find_path(CAMD_INCLUDE_DIR camd.h PATH_SUFFIXES suitesparse)
find_library(CAMD_LIBRARY camd)
mark_as_advanced(CAMD_INCLUDE_DIR CAMD_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CAMD
  REQUIRED_VARS CAMD_LIBRARY CAMD_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsuitesparse-dev, \
or configure with -DMESHGRAFT_WITH_MULTIFRONTAL=OFF")

if(CAMD_FOUND AND NOT TARGET CAMD::CAMD)
  add_library(CAMD::CAMD UNKNOWN IMPORTED)
  set_target_properties(CAMD::CAMD PROPERTIES
    IMPORTED_LOCATION "${CAMD_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CAMD_INCLUDE_DIR}")
endif()
