# What the Debian packages have besides what is installed. CPack runs it between installing each into a folder of its own
# and packing that.
cmake_minimum_required(VERSION 3.20)
set(command ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/command/usr)
set(development ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/development/usr)

# Debian's zsh looks here for what packages bring.
file(RENAME ${command}/share/zsh/site-functions ${command}/share/zsh/vendor-completions)

# Debian's pkg-config looks in the folder of the architecture, one deeper, when it compiles for that.
execute_process(COMMAND dpkg-architecture -qDEB_HOST_MULTIARCH OUTPUT_VARIABLE machine OUTPUT_STRIP_TRAILING_WHITESPACE)
if(machine)
  file(GLOB descriptions RELATIVE ${development}/lib/pkgconfig ${development}/lib/pkgconfig/*.pc)
  foreach(description IN LISTS descriptions)
    file(READ ${development}/lib/pkgconfig/${description} said)
    string(REPLACE "\${pcfiledir}/../.." "\${pcfiledir}/../../.." said "${said}")
    file(WRITE ${development}/lib/${machine}/pkgconfig/${description} "${said}")
  endforeach()
  file(REMOVE_RECURSE ${development}/lib/pkgconfig)
endif()

file(READ ${CPACK_THIMBLE_SOURCE}/LICENSE licence)
string(REGEX MATCH "Copyright[^\n]*" copyright "${licence}")
string(REGEX REPLACE "^Copyright (\\(c\\) )?" "" copyright "${copyright}")
string(REGEX REPLACE "^.*Copyright[^\n]*\n+" "" licence "${licence}")
string(STRIP "${licence}" licence)
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence "${licence}")
# The day of the commit, so that a commit makes the same packages.
file(READ ${CPACK_THIMBLE_DATE_HEADER} said)
string(REGEX MATCH "THIMBLE_DATE \"([^\"]*)\"" said "${said}")
execute_process(COMMAND env LC_ALL=C date -u -R -d ${CMAKE_MATCH_1} OUTPUT_VARIABLE day
  OUTPUT_STRIP_TRAILING_WHITESPACE)

foreach(part COMMAND LIBRARY DEVELOPMENT)
  string(TOLOWER ${part} folder)
  set(package ${CPACK_DEBIAN_${part}_PACKAGE_NAME})
  set(doc ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${folder}/usr/share/doc/${package})
  file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: thimble

Files: *
Copyright: ${copyright}
License: Expat

License: Expat
 ${licence}
")
  file(WRITE ${doc}/changelog "${CPACK_PACKAGE_NAME} (${CPACK_PACKAGE_VERSION}) unstable; urgency=low

  * What changed stands in CHANGELOG.md of the source.

 -- ${CPACK_PACKAGE_CONTACT}  ${day}
")
  file(COPY ${CPACK_THIMBLE_SOURCE}/README.md DESTINATION ${doc})
  execute_process(COMMAND gzip -9n ${doc}/changelog ${doc}/README.md)
endforeach()
execute_process(COMMAND chmod -R u=rwX,go=rX ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
