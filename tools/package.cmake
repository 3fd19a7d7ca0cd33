# What a Debian package has besides what is installed. CPack runs it between installing into a folder of its own and
# packing that.
cmake_minimum_required(VERSION 3.20)
set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr)
set(doc ${root}/share/doc/thimble)
file(MAKE_DIRECTORY ${doc})

# One package has the command, the shared library and what one builds with.
file(WRITE ${root}/share/lintian/overrides/thimble
  "thimble: package-name-doesnt-match-sonames\nthimble: non-dev-pkg-with-shlib-symlink\n")

# Debian's zsh looks here for what packages bring.
file(RENAME ${root}/share/zsh/site-functions ${root}/share/zsh/vendor-completions)

# Debian's pkg-config looks in the folder of the architecture, one deeper, when it compiles for that.
execute_process(COMMAND dpkg-architecture -qDEB_HOST_MULTIARCH OUTPUT_VARIABLE machine OUTPUT_STRIP_TRAILING_WHITESPACE)
if(machine AND EXISTS ${root}/lib/pkgconfig)
  file(GLOB descriptions RELATIVE ${root}/lib/pkgconfig ${root}/lib/pkgconfig/*.pc)
  foreach(description IN LISTS descriptions)
    file(READ ${root}/lib/pkgconfig/${description} said)
    string(REPLACE "\${pcfiledir}/../.." "\${pcfiledir}/../../.." said "${said}")
    file(WRITE ${root}/lib/${machine}/pkgconfig/${description} "${said}")
  endforeach()
  file(REMOVE_RECURSE ${root}/lib/pkgconfig)
endif()

file(READ ${CPACK_THIMBLE_SOURCE}/LICENSE licence)
string(REGEX MATCH "Copyright[^\n]*" copyright "${licence}")
string(REGEX REPLACE "^Copyright (\\(c\\) )?" "" copyright "${copyright}")
string(REGEX REPLACE "^.*Copyright[^\n]*\n+" "" licence "${licence}")
string(STRIP "${licence}" licence)
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence "${licence}")
file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: thimble

Files: *
Copyright: ${copyright}
License: Expat

License: Expat
 ${licence}
")

# The day of the commit, so that a commit makes one package.
file(READ ${CPACK_THIMBLE_DATE_HEADER} said)
string(REGEX MATCH "THIMBLE_DATE \"([^\"]*)\"" said "${said}")
execute_process(COMMAND env LC_ALL=C date -u -R -d ${CMAKE_MATCH_1} OUTPUT_VARIABLE day
  OUTPUT_STRIP_TRAILING_WHITESPACE)
file(WRITE ${doc}/changelog "${CPACK_PACKAGE_NAME} (${CPACK_PACKAGE_VERSION}) unstable; urgency=low

  * What changed stands in CHANGELOG.md of the source.

 -- ${CPACK_PACKAGE_CONTACT}  ${day}
")
execute_process(COMMAND gzip -9n ${doc}/changelog)
file(COPY ${CPACK_THIMBLE_SOURCE}/README.md DESTINATION ${doc})
execute_process(COMMAND gzip -9n ${doc}/README.md)
execute_process(COMMAND chmod -R u=rwX,go=rX ${root})
