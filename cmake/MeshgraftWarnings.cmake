# Warnings for our own targets; meshgraft_warnings(target). Clang warns of libstdc++'s own use of get_temporary_buffer.
function(meshgraft_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                         -Wno-missing-field-initializers $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                         $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations>)
endfunction()
