# How an image is linked, for firmware.cmake.
include(${THIMBLE_PLATFORM_DIR}/uf2.cmake)

# Sources with functions that run from the core's own RAM (BOARD_FAST_RAM_BYTES): ARM code, since that RAM is 32
# bits wide.
foreach(source IN LISTS BOARD_FAST_SOURCES)
  foreach(part thimble thimble_port thimble_board)
    set_property(SOURCE ${PROJECT_SOURCE_DIR}/${source} TARGET_DIRECTORY ${part} PROPERTY COMPILE_OPTIONS
      ${THIMBLE_FAST_FLAGS})
  endforeach()
endforeach()

if(BOARD_FAST_RAM_BYTES)
  target_compile_definitions(thimble PRIVATE THIMBLE_FAST_RAM)
endif()

# The linker scripts: flash.ld, and where a loader puts images into RAM, too, ram.ld (firmware.ld.in).
function(thimble_write_linker_script place)
  set(IMAGE_PLACE ${place})
  set(IMAGE_STACK RAM)
  set(IMAGE_FAST_MEMORY "")
  set(IMAGE_FAST_SECTIONS "")
  if(BOARD_FAST_RAM_BYTES)
    set(IMAGE_STACK FAST)
    set(IMAGE_FAST_MEMORY "  FAST (rwx) : ORIGIN = ${BOARD_FAST_RAM_ORIGIN}, LENGTH = ${BOARD_FAST_RAM_BYTES}\n")
    # Frames with light by the map have the same loops once more, for which there is no room beside.
    set(functions "    *(EXCLUDE_FILE(*flat.cpp.o*) .text.hot EXCLUDE_FILE(*flat.cpp.o*) .text.hot.*)\n")
    foreach(source IN LISTS BOARD_FAST_SOURCES)
      get_filename_component(name ${source} NAME)
      string(APPEND functions "    *${name}.o*(.rodata._Z*E)\n")
    endforeach()
    foreach(object IN LISTS BOARD_FAST_OBJECTS)
      string(APPEND functions "    *${object}(.text .text.*)\n")
    endforeach()
    set(IMAGE_FAST_SECTIONS "  .boot :
  {
    KEEP(*(.boot_${place}))
    KEEP(*(.vectors))
  } > FLASH
  .fast : ALIGN(4)
  {
    thimble_fast_start = .;
${functions}    . = ALIGN(4);
    thimble_fast_end = .;
  } > FAST AT > FLASH
  thimble_fast_image = LOADADDR(.fast);
")
  endif()
  if(place STREQUAL "flash")
    set(IMAGE_ORIGIN ${BOARD_FLASH_ORIGIN})
    set(IMAGE_BYTES ${BOARD_FLASH_BYTES})
    set(IMAGE_DATA "RAM AT > FLASH")
    set(IMAGE_BSS RAM)
  else()
    math(EXPR IMAGE_ORIGIN "${BOARD_RAM_ORIGIN} + ${BOARD_STACK_BYTES}" OUTPUT_FORMAT HEXADECIMAL)
    math(EXPR IMAGE_BYTES "${BOARD_RAM_BYTES} - ${BOARD_STACK_BYTES}")
    set(IMAGE_DATA FLASH)
    set(IMAGE_BSS FLASH)
  endif()
  configure_file(${THIMBLE_PLATFORM_DIR}/arch/common/firmware.ld.in ${generated}/${place}.ld @ONLY)
endfunction()
thimble_write_linker_script(flash)
# What stands in .semihosting of images for emulators.
file(WRITE ${generated}/semihosting "yes!")
if(BOARD_UF2)
  thimble_find_make_uf2()
  thimble_write_linker_script(ram)
endif()

# An image: APP.elf, APP.bin, APP.hex from `ARGN`, with whatever of the libraries that needs; APP.uf2 for BOARD_UF2; and
# APP.emulated.elf (or .uf2, .BOARD_IMAGE), which tells an emulator its exit status. `place` is flash or ram.
function(thimble_add_image_in place app)
  add_executable(${app} ${ARGN})
  set(script ${generated}/${place}.ld)
  set_target_properties(${app} PROPERTIES SUFFIX .elf LINK_DEPENDS ${script})
  target_include_directories(${app} PRIVATE ${THIMBLE_PLATFORM_DIR})
  set(stack ${BOARD_STACK_BYTES})
  if(DEFINED BOARD_STACK_BYTES_${app})
    set(stack ${BOARD_STACK_BYTES_${app}})
  endif()
  target_link_options(${app} PRIVATE ${THIMBLE_ARCH_FLAGS} -nostdlib -T ${script}
    -Wl,--defsym=thimble_stack_bytes=${stack}
    # --nmagic: segments hold sections alone, not the headers of the file in front of them, which would lie on other memory.
    -Wl,--nmagic,--gc-sections,--no-warn-rwx-segments,-Map=${app}.map)
  target_link_libraries(${app} PRIVATE thimble_firmware_flags thimble_warnings thimble_board thimble_apps
    thimble thimble_port gcc)
  set(others)
  if(BOARD_UF2)
    thimble_add_uf2(${app})
    set(others COMMAND ${PROJECT_BINARY_DIR}/make_uf2 ${app}.emulated.elf ${app}.emulated.uf2 ${BOARD_UF2})
  elseif(BOARD_IMAGE)
    set(others COMMAND ${CMAKE_OBJCOPY} -O binary ${app}.elf ${app}.${BOARD_IMAGE}
      COMMAND ${CMAKE_OBJCOPY} -O binary ${app}.emulated.elf ${app}.emulated.${BOARD_IMAGE})
  endif()
  add_custom_command(TARGET ${app} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} --update-section .semihosting=${generated}/semihosting ${app}.elf ${app}.emulated.elf
    ${others}
    COMMAND ${CMAKE_OBJCOPY} -O binary ${app}.elf ${app}.bin
    COMMAND ${CMAKE_OBJCOPY} -O ihex ${app}.elf ${app}.hex
    COMMAND ${CMAKE_COMMAND} -DPREFIX=${THIMBLE_BINUTILS_PREFIX} -DBOARD=${BOARD_NAME} -DAPP=${app}
      -DFLASH_BYTES=${BOARD_FLASH_BYTES} -DRAM_BYTES=${BOARD_RAM_BYTES} -DPLACE=${place}
      -P ${THIMBLE_PLATFORM_DIR}/memory_table.cmake
    BYPRODUCTS ${app}.bin ${app}.hex ${app}.emulated.elf VERBATIM)
endfunction()

function(thimble_add_image app)
  thimble_add_image_in(flash ${app} ${ARGN})
endfunction()
