# Finds BLAS and LAPACK: OpenBLAS where it is there, else whatever CMake finds. The reference BLAS works too, but a
# factorisation takes about ten times as long with it.
#
#   DenseKernels::DenseKernels    imported target
#   DenseKernels_FOUND, DenseKernels_VENDOR ("OpenBLAS" or "generic"), DenseKernels_LIBRARIES
#   DenseKernels_PREFIX           what the names of its functions begin with: "scipy_", or nothing
#
# Hints: DenseKernels_ROOT, CMAKE_PREFIX_PATH. The folder of the Python package scipy-openblas32, an OpenBLAS for all
# processors, is such a root.

find_library(DenseKernels_OPENBLAS_LIBRARY NAMES openblas scipy_openblas NAMES_PER_DIR)
mark_as_advanced(DenseKernels_OPENBLAS_LIBRARY)
if(DenseKernels_OPENBLAS_LIBRARY)
  set(DenseKernels_VENDOR "OpenBLAS")
  set(DenseKernels_LIBRARIES "${DenseKernels_OPENBLAS_LIBRARY}")
  set(DenseKernels_PREFIX "")
  if(DenseKernels_OPENBLAS_LIBRARY MATCHES "libscipy_openblas")
    set(DenseKernels_PREFIX "scipy_")
  endif()
else()
  find_package(LAPACK QUIET)
  if(LAPACK_FOUND)
    set(DenseKernels_VENDOR "generic")
    set(DenseKernels_LIBRARIES "${LAPACK_LIBRARIES}" "${BLAS_LIBRARIES}")
  endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(DenseKernels
  REQUIRED_VARS DenseKernels_LIBRARIES
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libopenblas-dev, \
or configure with -DMESHGRAFT_WITH_MULTIFRONTAL=OFF")

if(DenseKernels_FOUND AND NOT TARGET DenseKernels::DenseKernels)
  add_library(DenseKernels::DenseKernels INTERFACE IMPORTED)
  target_link_libraries(DenseKernels::DenseKernels INTERFACE "${DenseKernels_LIBRARIES}")
endif()
