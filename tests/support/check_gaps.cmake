# meshgraft_measure_check_gaps(target): lets CheckGaps see the checks for cancellation. The linker sends the library's
# calls of both functions to check_gaps.cpp.
set(meshgraft_check_gaps_source ${CMAKE_CURRENT_LIST_DIR}/check_gaps.cpp)
function(meshgraft_measure_check_gaps target)
  target_sources(${target} PRIVATE ${meshgraft_check_gaps_source})
  target_link_options(${target} PRIVATE
    LINKER:--wrap=_ZNK9meshgraft7Context4stepESt17basic_string_viewIcSt11char_traitsIcEEd
    LINKER:--wrap=_ZNK9meshgraft7Context16throw_if_stoppedEv)
endfunction()
