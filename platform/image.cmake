# How an image is linked, for firmware.cmake.

# An image: APP.elf, APP.bin, APP.hex from `ARGN`, with whatever of the libraries that needs.
function(thimble_add_image app)
  add_executable(${app} ${ARGN})
  set_target_properties(${app} PROPERTIES SUFFIX .elf LINK_DEPENDS ${generated}/firmware.ld)
  target_include_directories(${app} PRIVATE ${THIMBLE_PLATFORM_DIR})
  set(stack ${BOARD_STACK_BYTES})
  if(DEFINED BOARD_STACK_BYTES_${app})
    set(stack ${BOARD_STACK_BYTES_${app}})
  endif()
  target_link_options(${app} PRIVATE ${THIMBLE_ARCH_FLAGS} -nostdlib -T ${generated}/firmware.ld
    -Wl,--defsym=thimble_stack_bytes=${stack}
    -Wl,--gc-sections,--no-warn-rwx-segments,-Map=${app}.map)
  target_link_libraries(${app} PRIVATE thimble_firmware_flags thimble_warnings thimble_board thimble_apps
    thimble thimble_port gcc)
  add_custom_command(TARGET ${app} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} -O binary ${app}.elf ${app}.bin
    COMMAND ${CMAKE_OBJCOPY} -O ihex ${app}.elf ${app}.hex
    COMMAND ${CMAKE_COMMAND} -DPREFIX=${THIMBLE_BINUTILS_PREFIX} -DBOARD=${BOARD_NAME} -DAPP=${app}
      -DFLASH_BYTES=${BOARD_FLASH_BYTES} -DRAM_BYTES=${BOARD_RAM_BYTES}
      -P ${THIMBLE_PLATFORM_DIR}/memory_table.cmake
    BYPRODUCTS ${app}.bin ${app}.hex VERBATIM)
endfunction()
