# Installs the libraries, their headers, and what find_package(meshgraft) and pkg-config need. The program brings
# its own rules (cli/CMakeLists.txt).
include(CMakePackageConfigHelpers)

get_property(meshgraft_libraries GLOBAL PROPERTY meshgraft_published)
install(TARGETS ${meshgraft_libraries} EXPORT meshgraft)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/ ${PROJECT_BINARY_DIR}/include/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h"
        PATTERN distributed.h EXCLUDE)
if(MESHGRAFT_WITH_PETSC)
  install(FILES ${PROJECT_SOURCE_DIR}/include/meshgraft/distributed.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshgraft)
endif()
install(FILES LICENSE THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# find_package(meshgraft). A static library hands its own libraries on to whoever links it; the modules that
# find METIS, CAMD, BLAS and LAPACK, lib3mf and libzip go along because those have no configuration of their own.
get_target_property(meshgraft_library_type meshgraft TYPE)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meshgraft)
install(EXPORT meshgraft NAMESPACE meshgraft:: DESTINATION ${config_dir} FILE meshgraftTargets.cmake)
configure_package_config_file(cmake/meshgraftConfig.cmake.in meshgraftConfig.cmake
                              INSTALL_DESTINATION ${config_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(meshgraftConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/meshgraftConfig.cmake ${PROJECT_BINARY_DIR}/meshgraftConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindMETIS.cmake ${PROJECT_SOURCE_DIR}/cmake/FindCAMD.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindDenseKernels.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLibZip.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Findlib3MF.cmake
        DESTINATION ${config_dir})

# pkg-config: a description for each library. A static one lists all that it needs, so that plain --libs is enough for
# both kinds.
function(meshgraft_pkg_config pc_name pc_description pc_requires pc_libs)
  file(RELATIVE_PATH pc_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  configure_file(cmake/meshgraft.pc.in ${pc_name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pc_name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

set(pc_requires eigen3)
set(pc_libs)
set(pc_requires_script "meshgraft_samples = ${PROJECT_VERSION}")
if(meshgraft_library_type STREQUAL STATIC_LIBRARY)
  string(APPEND pc_requires " tbb fmt")
  string(APPEND pc_requires_script " libcrypto")
  set(pc_libs -lmeshoptimizer)
  if(MESHGRAFT_WITH_MULTIFRONTAL)
    get_target_property(dense_kernels DenseKernels::DenseKernels INTERFACE_LINK_LIBRARIES)
    string(JOIN " " pc_libs ${pc_libs} ${METIS_LIBRARY} ${CAMD_LIBRARY} ${dense_kernels})
  endif()
  if(MESHGRAFT_WITH_3MF)
    string(APPEND pc_requires " lib3MF libzip expat")
  endif()
endif()
meshgraft_pkg_config(meshgraft "${PROJECT_DESCRIPTION}" "${pc_requires}" "${pc_libs}")
meshgraft_pkg_config(meshgraft_samples "The built-in models of meshgraft" "meshgraft = ${PROJECT_VERSION}" "")
meshgraft_pkg_config(meshgraft_script "The edit files of meshgraft" "${pc_requires_script}" "")
