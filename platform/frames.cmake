# Which frames an image draws, for firmware.cmake: those of BOARD_FRAMES, or of sizes that are measured only.
#
#   THIMBLE_FACTS      facts of the board to replace, each NAME=VALUE (none): other pictures, another core
#   THIMBLE_MEASURED   whether `bench` measures the fastest engine alone (OFF)
#   THIMBLE_CASE_STEP  `golden` runs every Nth case (1), where the emulator is slow
set(THIMBLE_FACTS "" CACHE STRING "Facts of the board to replace, NAME=VALUE")
set(THIMBLE_MEASURED OFF CACHE BOOL "bench measures the fastest engine alone")
set(THIMBLE_CASE_STEP 1 CACHE STRING "Every Nth test case is run")

foreach(fact IN LISTS THIMBLE_FACTS)
  string(REGEX MATCH "^([A-Z_]+)=(.+)$" found "${fact}")
  if(NOT DEFINED BOARD_${CMAKE_MATCH_1})
    message(FATAL_ERROR "THIMBLE_FACTS: ${fact} is no NAME=VALUE of a fact of a board")
  endif()
  set(BOARD_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
endforeach()

# The formats behind rgb888 that an image has: the board's, if it is one of them (picture/pixel.h). `selftest`
# and `golden` try all of those that there are.
set(THIMBLE_PANEL_FORMATS "" CACHE STRING "Formats behind rgb888 in the images, a mask; empty: the board's")
function(thimble_choose_formats)
  set(formats rgb565_be bgr565 rgb444 mono1_pages gray4_low gray2 paper3 paper7 rgb332)
  list(FIND formats "${BOARD_FORMAT}" number)
  set(mask ${THIMBLE_PANEL_FORMATS})
  if("${mask}" STREQUAL "")
    set(mask 0)
    if(NOT number EQUAL -1)
      math(EXPR mask "32 << ${number}")
    endif()
  endif()
  target_compile_definitions(thimble PUBLIC THIMBLE_PANEL_FORMATS=${mask}U)
  if("${BOARD_FORMAT}" MATCHES "^mono1")  # frames are ink (picture/ink.h)
    target_compile_definitions(thimble_apps PRIVATE THIMBLE_INK)
  endif()
endfunction()

function(thimble_choose_frames)
  # Lit frames by the map whose points send rays of their own (occlusion, mirrors, water; lamps) take long to compile: an image
  # has those of its scene's effects.
  if(scene_in_flash AND NOT THIMBLE_IMAGE_EFFECTS STREQUAL "0")
    set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/light/flat/flat.cpp TARGET_DIRECTORY thimble APPEND PROPERTY
      COMPILE_DEFINITIONS "THIMBLE_FLAT_WITHIN=${THIMBLE_IMAGE_EFFECTS}")
  elseif(NOT "map_light" IN_LIST THIMBLE_APP)
    set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/light/flat/flat.cpp TARGET_DIRECTORY thimble APPEND PROPERTY
      COMPILE_DEFINITIONS "THIMBLE_FLAT_EFFECTS=${THIMBLE_IMAGE_EFFECTS};THIMBLE_FLAT_LAMPS=${THIMBLE_IMAGE_LAMPS}")
  endif()
  set(wet_stack_bytes 7296)
  # Pictures of up to 160 x 128 do without what larger ones take (picture/render.h).
  if("${BOARD_FRAMES}" STREQUAL "small")
    target_compile_definitions(thimble PUBLIC THIMBLE_SMALL_FRAMES)
    set(wet_stack_bytes 4096)
  elseif(NOT "${BOARD_FRAMES}" MATCHES "^(large)?$")
    message(FATAL_ERROR "BOARD_FRAMES of ${BOARD_NAME} is ${BOARD_FRAMES}; it may be small, large, or left out")
  endif()
  # Brick maps and frames by them for worlds of level 9 and 10 (tree/brick_map.h), 95 KB of code.
  if("${BOARD_WORLDS}" STREQUAL "deep")
    target_compile_definitions(thimble PUBLIC THIMBLE_DEEP_WORLDS)
  elseif(NOT "${BOARD_WORLDS}" STREQUAL "")
    message(FATAL_ERROR "BOARD_WORLDS of ${BOARD_NAME} is ${BOARD_WORLDS}; it may be deep, or left out")
  endif()
  # Water by the map takes more stack than some boards keep, which draw it by the tree.
  if(BOARD_STACK_BYTES LESS wet_stack_bytes)
    target_compile_definitions(thimble_apps PRIVATE THIMBLE_WATER_BY_TREE)
  endif()
  if(THIMBLE_MEASURED)
    target_compile_definitions(thimble_apps PRIVATE THIMBLE_MEASURED)
  endif()
  if(NOT THIMBLE_CASE_STEP EQUAL 1)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/tests/boards/apps/cases.cpp PROPERTIES
      COMPILE_DEFINITIONS THIMBLE_CASE_STEP=${THIMBLE_CASE_STEP})
  endif()
endfunction()
