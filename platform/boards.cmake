# The boards, from their board.cmake files: lists for the build and a table for the host's C++.

# The names of all boards, in alphabetical order.
function(thimble_list_boards names)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/platform/boards/*/board.cmake)
  set(found)
  foreach(file IN LISTS files)
    get_filename_component(folder ${file} DIRECTORY)
    get_filename_component(name ${folder} NAME)
    list(APPEND found ${name})
  endforeach()
  list(SORT found)
  set(${names} ${found} PARENT_SCOPE)
endfunction()

# Sets the BOARD_... variables of one board in the caller's scope, and refuses a file that leaves one out.
macro(thimble_read_board name)
  set(facts TITLE ARCH CPU FLASH_ORIGIN FLASH_BYTES RAM_ORIGIN RAM_BYTES STACK_BYTES DISPLAY WIDTH_PX HEIGHT_PX
    FORMAT BUTTONS QEMU PROBE CLOCK_MHZ ICOUNT_SHIFT VISITS_A_SECOND FRAME_INSTRUCTIONS CATCHES)
  foreach(fact IN LISTS facts)
    unset(BOARD_${fact})
  endforeach()
  foreach(fact CHIP FRAMES UF2 IMAGE CORE_MHZ BAND_BUFFERS FAST_RAM_ORIGIN FAST_RAM_BYTES FAST_SOURCES FAST_FUNCTIONS)
    unset(BOARD_${fact})
  endforeach()
  include(${PROJECT_SOURCE_DIR}/platform/boards/${name}/board.cmake)
  if(NOT DEFINED BOARD_CORE_MHZ)
    set(BOARD_CORE_MHZ ${BOARD_CLOCK_MHZ})
  endif()
  foreach(fact IN LISTS facts)
    if(NOT DEFINED BOARD_${fact})
      message(FATAL_ERROR "platform/boards/${name}/board.cmake does not set BOARD_${fact}")
    endif()
  endforeach()
endmacro()

# gray4 -> Gray4, gray4_low -> Gray4Low
function(thimble_capitalise result words)
  string(REPLACE "_" ";" words ${words})
  set(all)
  foreach(word IN LISTS words)
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND all ${first}${rest})
  endforeach()
  set(${result} ${all} PARENT_SCOPE)
endfunction()

# Writes `file`: one line of C++ initialisers a board, in the order of the members of BoardFacts
# (platform/boards/board_table.h).
function(thimble_write_board_table file)
  thimble_list_boards(names)
  set(text "// Made from platform/boards/*/board.cmake.\n")
  foreach(name IN LISTS names)
    thimble_read_board(${name})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
      ${PROJECT_SOURCE_DIR}/platform/boards/${name}/board.cmake)
    set(app_stacks)
    foreach(app selftest golden lit worlds bricks demo water bench particles)
      if(DEFINED BOARD_STACK_BYTES_${app})
        string(APPEND app_stacks "{\"${app}\", ${BOARD_STACK_BYTES_${app}}}, ")
      endif()
      unset(BOARD_STACK_BYTES_${app})
    endforeach()
    set(band_buffers 1)
    if(BOARD_BAND_BUFFERS)
      set(band_buffers ${BOARD_BAND_BUFFERS})
    endif()
    thimble_capitalise(format ${BOARD_FORMAT})
    thimble_capitalise(screen ${BOARD_DISPLAY})
    string(APPEND text "{\"${name}\", \"${BOARD_TITLE}\", \"${BOARD_CPU}\", ${BOARD_RAM_BYTES}, "
      "${BOARD_FLASH_BYTES}, ${BOARD_STACK_BYTES}, Screen::k${screen}, PixelFormat::k${format}, ${BOARD_WIDTH_PX}, "
      "${BOARD_HEIGHT_PX}, ${BOARD_BUTTONS}, ${BOARD_VISITS_A_SECOND}, ${BOARD_CORE_MHZ}, ${BOARD_FRAME_INSTRUCTIONS}, "
      "${band_buffers}, {${app_stacks}}},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
endfunction()
