# Installs meshgraft into a fresh prefix, moves that prefix, and builds and runs a small project against it:
# once by find_package, once by pkg-config. KIND: AsBuilt, or Shared (a build of its own, library alone).
set(prefix ${WORK_DIR}/moved)
set(first_prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${prefix} ${first_prefix} ${WORK_DIR}/consumer)
file(MAKE_DIRECTORY ${WORK_DIR})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(KIND STREQUAL Shared)
  cmake_path(GET BUILD_DIR PARENT_PATH BUILD_DIR)
  string(APPEND BUILD_DIR /shared)  # beside this build, compiled alike: what ccache has of that serves here
  run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${BUILD_DIR} -G Ninja -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_CXX_COMPILER=${CXX} -DBUILD_SHARED_LIBS=ON -DMESHGRAFT_WITH_MULTIFRONTAL=${WITH_MULTIFRONTAL}
      -DMESHGRAFT_WITH_3MF=${WITH_3MF} -DMESHGRAFT_UNITY=${UNITY} -DMESHGRAFT_WITH_RENDER=OFF -DMESHGRAFT_WITH_EDITOR=OFF
      -DMESHGRAFT_BUILD_CLI=OFF -DMESHGRAFT_BUILD_TESTS=OFF
      -DMESHGRAFT_BUILD_BENCHMARKS=OFF)
  run(${CMAKE_COMMAND} --build ${BUILD_DIR})
endif()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${first_prefix})
file(RENAME ${first_prefix} ${prefix})

if(EXISTS ${prefix}/bin/meshgraft)
  run(${prefix}/bin/meshgraft --version)
endif()

run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/consumer/project -B ${WORK_DIR}/consumer -G Ninja
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/consumer)
run(${WORK_DIR}/consumer/consumer)
run(${WORK_DIR}/consumer/script_consumer)

find_program(pkg_config pkg-config REQUIRED)
file(GLOB_RECURSE description ${prefix}/meshgraft.pc)
cmake_path(GET description PARENT_PATH pc_dir)
cmake_path(GET pc_dir PARENT_PATH lib_dir)
set(ENV{PKG_CONFIG_PATH} ${pc_dir})
execute_process(COMMAND ${pkg_config} --modversion meshgraft OUTPUT_VARIABLE version
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
foreach(program_and_package "consumer;meshgraft" "script_consumer;meshgraft_script")
  list(GET program_and_package 0 program)
  list(GET program_and_package 1 package)
  execute_process(COMMAND ${pkg_config} --cflags --libs ${package} OUTPUT_VARIABLE flags
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags)
  run(${CXX} -std=c++20 -DPACKAGE_VERSION="${version}" ${SOURCE_DIR}/tests/consumer/project/${program}.cpp
      ${flags} -Wl,-rpath,${lib_dir} -o ${WORK_DIR}/consumer/${program}_by_pkg_config)
  run(${WORK_DIR}/consumer/${program}_by_pkg_config)
endforeach()
