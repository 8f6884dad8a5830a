# Finds SuiteSparse's CXSparse, for which Debian 12 ships no CMake configuration.
#
#   CXSparse::CXSparse    imported target
#   CXSparse_FOUND
#
# Hints: CXSparse_ROOT, CMAKE_PREFIX_PATH.

find_path(CXSparse_INCLUDE_DIR cs.h PATH_SUFFIXES suitesparse)
find_library(CXSparse_LIBRARY cxsparse)
mark_as_advanced(CXSparse_INCLUDE_DIR CXSparse_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CXSparse
  REQUIRED_VARS CXSparse_LIBRARY CXSparse_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsuitesparse-dev, \
or configure with -DMESHGRAFT_WITH_CHOLMOD=OFF")

if(CXSparse_FOUND AND NOT TARGET CXSparse::CXSparse)
  add_library(CXSparse::CXSparse UNKNOWN IMPORTED)
  set_target_properties(CXSparse::CXSparse PROPERTIES
    IMPORTED_LOCATION "${CXSparse_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CXSparse_INCLUDE_DIR}")
endif()
