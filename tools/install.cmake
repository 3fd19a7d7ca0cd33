# What `make install` and the .deb have besides the library: the command, its scenes, its manual page, completions.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME command)
install(TARGETS thimble_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY gallery/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble
  FILES_MATCHING PATTERN "*.scene" PATTERN "*.vox" PATTERN "*.vox.gz")
install(DIRECTORY new DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble)
# Where they were built; and where the command finds them in a folder that one builds in.
if(NOT PROJECT_BINARY_DIR STREQUAL "${PROJECT_SOURCE_DIR}/build")
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/build/images ${PROJECT_BINARY_DIR}/images SYMBOLIC)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/build/web ${PROJECT_BINARY_DIR}/web SYMBOLIC)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/build/images DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble OPTIONAL
  FILES_MATCHING PATTERN "*.elf.gz")

install(FILES ${PROJECT_SOURCE_DIR}/build/web/share.html DESTINATION ${CMAKE_INSTALL_DATADIR}/thimble/web OPTIONAL)

# What desktops open files and draw their pictures by. The types are those of thimble.xml.
file(STRINGS desktop/thimble.xml types REGEX "mime-type type=")
list(TRANSFORM types REPLACE ".*type=\"([^\"]*)\".*" "\\1")
foreach(file desktop thumbnailer)
  configure_file(desktop/thimble.${file}.in ${PROJECT_BINARY_DIR}/generated/thimble.${file} @ONLY)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/thimble.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${PROJECT_BINARY_DIR}/generated/thimble.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers)
install(FILES desktop/thimble.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)
install(FILES desktop/thimble.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)

# The manual page comes from the description that --help prints.
set(manual ${PROJECT_BINARY_DIR}/generated/thimble.1.gz)
add_custom_command(OUTPUT ${manual} DEPENDS thimble_command
  COMMAND sh -c "\"$1\" manual | gzip -9n >\"$2\"" sh $<TARGET_FILE:thimble_command> ${manual}
  COMMENT "Writing the manual page" VERBATIM)
add_custom_target(thimble_manual ALL DEPENDS ${manual})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

install(FILES completions/thimble.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME thimble)
install(FILES completions/thimble.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
# Where zsh looks by itself below /usr/local; a package moves it (package.cmake).
install(FILES completions/thimble.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions RENAME _thimble)

# make deb: packages of the command, the shared library, and what one builds with.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME thimble)
set(CPACK_PACKAGE_VENDOR Thimble)
file(STRINGS ${PROJECT_SOURCE_DIR}/tools/packages/tree.py contact REGEX "^CONTACT = ")
string(REGEX REPLACE "^CONTACT = \"([^\"]*)\".*" "\\1" contact "${contact}")
set(CPACK_PACKAGE_CONTACT "${contact}" CACHE STRING "Maintainer of the Debian packages: NAME <MAIL>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "voxel ray tracer in a fixed block of memory")
set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME thimble)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COMMAND_DESCRIPTION
"Draws voxel scenes, meshes and clouds of points exactly, the same picture bit
for bit on every machine, and says what a scene takes on a microcontroller:
memory, flash, time and error. Holds the command and its scenes.")
set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(library libthimble-files${version})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${library})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/triggers)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION
"The readers and renderers as a shared library: programs that load voxel scenes,
meshes and clouds of points, draw them as the command does, and write them,
need this.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libthimble-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION}), libhwy-dev, libtbb-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"Headers, static libraries and descriptions for CMake and pkg-config of the
tracer for microcontrollers, of the desktop's renderer, and of the readers.")
# These were one package before.
foreach(part LIBRARY DEVELOPMENT)
  set(CPACK_DEBIAN_${part}_PACKAGE_BREAKS "thimble (<< ${version})")
  set(CPACK_DEBIAN_${part}_PACKAGE_REPLACES "thimble (<< ${version})")
endforeach()
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_SOURCE_DIR}/package.cmake)
set(CPACK_THIMBLE_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_THIMBLE_DATE_HEADER ${PROJECT_BINARY_DIR}/generated/thimble_version.h)
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)
