# Says what an image takes of its board, and writes it to APP.memory.csv: cmake -DPREFIX= -DBOARD= -DAPP=
# -DFLASH_BYTES= -DRAM_BYTES= -P memory_table.cmake, in the folder of APP.elf.
execute_process(COMMAND ${PREFIX}size -A -d ${APP}.elf OUTPUT_VARIABLE sizes COMMAND_ERROR_IS_FATAL ANY)
foreach(section text rodata stack data bss)
  set(${section} 0)
  if(sizes MATCHES "\n\\.${section} +([0-9]+)")
    set(${section} ${CMAKE_MATCH_1})
  endif()
endforeach()
math(EXPR flash "${text} + ${rodata} + ${data}")
math(EXPR ram "${data} + ${bss}")
math(EXPR arena "${RAM_BYTES} - ${ram} - ${stack}")
file(WRITE ${APP}.memory.csv "${BOARD},${APP},${flash},${ram},${stack},${arena}\n")
message("${BOARD} ${APP}: flash ${flash} of ${FLASH_BYTES}, RAM ${RAM_BYTES} = data and bss ${ram} + stack ${stack} + arena ${arena}")
