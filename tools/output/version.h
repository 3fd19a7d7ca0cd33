/// Which Thimble this is.
#pragma once

namespace thimble::tools {

/// The number of CMakeLists.txt, such as 0.3.0.
extern const char* const kVersionNumber;
/// The commit that was built, 12 hexadecimal digits; "unknown" where it was no clone of the repository.
extern const char* const kVersionCommit;
/// The day of that commit, else that on which the build was configured: 2026-11-22.
extern const char* const kVersionDate;

}  // namespace thimble::tools
