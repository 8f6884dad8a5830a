# meshgraft_facts(target namespace folder…): makes the records of facts of the folders' tables, for "FOLDER/facts.h",
# and compiles them into the target (tools/facts.py).
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)
add_custom_target(meshgraft_generated)  # all headers that are made, without compiling anything
set(meshgraft_facts_tool ${PROJECT_SOURCE_DIR}/tools/facts.py)

function(meshgraft_facts target namespace)
  set(out ${PROJECT_BINARY_DIR}/facts/${target})
  set(headers)
  set(tables)
  foreach(folder IN LISTS ARGN)
    cmake_path(GET folder FILENAME layer)
    list(APPEND tables ${PROJECT_SOURCE_DIR}/${folder}/facts.json)
    list(APPEND headers ${out}/${layer}/facts.h)
  endforeach()
  add_custom_command(
    OUTPUT ${out}/facts.cpp ${headers}
    COMMAND Python3::Interpreter ${meshgraft_facts_tool} types ${namespace} ${out} ${tables}
    DEPENDS ${meshgraft_facts_tool} ${tables} COMMENT "Making the records of facts of ${target}" VERBATIM)
  add_custom_target(${target}_fact_headers DEPENDS ${headers})
  add_dependencies(${target} ${target}_fact_headers)
  add_dependencies(meshgraft_generated ${target}_fact_headers)
  target_sources(${target} PRIVATE ${out}/facts.cpp)
  set_source_files_properties(${out}/facts.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${out}>)
endfunction()

# meshgraft_texts(target folder): makes "FOLDER/texts.inc" of FOLDER/texts.json, an interface's own texts of facts. They
# are checked against the tables of src and of the folder.
function(meshgraft_texts target folder)
  file(GLOB_RECURSE tables CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/facts.json)
  list(APPEND tables ${PROJECT_SOURCE_DIR}/${folder}/facts.json)
  set(texts ${PROJECT_SOURCE_DIR}/${folder}/texts.json)
  set(out ${PROJECT_BINARY_DIR}/facts/${target}/${folder}/texts.inc)
  add_custom_command(
    OUTPUT ${out} COMMAND Python3::Interpreter ${meshgraft_facts_tool} texts ${out} ${texts} ${tables}
    DEPENDS ${meshgraft_facts_tool} ${texts} ${tables} COMMENT "Making the texts of facts of ${target}" VERBATIM)
  add_custom_target(${target}_texts DEPENDS ${out})
  add_dependencies(${target} ${target}_texts)
  add_dependencies(meshgraft_generated ${target}_texts)
endfunction()
