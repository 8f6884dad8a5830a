# meshgraft_layer(LAYER): adds meshgraft_layer_LAYER, the objects of one layer. Its folder's CMakeLists.txt lists its
# sources, and its target_link_libraries name the layers that it may use (tools/check_layers.py reads them there) and
# the libraries of others that it needs.
function(meshgraft_layer layer)
  set(target meshgraft_layer_${layer})
  add_library(${target} OBJECT)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include
                                              ${PROJECT_SOURCE_DIR}/src)
  if(NOT layer STREQUAL facts)
    target_link_libraries(${target} PUBLIC meshgraft_layer_facts)
  endif()
  meshgraft_warnings(${target})
  cmake_language(EVAL CODE "cmake_language(DEFER CALL meshgraft_unity ${target})")  # when all sources are listed
endfunction()

# meshgraft_gather(library LAYER…): puts the objects of layers into a library and links what they need from others.
function(meshgraft_gather library)
  set_target_properties(${library} PROPERTIES LINKER_LANGUAGE CXX)
  foreach(layer IN LISTS ARGN)
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:meshgraft_layer_${layer}>)
    get_target_property(linked meshgraft_layer_${layer} LINK_LIBRARIES)
    if(linked)
      list(FILTER linked EXCLUDE REGEX "^meshgraft_layer_")
      target_link_libraries(${library} PRIVATE ${linked})
    endif()
  endforeach()
endfunction()

# meshgraft_publish(library NAME): the library is installed, as meshgraft::NAME.
function(meshgraft_publish library name)
  add_library(meshgraft::${name} ALIAS ${library})
  target_compile_features(${library} PUBLIC cxx_std_20)
  set_target_properties(${library} PROPERTIES
    EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}  # before 1.0 a minor version may change the interface
    INSTALL_RPATH $ORIGIN)                                       # shared ones find each other
  set_property(GLOBAL APPEND PROPERTY meshgraft_published ${library})
endfunction()

# meshgraft_used_layers(variable LAYER): sets the variable to the layers that a layer may use.
function(meshgraft_used_layers variable layer)
  get_target_property(linked meshgraft_layer_${layer} LINK_LIBRARIES)
  list(FILTER linked INCLUDE REGEX "^meshgraft_layer_")
  list(TRANSFORM linked REPLACE "^meshgraft_layer_" "")
  set(${variable} ${linked} PARENT_SCOPE)
endfunction()
