# Warnings for our own targets; meshgraft_warnings(target).
function(meshgraft_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-restrict
                         -Wno-missing-field-initializers)
endfunction()
