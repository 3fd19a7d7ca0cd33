# thimble_golden_trees(): the numbers of golden_trees.bin, for golden_trees.cpp where this directory compiles it.
function(thimble_golden_trees)
  set(here ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${here}/golden_trees.bin)
  file(READ ${here}/golden_trees.bin bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes ${bytes})
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/portable/golden_trees.inc CONTENT "${bytes}\n")
  set_source_files_properties(${here}/golden_trees.cpp PROPERTIES INCLUDE_DIRECTORIES ${PROJECT_BINARY_DIR}/generated)
endfunction()
