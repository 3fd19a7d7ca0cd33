/// Which Thimble this is.
#pragma once

namespace thimble::tools {

/// The number of CMakeLists.txt, such as 0.3.0.
const char* version_number();
/// The commit that was built, 12 hexadecimal digits; "unknown" where it was no clone of the repository.
const char* version_commit();
/// The day of that commit, else that on which the build was configured: 2026-11-22.
const char* version_date();

}  // namespace thimble::tools
