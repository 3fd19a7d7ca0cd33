# What applications are made of, and their images.
# Applications and what they share; the frames and cases that the tests share with them.
function(thimble_list_app_sources result)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${THIMBLE_PLATFORM_DIR}/apps/*.cpp
    ${PROJECT_SOURCE_DIR}/tests/boards/apps/*.cpp ${PROJECT_SOURCE_DIR}/tests/portable/*.cpp
    ${PROJECT_SOURCE_DIR}/tests/golden/scenes.cpp)
  # Not what no image asks for: the tests' cases and the larger applications take longer to compile than the demonstration.
  foreach(app bench dig water)
    if(NOT app IN_LIST THIMBLE_APP)
      list(FILTER sources EXCLUDE REGEX "/apps/${app}\\.cpp$")
    endif()
  endforeach()
  if(THIMBLE_MAIN)
    set(${result} ${THIMBLE_MAIN} PARENT_SCOPE)
    return()
  endif()
  set(cases ${THIMBLE_APP})
  list(REMOVE_ITEM cases demo bench dig water particles faults)
  include(${PROJECT_SOURCE_DIR}/tests/portable/golden_trees.cmake)
  thimble_golden_trees()
  if(NOT cases)
    list(FILTER sources EXCLUDE REGEX "/tests/(portable|golden)/|/boards/apps/cases[.]cpp$")
  endif()
  set(${result} ${sources} PARENT_SCOPE)
endfunction()

# An application's image; for BOARD_UF2 also one for RAM, which is built by itself, since not all that fits into
# flash fits there (build.sh).
function(thimble_add_application app)
  set(main ${THIMBLE_PLATFORM_DIR}/arch/common/main.cpp)
  thimble_add_image(${app} ${main})
  target_compile_definitions(${app} PRIVATE THIMBLE_APPLICATION=${app})
  if(BOARD_UF2)
    thimble_add_image_in(ram ${app}_ram ${main})
    set_target_properties(${app}_ram PROPERTIES EXCLUDE_FROM_ALL ON)
    target_compile_definitions(${app}_ram PRIVATE THIMBLE_APPLICATION=${app})
  endif()
endfunction()
