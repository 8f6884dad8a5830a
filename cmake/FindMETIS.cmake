# Finds METIS, the graph partitioner, for which Debian 12 ships no CMake configuration.
#
#   METIS::METIS    imported target
#   METIS_FOUND
#
# Hints: METIS_ROOT, CMAKE_PREFIX_PATH.

find_path(METIS_INCLUDE_DIR metis.h)
find_library(METIS_LIBRARY metis)
mark_as_advanced(METIS_INCLUDE_DIR METIS_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(METIS
  REQUIRED_VARS METIS_LIBRARY METIS_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libmetis-dev, \
or configure with -DMESHGRAFT_WITH_MULTIFRONTAL=OFF")

if(METIS_FOUND AND NOT TARGET METIS::METIS)
  add_library(METIS::METIS UNKNOWN IMPORTED)
  set_target_properties(METIS::METIS PROPERTIES
    IMPORTED_LOCATION "${METIS_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${METIS_INCLUDE_DIR}")
endif()
