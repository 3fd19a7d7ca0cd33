# Firmware for one board: -DTHIMBLE_BOARD=NAME, the toolchain file of its kind of core, and
#
#   THIMBLE_APP            which applications, a list (demo): each becomes APP.elf, APP.bin and APP.hex (and APP.uf2)
#   THIMBLE_MAIN           a source that has such an application in place of platform/apps (tools/new/port.cpp.in)
#   THIMBLE_SCENE_HEADER   a header made by `thimble bake`; without it port::scene() is empty
#   THIMBLE_SCENE_IN_FLASH a set of effects (0x3f0b): the scene is what lies behind the program and has effects within the
#                          set, and that of the header where there is none (images/README.md)
#   THIMBLE_FRAMES         how many frames an application draws; 0: it does not end by itself
#   THIMBLE_HOLD_FPS       the rate of frames that an application holds from its start; 0: none
#   THIMBLE_HOLD           whether it then waits for a `q` over the UART, its last frame shown (false)
#
# Says flash, RAM and stack of each image after its link. platform/build.sh calls this.
set(THIMBLE_APP demo CACHE STRING "Applications to build")
set(THIMBLE_SCENE_HEADER "" CACHE FILEPATH "Baked scene")
set(THIMBLE_SCENE_IN_FLASH "" CACHE STRING "Effects of scenes behind the program")
set(THIMBLE_FRAMES 0 CACHE STRING "Frames before the application ends; 0: for ever")
set(THIMBLE_HOLD_FPS 0 CACHE STRING "Rate of frames to hold from the start; 0: none")
set(THIMBLE_HOLD false CACHE STRING "Wait at the end: true or false")

thimble_list_boards(THIMBLE_BOARDS)
if(NOT THIMBLE_BOARD IN_LIST THIMBLE_BOARDS)
  string(REPLACE ";" " " known "${THIMBLE_BOARDS}")
  message(FATAL_ERROR "there is no board ${THIMBLE_BOARD}; the boards are: ${known}")
endif()
set(BOARD_NAME ${THIMBLE_BOARD})
thimble_read_board(${BOARD_NAME})
set(THIMBLE_PLATFORM_DIR ${PROJECT_SOURCE_DIR}/platform)
include(${THIMBLE_PLATFORM_DIR}/frames.cmake)
include(${THIMBLE_PLATFORM_DIR}/arch/${BOARD_ARCH}/flags.cmake)
if(NOT DEFINED THIMBLE_BINUTILS_PREFIX)
  message(FATAL_ERROR
    "firmware for ${BOARD_NAME} wants --toolchain platform/arch/${BOARD_ARCH}/toolchain.cmake")
endif()

# Facts and layout.
thimble_capitalise(THIMBLE_FORMAT ${BOARD_FORMAT})
set(THIMBLE_HAS_DISPLAY true)
if(BOARD_DISPLAY STREQUAL "none")
  set(THIMBLE_HAS_DISPLAY false)
endif()
set(generated ${PROJECT_BINARY_DIR}/generated)
configure_file(${THIMBLE_PLATFORM_DIR}/arch/common/facts.h.in ${generated}/thimble_board_facts.h @ONLY)
set(THIMBLE_SCENE_INCLUDE "")
set(THIMBLE_SCENE_BYTES "{}")
if(THIMBLE_SCENE_HEADER)
  set(THIMBLE_SCENE_INCLUDE "#include \"${THIMBLE_SCENE_HEADER}\"")
  set(THIMBLE_SCENE_BYTES "{thimble_scene, sizeof(thimble_scene)}")
endif()
include(${THIMBLE_PLATFORM_DIR}/scene_facts.cmake)
configure_file(${THIMBLE_PLATFORM_DIR}/arch/common/scene.cpp.in ${generated}/scene.cpp @ONLY)

string(COMPARE NOTEQUAL "${THIMBLE_SCENE_IN_FLASH}" "" scene_in_flash)
# One set of flags for the core, the port and the applications.
add_library(thimble_firmware_flags INTERFACE)
target_compile_options(thimble_firmware_flags INTERFACE ${THIMBLE_ARCH_FLAGS}
  -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -fno-unwind-tables
  -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections
  # The bound of the stack is computed from the call graph; without -fno-ipa-icf functions vanish from it.
  -fcallgraph-info=su,da -fno-ipa-icf)
target_compile_definitions(thimble_firmware_flags INTERFACE $<$<BOOL:${BOARD_CORES}>:THIMBLE_CORES=${BOARD_CORES}>
  $<$<BOOL:${BOARD_BAND_BUFFERS}>:THIMBLE_BAND_BUFFERS=${BOARD_BAND_BUFFERS}> $<$<BOOL:${BOARD_FLUSHES_AGAIN}>:THIMBLE_FLUSHES_AGAIN>)
