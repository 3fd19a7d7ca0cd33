# Writes thimble_version.h, if it says something new: cmake -DSOURCE=ROOT -DVERSION=N -DTODAY=DAY -DOUT=FILE -P
# version.cmake. A folder that is no clone itself has no commit, even if it lies in somebody's repository.
cmake_minimum_required(VERSION 3.20)
set(commit unknown)
set(date ${TODAY})
if(EXISTS ${SOURCE}/.git)
  execute_process(COMMAND git -C ${SOURCE} log -1 --abbrev=12 --format=%h,%cs OUTPUT_VARIABLE said
    ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status)
  if("${status}" STREQUAL "0" AND said MATCHES "^([0-9a-f]+),([-0-9]+)$")
    set(commit ${CMAKE_MATCH_1})
    set(date ${CMAKE_MATCH_2})
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT
  "#define THIMBLE_VERSION \"@VERSION@\"\n#define THIMBLE_COMMIT \"@commit@\"\n#define THIMBLE_DATE \"@date@\"\n"
  @ONLY)
