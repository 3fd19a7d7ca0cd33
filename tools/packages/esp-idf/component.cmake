# The core as a component of ESP-IDF. IDF first reads this without a project, and leaves where it registers.
get_filename_component(thimble_root ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
file(GLOB_RECURSE thimble_sources ${thimble_root}/src/*.cpp)
idf_component_register(SRCS ${thimble_sources} INCLUDE_DIRS ${thimble_root}/include)
target_compile_options(${COMPONENT_LIB} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics)
