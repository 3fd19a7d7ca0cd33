# The build of selftest.sh's small tree: just enough for clang-tidy to know its flags.
cmake_minimum_required(VERSION 3.20)
project(tree LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
file(GLOB_RECURSE sources src/*.cpp)
add_library(tree ${sources})
set_target_properties(tree PROPERTIES UNITY_BUILD ${THIMBLE_UNITY} UNITY_BUILD_CODE_BEFORE_INCLUDE
  "// NOLINTNEXTLINE(bugprone-suspicious-include)")
target_include_directories(tree PRIVATE include)
# What is generated before it is linted: nothing.
add_custom_target(thimble_generated)
