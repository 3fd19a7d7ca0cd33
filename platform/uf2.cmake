# Images for boards that show up as a drive (BOARD_UF2), for image.cmake.

# What makes APP.uf2 of APP.elf: a program for this machine, so its own compiler builds it.
function(thimble_find_make_uf2)
  find_program(THIMBLE_HOST_CXX NAMES c++ g++ clang++ REQUIRED)
  set(source ${THIMBLE_PLATFORM_DIR}/uf2/make_uf2.cpp ${THIMBLE_PLATFORM_DIR}/images/image_file.cpp)
  set(program ${PROJECT_BINARY_DIR}/make_uf2)
  add_custom_command(OUTPUT ${program} DEPENDS ${source} ${THIMBLE_PLATFORM_DIR}/images/image_file.h VERBATIM
    COMMAND ${THIMBLE_HOST_CXX} -std=c++20 -O1 -o ${program} ${source})
  add_custom_target(thimble_make_uf2 DEPENDS ${program})
endfunction()

# After the link of `image`, and before other files are made from it.
function(thimble_add_uf2 image)
  add_dependencies(${image} thimble_make_uf2)
  add_custom_command(TARGET ${image} POST_BUILD BYPRODUCTS ${image}.uf2 VERBATIM
    COMMAND ${PROJECT_BINARY_DIR}/make_uf2 ${image}.elf ${image}.uf2 ${BOARD_UF2})
endfunction()
