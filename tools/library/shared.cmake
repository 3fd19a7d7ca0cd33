# For each folder whose objects are part of the shared library and of Python's module, too: what they call among
# themselves has hidden names, so that no call goes by a table.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
