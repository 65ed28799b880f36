# BELTFLOW_BUILD, the name of what is built. dpkg orders the three as they stand here:
#     0.2.0~1520.gabc1234    1520 commits, and no tag v0.2.0 among them
#     0.2.0                  the tag v0.2.0, or no git (a tarball)
#     0.2.0+3.gabc1234       three commits after the tag

set(BELTFLOW_BUILD ${PROJECT_VERSION})
set(of_git ${CMAKE_COMMAND} -E env GIT_CEILING_DIRECTORIES=${CMAKE_SOURCE_DIR}/.. git -C ${CMAKE_SOURCE_DIR})
execute_process(COMMAND ${of_git} describe --tags --long --abbrev=7 --match v${PROJECT_VERSION}
  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE is_untagged)
if(NOT is_untagged AND described MATCHES "-([1-9][0-9]*)-(g[0-9a-f]+)$")
  string(APPEND BELTFLOW_BUILD "+${CMAKE_MATCH_1}.${CMAKE_MATCH_2}")
elseif(is_untagged)
  execute_process(COMMAND ${of_git} rev-list --count HEAD
    OUTPUT_VARIABLE n_commits OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE has_no_git)
  execute_process(COMMAND ${of_git} rev-parse --short=7 HEAD
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT has_no_git)
    string(APPEND BELTFLOW_BUILD "~${n_commits}.g${commit}")
  endif()
endif()
