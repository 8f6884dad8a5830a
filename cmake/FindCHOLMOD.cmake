# Finds SuiteSparse's CHOLMOD, for which Debian 12 ships no CMake configuration, and the BLAS and LAPACK that
# its supernodal part spends its time in.
#
#   CHOLMOD::CHOLMOD   imported target: headers, CHOLMOD, and OpenBLAS (or whatever BLAS and LAPACK there is)
#   CHOLMOD_FOUND, CHOLMOD_VERSION, CHOLMOD_BLAS ("OpenBLAS" or "generic"), CHOLMOD_BLAS_LIBRARIES
#
# Hints: CHOLMOD_ROOT, CMAKE_PREFIX_PATH.

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
find_library(CHOLMOD_CAMD_LIBRARY camd)  # its minimum degree, which is called directly too
find_library(CHOLMOD_OPENBLAS_LIBRARY openblas)
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY CHOLMOD_CAMD_LIBRARY CHOLMOD_OPENBLAS_LIBRARY)

# The version macros moved from cholmod_core.h to cholmod.h in SuiteSparse 6.
set(CHOLMOD_VERSION)
foreach(header cholmod.h cholmod_core.h)
  if(NOT CHOLMOD_VERSION AND EXISTS "${CHOLMOD_INCLUDE_DIR}/${header}")
    file(STRINGS "${CHOLMOD_INCLUDE_DIR}/${header}" lines
         REGEX "^#define CHOLMOD_(MAIN|SUB|SUBSUB)_VERSION[ \t]+[0-9]+")
    list(TRANSFORM lines REPLACE "^#define CHOLMOD_[A-Z]+_VERSION[ \t]+([0-9]+).*" "\\1")
    list(JOIN lines "." CHOLMOD_VERSION)
  endif()
endforeach()

# A supernodal factorisation on the reference BLAS takes about ten times as long: OpenBLAS where it is there,
# linked before CHOLMOD's own choice so that its symbols are the ones that are used.
if(CHOLMOD_OPENBLAS_LIBRARY)
  set(CHOLMOD_BLAS "OpenBLAS")
  set(CHOLMOD_BLAS_LIBRARIES "${CHOLMOD_OPENBLAS_LIBRARY}")
  set(cholmod_has_blas TRUE)
else()
  set(CHOLMOD_BLAS "generic")
  find_package(BLAS QUIET)
  find_package(LAPACK QUIET)
  set(CHOLMOD_BLAS_LIBRARIES "${LAPACK_LIBRARIES}" "${BLAS_LIBRARIES}")
  if(BLAS_FOUND AND LAPACK_FOUND)
    set(cholmod_has_blas TRUE)
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CHOLMOD
  REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_CAMD_LIBRARY CHOLMOD_INCLUDE_DIR cholmod_has_blas
  VERSION_VAR CHOLMOD_VERSION
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsuitesparse-dev libopenblas-dev, \
or configure with -DMESHGRAFT_WITH_CHOLMOD=OFF")

if(CHOLMOD_FOUND AND NOT TARGET CHOLMOD::CHOLMOD)
  add_library(CHOLMOD::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(CHOLMOD::CHOLMOD PROPERTIES
    IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${CHOLMOD_CAMD_LIBRARY};${CHOLMOD_BLAS_LIBRARIES}")
endif()