# The core for speed, the rest for size. The demonstration with the core for size, too, takes 1.26 times the
# instructions a frame on a Cortex-M3, 1.04 on a Cortex-M0 and 1.47 on RV32, for 12 to 18 KB less flash.
# Scheduling before registers are handed out keeps more values alive than these chips have registers for: 2
# per cent of a frame.
target_compile_options(thimble PRIVATE -O2 -fno-schedule-insns)
target_link_libraries(thimble PRIVATE thimble_firmware_flags)

# The port: a library, so that an image takes what it needs and a board may replace any part.
file(GLOB sources CONFIGURE_DEPENDS ${THIMBLE_PLATFORM_DIR}/arch/common/*.cpp
  ${THIMBLE_PLATFORM_DIR}/arch/${BOARD_ARCH}/*.cpp ${THIMBLE_PLATFORM_DIR}/drivers/${THIMBLE_UART}.cpp)
list(FILTER sources EXCLUDE REGEX "/common/main\\.cpp$")
add_library(thimble_port STATIC ${sources} ${generated}/scene.cpp)
set(board_folders ${THIMBLE_PLATFORM_DIR}/boards/${BOARD_NAME})
foreach(folder IN LISTS BOARD_CHIP)
  list(APPEND board_folders ${THIMBLE_PLATFORM_DIR}/chips/${folder})
endforeach()
list(TRANSFORM board_folders APPEND /*.cpp OUTPUT_VARIABLE board_sources)
file(GLOB sources CONFIGURE_DEPENDS ${board_sources})
add_library(thimble_board OBJECT ${sources})
include(${THIMBLE_PLATFORM_DIR}/apps.cmake)
thimble_list_app_sources(sources)
add_library(thimble_apps STATIC ${sources})
# They take objects from an arena, whose bytes are aligned as they asked.
add_library(thimble_app_warnings INTERFACE)
target_compile_options(thimble_app_warnings INTERFACE -Wno-cast-align)
# Cases without names and expressions where these would fill the flash: a failure then gives its file and
# line.
if(BOARD_FLASH_BYTES LESS_EQUAL 131072)
  target_compile_definitions(thimble_apps PRIVATE THIMBLE_TERSE_CASES)
endif()
# Holding a rate of frames takes 10 KB of code and a whole frame of RAM.
if(BOARD_VISITS_A_SECOND EQUAL 0)
  target_compile_definitions(thimble_apps PRIVATE THIMBLE_NO_HOLD)
endif()
thimble_choose_frames()
thimble_choose_formats()
foreach(part thimble_port thimble_board thimble_apps)
  target_include_directories(${part} PRIVATE ${THIMBLE_PLATFORM_DIR} ${generated})
  target_compile_options(${part} PRIVATE -Os)
  # The core, which needs to know neither, is not compiled again for them.
  target_compile_definitions(${part} PRIVATE $<$<BOOL:${scene_in_flash}>:THIMBLE_SCENE_IN_FLASH> $<$<BOOL:${THIMBLE_HOLD}>:THIMBLE_HOLDS>)
  target_link_libraries(${part} PRIVATE thimble thimble_firmware_flags thimble_warnings)
endforeach()
target_include_directories(thimble_port PRIVATE ${THIMBLE_PLATFORM_DIR}/arch)
target_include_directories(thimble_board PRIVATE ${THIMBLE_PLATFORM_DIR}/arch ${board_folders})
target_include_directories(thimble_apps PRIVATE ${PROJECT_SOURCE_DIR}/tests)
# Those that draw a scene with light (apps/scene_light.h).
set_source_files_properties(${THIMBLE_PLATFORM_DIR}/apps/demo.cpp ${THIMBLE_PLATFORM_DIR}/apps/bench.cpp
  ${THIMBLE_PLATFORM_DIR}/apps/water.cpp PROPERTIES
  COMPILE_DEFINITIONS "THIMBLE_IMAGE_EFFECTS=${THIMBLE_IMAGE_EFFECTS};THIMBLE_IMAGE_LAMPS=${THIMBLE_IMAGE_LAMPS}")
target_link_libraries(thimble_apps PRIVATE thimble_app_warnings)
set_source_files_properties(${THIMBLE_PLATFORM_DIR}/arch/common/memory.cpp PROPERTIES
  COMPILE_OPTIONS -fno-tree-loop-distribute-patterns)

include(${THIMBLE_PLATFORM_DIR}/image.cmake)
foreach(app IN LISTS THIMBLE_APP)
  thimble_add_application(${app})
endforeach()
include(${THIMBLE_PLATFORM_DIR}/effect_images.cmake)
